"""Objective rates and what they are mistaken for: orders, closed forms, other observers, and rotations of any size.

Who sees which negative control, as the share of the stress by which it misses (measured,
hypoelastic; at least 0.1 is seen):

                    constant      one step of    going on,   strained turn,  strained turn,
                    rotation      1 rad          4 steps     4 steps         400 steps
rates               0             0              0.06        0.04            4e-6
strain_start        0             0              0.44        0.15            1.5e-3
strain_end          0             0              0.44        0.15            1.5e-3
strain_fixed        0             0              0.44        0.15            1.5e-3
explicit_jaumann    0             0.20           1.24        0.33            2.7e-3
same_rotation       0             0.18           1.11        0.44            0.43
stretched_frame     0             0              0.49        0.66            0.92
printed_rotation    0.49          0.19           0.55        0.36            0.37
printed             1.00          0.19           1.02        0.53            0.995

"Constant" and "going on" compare two observers of one motion; stretched_frame tells both the same wrong stress once
steps are small, so only a closed form sees it at any number of steps.
"""

from functools import cache
from itertools import pairwise
from typing import Any

import mpmath
import numpy as np
import pytest
from fixtures_rates import (
    CONFINED,
    LAWS,
    RIGHT,
    WRONG,
    in_frame,
    law_of,
    prestress,
    size,
    started,
    step_to,
    strained,
    turned,
    walk,
)

from mpm_verify.cases.objectivity.exact import compressed, turn
from mpm_verify.cases.objectivity.kinematic import follow, sheared, stretched_turn
from mpm_verify.cases.objectivity.rates import STEPS, order_errors, simple_shear, slope
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.plugins import RATES, create
from mpm_verify.solver.rate_material import objective
from mpm_verify.solver.rates.logarithmic import bend
from mpm_verify.solver.state import Floats

MISS = 0.1  # of the stress: what is missed by so much is seen
SOILS = [name for name in LAWS if name != "hypoelastic"]
every_rate = pytest.mark.parametrize("rate", RIGHT)
every_reading = pytest.mark.parametrize("rate", [*RIGHT, *WRONG])


# ---- orders in time


EXPECTED = {  # error at 25 and at 400 steps of the strained turn
    "green_naghdi": (9.8e-4, 3.8e-6),
    "jaumann": (9.8e-4, 3.8e-6),
    "logarithmic": (9.8e-4, 3.8e-6),
    "truesdell": (9.9e-4, 3.9e-6),
    "strain_start": (2.3e-2, 1.5e-3),
    "strain_end": (2.3e-2, 1.5e-3),
    "strain_fixed": (2.3e-2, 1.5e-3),
    "explicit_jaumann": (4.5e-2, 2.7e-3),
    "same_rotation": (0.426, 0.426),
    "printed_rotation": (0.325, 0.370),
    "printed": (0.918, 0.995),
    "stretched_frame": (0.891, 0.920),
}


@cache
def errors_of(rate: str) -> Floats:
    return order_errors(rate)


@every_reading
def test_error_and_order_along_a_strained_turn(rate: str) -> None:
    """R(pi t / 2) diag(1 - t/5, 1): magnitudes to their digits, the order as the plug-in states it."""
    errors = errors_of(rate)
    assert rate in EXPECTED, "a new plug-in: measure its error at 25 and 400 steps and write it here"
    assert (errors[0], errors[-1]) == pytest.approx(EXPECTED[rate], rel=0.03)
    order = objective(rate).order
    assert slope(errors) == pytest.approx(order, abs=0.1)
    if order == 0:
        assert errors[-1] > 0.99 * errors[0]
        assert errors.min() > 0.3
    else:
        local = np.log2(errors[:-1] / errors[1:])
        np.testing.assert_allclose(local, order, atol=0.1)


def test_rates_and_misreadings_say_so() -> None:
    assert {objective(rate).order for rate in RIGHT} == {2.0}
    assert {objective(rate).order for rate in WRONG} == {0.0, 1.0}


