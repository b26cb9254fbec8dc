"""The command `verify`: one file a subcommand, each a few lines that call down. Nothing heavy is imported here."""

import contextlib
import os
import sys
import traceback
from typing import Annotated

import typer

from mpm_verify.verify.commands.audit import audit
from mpm_verify.verify.commands.column import column
from mpm_verify.verify.commands.element import material
from mpm_verify.verify.commands.expectations import expectations
from mpm_verify.verify.commands.graded import graded
from mpm_verify.verify.commands.list import list_plugins
from mpm_verify.verify.commands.methods import methods
from mpm_verify.verify.commands.mms import mms
from mpm_verify.verify.commands.objectivity import objectivity
from mpm_verify.verify.commands.report import report
from mpm_verify.verify.commands.sweep import sweep

USAGE, STOPPED = 2, 130

app = typer.Typer(name="verify", rich_markup_mode=None, pretty_exceptions_enable=False)
app.command("mms")(mms)
app.command("methods")(methods)
app.command("graded")(graded)
app.command("audit")(audit)
app.command("expectations")(expectations)
app.command("material")(material)
app.command("objectivity")(objectivity)
app.command("column")(column)
app.command("sweep")(sweep)
app.command("list")(list_plugins)
app.command("report")(report)


def print_version(wanted: bool) -> None:
    """Version and end."""
    if wanted:
        from importlib.metadata import version

        print(f"verify {version('mpm-verify')}")
        raise typer.Exit


@app.callback(invoke_without_command=True)
def root(
    context: typer.Context,
    version: Annotated[
        bool, typer.Option("--version", callback=print_version, is_eager=True, help="Print it.")
    ] = False,
) -> None:
    """Verification of the material point method: manufactured solutions, observed orders, verdicts, reports.

    Exit codes: 0 pass, 1 fail, 2 usage or solver error, 3 inconclusive.
    """
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())
        raise typer.Exit(USAGE)


def main() -> None:
    """Entry point: what is wrong in the input is one line on standard error, and exit code 2.

    A defect of this program ends with 2 too, and with its traceback: 1 would read as a verdict.
    """
    try:
        code = app(standalone_mode=False)
    except typer.TyperException as error:
        code = complain(error.format_message() if hasattr(error, "format_message") else str(error))
    except (typer.Abort, KeyboardInterrupt):
        code = STOPPED
    except Exception:
        traceback.print_exc()
        code = complain("this is a defect of verify, not of what it verifies; please report it with the lines above")
    if code == STOPPED:
        complain("stopped; what was finished is stored, and the same command goes on from there")
    sys.exit(code if isinstance(code, int) else 0)


def complain(message: str) -> int:
    """One line on standard error."""
    if message.startswith("No such command"):
        message = f"{message} Choose from {', '.join(str(command.name) for command in app.registered_commands)}."
    print(f"verify: {' '.join(message.split())}", file=sys.stderr)
    return USAGE


def run() -> None:
    """The console script: main, and out. Python takes half a second to take the libraries apart, for nothing."""
    try:
        main()
    except SystemExit as end:
        with contextlib.suppress(OSError, ValueError):
            sys.stdout.flush()
        os._exit(end.code if isinstance(end.code, int) else 0)


if __name__ == "__main__":
    run()
