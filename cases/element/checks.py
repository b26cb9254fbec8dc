"""Checks of each material beyond curves: tables, limits and invariants, with what they are held against."""

from collections.abc import Callable
from dataclasses import replace
from math import cos, exp, inf, radians, sin, tan
from typing import Any

import numpy as np

from mpm_verify.cases.element import ubcsand_exact as ubc
from mpm_verify.cases.element.curves import columns
from mpm_verify.cases.element.element import Element
from mpm_verify.cases.element.following import Followed, follow
from mpm_verify.cases.element.paths import TESTS
from mpm_verify.cases.harness.checks import Check
from mpm_verify.mms.constitutive.driver import Subject
from mpm_verify.mms.constitutive.history import tests as tests_of_memory
from mpm_verify.mms.constitutive.stress import tests as tests_of_stress
from mpm_verify.mms.constitutive.tested import Part
from mpm_verify.solver.material.drucker_prager import DruckerPrager
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb, slope
from mpm_verify.solver.material.ubcsand import MEMORY, Ubcsand
from mpm_verify.solver.state import Floats

TIMES_J = ("hencky", "hencky_rate")  # whose Kirchhoff stress is linear in the logarithmic strain
TABLE, FORM = "reference table", "closed form"
GROUPS: dict[str, str] = {
    Part.STRESS: "Stress to round-off",
    Part.RATE: "Turned paths, to round-off",
    Part.HISTORY: "Memory, to round-off",
    Part.CUT_OFF: "Stress to round-off",
    Part.TIME_STEP: "Stress to round-off",
}
RETURNS = (  # trial stress -> stress: E = 840, nu = 0.3, phi = 31, psi = 1, c = 0, in any unit
    ((-1.0, -3.0, -9.0), (-2.45429513, -3.03647977, -7.66730412), "plane"),
    ((-1.0, -1.2, -9.0), (-2.23265637, -2.23265637, -6.97489685), "edge of the first two"),
    ((-1.0, -8.0, -9.0), (-2.50600495, -7.82884742, -7.82884742), "edge of the last two"),
    ((-0.2, -2.0, -9.0), (-2.23265637, -2.23265637, -6.97489685), "edge of the first two, outside"),
    ((1.0, 0.5, -0.2), (0.0, 0.0, 0.0), "apex"),
)


def material_checks(material: Any) -> list[Check]:
    """Checks of this material: what any must keep to round-off, and what is known of this one."""
    return [*exact(material), *(CHECKS[material.name](material) if material.name in CHECKS else [])]


def exact(material: Any) -> list[Check]:
    """Checks to round-off: F without symmetry and turned, zz, moduli, and what the memory sums."""
    subject = Subject(material)
    return [
        Check(GROUPS[one.points_to], one.name, one.residual, one.bound, "at_most", "round-off")
        for one in (*tests_of_stress(subject), *tests_of_memory(subject))
        if not one.reason
    ]


def run(material: Any, name: str, length: float, stress: float, steps: int = 100) -> Followed:
    """Run an element test of another length, from an isotropic stress, compression positive."""
    test = replace(TESTS[name], length=length, loose=1.0)
    return follow(Element(material), test, steps, np.array([-stress, -stress, -stress, 0.0]))


def elastic(material: Any) -> list[Check]:
    """Checks of uniaxial strain: M ln(stretch), of a Hencky solid for J sigma, and K0, from nothing."""
    M, K0 = material.lam + 2 * material.mu, material.nu / (1 - material.nu)
    end = run(material, "oedometric", 0.1, 0.0).sigma[-1] * exp(-0.1 * (material.name in TIMES_J))
    group = "Linear elasticity"
    return [
        Check(group, "vertical stress over M at a strain of -0.1", end[1] / M, -0.1, "relative", FORM, 1e-12),
        Check(group, "K0", end[0] / end[1], K0, "absolute", FORM, 1e-12),
    ]  # fmt: skip


