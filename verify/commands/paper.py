"""`verify paper`: the studies behind the paper's figures and tables, and what each of its claims comes to in them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.verify.options import DryRun, Jobs, Json, Out, Threads, Yes

if TYPE_CHECKING:
    from mpm_verify.reports.paper.studies import PaperStudy

Quick = Annotated[bool, typer.Option("--quick", help="Coarser meshes and shorter studies: minutes, not hours.")]
Only = Annotated[
    str, typer.Option(metavar="PARTS", help="Figures such as 4,5, or tables, methods, or names of studies.")
]
Register = Annotated[
    bool, typer.Option("--register", help="Write statuses and numbers, which later runs are held against.")
]
Pages = Annotated[bool, typer.Option("--pages", help="Draw the page of each study too.")]
NOTHING = 3  # exit code where nothing is registered of what was asked for


def paper(
    quick: Quick = False,
    only: Only = "",
    register: Register = False,
    out: Out = None,
    jobs: Jobs = None,
    threads: Threads = 1,
    pages: Pages = False,
    json_output: Json = False,
    dry_run: DryRun = False,
    yes: Yes = False,
) -> int:
    """Run or reuse every study behind the paper, and hold each of its claims against the stored numbers.

    Exit code 1 says that a status or number is not the registered one, never that a claim of the paper does not hold.
    """
    from mpm_verify.verify.run import Settings, usage

    with usage():
        from mpm_verify.reports.paper.studies import FULL, QUICK, chosen
        from mpm_verify.verify.paper_studies import run

        mode = QUICK if quick else FULL
        folder, wanted = out or Path("results") / f"paper-{mode}", chosen(only)
        made = [one.build(mode, command(one.name, mode)) for one in wanted]
        run(made, Settings(folder, jobs=jobs, threads=threads, page=pages, dry_run=dry_run, yes=yes))
        return 0 if dry_run else told(folder, mode, wanted, register, json_output)


def told(folder: Path, mode: str, wanted: "list[PaperStudy]", register: bool, json_output: bool) -> int:
    """Write the ledger, print it, and give the exit code."""
    import json

    from mpm_verify.reports.export import paper as writing
    from mpm_verify.reports.figures.paper import write_all
    from mpm_verify.reports.pages._paper import page
    from mpm_verify.reports.paper import registered
    from mpm_verify.reports.paper.evidence import below
    from mpm_verify.reports.paper.ledger import ledger
    from mpm_verify.reports.paper.records import Status
    from mpm_verify.reports.paper.studies import studies
    from mpm_verify.verify.terminal.output import printing
    from mpm_verify.verify.terminal.paper import show

    seen = below(folder)
    entries, figures = ledger(seen), write_all(folder, seen)
    if register:
        registered.register(entries, mode)
    rows = registered.registered(mode)
    changed = registered.changes(entries, rows, len(wanted) == len(studies()))
    files = [*writing.write(folder, mode, entries, changed), *writing.tables(folder, seen),
             *(paths[0] for paths in figures.values()), page(folder, mode, entries, changed, figures)]  # fmt: skip
    with printing():
        if json_output:
            typer.echo(json.dumps(writing.document(mode, entries, changed), indent=1, ensure_ascii=False))
        else:
            show(mode, entries, changed, set(rows), files)
    ran = {one.claim.id for one in entries if one.status is not Status.NOT_RUN}
    return 1 if changed else 0 if ran & rows.keys() else NOTHING


def command(name: str, mode: str) -> str:
    """Command that repeats a study."""
    return f"verify paper{' --quick' * (mode == 'quick')} --only {name}"


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("paper")(paper)
