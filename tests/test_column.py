"""The collapsing column: invariants of the run, what keeps it alive, and what its measures say of known shapes."""

from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.column.execute import Gate, execute, gravity, setup
from mpm_verify.cases.column.measure import Measure, connected, final, quantile, surface
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.cases.column.start import oedometric
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.step import advance

SMALL = ColumnRun(cells=4, ppc=4, duration=0.3)


def went(run: ColumnRun, steps: int) -> Any:
    """The model after so many steps."""
    model, _ = setup(run)
    for _ in range(steps):
        advance(model, gravity)
    return model


@pytest.fixture(scope="module")
def done() -> Any:
    return execute(SMALL)


def test_budgets_close(done: Any) -> None:
    """Energy, momentum and mass; each term has the sign it must have."""
    result, arrays = done
    assert (result.status, result.failure) == ("finished", None)
    first = float(arrays["curve_potential"][0])
    assert result.values["unbalanced"] < 1e-12
    assert result.values["most_momentum_lost"] < 1e-9
    assert result.values["most_mass_lost"] < 1e-13
    assert result.values["misworked"] < 2e-3
    assert result.values["plastic_falls"] < 1e-4
    assert arrays["curve_potential"][-1] < 0.5 * first
    assert arrays["curve_kinetic"].max() > 0.1 * first
    assert arrays["curve_walls"][-1] < 0 < arrays["curve_plastic"][-1]
    assert (np.diff(arrays["curve_plastic"]) > -1e-3 * first).all()
    assert 0 < arrays["curve_elastic"].max() < 0.02 * first


@pytest.mark.parametrize("name", ["kinetic", "potential", "damping", "walls", "transfer"])
def test_a_term_that_is_wrong_is_seen(name: str) -> None:
    """One per cent too much of a term that matters is a residual; no term is the rest of the others."""
    _, arrays = execute(replace(SMALL, damping=0.05))
    wrong = arrays["curve_residual"] + 0.1 * (arrays[f"curve_{name}"] - arrays[f"curve_{name}"][0])
    first = float(arrays["curve_potential"][0])
    assert np.abs(wrong).max() > np.abs(arrays["curve_residual"]).max() + 1e-4 * first


def test_particles_that_gain_energy_are_seen() -> None:
    """Velocities that grow by themselves are in no term, and a material that works too much is not in the forces."""
    model, steps = setup(SMALL)
    measure = Measure(SMALL, model)
    measure.look(model)
    for _ in range(steps):
        advance(model, gravity)
        model.particles.v *= 1 + 2e-4
        model.particles.work *= 1 + 2e-4
    measure.look(model)
    values = final(SMALL, measure.curves())
    assert values["unbalanced"] > 0.01
    assert values["misworked"] > 0.01


@pytest.mark.slow
def test_crossings_make_energy_in_classical_mpm() -> None:
    """The work of its forces is another than that of its stress; of the others it is the same to a thousandth."""
    worked = {
        m: execute(replace(SMALL, method=m, duration=0.6))[0].values["misworked"] for m in ("mpm", "gimp", "cpdi")
    }
    assert worked["mpm"] > 0.1
    assert max(worked["gimp"], worked["cpdi"]) < 2e-3


def test_the_collapse(done: Any) -> None:
    """Run-out, monotonously in its front, and into a heap that falls off from the wall."""
    result, arrays = done
    front, profile = arrays["curve_front_99"], arrays["curve_profile"]
    assert np.diff(front).min() > -1e-3
    assert front[-1] > 3 * result.run.width
    assert profile[0, 0] == pytest.approx(result.run.height, rel=0.05)
    assert result.values["front_99"] <= result.values["front_999"]
    assert 0 < result.values["most_void"] < 1
    assert profile.shape[1] == result.run.channel * 4  # strips are as wide as the cells, where those are this wide
    assert 0.9 < result.values["area"] < 1.2
    assert arrays["curve_crowding"][0] == pytest.approx(1, abs=1e-6)
    assert 0.9 < arrays["curve_crowding"].max() < 1.3