def davis_ratio(material: Any) -> float | None:
    """Shear over vertical stress of simple shear at failure (Davis 1968); None where the material has another."""
    if not material.fails_as_mohr_coulomb or material.cohesion:
        return None
    sf, sp = sin(radians(material.phi)), sin(radians(material.psi))
    return float(sf * cos(radians(material.psi)) / (1 - sf * sp))


def at_failure(material: Any, slipped: float) -> Any:
    """Material that flows as this one does after a plastic shear: without dilation from gamma_cv on."""
    ended = slipped >= getattr(material, "gamma_cv", inf)
    return replace(material, psi=0.0, gamma_cv=inf) if ended else material


def davis(material: Any) -> list[Check]:
    """Checks of simple shear at failure, under constant vertical stress: stress ratio and dilation, where known."""
    ratio = davis_ratio(material)
    if ratio is None:
        return []
    stress = 1e-6 * material.E  # far below the stiffness: then the last bit of elastic strain is gone soon
    found = run(material, "shear_stress", 0.1, stress, 400)
    material = at_failure(material, found.history[-40, 0])
    ratio = davis_ratio(material) or ratio
    before, after = columns(TESTS["shear_stress"], replace(found)), found.strain
    grown = (after[-1, 1] - after[-40, 1]) / (2 * (after[-1, 2] - after[-40, 2]))
    group = "Simple shear at failure"
    return [
        Check(group, "shear over vertical stress", before["tau"][-1] / stress, ratio, "absolute", "Davis (1968)", 1e-6),
        Check(
            group,
            "dilation, vertical strain over shear",
            grown,
            tan(radians(material.psi)),
            "absolute",
            "tan psi",
            1e-6,
        ),
    ]


def frictionless(material: Any) -> list[Check]:
    """Checks of phi = 0: simple shear ends at the cohesion, that of the compression cone at 2 / sqrt(3) of it; no apex.

    So an isotropic tension of ten times the cohesion, or at the cut-off if that is lower, stays as it is.
    """
    if material.friction_angle != 0:
        return []
    known = 2 / np.sqrt(3) if getattr(material, "cone", "") == "compression" else 1.0
    end = run(material, "shear_stress", 8 * material.c / material.mu, 10 * material.c)
    found = float(end.sigma[-1, 3]) / material.c
    tension = min(10 * material.c, getattr(material, "sigma_t", np.inf))
    sigma = np.array([tension, tension, tension, 0.0])
    material.respond(material.constants(), sigma, np.zeros(3), np.zeros(len(material.memory)))
    moved = float(np.abs(sigma[:3] - tension).max()) / material.c
    return [
        Check("Simple shear at failure", "shear stress over cohesion, phi = 0", found, known, "absolute", FORM, 1e-12),
        Check("Returns", "isotropic tension that changes, over cohesion, phi = 0", moved, 0.0, "absolute", FORM, 0.0),
    ]


def mohr_coulomb(material: MohrCoulomb) -> list[Check]:
    """Checks of Mohr-Coulomb: returns of the table where the angles are its own, Davis' ratio, both sides of yield."""
    found = (
        returns(material)
        if (material.phi, material.psi, material.nu, material.c, material.sigma_t) == (31, 1, 0.3, 0, 0)
        else []
    )
    stress, k = 5e3, slope(material.phi)
    strong = k * stress + 2 * material.c * np.sqrt(k)
    yields = (strong - stress) * (1 - material.nu**2) / material.E
    end = run(material, "biaxial", 4 * yields, stress)
    if end.failed:
        return found
    rate = (end.strain[-1] - end.strain[-20])[:2]
    m = slope(at_failure(material, end.history[-20, 0]).psi)
    group, K0 = "Biaxial compression and K0", material.nu / (1 - material.nu)
    just = run(material, "biaxial", yields * (1 - 1e-6), stress).history[-1, 0]
    found += [
        Check(group, "vertical stress at failure", -end.sigma[-1, 1], strong, "relative", FORM, 1e-10),
        Check(group, "plastic shear strain just before the yield strain", just, 0.0, "absolute", FORM, 1e-12),
        Check(group, "lateral over vertical strain at failure", rate[0] / rate[1], -m, "relative", FORM, 1e-9),
    ]  # fmt: skip
    if K0 * k > 1:
        slid = run(material, "oedometric", 0.01, 1.0).history[-1, 0]
        found.append(Check(group, "plastic strain of an elastic K0 state", slid, 0.0, "absolute", "K0 k > 1", 0.0))
    return found + davis(material) + frictionless(material)


