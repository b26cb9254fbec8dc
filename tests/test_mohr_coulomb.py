"""Mohr-Coulomb against Koiter's rule by enumeration, closest points, and closed forms of soil mechanics."""

from dataclasses import dataclass
from math import cos, inf, nan, radians, sin, tan
from typing import Any

import numpy as np
import pytest
from fixtures_plastic import (
    biaxial,
    eigenvalues,
    enumerated,
    excess,
    planes,
    region,
    respond,
    returned,
    simple_shear,
    stiffness,
    turned,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb, apex_of
from mpm_verify.solver.plugins import create
from mpm_verify.solver.state import Floats, Particles

COUNT = 10_000
BARE = {"elastic", "plane", "edge s1 = s2", "edge s2 = s3", "apex"}
CUT = BARE - {"apex"} | {
    "cut-off", "cut-off edge", "cut-off apex", "plane and cut-off", "corner s1 = s2", "corner s2 = s3"
}  # fmt: skip
LAWS = {  # parameters and the regions they have
    "paper": ({}, BARE),
    "associated": ({"psi": 31.0}, BARE),
    "cohesive": ({"psi": 10.0, "c": 2e3, "sigma_t": 1e9}, BARE),
    "cut": ({"c": 5e3, "sigma_t": 2e3}, CUT),
    "cut at zero": ({"c": 5e3}, CUT),
    "cut associated": ({"psi": 31.0, "c": 5e3, "sigma_t": 2e3}, CUT),
    "cut without dilation": ({"psi": 0.0, "c": 5e3, "sigma_t": 2e3}, CUT),
    "auxetic": ({"nu": -0.6, "phi": 60.0, "psi": 20.0, "c": 3e3, "sigma_t": 1e3}, CUT),
    "tresca": ({"phi": 0.0, "c": 2e3, "sigma_t": 1e9}, BARE - {"apex"}),
    "tresca cut": ({"phi": 0.0, "c": 2e3, "sigma_t": 1e3}, CUT),
    "tresca cut at zero": ({"phi": 0.0, "c": 2e3}, CUT),
}
every_law = pytest.mark.parametrize("name", LAWS)


def law_of(name: str) -> MohrCoulomb:
    return MohrCoulomb(**LAWS[name][0])


def random_trials(count: int = COUNT) -> Floats:
    return np.random.default_rng(3).uniform(-2e4, 1e4, (count, 3))


def planes_of(law: MohrCoulomb) -> int:
    """9, or 6 where the cut-off is at the apex or beyond, or beyond all of the trials."""
    return 6 if law.sigma_t >= min(apex_of(law.phi, law.c), 1e8) else 9


def difference(law: Any, trial: Floats) -> float:
    """Largest distance from Koiter's rule, as a share of the size of the trial stress."""
    exact, left = enumerated(law, trial, planes_of(law))
    assert left.max() < 1e-12
    size: float = (np.abs(returned(law, trial) - exact).max(axis=1) / np.abs(trial).max(axis=1)).max()
    return size


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)])
def test_reference_values(order: tuple[int, ...]) -> None:
    """Whichever of the three is zz."""
    trial = [(-1, -3, -9), (-1, -1.2, -9), (-1, -8, -9), (-0.2, -2, -9), (1, 0.5, -0.2)]
    values = [
        (-2.45429513, -3.03647977, -7.66730412),
        (-2.23265637, -2.23265637, -6.97489685),
        (-2.50600495, -7.82884742, -7.82884742),
        (-2.23265637, -2.23265637, -6.97489685),
        (0, 0, 0),
    ]
    law = MohrCoulomb(E=840.0)
    mine = returned(law, np.array(trial, dtype=float)[:, order])
    assert np.abs(mine - np.array(values)[:, order]).max() < 1e-8


@every_law
def test_koiter(name: str) -> None:
    """U2. Every state has one solution with the right signs, also at the apex where psi < phi; every region is hit."""
    law, trial = law_of(name), random_trials()
    assert difference(law, trial) < 1e-13
    sigma = returned(law, trial)
    assert excess(law, sigma)[np.abs(sigma - trial).max(axis=1) > 0].max() < 1e-13 * law.constants()[2] * 2e4
    hit, counts = np.unique(region(law, trial, sigma), return_counts=True)
    assert set(hit) == LAWS[name][1]
    assert counts.min() >= 3


