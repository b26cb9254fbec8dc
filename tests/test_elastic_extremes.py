"""Elastic laws under whatever comes: against forty digits where they give a stress, and a lost state stays lost."""

from math import inf, isfinite, nan

import mpmath
import numpy as np
import pytest
from fixtures_plastic import respond
from fixtures_rates import RIGHT, started, step_to
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from mpm_verify.cases.objectivity.exact import turn
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.material.neo_hookean import NeoHookean
from mpm_verify.solver.state import Floats, Particles

HUGE = [0.0, -0.0, 1.0, -1.0, 1e-150, -1e-150, 1e150, -1e150, 1e-300, 1e300]
LOST = st.sampled_from([nan, inf, -inf])
numbers = st.one_of(st.floats(-3, 3), st.sampled_from(HUGE), st.floats(-1e150, 1e150))
four = st.tuples(*[numbers] * 4)
constants = st.tuples(st.floats(1e-3, 1e12), st.floats(-0.95, 0.495))
search = settings(deadline=None, max_examples=300, derandomize=True, database=None)


def deformed(law: NeoHookean, F: Floats) -> Floats:
    """Stress (P,4) of F (P,2,2)."""
    count = len(F)
    p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
    p.F = np.ascontiguousarray(F)
    law.update(p, 1.0)
    return p.sigma


def exactly(law: NeoHookean, F: tuple[float, ...]) -> tuple[list[mpmath.mpf], mpmath.mpf]:
    """[mu (F F^T - I) + lam ln J I] / J, and the size of its terms, in the digits that are set."""
    xx, xy, yx, yy = map(mpmath.mpf, F)
    J = xx * yy - xy * yx
    a, b, c = xx * xx + xy * xy, yx * yx + yy * yy, xx * yx + xy * yy
    bulk = law.lam * mpmath.log(J)
    size = (law.mu * (max(a, b) + 1) + abs(bulk)) / J
    return [(law.mu * (a - 1) + bulk) / J, (law.mu * (b - 1) + bulk) / J, bulk / J, law.mu * c / J], size


def cancelled(F: tuple[float, ...]) -> float:
    """det F over the size of its two products: the digits that floats have left of it; 0 where there are none."""
    with mpmath.workdps(40):
        xx, xy, yx, yy = map(mpmath.mpf, F)
        size = abs(xx * yy) + abs(xy * yx)
        return float((xx * yy - xy * yx) / size) if size else 0.0


@search
@given(constants, four)
def test_neo_hookean_whatever_comes(values: tuple[float, float], F: tuple[float, ...]) -> None:
    """A stress that is finite is the right one; of what is turned inside out there is none, nor of a flat one."""
    law = NeoHookean(*values)
    sigma, left = deformed(law, np.array(F).reshape(1, 2, 2))[0], cancelled(F)
    if left <= -1e-15 or not any(F):
        assert not np.isfinite(sigma).all()
    if left > 1e-3 and np.isfinite(sigma).all():
        with mpmath.workdps(40):
            right, size = exactly(law, F)
            assert max(abs(a - b) for a, b in zip(sigma.tolist(), right, strict=True)) <= 1e-11 * size


@search
@given(constants, st.tuples(*[st.floats(-3, 3)] * 4))
def test_neo_hookean_of_usual_strains_is_finite(values: tuple[float, float], F: tuple[float, ...]) -> None:
    """The check above is not empty: it does not look at what is not finite."""
    assume(F[0] * F[3] - F[1] * F[2] > 1e-3)
    assert np.isfinite(deformed(NeoHookean(*values), np.array(F).reshape(1, 2, 2))).all()


@search
@given(four, st.integers(0, 3), LOST)
def test_neo_hookean_of_a_lost_deformation(F: tuple[float, ...], where: int, bad: float) -> None:
    values = np.array(F)
    values[where] = bad
    assert not np.isfinite(deformed(NeoHookean(), values.reshape(1, 2, 2))).all()


@search
@given(constants, st.floats(1e-3, 1e3), st.floats(-4, 4))
def test_neo_hookean_of_equal_stretches(values: tuple[float, float], stretch: float, angle: float) -> None:
    """Isotropic in the plane, whichever way it is turned."""
    law = NeoHookean(*values)
    xx, yy, zz, xy = deformed(law, stretch * turn(angle)[None])[0]
    size = law.mu * (1 + 1 / stretch**2) + abs(zz)
    assert max(abs(xx - yy), abs(xy)) <= 1e-14 * size


@search
@given(constants, four, st.tuples(*[numbers] * 3))
def test_hypoelastic_whatever_comes(
    values: tuple[float, float], state: tuple[float, ...], de: tuple[float, ...]
) -> None:
    """sigma + lam tr(de) I + 2 mu de, to the last bits of its terms; nothing of no strain."""
    assume(max(map(abs, (*state, *de))) < 1e200)
    law = Hypoelastic(*values)
    sigma = respond(law, np.array([state]), np.array([de]))[0][0]
    with mpmath.workdps(40):
        xx, yy, xy = map(mpmath.mpf, de)
        lam, mu = law.lam, law.mu
        right = [a + b for a, b in zip(state, (lam * (xx + yy) + 2 * mu * xx, lam * (xx + yy) + 2 * mu * yy,
                                               lam * (xx + yy), 2 * mu * xy), strict=True)]  # fmt: skip
        size = max(map(abs, state)) + (abs(lam) + 2 * mu) * 2 * max(map(abs, de))
        assert max(abs(a - b) for a, b in zip(sigma.tolist(), right, strict=True)) <= 1e-15 * size
    assert np.array_equal(respond(law, np.array([state]))[0][0], state)


@search
@given(st.tuples(*[st.one_of(numbers, LOST)] * 4), st.tuples(*[st.one_of(st.floats(-1, 1), LOST)] * 3))
def test_hypoelastic_keeps_what_is_lost(state: tuple[float, ...], de: tuple[float, ...]) -> None:
    sigma = respond(Hypoelastic(), np.array([state]), np.array([de]))[0]
    assert np.isfinite(sigma).all() == all(map(isfinite, (*state, *de)))


@settings(search, max_examples=100)
@given(st.sampled_from(RIGHT), st.floats(-1e3, 1e3), st.floats(0.5, 2), st.floats(-3, 3))
def test_hypoelastic_of_equal_stretches(rate: str, pressure: float, stretch: float, angle: float) -> None:
    """Through the rates, where no direction of stretch is there to be found: isotropic stress stays so in the plane."""
    law = Hypoelastic(E=1e3, rate=rate)
    p = started(law, np.eye(2)[None], np.array([pressure, pressure, 0.0, 0.0]))
    xx, yy, _, xy = step_to(law, p, stretch * turn(angle)[None]).sigma[0]
    assert np.isfinite([xx, yy]).all()
    assert max(abs(xx - yy), abs(xy)) <= 1e-12 * 1e4


@pytest.mark.parametrize("wrong", [1e-10, -1e-10])
def test_a_wrong_digit_would_be_seen(wrong: float) -> None:
    """Sharpness of the comparison with forty digits: a shear modulus that is off by as little misses it."""
    law, F = NeoHookean(), (1.2, 0.3, -0.1, 0.9)
    with mpmath.workdps(40):
        right, size = exactly(law, F)
        other, _ = exactly(NeoHookean(E=law.E * (1 + wrong)), F)
        assert max(abs(a - b) for a, b in zip(other, right, strict=True)) > 1e-11 * size
