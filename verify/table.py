"""What a study prints at its end: errors and local orders, the verdicts with their reasons, the path of the report."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from cases.study import Study
from cases.verdicts import Finding

STYLES = {"PASS": "bold green", "FAIL": "bold red", "INCONCLUSIVE": "bold yellow", "ERROR": "bold magenta"}
ALWAYS = ("u", "rms")


class Listened(Console):
    """Rich ends the program when nobody reads, with the exit code of a FAIL; this leaves it to verify.output."""

    def on_broken_pipe(self) -> None:
        """Tell the caller."""
        raise BrokenPipeError


def show(study: Study, found: Sequence[Finding], report: Path, console: Console | None = None) -> None:
    """Print to standard output, as wide as the terminal is and 100 columns where there is none."""
    out = console or Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, 100)
    out.print(f"\n[bold]{study.title}[/bold]")
    out.print(errors_table([f for f in found if f.declared.judged or (f.declared.quantity, f.declared.norm) == ALWAYS]))
    for finding in found:
        if finding.declared.judged:
            out.print(sentence(finding))
    if not any(f.declared.judged for f in found):
        out.print("INCONCLUSIVE: nothing here has a registered expectation, so nothing is judged.")
    out.print("\nMore quantities and norms, figures, and how it was made:")
    out.print(f"report: {report}", soft_wrap=True)


def errors_table(found: Sequence[Finding]) -> Table:
    """Error and local order at each cell count; a failed run by its reason."""
    table = Table(box=None, pad_edge=False, header_style="dim")
    for name in ("method", "per cell", "quantity", "cells"):
        table.add_column(name, justify="right" if name in ("per cell", "cells") else "left")
    for name in ("error", "order"):
        table.add_column(name, justify="right")
    table.add_column("")
    for finding in found:
        for row in rows(finding):
            table.add_row(*row)
    return table


def rows(finding: Finding) -> Iterator[tuple[str, ...]]:
    """A row a level; names once a block."""
    d, orders = finding.declared, iter(finding.verdict.local_orders)
    first, earlier = (d.method, str(d.ppc), f"{d.quantity} {d.norm}"), False
    for level in finding.levels:
        cells = f"{1 / level.h:.0f}"
        if level.ended:
            yield (*first, cells, "-", "", level.ended)
        else:
            yield (*first, cells, f"{level.errors[0]:.3e}", order(next(orders, None)) if earlier else "", "")
            earlier = True
        first = ("", "", "")


def order(local: float | None) -> str:
    """A local order; none where an error is zero."""
    return "" if local is None else f"{local:.2f}"


def sentence(finding: Finding) -> Text:
    """The verdict in words."""
    d, v = finding.declared, finding.verdict
    expected = "no convergence" if v.expected is None else f"order {v.expected:g}"
    text = Text(f"\n{v.outcome}", STYLES[v.outcome])
    text.append(
        f"  {d.method}, {d.ppc} per cell, {d.quantity} in {d.norm}, {expected} expected: {v.reason}.",
        "not bold default",
    )
    return text
