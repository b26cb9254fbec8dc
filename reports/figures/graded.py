"""What graded layouts save: error against cost for each solution and method, a table, and a sentence each."""

from collections.abc import Iterator
from statistics import median

from matplotlib.figure import Figure

from cases.graded_study import Bounded, Saving, kind, savings
from cases.study import Run
from reports import style, words
from reports.figures.cost import Line, Row, cost_figure
from reports.show import Table
from reports.stored import Record

COLUMNS = (
    "solution", "method", "layout", "per cell", "cells", "particles", "fewest", "error", "particles x", "error x",
    "same grid", "any grid",
)  # fmt: skip
MEANING = (
    "fewest: particles in a full cell, the least over the run. particles x, error x: over those of the uniform layout "
    "with as many per cell. same grid: particles that a uniform layout needs for that error on that grid, over those "
    "of the run; any grid: the same of particle updates, of the cheapest grid and count. Above 1 the layout saves."
)
CLEAR = 1.1  # a factor nearer to 1 says neither more nor less
SIGNS = {"": "", "at_least": "> ", "at_most": "< "}


def found(record: Record) -> bool:
    """Whether the study has a layout that is not uniform beside one that is."""
    return len({kind(run) for run in record.study.runs}) > 1


def figure(record: Record, solution: str, quantity: str = "u") -> Figure:
    """Error against cost on one solution: a row a method, a line a layout and particle count."""
    runs = [run for run in record.study.runs if run.solution == solution]
    methods = dict.fromkeys(run.method for run in runs)
    rows = [Row(words.method(m), list(lines([run for run in runs if run.method == m]))) for m in methods]
    return cost_figure(record, rows, quantity)


def lines(runs: list[Run]) -> Iterator[Line]:
    """The refinements of one solution and method: colour and marker tell the layout, line and filling the count."""
    kinds = list(dict.fromkeys(map(kind, runs)))
    for layout, ppc in dict.fromkeys((kind(run), run.ppc) for run in runs):
        mine = [run for run in runs if (kind(run), run.ppc) == (layout, ppc)]
        yield Line(f"{layout}, {ppc}", mine, style.look(kinds, layout, ppc).plot)


def shown(record: Record) -> Table:
    """The same for the page."""
    caption = "What each layout costs and saves, in u"
    return Table(caption, COLUMNS, tuple(table(record)), heads=3)


def table(record: Record, quantity: str = "u") -> list[tuple[str, ...]]:
    """A row a run, solution by solution; see MEANING."""
    saved = {saving.result.run: saving for saving in savings(record.study.runs, record.results, quantity)}
    return [row(record, run, saved.get(run), quantity) for run in record.study.runs]


def row(record: Record, run: Run, saving: Saving | None, quantity: str) -> tuple[str, ...]:
    """One run; a failed one by its reason."""
    result, error = record.result(run), record.error(run, quantity, "rms")
    head = (run.solution, words.method(run.method), kind(run), str(run.ppc), str(run.cells))
    if result is None:
        return (*head, *[words.DASH] * 3, *[""] * 4)
    fewest = result.packed.fewest if result.packed else None
    size = (str(result.particles), words.DASH if fewest is None else str(fewest))
    if error is None:
        return (*head, *size, "failed", *[""] * 4)
    return (*head, *size, words.sci(error), *(factors(saving) if saving else [""] * 4))


def factors(saving: Saving) -> tuple[str, str, str, str]:
    """The last four columns."""
    return two(saving.particles), two(saving.errors), bounded(saving.same_grid), two(saving.any_grid)


def two(factor: float | None) -> str:
    """Two decimals; a dash for nothing."""
    return words.DASH if factor is None else f"{factor:.2f}"


def bounded(factor: Bounded | None) -> str:
    """1.80, or > 1.80 where no more is known."""
    return words.DASH if factor is None else SIGNS[factor.bound] + two(factor.value)


def statements(record: Record, quantity: str = "u") -> list[str]:
    """What each layout does, one sentence a solution, method and layout."""
    kinds: dict[tuple[str, str, str], list[Saving]] = {}
    for saving in savings(record.study.runs, record.results, quantity):
        run = saving.result.run
        kinds.setdefault((run.solution, run.method, kind(run)), []).append(saving)
    return [sentence(*key, found, quantity) for key, found in kinds.items()]


def sentence(solution: str, method: str, layout: str, found: list[Saving], quantity: str) -> str:
    """`localised, MPM, graded: 1 times the particles, 0.71 (0.60 to 0.87) times the error of u ...`: over its runs."""
    share = [s.particles for s in found if s.particles is not None]
    ratio = [s.errors for s in found if s.errors is not None]
    head = f"{solution}, {words.method(method)}, {layout}: "
    if not ratio:
        return head + "no uniform run to compare with."
    text = f"{spread(share)} times the particles, {spread(ratio)} times the error of {words.quantity(quantity)}"
    known = [s.same_grid for s in found if s.same_grid is not None]
    more = sum(f.value > CLEAR and f.bound != "at_most" for f in known)
    less = sum(f.value < 1 / CLEAR and f.bound != "at_least" for f in known)
    saves = f"for that error on that grid it saves particles in {more} of {len(found)} runs and needs more in {less}"
    return f"{head}{text}; {saves}."


def spread(factors: list[float]) -> str:
    """Median and ends: `1.9 (1.6 to 2.2)`."""
    ends = [f"{value:.2f}" for value in (median(factors), min(factors), max(factors))]
    return ends[0] if ends[1] == ends[2] else f"{ends[0]} ({ends[1]} to {ends[2]})"