def test_what_is_kept(done: Any) -> None:
    result, arrays = done
    assert arrays["frame_x"].shape[1:] == (result.particles, 2)
    assert arrays["snapshot_t"][[0, -1]] == pytest.approx([0, SMALL.duration])
    count = len(arrays["snapshot_t"])
    for name, shape in {"F": (2, 2), "sigma": (4,), "corners": (4, 2), "void": ()}.items():
        assert arrays[f"snapshot_{name}"].shape == (count, result.particles, *shape)
    np.testing.assert_array_equal(arrays["snapshot_x"][-1], arrays["frame_x"][-1])
    corners = arrays["snapshot_corners"][0]
    np.testing.assert_allclose(corners.mean(axis=1), arrays["snapshot_x"][0], atol=1e-6)


def test_density_and_modulus_scaled_together() -> None:
    """Friction without cohesion has no stress of its own: the same positions, to round-off, and scaled stresses."""
    one, other = (went(replace(SMALL, material=f"mohr_coulomb:{p}"), 300) for p in ("E=840e3", "E=504e3,rho0=1590"))
    np.testing.assert_allclose(other.particles.x, one.particles.x, atol=1e-9)
    np.testing.assert_allclose(other.particles.sigma / 0.6, one.particles.sigma, atol=1e-4)
    moved = np.abs(one.particles.x - one.particles.X).max()
    assert moved > 1e-2
    stiffer = went(replace(SMALL, material="mohr_coulomb:E=1680e3,rho0=2650", courant=0.4 * 2**0.5), 300)
    assert np.abs(stiffer.particles.x - one.particles.x).max() > 1e-4  # E alone is not without effect


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"material": "ubcsand", "start": "oedometric"},
        {"smoothing": "deviatoric", "damping": 0.05},
        {"gate": 2.0, "left": "fixed"},
        {"gate": 2.0, "floor": "frictional", "left": "frictional"},
    ],
    ids=str,
)
def test_a_mirrored_column_is_the_mirror_image(change: Any) -> None:
    one, other = (went(replace(SMALL, mirror=m, **change), 300) for m in (False, True))
    end = other.grid.upper[0]
    x = other.particles.in_initial_order("x")
    per_column = 7 * 4 * 2
    image = x.reshape(-1, per_column, 2)[::-1].reshape(-1, 2) * [-1, 1] + [end, 0]
    np.testing.assert_allclose(image, one.particles.in_initial_order("x"), atol=1e-9)
    assert np.abs(one.particles.x - one.particles.X).max() > 5e-3


@pytest.mark.parametrize(
    ("change", "gone"),
    [
        ({"method": "mpm"}, 0.9),
        ({"method": "gimp"}, 0.9),
        ({"material": "drucker_prager"}, 0.9),
        ({"material": "ubcsand", "start": "oedometric", "duration": 0.15}, 0.1),
        ({"start": "k0"}, 0.9),
        ({"damping": 0.05}, 0.9),
        ({"smoothing": "deviatoric", "left": "fixed"}, 0.9),
        ({"gate": 1.0}, 0.5),
        ({"floor": "frictional", "left": "frictional"}, 0.9),
    ],
    ids=str,
)
def test_what_else_there_is(change: Any, gone: float) -> None:
    """End, fall, and a budget that closes."""
    result, arrays = execute(replace(SMALL, **{"duration": 0.25, **change}))
    assert result.failure is None
    assert result.values["unbalanced"] < 5e-3
    assert arrays["curve_front_99"][-1] > (1 + gone) * SMALL.width
    assert result.values["most_momentum_lost"] < 1e-9
    assert (result.values["damping"] > 0) == ("damping" in change)


