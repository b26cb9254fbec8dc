"""Mohr-Coulomb soil with a tension cut-off: linear elastic, perfectly plastic, flow by an angle of dilation psi <= phi.

Principal stresses s1 >= s2 >= s3, tension positive, zz among them. Elastic states have
    f = k s1 - s3 - 2 c sqrt(k) <= 0   and   s1 <= sigma_t,   k = (1 + sin phi)/(1 - sin phi);
flow is along (m, 0, -1), m = (1 + sin psi)/(1 - sin psi), on a plane of f, and associated on the cut-off. Directions of
return are constant, so every region has its exact solution in one step. Which it is, `returned` finds by tests that
each imply all that Koiter's rule asks for; what they leave, rounding included, belongs to the edge of plane and cut-off
or to an end of it.

A cut-off above the apex c cot phi has no effect: it is put at the apex, where all corners of the cut-off meet. With
psi > 0 the flow of the six planes reaches every state beyond the apex. With psi = 0 flow cannot change the pressure;
then the return to the apex is a projection, and the plastic strain is what the elastic one leaves: C (trial - sigma).

With phi = 0 it is Tresca's material, k = 1: s1 - s3 <= 2 c at any pressure. There is no apex, nothing dilates, and the
cut-off is at sigma_t itself, however high.

Dilation may end, as that of sand does at its critical volume: where gamma_p has reached gamma_cv at the start of a
step, psi is 0. This is **our own reading**, a step where sand has a curve; the paper's psi has no end, and the volume
that it makes grows with the shear.
"""

from dataclasses import dataclass
from math import cos, inf, radians, sin, sqrt, tan
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.objective import RESPOND
from mpm_verify.solver.principal import advance_elastic, in_order, on_axes, unsorted
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats
from mpm_verify.solver.voids import check_void, close_void

if TYPE_CHECKING:
    from mpm_verify.solver.compression import Compression


@kernel(inline=True)
def returned(t1, t2, t3, f, constants):
    """Admissible stress of a trial stress t1 >= t2 >= t3 that is not, f its excess.

    p is the return to the plane, q to the cut-off, each as if it were alone. One sign says whether the next surface
    flows too: p1 < p2 that the plane of s2 and s3 does, q2 > sigma_t that the cut-off of s2 does; by the order of t the
    first one then flows more. Tests of adjacent regions are complements of one another, so round-off leaves no gap.
    """
    k, cohesive, tension, low = constants[2], constants[3], constants[4], constants[5]
    nu, cut = constants[6], t1 - tension
    p1 = t1 - f * constants[7]
    p2 = t2 - f * constants[8]
    p3 = t3 - f * constants[9]
    q2 = t2 - cut * constants[10]
    q3 = t3 - cut * constants[10]
    e12 = constants[11] * (t1 + t2) + constants[12] * t3 + constants[13]
    e23 = constants[14] * t1 + constants[15] * (t2 + t3) + constants[16]
    r3 = t3 - nu * (t1 + t2 - 2.0 * tension)
    if f > 0.0 and p1 >= p2 and p2 >= p3 and p1 <= tension:  # plane
        s1, s2, s3 = p1, p2, p3
    elif f > 0.0 and p1 < p2 and e12 <= tension:  # edge s1 = s2
        s1, s2, s3 = e12, e12, k * e12 - cohesive
    elif f > 0.0 and p2 < p3 and e23 <= tension:  # edge s2 = s3
        s1, s2, s3 = e23, k * e23 - cohesive, k * e23 - cohesive
    elif cut > 0.0 and q2 <= tension and q3 >= low:  # cut-off
        s1, s2, s3 = tension, q2, q3
    elif cut > 0.0 and q2 > tension and r3 >= low:  # edge of the cut-off, and its apex
        s1, s2, s3 = tension, tension, min(r3, tension)
    else:  # edge of plane and cut-off: neither strains in direction 2; and its ends
        s2 = t2 - nu * (t1 + t3 - tension - low)
        s1, s2, s3 = tension, max(low, min(s2, tension)), low
    return s1, s2, s3


