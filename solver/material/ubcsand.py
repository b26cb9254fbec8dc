"""UBCSAND: sand with hyperbolic hardening of the mobilised friction, primary loading (Beaty & Byrne 2011).

In the plane, compression positive: s the centre and t the radius of Mohr's circle, s' = s + c cot phi_f, eta = t/s'.
    elastic   G = KGe Pa (s/Pa)^ne,  K = KBe Pa (s/Pa)^me
    yield     t = eta_m s',  eta_m the largest eta of the branch
    hardening d eta = (Gp/s') (1 - Rf eta/eta_f)^2 d gamma_p,  Gp = KGp Pa (s/Pa)^np,  eta <= eta_f = sin phi_f
    flow      d eps_v_p = (eta - eta_cv) d gamma_p, eta_cv = sin phi_pt: it contracts below eta_cv (dilation positive)
The plane alone yields, as in the two-dimensional programs that the model comes from; zz follows (see `out_of_range`).
Every modulus is that of the middle of the step, found by passes; hardening is integrated exactly, q = eta/(1 - a eta)
growing by k d gamma_p with a = Rf/eta_f, k = Gp/s', so that a pass ends in a quadratic equation; the flow has the mean
eta of the slip. Slip is along the axes of stress in the middle of the plastic part of the step: along those of its end,
as radial returns have it, turning axes (simple shear) cost an order. So of order 2, and 4 at constant s and axes.

Beyond the cut-off (s <= -sigma_t) all stresses vanish and eta_m is forgotten: what touches again loads as if new.

With reversal=1, **our reading** of the cyclic model's cross-over, whose rules are not public: where the shear stress on
the material's horizontal plane changes its sign, a new branch starts at the eta that is mobilised there, with a plastic
stiffness times hfac1 hfac2 (4 + n/2) min(1, max(1/2, N/10)), n the number of reversals, N = (N1)60. It needs the
material's own axes, hence the rate green_naghdi. Without it hfac1 to hfac6 are stored and have no effect: they belong
to cyclic loading, and the paper's column has none.
"""

from dataclasses import dataclass, fields
from math import inf, isfinite, radians, sin, sqrt, tan
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.mobilised import onset, slip, unit
from mpm_verify.solver.objective import RESPOND
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats, Ints, Particles
from mpm_verify.solver.voids import check_void, close_void

if TYPE_CHECKING:
    from mpm_verify.solver.compression import Compression

PASSES = 3
CLOSE = 0.8  # cosine between the axes of the middle and of the end; beyond it the return is radial
NOISE = 1e-9  # fraction of s: a shear stress below it is none, and cannot change its sign
SETTLED = 1e-12  # fraction of s: below it an elastic step need not be passed again
MEMORY = ("eta_m", "gamma_p", "eps_v_p", "work_p", "reversals", "detached", "void")


