"""Edges of own solutions that are pulled or driven: kinds, points and forces, orders of u, export."""

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.mms.execute import execute, setup
from mpm_verify.cases.mms.expectations import expected
from mpm_verify.cases.mms.run import Run
from mpm_verify.cases.mms.stability import check_time_steps
from mpm_verify.mms.blind_spots import OPEN, BlindSpotCode
from mpm_verify.mms.edges import examine
from mpm_verify.mms.export.case import Names, export
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.mms.measure import open_sides
from mpm_verify.reports.export.case_folder import words
from mpm_verify.reports.sentences.blind_spots import sentence
from mpm_verify.solver import surface as module
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.model import check_time_step
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.surface import STIFFNESS, Surface

SINE = "sp.sin(50*sp.pi*t)**2"
MOTIONS = {  # displacement, corners, more of domain(), and the kinds that are found
    "turn": ("[s*(c*x - d*y) - x, s*(d*x + c*y) - y]", ((-0.5, -0.5), (0.5, 0.5)), "", ("pulled",) * 4),
    "all move": (f"[A*{SINE}*sp.exp(x**2)*sp.sin(y), A*{SINE}*(sp.log(3+y)*sp.cos(x)+sp.sin(y))]",
                 ((0, 0), (1, 1)), "", ("pulled",) * 4),
    "bending": (f"[A*{SINE}*(x**2*y*(1-y)+x*y**2*(1-y)**2), A*{SINE}*x*(1-x)*sp.sin(2*sp.pi*y)]",
                ((0, 0), (1, 1)), "", ("fixed", "pulled", "fixed", "fixed")),
    "piston": (f"[5*A*x*{SINE}, 0]", ((0, 0), (1, 1)), "", ("fixed", "pulled", "roller", "roller")),
    "tapered": (f"[4*A*sp.sin(sp.pi*x/3)*{SINE}, 0]", ((0, 0), (1, 1)), "", ("fixed", "pulled", "roller", "roller")),
}  # fmt: skip
Write = Callable[..., str]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def text(name: str, boundary: Any = None, duration: float = 0.02) -> str:
        u, (lower, upper), more, _ = MOTIONS[name]
        held = "" if boundary is None else f", 'boundary': {boundary!r}"
        path = tmp_path / f"{name.replace(' ', '_')}.py"
        path.write_text(
            f"""import sympy as sp
def displacement(X, t, A=0.01):
    x, y = X
    w = 20 if {name == "turn"} else 0
    s = 1 + sp.sin(w*t)/20
    c, d = sp.cos(sp.sin(w*t)/5), sp.sin(sp.sin(w*t)/5)
    return sp.Matrix({u})
def domain():
    return {{"lower": {lower}, "upper": {upper}, "duration": {duration}, "speed": 100{more}{held}}}
"""
        )
        return str(path)

    return text


def run(path: str, cells: int, **more: Any) -> Run:
    return Run(solution=path, material="neo_hookean", cells=cells, **more)


def error(path: str, cells: int, **more: Any) -> float:
    result, _ = execute(run(path, cells, **more))
    assert result.failure is None
    return float(result.errors["u"]["rms"])


def orders(path: str, cells: tuple[int, ...], **more: Any) -> list[float]:
    errors = [error(path, n, **more) for n in cells]
    steps = np.log(np.array(cells[1:]) / cells[:-1])
    return list(np.log(np.array(errors[:-1]) / errors[1:]) / steps)


@pytest.mark.parametrize("name", MOTIONS)
def test_kinds_that_are_found(write: Write, name: str) -> None:
    """An edge that is no wall and not free is pulled, and the audit tells it as found."""
    solution: Any = create(SOLUTIONS, write(name))
    assert solution.sides == MOTIONS[name][3]
    assert set(open_sides(solution).values()) == {OPEN["found"]}
    named: Any = create(SOLUTIONS, write(name, tuple("prescribed" if k == "pulled" else k for k in solution.sides)))
    assert set(open_sides(named).values()) == {OPEN["prescribed"]}
    assert (named.margin > 0) is True if np.ndim(named.margin) == 0 else (named.margin > 0).any()


