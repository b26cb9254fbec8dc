"""`verify check-force DIR`: whether the exported sources of a case give the right values, language by language."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.verify.choices import completing
from mpm_verify.verify.options import Json
from mpm_verify.verify.terminal.output import printing

if TYPE_CHECKING:
    from mpm_verify.mms.export.checking import Checked

NAMES = ("c", "cpp", "cuda", "fortran", "julia", "python", "octave")


def check_force(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that verify export wrote.")],
    lang: Annotated[
        str,
        typer.Option(
            help=f"{', '.join(NAMES)}; several with commas. cuda is compiled as C++.",
            autocompletion=completing(lambda: NAMES),
            show_default="all that are in the folder",
        ),
    ] = "",
    json_output: Json = False,
) -> int:
    """Compile and run exported sources against values at 30 digits. Exit codes: 0 agree, 1 not, 3 nothing to check."""
    from mpm_verify.verify.run import usage

    with usage():
        from mpm_verify.mms.export.checking import check, exit_code
        from mpm_verify.reports.export.case_folder import read, table_of

        record = read(folder)
        known = table_of(folder, record)
        checks = [check(folder.resolve(), name, record.dimension, known) for name in chosen(folder, lang)]
    with printing():
        show(checks, json_output)
    return exit_code(checks)


def chosen(folder: Path, lang: str) -> list[str]:
    """Languages that are asked for. Raises ValueError for one that is not known, or whose sources are not there."""
    from mpm_verify.mms.export.checking import there
    from mpm_verify.solver.plugins import meant

    found = there(folder)
    asked = [name.strip() for name in lang.split(",")] if lang else found
    for name in asked:
        if name not in NAMES:
            raise ValueError(f"--lang: no language {name!r}{meant(name, NAMES)}; choose from {', '.join(NAMES)}")
        if name not in found:
            raise ValueError(f"--lang {name}: {folder} has no source in it; it has {', '.join(found) or 'none'}")
    if not asked:
        raise ValueError(f"{folder} has no source in any language; export the case again")
    return list(dict.fromkeys(asked))


def show(checks: "list[Checked]", json_output: bool) -> None:
    """Print a line for each language, or one JSON document."""
    from mpm_verify.mms.export.checking import exit_code
    from mpm_verify.reports.export.document import finite
    from mpm_verify.reports.sentences.check_force import sentence

    if json_output:
        rows = [{**finite(asdict(one)), "sentence": sentence(one)} for one in checks]
        typer.echo(json.dumps({"exit_code": exit_code(checks), "languages": rows}, indent=1))
        return
    for one in checks:
        typer.echo(f"{one.language:8} {sentence(one)}")


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("check-force")(check_force)
