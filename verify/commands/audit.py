"""`verify audit`: what a study of a solution cannot see, how strong the solution is; derives, runs nothing."""

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS
from mpm_verify.verify.choices import choices, completion
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.mms.audit import Audit


def audit(
    solution: Annotated[
        str,
        typer.Argument(
            metavar="SOLUTION",
            help=f"{choices(SOLUTIONS)}, with parameters as axis_aligned:A=0.01, or a file: path/to/own.py.",
            autocompletion=completion(SOLUTIONS),
        ),
    ],
    material: Annotated[
        str | None,
        typer.Option(
            help=f"{choices(MATERIALS)}; parameters as neo_hookean:nu=0.2.",
            autocompletion=completion(MATERIALS),
            show_default="the solution's own",
        ),
    ] = None,
    json_output: Annotated[bool, typer.Option("--json", help="One JSON document on standard output.")] = False,
) -> None:
    """Say what a manufactured solution cannot see, and what it can, in words and numbers."""
    from mpm_verify.verify.run import usage

    with usage():
        name, result = examine(solution, material)
        text = json.dumps(document(solution, name, result), indent=2, ensure_ascii=False) if json_output else ""
    with printing():
        if text:
            typer.echo(text)
        else:
            show(f"{solution} in {name}", result)


def examine(specification: str, material: str | None) -> tuple[str, "Audit"]:
    """Name of the material and the audit; a user's file is checked before. Raises ValueError."""
    from mpm_verify.mms.audit import audit as score
    from mpm_verify.mms.check import check
    from mpm_verify.mms.manufacture import manufacture
    from mpm_verify.solver.plugins import create, is_file

    solution = create(SOLUTIONS, specification)
    name = material or solution.material
    model = create(MATERIALS, name)
    if is_file(specification):
        check(solution, model)
    return name, score(manufacture(solution, model, model.rho0), solution, model)


def document(solution: str, material: str, result: "Audit") -> dict[str, object]:
    """Content of --json: each blind spot with its sentence, and all that was measured."""
    from mpm_verify.reports.sentences import blind_spots as words

    spots = [{**asdict(spot), "sentence": words.sentence(spot)} for spot in result.spots]
    return {"solution": solution, "material": material, "blind_spots": spots, "numbers": result.numbers}


def show(title: str, result: "Audit") -> None:
    """Print what is blind, what is seen, and the numbers, as wide as the terminal is."""
    from rich.columns import Columns
    from rich.table import Table
    from rich.text import Text

    from mpm_verify.reports.sentences import blind_spots as words
    from mpm_verify.verify.terminal.table import listened

    out = listened()
    out.print(Text(f"\n{title}", "bold"))
    for heading, style, spots in (
        ("cannot see", "bold yellow", result.blind),
        ("sees", "bold green", result.seen),
    ):
        table = Table(box=None, pad_edge=False, show_header=False, title=heading, title_justify="left")
        table.title_style = style
        table.add_column(no_wrap=True)
        table.add_column()
        for spot in spots:
            table.add_row(spot.code, Text(words.sentence(spot)))
        out.print(Text())
        out.print(table)
    out.print(Text("\nin numbers", "bold"))
    numbers = (f"{value:.3g} {name}" for name, value in result.numbers.items())
    out.print(Columns(map(Text, numbers), padding=(0, 3), equal=True, column_first=True))


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("audit")(audit)
