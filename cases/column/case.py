"""The granular column as a case: its contract (cases/harness/contract.py); what it is stands in execute.py."""

from collections.abc import Sequence
from dataclasses import replace

from mpm_verify.cases.column.exam import examine
from mpm_verify.cases.column.execute import material_of, setup, steps_of
from mpm_verify.cases.column.run import ColumnResult, ColumnRun
from mpm_verify.solver.plugins import METHODS, create, label

__all__ = ["Result", "Run", "check", "examine"]

Run, Result = ColumnRun, ColumnResult


def title(runs: Sequence[ColumnRun]) -> str:
    """Title of a study of columns."""
    return "Collapse of granular columns" if len(runs) > 1 else "Collapse of a granular column"


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
