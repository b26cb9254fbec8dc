"""Comparison with references on a terminal: outcome, digits, where the two part, what is not told apart."""

from pathlib import Path

from rich.text import Text

from mpm_verify.cases.mms.digits.examine import Examined
from mpm_verify.reports.components.digits import table
from mpm_verify.reports.components.logs import of_comparison
from mpm_verify.reports.pages._digits import title
from mpm_verify.reports.sentences import digits
from mpm_verify.verify.terminal import logs
from mpm_verify.verify.terminal.table import STYLES, bare, listened

COLOURS = {"AGREES": STYLES["PASS"], "PARTS": STYLES["FAIL"]}


def show(examined: Examined, page: Path | None) -> None:
    """Print to standard output, as wide as the terminal is and 100 columns where there is none."""
    found, out = examined.compared, listened()
    out.print(Text(f"\n{title(examined)}", "bold"))
    if found.against:
        rows = table(found)
        shown = bare()
        for number, name in enumerate(rows.head):
            shown.add_column(name, justify="left" if number < rows.heads else "right")
        for row in rows.rows:
            shown.add_row(*row)
        out.print(shown)
    said = digits.OUTCOMES[found.outcome]
    out.print(
        Text(f"\n{said}", COLOURS.get(said, STYLES.get(said, ""))).append(
            f"  {digits.outcome(found)}", "not bold default"
        )
    )
    for line in digits.sentences(found):
        out.print(line, markup=False)
    logs.show(out, of_comparison(examined.run, found, page.parent if page else None))
    if page:
        out.print(f"\nreport: {page}", soft_wrap=True, markup=False)
        if (picture := page.parent / "figures" / "difference.png").exists():
            out.print(f"picture: {picture}", soft_wrap=True, markup=False)