@pytest.mark.parametrize("name", ["associated", "cut associated"])
def test_associated_is_the_closest_point(name: str) -> None:
    """(trial - s) . C (y - s) <= 0 for corners y of the admissible stresses, and for their directions to infinity."""
    law, trial = law_of(name), random_trials()
    sigma, k = returned(law, trial), (1 + sin(radians(31))) / (1 - sin(radians(31)))
    strain = (trial - sigma) @ np.linalg.inv(stiffness(law)) * law.E / 2e4
    rays = -np.array([[1, 1, k], [1, k, 1], [k, 1, 1], [1, k, k], [k, 1, k], [k, k, 1]])
    low = k * law.sigma_t - 2 * law.c * np.sqrt(k)
    corners = np.array([[law.sigma_t if bit & 1 << i else low for i in range(3)] for bit in range(1, 8)])
    assert (strain @ rays.T).max() < 1e-13
    towards = np.einsum("pi,pyi->py", strain, (corners - sigma[:, None]) / 2e4)
    assert towards.max() < 1e-13
    strain[:, 0] += 1e-9  # the check can fail
    assert (strain @ -np.eye(3)).max() > 0
    assert np.einsum("pi,pyi->py", strain, (corners - sigma[:, None]) / 2e4).max() > 1e-10


def test_projection_to_the_apex_without_dilation() -> None:
    """psi = 0: flow cannot change the pressure; beyond the apex, and only there, no flow leads back."""
    law, trial = MohrCoulomb(psi=0.0, c=2e3, sigma_t=1e9), random_trials()
    apex = law.c / tan(radians(law.phi))
    beyond = trial.mean(axis=1) > apex
    _, left = enumerated(law, trial, 6)
    assert np.array_equal(left > 1e-12, beyond)
    assert beyond.sum() > 300
    out, history = respond(law, np.column_stack([trial, np.zeros(COUNT)]))
    assert np.abs(out[beyond, :3] - apex).max() < 1e-13 * 2e4
    assert np.allclose(out[~beyond, :3].sum(axis=1), trial[~beyond].sum(axis=1), rtol=0, atol=1e-9)
    assert np.allclose(history[:, 1], (trial - out[:, :3]).sum(axis=1) * (1 - 2 * law.nu) / law.E, rtol=0, atol=1e-15)


def test_tresca() -> None:
    """phi = 0: s1 - s3 comes to 2 c to round-off at any pressure, the pressure stays, and nothing dilates."""
    law, trial = MohrCoulomb(phi=0.0, c=1e3, sigma_t=1e9), random_trials()
    assert law.psi == 0.0
    out, history = respond(law, np.column_stack([trial, np.random.default_rng(2).uniform(-1e4, 1e4, COUNT)]))
    first, _, last = eigenvalues(out).T
    yielding = history[:, 0] > 0
    assert yielding.sum() > COUNT / 2
    assert np.abs((first - last)[yielding] - 2e3).max() < 1e-12 * 2e4
    assert (first - last)[~yielding].max() < 2e3
    assert np.abs(out[:, :3].sum(axis=1) - trial.sum(axis=1)).max() < 1e-12 * 2e4
    assert np.abs(history[:, 1]).max() < 1e-15
    almost, _ = respond(MohrCoulomb(phi=1e-6, psi=0.0, c=1e3, sigma_t=1e9), np.column_stack([trial, 0 * trial[:, 0]]))
    assert np.abs(almost - respond(law, np.column_stack([trial, 0 * trial[:, 0]]))[0]).max() < 1e-2  # its limit
    assert np.isfinite(returned(law, np.array([[1e150, 0.0, -1e150], [3e12, 3e12, -3e12]]))).all()


@pytest.mark.parametrize("constant", range(2, 17))
def test_a_wrong_constant_is_seen(constant: int) -> None:
    """Each weight of the return, off by a millionth."""

    @dataclass(frozen=True)
    class Wrong(MohrCoulomb):
        def constants(self) -> Floats:
            values = super().constants()
            values[constant] *= 1 + 1e-6
            return values

    assert difference(Wrong(**LAWS["cut"][0]), random_trials(2000)) > 1e-9


def test_flow_in_the_direction_of_phi_is_seen() -> None:
    @dataclass(frozen=True)
    class Wrong(MohrCoulomb):
        def constants(self) -> Floats:
            return MohrCoulomb(psi=self.phi).constants()

    assert difference(Wrong(), random_trials(2000)) > 0.1


