"""What the commands of the column do: run what is not stored, judge, make the page, print, say it in the exit code."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mpm_verify.verify.options.common import check_count
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.cases.column.exam import ColumnAnalysis
    from mpm_verify.cases.column.run import ColumnStudy

VERSION = 2


@dataclass(frozen=True)
class Wanted:
    """How a study of the column is told."""

    vtk: bool = False
    json_output: bool = False
    junit: Path | None = None


def conduct(study: "ColumnStudy", folder: Path, jobs: int | None, threads: int, wanted: Wanted) -> int:
    """Returns the exit code; what is wrong with the input or the store is one line and exit code 2."""
    from mpm_verify.reports.export.junit import check_junit, write_checks
    from mpm_verify.verify.conduct import Settings, compute, usage
    from mpm_verify.verify.examine import CODES

    with usage():
        from mpm_verify.cases.harness.store import Store

        check_junit(wanted.junit)
        check_count(jobs, "--jobs")
        check_count(threads, "--threads")
        store = Store(folder, "column")
        with store.locked():
            store.create(study)
            compute(study, store, Settings(folder, jobs, threads))  # type: ignore[arg-type]
            from mpm_verify.reports.pages.column import page

            collapse, made = page(folder, wanted.vtk)
        if wanted.junit:
            write_checks(wanted.junit, collapse.examination)
    with printing():
        if wanted.json_output:
            typer.echo(document(collapse, made))
        else:
            show(collapse, made)
    return CODES[collapse.examination.outcome]


def document(collapse: "ColumnAnalysis", made: Path) -> str:
    """One JSON document: runs with their numbers, the paper's sentences, the checks; null for what is not finite."""
    from mpm_verify.reports.sentences import column as words
    from mpm_verify.reports.sentences.remarks import lead
    from mpm_verify.verify.examine import finite, told

    examination, results = collapse.examination, collapse.results
    runs = []
    for run in collapse.study.runs:
        result = results.get(run.digest)
        runs.append({
            "run": finite(asdict(run)), "status": result.status if result else "not run",
            "values": finite(result.values) if result else {},
            "failure": asdict(result.failure) if result and result.failure else None,
        })  # fmt: skip
    content = {
        "version": VERSION,
        "study": collapse.study.name,
        "outcome": str(examination.outcome),
        "lead": lead(examination),
        "findings": [finite(asdict(finding)) for finding in examination.findings],
        "runs": runs,
        "paper": [
            {"says": words.says(claim), **finite(asdict(claim)), "found": words.found(claim)}
            for claim in collapse.claims
        ],
        "checks": [told(check) for check in examination.checks],
        "refinement": [finite(asdict(one)) for one in collapse.refined],
        "report": str(made),
    }
    return json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False)


def show(collapse: "ColumnAnalysis", made: Path) -> None:
    """Print the runs, the paper's sentences, and the checks."""
    from rich.table import Table
    from rich.text import Text

    from mpm_verify.reports.pages.column import numbers
    from mpm_verify.reports.sentences import column as words
    from mpm_verify.verify.examine import show as checks
    from mpm_verify.verify.terminal.table import Listened

    out = Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, 100)
    table = Table(box=None, pad_edge=False, header_style="dim")
    for name in ("run", "front 99 %", "99.9 %", "toe", "height", "rest", "falls", "area", ""):
        table.add_column(name, justify="left" if name in ("run", "") else "right")
    for run in collapse.study.runs:
        table.add_row(words.label(collapse.study, run), *numbers(run, collapse.results.get(run.digest)))
    out.print()
    out.print(table)
    out.print(
        "lengths in m from the wall; rest in sqrt(h0/g); falls: of the height in the last fifth of the time; "
        "area: of the heap over that of the column"
    )
    styles = {True: "bold green", False: "bold yellow", None: "dim"}
    for claim in collapse.claims:
        where = f" ({words.listed(claim.shared)})" if claim.shared else ""
        told = f"  {words.says(claim)}{where} {words.found(claim)}"
        out.print(Text.assemble("\n", (words.answer(claim).upper(), styles[claim.reproduced]), told))
    checks(collapse.examination, made)
