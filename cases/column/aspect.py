"""Run-out against the aspect ratio a = h0/d0 of columns, and the scaling of experiments in channels.

Texts quote that of Lube, Huppert, Sparks & Freundt 2005 (doi:10.1103/PhysRevE.72.041301) in two forms of the run-out
(d - d0)/d0: 1.2 a and 1.9 a^(2/3), and 1.6 a and 2.2 a^(2/3), of squat and of tall columns; they change between a = 1.8
and 2.8. No primary text was at hand, see cases/column/experiment.py.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from mpm_verify.cases.column.claims import values
from mpm_verify.cases.column.experiment import Band
from mpm_verify.cases.column.records import MEASURES, FinishedRun

FACTORS = ((1.2, 1.9), (1.6, 2.2))  # of a, and of a^(2/3), in each form
BETWEEN = (1.8, 2.8)  # aspects at which one scaling goes over into the other
ENOUGH = 24  # cells of the height: with fewer a squat column falls short


@dataclass(frozen=True)
class Point:
    """A column at rest: aspect, run-out over the width, by the usual front, cells of its height, and crowding.

    `by`: the run-out by each measure of the front that the run has.
    """

    aspect: float
    run_out: float
    cells: int
    crowding: float
    by: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Line:
    """Columns that differ in aspect, and in cells as that asks for, by aspect; `shared` on the other axes."""

    shared: dict[str, Any]
    points: tuple[Point, ...]


def scaling(aspect: float) -> Band:
    """Least and largest run-out over the width that the forms of the scaling give for an aspect."""
    squat = [linear * aspect for linear, _ in FACTORS] if aspect <= BETWEEN[1] else []
    tall = [power * aspect ** (2 / 3) for _, power in FACTORS] if aspect >= BETWEEN[0] else []
    return min(squat + tall), max(squat + tall)


def lines(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Line]:
    """Lines of a study that varies the aspect; none of another, and of fewer than three aspects."""
    if "aspect" not in axes:
        return []
    others = [axis for axis in axes if axis not in ("aspect", "cells")]
    grouped: dict[str, list[FinishedRun]] = {}
    for one in ran:
        grouped.setdefault(str(values(one.run, others)), []).append(one)
    found = []
    for group in grouped.values():
        if len({one.run.aspect for one in group}) > 2:
            points = sorted((point(one) for one in group), key=lambda at: (at.aspect, at.cells))
            found.append(Line(values(group[0].run, others), tuple(points)))
    return found


def point(one: FinishedRun) -> Point:
    """Point of a run."""
    run = one.run
    by = {name: one.lengths[name] / run.width - 1 for name in MEASURES["front"] if name in one.lengths}
    run_out = (one.front - run.width) / run.width
    return Point(run.aspect, run_out, round(run.aspect * run.cells), one.values["crowding"], by)
