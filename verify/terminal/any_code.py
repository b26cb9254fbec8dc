"""Table of any code on a terminal: how it was read, errors and verdicts, what three levels of values say."""

from pathlib import Path

from mpm_verify.reports.frames import Record


def show(record: Record, page: Path | None) -> None:
    """Print errors and verdicts as of any refinement; where no order is expected, the observed ones."""
    from rich.text import Text

    from mpm_verify.reports.sentences import any_code
    from mpm_verify.verify.terminal import table

    out = table.listened()
    table.show(record, None, out)
    for finding in record.findings:
        if not finding.counts:
            out.print(Text(any_code.observed(table.named(record, finding.plan), finding.verdict)))
    seen: set[tuple[str, str]] = set()
    for found in record.analysis.more.extrapolated:
        if (found.method, found.measured) not in seen:  # the finest three come first
            out.print(Text(f"\n{any_code.celik(found, record.by)}"))
        seen.add((found.method, found.measured))
    out.print()
    for words in record.study.words:
        out.print(Text(words, "dim"))
    table.where(out, page)
