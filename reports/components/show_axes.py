"""Tables of the axes beside the cells: time step, particles per cell, position of the particles in their cells."""

from mpm_verify.cases.harness.axes import particle_axes, position_axes, time_axes
from mpm_verify.cases.judging.fit import Fit
from mpm_verify.reports import words
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import label

CONFIDENCE = 0.95


def time_step(record: Record) -> Table:
    """Error of u in rms at each time step, the order from the one before, and the fraction of the first time step."""
    rows = []
    for a in time_axes(record.study.runs, record.results):
        name = f"{record.label(a.run)}, cell size {words.cell_size(a.run.cells)}"
        name += f"; fraction of the time step {words.percent(a.fractions[0])}"
        for courant, error, order in zip(a.courants, a.errors, (None, *a.orders), strict=True):
            rows.append((name, f"{courant:g}", words.sci(error), "" if order is None else words.order(order)))
    head = ("series", "Courant number", "error", "order")
    return Table("Error of u in rms against the Courant number", head, tuple(rows), heads=2, grouped=True)


def particles(record: Record) -> Table:
    """Error of u in rms with each particle count, and the order in the spacing of the particles."""
    rows = []
    for a in particle_axes(record.study.runs, record.results):
        name = words.method(a.run.method) + (f", {label(a.run.solution)}" if len(record.solutions) > 1 else "")
        name += f", cell size {words.cell_size(a.run.cells)}"
        for count, error, order in zip(a.ppc, a.errors, (None, *a.orders), strict=True):
            rows.append((name, str(count), words.sci(error), "" if order is None else words.order(order)))
    head = ("series", "particles per cell", "error", "order")
    return Table("Error of u in rms against the particles per cell", head, tuple(rows), heads=2, grouped=True)


def scatter(record: Record) -> Table:
    """Smallest, middle and largest error of u in rms over the replicates."""
    rows = []
    for a in position_axes(record.study.runs, record.results):
        for cells, errors, (low, mid, high) in zip(a.cells, a.errors, a.ends, strict=True):
            ratio = f"{high / low:.2f}" if low else words.DASH
            ends = (words.sci(e) for e in (errors[0], low, mid, high))
            rows.append((record.label(a.run), words.cell_size(cells), str(len(errors)), *ends, ratio))
    head = ("series", "cell size", "runs", "usual position", "smallest", "median", "largest", "largest / smallest")
    return Table("Error of u in rms over the positions of the particles", head, tuple(rows), heads=2, grouped=True)


def intervals(record: Record) -> Table:
    """Fitted order and its interval, from the usual positions alone and from all replicates."""
    rows = [
        (record.label(a.run), *_interval(a.alone), *_interval(a.together))
        for a in position_axes(record.study.runs, record.results)
    ]
    head = ("series", "order, usual position", "95 % interval", "order, all positions", "95 % interval of the scatter")
    return Table("Order of u in rms with and without the other positions", head, tuple(rows))


def _interval(fit: Fit) -> tuple[str, str]:
    slope = fit.slope
    return (words.order(slope.value), words.interval(slope.interval(CONFIDENCE))) if slope else (words.DASH, words.DASH)
