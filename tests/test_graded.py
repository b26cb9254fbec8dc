"""Layouts that are finer where strain is expected, the packing of particles, and what such layouts save."""

from dataclasses import replace
from math import sqrt
from typing import Any

import fixtures_study as fixtures
import numpy as np
import pytest

from mpm_verify.cases.harness.build import Asked, named
from mpm_verify.cases.mms import execute as case
from mpm_verify.cases.mms.graded import Bounded, Plan, build_graded, cost_of, factor, kind, savings
from mpm_verify.cases.mms.packing import counts, full_cells, outline
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result, Run
from mpm_verify.mms.grading import Grading, equidistributed, expected_strain
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.reports.sentences import failures
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.layout import CENTRED, Layout, annulus, graded, rectangle
from mpm_verify.solver.plugins import LAYOUTS, SOLUTIONS, available, create
from mpm_verify.solver.state import Floats, Grid

CENTRE, CORNER = (15, 15), (0, 0)


def made(solution: str) -> tuple[Any, Manufactured]:
    """A solution and its fields."""
    plugin = create(SOLUTIONS, solution)
    return plugin, case.manufactured(solution, plugin.material)


def laid(specification: str, solution: str = "localised", cells: int = 32, ppc: int = 4) -> Layout:
    """A layout of a solution."""
    plugin, exact = made(solution)
    layout: Layout = create(LAYOUTS, specification)(plugin, exact, 1 / cells, ppc, CENTRED)
    return layout


def held(layout: Layout, cells: int = 32) -> Any:
    """Particles in each cell."""
    return counts(Grid(1 / cells, np.zeros(2), np.ones(2)), layout.X)


def run(layout: str, method: str = "cpdi", cells: int = 16, ppc: int = 4, solution: str = "localised") -> Run:
    """One run of this study."""
    return Run(method, solution, "neo_hookean", cells, ppc, 0.4, layout=layout)


def test_equidistribution_divides_the_integral_evenly() -> None:
    n = np.repeat([1.0, 3.0], 50)
    faces = equidistributed(n, 2.0, 4.0, 8)
    assert np.allclose(faces, [2, 2.5, 3, *(3 + np.arange(1, 7) / 6)])  # 2 of 8 on the left half, 6 on the right
    moved = equidistributed(n, 2.0, 4.0, 8, 0.25)
    assert moved[[0, -1]].tolist() == [2.0, 4.0]
    assert moved[1] == pytest.approx(2.5 + 0.25 * 0.5)


def test_the_strain_is_that_of_green_and_lagrange_and_blind_to_rotation() -> None:
    """bar: E = (F^2 - 1) / 2 with F = 1 + A pi cos(pi X) at its largest; none along y. A rotation has none at all."""
    along, across = expected_strain(made("bar")[1], made("bar")[0])
    X = (np.arange(96) + 0.5) / 96
    slope = 0.1 * np.pi * np.abs(np.cos(np.pi * X))
    assert np.allclose(along, ((1 + slope) ** 2 - 1) / 2, atol=1e-12)
    assert np.ptp(across) == 0

    class Turning:
        def F(self, X: Floats, t: float) -> Floats:
            turn = np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]])
            return np.broadcast_to(turn, (len(X), 2, 2))

    rest: Any = Turning()
    assert max(s.max() for s in expected_strain(rest, made("bar")[0])) < 1e-15
    assert (Grading().crowding(np.zeros(3), 0.0) == 1).all()


@pytest.mark.parametrize("specification", ["graded", "graded:contrast=3,power=0.5", "thinned", "thinned:contrast=1.5"])
def test_a_graded_layout_tiles_the_body_and_is_finer_where_strain_is(specification: str) -> None:
    layout = laid(specification)
    assert layout.V0.sum() == pytest.approx(1.0, rel=1e-13)
    assert held(layout)[CENTRE] > held(layout).mean() > held(layout)[CORNER]
    wanted = create(LAYOUTS, specification).contrast
    side = sqrt(layout.V0.max() / layout.V0.min())
    assert 0.85 * wanted < side <= wanted * 1.001


def test_graded_keeps_the_number_and_thinned_the_packing() -> None:
    uniform, moved, fewer = (laid(s, ppc=9) for s in ("uniform", "graded", "thinned"))
    assert len(moved) == len(uniform) == 9 * 32**2
    assert 0.45 < len(fewer) / len(uniform) < 0.6
    assert fewer.V0.min() == pytest.approx(uniform.V0[0], rel=0.05)
    assert moved.V0.min() < 0.65 * uniform.V0[0]


def test_contrast_one_is_uniform() -> None:
    for specification in ("graded:contrast=1", "thinned:contrast=1"):
        assert np.allclose(laid(specification).X, laid("uniform").X, atol=1e-14)