def with_strain_of(gradient: Any, rate: str, steps: int) -> float:
    """Error of the strained turn by the kernels of a rate, the strain increment alone by `gradient(F0, F1)`."""
    law: Any = Hypoelastic(E=1.0, rate=rate)
    frame, sigma, de = objective(rate), np.zeros(4), np.zeros(3)
    path = [stretched_turn(t) for t in np.linspace(0, 1, steps + 1)]
    for F0, F1 in pairwise(path):
        frame.unrotate(F0.ravel(), F1.ravel(), sigma, de)
        L = gradient(F0, F1)
        D = (L + L.T) / 2
        if rate == "green_naghdi":
            mean = F0 + F1
            Q = turn(float(np.arctan2(mean[1, 0] - mean[0, 1], mean[0, 0] + mean[1, 1])))
            D = Q.T @ D @ Q
        mine = np.array([D[0, 0], D[1, 1], D[0, 1]])
        law.respond(law.constants(), sigma, mine, np.zeros(0))
        frame.rotate(F0.ravel(), F1.ravel(), sigma)
    xx, yy, _ = compressed(0.8, law.lam, law.mu, rate)
    return size(sigma - np.array([yy, xx, sigma[2], 0.0])) / float(np.hypot(xx, yy))


def in_the_middle(F0: Floats, F1: Floats) -> Floats:
    return (F1 - F0) @ np.linalg.inv((F0 + F1) / 2)


def from_the_start(F0: Floats, F1: Floats) -> Floats:
    return (F1 - F0) @ np.linalg.inv(F0)


@every_rate
def test_a_strain_increment_of_the_start_costs_an_order(rate: str) -> None:
    """With the mean it is what the kernels do, to round-off; with F0 in its place a third is missed, at order 1."""
    few = with_strain_of(in_the_middle, rate, STEPS[0])
    assert few == pytest.approx(errors_of(rate)[0], rel=1e-9)
    wrong = np.array([with_strain_of(from_the_start, rate, steps) for steps in STEPS])
    assert wrong[0] > 0.3
    assert slope(wrong) == pytest.approx(1, abs=0.1)


# ---- closed forms in simple shear


TABLE = {  # shear: s12 and s11 over G of Jaumann, Green-Naghdi, logarithmic
    1.0: (0.841470984808, 0.459697694132, 0.869783943705, 0.415900087226, 0.860817881928, 0.430408940964),
    4.0: (-0.756802495308, 1.653643620864, 2.317943737189, 2.274201391862, 1.291226822892, 2.582453645784),
    8.0: (0.989358246623, 1.145500033809, 5.046020804989, 3.730739150533, 1.016084833843, 4.064339335371),
}


@pytest.mark.parametrize("gamma", TABLE)
def test_closed_forms_of_simple_shear(gamma: float) -> None:
    """The functions against numbers that were computed apart from them, to all twelve digits."""
    of = {name: exact(np.array([gamma]))[0] for name, exact in SIMPLE_SHEAR.items()}
    order = ("jaumann", "green_naghdi", "logarithmic")
    found = [of[name][component] for name in order for component in (2, 0)]
    np.testing.assert_allclose(found, TABLE[gamma], rtol=0, atol=1e-12)
    np.testing.assert_allclose([of[name][1] for name in order], [-of[name][0] for name in order], rtol=1e-15)
    np.testing.assert_allclose(of["truesdell"], [gamma**2, 0, gamma], rtol=1e-15)


@pytest.mark.parametrize("name", SIMPLE_SHEAR)
def test_closed_forms_solve_the_equation_of_their_rate(name: str) -> None:
    """d sigma / d gamma = 2 G D + what the rate carries along, by a central difference."""
    gamma, h = np.linspace(0.1, 8, 40), 1e-5
    exact = SIMPLE_SHEAR[name]
    s11, s22, s12 = exact(gamma).T
    derived = (exact(gamma + h) - exact(gamma - h)) / (2 * h)
    if name == "truesdell":  # L sigma + sigma L^T
        right = np.stack([2 * s12, 0 * s12, 1 + s22], axis=1)
    else:
        spin = {
            "jaumann": 0 * gamma - 0.5,
            "green_naghdi": -2 / (4 + gamma**2),
            "logarithmic": -0.25 * (4 / (4 + gamma**2) + gamma / np.sqrt(4 + gamma**2) / np.arcsinh(gamma / 2)),
        }[name]  # angle of the frame per shear, W12 of it with the other sign
        right = np.stack([-2 * spin * s12, 2 * spin * s12, 1 + spin * (s11 - s22)], axis=1)
    np.testing.assert_allclose(derived, right, atol=1e-8)


