"""Savings of graded layouts: a row for each run, and for each layout over its runs."""

from statistics import median

from mpm_verify.cases.mms.graded import Bounded, Saving, kind, savings
from mpm_verify.cases.mms.run import Run
from mpm_verify.reports import words
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import label

COLUMNS = (
    "solution", "method", "layout", "per cell", "cells", "particles", "fewest", "error", "particles x", "error x",
    "same grid", "any grid",
)  # fmt: skip
MEANING = (
    "fewest: particles in a full cell, the least over the run. particles x, error x: over those of the uniform layout "
    "with as many per cell. same grid: particles that a uniform layout needs for that error on that grid, over those "
    "of the run; any grid: the same of particle updates, of the cheapest grid and count. Above 1 the layout saves."
)
OVERVIEW = ("solution", "method", "layout", "error of", "particles x", "error x", "saves", "needs more")
WHAT = (
    "particles x, error x: over those of the uniform layout with as many per cell, median and ends over the runs. "
    "saves, needs more: in how many runs a uniform layout on the same grid needs clearly more, or fewer, particles "
    "for that error."
)
CLEAR = 1.1  # a factor nearer to 1 says neither more nor less
SIGNS = {"": "", "at_least": "> ", "at_most": "< "}


def shown(record: Record) -> Table:
    """Table of all runs for the page."""
    caption = "What each layout costs and saves, in u"
    return Table(caption, COLUMNS, tuple(table(record)), heads=3)


def table(record: Record, quantity: str = "u") -> list[tuple[str, ...]]:
    """Rows, one for each run, solution by solution; see MEANING."""
    saved = {saving.result.run: saving for saving in savings(record.study.runs, record.results, quantity)}
    return [row(record, run, saved.get(run), quantity) for run in record.study.runs]


def row(record: Record, run: Run, saving: Saving | None, quantity: str) -> tuple[str, ...]:
    """Row of one run; a failed one says so."""
    result, error = record.result(run), record.error(run, quantity, "rms")
    head = (label(run.solution), words.method(run.method), kind(run), str(run.ppc), str(run.cells))
    if result is None:
        return (*head, *[words.DASH] * 3, *[""] * 4)
    fewest = result.packed.fewest if result.packed else None
    size = (str(result.particles), words.DASH if fewest is None else str(fewest))
    if error is None:
        return (*head, *size, "failed", *[""] * 4)
    return (*head, *size, words.sci(error), *(factors(saving) if saving else [""] * 4))


def factors(saving: Saving) -> tuple[str, str, str, str]:
    """Cells of the last four columns."""
    return two(saving.particles), two(saving.errors), bounded(saving.same_grid), two(saving.any_grid)


def two(factor: float | None) -> str:
    """Factor with two decimals; a dash for nothing."""
    return words.DASH if factor is None else f"{factor:.2f}"


def bounded(factor: Bounded | None) -> str:
    """Factor such as 1.80, or > 1.80 where no more is known."""
    return words.DASH if factor is None else SIGNS[factor.bound] + two(factor.value)


def overview(record: Record) -> Table:
    """Table of what each layout saves over its runs: a row for each solution, method, layout and quantity."""
    rows = []
    for quantity in ("u", "sigma"):
        kinds: dict[tuple[str, str, str], list[Saving]] = {}
        for saving in savings(record.study.runs, record.results, quantity):
            run = saving.result.run
            kinds.setdefault((run.solution, run.method, kind(run)), []).append(saving)
        rows += [summed(*key, quantity, found) for key, found in kinds.items()]
    return Table("What graded layouts save, over all runs of each", OVERVIEW, tuple(rows), heads=4)


def summed(solution: str, method: str, layout: str, quantity: str, found: list[Saving]) -> tuple[str, ...]:
    """One row of the overview."""
    head = (label(solution), words.method(method), layout, words.quantity(quantity))
    count = [s.particles for s in found if s.particles is not None]
    ratio = [s.errors for s in found if s.errors is not None]
    if not ratio:
        return (*head, *[words.DASH] * 4)
    known = [s.same_grid for s in found if s.same_grid is not None]
    more = sum(f.value > CLEAR and f.bound != "at_most" for f in known)
    less = sum(f.value < 1 / CLEAR and f.bound != "at_least" for f in known)
    return (*head, spread(count), spread(ratio), f"{more} of {len(found)}", f"{less} of {len(found)}")


def spread(factors: list[float]) -> str:
    """Median and ends: `1.9 (1.6 to 2.2)`."""
    ends = [f"{value:.2f}" for value in (median(factors), min(factors), max(factors))]
    return ends[0] if ends[1] == ends[2] else f"{ends[0]} ({ends[1]} to {ends[2]})"
