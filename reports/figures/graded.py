"""Graded layouts against uniform ones: error against cost, a figure for each solution."""

from collections.abc import Iterator

from matplotlib.figure import Figure

from mpm_verify.cases.mms.graded import kind
from mpm_verify.cases.mms.run import Run
from mpm_verify.reports import words
from mpm_verify.reports.figures import style
from mpm_verify.reports.figures.cost import Line, Row, cost_figure
from mpm_verify.reports.frames import Record


def found(record: Record) -> bool:
    """Whether the study has a layout that is not uniform beside one that is."""
    return len({kind(run) for run in record.study.runs}) > 1


def figure(record: Record, solution: str, quantity: str = "u") -> Figure:
    """Error against cost on one solution: a row for each method, a line for each layout and count."""
    runs = [run for run in record.study.runs if run.solution == solution]
    methods = dict.fromkeys(run.method for run in runs)
    rows = [Row(words.method(m), list(lines([run for run in runs if run.method == m]))) for m in methods]
    return cost_figure(record, rows, quantity)


def lines(runs: list[Run]) -> Iterator[Line]:
    """Lines of one solution and method: colour and marker tell the layout, line and filling the count."""
    kinds = list(dict.fromkeys(map(kind, runs)))
    for layout, ppc in dict.fromkeys((kind(run), run.ppc) for run in runs):
        mine = [run for run in runs if (kind(run), run.ppc) == (layout, ppc)]
        yield Line(f"{layout}, {ppc}", mine, style.look(kinds, layout, ppc).plot)