@pytest.mark.parametrize("gamma", TABLE)
@every_rate
def test_simple_shear_is_met(rate: str, gamma: float) -> None:
    """To 1e-3 of G in 100 steps per unit of shear, at order 2; Truesdell's in any number of steps."""
    exact = SIMPLE_SHEAR[rate](np.array([gamma]))[0, [0, 2]]
    errors = [float(np.abs(simple_shear(rate, gamma, int(n * gamma)) - exact).max()) for n in (25, 100)]
    assert errors[1] < 1e-3
    if rate == "truesdell":
        assert max(errors) < 1e-11
    else:
        assert np.log(errors[0] / errors[1]) / np.log(4) == pytest.approx(2, abs=0.1)


def test_simple_shear_tells_the_rates_apart() -> None:
    """At a shear of 8 any two differ by more than G/10, in s11 or s12."""
    ends = [SIMPLE_SHEAR[rate](np.array([8.0]))[0] for rate in RIGHT]
    away = [np.abs(a - b).max() for k, a in enumerate(ends) for b in ends[:k]]
    assert min(away) > 0.1


# ---- other observers


ANGLES = (0.3, 1.0, 2.5, -1.7)


def miss_of_constant(name: str, rate: str, steps: int = 50) -> float:
    """How far a turned observer's stress is from the stress turned, as a share of it."""
    law = law_of(name, rate)
    stress = walk(law, strained, steps, prestress(law)).sigma[0]
    seen = [walk(law, in_frame(angle), steps, turned(prestress(law), angle)).sigma[0] for angle in ANGLES]
    away = [there - turned(stress, angle) for there, angle in zip(seen, ANGLES, strict=True)]
    return max(float(np.abs(there).max()) for there in away) / float(np.abs(stress).max())


@every_rate
@pytest.mark.parametrize("name", LAWS)
def test_a_turned_observer_sees_the_stress_turned(name: str, rate: str) -> None:
    assert miss_of_constant(name, rate) < 1e-12


@pytest.mark.parametrize("name", LAWS)
def test_the_history_knows_no_observer(name: str) -> None:
    """And the path does yield: what the law keeps of it is not what it began with."""
    law = law_of(name)
    p = walk(law, strained, 50, prestress(law))
    q = walk(law, in_frame(1.0), 50, turned(prestress(law), 1.0))
    np.testing.assert_allclose(q.history, p.history, rtol=1e-11, atol=1e-13)
    if law.memory:
        assert (p.history != law.initial(prestress(law)[None])).any()
        assert size(p.sigma[0] - prestress(law)) > 0.1 * size(prestress(law))


def miss_of_ongoing(name: str, rate: str, steps: int) -> float:
    """The same of an observer who turns by two radians meanwhile."""
    law = law_of(name, rate)
    stress = walk(law, strained, steps, prestress(law)).sigma[0]
    seen = walk(law, in_frame(0.0, 2.0), steps, prestress(law)).sigma[0]
    return size(seen - turned(stress, 2.0)) / size(stress)


# Orders 2.03, 2.31, 1.98 between the steps below, fitted 2.13: the first step of 25 and of 50 turns the axes of stress
# so far that ubcsand returns radially (its CLOSE), where the two observers differ more.
LESS_REGULAR = {("ubcsand", "truesdell"): 0.15}
FARTHER = {("hencky_rate", "truesdell"): 3.5e-3}  # 3.0e-3


