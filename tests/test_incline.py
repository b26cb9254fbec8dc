"""Benchmarks of an incline: a block that slides or sticks, a cylinder that rolls or slides, and what they alone see."""

import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from math import cos, pi, radians, sin, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.benchmark.case import canonical
from mpm_verify.cases.benchmark.execute import execute
from mpm_verify.cases.benchmark.problems.rolling_cylinder import RollingCylinder, disc
from mpm_verify.cases.benchmark.problems.sliding_block import SlidingBlock
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.cases.detect.defect import defects
from mpm_verify.cases.detect.plant import Planted, copied
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.solver._jit import use_threads

METHODS = ("mpm", "gimp", "cpdi", "bspline2")


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    use_threads(1)
    yield
    use_threads(2)


def made(problem: str, cells: int, method: str = "cpdi", **more: Any) -> Run:
    return Run(**canonical({"problem": problem, "cells": cells, "method": method, **more}))


def missed(run: Run) -> tuple[dict[str, float], list[str]]:
    """Values of a run, and the numbers that are not as they are held."""
    result, curves = execute(run)
    assert result.failure is None
    assert {name.split("/")[1] for name in curves} == set(run.stated.figures)
    found = [
        one.name
        for one in run.stated.held(run)
        if Check("", one.name, result.values[one.name], one.expected, one.way, "", one.within).outcome != Outcome.PASS
    ]
    return result.values, found


def test_closed_forms() -> None:
    """Accelerations by hand; a block sticks from tan(theta) on, a cylinder rolls from a third of it on."""
    slope = tan(radians(25))
    assert SlidingBlock().travel == pytest.approx(0.5 * 10 * (sin(radians(25)) - 0.3 * cos(radians(25))) * 0.25)
    assert SlidingBlock().travel == pytest.approx(0.188407, rel=1e-5)
    assert [SlidingBlock(mu=mu).slides for mu in (0.99 * slope, 1.01 * slope)] == [True, False]
    assert [RollingCylinder(mu=mu).rolls for mu in (0.99 * slope / 3, 1.01 * slope / 3)] == [False, True]
    at = replace(RollingCylinder(), mu=slope / 3 * (1 - 1e-12))
    assert at.accelerations == pytest.approx(replace(at, mu=0.3).accelerations)  # both forms meet where it begins
    assert RollingCylinder().accelerations == pytest.approx((2.817455, 5.634910), rel=1e-6)


@pytest.mark.parametrize("spacing", [0.25, 0.03])
def test_a_disc(spacing: float) -> None:
    """Area and moment of inertia are exact; no domain is much longer than wide."""
    layout = disc(0.5, spacing)
    assert layout.V0.sum() == pytest.approx(pi / 4, rel=1e-12)
    assert (layout.V0 * (layout.X**2).sum(axis=1)).sum() == pytest.approx(pi / 2 * 0.5**4, rel=1e-12)
    np.testing.assert_allclose(4 * np.abs(np.linalg.det(layout.r0)), layout.V0, rtol=1e-12)


@pytest.mark.parametrize(("problem", "cells"), [("sliding_block", 4), ("sliding_block:mu=0.6", 4)])
def test_a_block(problem: str, cells: int) -> None:
    values, wrong = missed(made(problem, cells))
    assert wrong == []
    assert abs(values["excess_friction"]) < 1e-12
    assert values["travel"] == pytest.approx(1.0062 if problem == "sliding_block" else 0.00088, rel=0.02, abs=1e-4)
    _, wrong = missed(made(problem, cells, control=True))
    assert set(wrong) == ({"travel", "excess_friction"} if problem == "sliding_block" else {"travel"})


def test_a_cylinder() -> None:
    """Cylinder that rolls, and slides in its failing control."""
    values, wrong = missed(made("rolling_cylinder", 8))
    assert wrong == []
    assert values["gap"] == pytest.approx(0.563, abs=0.02)
    assert values["turn"] == pytest.approx(0.871, abs=0.01)
    assert values["slip"] == pytest.approx(0.489, abs=0.01)  # of 0.58 at most
    _, wrong = missed(made("rolling_cylinder", 8, control=True))
    assert set(wrong) == {"gap", "slip"}


