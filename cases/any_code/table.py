"""Study of a table: its rows as runs, levels that the order rule can take, and what is expected of them."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import isfinite

from mpm_verify.cases.any_code.reading import Row, Table
from mpm_verify.cases.any_code.run import HALF, NORM, Run
from mpm_verify.cases.harness.build import axes
from mpm_verify.cases.harness.study import QuantityPlan, Study, head
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.cases.judging.richardson import FORMAL

HIGHEST = 20.0  # order that is expected
WIDEST = 1e9  # ratio of cell sizes
USUAL = Expectation(FORMAL)  # of the band


@dataclass(frozen=True)
class Expected:
    """Expectation that a table is held against.

    Parameters
    ----------
    order, below, above
        Expected order and its band; without an order nothing is judged.
    floor
        Round-off floor of the numbers, in their unit.
    exact
        Whether the numbers are errors; otherwise they are values of a quantity.
    steady
        Whether there is no time step.

    Raises
    ------
    ValueError
        One line for an order, a band or a floor that cannot be.
    """

    order: float | None = None
    below: float = USUAL.below
    above: float = USUAL.above
    floor: float = 0.0
    exact: bool = True
    steady: bool = False

    def __post_init__(self) -> None:
        if self.order is not None and not 0 < self.order <= HIGHEST:
            raise ValueError(f"--order {self.order:g} must be above 0 and at most {HIGHEST:g}, such as 2")
        if not (0 < self.below < HIGHEST and 0 < self.above < HIGHEST):
            raise ValueError(f"--below {self.below:g} and --above {self.above:g} must both be above 0, such as 0.2 0.3")
        if not 0 <= self.floor < float("inf"):
            raise ValueError(f"--floor {self.floor:g} must be a finite error from 0 on, such as 1e-12")

    @property
    def registered(self) -> Expectation | None:
        """Expectation of each refinement."""
        return None if self.order is None else Expectation(self.order, self.below, self.above, source="the command")


Key = tuple[str, str]  # method and quantity
Levels = dict[float, list[Row]]  # rows by one over their cell size, the usual replicate first


def study(table: Table, expected: Expected, command: str, name: str, words: Sequence[str] = ()) -> Study[Run]:
    """Study of a table.

    Parameters
    ----------
    table
        Rows of a file, see reading.py.
    expected
        What is registered.
    command, name, words
        See cases/harness/study.py.

    Returns
    -------
    Study
        A run for each row, and one more where it says the number with half the time step; a plan for each method and
        quantity.

    Raises
    ------
    ValueError
        One line for rows that stand at the same point, or that contradict what is expected.
    """
    if expected.steady and any(row.half is not None for row in table.rows):
        raise ValueError(f"{table.path} says half a time step, and --steady that there is none; leave one out")
    found = grouped(table)
    runs = [run for key, levels in found.items() for run in runs_of(table, key, levels, expected)]
    first = {head(run): run for run in reversed(runs)}
    plans = [
        QuantityPlan(run, run.measured, NORM, expected.order is not None, expected.registered)
        for run in sorted(first.values(), key=lambda run: list(found).index((run.method, run.measured)))
    ]
    title = f"Refinement in {table.path.name}"
    return Study(name, title, command, tuple(runs), tuple(plans), axes(runs), tuple(words), 0, Run.case)


def grouped(table: Table) -> dict[Key, Levels]:
    """Rows of each method and quantity by cell size. Raises ValueError for two rows at the same point."""
    found: dict[Key, Levels] = {}
    for row in table.rows:
        levels = found.setdefault((row.method, row.quantity), {})
        same = levels.setdefault(row.cells, [])
        if earlier := next((one for one in same if one.replicate == row.replicate), None):
            raise ValueError(twice(table, earlier, row))
        same.append(row)
    return found


def twice(table: Table, earlier: Row, row: Row) -> str:
    """Line on two rows at the same point."""
    size = f"cells = {row.cells:.15g}" if table.by == "cells" else f"h = {row.h:.6g}"
    of = " ".join(name for name in (row.method, row.quantity) if name)
    words = "give a column replicate for repeated runs, or method or quantity for what differs"
    there = f"replicate {row.replicate} of {size}" if row.replicate else size
    here, before = (f"{table.word} {one.line}" for one in (row, earlier))
    return f"{table.path}, {here}: {there} of {of} is there already, in {before}; {words}"


def runs_of(table: Table, key: Key, levels: Levels, expected: Expected) -> Iterable[Run]:
    """Runs of one refinement, coarse to fine. Raises ValueError for values with replicates, or on one level."""
    sizes = sorted(levels)
    if sizes[-1] > WIDEST * sizes[0]:
        ends = f"{1 / sizes[0]:.3g} to {1 / sizes[-1]:.3g}"
        raise ValueError(f"{table.path}: cell sizes of {' '.join(key)} go from {ends}, which is no refinement")
    if not expected.exact:
        check_values(table, key, levels)
    steps = differences([levels[cells][0].number for cells in sizes])
    last = next((step for step in reversed(steps) if step), 0.0)
    for at, cells in enumerate(sizes[0 if expected.exact else 1 :]):
        for number, row in enumerate(levels[cells]):
            for courant, value in ((1.0, row.number), (HALF, row.half)):
                if value is None:
                    continue
                run = Run(
                    method=row.method, measured=row.quantity, cells=cells, courant=courant,
                    offset=(float(number), 0.0), exact=expected.exact, steady=expected.steady, number=value,
                    floor=expected.floor, by=table.by, line=row.line,
                )  # fmt: skip
                yield run if expected.exact else compared(run, levels[sizes[at]][0], steps[at] * last < 0, expected)


def compared(run: Run, coarser: Row, turns: bool, expected: Expected) -> Run:
    """Run of a value beside the next coarser level."""
    order = FORMAL if expected.order is None else expected.order
    return replace(run, coarser=coarser.number, coarser_h=coarser.h, turns=turns, order=order)


def check_values(table: Table, key: Key, levels: Levels) -> None:
    """Raise ValueError where no level has a coarser one, or where one has several values."""
    again = next((rows[1] for rows in levels.values() if len(rows) > 1), None)
    if again:
        raise ValueError(
            f"{table.path}, {table.word} {again.line}: replicates of values are not taken; write their mean in one row"
        )
    if len(levels) < 2:
        raise ValueError(f"{table.path} has one level of {' '.join(key)}; without an exact solution write two at least")


def differences(values: Sequence[float]) -> list[float]:
    """Steps from each level to the next finer one; zero where one of them is not a number."""
    return [b - a if isfinite(a) and isfinite(b) else 0.0 for a, b in pairwise(values)]