@every_rate
@pytest.mark.parametrize("name", LAWS)
def test_a_turning_observer_sees_it_at_second_order(name: str, rate: str) -> None:
    """Not exactly, as D is of the middle of the step: by 1.5e-3 in 25 steps, at order 2; some by more."""
    steps = np.array([25, 50, 100, 200])
    away = [miss_of_ongoing(name, rate, int(count)) for count in steps]
    assert away[0] < FARTHER.get((name, rate), 7e-3 if name == "ubcsand" else 2e-3)  # 6.4e-3 of ubcsand
    within = LESS_REGULAR.get((name, rate), 0.02)
    assert -np.polyfit(np.log(steps), np.log(away), 1)[0] == pytest.approx(2, abs=within)


CONSTANT = {"printed", "printed_rotation"}  # whom the constant rotation sees
STEP = CONSTANT | {"explicit_jaumann", "same_rotation"}  # and one step by 1 rad


def miss_of_a_step(rate: str, angle: float) -> float:
    """How far one step of rotation is from the stress turned; the law is so soft that the strain does not count."""
    law = create("mpm_verify.solver.material", f"hypoelastic:E=1,rate={rate}")
    p = step_to(law, started(law, np.eye(2)[None], CONFINED), turn(angle)[None])
    return float(np.abs(p.sigma[0] - turned(CONFINED, angle)).max() / np.abs(CONFINED).max())


@pytest.mark.parametrize("rate", WRONG)
def test_who_sees_which_misreading(rate: str) -> None:
    """The matrix above; a turn that goes on, in four steps, and the strained turn see them all, and no rate."""
    assert (miss_of_constant("hypoelastic", rate) > MISS) == (rate in CONSTANT)
    assert (miss_of_a_step(rate, 1.0) > MISS) == (rate in STEP)
    assert miss_of_ongoing("hypoelastic", rate, 4) > 0.4
    assert order_errors(rate, (4,))[0] > MISS
    assert (errors_of(rate)[-1] > MISS) == (objective(rate).order == 0)
    if rate not in CONSTANT:
        assert miss_of_constant("hypoelastic", rate) < 1e-12
    if rate not in STEP:
        assert miss_of_a_step(rate, 1.0) < 1e-13


@pytest.mark.parametrize("rate", WRONG)
@pytest.mark.parametrize("name", SOILS)
def test_a_soil_shows_every_misreading(name: str, rate: str) -> None:
    """To an observer who goes on turning, four steps: by 0.23 to 5.9, and by more than any rate (0.06, ubcsand 0.2)."""
    miss = miss_of_ongoing(name, rate, 4)
    assert miss > 2 * MISS
    assert miss > 1.5 * largest_miss_of_a_rate(name)


@cache
def largest_miss_of_a_rate(name: str) -> float:
    return max(miss_of_ongoing(name, rate, 4) for rate in RIGHT)


@every_rate
def test_no_rate_is_taken_for_a_misreading(rate: str) -> None:
    assert miss_of_ongoing("hypoelastic", rate, 4) < 0.07
    assert order_errors(rate, (4,))[0] < 0.05


def test_a_stretched_frame_tells_all_observers_the_same() -> None:
    """Why the closed form is needed: two observers agree on its wrong stress, at second order."""
    assert miss_of_ongoing("hypoelastic", "stretched_frame", 200) < 1e-3
    assert errors_of("stretched_frame")[-1] > 0.9


# ---- rotations of any size, and no step at all


@pytest.mark.parametrize("angle", [0.1, 1.0, 2.5, -3.0, 4.0])
@every_rate
def test_one_step_of_rotation_is_exact(rate: str, angle: float) -> None:
    """The stress is turned to 1e-13, and there is no strain: a stiff law free of stress stays so."""
    assert miss_of_a_step(rate, angle) < 1e-13
    law = law_of("hypoelastic", rate)
    p = step_to(law, started(law, np.eye(2)[None], np.zeros(4)), turn(angle)[None])
    assert np.abs(p.sigma).max() < 1e-13 * law.E


