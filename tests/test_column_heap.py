"""Measures of a heap, each alone, on shapes with a closed form: fronts, surfaces, area, height at the wall, energy."""

from math import sqrt
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.column.heap import at_wall, by_volume, connected, crowding, levelled, quantile, surface
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver.basis.mpm import Mpm
from mpm_verify.solver.boundary import box
from mpm_verify.solver.energy_budget import Budget, kinetic
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import no_load
from mpm_verify.solver.plugins import MATERIALS, create
from mpm_verify.solver.state import Floats, Grid
from mpm_verify.solver.step import Model, advance

WIDTH = ColumnRun().width
STRIP, STRIPS = WIDTH / 7, 126  # of a run with 7 cells and more
RESOLUTIONS = [(4, 4), (7, 4), (7, 9), (14, 9), (14, 16)]  # cells of the width, particles per cell
SHIFTS = [(0.0, 0.0), (0.25, -0.4), (-0.37, 0.11), (0.48, 0.48)]  # of the particles, in spacings


def column(cells: int, ppc: int, shift: tuple[float, float], wide: float = 1.0, tall: float = 7.0) -> Any:
    """Positions and volumes of a rectangle, in widths, that particles fill whatever their shift."""
    layout = rectangle(np.zeros(2), WIDTH * np.array([wide, tall]), WIDTH / cells, ppc, shift)
    return layout.X, layout.V0


def triangle(cells: int, ppc: int, shift: tuple[float, float], wide: float = 10.0, tall: float = 2.0) -> Any:
    """Positions and volumes of a heap that falls off evenly from the wall, in widths."""
    x, V = column(cells, ppc, shift, wide, tall)
    inside = x[:, 0] / wide + x[:, 1] / tall < WIDTH
    return x[inside], V[inside]


def area(x: Floats, V: Floats, recorded: bool = False, strip: float = STRIP) -> float:
    """Area below the surface."""
    heights = surface(x, V, strip, STRIPS) if recorded else levelled(x, V, V, strip, STRIPS)
    return float(heights.sum()) * strip


@pytest.mark.parametrize("shift", SHIFTS, ids=str)
@pytest.mark.parametrize(("cells", "ppc"), RESOLUTIONS)
def test_a_perfect_heap_has_its_area(cells: int, ppc: int, shift: tuple[float, float]) -> None:
    """Within 0.002, a rectangle, a flat and a steep triangle; the recorded measure is too low by a hundredth."""
    x, V = column(cells, ppc, shift)
    strip = ColumnRun(cells=cells).strip
    assert area(x, V, strip=strip) / V.sum() == pytest.approx(1, abs=0.002)
    assert area(x, V, True, strip) / V.sum() < 0.995
    for wide, tall in ((10.0, 2.0), (4.0, 2.0)):
        x, V = triangle(cells, ppc, shift, wide, tall)
        assert area(x, V, strip=strip) / V.sum() == pytest.approx(1, abs=0.002)


def test_a_heap_that_ends_within_a_strip_and_one_that_is_crowded() -> None:
    """A rectangle of 2.3 strips; one whose particles keep 1.3 times their space: positions alone count."""
    x, V = column(14, 9, (0.1, 0.2))
    inside = x[:, 0] < 2.3 * STRIP
    assert area(x[inside], V[inside]) / V[inside].sum() == pytest.approx(1, abs=0.002)
    assert area(x[inside], V[inside], recorded=True) / V[inside].sum() > 1.1  # a strip counts as a whole
    x, V = triangle(14, 9, (0.0, 0.0))
    assert area(x, 1.3 * V) == pytest.approx(area(x, V), rel=0.005)
    assert by_volume(x, 1.3 * V, STRIP, STRIPS).sum() * STRIP == pytest.approx(1.3 * V.sum(), rel=1e-12)


@pytest.mark.parametrize("made", [column, triangle])
@pytest.mark.parametrize(("cells", "ppc"), RESOLUTIONS)
def test_crowding_is_volume_over_space(cells: int, ppc: int, made: Any) -> None:
    """Rectangle and triangle have 1, with 1.3 times the volume 1.3, with half the height 2; a mean over squares."""
    x, V = made(cells, ppc, (0.0, 0.0))
    strip = ColumnRun(cells=cells).strip
    assert crowding(x, V, strip) == pytest.approx(1, abs=1e-12)
    assert crowding(x, 1.3 * V, strip) == pytest.approx(1.3, abs=1e-12)
    assert crowding(x * [1.0, 0.5], V, strip) == pytest.approx(2, abs=1e-12)
    if made is column:
        V[x[:, 1] < strip] *= 2  # of the lowest of the rows of squares, all but the uppermost of which count
        rows = 7 * WIDTH / strip - 1
        assert crowding(x, V, strip) == pytest.approx(1 + 1 / rows, abs=1e-12)


def test_crowding_of_what_has_no_inside() -> None:
    """A single row of squares has no square with another above it, and so no number; a hollow is not counted."""
    x, V = column(14, 9, (0.0, 0.0), 10.0, 1 / 7)
    assert np.isnan(crowding(x, V, STRIP))
    x, V = column(14, 9, (0.0, 0.0))
    whole = crowding(x, V, STRIP)
    kept = (x[:, 1] < 10 * STRIP) | (x[:, 1] > 12 * STRIP)
    assert crowding(x[kept], V[kept], STRIP) == pytest.approx(whole, abs=1e-12)