@kernel(RESPOND)
def respond(constants, sigma, de, history):
    """Write the elastic trial stress, or its return where it is not admissible; history gamma_p, eps_v_p, void.

    Two loops: the first has no branches and vectorises, roots included, which makes the whole faster by a half.
    """
    shear, k, cohesive, tension = constants[1], constants[2], constants[3], constants[4]
    gamma_cv, ended = constants[19], constants[20:]
    plane = np.empty(3 * (sigma.shape[0] // 4))
    for b in range(sigma.shape[0] // 4):
        if history[3 * b + 2] != 0.0:
            history[3 * b + 2] = close_void(b, de, history[3 * b + 2])
    advance_elastic(constants[0], shear, sigma, de, plane)
    for b in range(sigma.shape[0] // 4):
        up, down, zz = plane[3 * b], plane[3 * b + 1], sigma[4 * b + 2]
        t1, t2, t3 = in_order(up, down, zz)
        f = k * t1 - t3 - cohesive
        if not (f <= 0.0 and t1 <= tension):
            xx, yy, xy = sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 3]
            s1, s2, s3 = returned(t1, t2, t3, f, ended if history[3 * b] >= gamma_cv else constants)
            finite = 0.0 * (xx + yy + zz + xy)  # corners are finite whatever comes in: a state that is NaN stays so
            up, down, zz = unsorted(s1 + finite, s2 + finite, s3 + finite, up, down, zz)
            opens = constants[18] > 0.0 and min(up, down) >= tension  # nothing is left in the plane
            history[3 * b] += (t1 - s1 - t3 + s3) / shear
            history[3 * b + (2 if opens else 1)] += (t1 - s1 + t2 - s2 + t3 - s3) * constants[17]
            xx, yy, xy = on_axes(up, down, xx, yy, xy, plane[3 * b + 2])
            sigma[4 * b] = xx
            sigma[4 * b + 1] = yy
            sigma[4 * b + 2] = zz
            sigma[4 * b + 3] = xy


@dataclass(frozen=True)
class MohrCoulomb(RateMaterial, Elastic):
    """Mohr-Coulomb soil with a tension cut-off, in rate form; the defaults are the sand of the paper's column, in SI.

    The history holds gamma_p, the sum of the increments of e1 - e3 of the plastic strain, and eps_v_p, its volume,
    positive where the soil dilates; with void=1 what opens at the apex is not in eps_v_p but in the void strain, so
    that elastic volume + eps_v_p + void is the volume strain.

    Parameters
    ----------
    rate
        Objective rate, a file of solver/rates.
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.
    phi
        Angle of friction in degrees, 0 <= phi < 90; 0 with c above zero is Tresca.
    psi
        Angle of dilation in degrees, 0 <= psi <= phi: without hardening, flow that contracts has no end and leaves
        states around the apex without a return. It is 0 with phi = 0 unless another one is given.
    c
        Cohesion in the unit of E, zero or more.
    sigma_t
        Tension cut-off in the unit of E, zero or more; far above the cohesion it has no effect.
    void
        1 with void-strain memory (solver/voids.py), which needs c = 0 or sigma_t = 0.
    gamma_cv
        Plastic shear gamma_p, above zero, from which on psi is 0; inf where dilation has no end.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    Clausen, Damkilde & Andersen 2007, doi:10.1016/j.compstruc.2007.04.002.
    de Souza Neto, Peric & Owen 2008, doi:10.1002/9780470694626, chapter 8.
    """

    E: float = 840e3
    rho0: float = 2650.0
    phi: float = 31.0
    psi: float = 1.0
    c: float = 0.0
    sigma_t: float = 0.0
    void: float = 0.0
    gamma_cv: float = inf
    memory: ClassVar[tuple[str, ...]] = ("gamma_p", "eps_v_p", "void")
    sums: ClassVar[tuple[str, ...]] = ("gamma_p", "eps_v_p")
    order: ClassVar[float | None] = 1.0
    yields_in_plane: ClassVar[bool] = True
    out_of_plane: ClassVar[Literal["", "trial", "plane"]] = "trial"
    respond = staticmethod(respond)

    def __post_init__(self) -> None:
        Elastic.__post_init__(self)
        RateMaterial.__post_init__(self)
        undilated(self)
        check_strength(self.phi, self.psi, self.c)
        check_void(self.void, self.c, self.sigma_t)
        if not 0 <= self.sigma_t < inf:
            raise ValueError(f"sigma_t = {self.sigma_t} must be zero or more, and finite")
        if not self.gamma_cv > 0:
            raise ValueError(f"gamma_cv = {self.gamma_cv} must be above zero; psi=0 is what does not dilate at all")
        if self.gamma_cv < inf:  # what follows depends on the sum
            object.__setattr__(self, "sums", ())

    @property
    def friction_angle(self) -> float:
        """Angle phi in degrees."""
        return self.phi

    @property
    def fails_as_mohr_coulomb(self) -> bool:
        """Whether it fails and flows as Mohr-Coulomb in plane strain."""
        return True

    @property
    def cohesion(self) -> float:
        """Cohesion c, in the unit of E."""
        return self.c

    def compression(self) -> "Compression":
        """Volume strain that stress holds."""
        from mpm_verify.solver.compression import linear

        return linear(self)

    def constants(self) -> Floats:
        """Constants (39,): 19 of `weights` with psi, gamma_cv, and the 19 of psi = 0."""
        return np.concatenate([self.weights(self.psi), [self.gamma_cv], self.weights(0.0)])

    def weights(self, psi: float) -> Floats:
        """Constants (19,): lam, 2 mu, strength, and the weights of trial stresses in the return to each region."""
        nu, k, m = self.nu, slope(self.phi), slope(psi)
        cohesive = 2 * self.c * sqrt(k)
        tension, apex = min(self.sigma_t, apex_of(self.phi, self.c)), apex_of(self.phi, self.c)
        low = k * tension - cohesive if tension < apex else tension  # s3 where plane and cut-off meet
        dilation = nu / (1 - 2 * nu) * (m - 1)  # the flow's stress is 2 mu (dilation (1, 1, 1) + (m, 0, -1))
        plane = np.array([dilation + m, dilation, dilation - 1]) / (dilation * (k - 1) + k * m + 1)
        # what no flow of the edge changes: (v, v, w) . s on s1 = s2, (u, v, v) . s on s2 = s3
        v, w = np.array([1 - dilation, 2 * dilation + m]) / (2 * (1 - dilation) + k * (2 * dilation + m))
        upper = [v, w, w * cohesive]
        u, v = np.array([1 - 2 * dilation, dilation + m]) / (1 - 2 * dilation + 2 * k * (dilation + m))
        lower = [u, v, 2 * v * cohesive]
        return np.array(
            [self.lam, 2 * self.mu, k, cohesive, tension, low, nu, *plane, nu / (1 - nu), *upper, *lower,
             (1 - 2 * nu) / self.E, self.void]
        )  # fmt: skip


def slope(angle: float) -> float:
    """Slope (1 + sin)/(1 - sin) of an angle in degrees, so written that it is 1 for 0 and stays finite close to 90."""
    return ((1 + sin(radians(angle))) / cos(radians(angle))) ** 2


def apex_of(phi: float, c: float) -> float:
    """Pressure c cot phi of the apex, tension positive; inf for phi = 0 (degrees), which has none."""
    return c / tan(radians(phi)) if phi else inf


def undilated(soil: Any) -> None:
    """Set psi to 0 where phi = 0 and psi is the class's usual one: what has no friction does not dilate."""
    if soil.phi == 0 and soil.psi == type(soil).psi:
        object.__setattr__(soil, "psi", 0.0)


def check_strength(phi: float, psi: float, c: float) -> None:
    """Raise ValueError for angles (degrees) or a cohesion that are out of range."""
    if not 0 <= phi < 90:
        raise ValueError(f"phi = {phi} must be at least 0 and below 90 degrees")
    if phi == 0 and not c > 0:
        raise ValueError("phi = 0 must have c above zero, its strength; without both nothing is left of the soil")
    if not 0 <= psi <= phi:
        raise ValueError(f"psi = {psi} must lie between 0 and phi = {phi} degrees")
    if not 0 <= c < inf:
        raise ValueError(f"c = {c} must be zero or more, and finite")