def test_along_an_axis_without_change_the_layout_is_uniform() -> None:
    layout = laid("graded", "bar")
    assert np.ptp(layout.r0[:, 1, 1]) < 1e-15
    assert layout.r0[:, 0, 0].max() > 1.3 * layout.r0[:, 0, 0].min()


@pytest.mark.parametrize(
    ("specification", "words"),
    [
        ("graded:contrast=0.5", "contrast = 0.5 must be from 1"),
        ("graded:contrast=9", "contrast = 9 must be from 1"),
        ("thinned:power=0", "power = 0 must be above 0"),
        ("coarse", "choose from graded, thinned, uniform"),
    ],
)
def test_refused_in_one_line(specification: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        fixtures.built(layout=(specification,))


def test_a_ring_is_refused_before_anything_runs() -> None:
    with pytest.raises(ValueError, match="rectangles with sides in x and y; choose uniform"):
        fixtures.built(solution=("expanding_ring",), layout=("graded",))
    assert fixtures.built(solution=("expanding_ring",)).runs


def test_a_sweep_names_its_layout_and_expects_nothing_of_it() -> None:
    study = fixtures.built(layout=("graded:contrast=2.0",))
    assert {each.layout for each in study.runs} == {"graded"}  # the usual contrast
    assert not any(d.judged or d.expectation for d in study.plans)
    assert any(d.judged for d in fixtures.built().plans)
    assert named(Asked("mms", {"layout": ("thinned",)})).endswith("layout-thinned")


def test_outline_and_ratio_of_neighbours() -> None:
    edges = [np.array([0.0, 0.2, 0.6, 1.0]), np.array([0.0, 0.5, 1.0])]
    edge, steepest = outline(graded(edges))
    assert np.hypot(*(edge[:, 1] - edge[:, 0]).T).sum() == pytest.approx(4.0)
    assert steepest == pytest.approx(2.0)
    ring, _ = outline(annulus(0.5, 1.0, 0.1, 4))
    assert np.hypot(*(ring[:, 1] - ring[:, 0]).T).sum() == pytest.approx(3 * np.pi, rel=1e-2)


def test_full_cells_are_those_that_the_body_covers() -> None:
    """A square half a cell out of line fills one row and column less; a ring those that are wholly inside."""
    grid = Grid(0.1, np.zeros(2), np.ones(2))
    edge, _ = outline(rectangle(np.zeros(2), np.ones(2), 0.1, 4))
    assert full_cells(grid, edge).all()
    shifted = full_cells(grid, edge + 0.05)
    assert shifted.sum() == 81
    assert shifted[1:, 1:].all()
    grid = Grid(0.1, np.full(2, -1.5), np.full(2, 1.5))
    edge, _ = outline(annulus(0.55, 1.23, 0.02, 4))
    corners = np.stack(np.meshgrid(*[-1.5 + 0.1 * np.arange(31)] * 2, indexing="ij"), axis=-1)
    R, low = np.hypot(*np.moveaxis(corners, -1, 0)), np.abs(corners).min(axis=-1) < 1e-9
    around = np.stack([R[a : a + 30, b : b + 30] for a in (0, 1) for b in (0, 1)])
    assert not low[:30, :30].all()
    assert (full_cells(grid, edge) == ((around.max(axis=0) < 1.23) & (around.min(axis=0) > 0.55))).all()


def test_a_layout_with_an_empty_cell_is_refused_with_its_cell() -> None:
    result, _ = case.execute(run("thinned:contrast=4"))
    assert result.status == "failed"
    assert result.failure == Failure(FailureKind.EMPTY_CELL, 0, -1, result.failure.cell)
    i, j = result.failure.cell or (-1, -1)
    assert held(laid("thinned:contrast=4", cells=16), 16)[i, j] == 0
    assert failures.failure(result.failure).endswith(f"at step 0 in cell ({i}, {j})")
    assert result.packed is not None
    assert result.packed.widest > 1
    assert result.steps == 0


def test_the_fewest_particles_of_a_run_are_kept() -> None:
    """Uniform 1 leaves cells empty where the body stretches, 4 do not; a layout says how wide its domains are."""
    one, four, thin = (
        case.execute(run(s, ppc=n))[0].packed for s, n in (("uniform", 1), ("uniform", 4), ("thinned", 4))
    )
    assert one is not None and four is not None and thin is not None  # noqa: PT018 - for the types
    assert (one.fewest, one.widest, one.steepest) == (0, pytest.approx(1.0), pytest.approx(1.0))
    assert four.fewest in (1, 2)
    assert thin.fewest == 1
    assert 0.9 < thin.widest <= 1
    assert 1.05 < thin.steepest < 1.3


def test_cells_at_the_edge_of_a_ring_may_hold_none() -> None:
    """Its grid has cells without particles all around; the one that is named lies wholly in the ring."""
    ring = create(SOLUTIONS, "expanding_ring")
    model, comparison, _ = case.setup(
        replace(run("uniform", cells=32, solution="expanding_ring"), material=ring.material)
    )
    comparison.packing.begin(model)
    packed = comparison.packing.packed
    assert packed.fewest is not None
    assert packed.fewest >= 2
    assert packed.cell is not None
    corners = model.grid.lower + model.grid.dx * np.add(packed.cell, [[0, 0], [0, 1], [1, 0], [1, 1]])
    R = np.hypot(*corners.T)
    assert R.min() > ring.inner
    assert R.max() < ring.outer


def test_fewer_particles_where_little_happens_cost_gimp_little() -> None:
    """Measured: 0.54 of the particles, 1.04 of the error of u; uniform layouts need 1.8 times as many for it."""
    uniform, thinned = (case.execute(run(s, "gimp"))[0] for s in ("uniform", "thinned"))
    assert thinned.particles / uniform.particles == pytest.approx(0.54, abs=0.02)
    assert thinned.errors["u"]["rms"] / uniform.errors["u"]["rms"] == pytest.approx(1.04, abs=0.05)
    assert thinned.scale["u"] == pytest.approx(uniform.scale["u"], rel=0.01)  # by volume, not by particles


def stored(of: Run, particles: int, steps: int, error: float) -> Result:
    """A Result with that error in every norm."""
    errors = {q: dict.fromkeys(NORMS, error) for q in QUANTITIES}
    return Result(
        run=of, digest=of.digest, status="finished", errors=errors, steps=steps, particles=particles, dt=1.0,
        wall_s=1.0, peak_memory_mb=1.0,
    )  # fmt: skip


def test_what_a_layout_saves() -> None:
    """Uniform errors fall as 1/N on each grid, so the factor is the error's share times the number's, inverted."""
    runs = [run("uniform", ppc=n, cells=c) for c in (16, 32) for n in (1, 4, 9)]
    results = [stored(r, r.ppc * r.cells**2, r.cells, 1 / (r.ppc * r.cells**2)) for r in runs]
    thin = run("thinned", cells=16)
    for particles, error, expected in (
        (512, 1 / 1024, Bounded(2.0)),
        (512, 1 / 9999, Bounded(4.5, "at_least")),
        (512, 1.0, Bounded(0.5, "at_most")),
    ):
        mine = stored(thin, particles, 16, error)
        found = savings([*runs, thin], {r.run.digest: r for r in [*results, mine]})
        assert len(found) == 1
        assert found[0].same_grid == Bounded(pytest.approx(expected.value), expected.bound)
        assert (found[0].particles, found[0].errors) == (pytest.approx(0.5), pytest.approx(1024 * error))
    mine = stored(thin, 512, 16, 1 / 1100)
    every = savings([*runs, thin], {r.run.digest: r for r in [*results, mine]})[0].any_grid
    assert every == pytest.approx(2 * (1100 / 1024) ** 1.5)  # 4 per cell from 16 to 32 cells: updates ~ error^-1.5


def test_cost_of_an_error() -> None:
    assert cost_of(0.1, [(1.0, 1.0), (100.0, 0.01)]) == pytest.approx(10.0)
    assert cost_of(0.1, [(100.0, 0.01), (1.0, 1.0)]) == pytest.approx(10.0)  # in any order
    assert cost_of(2.0, [(1.0, 1.0), (100.0, 0.01)]) is None
    assert cost_of(0.5, [(1.0, 0.1), (2.0, 1.0)]) is None  # it rises through the error
    assert factor(0.1, 5.0, []) is None


def test_the_study_grades_only_what_stays_packed() -> None:
    study = build_graded(Plan(("cpdi",), ("localised",), (16, 32)), "", "graded")
    found = {(kind(r), r.ppc) for r in study.runs}
    assert found == {
        ("uniform", 1),
        ("uniform", 4),
        ("uniform", 9),
        *((k, n) for k in ("graded", "thinned") for n in (4, 9)),
    }
    assert len(study.runs) == 7 * 2
    assert not any(d.judged for d in study.plans)
    with pytest.raises(ValueError, match="a contrast of 4 needs 16 particles per cell or more"):
        build_graded(Plan(contrast=4), "", "graded")
    assert len({replace(r, layout="").digest for r in study.runs}) < len(study.runs)


@pytest.mark.parametrize("name", available(LAYOUTS))
def test_every_layout_keeps_the_area_and_shifts(name: str) -> None:
    plugin, exact = made("localised")
    there = create(LAYOUTS, name)(plugin, exact, 1 / 16, 4, (0.3, -0.2))
    assert there.V0.sum() == pytest.approx(1.0, rel=1e-13)
    assert abs(there.X.mean(axis=0) - laid(name, cells=16).X.mean(axis=0)).max() > 0
