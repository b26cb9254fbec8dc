"""Error of u against the Courant number on the finest cells, log-log: a flat line is an error of space."""

from dataclasses import replace

from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from mpm_verify.cases.harness.axes import TimeAxis, time_axes
from mpm_verify.reports import words
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.figures.convergence import methods
from mpm_verify.reports.frames import Record

ENOUGH = 3  # time steps; two are a number in a table


def time_step(record: Record, solution: str, quantity: str = "u", norm: str = "rms") -> Figure | None:
    """Figure of one solution, None where no series has three time steps."""
    axes = time_axes(record.study.runs, record.results, quantity, norm)
    found = [a for a in axes if a.run.solution == solution and len(a.courants) >= ENOUGH and min(a.errors) > 0]
    if not found:
        return None
    with rc_context(style.RC):
        figure = Figure(figsize=style.PANEL, layout="constrained")
        _draw(figure, record, found)
        figure.axes[0].set_ylabel(f"error of {words.quantity(quantity)}, {norm}")
        style.legend(figure, methods(record), [(a.run.method, a.run.ppc) for a in found])
    return figure


def _draw(figure: Figure, record: Record, found: list[TimeAxis]) -> None:
    """Draw the errors, large time steps on the right."""
    axes = figure.subplots()
    for a in found:
        look = style.look(methods(record), a.run.method, a.run.ppc)
        lines = axes.plot(a.courants, a.errors, label=record.label(a.run, solution=False), **look.plot)
        drawn.of_runs(lines, [replace(a.run, courant=courant) for courant in a.courants])
    ticks = sorted({courant for a in found for courant in a.courants})
    axes.set(xscale="log", yscale="log", xlabel=f"Courant number, {found[0].run.cells} cells a side")
    axes.set_xticks(ticks, [f"{courant:g}" for courant in ticks])
    axes.xaxis.set_minor_locator(NullLocator())
    style.error_axis(axes)