def test_zz_taken_for_intermediate_is_seen() -> None:
    """A return without the sort, by the plane of the two stresses in the plane, is right only where zz is between."""
    law, trial = MohrCoulomb(), -np.sort(-random_trials()[:, :2], axis=1)
    trial = np.column_stack([trial[:, 0], random_trials()[:, 2], trial[:, 1]])
    k, r = law.constants()[2], law.constants()[7:10]
    flat = trial - np.outer((k * trial[:, 0] - trial[:, 2]).clip(0), r)
    wrong = np.abs(flat - enumerated(law, trial, 6)[0]).max(axis=1) > 1e-9 * 2e4
    between = (flat[:, 0] >= flat[:, 1]) & (flat[:, 1] >= flat[:, 2])
    assert not wrong[between].any()
    assert wrong.sum() > COUNT / 3
    assert excess(law, flat[wrong]).max() > 1e3


def test_koiter_for_any_parameters() -> None:
    rng, worst = np.random.default_rng(9), 0.0
    for _ in range(60):
        phi, c = rng.uniform(3, 75), rng.choice([0.0, 3e3])
        law = MohrCoulomb(
            E=10 ** rng.uniform(3, 9), nu=rng.uniform(-0.9, 0.49), phi=phi, psi=rng.uniform(0.02, 1) * phi, c=c,
            sigma_t=rng.choice([0.0, 1e9, 0.5 * c / tan(radians(phi))]),
        )  # fmt: skip
        worst = max(worst, difference(law, random_trials(200)))
    assert worst < 1e-11


@every_law
def test_once_is_enough(name: str) -> None:
    law = law_of(name)
    once, history = respond(law, np.column_stack([random_trials(), np.random.default_rng(4).uniform(-1e4, 1e4, COUNT)]))
    twice, more = respond(law, once)
    assert np.abs(twice - once).max() < 1e-12 * 2e4
    assert history.max() > 1e-3
    assert np.abs(more).max() < 1e-12


@every_law
def test_the_frame_does_not_matter(name: str) -> None:
    """Turned before is turned after, and the history is the same: zz major, minor or between."""
    law, rng = law_of(name), np.random.default_rng(5)
    sigma = np.column_stack([random_trials(), rng.uniform(-1e4, 1e4, COUNT)])
    angle = rng.uniform(0, 2 * np.pi, COUNT)
    straight, kept = respond(law, sigma)
    askew, kept_askew = respond(law, turned(sigma, angle))
    assert np.abs(askew - turned(straight, angle)).max() < 1e-12 * 2e4
    assert np.abs(kept - kept_askew).max() < 1e-12 * kept.max()
    assert np.abs(askew - straight).max() > 1e3
    order = np.argsort(np.argsort(sigma[:, :3], axis=1), axis=1)[:, 2]
    assert np.bincount(order, minlength=3).min() > 1000


@every_law
def test_general_stress_by_its_eigenvalues(name: str) -> None:
    """Shear in the plane: principal stresses by LAPACK, returned; the same axes."""
    law, rng = law_of(name), np.random.default_rng(6)
    trial = np.column_stack([random_trials(), rng.uniform(-1e4, 1e4, COUNT)])
    out, _ = respond(law, trial)
    expected = -np.sort(-returned(law, eigenvalues(trial)), axis=1)
    assert np.abs(eigenvalues(out) - expected).max() < 1e-12 * 2e4
    across = (trial[:, 0] - trial[:, 1]) * out[:, 3] - (out[:, 0] - out[:, 1]) * trial[:, 3]
    assert np.abs(across).max() < 1e-12 * 4e8
    assert ((trial[:, 3] * out[:, 3]) > -1e-3).all()


def test_of_degree_one_without_cohesion() -> None:
    law, trial = MohrCoulomb(), random_trials()
    for factor in (2.0**40, 2.0**-60, 2.0**450, 2.0**-450):
        assert np.array_equal(returned(law, factor * trial), factor * returned(law, trial))
    cohesive = MohrCoulomb(c=1e3)
    assert np.abs(returned(cohesive, 2 * trial) - 2 * returned(cohesive, trial)).max() > 1e2