def test_what_is_held_of_a_cylinder_is_what_was_measured_of_it() -> None:
    """Both bounds of the gap and of the slip; of another cylinder, a coarse grid or more particles no measured one."""
    found = []
    for run in (
        made("rolling_cylinder", 8),
        made("rolling_cylinder", 16, "bspline2"),
        made("rolling_cylinder:theta=20", 8),
        made("rolling_cylinder", 4),
        made("rolling_cylinder", 8, ppc=9),
    ):
        found.append([(one.name, one.expected) for one in run.stated.held(run)][:4])
    usual, splines, *others = ([value for _, value in one] for one in found)
    assert usual == [0.45, 1.0, 0.0, 0.58]
    assert splines == [0.2, 1.0, 0.0, 0.58]
    assert others == [[0.0, 1.0, 0.0, 1.0]] * 3
    assert [name for name, _ in found[0]] == ["gap", "gap", "slip", "slip"]


@pytest.mark.parametrize(
    ("problem", "judged"),
    [
        ("sliding_block", True), ("sliding_block:mu=0.2", True), ("sliding_block:mu=0.6", True),
        ("sliding_block:mu=0.4", False), ("sliding_block:mu=0.47", False), ("sliding_block:E=1e5", False),
        ("rolling_cylinder", True), ("rolling_cylinder:mu=0.1", True), ("rolling_cylinder:mu=0.15", False),
        ("rolling_cylinder:theta=45,mu=0.9", False), ("rolling_cylinder:E=1e4", False),
    ],
)  # fmt: skip
def test_bands_are_held_where_they_were_measured(problem: str, judged: bool) -> None:
    """Friction is held to round-off everywhere."""
    one, soft = made(problem, 8), made(problem, 8, material="hypoelastic:E=1e6")
    assert {held.name for held in one.stated.held(one) if not held.unjudged} >= {"excess_friction"}
    assert all(not held.unjudged for held in one.stated.held(one)) is judged
    assert any(held.unjudged for held in soft.stated.held(soft))


def test_what_is_no_incline() -> None:
    for run, said in (
        (made("sliding_block:theta=70", 4), "theta must be above 0"),
        (made("sliding_block:theta=50,mu=0.9", 4), "tips; take a lower theta"),
        (made("sliding_block", 4, "tlmpm"), "are no floor; take cpdi"),
        (made("rolling_cylinder:mu=0", 8), "mu, g, R and T above zero"),
        (made("rolling_cylinder", 8, "tlmpm"), "are no floor; take cpdi"),
    ):
        with pytest.raises(ValueError, match=said):
            run.stated.check(run)


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("problem", "cells"),
    [("sliding_block", 8), ("sliding_block:mu=0.6", 8), ("rolling_cylinder", 8), ("rolling_cylinder:mu=0.1", 16)],
)
def test_each_method(problem: str, cells: int, method: str) -> None:
    """Each is as registered, and its failing control is not."""
    assert missed(made(problem, cells, method))[1] == []
    assert missed(made(problem, cells, method, control=True))[1]


ASK = """
from mpm_verify.cases.exact import battery
from mpm_verify.cases.exact.body import Subject
from mpm_verify.solver._jit import use_threads
use_threads(1)
tested = [one for group in ("friction", "walls") for one in battery.tested(group, Subject("cpdi", "hypoelastic"))]
print(*{one.test for one in tested if not one.passed})
from test_incline import made, missed
for problem, cells, method in (("sliding_block", 4, "cpdi"), ("rolling_cylinder", 8, "gimp")):
    print(problem, *missed(made(problem, cells, method))[1])
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "seen"),
    [
        ("friction-sticks-for-good", ["friction_course", "sliding_block travel excess_friction", "rolling_cylinder"]),
        ("friction-touches-once", ["friction_course", "sliding_block", "rolling_cylinder gap slip"]),
    ],
)
def test_a_defect_that_only_an_incline_sees(name: str, seen: list[str], tmp_path: Path) -> None:
    """Mistakes in what is kept from step to step: the course of a few steps sees them, and each problem sees one."""
    copy = copied(tmp_path)
    ways = {**os.environ, "PYTHONPATH": f"{copy}{os.pathsep}{Path(__file__).parent}"}
    with Planted(copy, defects()[name]):
        done = subprocess.run(
            [sys.executable, "-c", ASK], env=ways, cwd=copy, capture_output=True, text=True, check=True
        )
    assert [line.rstrip() for line in done.stdout.splitlines()] == seen
