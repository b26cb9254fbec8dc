"""The granular column as a case: its contract (cases/harness/contract.py); what it is stands in execute.py."""

from collections.abc import Sequence
from dataclasses import replace

from mpm_verify.cases.column.exam import examine
from mpm_verify.cases.column.execute import material_of, setup, steps_of
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.cases.harness.build import Asked
from mpm_verify.solver.plugins import METHODS, create, label

__all__ = ["Result", "Run", "check", "examine"]

COMMAND = "column"

Run, Result = ColumnRun, ColumnResult


def title(runs: Sequence[ColumnRun]) -> str:
    """Title of a study of columns."""
    return "Collapse of granular columns" if len(runs) > 1 else "Collapse of a granular column"


def parts(asked: Asked) -> list[Asked]:
    """The study as it is asked for. Raises ValueError for a value that none of its runs would use."""
    given = asked.values
    walls = {*given.get("floor", (Run.floor,)), *given.get("left", (Run.left,))}
    if given.get("mu") and "frictional" not in walls:
        raise ValueError(
            f"mu = {given['mu'][0]} has no frictional floor or wall; add --floor frictional, or leave --mu out"
        )
    if given.get("damping_kind") and not any(given.get("damping", (Run.damping,))):
        kind = given["damping_kind"][0]
        raise ValueError(f"damping_kind = {kind!r} has no damping; add --damping 0.05, or leave --damping-kind out")
    return [asked]


def check(runs: Sequence[ColumnRun]) -> None:
    """Raise ValueError for what no column can have, by setting up a small one of each kind."""
    for run in runs:
        if run.courant > 1:
            raise ValueError(f"courant = {run.courant} is above the stability limit of 1; 0.4 is usual")
        steps_of(run, material_of(run))
        if create(METHODS, run.method).reference:
            raise ValueError(
                f"{label(run.method)} keeps its nodes in the reference configuration, where no grain of a column meets "
                "the floor or another grain; choose --method cpdi"
            )
    kinds = (replace(run, cells=2, ppc=4, aspect=7.0, channel=18.0, courant=0.4, duration=1e-3) for run in runs)
    for kind in dict.fromkeys(kinds):
        setup(kind)