@every_rate
def test_a_step_of_nothing_leaves_the_stress(rate: str) -> None:
    law = law_of("hypoelastic", rate)
    F = in_frame(0.7)(1.0)[None]
    p = started(law, F, CONFINED)
    for _ in range(3):
        step_to(law, p, F)
    np.testing.assert_allclose(p.sigma[0], CONFINED, rtol=3e-15)


@pytest.mark.parametrize("rate", ["printed", "printed_rotation", "stretched_frame"])
def test_a_step_of_nothing_sees_these(rate: str) -> None:
    law = law_of("hypoelastic", rate)
    F = in_frame(0.7)(1.0)[None]
    p = step_to(law, started(law, F, CONFINED), F)
    assert size(p.sigma[0] - CONFINED) > MISS * size(CONFINED)


# ---- many particles


@pytest.mark.parametrize("name", LAWS)
def test_new_rows_in_the_middle_of_a_path_change_no_bit(name: str) -> None:
    """F_old and history travel with their particle; 70 particles are two blocks and a rest."""
    law, rng = law_of(name), np.random.default_rng(5)
    speeds = rng.uniform(0.2, 1.0, 70)
    plain, moved = (started(law, np.tile(np.eye(2), (70, 1, 1)), prestress(law)) for _ in range(2))
    for step in range(1, 13):
        F = np.array([in_frame(0.0, speed)(speed * step / 12) for speed in speeds])
        step_to(law, plain, F)
        if step in (4, 9):
            moved.reorder(rng.permutation(70))
        step_to(law, moved, F[moved.id])
    np.testing.assert_array_equal(moved.in_initial_order("sigma"), plain.sigma)
    np.testing.assert_array_equal(moved.in_initial_order("history"), plain.history)
    assert len(np.unique(plain.sigma[:, 0])) == 70


def test_a_forgotten_column_would_be_seen() -> None:
    """The check above can fail: with F_old left behind the stress is another."""
    law = law_of("hypoelastic")
    F = np.array([strained(t) for t in np.linspace(0, 1, 40)])
    p = started(law, F, CONFINED)
    step_to(law, p, F)
    kept = p.F_old.copy()
    p.reorder(np.arange(40)[::-1])
    p.F_old = kept
    step_to(law, p, F[::-1])
    assert np.abs(p.in_initial_order("sigma") - CONFINED).max() > 1


# ---- the logarithmic rate where stretches are alike


@pytest.mark.parametrize("z", [1e-12, 1e-6, 1e-3, 0.02, 0.0499, 0.05 - 1e-12, 0.05, 0.0501, 0.1, 0.5, 0.99, 1 - 1e-9])
def test_bend_of_the_logarithmic_rate(z: float) -> None:
    """Against forty digits, on both sides of its threshold."""
    with mpmath.workdps(40):
        exact = float((mpmath.mpf(z) / mpmath.atanh(mpmath.mpf(z)) - 1) / mpmath.mpf(z) ** 2)
    assert bend(z) == pytest.approx(exact, rel=1e-13 if z > 0.2 else 2e-13)
    assert bend(0.0) == pytest.approx(-1 / 3, rel=1e-15)


def sheared_from(stretch: float) -> Floats:
    """Stress of one step of shear and turn from F = diag(stretch, 1), free of stress before."""
    law = law_of("hypoelastic", "logarithmic")
    F = np.diag([stretch, 1.0])
    p = started(law, F[None], CONFINED)
    return step_to(law, p, (turn(0.2) @ np.array([[1.0, 0.02], [0.0, 1.0]]) @ F)[None]).sigma[0]


def test_alike_stretches_make_no_jump() -> None:
    """From a thousandth apart down to not at all, stresses come together as the stretches do, whatever the sign."""
    alike = sheared_from(1.0)
    for apart in 10.0 ** -np.arange(3, 13):
        for sign in (1, -1):
            away = np.abs(sheared_from(1 + sign * apart) - alike).max()
            assert away < 1e4 * apart + 1e-10


