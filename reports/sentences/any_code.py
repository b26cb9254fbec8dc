"""Tables of any code in words: how a file was read, what row would decide, and what three levels say."""

from collections.abc import Sequence

from mpm_verify.cases.any_code.case import Extrapolated
from mpm_verify.cases.any_code.reading import Table
from mpm_verify.cases.any_code.table import Expected
from mpm_verify.cases.judging.records import Action, Verdict, Wanted
from mpm_verify.reports import words

NEAR = 0.005  # orders that are the same on screen
STRICTER = {
    "oscillates": "the values go to and fro, so there is no order and no limit; half the range of the three is given",
    "unsettled": "the order is below one half, so nothing has settled; half the range of the three is given",
    "equal": "the finest two values are equal, which shows no order",
    "capped": "the observed order is above the expected one, which is an accident; the expected one is used",
    "converges": "the same; three levels do not show that the order has settled, so they decide nothing",
}
ESTIMATED = (
    "There is no exact solution: the error of a level is Richardson's estimate from the next coarser one, "
    "|f(h) - f(r h)| / (r^p - 1) with p = {order}; the coarsest level has none."
)


def told(table: Table, expected: Expected) -> tuple[str, ...]:
    """Sentences on how a file was read."""
    read = ", ".join(name if plain(name) == role else f"{name} as {role}" for role, name in table.taken.items())
    unused = f" Not read: {', '.join(table.unused)}." if table.unused else ""
    found = [f"Columns of {table.path.name} that were read: {read}.{unused}"]
    if not expected.exact:
        found.append(ESTIMATED.format(order=f"{expected.order:g}" if expected.order else "2, as none is expected"))
    if expected.steady:
        found.append("There is no time step to halve, as --steady says.")
    return tuple(found)


def plain(name: str) -> str:
    """Name in lower case, for a comparison."""
    return name.strip().lower()


def advice(wanted: Wanted, by: str, present: Sequence[float], exact: bool = True) -> str:
    """Advice on what to change in the table; `present` are the cell sizes of its levels."""
    number, an = ("error", "an") if exact else ("value", "a")
    if wanted.action is Action.FINISH:
        return f"that row needs {an} {number} that is finite"
    if wanted.action is Action.HALVE_ALL:
        return "run all levels with half the time step, and judge that table"
    if wanted.action is Action.HALVE_FINEST:
        column = f"half_dt_{number}"
        return (
            f"add a column {column}, the {number} with half the time step, to the row of {size(wanted.h, by)}; "
            "or --steady where there is no time step"
        )
    if wanted.action is Action.REPLACE_FINEST:
        return f"take the finest level out, and add a row of {size(coarsest(wanted, by), by)}"
    return "add " + added(wanted, by, present)


def coarsest(wanted: Wanted, by: str) -> float:
    """Cell size of the level that is to be coarser than all."""
    return 1 / wanted.cells[0] if by == "cells" and wanted.cells else wanted.h


def added(wanted: Wanted, by: str, present: Sequence[float]) -> str:
    """Rows to add."""
    there = {round(1 / h) for h in present}
    sizes = [1 / cells for cells in wanted.cells if cells not in there] or [wanted.h]
    if len(sizes) == 1 and not wanted.cells and len(present) < 3:
        return f"rows of finer levels down to {size(wanted.h, by)}"
    return f"a row of {size(sizes[0], by)}" if len(sizes) == 1 else f"rows of {sized(sizes, by)}"


def size(h: float, by: str) -> str:
    """Cell size as the table has it: `64 cells`, `h = 0.0125`."""
    return f"{1 / h:.0f} cells" if by == "cells" else f"h = {h:.6g}"


def sized(sizes: Sequence[float], by: str) -> str:
    """Several cell sizes: `24, 32 cells`."""
    if by == "cells":
        return ", ".join(f"{1 / h:.0f}" for h in sizes) + " cells"
    return "h = " + ", ".join(f"{h:.6g}" for h in sizes)


def stricter(found: Extrapolated) -> str:
    """Where the rule of this project is the stricter one, and why."""
    return STRICTER[code(found)]


def code(found: Extrapolated) -> str:
    """Key of STRICTER: the kind of the extrapolation, or that its order is not used."""
    capped = found.ours.kind == "converges" and found.ours.order > found.formal + NEAR
    return "capped" if capped else found.ours.kind


def celik(found: Extrapolated, by: str) -> str:
    """Sentence on the finest three levels."""
    name = f"{found.method}, {found.measured}"
    levels = sized(found.h, by)
    index = found.index
    paper = (
        f"order {words.order(index.order)}, extrapolated {index.limit:.6g}, GCI {words.percent(index.index, 2)}"
        if index.order == index.order
        else "no order"
    )
    return f"{name}, {levels}: {paper} (Celik et al. 2008). Here: {ours(found)}."


def ours(found: Extrapolated) -> str:
    """Phrase on the extrapolation by the stricter rule."""
    e = found.ours
    uncertain = f"{e.finest:.6g} \N{PLUS-MINUS SIGN} {words.short(e.uncertainty)}"
    return f"{uncertain}; {stricter(found)}"


def observed(name: str, verdict: Verdict) -> str:
    """Sentence on what was observed where no order is expected."""
    if verdict.observed is None:
        return f"{name}: no order was observed; three levels with an error above zero show one"
    local = " ".join(words.order(order) for order in verdict.local_orders)
    return (
        f"{name}: observed order {words.order(verdict.observed)} (interval {words.interval(verdict.interval)}, local "
        f"orders {local}); --order says which one is expected, and judges it"
    )
