"""The command `verify`: one file a subcommand in verify/commands, found by its name; nothing heavy is imported here."""

import contextlib
import os
import sys
import traceback
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.solver.plugins import CASES, available
from mpm_verify.verify.run import DEFECT, USAGE

STOPPED = 130
COMMANDS = ("mms", "methods", "graded", "column", "sweep", "element", "objectivity")  # first in the help, in this order


def files() -> list[str]:
    """Names of the commands' files and of cases: those of COMMANDS first, then by name."""
    there = sorted({*own(), *available(CASES)})
    return [*(name for name in COMMANDS if name in there), *(name for name in there if name not in COMMANDS)]


def own() -> list[str]:
    """Commands that have a file of their own; a case without one has the command that any case can have."""
    return [file.stem for file in Path(__file__).with_name("commands").glob("[a-z]*.py")]


def application(asked: str = "") -> Any:
    """The Typer application: with the one command that is asked for, or with all of them."""
    app = typer.Typer(name="verify", rich_markup_mode=None, pretty_exceptions_enable=False,
                      context_settings={"help_option_names": ["-h", "--help"]})  # fmt: skip
    app.callback(invoke_without_command=True)(root)
    for name in [asked] if asked in files() else files():
        if name in own():
            import_module(f"mpm_verify.verify.commands.{name}").add(app)
        else:
            import_module("mpm_verify.verify.commands._case").add(app, name)
    return app


def print_version(wanted: bool) -> None:
    """Version and end."""
    if wanted:
        from importlib.metadata import version

        print(f"verify {version('mpm-verify')}")
        raise typer.Exit


def root(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=print_version, is_eager=True, help="Print it.")
    ] = False,
) -> None:
    """Verification of the material point method: manufactured solutions, observed orders, verdicts, reports.

    Exit codes: 0 pass, 1 fail, 2 usage or input, 3 inconclusive or nothing judged, 4 nothing could be judged because
    runs ended in error, or a defect of verify.
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(USAGE)


def main() -> None:
    """Entry point: what is wrong in the input is one line on standard error, and exit code 2.

    A defect of this program ends with 4, and with its traceback: 1 would read as a verdict.
    """
    try:
        code = application(next(iter(sys.argv[1:]), ""))(standalone_mode=False)
    except typer.TyperException as error:
        message = error.format_message() if hasattr(error, "format_message") else str(error)
        code = complain(message, getattr(error, "exit_code", USAGE))
        code = USAGE if code == 1 else code
    except (typer.Abort, KeyboardInterrupt):
        code = complain("stopped; what was finished is stored, and the same command goes on from there", STOPPED)
    except Exception:
        with contextlib.suppress(OSError, ValueError, AttributeError):
            traceback.print_exc()
        code = complain(
            "this is a defect of verify, not of what it verifies; please report it with the lines above", DEFECT
        )
    sys.exit(code if isinstance(code, int) else 0)


def complain(message: str, code: int = USAGE) -> int:
    """One line on standard error, if anybody reads it; gives the exit code back."""
    if message.startswith("No such command"):
        message = f"{message} Choose from {', '.join(files())}."
    with contextlib.suppress(OSError, ValueError, AttributeError):
        print(f"verify: {' '.join(message.split())}", file=sys.stderr)
    return code


def run() -> None:
    """The console script: main, and out. Python takes half a second to take the libraries apart, for nothing."""
    try:
        main()
    except SystemExit as end:
        with contextlib.suppress(OSError, ValueError, AttributeError):
            sys.stdout.flush()
        os._exit(end.code if isinstance(end.code, int) else 0)


if __name__ == "__main__":
    run()