@every_law
def test_history(name: str) -> None:
    """gamma_p and eps_v_p are largest difference and sum of C (trial - sigma), whatever the strain that led there."""
    law, rng = law_of(name), np.random.default_rng(7)
    start = respond(law, np.column_stack([random_trials(), np.zeros(COUNT)]))[0]
    de = rng.uniform(-2e-2, 2e-2, (COUNT, 3))
    trial = start + 2 * law.mu * np.column_stack([de[:, :2], np.zeros(COUNT), de[:, 2]])
    trial[:, :3] += law.lam * de[:, :2].sum(axis=1, keepdims=True)
    out, history = respond(law, start, de)
    plastic = eigenvalues(trial - out)
    assert np.abs(history[:, 0] - (plastic[:, 0] - plastic[:, 2]) / (2 * law.mu)).max() < 1e-14
    assert np.abs(history[:, 1] - plastic.sum(axis=1) * (1 - 2 * law.nu) / law.E).max() < 1e-14
    assert history[:, 0].max() > 1e-2
    assert (history[:, 0] >= 0).all()
    assert history[:, 1].min() >= -1e-16  # no region contracts


@pytest.mark.parametrize("psi", [0.0, 1.0, 31.0])
def test_davis(psi: float) -> None:
    """U3. Simple shear under constant s_yy: tau/|s_yy| = sin phi cos psi/(1 - sin phi sin psi), tan phi for psi = phi.

    The volume grows by tan psi. With dilation the ratio is approached exponentially in G gamma/p0; without it, from
    isotropic stress, it is there at the first yield.
    """
    s, flow = sin(radians(31)), radians(psi)
    exact = s * cos(flow) / (1 - s * sin(flow))
    expected = {0.0: s, 1.0: 0.5196304100, 31.0: tan(radians(31))}[psi]
    assert exact == pytest.approx(expected, abs=1e-10)
    ratio, dilation = simple_shear(MohrCoulomb(psi=psi), 840.0, 0.2, 100)
    assert ratio == pytest.approx(exact, abs=1e-12)
    assert dilation == pytest.approx(tan(flow), abs=1e-11)
    early, _ = simple_shear(MohrCoulomb(psi=psi), 8400.0, 0.1, 100)
    assert abs(exact - early) < 1e-12 if psi == 0 else 1e-5 < exact - early < 1e-3


def test_drained_biaxial_compression() -> None:
    """Elastic to (k - 1) p0 (1 - nu^2)/E, then constant stress and de_xx = -m de_yy; zz stays between."""
    law, p0 = MohrCoulomb(), 1e4
    k, m = ((1 + sin(radians(angle))) / (1 - sin(radians(angle))) for angle in (31, 1))
    at_yield = (k - 1) * p0 * (1 - law.nu**2) / law.E
    sigma, ratio = biaxial(law, p0, 2 * at_yield, 100)
    elastic = np.arange(1, 101) * 2 * at_yield / 100 < at_yield * (1 - 1e-9)
    assert elastic.sum() == 49
    assert np.abs(sigma[49:, 1] + k * p0).max() < 1e-9 * p0
    assert sigma[48, 1] == pytest.approx(-p0 - 0.98 * (k - 1) * p0, rel=1e-10)
    assert np.abs(ratio[:49] - law.nu / (1 - law.nu)).max() < 1e-9
    assert np.abs(ratio[50:] - m).max() < 1e-9
    assert m == pytest.approx(1.03552, abs=1e-5)
    assert np.ptp(sigma[50:, 2]) < 1e-8
    assert p0 < -sigma[-1, 2] < k * p0


def test_a_column_at_rest_stays_elastic() -> None:
    """Uniaxial strain: s_h/s_v = nu/(1 - nu), s_v/s_h below k; with phi below asin(1 - 2 nu) it is not."""
    law, sigma = MohrCoulomb(), np.zeros((1, 4))
    history = np.zeros((1, len(law.memory)))
    for _ in range(50):
        sigma, history = respond(law, sigma, np.array([[0, -1e-3, 0]]))
        assert not history.any()
    assert sigma[0, 0] / sigma[0, 1] == pytest.approx(0.3 / 0.7, rel=1e-14)
    assert sigma[0, 2] == sigma[0, 0]
    assert respond(MohrCoulomb(phi=23.0), sigma)[1].any()
    assert not respond(MohrCoulomb(phi=24.0), sigma)[1].any()