def test_what_the_audit_says(write: Write) -> None:
    from mpm_verify.mms.audit import audit

    material: Any = create(MATERIALS, "neo_hookean")
    said = []
    for path in (write("piston"), write("bending", ("fixed", "prescribed", "fixed", "pulled"))):
        solution: Any = create(SOLUTIONS, path)
        spots = audit(manufacture(solution, material, material.rho0), solution, material).spots
        said += [sentence(spot) for spot in spots if spot.code is BlindSpotCode.EDGES]
    assert said[0].startswith("The right edge is pulled by the exact traction: an edge that is no wall and not free is")
    assert (
        said[1]
        == "The top edge is pulled by the exact traction and the right edge is driven by the exact displacement."
    )


def test_an_edge_may_be_named_what_another_kind_is_too(write: Write) -> None:
    """A free edge may be pulled, by nothing; and a wall that moves cannot be fixed."""
    solution: Any = create(SOLUTIONS, write("piston", ("fixed", "fixed", "roller", "roller")))
    material: Any = create(MATERIALS, "neo_hookean")
    wrong = examine(solution, manufacture(solution, material, material.rho0), material).wrong(solution.sides)
    assert wrong.startswith("the right edge cannot be fixed: its normal displacement is 0.05 at")
    assert wrong.endswith('it is pulled or prescribed: write that, or leave "boundary" out')


@pytest.mark.parametrize("method", ["cpdi", "mpm"])
def test_points_lie_on_the_edge_with_its_length_and_normals(write: Write, method: str) -> None:
    model, comparison, _ = setup(run(write("turn"), 8, method=method, offset=(0.3, -0.2)))
    surface = model.surface
    assert surface is not None
    assert surface.area.sum() == pytest.approx(4.0, rel=1e-14)
    np.testing.assert_allclose((surface.area[:, None] * surface.N).sum(axis=0), 0.0, atol=1e-14)
    np.testing.assert_allclose((surface.X * surface.N).sum(axis=1), 0.5, atol=1e-14)  # outwards
    np.testing.assert_allclose(surface.x, comparison.exact.x(surface.X, 0.0), atol=1e-15)
    assert len(surface.X) == 2 * 4 * 16


def test_the_first_forces_are_those_of_the_exact_fields(write: Write) -> None:
    """A body in uniform stress at t: on all nodes inner forces and tractions cancel."""
    model, comparison, _ = setup(run(write("piston", "pulled"), 8))
    exact, p, t = comparison.exact, model.particles, 0.005
    model.steps = round(t / model.dt)
    p.x[:], p.F[:], p.sigma[:] = exact.x(p.X, t), exact.F(p.X, t), exact.sigma(p.X, t)
    from mpm_verify.solver.step import particles_to_grid

    p.b[:] = 0.0
    particles_to_grid(model)
    alone = np.abs(model.grid.force).max()
    assert model.surface is not None
    model.surface.act(model)
    assert np.abs(model.grid.force).max() < 1e-13 * alone


def test_a_gap_is_pulled_shut(write: Write) -> None:
    """The spring of a driven edge, beside the traction of the particle's own stress, which is that of the exact one."""
    model, comparison, _ = setup(run(write("piston", "prescribed"), 8))
    surface, material = model.surface, model.material
    assert surface is not None
    gap = np.array([1e-3, -2e-3])
    before = surface.traction(model)
    np.testing.assert_allclose(before, 0.0, atol=1e-12)
    surface.x -= gap
    stiffness = STIFFNESS * 1000 * material.wave_speed() ** 2 / model.grid.dx * material.rho0 / 1000
    np.testing.assert_allclose(surface.traction(model), np.tile(stiffness * gap, (len(surface.x), 1)), rtol=1e-12)
    assert comparison.lag > 0


def test_an_edge_that_leaves_the_grid_ends_the_run(write: Write) -> None:
    model, _, _ = setup(run(write("turn"), 8, method="mpm"))
    surface = model.surface
    assert surface is not None
    surface.x += 10.0
    for act in (surface.act, surface.move):
        with pytest.raises(RunFailed) as ended:
            act(model)
        assert ended.value.failure.kind is FailureKind.OUTSIDE_GRID


