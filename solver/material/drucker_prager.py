"""Drucker-Prager soil: the smooth cone beside Mohr-Coulomb, linear elastic, perfectly plastic, flow by psi <= phi.

F = sqrt(J2) + a p - b <= 0, p = tr(sigma)/3, tension positive; flow along the gradient of sqrt(J2) + d p. The apex is
that of Mohr-Coulomb, p = c cot phi, so b = a c cot phi. Two cones:

plane_strain: strength and dilation of Mohr-Coulomb where plane strain fails. There the elastic strain rests, so plastic
    strain has no zz: s_zz = -2/3 d sqrt(J2). With it, radius t and centre s of Mohr's circle have
    t = sqrt(1 - d^2/3) sqrt(J2), s = p + d/3 sqrt(J2), and flow has volume to shear d / sqrt(1 - d^2/3) = sin psi. So
    d = n sin psi, a = (sin phi / n) / (1 + sin phi sin psi / 3), n = (1 + sin^2 psi / 3)^(-1/2);
    for psi = phi it is a = 3 tan phi / sqrt(9 + 12 tan^2 phi) (Drucker & Prager 1952, doi:10.1090/qam/48291).
compression: the edge s1 = s2, a = 6 sin phi / (sqrt(3) (3 - sin phi)), d alike with psi (de Souza Neto, Peric & Owen
    2008, chapter 6). In plane strain it is stronger than Mohr-Coulomb.

The return is radial or to the apex (chapter 8 there); with psi = 0 the latter is a projection, as in mohr_coulomb.

With phi = 0 it is von Mises' material: sqrt(J2) <= c (plane_strain: t <= c where plane strain fails) or 2 c / sqrt(3)
(compression: s1 - s3 <= 2 c there). There is no apex, and nothing dilates.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import radians, sin, sqrt
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.material.mohr_coulomb import apex_of, check_strength, undilated
from mpm_verify.solver.objective import RESPOND
from mpm_verify.solver.principal import in_order, in_plane
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats
from mpm_verify.solver.voids import check_void, close_void

if TYPE_CHECKING:
    from mpm_verify.solver.compression import Compression


@kernel(RESPOND)
def respond(constants, sigma, de, history):
    """Write the elastic trial stress, or its return where it is not admissible; history gamma_p, eps_v_p, void."""
    lam, shear, slope, strength = constants[0], constants[1], constants[2], constants[3]
    for b in range(sigma.shape[0] // 4):
        if history[3 * b + 2] != 0.0:
            history[3 * b + 2] = close_void(b, de, history[3 * b + 2])
        bulk = lam * (de[3 * b] + de[3 * b + 1])
        xx = sigma[4 * b] + (bulk + shear * de[3 * b])
        yy = sigma[4 * b + 1] + (bulk + shear * de[3 * b + 1])
        zz = sigma[4 * b + 2] + bulk
        xy = sigma[4 * b + 3] + shear * de[3 * b + 2]
        p = (xx + yy + zz) / 3.0
        sxx, syy, szz = xx - p, yy - p, zz - p
        root = np.sqrt(0.5 * (sxx * sxx + syy * syy + szz * szz) + xy * xy)
        excess = root + slope * p - strength
        if not excess <= 0.0:
            up, down, _ = in_plane(xx, yy, xy)
            t1, _, t3 = in_order(up, down, zz)
            step = excess * constants[4]
            finite = 0.0 * (xx + yy + zz + xy)  # the apex is finite whatever comes in: a state that is NaN stays so
            scale, mean = finite, constants[6] + finite
            if step < root or slope == 0.0:  # a cone of no slope has no apex
                scale, mean = 1.0 - step / root, p - step * constants[5]
            opens = constants[8] > 0.0 and not step < root
            history[3 * b] += (1.0 - scale) * (t1 - t3) / shear
            history[3 * b + (2 if opens else 1)] += (p - mean) * constants[7]
            xx, yy, zz, xy = mean + scale * sxx, mean + scale * syy, mean + scale * szz, scale * xy
        sigma[4 * b] = xx
        sigma[4 * b + 1] = yy
        sigma[4 * b + 2] = zz
        sigma[4 * b + 3] = xy


def plane_strain(phi: float, psi: float) -> tuple[float, float]:
    """Slopes a and d of the cone that fails as Mohr-Coulomb in plane strain; angles in degrees."""
    n = 1 / sqrt(1 + sin(radians(psi)) ** 2 / 3)
    return sin(radians(phi)) / n / (1 + sin(radians(phi)) * sin(radians(psi)) / 3), n * sin(radians(psi))


def compression(phi: float, psi: float) -> tuple[float, float]:
    """Slopes a and d of the cone through the compression edges of Mohr-Coulomb; angles in degrees."""
    a, d = (6 * sin(radians(angle)) / (sqrt(3) * (3 - sin(radians(angle)))) for angle in (phi, psi))
    return a, d


CONES: dict[str, Callable[[float, float], tuple[float, float]]] = {
    "plane_strain": plane_strain,
    "compression": compression,
}


VON_MISES = {"plane_strain": 1.0, "compression": 2 / sqrt(3)}  # sqrt(J2) / c that is left of each cone with phi = 0


@dataclass(frozen=True)
class DruckerPrager(RateMaterial, Elastic):
    """Drucker-Prager soil, in rate form; history as of MohrCoulomb.

    Parameters
    ----------
    rate
        Objective rate, a file of solver/rates.
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.
    phi, psi
        Angles of friction and dilation in degrees, 0 <= phi < 90, 0 <= psi <= phi; phi = 0 needs c above zero, and
        psi is 0 then unless another one is given.
    c
        Cohesion in the unit of E, zero or more.
    cone
        ``plane_strain`` or ``compression``.
    void
        1 with void-strain memory (solver/voids.py), which needs c = 0.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    de Souza Neto, Peric & Owen 2008, doi:10.1002/9780470694626, chapters 6 and 8.
    """

    E: float = 840e3
    rho0: float = 2650.0
    phi: float = 31.0
    psi: float = 1.0
    c: float = 0.0
    cone: str = "plane_strain"
    void: float = 0.0
    memory: ClassVar[tuple[str, ...]] = ("gamma_p", "eps_v_p", "void")
    sums: ClassVar[tuple[str, ...]] = ("gamma_p", "eps_v_p")
    order: ClassVar[float | None] = 1.0
    out_of_plane: ClassVar[Literal["", "trial", "plane"]] = "trial"
    respond = staticmethod(respond)

    def __post_init__(self) -> None:
        Elastic.__post_init__(self)
        RateMaterial.__post_init__(self)
        undilated(self)
        check_strength(self.phi, self.psi, self.c)
        check_void(self.void, self.c)
        if self.cone not in CONES:
            raise ValueError(f"cone = {self.cone!r} must be one of {', '.join(CONES)}")

    @property
    def friction_angle(self) -> float:
        """Angle phi in degrees."""
        return self.phi

    @property
    def fails_as_mohr_coulomb(self) -> bool:
        """Whether it fails and flows as Mohr-Coulomb in plane strain."""
        return self.cone == "plane_strain"

    @property
    def cohesion(self) -> float:
        """Cohesion c, in the unit of E."""
        return self.c

    def compression(self) -> "Compression":
        """Volume strain that stress holds."""
        from mpm_verify.solver.compression import linear

        return linear(self)

    def constants(self) -> Floats:
        """Constants (9,): lam, 2 mu, a, b, and factors of the return."""
        a, d = CONES[self.cone](self.phi, self.psi)
        stiff = self.lam + 2 * self.mu / 3  # bulk modulus
        ratio, apex = d * stiff / self.mu, apex_of(self.phi, self.c)
        strength = a * apex if self.phi else VON_MISES[self.cone] * self.c
        return np.array(
            [self.lam, 2 * self.mu, a, strength, 1 / (1 + a * ratio), ratio, apex, 1 / stiff,
             self.void]
        )  # fmt: skip