def test_a_rigid_rotation_of_a_failing_particle() -> None:
    """Through the objective rate: stress turns along, and nothing flows."""
    law, count, turns = MohrCoulomb(), 64, 40
    p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
    p.sigma = respond(law, np.column_stack([random_trials(count), np.full(count, 3e3)]))[0]
    before = p.sigma.copy()
    law.start(p)
    for step in range(1, turns + 1):
        angle = step / turns * np.pi / 3
        p.F[:] = [[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]
        law.update(p, 1.0)
    assert np.abs(p.sigma - turned(before, np.full(count, np.pi / 3))).max() < 1e-11 * 2e4
    assert np.abs(p.history).max() < 1e-13
    assert p.history.shape == (count, len(law.memory))


@pytest.mark.parametrize("psi", [0.0, 1.0, 31.0])
@pytest.mark.parametrize("sigma_t", [0.0, 1e3, 1e9])
def test_special_states(psi: float, sigma_t: float) -> None:
    """No stress, the apex, equal principal stresses, and what is not admissible by one of them."""
    law = MohrCoulomb(psi=psi, c=2e3, sigma_t=sigma_t)
    top = min(sigma_t, law.c / tan(radians(31)))
    values = np.array([0.0, top, -1e4, 3e4, 1e150, -1e150, 1e-150])
    trial = np.array(np.meshgrid(values, values, values)).reshape(3, -1).T
    sigma = returned(law, trial)
    assert np.isfinite(sigma).all()
    assert (excess(law, sigma) <= 1e-13 * np.maximum(np.abs(trial).max(axis=1), 1e4)).all()
    assert np.array_equal(returned(law, np.zeros((1, 3))), np.zeros((1, 3)))
    assert np.abs(returned(law, np.full((1, 3), top)) - top).max() < 1e-12 * 2e3
    assert np.abs(returned(law, np.full((1, 3), 1e6)) - top).max() < 1e-12 * 2e3
    for i, j in ((0, 1), (0, 2), (1, 2)):
        equal = trial[:, i] == trial[:, j]
        assert (np.abs(sigma[equal, i] - sigma[equal, j]) <= 1e-15 * np.abs(trial[equal]).max(axis=1)).all()


numbers = st.one_of(
    st.floats(-3e4, 3e4), st.sampled_from([0.0, 1.0, -1e4, 1e-150, -1e-150, 1e150, -1e150]), st.floats(-1e150, 1e150)
)
parameters = st.fixed_dictionaries(
    {
        "E": st.floats(1e-3, 1e12),
        "nu": st.floats(-0.95, 0.495),
        "phi": st.floats(0.5, 85),
        "share": st.floats(0, 1),
        "c": st.one_of(st.just(0.0), st.floats(1e-3, 1e6)),
        "sigma_t": st.one_of(st.just(0.0), st.floats(1e-3, 1e6)),
    }
)
search = settings(deadline=None, max_examples=300, derandomize=True, database=None)


def law_from(values: dict[str, float]) -> MohrCoulomb:
    rest = dict(values)
    share = rest.pop("share")
    return MohrCoulomb(psi=min(share * rest["phi"], rest["phi"]), **rest)


@search
@given(parameters, st.tuples(numbers, numbers, numbers, numbers), st.booleans())
def test_whatever_comes(values: dict[str, float], state: tuple[float, ...], tie: bool) -> None:
    """Admissible, finite, and the same again, in units of k times the largest stress there is."""
    law, sigma = law_from(values), np.array([state])
    if tie:
        sigma[0, 2] = sigma[0, 1]
    out, history = respond(law, sigma)
    k = law.constants()[2]
    scale = max(np.abs(sigma).max(), law.c, 1e-3)
    assert np.isfinite(out).all()
    assert np.isfinite(history).all()
    assert excess(law, eigenvalues(out))[0] <= 1e-13 * k * k * scale
    assert np.abs(respond(law, out)[0] - out).max() <= 1e-13 * k * k * scale
    assert history[0, 0] >= -1e-13 * scale / law.mu


@search
@given(parameters, st.tuples(*[st.one_of(numbers, st.sampled_from([nan, inf, -inf]))] * 4))
def test_what_is_lost_stays_lost(values: dict[str, float], state: tuple[float, ...]) -> None:
    law = law_from(values)
    out, _ = respond(law, np.array([state]))
    assert np.isfinite(out).all() == np.isfinite(state).all()


@pytest.mark.parametrize("component", range(3))
@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_a_lost_strain_is_not_hidden(component: int, value: float) -> None:
    de = np.zeros((1, 3))
    de[0, component] = value
    for name in LAWS:
        assert not np.isfinite(respond(law_of(name), np.array([[-1e4, -2e4, -1e4, 1e3]]), de)[0]).all()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("phi=0", "phi = 0 must have c above zero, its strength"),
        ("phi=0,c=1,psi=5", "psi = 5.0 must lie between 0 and phi = 0.0"),
        ("phi=90", "phi = 90.0 must be at least 0 and below 90"),
        ("phi=-5", "phi = -5.0 must be at least 0 and below 90"),
        ("psi=31.5", "psi = 31.5 must lie between 0 and phi = 31.0"),
        ("psi=-1", "psi = -1.0 must lie between 0 and phi"),
        ("c=-1", "c = -1.0 must be zero or more"),
        ("sigma_t=-1", "sigma_t = -1.0 must be zero or more"),
        ("nu=0.5", "nu = 0.5 must lie between"),
        ("E=-1", "must be above zero"),
        ("rho0=0", "must be above zero"),
        ("c=inf", "must be a finite number"),
        ("phi=nan", "must be a finite number"),
        ("rate=none", "choose from"),
    ],
)
def test_bad_parameters(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        create("mpm_verify.solver.material", f"mohr_coulomb:{text}")


@pytest.mark.parametrize("name", ["E", "nu", "rho0", "phi", "psi", "c", "sigma_t"])
@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_parameters_that_are_no_numbers(name: str, value: float) -> None:
    with pytest.raises(ValueError, match="must"):
        MohrCoulomb(**{name: value})


@pytest.mark.parametrize("phi", [1e-300, 1e-9, 89.9, 90 - 1e-13])
def test_the_ends_of_phi(phi: float) -> None:
    """Nearly no friction, and nearly nothing but it: still finite, and without a division by zero."""
    for psi in (0.0, phi):
        for c in (0.0, 1e3):
            assert np.isfinite(returned(MohrCoulomb(phi=phi, psi=psi, c=c, sigma_t=5.0), random_trials(100))).all()


def test_defaults_are_those_of_the_column() -> None:
    law = MohrCoulomb()
    assert (law.E, law.nu, law.rho0, law.phi, law.psi, law.c, law.sigma_t) == (840e3, 0.3, 2650, 31, 1, 0, 0)
    assert law.memory == ("gamma_p", "eps_v_p", "void")
    assert planes(law)[0].shape == (9, 3)
    assert law.wave_speed() == pytest.approx(20.657, abs=1e-3)


# ---- dilation that ends


def test_dilation_ends_at_its_plastic_shear() -> None:
    """Shear of constant volume: bits of psi without an end until then, then none; gamma_cv (m - 1)/(m + 1) in all."""
    usual, ending = MohrCoulomb(psi=10.0), MohrCoulomb(psi=10.0, gamma_cv=0.02)
    m, steps = 1 / tan(radians(40.0)) ** 2, 2000
    paths = {}
    for one in (usual, ending):
        sigma, history, rows = np.array([-5e3, -5e3, -5e3, 0.0]), np.zeros(3), []
        for _ in range(steps):
            de = np.array([1.0, -1.0, 0.0]) * 2e-5
            one.respond(one.constants(), sigma, de, history)
            rows.append([*sigma, *history])
        paths[one] = np.array(rows)
    first, last = paths[usual], paths[ending]
    before = first[:, 4] < 0.02
    at = int(before.sum()) + 1  # the step that reaches it flows as before
    assert 0 < at < steps / 2
    assert first[:at].tobytes() == last[:at].tobytes()
    assert np.ptp(last[at:, 5]) < 1e-14
    assert last[-1, 4] > 0.03
    assert last[-1, 5] == pytest.approx((m - 1) / (m + 1) * 0.02, abs=(m - 1) / (m + 1) * 5e-5)
    assert np.ptp(first[at:, 5]) > 1e-3  # without an end it goes on


def test_after_its_end_it_is_psi_zero() -> None:
    """Random trial stresses: bits of psi = 0 from gamma_cv on, those of psi below it."""
    trial, none = random_trials(200), MohrCoulomb(psi=0.0)
    usual, ending = MohrCoulomb(psi=10.0), MohrCoulomb(psi=10.0, gamma_cv=0.1)
    for slipped, like in ((0.1, none), (0.3, none), (0.0999, usual)):
        both = []
        for one in (ending, like):
            sigma = np.column_stack([trial, np.zeros(len(trial))]).ravel()
            history = np.tile([slipped, 0.0, 0.0], len(trial))
            one.respond(one.constants(), sigma, np.zeros(3 * len(trial)), history)
            both.append((sigma.tobytes(), history.tobytes()))
        assert both[0] == both[1]


@pytest.mark.parametrize("value", [0.0, -1.0, nan])
def test_an_end_before_the_start_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match="psi=0 is what does not dilate at all"):
        MohrCoulomb(gamma_cv=value)