@pytest.mark.parametrize(
    ("name", "boundary", "recorded"),
    [("tapered", None, 2.185e-4), ("all move", ("prescribed", "pulled", "prescribed", "pulled"), 2.148e-4)],
)
def test_order_of_u(write: Write, name: str, boundary: Any, recorded: float) -> None:
    """CPDI on 8 and 16 cells: one edge that is pulled, and all edges, of both kinds; magnitude and order."""
    coarse, fine = (error(write(name, boundary), n) for n in (8, 16))
    assert coarse == pytest.approx(recorded, rel=0.01)
    assert np.log2(coarse / fine) == pytest.approx(1.94 if name == "tapered" else 1.81, abs=0.02)


FINE = [
    *((name, "pulled", "cpdi") for name in MOTIONS), ("all move", "pulled", "cpdi2"),
    *((name, "prescribed", "cpdi") for name in ("all move", "bending", "tapered")), ("all move", "prescribed", "cpdi2"),
    ("all move", "pulled", "tlmpm"), ("turn", "pulled", "tlmpm"), ("all move", "prescribed", "tlmpm"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(("name", "kind", "method"), FINE)
def test_order_two_from_16_to_32_cells(write: Write, name: str, kind: str, method: str) -> None:
    found = MOTIONS[name][3]
    path = write(name, tuple(kind if k == "pulled" else k for k in found), 0.1 if name == "turn" else 0.02)
    assert 1.9 < orders(path, (16, 32), method=method)[0] < 2.2


def test_what_is_expected(write: Write) -> None:
    """Order 2 of CPDI with edges of any kind; nothing where F is uniform and one is driven, nor of GIMP: it stalls."""
    driven = ("fixed", "prescribed", "roller", "roller")

    def order(path: str, method: str) -> float | None:
        known = expected(method, path, "neo_hookean", 4, "u", "rms")
        return known and known.order

    assert [order(write("tapered", kinds), "cpdi") for kinds in (None, driven)] == [2.0, 2.0]
    assert order(write("piston"), "cpdi") == 2.0
    assert order(write("piston", driven), "cpdi") is None
    assert order(write("tapered"), "gimp") is None


@pytest.mark.slow
@pytest.mark.parametrize("method", ["mpm", "gimp", "cpgimp", "bspline2", "bspline3"])
def test_order_two_of_every_method_while_no_particle_crosses(write: Write, method: str) -> None:
    """Surface particles, at an amplitude of 1e-7."""
    assert orders(write("all move") + ":A=1e-7", (16, 32), method=method)[0] == pytest.approx(2.0, abs=0.06)


@pytest.mark.slow
def test_a_long_run_with_driven_edges(write: Write) -> None:
    """Ten periods have twice the error of one: the spring takes out what the own traction puts in."""
    short, long = (error(write("all move", "prescribed", duration), 16) for duration in (0.02, 0.2))
    assert long < 2 * short


def late(patch: pytest.MonkeyPatch) -> None:
    """Data of the step before."""
    traction = Surface.traction

    def wrong(self: Any, model: Any) -> Any:
        model.steps -= 1
        found = traction(self, model)
        model.steps += 1
        return found

    patch.setattr(Surface, "traction", wrong)


SPOILT = {  # how, and the kind of edge that it spoils
    "late": (late, "pulled"),
    "no traction of its own": (
        lambda patch: patch.setattr(module, "own_traction", lambda particles, rows, N: 0.0 * N), "prescribed"
    ),
    "no spring": (lambda patch: patch.setattr(module, "STIFFNESS", 0.0), "prescribed"),
}  # fmt: skip


@pytest.mark.parametrize("name", SPOILT)
def test_orders_see_what_is_wrong_at_an_edge(write: Write, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Data a step late, or the spring without the own traction, make u of first order."""
    plant, kind = SPOILT[name]
    plant(monkeypatch)
    assert orders(write("piston", ("fixed", kind, "roller", "roller")), (8, 16))[0] < 1.4


@pytest.mark.parametrize(("kind", "courant", "stable"), [("pulled", 0.8, True), ("prescribed", 0.8, False),
                                                         ("prescribed", 0.5, True)])  # fmt: skip
def test_steps_are_shorter_with_driven_edges(write: Write, kind: str, courant: float, stable: bool) -> None:
    """The limit is 0.6 dx / (c + |v|) there, before anything runs and in the run."""
    path = write("tapered", ("fixed", kind, "roller", "roller"))
    one = run(path, 8, courant=courant)
    model, _, _ = setup(one)
    with nullcontext() if stable else pytest.raises(RunFailed):
        check_time_step(model)
    with nullcontext() if stable else pytest.raises(ValueError, match=r"above the stability limit of 0.51\d; .*--cour"):
        check_time_steps([one], [courant])


@pytest.mark.slow
@pytest.mark.parametrize("stress", ["musl", "usf"])
def test_flip_keeps_noise_beside_a_prescribed_edge(write: Write, stress: str) -> None:
    """Order below 1 on 8 and 16 cells where usl has 2 and apic 1.8; the run says so of itself."""
    path = write("all move", "prescribed")
    assert orders(path, (8, 16), stress=stress)[0] < 1.0
    assert orders(path, (8, 16), stress=stress, transfer="apic")[0] > 1.75
    assert run(path, 8, stress=stress).edge_noise
    others = ({"stress": "usl"}, {"stress": stress, "transfer": "apic"}, {"stress": stress, "transfer": "pic"})
    assert not any(run(path, 8, **other).edge_noise for other in others)
    assert not run(write("all move"), 8, stress=stress).edge_noise


def test_a_total_lagrangian_method_refuses_cut_domains_at_open_edges(write: Write) -> None:
    """Shifted particles do not converge there: 2.0e-3 on 8 and 16 cells; between walls, and of CPDI, they run."""
    open_, held = write("all move", "prescribed"), "clamped_shear"
    for more, said in (
        ({"offset": [(0.25, 0.1)]}, "beside edges that are prescribed"),
        ({"replicates": 3}, "replicates"),
    ):
        replicates = more.pop("replicates", 1)
        asked: dict[str, Any] = {"method": ["tlmpm"], "cells": [8, 16], "ppc": [4], **more}
        with pytest.raises(ValueError, match=said) as told:
            build(Asked("mms", {**asked, "solution": [open_]}, replicates), "verify")
        assert "\n" not in str(told.value)
        build(Asked("mms", {**asked, "solution": [held]}, replicates), "verify")
        build(Asked("mms", {**asked, "solution": [open_], "method": ["cpdi"]}, replicates), "verify")
    coarse, fine = (error(open_, n, method="tlmpm", offset=(0.25, 0.1)) for n in (8, 16))
    assert fine > 0.9 * coarse > 1e-3


def test_export_says_what_acts(write: Write) -> None:
    """Kinds in case.json, and P from the exported deformation and stress."""
    solution: Any = create(SOLUTIONS, write("bending", ("fixed", "prescribed", "fixed", "pulled")))
    material: Any = create(MATERIALS, "neo_hookean")
    case = export(Names("bending", "neo_hookean"), solution, material, 8, 4, checked=False)
    assert case.record.edges == {"left": "fixed", "right": "prescribed", "bottom": "fixed", "top": "pulled"}
    assert case.record.grid_upper[0] > 1.0
    assert case.record.grid_lower == (0.0, 0.0)
    text = words(case.record)
    assert "- top: pulled, the traction P N acts per reference area" in text
    assert "- right: prescribed, its points X are at X + `displacement(X, t)`" in text
    assert "P = det F sigma F^-T" in text
    names: dict[str, Any] = {}
    exec(next(case.sources[name] for name in case.sources if name.endswith(".py")), names)
    exact, X = manufacture(solution, material, material.rho0), np.array([[0.3, 1.0], [0.9, 1.0]])
    F, s = (np.array([names[name](row, 0.006) for row in X]) for name in ("deformation", "stress"))
    F = F.reshape(-1, 2, 2)
    P = np.linalg.det(F)[:, None, None] * s[:, [0, 3, 3, 1]].reshape(-1, 2, 2) @ np.linalg.inv(F).transpose(0, 2, 1)
    np.testing.assert_allclose(P, exact.P(X, 0.006), rtol=1e-11)