@kernel(RESPOND)
def respond(constants, sigma, de, history):
    """Write stress and history at the end of the step; constants as in `Ubcsand.constants`."""
    Ge, ne, Ke, me, Gp, n_p = constants[0], constants[1], constants[2], constants[3], constants[4], constants[5]
    a, eta_f, eta_cv, per_Pa, s_min = constants[6], constants[7], constants[8], constants[9], constants[10]
    shift, cut, reversal, secondary = constants[11], constants[12], constants[13], constants[14]
    open_ = constants[15]
    for b in range(sigma.shape[0] // 4):
        if history[7 * b + 6] != 0.0:
            history[7 * b + 6] = close_void(b, de, history[7 * b + 6])
        xx, yy, zz, xy = sigma[4 * b], sigma[4 * b + 1], sigma[4 * b + 2], sigma[4 * b + 3]
        dxx, dyy, dxy = de[3 * b], de[3 * b + 1], de[3 * b + 2]
        eta_m = history[7 * b]
        turns = history[7 * b + 4]
        volume = dxx + dyy
        start = -0.5 * (xx + yy)
        s = start
        eta = eta_m
        ends = eta_m  # memory after the step
        half0 = 0.5 * (xx - yy)
        L = D = nx = ny = mx = my = 0.0
        s_mid = start
        eta_mid = eta_m
        for _ in range(PASSES):
            middle = s_mid if not (s_mid < s_min) else s_min
            logarithm = np.log(middle * per_Pa)
            power = np.exp(ne * logarithm)
            G = Ge * power
            K = Ke * (power if me == ne else np.exp(me * logarithm))
            lam = K - 2.0 / 3.0 * G
            stiff = K + G / 3.0
            nxx = xx + lam * volume + 2.0 * G * dxx
            nyy = yy + lam * volume + 2.0 * G * dyy
            nzz = zz + lam * volume
            nxy = xy + 2.0 * G * dxy
            trial = -0.5 * (nxx + nyy)
            half = 0.5 * (nxx - nyy)
            t = np.sqrt(half * half + nxy * nxy)
            memory = eta_m
            stiffer = 1.0
            onset_at = 0.0  # fraction of the way from the old stress to the trial
            crossed = reversal > 0.0 and xy * nxy < 0.0 and abs(xy) > NOISE * (start + shift)
            if crossed:  # eta where the shear stress vanishes, on the way from the old stress to the trial
                onset_at = xy / (xy - nxy)
                memory = abs(half0 * (1.0 - onset_at) + half * onset_at)
                memory = min(memory / (start + (trial - start) * onset_at + shift), eta_f)
                eta_mid = memory if L == 0.0 else eta_mid
            if reversal > 0.0 and turns + crossed > 0.0:
                stiffer = secondary * (4.0 + 0.5 * (turns + crossed))
            L = 0.0
            s = trial
            ends = memory
            eta = t / (trial + shift)
            if not (trial <= cut) and not (t <= memory * (trial + shift)):
                onset_at = onset_at if crossed else onset(memory, half0, xy, start + shift, half, nxy, trial + shift)
                x_on = half0 + onset_at * (half - half0)
                y_on = xy + onset_at * (nxy - xy)
                radius = nx * half + ny * nxy  # on the new axes; slip on those of the middle shortens it by G_n
                if not (nx * mx + ny * my > CLOSE and radius > memory * (trial + shift)):  # a first pass, a large step
                    nx, ny, mx, my, radius = half / t, nxy / t, half / t, nxy / t, t
                D = eta_cv - eta_mid
                k = stiffer * Gp * np.exp(n_p * logarithm) / (middle + shift)
                G_n = G * (nx * mx + ny * my)
                L = slip(radius, trial + shift, G_n, stiff, D, a, k, memory)
                first = memory / (1.0 - a * memory)
                q = first + k * L
                eta = q / (1.0 + a * q)
                q = first + 0.5 * k * L
                eta_mid = (memory + 4.0 * q / (1.0 + a * q) + eta) / 6.0  # mean over the slip, by Simpson's rule
                if eta > eta_f or L < 0.0:
                    eta = eta_f
                    eta_mid = eta_f
                    D = eta_cv - eta_f
                    L = (radius - eta_f * (trial + shift)) / (G_n - eta_f * stiff * D)
                s = trial - stiff * D * L
                nzz += lam * D * L
                ends = eta
                nx, ny = unit(half - G * L * mx, nxy - G * L * my, mx, my)
                fit = eta * (s + shift)
                mx, my = unit(x_on + fit * nx, y_on + fit * ny, nx, ny)
            before = s_mid
            s_mid = 0.5 * (start + s)
            if L == 0.0 and abs(s_mid - before) <= SETTLED * middle:
                break
        if s <= cut:
            nothing = 0.0 * (nxx + nyy + nzz + nxy)  # a state that is NaN stays so
            sigma[4 * b] = nothing
            sigma[4 * b + 1] = nothing
            sigma[4 * b + 2] = nothing
            sigma[4 * b + 3] = nothing
            history[7 * b] = 0.0
            history[7 * b + 5] += 1.0
            history[7 * b + 6] += open_ * (cut - s) / stiff
        else:
            if L != 0.0:
                radius = eta * (s + shift)
                nxy = radius * ny
                history[7 * b + 1] += L
                history[7 * b + 2] -= D * L
                history[7 * b + 3] += (s_mid + shift) * (eta_mid + D) * L - shift * D * L
                nxx = -s + radius * nx
                nyy = -s - radius * nx
            history[7 * b] = ends
            history[7 * b + 4] = turns + crossed
            sigma[4 * b] = nxx
            sigma[4 * b + 1] = nyy
            sigma[4 * b + 2] = nzz
            sigma[4 * b + 3] = nxy


@dataclass(frozen=True)
class Ubcsand(RateMaterial):
    """UBCSAND, in rate form; the defaults are the paper's Table 2, SI units.

    History: eta_m; gamma_p, plastic e1 - e3, summed; eps_v_p, its volume, dilation positive; work_p, plastic work per
    volume; the number of reversals; how often the particle was detached; with void=1 the void strain.

    Parameters
    ----------
    rate
        Objective rate, a file of solver/rates.
    KGe, ne, KBe, me, KGp, np
        Numbers and exponents of the shear, the bulk and the plastic modulus.
    phi_f, phi_pt
        Angles of failure and of constant volume in degrees.
    c, sigma_t
        Cohesion and tension cut-off, stresses, zero or more.
    Pa
        Atmospheric pressure, in the unit of stress.
    N
        Blow count (N1)60.
    Rf
        Failure ratio, which decides how soon the strength is mobilised. Rf is not in that table; the default is
        the generic correlation 1.1 N^-0.15 at N = 10.7.
    hfac1, hfac2, hfac3, hfac4, hfac5, hfac6
        Factors of cyclic loading; with reversal=1 the first two act, the others have no effect.
    s_min
        Least s in the moduli, in units of Pa.
    s_bound
        Largest s that a run is meant to reach, for its time step alone (`wave_speed`), as the moduli have no limit.
    rho0
        Density at reference.
    reversal
        1 with a new branch at each reversal, which needs the rate green_naghdi.
    void
        1 with void-strain memory (solver/voids.py), which needs c = 0 or sigma_t = 0.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    KGe: float = 100.0
    ne: float = 0.7
    KBe: float = 125.0
    me: float = 0.7
    KGp: float = 5.0
    np: float = 0.4
    phi_f: float = 31.1
    phi_pt: float = 31.0
    c: float = 0.0
    sigma_t: float = 0.0
    Pa: float = 100e3
    N: float = 10.7
    Rf: float = 0.7708770538
    hfac1: float = 0.65
    hfac2: float = 0.85
    hfac3: float = 1.0
    hfac4: float = 0.6
    hfac5: float = 1.0
    hfac6: float = 0.95
    s_min: float = 1e-4
    s_bound: float = 20e3
    rho0: float = 2650.0
    reversal: float = 0.0
    void: float = 0.0
    memory: ClassVar[tuple[str, ...]] = MEMORY
    sums: ClassVar[tuple[str, ...]] = ("gamma_p", "eps_v_p", "work_p")
    yields_in_plane: ClassVar[bool] = True
    order: ClassVar[float | None] = 2.0
    out_of_plane: ClassVar[Literal["", "trial", "plane"]] = "plane"
    respond = staticmethod(respond)

    def __post_init__(self) -> None:
        RateMaterial.__post_init__(self)
        check(self)

    @property
    def friction_angle(self) -> float:
        """Angle phi_f in degrees."""
        return self.phi_f

    @property
    def cohesion(self) -> float:
        """Cohesion c, a stress."""
        return self.c

    @property
    def eta_f(self) -> float:
        """Failure ratio sin phi_f."""
        return sin(radians(self.phi_f))

    @property
    def eta_cv(self) -> float:
        """Ratio of constant volume, sin phi_pt."""
        return sin(radians(self.phi_pt))

    @property
    def shift(self) -> float:
        """Shift c cot phi_f of s, a stress."""
        return self.c / tan(radians(self.phi_f))

    def moduli(self, s: float) -> tuple[float, float]:
        """Shear modulus G and bulk modulus K at the mean stress s in the plane, compression positive."""
        ratio = max(s / self.Pa, self.s_min)
        return self.KGe * self.Pa * ratio**self.ne, self.KBe * self.Pa * ratio**self.me

    def compression(self) -> "Compression":
        """Volume strain that stress holds: of K + G/3, by s."""
        from mpm_verify.solver.compression import by_power, by_two_powers

        least, bulk, shear = self.s_min * self.Pa, self.KBe * self.Pa ** (1 - self.me), self.KGe / 3
        if self.ne == self.me:
            return by_power((self.KBe + shear) * self.Pa ** (1 - self.me), self.me, least)
        return by_two_powers(bulk, self.me, shear * self.Pa ** (1 - self.ne), self.ne, least)

    def renew(self, particles: Particles, rows: Ints) -> None:
        """Write eta_m of particles in `rows` as their new stress mobilises it: what touches again loads as if new."""
        particles.history[rows, 0] = self.initial(particles.sigma[rows])[:, 0]

    def mobilise(self, particles: Particles) -> None:
        """Raise eta_m of particles to what their stress mobilises."""
        eta = particles.history[:, 0]
        np.maximum(eta, self.initial(particles.sigma)[:, 0], out=eta)

    def constants(self) -> Floats:
        """Constants (16,) in the order in which the kernel reads them."""
        secondary = self.hfac1 * self.hfac2 * min(1.0, max(0.5, 0.1 * self.N))
        return np.array(
            [self.KGe * self.Pa, self.ne, self.KBe * self.Pa, self.me, self.KGp * self.Pa, self.np,
             self.Rf / self.eta_f, self.eta_f, self.eta_cv, 1 / self.Pa, self.s_min * self.Pa, self.shift,
             -min(self.sigma_t, self.shift), self.reversal, secondary, self.void]
        )  # fmt: skip

    def initial(self, sigma: Floats) -> Floats:
        """History (P,7) with the eta_m that sigma (P,4) mobilises, at most eta_f; nothing else has happened."""
        history = np.zeros((len(sigma), len(MEMORY)))
        s = -(sigma[:, 0] + sigma[:, 1]) / 2 + self.shift
        t = np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3])
        history[:, 0] = np.clip(np.divide(t, s, out=np.zeros(len(s)), where=s > 0), 0, self.eta_f)
        return history

    def wave_speed(self, s: float | None = None) -> float:
        """Speed of the compression wave, sqrt((K + 4G/3)/rho0), at the mean stress s, s_bound if it is left out."""
        G, K = self.moduli(self.s_bound if s is None else s)
        return sqrt((K + 4 / 3 * G) / self.rho0)


def out_of_range(sigma: Floats) -> NDArray[np.bool_]:
    """Whether zz of sigma (P,4) leaves the range of the principal stresses in the plane, (P,).

    There a three-dimensional model would yield on other planes than this one.
    """
    centre = (sigma[:, 0] + sigma[:, 1]) / 2
    radius = np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3])
    outside: NDArray[np.bool_] = np.abs(sigma[:, 2] - centre) > radius * (1 + 1e-12)
    return outside


def check(sand: Ubcsand) -> None:
    """Raise ValueError with what is allowed."""
    for item in fields(sand):
        value = getattr(sand, item.name)
        if item.name != "rate" and not isfinite(value):
            raise ValueError(f"{item.name} = {value} must be finite")
    for name in ("KGe", "KBe", "KGp", "Pa", "N", "s_min", "s_bound", "rho0"):
        if not getattr(sand, name) > 0:
            raise ValueError(f"{name} = {getattr(sand, name)} must be above zero")
    for name in ("ne", "me", "np"):
        if not 0 <= getattr(sand, name) <= 1:
            raise ValueError(f"{name} = {getattr(sand, name)} must lie between 0 and 1")
    if not 0 < sand.phi_pt <= sand.phi_f < 90:
        raise ValueError(
            f"phi_pt = {sand.phi_pt} must lie above 0 and not above phi_f = {sand.phi_f}, below 90 degrees"
        )
    if not 0 <= sand.Rf < 1:
        raise ValueError(f"Rf = {sand.Rf} must lie from 0 to below 1")
    worst = max((K / G + 1 / 3) * sand.eta_cv**2 / 4 for G, K in map(sand.moduli, (sand.s_min * sand.Pa, sand.s_bound)))
    if worst >= 1:
        raise ValueError(f"K/G must leave (K/G + 1/3) sin^2(phi_pt)/4 below 1, not {worst:.3g}: no step would end")
    if not (0 <= sand.c < inf and 0 <= sand.sigma_t < inf):
        raise ValueError(f"c = {sand.c} and sigma_t = {sand.sigma_t} must be zero or more")
    check_void(sand.void, sand.c, sand.sigma_t)
    if sand.reversal not in (0, 1):
        raise ValueError(f"reversal = {sand.reversal} must be 0 or 1")
    if sand.reversal and sand.rate != "green_naghdi":
        raise ValueError(f"reversal=1 must have rate=green_naghdi, the material's own axes, not {sand.rate}")
