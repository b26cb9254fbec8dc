"""UBCSAND against its closed forms, tables and invariants; the schemes that it is not are seen by the same checks."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mpm_verify.cases.element.checks import excess
from mpm_verify.cases.element.element import Element, State
from mpm_verify.cases.element.ubcsand_exact import (
    BIAXIAL,
    CONSTANT_S,
    ETA_AT_TWO_PERCENT,
    OEDOMETRIC,
    biaxial,
    elastic_shear,
    isotropic,
    plastic_shear,
    plastic_volume,
    ratio_at,
)
from mpm_verify.solver.material.ubcsand import MEMORY, Ubcsand, out_of_range
from mpm_verify.solver.plugins import create
from mpm_verify.solver.state import Floats

LAW = Ubcsand()
ETA, GAMMA, VOLUME, WORK, TURNS, DETACHED = range(6)


def confined(s: float, t: float = 0.0, angle: float = 0.0) -> Floats:
    """Stress of centre s and radius t, compression positive, its axes turned."""
    return np.array([-s + t * np.cos(angle), -s - t * np.cos(angle), -s, t * np.sin(angle)])


def at_constant_s(law: Ubcsand, s: float, gamma: float, steps: int) -> State:
    """Shear eps_1 - eps_3 = gamma, compressed along y, with s held."""
    element, d = Element(law), gamma / steps
    state = element.start(confined(s))
    for _ in range(steps):
        state = element.solve(
            state,
            lambda de, end: np.array([de[0] - de[1] - d, -(end.sigma[0] + end.sigma[1]) / 2 - s, de[2]]),
            np.array([d / 2, -d / 2, 0]),
            np.array([d, s, d]),
        )
    return state


def drained(law: Ubcsand, s3: float, e1: float, steps: int) -> State:
    """Biaxial compression along y by e1 at constant lateral stress."""
    element, d = Element(law), e1 / steps
    state = element.start(confined(s3))
    for _ in range(steps):
        state = element.solve(
            state,
            lambda de, end: np.array([de[1] + d, end.sigma[0] + s3, de[2]]),
            np.array([d / 2, -d, 0]),
            np.array([d, s3, d]),
        )
    return state


def followed(law: Ubcsand, start: Floats, increments: Floats) -> list[State]:
    """States along given strain increments (N,3), the first one included."""
    element = Element(law)
    states = [element.start(start)]
    for increment in increments:
        states.append(element.step(states[-1], increment[None])[0])
    return states


def orders(errors: list[float]) -> Floats:
    """Between halved steps."""
    return np.array([np.log2(a / b) for a, b in pairwise(errors)])


@pytest.mark.parametrize(("s", "eta", "gamma", "volume", "elastic"), CONSTANT_S)
def test_table_of_constant_s(s: float, eta: float | None, gamma: float, volume: float, elastic: float) -> None:
    """The closed forms give the table, and 100 steps give the closed forms to 1e-6."""
    wanted = eta or LAW.eta_f
    exact = plastic_shear(LAW, s, wanted), plastic_volume(LAW, s, wanted), elastic_shear(LAW, s, wanted)
    np.testing.assert_allclose(exact, (gamma, volume, elastic), rtol=0, atol=6e-7)
    assert exact[0] == pytest.approx(gamma, abs=6e-9)
    end = at_constant_s(LAW, s, exact[0] + exact[2], 100)
    assert end.history[ETA] == pytest.approx(wanted, abs=1e-6)
    assert end.history[GAMMA] == pytest.approx(exact[0], abs=1e-6)
    assert -end.history[VOLUME] == pytest.approx(exact[1], abs=1e-6)


def test_order_in_the_step() -> None:
    """Total shear of 2 % at 5 kPa: at least second order, here the fourth."""
    assert ratio_at(LAW, 5e3, 0.02) == pytest.approx(ETA_AT_TWO_PERCENT, abs=1e-10)
    errors = [abs(at_constant_s(LAW, 5e3, 0.02, n).history[ETA] - ETA_AT_TWO_PERCENT) for n in (5, 10, 20, 40)]
    assert errors[0] < 1e-4
    assert errors[-1] < 1e-6
    assert (orders(errors) > 1.9).all()


def test_order_with_turning_axes() -> None:
    """Simple shear with some compression, whose principal axes turn: second order too, which a radial return is not."""
    ends = [followed(LAW, confined(5e3), np.tile([0, -2e-3 / n, 0.01 / n], (n, 1)))[-1] for n in (25, 50, 100, 1600)]
    errors = [np.abs(end.sigma - ends[-1].sigma).max() / 5e3 for end in ends[:-1]]
    assert errors[-1] < 1e-4
    assert (orders(errors) > 1.9).all()


def one_pass(law: Ubcsand, gamma: float, s: float, steps: int) -> float:
    """eta by the plastic modulus at the start of each step, linearised: what the midpoint scheme is not."""
    a, k, eta = law.Rf / law.eta_f, law.KGp * (s / law.Pa) ** (law.np - 1), 0.0
    G = law.moduli(s)[0]
    for _ in range(steps):
        rate = k * (1 - a * eta) ** 2
        eta += rate * (gamma / steps) * G / (G + s * rate)
    return eta


def test_a_linearised_step_is_seen() -> None:
    """First order: the check of the order above would not pass it."""
    errors = [abs(one_pass(LAW, 0.02, 5e3, n) - ETA_AT_TWO_PERCENT) for n in (50, 100, 200, 400)]
    np.testing.assert_allclose(orders(errors), 1, atol=0.1)
    assert 1e-3 < errors[0] < 3e-3


@pytest.mark.parametrize(("eta", "s1", "gamma", "volume", "e1", "e3"), BIAXIAL)
def test_drained_biaxial(eta: float, s1: float, gamma: float, volume: float, e1: float, e3: float) -> None:
    """Quadrature gives the table, 100 steps give it to 1e-6, at second order."""
    np.testing.assert_allclose(biaxial(LAW, 5e3, eta), (gamma, volume), rtol=0, atol=1e-10)
    ends = [drained(LAW, 5e3, e1, steps) for steps in (50, 100, 200)]
    assert ends[1].history[ETA] == pytest.approx(eta, abs=1e-6)
    assert -ends[1].strain[0] == pytest.approx(e3, abs=1e-6)
    assert -ends[1].sigma[1] == pytest.approx(s1, rel=2e-6)
    if eta > 0.1:  # a small one is at the end of the table's digits
        assert (orders([abs(end.history[ETA] - eta) for end in ends]) > 1.9).all()


def test_peak_and_flow_at_failure() -> None:
    """sigma1/sigma3 = (1 + eta_f)/(1 - eta_f), and d eps_v/d gamma_p = eta_f - eta_cv, dilation of 0.0857 degrees."""
    a = drained(LAW, 5e3, 0.12, 200)
    assert a.sigma[1] / a.sigma[0] == pytest.approx(3.13679, abs=1e-5)
    b = Element(LAW).step(a, np.array([[1e-3, -1e-3, 0.0]]))[0]
    flow = (b.history[VOLUME] - a.history[VOLUME]) / (b.history[GAMMA] - a.history[GAMMA])
    assert flow == pytest.approx(LAW.eta_f - LAW.eta_cv, rel=1e-9)
    assert np.degrees(np.arcsin(flow)) == pytest.approx(0.0857, abs=1e-4)


def test_isotropic_compression_is_elastic() -> None:
    """ds = (K + G/3) d eps_v, no plastic strain, second order."""
    ends = [followed(LAW, confined(50.0), np.tile([-1e-3 / n, -1e-3 / n, 0], (n, 1)))[-1] for n in (200, 400, 800)]
    exact = isotropic(LAW, 50.0, 2e-3)
    errors = [abs(-end.sigma[0] / exact - 1) for end in ends]
    assert errors[-1] < 1e-4
    np.testing.assert_allclose(orders(errors), 2, atol=0.1)
    assert all(end.history[GAMMA] == 0 for end in ends)


def test_unloading_and_reloading_are_elastic_and_reversible() -> None:
    """A closed loop below eta_m at constant s comes back to the stress it left, and to the hyperbola after it."""
    loaded = at_constant_s(LAW, 5e3, 0.02, 20)
    element, d = Element(LAW), 1e-4

    def shear(state: State, sign: float) -> State:
        return element.solve(
            state,
            lambda de, end: np.array([de[0] - de[1] - sign * d, -(end.sigma[0] + end.sigma[1]) / 2 - 5e3, de[2]]),
            np.array([sign * d / 2, -sign * d / 2, 0]),
            np.array([d, 5e3, d]),
        )

    state = loaded
    for sign in [-1] * 5 + [1] * 5:
        state = shear(state, sign)
        assert state.history[GAMMA] == loaded.history[GAMMA]
    np.testing.assert_allclose(state.sigma, loaded.sigma, rtol=1e-11)
    assert shear(state, 1).history[GAMMA] > loaded.history[GAMMA]


def test_plastic_work_is_that_of_constant_volume() -> None:
    """t d gamma_p + s d eps_v_p = s sin(phi_pt) d gamma_p: accumulated and at once, better with smaller steps."""
    ends = [at_constant_s(LAW, 5e3, 0.06, steps) for steps in (50, 100, 200)]
    errors = [abs(end.history[WORK] / (5e3 * LAW.eta_cv * end.history[GAMMA]) - 1) for end in ends]
    assert errors[1] < 2e-6
    assert (orders(errors) > 1.9).all()


def test_oedometric_path() -> None:
    """From s = 50 Pa: K0, eta and strain at six stresses, to the digits that are known."""
    states = followed(LAW, confined(50.0), np.tile([0, -0.009 / 4000, 0], (4000, 1)))
    vertical = np.array([-state.sigma[1] for state in states])
    for stress, K0, eta, strain in OEDOMETRIC:
        found = [
            np.interp(stress, vertical, values)
            for values in (
                [state.sigma[0] / state.sigma[1] for state in states],
                [state.history[ETA] for state in states],
                [-state.strain[1] for state in states],
            )
        ]
        assert (np.abs(np.subtract(found, (K0, eta, strain))) < (1e-3, 1e-3, 1e-5)).all()


def random_walk(seed: int, steps: int = 2000, size: float = 2e-4) -> Floats:
    return np.random.default_rng(seed).normal(0, size, (steps, 3)) - np.array([2e-5, 2e-5, 0])


@pytest.mark.parametrize("seed", range(5))
def test_never_above_failure_and_never_back(seed: int) -> None:
    """2000 random steps: eta <= eta_f, eta_m falls only where the element is detached, plastic work never falls."""
    states = followed(LAW, confined(5e3), random_walk(seed))
    assert states[-1].history[GAMMA] > 0
    for before, after in pairwise(states):
        t = np.hypot((after.sigma[0] - after.sigma[1]) / 2, after.sigma[3])
        s = -(after.sigma[0] + after.sigma[1]) / 2
        assert t <= after.history[ETA] * s * (1 + 1e-12)
        assert after.history[ETA] <= LAW.eta_f
        assert after.history[WORK] >= before.history[WORK]
        if after.history[DETACHED] == before.history[DETACHED]:
            assert after.history[ETA] >= before.history[ETA]


def plastic_work(law: Ubcsand, before: State, after: State) -> float:
    """Of one step, without the law's counter: the strain that the elastic moduli of the mean s leave, times the stress.

    zz has no part in it: neither strain nor plastic strain.
    """
    middle, change = (before.sigma + after.sigma) / 2, after.sigma - before.sigma
    G, K = law.moduli(-(middle[0] + middle[1]) / 2)
    volume, half = (change[0] + change[1]) / 2 / (K + G / 3), (change[0] - change[1]) / (4 * G)
    elastic = np.array([volume / 2 + half, volume / 2 - half, change[3] / (2 * G)])
    return float(middle[[0, 1, 3]] * (1, 1, 2) @ (after.strain - before.strain - elastic))


def works(law: Ubcsand, seed: int) -> tuple[Floats, Floats, Floats]:
    """Of a random walk that stays in contact: work of the plastic steps, what the counter says, work of the elastic."""
    slid, counted, stayed = [], [], []
    for before, after in pairwise(followed(law, confined(5e3), random_walk(seed))):
        gone = after.history - before.history
        assert not gone[DETACHED]
        (slid if gone[GAMMA] else stayed).append(plastic_work(law, before, after))
        if gone[GAMMA]:
            counted.append(gone[WORK])
    return np.array(slid), np.array(counted), np.array(stayed)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "law", [LAW, Ubcsand(Rf=0.9, phi_pt=25.0), Ubcsand(reversal=1.0)], ids=["paper", "soft", "cyclic"]
)
def test_plastic_work_is_dissipated(law: Ubcsand, seed: int) -> None:
    """Every plastic step takes work, to the last; the counter agrees within 4.2 % of the largest step, 2 % in all."""
    slid, counted, stayed = works(law, seed)
    assert len(slid) > 100
    assert slid.min() > 0
    assert np.abs(stayed).max() < 1e-3 * slid.max()  # what the mean modulus of a finite step leaves
    assert np.abs(slid - counted).max() < 0.05 * slid.max()
    assert slid.sum() == pytest.approx(counted.sum(), rel=0.02)


class Gaining(Ubcsand):
    """Flow that makes work: its angle of constant volume has the wrong sign."""

    def constants(self) -> Floats:
        constants = super().constants()
        constants[8] *= -1
        return constants


def test_work_that_is_made_would_be_seen() -> None:
    """And so would a counter that leaves out the volume."""
    assert (works(Gaining(), 0)[0] < 0).all()
    shear = []
    for before, after in pairwise(followed(LAW, confined(5e3), random_walk(0))):
        if after.history[GAMMA] > before.history[GAMMA]:
            middle = (before.sigma + after.sigma) / 2
            t = np.hypot((middle[0] - middle[1]) / 2, middle[3])
            shear.append(t * (after.history[GAMMA] - before.history[GAMMA]))
    slid, _, _ = works(LAW, 0)
    assert np.abs(slid - shear).max() > 0.1 * slid.max()


def turned(sigma: Floats, angle: float) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    xx, yy, zz, xy = sigma
    return np.array(
        [c * c * xx + s * s * yy - 2 * c * s * xy, s * s * xx + c * c * yy + 2 * c * s * xy, zz,
         c * s * (xx - yy) + (c * c - s * s) * xy]
    )  # fmt: skip


@pytest.mark.parametrize("angle", [0.3, np.pi / 4, 2.0])
def test_axes_do_not_matter(angle: float) -> None:
    """The same path in turned axes gives the turned stress."""
    walk = random_walk(7, 200)
    there = np.array([turned(np.array([xx, yy, 0, xy]), angle)[[0, 1, 3]] for xx, yy, xy in walk])
    here, away = followed(LAW, confined(5e3), walk), followed(LAW, confined(5e3), there)
    size = max(float(np.abs(state.sigma).max()) for state in here)
    for a, b in zip(here, away, strict=True):
        np.testing.assert_allclose(b.sigma, turned(a.sigma, angle), rtol=0, atol=1e-12 * size)


def test_limit_of_perfect_plasticity() -> None:
    """Rf = 0 and a large KGp: Mohr-Coulomb in the plane, failure at once, sin psi = eta_f - eta_cv from then on."""
    stiff = Ubcsand(Rf=0.0, KGp=1e7)
    end = drained(stiff, 5e3, 0.02, 100)
    assert end.sigma[1] / end.sigma[0] == pytest.approx((1 + LAW.eta_f) / (1 - LAW.eta_f), rel=1e-9)
    assert end.history[VOLUME] / end.history[GAMMA] == pytest.approx(LAW.eta_f - LAW.eta_cv, abs=1e-5)


def test_only_the_ratio_to_Pa_matters() -> None:
    states = [drained(Ubcsand(Pa=Pa), 0.05 * Pa, 0.02, 20) for Pa in (1.0, 1e5, 101325.0)]
    for state, Pa in zip(states, (1.0, 1e5, 101325.0), strict=True):
        np.testing.assert_allclose(state.sigma / Pa, states[0].sigma, rtol=1e-9, atol=1e-15)
        np.testing.assert_allclose(state.strain, states[0].strain, rtol=1e-9, atol=1e-15)


def test_apex_and_contact_again() -> None:
    """Pulled apart all stresses vanish and eta_m is forgotten; compressed again it loads as if new."""
    loaded = drained(LAW, 5e3, 0.03, 30)
    element = Element(LAW)
    apart = element.step(loaded, np.array([[0.05, 0.05, 0.0]]))[0]
    assert not apart.sigma.any()
    assert (apart.history[ETA], apart.history[DETACHED]) == (0.0, 1.0)
    assert apart.history[GAMMA] == loaded.history[GAMMA]
    again = element.step(apart, np.array([[-1e-3, -1e-3, 0.0]]))[0]
    assert again.sigma[0] < 0
    assert again.history[GAMMA] == loaded.history[GAMMA]


def test_cohesion_moves_the_apex() -> None:
    """With c the ratio is t/(s + c cot phi_f): strength t = (s + c cot phi_f) sin phi_f, tension up to the cut-off."""
    law = Ubcsand(c=1e3, sigma_t=1e9)
    end = at_constant_s(law, 5e3, 0.5, 200)
    t = np.hypot((end.sigma[0] - end.sigma[1]) / 2, end.sigma[3])
    assert t == pytest.approx((5e3 + 1e3 / np.tan(np.radians(31.1))) * law.eta_f, rel=1e-9)
    element = Element(law)
    pulled = element.step(element.start(confined(10.0)), np.array([[2e-4, 2e-4, 0.0]]))[0]
    assert 0 < pulled.sigma[0] < law.shift
    cut = element.step(element.start(confined(10.0)), np.array([[0.2, 0.2, 0.0]]))[0]
    assert not cut.sigma.any()


def cycles(law: Ubcsand, amplitude: float, turns: int, steps: int = 50) -> list[State]:
    """Cyclic simple shear at constant vertical stress from an isotropic one."""
    element = Element(law)
    states = [element.start(confined(5e3))]
    for leg in range(2 * turns):
        length = amplitude if leg == 0 else 2 * amplitude
        d = (-1) ** leg * length / steps / 2
        for _ in range(steps):
            states.append(
                element.solve(
                    states[-1],
                    lambda de, end, d=d: np.array([de[0], end.sigma[1] + 5e3, de[2] - d]),
                    np.array([0, 0, d]),
                    np.array([abs(d), 5e3, abs(d)]),
                )
            )
    return states


def test_reversal_is_our_reading_and_off_by_default() -> None:
    """With it each crossing starts a branch at the eta that is mobilised there; without, eta_m grows on."""
    usual, reading = (cycles(Ubcsand(reversal=r), 0.01, 2) for r in (0.0, 1.0))
    assert (usual[-1].history[TURNS], reading[-1].history[TURNS]) == (0, 3)
    drops = [sum(b.history[ETA] < a.history[ETA] for a, b in pairwise(path)) for path in (usual, reading)]
    assert drops == [0, 3]
    assert reading[-1].history[VOLUME] < 1.2 * usual[-1].history[VOLUME] < 0  # it contracts more
    np.testing.assert_array_equal(reading[50].sigma, usual[50].sigma)  # the same until the first crossing


def test_stiffness_of_the_second_branch() -> None:
    """After a crossing at eta = 0 the hyperbola is the first one with k times hfac1 hfac2 (4 + 1/2)."""
    law = Ubcsand(reversal=1.0)
    element = Element(law)
    state = element.start(confined(5e3, 5.0, np.pi / 2))
    history = state.history.copy()
    history[TURNS] = 0
    d = -1e-6
    con: Callable[..., Floats] = lambda de, end: np.array(  # noqa: E731
        [de[0] - de[1], -(end.sigma[0] + end.sigma[1]) / 2 - 5e3, de[2] - d]
    )
    steps = 400
    for _ in range(steps):
        state = element.solve(state, con, np.array([0, 0, d]), np.array([abs(d), 5e3, abs(d)]))
    a, k = law.Rf / law.eta_f, law.KGp * (0.05) ** (law.np - 1) * 0.65 * 0.85 * 4.5
    assert state.history[TURNS] == 1
    eta = state.history[ETA]
    assert eta / (1 - a * eta) == pytest.approx(k * state.history[GAMMA], rel=1e-3)


def test_initial_memory() -> None:
    """eta_m of a stress that has not been sheared by us is what it mobilises, at most eta_f."""
    sigma = np.array([confined(5e3), confined(5e3, 1.5e3, 0.4), confined(5e3, 4e3), np.zeros(4), confined(-5.0)])
    np.testing.assert_allclose(LAW.initial(sigma)[:, ETA], [0, 0.3, LAW.eta_f, 0, 0])
    assert LAW.initial(sigma).shape == (5, len(MEMORY))


def test_zz_out_of_range_is_told() -> None:
    sigma = np.array([[-1.0, -3.0, -2.0, 0.0], [-1.0, -3.0, -0.5, 0.0], [-1.0, -3.0, -3.5, 0.0], [-2, -2, -2, 1.0]])
    np.testing.assert_array_equal(out_of_range(sigma), [False, True, True, False])


numbers = st.one_of(
    st.floats(-1e6, 1e6),
    st.sampled_from([0.0, -0.0, 1e-300, -1e-300, 1e150, -1e150, 1.0, -1.0]),
)


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(st.tuples(*[numbers] * 4), st.tuples(*[st.floats(-0.5, 0.5)] * 3), st.floats(0, LAW.eta_f))
def test_no_state_breaks_it(sigma: tuple[float, ...], de: tuple[float, ...], eta: float) -> None:
    """From finite states comes an admissible stress, eta_m within bounds; the same step once more ends as well."""
    state = State(np.zeros(3), np.array(sigma), np.r_[eta, np.zeros(len(LAW.memory) - 1)])
    for _ in range(2):
        state = Element(LAW).step(state, np.array([de]))[0]
        huge = max(map(abs, sigma)) > 1e100
        assert huge or np.isfinite(state.sigma).all()
        if np.isfinite(state.sigma).all():
            s = -(state.sigma[0] + state.sigma[1]) / 2
            t = np.hypot((state.sigma[0] - state.sigma[1]) / 2, state.sigma[3])
            assert 0 <= state.history[ETA] <= LAW.eta_f
            assert t <= state.history[ETA] * s + 1e-9 * (s + max(map(abs, sigma))) + 1e-300
            assert state.history[GAMMA] >= 0


increments = st.tuples(*[st.floats(-1, 1)] * 3, st.floats(-6, -2))  # a direction, and the exponent of its size
laws = st.builds(
    lambda Rf, phi_f, share, reversal: Ubcsand(Rf=Rf, phi_f=phi_f, phi_pt=share * phi_f, reversal=reversal),
    st.one_of(st.just(0.0), st.floats(0, 0.999)), st.floats(1, 60), st.floats(0.02, 1), st.sampled_from([0.0, 1.0]),
)  # fmt: skip


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(laws, st.floats(0, 5), st.floats(0, 1), st.floats(0, 7), st.lists(increments, min_size=1, max_size=6))
def test_no_parameters_break_it(
    law: Ubcsand, decades: float, share: float, angle: float, path: list[tuple[float, ...]]
) -> None:
    """From 1 Pa to 100 kPa, steps up to 1 %: finite, never beyond the strength, and slip only adds up."""
    s = 10**decades
    states = followed(law, confined(s, share * s * law.eta_f, angle), np.array([10**p * np.array(d) for *d, p in path]))
    for before, after in pairwise(states):
        assert np.isfinite(after.sigma).all()
        assert np.isfinite(after.history).all()
        s, t = -(after.sigma[0] + after.sigma[1]) / 2, np.hypot((after.sigma[0] - after.sigma[1]) / 2, after.sigma[3])
        assert 0 <= after.history[ETA] <= law.eta_f + 1e-12
        assert t <= s * (after.history[ETA] + 1e-12)
        assert after.history[GAMMA] >= before.history[GAMMA]


@pytest.mark.parametrize(
    ("law", "s", "de"),
    [
        (Ubcsand(Rf=0.0), 24.0, (6.5e-4, 2.5e-4, 1.5e-4)),
        (Ubcsand(Rf=0.0, reversal=1.0), 24.0, (6.5e-4, 2.5e-4, 1.5e-4)),
        (Ubcsand(Rf=0.0), 25.0, (-1e-3, 1.5e-3, 1e-3)),
        (Ubcsand(Rf=0.0), 4e3, (-4e-3, 6e-3, 7e-3)),
        (Ubcsand(Rf=0.3), 4.143963895658211, (-0.00103527538757433, -0.001993643197832, 0.004324264399348237)),
        (Ubcsand(Rf=0.3), 29.94328102, (-0.002616265031875291, 0.0014314437212125269, 0.00222191298938422)),
    ],
)
def test_where_the_hyperbola_is_not_met(law: Ubcsand, s: float, de: tuple[float, ...]) -> None:
    """A step from isotropic stress whose quadratic equation has no root on some pass: finite, within the strength."""
    end = followed(law, confined(s), np.array([de]))[-1]
    assert np.isfinite(end.sigma).all()
    assert excess(law, end.sigma) <= 1e-12
    assert end.history[GAMMA] >= 0


@pytest.mark.parametrize("Rf", [0.0, LAW.Rf])
def test_next_to_no_stress(Rf: float) -> None:
    """Squares of the radius are below the smallest float: there is no direction of its own, and nothing is lost."""
    law, history = Ubcsand(Rf=Rf), np.array([0, 0, 0, 0, 0, 4, 3.2790547e-43])
    de = np.array([[-2.24121797e-42, 2.03747088e-43, 3.90187514e-63]])
    end = Element(law).step(State(np.zeros(3), np.zeros(4), history), de)[0]
    assert np.isfinite(end.sigma).all()
    assert np.isfinite(end.history).all()
    assert excess(law, end.sigma) <= 1e-12


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", range(7))
def test_what_is_not_finite_stays_so(bad: float, where: int) -> None:
    """Never a finite stress of a lost state."""
    values = np.array([-5e3, -6e3, -5e3, 100.0, 1e-3, -2e-3, 1e-3])
    values[where] = bad
    element = Element(LAW)
    end = element.step(State(np.zeros(3), values[:4], LAW.initial(confined(5e3)[None])[0]), values[None, 4:])[0]
    assert not np.isfinite(end.sigma).all()


@pytest.mark.parametrize(
    "text",
    ["KGe=0", "KBe=-1", "KGp=0", "Pa=0", "ne=1.5", "np=-0.1", "phi_f=0", "phi_f=90", "phi_pt=32", "phi_pt=0", "Rf=1",
     "Rf=-0.1", "c=-1", "sigma_t=-1", "s_min=0", "s_bound=0", "rho0=0", "reversal=2", "reversal=1,rate=jaumann",
     "KBe=2000"],
)  # fmt: skip
def test_bad_parameters(text: str) -> None:
    with pytest.raises(ValueError, match="must") as caught:
        create("mpm_verify.solver.material", f"ubcsand:{text}")
    assert "\n" not in str(caught.value)


def test_the_missing_parameter_is_documented() -> None:
    assert pytest.approx(1.1 * 10.7**-0.15, abs=1e-10) == LAW.Rf
    assert "Rf is not in that table" in (Ubcsand.__doc__ or "")
    assert LAW.wave_speed() == pytest.approx(56, abs=0.5)  # at 20 kPa, 2.7 times that of the Mohr-Coulomb sand


def test_a_state_on_its_own_yield_surface_stays() -> None:
    """Without strain nothing happens, to the last bit or not: where t passes eta_m s by rounding no slip is left."""
    sand = Ubcsand()
    sigma = -np.outer(np.linspace(0.2, 1.0, 400), [5e3, 8e3, 6e3, 1e3])
    history, after = sand.initial(sigma), sigma.copy()
    t, s = np.hypot((sigma[:, 0] - sigma[:, 1]) / 2, sigma[:, 3]), -(sigma[:, 0] + sigma[:, 1]) / 2
    assert 0 < (t > history[:, 0] * s).mean() < 1  # some are beyond, by rounding
    sand.respond(sand.constants(), after.ravel(), np.zeros(3 * len(sigma)), history.ravel())
    np.testing.assert_allclose(after, sigma, rtol=1e-12)
