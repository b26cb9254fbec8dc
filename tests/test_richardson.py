"""Richardson extrapolation: what is known of made sequences, with spacings in any ratio."""

from math import inf

import pytest

from mpm_verify.cases.judging.richardson import FORMAL, LEAST, extrapolate

LEVELS = [(1.0, 2.0, 4.0), (1 / 42, 1 / 28, 1 / 14), (0.3, 0.7, 0.8)]


@pytest.mark.parametrize("h", LEVELS)
@pytest.mark.parametrize("order", [0.6, 1.0, 2.0, 3.5])
@pytest.mark.parametrize("size", [0.7, -0.02])
def test_a_power_law_gives_its_order_and_limit(h: tuple[float, float, float], order: float, size: float) -> None:
    found = extrapolate(h, [3.0 + size * level**order for level in h])
    assert (found.kind, found.order) == ("converges", pytest.approx(order))
    if order <= FORMAL:
        assert found.limit == pytest.approx(3.0)
        assert found.uncertainty == pytest.approx(1.25 * abs(found.finest - 3.0))
    else:  # an order that the method cannot have is not used
        assert abs(found.limit - found.finest) > abs(3.0 - found.finest)
        assert found.uncertainty > 1.25 * abs(found.finest - 3.0)


def test_a_second_term_is_inside_the_uncertainty() -> None:
    """h + h^2/2: the order seen is above 1, and the true limit lies within the index."""
    h = (0.1, 0.2, 0.4)
    found = extrapolate(h, [1 + level + level**2 / 2 for level in h])
    assert 1 < found.order < 1.3
    assert abs(found.finest - 1) < found.uncertainty < 0.15
    assert abs(found.limit - 1) < 0.02


@pytest.mark.parametrize(
    ("f", "kind", "uncertainty"),
    [
        ((1.0, 1.1, 1.05), "oscillates", 0.05),
        ((1.0, 1.1, 1.1), "oscillates", 0.05),
        ((1.0, 1.5, 1.6), "unsettled", 0.3),
        ((1.0, 1.1, 1.2), "unsettled", 0.1),
        ((2.0, 2.0, 1.0), "equal", 0.5),
    ],
)
def test_what_does_not_converge_has_no_limit(f: tuple[float, ...], kind: str, uncertainty: float) -> None:
    found = extrapolate((1.0, 2.0, 4.0), f)
    assert (found.kind, found.uncertainty) == (kind, pytest.approx(uncertainty))
    assert (found.limit == found.limit) == (kind == "equal")


def test_an_order_below_the_least_is_none() -> None:
    h = (1.0, 2.0, 4.0)
    assert extrapolate(h, [level ** (LEAST - 0.02) for level in h]).kind == "unsettled"
    assert extrapolate(h, [level ** (LEAST + 0.02) for level in h]).kind == "converges"


@pytest.mark.parametrize(
    ("h", "f"),
    [
        ((1.0, 1.0, 2.0), (1.0, 2.0, 3.0)),
        ((4.0, 2.0, 1.0), (1.0, 2.0, 3.0)),
        ((1.0, 2.0, inf), (1.0, 2.0, 3.0)),
        ((1.0, 2.0, 4.0), (1.0, 2.0, float("nan"))),
        ((1.0, 2.0), (1.0, 2.0)),
    ],
)
def test_refusals(h: tuple[float, ...], f: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="three levels of rising spacing"):
        extrapolate(h, f)
