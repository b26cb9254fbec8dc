"""`verify power`: how often the order rule passes what is bad and fails what is sound, over known sequences."""

import json
import os
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpm_verify.verify.options import Jobs, Json
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.cases.judging.power import Row


LEAST, MOST = 50, 100_000  # draws


def power(
    draws: Annotated[int, typer.Option(help="Draws of each sequence, set of levels and scatter.")] = 400,
    seed: Annotated[int, typer.Option(help="Seed: the same one gives the same numbers.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder of the table, the page and the figure.")] = Path("results/power"),
    jobs: Jobs = None,
    json_output: Json = False,
) -> int:
    """Measure power and safety of the order rule. Exit codes: 0 no promise is broken, 1 one is."""
    from mpm_verify.verify.run import check_count, usage

    with usage():
        if not LEAST <= draws <= MOST:
            raise ValueError(f"--draws {draws} must be from {LEAST}, fewer tell no rate, to {MOST}; usual are 400")
        check_count(jobs, "--jobs")
        if seed < 0:
            raise ValueError(f"--seed {seed} must be 0 or more")
        out.mkdir(parents=True, exist_ok=True)
        rows = measured(draws, seed, jobs or os.cpu_count() or 1)
        written(out, rows)
    with printing():
        show(rows, out, json_output)
    from mpm_verify.cases.judging.power import promises

    return 0 if all(one.kept for one in promises(rows)) else 1


def measured(draws: int, seed: int, jobs: int) -> "list[Row]":
    """Rows, counted by as many processes as are asked for."""
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor

    from mpm_verify.cases.judging.power import measure

    if jobs == 1:
        return measure(draws, seed, watched(map))
    with ProcessPoolExecutor(jobs, mp_context=multiprocessing.get_context("spawn")) as pool:
        return measure(draws, seed, watched(pool.map))


def watched(mapping: Callable[..., Iterable[Any]]) -> Callable[..., Iterable[Any]]:
    """Map that shows a bar on standard error, where that is a terminal."""
    from rich.console import Console
    from rich.progress import track

    def mapped(function: Callable[..., Any], items: Sequence[Any]) -> Iterable[Any]:
        console = Console(stderr=True)
        found = mapping(function, items)
        show = partial(track, total=len(items), console=console, transient=True, description="judging")
        return show(found) if console.is_terminal else found

    return mapped


def written(out: Path, rows: "Sequence[Row]") -> None:
    """Write power.csv, power.md and power.png."""
    from mpm_verify.reports.export import power as files
    from mpm_verify.reports.figures import style
    from mpm_verify.reports.figures.power import power_figure

    files.write(out, rows)
    style.save(power_figure(rows), out, "power", ("png",))


def show(rows: "Sequence[Row]", out: Path, json_output: bool) -> None:
    """Print a table for each set of levels, and what is promised; or one JSON document."""
    from mpm_verify.cases.judging.power import promises
    from mpm_verify.reports.sentences import power as words

    if json_output:
        typer.echo(json.dumps(document(rows), indent=1, ensure_ascii=False))
        return
    from mpm_verify.verify.terminal.table import listened

    console = listened()
    for levels in dict.fromkeys(row.levels for row in rows):
        console.print(f"\n[bold]{words.levels(levels)}: PASS / FAIL / INCONCLUSIVE in % by scatter[/bold]")
        console.print(table([row for row in rows if row.levels == levels]))
    console.print("\n[bold]what is promised[/bold]")
    console.print(plain(words.HEAD, [words.promise(one) for one in promises(rows)], 3))
    console.print("\n[bold]what no rule can tell[/bold]")
    for text in words.hidden(rows) or ["nothing here"]:
        console.print(text)
    console.print(f"\ntable, page and figure: {out}", soft_wrap=True)


def document(rows: "Sequence[Row]") -> dict[str, Any]:
    """Content of --json."""
    from dataclasses import asdict

    from mpm_verify.cases.judging.power import interval, promises
    from mpm_verify.reports.export.document import finite
    from mpm_verify.reports.sentences import power as words

    told = [
        {
            "kind": one.kind, "levels": one.row.levels, "sequence": one.row.sequence, "scatter": one.row.scatter,
            "rate": one.count / one.row.draws, "interval": interval(one.count, one.row.draws), "limit": one.limit,
            "kept": one.kept, "standing": one.standing, "sentence": words.sentence(one),
        }
        for one in promises(rows)
    ]  # fmt: skip
    return {"promises": told, "rows": [finite(asdict(row)) for row in rows]}


def table(rows: "Sequence[Row]") -> Any:
    """Table of one set of levels."""
    from mpm_verify.reports.export.power import by_sequence
    from mpm_verify.reports.sentences import power as words

    head = ["sequence", "right", *map(words.scatter, dict.fromkeys(row.scatter for row in rows))]
    lines = [
        (words.name(several[0].sequence), words.right(several[0]), *map(words.rates, several))
        for _, several in by_sequence(rows)
    ]
    return plain(head, lines, 2)


def plain(head: "Sequence[str]", lines: "Sequence[Sequence[str]]", texts: int) -> Any:
    """Table for a terminal: `texts` columns of text, then numbers."""
    from mpm_verify.verify.terminal.table import bare

    found = bare()
    for k, name in enumerate(head):
        found.add_column(name, justify="left" if k < texts else "right")
    for line in lines:
        found.add_row(*line)
    return found


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("power")(power)
