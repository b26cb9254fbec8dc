"""Page of a comparison with references: what came out, digits, where the two part, and all references."""

import json
from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.harness.checks import Examination
from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.store import Store, make
from mpm_verify.cases.mms.digits.examine import Examined
from mpm_verify.reports import words
from mpm_verify.reports.components.digits import table
from mpm_verify.reports.components.examined import Section, render
from mpm_verify.reports.components.logs import FILE, of_comparison
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.export.digits import document
from mpm_verify.reports.figures.difference import difference
from mpm_verify.reports.sentences import digits
from mpm_verify.solver.plugins import label

BADGES = {"AGREES": "PASS", "PARTS": "FAIL"}


def title(examined: Examined) -> str:
    """Title: the program, the solution and the grid."""
    from mpm_verify.cases.solvers.command import program

    run = examined.run
    return f"{program(run.solver)} against the reference: {label(run.solution)}, {run.cells} cells, {run.ppc} per cell"


def page(examined: Examined, folder: Path, command: str) -> Path:
    """Write report.html, its figure, and comparison.json; the path of the page. Raises StoreError."""
    make(folder)
    found, run = examined.compared, examined.run
    shown: dict[str, float | str] = {"material": label(run.material), "courant": run.courant, "ppc": run.ppc}
    examination = Examination(folder.name, title(examined), command, (), (), shown, {}, environment())
    said = digits.OUTCOMES[found.outcome]
    path = render(
        folder, examination, lambda _, add: sections(examined, add),
        outcome=BADGES.get(said, said), said=digits.outcome(found),
        logs=of_comparison(run, found, folder),
    )  # fmt: skip
    if found.log.text:
        Store.write(folder / FILE, found.log.text.encode())
    Store.write(folder / "comparison.json", json.dumps(document(run, found, str(path)), indent=1).encode())
    return path


def sections(examined: Examined, add: Add) -> Sequence[Section]:
    """Digits, the picture, and every reference."""
    found = examined.compared
    if not found.against:
        return []
    made = [Section("digits", "Digits", digits.sentences(found), tables=[table(found)])]
    if examined.moments:
        name = " and ".join(words.quantity(q) for q in examined.moments[0].off)
        alt = f"Size of the difference of {name} from the nearest reference, on the particles."
        image = add("difference", difference(examined.moments, found.partings), alt)
        told = (
            "at the first frame where the two part and at the last"
            if len(examined.moments) > 1
            else "at the last frame"
        )
        made.append(Section("where", "Where", figures=[(image, f"Difference from the nearest reference {told}.")]))
    return [*made, Section("all", "All references", tables=[table(found, len(found.against))])]
