"""Tables of the axes beside the cells: time step, particles per cell, position of the particles in their cells."""

from itertools import pairwise

from mpm_verify.cases.harness.axes import particle_axes, position_axes, time_axes
from mpm_verify.cases.judging.fit import Fit
from mpm_verify.reports import words
from mpm_verify.reports.components.show import Table
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import label

CONFIDENCE = 0.95
ARROW = "→"


def time_step(record: Record) -> Table:
    """Error of u in rms at each time step, the order between them, and the fraction of the first time step."""
    axes = time_axes(record.study.runs, record.results)
    courants = sorted({courant for a in axes for courant in a.courants}, reverse=True)
    pairs, rows = list(pairwise(courants)), []
    for a in axes:
        errors = dict(zip(a.courants, a.errors, strict=True))
        orders = dict(zip(pairwise(a.courants), a.orders, strict=True))
        cells = (words.sci(errors.get(courant)) for courant in courants)
        steps = (words.order(orders.get(pair)) for pair in pairs)
        rows.append((record.label(a.run), words.cell_size(a.run.cells), *cells, *steps, words.percent(a.fractions[0])))
    head = [f"C = {courant:g}" for courant in courants] + [f"order {a:g} {ARROW} {b:g}" for a, b in pairs]
    return Table(
        "Error of u in rms against the Courant number C",
        ("series", "cell size", *head, "fraction of the time step"),
        tuple(rows),
        heads=2,
    )


def particles(record: Record) -> Table:
    """Error of u in rms with each particle count, and the order in the spacing of the particles."""
    axes = particle_axes(record.study.runs, record.results)
    counts = sorted({count for a in axes for count in a.ppc})
    pairs, rows = list(pairwise(counts)), []
    for a in axes:
        errors = dict(zip(a.ppc, a.errors, strict=True))
        orders = dict(zip(pairwise(a.ppc), a.orders, strict=True))
        name = words.method(a.run.method) + (f", {label(a.run.solution)}" if len(record.solutions) > 1 else "")
        cells = (words.sci(errors.get(count)) for count in counts)
        rows.append((name, words.cell_size(a.run.cells), *cells, *(words.order(orders.get(pair)) for pair in pairs)))
    head = [f"{count} per cell" for count in counts] + [f"order {a} {ARROW} {b}" for a, b in pairs]
    caption = "Error of u in rms against the particles per cell"
    return Table(caption, ("method", "cell size", *head), tuple(rows), heads=2)


def scatter(record: Record) -> Table:
    """Smallest, middle and largest error of u in rms over the replicates."""
    rows = []
    for a in position_axes(record.study.runs, record.results):
        for cells, errors, (low, mid, high) in zip(a.cells, a.errors, a.ends, strict=True):
            ratio = f"{high / low:.2f}" if low else words.DASH
            ends = (words.sci(e) for e in (errors[0], low, mid, high))
            rows.append((record.label(a.run), words.cell_size(cells), str(len(errors)), *ends, ratio))
    head = ("series", "cell size", "runs", "usual position", "smallest", "median", "largest", "largest / smallest")
    return Table("Error of u in rms over the positions of the particles", head, tuple(rows), heads=2)


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
