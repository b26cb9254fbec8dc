"""Edges of an exported benchmark: friction, traction and travel are told, and what has no record is refused."""

from dataclasses import replace
from math import cos, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.benchmark.case import canonical
from mpm_verify.cases.benchmark.edges import EdgeRecord, edges, pushed_nodes
from mpm_verify.cases.benchmark.exported import exported
from mpm_verify.cases.benchmark.pressed import Smooth
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.reports.export.benchmark_folder import write
from mpm_verify.solver.boundary import moving
from mpm_verify.solver.friction import FrictionalWalls
from mpm_verify.solver.model import Model
from mpm_verify.solver.plugins import PROBLEMS, available, create
from mpm_verify.solver.pushed import PushedWalls


def model(problem: str, cells: int) -> Model:
    run = Run(**canonical({"problem": problem, "cells": cells}))
    found: Model = run.stated.setup(run).model
    return found


def told(problem: str, cells: int, folder: Path) -> tuple[Any, str]:
    """Record of an exported benchmark, and its README."""
    case = exported(problem, None, cells, None, 0.4)
    write(folder, case, create(PROBLEMS, problem))
    return case.record, (folder / "README.md").read_text()


@pytest.mark.parametrize("problem", ["sliding_block:mu=0.6", "rolling_cylinder:mu=0.6"])
def test_friction_is_told(problem: str, tmp_path: Path) -> None:
    record, readme = told(problem, 8, tmp_path)
    assert record.edges["bottom"] == EdgeRecord("frictional", 0.6, (0.0, 0.0))
    assert [record.edges[side].kind for side in ("left", "right", "top")] == ["free"] * 3
    assert "- bottom: frictional, friction coefficient 0.6\n" in readme
    assert "at most the friction coefficient times the normal one" in readme


def test_the_wall_of_rankine_and_its_surcharge_are_told(tmp_path: Path) -> None:
    record, readme = told("rankine:q=1e5", 4, tmp_path)
    (wall,) = record.pushed
    assert record.edges["right"].kind == "pushed"
    assert (wall.lower, wall.upper, wall.axis, wall.surface) == ((5.0, 0.0), (5.0, 5.0), "x", "smooth")
    assert record.duration == pytest.approx(2 * wall.duration, rel=1e-12)  # out and back
    assert record.edges["top"] == EdgeRecord("free", 0.0, (0.0, -1e5))
    assert "traction on the body 0.0, -100000.0" in readme
    assert f"distance = {wall.distance} m and duration = {wall.duration} s; they are smooth" in readme


@pytest.mark.parametrize(("problem", "surface"), [("footing", "rough"), ("footing:rough=0", "smooth")])
def test_the_strip_is_told(problem: str, surface: str, tmp_path: Path) -> None:
    """Up to the last node before its edge, which lies in the middle of a cell; and both bounds of its pressure."""
    record, readme = told(problem, 9, tmp_path)
    (strip,) = record.pushed
    assert record.edges["top"].kind == "free"
    assert (strip.axis, strip.surface) == ("y", surface)
    assert strip.upper[0] == pytest.approx(1.0 - record.dx / 2)
    assert strip.lower == (0.0, record.grid_upper[1])
    assert [(one.way, one.least) for one in record.known if one.name == "bearing"] == [("relative", 9), ("at_least", 0)]
    assert "within 0.02 of it | the limit of refinement, of 9 cells or more" in readme
    assert "| bearing | at least" in readme


@pytest.mark.parametrize("problem", available(PROBLEMS))
def test_what_walls_do_is_in_the_record(problem: str) -> None:
    """Every component that a model holds, each friction coefficient and each travel."""
    made = model(problem, 9 if problem == "footing" else 16)
    walls, kinds, nodes = made.walls, edges(made), pushed_nodes(made)
    assert isinstance(walls, FrictionalWalls) == any(edge.kind == "frictional" for edge in kinds.values())
    assert isinstance(walls, PushedWalls) == bool(nodes)
    if isinstance(walls, FrictionalWalls):
        assert {edge.friction for edge in kinds.values()} - {0.0} == set(walls.mu[walls.normal != 0])
    if isinstance(walls, PushedWalls):
        scope = {"pi": pi, "cos": cos, "distance": nodes[0].distance, "duration": nodes[0].duration}
        for t in np.linspace(0.0, 2.0, 7) * nodes[0].duration:
            assert eval(nodes[0].formula, scope | {"t": t}) == pytest.approx(walls.travel(t), abs=1e-20)


def test_what_has_no_record_is_refused() -> None:
    made = model("footing", 9)
    walls = made.walls
    assert isinstance(walls, PushedWalls)
    made.walls = replace(walls, travel=lambda t: t)
    with pytest.raises(ValueError, match=r"has no formula; take cases/benchmark/pressed\.py: Smooth"):
        pushed_nodes(made)
    made.walls = replace(walls, there=walls.there & (np.arange(len(walls.there)) // made.grid.ny % 2 == 0))
    with pytest.raises(ValueError, match="fill no rectangle"):
        pushed_nodes(made)
    held = walls.held.copy()
    held[made.grid.nodes[:, 1] < 1.0] = False
    made.walls = replace(walls, held=held, travel=Smooth(1.0, 1.0))
    with pytest.raises(ValueError, match="nodes of the left edge differ"):
        edges(made)
    made.walls = moving(made.grid, lambda nodes, t, dt: (walls.held, walls.value, walls.rate))
    with pytest.raises(ValueError, match="walls by a rule have no record"):
        edges(made)
