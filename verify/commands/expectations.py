"""`verify expectations`: what is registered of each method on each solution, before anything runs."""

import json
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.solver.plugins import METHODS, SOLUTIONS
from mpm_verify.verify.choices import completion
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.cases.judging.records import Expectation
    from mpm_verify.cases.mms.expectations import Entry


NOTE = """
Orders in rms with their bands, measured (see docs/methods.md); the source is that of u. With 4 or 9 particles per
cell u is judged, the others are shown. `stalls`: the order falls below 1.8. `diverges`: the error grows, or runs
fail. What damping, smoothing and another duration do to an order stands there too.
"""


def expectations(
    solution: Annotated[
        str | None, typer.Option(help="Only this solution.", autocompletion=completion(SOLUTIONS))
    ] = None,
    method: Annotated[str | None, typer.Option(help="Only this method.", autocompletion=completion(METHODS))] = None,
    json_output: Annotated[bool, typer.Option("--json", help="One JSON document on standard output.")] = False,
) -> None:
    """Print what is expected of each method on each solution, with its source: registered before anything runs."""
    from mpm_verify.verify.run import usage

    with usage():
        from mpm_verify.cases.mms.expectations import registry
        from mpm_verify.mms.discretisation import axisymmetric, dimension
        from mpm_verify.solver.plugins import available, create

        entries = [e for e in registry() if solution in (None, e.solution) and method in (None, e.method)]
        if not entries and solution in available(SOLUTIONS):
            plugin = create(SOLUTIONS, solution)
            has = {1: "one dimension", 3: "three dimensions"}.get(dimension(plugin))
            if has or axisymmetric(plugin):
                raise ValueError(
                    f"{solution} {f'has {has}' if has else 'is axisymmetric'}, and nothing of its own is registered; "
                    "at a small amplitude --as takes what --solution 'small amplitude' shows; otherwise give --order"
                )
        if not entries:
            solutions, methods = sorted({e.solution for e in registry()}), sorted({e.method for e in registry()})
            choice = f"choose from {', '.join(solutions)} and from {', '.join(methods)}"
            raise ValueError(f"nothing is registered there; {choice}")
    with printing():
        if json_output:
            typer.echo(json.dumps([line(e) for e in entries], indent=1))
        else:
            show(entries)


def line(entry: "Entry") -> dict[str, object]:
    """Row of an entry as data."""
    e = entry.expectation
    band = None if e.order is None else [e.order - e.below, e.order + e.above]
    return {
        "solution": entry.solution, "method": entry.method, "quantity": entry.quantity, "expected": e.kind,
        "band": band, "source": e.source,
    }  # fmt: skip


def show(entries: "list[Entry]") -> None:
    """Print a row for each solution and method, the quantities beside each other."""
    from mpm_verify.verify.terminal.table import bare, listened

    table = bare()
    for name in ("solution", "method", "u", "v", "F", "sigma", "source"):
        table.add_column(name)
    rows: dict[tuple[str, str], list[Entry]] = {}
    for entry in entries:
        rows.setdefault((entry.solution, entry.method), []).append(entry)
    last = ""
    for (solution, method), quantities in rows.items():
        words = [word(e.expectation) for e in quantities]
        table.add_row(
            "" if solution == last else solution, method, *words, quantities[0].expectation.source.partition(";")[0]
        )
        last = solution
    out = listened(120)
    out.print(table)
    out.print(NOTE)


def word(e: "Expectation") -> str:
    """Expectation in words: `2 (1.8-2.3)`, `stalls` or `diverges`."""
    from mpm_verify.reports.sentences import verdicts

    if e.order is not None:
        return f"{e.order:g} ({e.order - e.below:.2g}\N{EN DASH}{e.order + e.above:.2g})"
    return verdicts.registered(e)


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("expectations")(expectations)