def returns(material: MohrCoulomb) -> list[Check]:
    """Checks of returns: a stress outside each region, zz in each position; de = 0 leaves only the return."""
    checks, none = [], np.zeros(3)
    for trial, exact, region in RETURNS:
        worst = 0.0
        for order in ((0, 1, 2), (1, 2, 0), (0, 2, 1)):  # which of the three stand in xx, yy, zz
            sigma = np.array([*(trial[i] for i in order), 0.0])
            material.respond(material.constants(), sigma, none.copy(), np.zeros(len(material.memory)))
            worst = float(np.max([worst, *(abs(sigma[at] - exact[i]) for at, i in enumerate(order))]))
        checks.append(
            Check("Returns", f"{region}: largest miss, zz in any position", worst, 0.0, "absolute", TABLE, 1e-8)
        )
    return checks


def drucker_prager(material: DruckerPrager) -> list[Check]:
    """Checks of Drucker-Prager: the cone matched in plane strain fails as Mohr-Coulomb does, in steady shear."""
    return davis(material) + frictionless(material)


def ubcsand(material: Ubcsand) -> list[Check]:
    """Checks of UBCSAND: tables where the parameters are those of Table 2, else closed forms; failure, work, bounds."""
    if material.c or not material.Rf:
        return []
    return [*constant_s(material), *biaxial(material), *oedometric(material), *invariants(material)]


def constant_s(material: Ubcsand) -> list[Check]:
    """Checks at constant s: ratio, plastic shear and plastic volume after the tabulated strain, 100 steps."""
    checks, usual, group = [], material == Ubcsand(), "Shear at constant s"
    for s, ratio, gamma, volume, _ in ubc.CONSTANT_S:
        eta = ratio or material.eta_f
        if eta > material.eta_f:
            continue
        slip, shrunk = ubc.plastic_shear(material, s, eta), ubc.plastic_volume(material, s, eta)
        end = run(material, "constant_s", slip + ubc.elastic_shear(material, s, eta), s).history[-1]
        at = f"s = {s / 1e3:g} kPa, eta = {eta:.3g}"
        wanted = (eta, gamma, volume) if usual else (eta, slip, shrunk)
        for what, found, expected in zip(("eta", "plastic shear", "contraction"), (end[0], end[1], -end[2]), wanted,
                                         strict=True):  # fmt: skip
            within = 1e-6 if usual else 1e-3 * expected  # other numbers may take much longer strains
            checks.append(
                Check(group, f"{what} at {at}", found, expected, "absolute", TABLE if usual else FORM, within)
            )
    reached = run(material, "constant_s", 0.02, 5e3).history[-1, 0]
    known = ubc.ETA_AT_TWO_PERCENT if usual else ubc.ratio_at(material, 5e3, 0.02)
    return [*checks, Check(group, "eta at 5 kPa and a shear of 2 %", reached, known, "absolute", FORM, 1e-6)]


