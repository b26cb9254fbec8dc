"""`verify judge FILE`: a table of errors, or of values, of any code by the order rule, whatever its method."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpm_verify.verify.options import common

if TYPE_CHECKING:
    from mpm_verify.cases.any_code.table import Expected
    from mpm_verify.cases.harness.study import Study

File = Annotated[
    Path,
    typer.Argument(
        metavar="FILE",
        help="CSV, TSV or JSON with columns cells or h, and error; method, quantity, replicate, half_dt_error if any.",
    ),
]
Order = Annotated[float | None, typer.Option(help="Expected order; without it nothing is judged.")]
Below = Annotated[float, typer.Option(help="How far below it the whole interval may reach.")]
Above = Annotated[float, typer.Option(help="How far above it.")]
Floor = Annotated[float, typer.Option(help="Round-off floor of the errors, in their unit.")]
NoExact = Annotated[
    bool,
    typer.Option("--no-exact", help="There is no exact solution: the column is a value of a quantity, not an error."),
]
Steady = Annotated[bool, typer.Option("--steady", help="There is no time step, so none is to be halved.")]


def judge(
    file: File,
    order: Order = None,
    below: Below = 0.2,
    above: Above = 0.3,
    floor: Floor = 0.0,
    no_exact: NoExact = False,
    steady: Steady = False,
    *,
    out: Path | None,
    **more: Any,
) -> int:
    """Judge errors of any code, or values without an exact solution: observed order, verdict, HTML report."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.any_code.table import Expected

        study = study_of(file, Expected(order, below, above, floor, not no_exact, steady), command())
    return conduct(study, Settings(named(study, out), **more))


def study_of(file: Path, expected: "Expected", command: str) -> "Study[Any]":
    """Study of a file, with a sentence on how it was read. Raises ValueError with one line."""
    from mpm_verify.cases.any_code import reading, table
    from mpm_verify.reports.sentences import any_code

    read = reading.read(file, expected.exact)
    name = "judge-" + "".join(letter if letter.isalnum() or letter in "._" else "-" for letter in file.stem)[:100]
    return table.study(read, expected, command, name, any_code.told(read, expected))


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("judge")(common(judge))