@pytest.mark.parametrize("shift", SHIFTS, ids=str)
def test_the_surface_by_volume(shift: tuple[float, float]) -> None:
    """Sums are kept to round-off; the strips of a rectangle and of a triangle have their mean heights."""
    x, V = column(14, 9, shift)
    found = by_volume(x, V, STRIP, STRIPS)
    assert found.sum() * STRIP == pytest.approx(V.sum(), rel=1e-12)
    np.testing.assert_allclose(found[:7], 7 * WIDTH, rtol=0.04)  # squares of a shifted layout stand for rectangles
    x, V = triangle(14, 16, shift)
    found = by_volume(x, V, STRIP, STRIPS)
    assert found.sum() * STRIP == pytest.approx(V.sum(), rel=1e-12)
    middles = (np.arange(70) + 0.5) * STRIP
    np.testing.assert_allclose(found[:70], 0.2 * (10 * WIDTH - middles), atol=0.02 * 2 * WIDTH)
    assert (found[72:] == 0).all()


def test_fronts_of_a_triangle() -> None:
    """99 and 99.9 % of its mass lie within 1 - sqrt(0.01) and 1 - sqrt(0.001) of its length; its toe is its end."""
    x, V = triangle(28, 16, (0.0, 0.0))
    length = 10 * WIDTH
    spacing = WIDTH / 28 / 4
    for fraction in (0.99, 0.999):
        assert quantile(x[:, 0], V, fraction) == pytest.approx(length * (1 - sqrt(1 - fraction)), abs=2 * spacing)
    flown = np.vstack([x, [[1.2 * length, 0.01]]])
    heap = connected(flown, STRIP)
    assert not heap[-1]
    assert flown[heap, 0].max() == pytest.approx(length, abs=4 * spacing)


@pytest.mark.parametrize("slope", [0.0, 0.2, 0.5])
def test_the_height_at_the_wall_of_a_straight_surface(slope: float) -> None:
    """Round-off, with three strips of seven that hold anything; one strip at the wall is half a strip too low."""
    heights = 0.17 - slope * STRIP * (np.arange(7) + 0.5)
    assert at_wall(heights, STRIP) == pytest.approx(0.17, rel=1e-12)
    for wrong in ((0,), (0, 1), (0, 3, 6)):
        hanging = heights.copy()
        hanging[list(wrong)] += 0.03
        assert at_wall(hanging, STRIP) == pytest.approx(0.17, rel=1e-12)
        assert abs(np.polyval(np.polyfit(np.arange(7) + 0.5, hanging, 1), 0) - 0.17) > 2e-3  # least squares is not
    few = heights[:2]
    assert at_wall(few, STRIP) == pytest.approx(0.17, rel=1e-12)


def test_a_sliver_at_the_wall_lifts_one_strip_and_not_the_fit() -> None:
    """Particles that hang above a triangle at the wall, as at a roller: 3 cm in one strip, below 1 mm by fit."""
    x, V = triangle(7, 9, (0.0, 0.0))
    s = WIDTH / 21
    sliver = np.stack([np.full(8, s / 2), 2 * WIDTH + s * np.arange(8)], axis=1)
    whole, more = np.vstack([x, sliver]), np.append(V, np.full(8, s * s))
    assert surface(whole, more, STRIP, STRIPS)[0] - surface(x, V, STRIP, STRIPS)[0] > 0.025
    fits = [at_wall(levelled(of, v, v, STRIP, STRIPS)[:7], STRIP) for of, v in ((x, V), (whole, more))]
    assert fits == pytest.approx([2 * WIDTH] * 2, abs=1e-3)


def test_the_energy_that_the_grid_sees() -> None:
    """A body that moves as one has it all; velocities that alternate from particle to particle have none of theirs."""
    dx = 0.1
    energies = {}
    for name in ("even", "alternating", "both"):
        grid = Grid(dx, np.zeros(2), np.array([1.0, 1.0]))
        material = create(MATERIALS, "hypoelastic")
        p = Mpm().populate(rectangle(np.array([0.3, 0.3]), np.array([0.7, 0.7]), dx, 4), material.rho0)
        row = np.round(p.x / (dx / 2) - 0.5).astype(int).sum(axis=1)
        sign = np.where(row % 2 == 0, 1.0, -1.0)
        p.v[:] = {"even": 0 * sign + 3, "alternating": sign, "both": 3 + sign}[name][:, None] * [1.0, 0.0]
        model = Model(grid, p, Mpm(), material, box(grid, "free"), 1e-9)
        budget = Budget(np.zeros(2), kinetic(p))
        model.watch(budget)
        advance(model, no_load)
        terms = budget.terms(model)
        nodes = 0.5 * float((grid.mass[:, None] * grid.velocity**2).sum())
        assert terms["on_grid"] == pytest.approx(nodes, rel=1e-9)
        energies[name] = terms["on_grid"] / (0.5 * p.m.sum()), terms["kinetic"] / (0.5 * p.m.sum())
    assert energies["even"] == pytest.approx((9, 9), rel=1e-9)
    assert energies["alternating"][1] == pytest.approx(1, rel=1e-6)
    assert energies["alternating"][0] < 0.02  # of corners, where a node has one particle alone
    assert energies["both"][1] == pytest.approx(10, rel=1e-6)
    assert energies["both"][0] == pytest.approx(9, rel=0.02)
