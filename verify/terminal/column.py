"""What a study of the column prints: its runs, the paper's sentences, and the checks."""

from pathlib import Path

from mpm_verify.reports.frames import Record


def show(record: Record, page: Path | None) -> None:
    """Print the runs, the paper's sentences, and the checks."""
    collapse = record.analysis.more
    from rich.table import Table
    from rich.text import Text

    from mpm_verify.reports.pages.column import WORDS, numbers
    from mpm_verify.verify.terminal.checks import show as checks
    from mpm_verify.verify.terminal.table import Listened

    out = Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, 100)
    table = Table(box=None, pad_edge=False, header_style="dim")
    for name in ("run", "front 99 %", "99.9 %", "toe", "height", "rest", "falls", "area", ""):
        table.add_column(name, justify="left" if name in ("run", "") else "right")
    for run in collapse.study.runs:
        table.add_row(collapse.label(run), *numbers(run, collapse.results.get(run.digest)))
    out.print()
    out.print(table)
    out.print(
        "lengths in m from the wall; rest in sqrt(h0/g); falls: of the height in the last fifth of the time; "
        "area: of the heap over that of the column"
    )
    styles = {True: "bold green", False: "bold yellow", None: "dim"}
    for claim in collapse.claims:
        where = f" ({claim.runs})" if claim.runs else ""
        out.print(Text.assemble("\n", (WORDS[claim.reproduced].upper(), styles[claim.reproduced]),
                                f"  {claim.says}{where} {claim.found}"))  # fmt: skip
    checks(record, page, collapse.examination.lead)
