"""`verify example LANGUAGE DIR`: a tiny complete solver with its adapter, to compare yours with or to begin from."""

import shlex
import shutil
import sys
from pathlib import Path
from typing import Annotated

import typer

from mpm_verify.verify.terminal.output import printing

FOLDER = Path(__file__).absolute().parents[2] / "cases" / "mms" / "external" / "examples"
FIRST = {"python1d": "bump1d", "python-rz": "bump_rz", "python3d": "bump3d"}  # of other dimensions than two
LANGUAGES = {  # what is typed beside --solver, and what it needs
    "python": "{python} {here}/solver.py {{case}} {{out}}",
    "numpy-class": "{python} {here}/adapter.py {{case}} {{out}}",
    "python1d": "{python} {here}/solver.py {{case}} {{out}}",
    "python-rz": "{python} {here}/solver.py {{case}} {{out}}",
    "python3d": "{python} {here}/solver.py {{case}} {{out}}",
    "cpp": "{here}/run.sh {{case}} {{out}}",
    "fortran": "{here}/run.sh {{case}} {{out}}",
    "julia": "julia {here}/solver.jl {{case}} {{out}}",
}


def example(
    language: Annotated[
        str,
        typer.Argument(
            metavar="LANGUAGE",
            help=f"{', '.join(LANGUAGES)}.",
            autocompletion=lambda incomplete: [name for name in LANGUAGES if name.startswith(incomplete)],
        ),
    ],
    to: Annotated[Path, typer.Argument(metavar="DIR", help="Folder, new or empty.")],
) -> None:
    """Write a whole solver of some hundred lines, and print the command that judges it."""
    from mpm_verify.solver.plugins import meant
    from mpm_verify.verify.run import usage

    with usage():
        if language not in LANGUAGES:
            near = meant(language, LANGUAGES)
            raise ValueError(f"no example in {language!r}{near}; choose from {', '.join(LANGUAGES)}")
        if to.exists() and (not to.is_dir() or any(to.iterdir())):
            raise ValueError(f"{to} is there already; name a new folder")
        to.mkdir(parents=True, exist_ok=True)
        for source in sorted((FOLDER / language).glob("*.in")):
            target = to / source.name.removesuffix(".in")
            target.write_text(source.read_text(encoding="utf-8"), encoding="utf-8")
            target.chmod(0o755 if target.suffix == ".sh" else 0o644)
    here = to if to.is_absolute() else f"./{to}"
    with printing():
        typer.echo(f"{to}: {', '.join(sorted(file.name for file in to.iterdir()))}")
        command = LANGUAGES[language].format(here=here, python=interpreter())
        first = FIRST.get(language, "clamped_shear:G=1e-6")
        typer.echo(f"judge it with: verify mms --quick --solver '{command}' --as mpm --solution {first}")


def interpreter() -> str:
    """Python that runs this command, which has NumPy: `python` where that is the one, else its path."""
    first = shutil.which("python")
    return (
        "python" if first and Path(first).absolute() == Path(sys.executable).absolute() else shlex.quote(sys.executable)
    )


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("example")(example)