def test_no_jump_at_the_threshold_of_the_series() -> None:
    """z of the middle of the step passes 0.05 on the way; third differences of the stress see a jump of 1e-9."""
    stretches = np.linspace(0.9, 1.1, 3001)
    stresses = np.array([sheared_from(stretch) for stretch in stretches])
    assert np.abs(np.diff(stresses, n=3, axis=0)).max() < 1e-9
    zs = np.array([spread(stretch) for stretch in stretches])
    assert zs.min() < 0.045
    assert zs.max() > 0.055


def spread(stretch: float) -> float:
    """z of the step of sheared_from."""
    F = np.diag([stretch, 1.0])
    mean = F + turn(0.2) @ np.array([[1.0, 0.02], [0.0, 1.0]]) @ F
    large, small = np.linalg.eigvalsh(mean @ mean.T)[::-1]
    return float((large - small) / (large + small))


# ---- lost states


LOST = {
    "turned inside out": (np.eye(2), np.diag([1.0, -3.0])),
    "flat in the middle": (np.eye(2), np.diag([1.0, -1.0])),
    "both ends whole": (np.diag([4.0, 1.0]), np.diag([-1.0, -4.0])),
    "not a number": (np.eye(2), np.array([[1.0, np.nan], [0.0, 1.0]])),
    "infinite": (np.eye(2), np.array([[np.inf, 0.0], [0.0, 1.0]])),
    "not a number before": (np.array([[np.nan, 0.0], [0.0, 1.0]]), np.eye(2)),
}


@pytest.mark.parametrize("lost", LOST)
@pytest.mark.parametrize(
    ("name", "rate"),
    [*(("hypoelastic", rate) for rate in (*RIGHT, *WRONG)), *((name, "green_naghdi") for name in LAWS)],
)
def test_a_lost_deformation_gives_no_stress(name: str, rate: str, lost: str) -> None:
    """Not a finite wrong one; and its neighbours in the block keep theirs."""
    law = law_of(name, rate)
    start, end = LOST[lost]
    p = started(law, np.array([np.eye(2), start, np.eye(2)]), prestress(law))
    step_to(law, p, np.array([np.eye(2), end, np.eye(2)]))
    assert not np.isfinite(p.sigma[1]).any()
    np.testing.assert_allclose(p.sigma[[0, 2]], np.tile(prestress(law), (2, 1)), rtol=1e-14)


# ---- what a rate or a law is refused for


def test_no_such_rate() -> None:
    with pytest.raises(ValueError, match=r"no rate 'spin'; choose from green_naghdi, jaumann, logarithmic, truesdell"):
        create("mpm_verify.solver.material", "hypoelastic:rate=spin")
    law = law_of("hypoelastic")
    p = started(law, np.eye(2)[None], CONFINED)
    p.F_old = np.zeros((1, 0))
    with pytest.raises(ValueError, match="must start the particles"):
        law.update(p, 1.0)


def test_truesdell_has_its_own_limit_and_the_others_one() -> None:
    """Why its order is measured against another closed form: without rotation it is lam (1 - 1/stretch) across."""
    for rate in RIGHT:
        law = create("mpm_verify.solver.material", f"hypoelastic:E=1,rate={rate}")
        end = follow(law, lambda t: np.diag([1 - 0.2 * t, 1.0]), 200).sigma[-1]
        np.testing.assert_allclose(end[:3], compressed(0.8, law.lam, law.mu, rate), rtol=1e-5)
    assert abs(compressed(0.8, 1.0, 1.0, "truesdell") - compressed(0.8, 1.0, 1.0, "jaumann")).max() > 0.02


def test_shear_that_comes_back() -> None:
    """There and back by the same steps gives the stress back to round-off, by every rate."""
    for rate in RIGHT:
        law = create("mpm_verify.solver.material", f"hypoelastic:E=1,rate={rate}")
        end = follow(law, lambda t: sheared(2.0)(1 - abs(2 * t - 1)), 40).sigma[-1]
        assert np.abs(end).max() < 1e-13, rate
    assert set(RIGHT) == set(SIMPLE_SHEAR), f"a new rate of {RATES} needs its closed form"
