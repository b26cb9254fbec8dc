"""Speed of methods on a terminal: a table, the processor, and what does not pass."""

from pathlib import Path

from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.bench import measured_on
from mpm_verify.reports.tables import bench
from mpm_verify.verify.terminal import checks


def show(record: Record, page: Path | None) -> None:
    """Print the speeds and the checks."""
    from mpm_verify.verify.terminal.table import bare, listened

    if rows := bench.rows(record):
        out = listened()
        table = bare()
        for name in bench.head(rows):
            table.add_column(name, justify="left" if name in ("method", *bench.more(rows)) else "right")
        for row in rows:
            table.add_row(*bench.cells(row, bench.more(rows)))
        out.print()
        out.print(table)
        out.print(measured_on(rows))
    checks.show(record, page)
