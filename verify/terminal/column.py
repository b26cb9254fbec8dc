"""Study of the column on a terminal: its runs, the paper's sentences, and the checks."""

from pathlib import Path

from mpm_verify.reports.frames import Record


def show(record: Record, page: Path | None) -> None:
    """Print the runs, the paper's sentences, and the checks."""
    from rich.text import Text

    from mpm_verify.reports.pages.column import numbers
    from mpm_verify.reports.sentences import column as words
    from mpm_verify.reports.sentences.remarks import lead
    from mpm_verify.verify.terminal.checks import show as checks
    from mpm_verify.verify.terminal.table import bare, listened

    found = record.analysis.more
    out = listened()
    table = bare()
    for name in ("run", "front 99 %", "99.9 %", "toe", "height", "by fit", "rest", "falls", "area", ""):
        table.add_column(name, justify="left" if name in ("run", "") else "right")
    for run in found.study.runs:
        table.add_row(words.label(found.study, run), *numbers(run, found.results.get(run.digest)))
    out.print()
    out.print(table)
    out.print(
        "lengths in m from the wall; height: of one strip, and by fit over the first width; rest in sqrt(h0/g); falls: "
        "fraction of the height in the last fifth of the time; area: of the heap over that of the column"
    )
    styles = {True: "bold green", False: "bold yellow", None: "dim"}
    for claim in found.claims:
        where = f" ({words.listed(claim.shared)})" if claim.shared else ""
        told = f"  {words.says(claim)}{where} {words.found(claim)}"
        out.print(Text.assemble("\n", (words.answer(claim).upper(), styles[claim.reproduced]), told))
    checks(record, page, lead(found.examination))