def test_a_floor_with_friction(done: Any) -> None:
    """The less friction, the further it runs; friction takes energy in each step, as much as all walls do; a
    coefficient counts where there is friction."""
    fronts = [done[0].values["front_99"]]
    for mu in (0.47, 0.1):
        result, arrays = execute(replace(SMALL, floor="frictional", mu=mu))
        fronts.append(result.values["front_99"])
        first = float(arrays["curve_potential"][0])
        assert result.values["unbalanced"] < 1e-12
        assert result.values["most_momentum_lost"] < 1e-9
        assert (np.diff(arrays["curve_friction"]) >= 0).all()
        assert result.values["friction"] > 0.01 * first
        assert result.values["friction"] == pytest.approx(-result.values["walls"], rel=0.1)
    assert fronts == sorted(fronts)
    assert fronts[2] > 1.05 * fronts[0]
    assert done[0].values["friction"] == 0.0
    assert replace(SMALL, mu=0.1).digest == SMALL.digest
    assert replace(SMALL, mu=0.1, floor="frictional").digest != replace(SMALL, floor="frictional").digest
    for wrong, said in (({"mu": -0.1}, "mu = -0.1 must be zero or more"), ({"floor": "sandy"}, "floor = 'sandy' must")):
        with pytest.raises(ValueError, match=said):
            replace(SMALL, **wrong)


def test_a_step_that_is_too_long_is_a_failed_run() -> None:
    result, arrays = execute(replace(SMALL, courant=5.0))
    assert result.failure
    assert result.failure.kind is FailureKind.UNSTABLE_STEP
    assert result.failure.numbers["dt"] > result.failure.numbers["limit"]
    assert (result.steps, len(arrays["curve_t"]), result.values["t"]) == (0, 1, 0.0)


def test_a_smoothed_run_that_flies_apart_is_a_failed_run() -> None:
    """Smoothing looks into cells: for a particle that has left the grid there is none."""
    run = replace(SMALL, cells=3, smoothing="volumetric:into=history,where=node", damping=0.3, duration=1.0)
    result, _ = execute(replace(run, damping_kind="objective"))
    assert result.failure
    assert result.failure.kind is FailureKind.OUTSIDE_GRID
    for position in (np.nan, -1.0, 1e30):
        model, _ = setup(replace(SMALL, smoothing="volumetric"))
        model.particles.x[5, 0] = position
        with pytest.raises(RunFailed, match=r"outside_grid|not_finite"):
            advance(model, gravity)


def test_undamped_runs_are_one_run() -> None:
    """No damping is of no kind."""
    one, other = (replace(SMALL, damping_kind=kind) for kind in ("local", "objective"))
    assert one.digest == other.digest
    assert replace(one, damping=0.1).digest != replace(other, damping=0.1).digest


def test_without_what_keeps_it_alive() -> None:
    """The plain scheme fails; its failure is a result."""
    result, _ = execute(replace(SMALL, limit=inf, void=False, deformation="linear", duration=0.6))
    assert result.status == "failed"
    assert result.failure
    assert 0 < result.failure.step < 0.6 / result.dt
    assert result.values["t"] < 0.6


def test_the_stress_at_first() -> None:
    """Rest, vertical stress of the weight above, K0 of Jaky; oedometric: admissible, of the material's own path."""
    model, _ = setup(replace(SMALL, start="k0"))
    p = model.particles
    weight = 2650 * 10 * (SMALL.height - p.x[:, 1])
    np.testing.assert_allclose(p.sigma[:, 1], -weight)
    np.testing.assert_allclose(p.sigma[:, 0] / p.sigma[:, 1], 1 - np.sin(np.radians(31)))
    sigma, history = (rows[1:] for rows in oedometric(Ubcsand(), 5e3))  # the first is free of stress
    K0 = sigma[:, 0] / sigma[:, 1]
    assert np.interp(5e3, -sigma[:, 1], K0) == pytest.approx(0.523, abs=2e-3)
    assert np.interp(5e3, -sigma[:, 1], history[:, 0]) == pytest.approx(0.313, abs=2e-3)
    sigma, _ = oedometric(MohrCoulomb(), 5e3)
    more = sigma[-1] - sigma[1]  # beyond the isotropic stress that it starts from
    assert more[0] / more[1] == pytest.approx(0.3 / 0.7, rel=1e-9)  # elastic


