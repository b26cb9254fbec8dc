"""Comparison of many methods on a terminal: one table, what did not pass, and the path of the report."""

from pathlib import Path

from mpm_verify.reports.components.cards import summary
from mpm_verify.reports.components.show_cost import overview
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import controls
from mpm_verify.reports.sentences.headline import headline
from mpm_verify.verify.terminal.table import bare, listened, verdict, where


def show_overview(record: Record, page: Path | None) -> None:
    """Print to standard output, as wide as the terminal is and wide enough for a line a method where there is none."""
    found = overview(record)
    out = listened(max(100, 17 * len(found.head)))
    table = bare()
    for number, name in enumerate(found.head):
        table.add_column(name, justify="left" if number == 0 else "right", overflow="fold")
    for row in found.rows:
        table.add_row(*row)
    out.print(f"\n[bold]{record.study.title}[/bold]")
    if told := headline(record):
        out.print(told)
    out.print(f"{found.caption}\n")
    out.print(table)
    for finding in record.findings:
        if finding.counts and finding.verdict.outcome != "PASS":
            verdict(out, record, finding)
    out.print(f"\n{summary(record)}")
    if spoilt := controls.sentence(record.analysis.controls):
        out.print(spoilt)
    where(out, page, "\nVerdicts, error against cost, where orders fall and why, and how it was made:")