def biaxial(material: Ubcsand) -> list[Check]:
    """Checks of biaxial compression: ratio and lateral strain at the tabulated vertical strain, peak and flow there."""
    checks, usual, group = [], material == Ubcsand(), "Drained biaxial compression at 5 kPa"
    for eta, _, gamma, volume, *_ in ubc.BIAXIAL:
        if eta >= material.eta_f:
            continue
        shear, shrunk = (gamma, volume) if usual else ubc.biaxial(material, 5e3, eta)
        end = run(material, "biaxial", (shrunk + shear) / 2, 5e3)
        source = TABLE if usual else "quadrature"
        checks.append(
            Check(group, f"eta at the strain of eta = {eta}", end.history[-1, 0], eta, "absolute", source, 1e-6)
        )
        lateral = -end.strain[-1, 0]
        checks.append(
            Check(group, f"lateral strain there ({eta})", lateral, (shrunk - shear) / 2, "absolute", source, 1e-6)
        )
    end = run(material, "biaxial", 4 * (ubc.plastic_shear(material, 5e3, material.eta_f) + 0.01), 5e3, 800)
    peak = end.sigma[-1, 1] / end.sigma[-1, 0]
    gone = end.history[-1] - end.history[-10]
    f = material.eta_f
    return [
        *checks,
        Check(group, "stress ratio at failure", peak, (1 + f) / (1 - f), "relative", "(1 + eta_f)/(1 - eta_f)", 1e-9),
        Check(group, "dilation at failure", gone[2] / gone[1], f - material.eta_cv, "absolute", "eta_f - eta_cv", 1e-9),
    ]  # fmt: skip


def oedometric(material: Ubcsand) -> list[Check]:
    """Checks of oedometric loading: K0, ratio and strain from a nearly stress-free state, for Table 2 alone."""
    if material != Ubcsand():
        return []
    found = run(material, "oedometric", 0.009, 50.0, 2000)
    vertical, checks = -found.sigma[:, 1], []
    for stress, K0, eta, strain in ubc.OEDOMETRIC:
        for what, values, expected, within in (
            ("K0", found.sigma[:, 0] / found.sigma[:, 1], K0, 1e-3), ("eta", found.history[:, 0], eta, 1e-3),
            ("strain", -found.strain[:, 1], strain, 1e-5),
        ):  # fmt: skip
            at = float(np.interp(stress, vertical, values))
            checks.append(Check("Oedometric loading from 50 Pa", f"{what} at {stress / 1e3:g} kPa", at, expected,
                                "absolute", "table to three digits", within))  # fmt: skip
    return checks


def invariants(material: Ubcsand) -> list[Check]:
    """Checks of invariants: no random strain passes the strength or lets plastic work fall; the work's closed form."""
    group, element = "Invariants", Element(material)
    worked, rng = MEMORY.index("work_p"), np.random.default_rng(1)  # a walk that spends most of its steps at failure
    state = element.start(np.array([-5e3, -5e3, -5e3, 0.0]))
    over, fall = -np.inf, -np.inf
    for move in rng.normal(0, 2e-4, (2000, 3)) - (2e-5, 2e-5, 0):
        before, state = state, element.step(state, move[None])[0]
        over = float(np.maximum(over, excess(material, state.sigma)))  # max() would lose a NaN
        fall = float(np.maximum(fall, before.history[worked] - state.history[worked]))
    end = run(material, "constant_s", 0.06, 5e3).history[-1]
    work = end[worked] / (5e3 * material.eta_cv * end[MEMORY.index("gamma_p")])
    return [
        Check(group, "largest t - s sin(phi_f) over s, 2000 random steps", over, 1e-12, "at_most", "strength"),
        Check(group, "largest fall of the plastic work", fall, 0.0, "at_most", "dissipation"),
        Check(group, "plastic work over s sin(phi_pt) gamma_p", work, 1.0, "absolute", "Taylor's work equation", 1e-5),
    ]


def excess(material: Ubcsand, sigma: Floats) -> float:
    """Excess of a stress over the strength, over s."""
    s = -(sigma[0] + sigma[1]) / 2
    return -np.inf if s <= 0 else float((np.hypot((sigma[0] - sigma[1]) / 2, sigma[3]) - material.eta_f * s) / s)


# By the name of the material.
CHECKS: dict[str, Callable[[Any], list[Check]]] = {
    "hencky": elastic,
    "hencky_rate": elastic,
    "hypoelastic": elastic,
    "mohr_coulomb": mohr_coulomb,
    "drucker_prager": drucker_prager,
    "ubcsand": ubcsand,
}
