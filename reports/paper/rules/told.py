"""Answers from claims of the column: numbers of the runs that a claim compares, and those that are crowded."""

from collections.abc import Mapping
from typing import Any

from mpm_verify.cases.column.claims import CROWDED
from mpm_verify.cases.column.records import MEASURES, Claim, Compared, FinishedRun
from mpm_verify.reports.paper.records import Answer, NotStoredError
from mpm_verify.solver.plugins import label

BOUNDS = ("crowded", "near", "little", "marked", "close", "scatter", "until")  # of a claim's numbers


def length_of(claim: Claim, at: Mapping[str, Any]) -> str:
    """Measure that the claim is read by: that of its front or height; empty of one that hangs on neither."""
    kind = next((kind for kind, names in MEASURES.items() if set(names) & claim.by.keys()), "")
    return str(at[kind]) if kind else ""


def reproduced(claim: Claim, at: Mapping[str, Any]) -> bool | None:
    """Answer of a claim by the measure that is read. Raises NotStoredError where its runs do not have that."""
    measure = length_of(claim, at)
    if measure and measure not in claim.by:
        raise NotStoredError(measure)
    return claim.by[measure] if measure else claim.reproduced


def answer(at: Mapping[str, Any], **parts: Claim) -> Answer:
    """Answer of which each part is a claim."""
    numbers: dict[str, float] = {}
    crowded: dict[str, float] = {}
    for claim in parts.values():
        measure = length_of(claim, at)
        for one in claim.runs:
            if measure:
                numbers[f"{measure}, {named(claim.axis, one)} [m]"] = one.lengths[measure]
            if one.crowding > CROWDED:
                crowded[named(claim.axis, one)] = one.crowding
        numbers |= {name: value for name, value in claim.numbers.items() if name not in BOUNDS}
    return Answer({name.replace("_", " "): reproduced(claim, at) for name, claim in parts.items()}, numbers, crowded)


def named(axis: str, run: Compared) -> str:
    """Name of a run by its value on the axis."""
    return value_of(axis, run.value)


def value_of(axis: str, value: Any) -> str:
    """Value on an axis in words."""
    if axis == "ppc":
        return f"{value} per cell"
    if axis == "damping":
        return f"{100 * value:g} % damping"
    if axis == "cells":
        return f"{value} cells"
    return {"none": "no smoothing"}.get(str(value), label(str(value)))


def crowded(axis: str, ran: list[FinishedRun]) -> dict[str, float]:
    """Crowding of runs that are crowded."""
    each = {value_of(axis, getattr(one.run, axis)): one.values["crowding"] for one in ran}
    return {name: value for name, value in each.items() if value > CROWDED}