def test_a_column_behind_a_closed_gate_stays() -> None:
    """The gate holds it: a gate that does not move lets nothing through, and one that is gone lets it fall."""
    shut, gone = (execute(replace(SMALL, gate=gate, duration=0.1, start="k0")) for gate in (1e-9, 1e9))
    assert shut[1]["curve_front_99"][-1] < 1.01 * SMALL.width < gone[1]["curve_front_99"][-1]
    model, _ = setup(replace(SMALL, gate=1.0))
    assert isinstance(model.walls.rule, Gate)  # type: ignore[attr-defined]


def test_measures_of_known_shapes() -> None:
    """A triangle of equal masses with two flyers: its toe, its surface and its percentiles."""
    grid = np.stack(np.meshgrid(np.arange(0.05, 10, 0.1), np.arange(0.05, 5, 0.1)), axis=-1).reshape(-1, 2)
    heap = grid[grid[:, 1] < 5 - grid[:, 0] / 2]
    x = np.vstack([heap, [[11.0, 0.1], [4.0, 4.9]]])
    m = np.ones(len(x))
    inside = connected(x, 0.5)
    assert inside[: len(heap)].all()
    assert not inside[len(heap) :].any()
    heights = surface(heap, np.ones(len(heap)), 0.5, 30)
    np.testing.assert_allclose(heights[:18], 5 - (np.arange(18) + 0.5) / 4, atol=0.2)
    assert (heights[20:] == 0).all()
    assert quantile(x[:, 0], m, 0.5) == pytest.approx(10 * (1 - 0.5**0.5), abs=0.06)
    assert quantile(x[:, 0], m, 1.0) == 11.0


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"ppc": 3}, "not a square number"),
        ({"cells": 1}, "choose whole numbers from 2 to"),
        ({"cells": 2000}, "from 2 to 1000"),
        ({"channel": 7.3}, "must make whole cells"),
        ({"damping_kind": "x"}, "must be one of local, objective"),
        ({"limit": 0.0}, "or inf"),
        ({"g": 1e300}, "must be at most"),
        ({"material": "mohr_coulomb:rho0=1e-300"}, "steps would be needed"),
        ({"duration": 0.0}, "must be above zero"),
        ({"aspect": 0.3}, "must make whole cells"),
        ({"start": "wet"}, "must be one of none, k0, oedometric"),
        ({"left": "rubber"}, "must be one of roller, fixed"),
        ({"material": "neo_hookean"}, "must have a material in rate form"),
        ({"smoothing": "rough"}, "no smoothing"),
        ({"limit": 0.0}, "must be above zero"),
        ({"material": "hypoelastic", "start": "k0"}, "must have a material with an angle of friction"),
        ({"damping": 1.5}, "must lie from 0"),
        ({"deformation": "cubic"}, "choose from linear, exponential"),
        ({"channel": 1.0}, "must be from 2 to 100"),
    ],
    ids=str,
)
def test_refusals(change: Any, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        setup(replace(SMALL, **change))


@pytest.mark.parametrize("changes", [{"duration": 1e-6}, {"duration": 1e-9}, {"duration": 0.01, "damping": 0.99}])
def test_a_column_that_has_had_no_time_to_fall_is_not_at_rest(changes: dict[str, float]) -> None:
    """Column that stands as still as a heap at its end."""
    result, _ = execute(replace(SMALL, **changes))
    assert result.status == "finished"
    assert result.values["rest"] == inf


def test_a_step_above_the_stability_limit_is_told_before_the_run() -> None:
    with pytest.raises(ValueError, match="above the stability limit of 1"):
        case_named("column").check([replace(SMALL, courant=5.0)])
