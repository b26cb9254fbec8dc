"""The command `verify`: one file a subcommand, each a few lines that call down. Nothing heavy is imported here."""

import sys
from typing import Annotated

import typer

from verify.list import list_plugins
from verify.mms import mms
from verify.report import report

USAGE = 2

app = typer.Typer(name="verify", rich_markup_mode=None, pretty_exceptions_enable=False)
app.command("mms")(mms)
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
    """Entry point: what is wrong in the input is one line on standard error, and exit code 2."""
    try:
        code = app(standalone_mode=False)
    except typer.TyperException as error:
        code = complain(error.format_message() if hasattr(error, "format_message") else str(error))
    except (typer.Abort, KeyboardInterrupt):
        complain("stopped; what was finished is stored, and the same command goes on from there")
        code = 130
    except BrokenPipeError:
        sys.stderr.close()  # nobody listens any more: no traceback at exit either
        code = 0
    sys.exit(code if isinstance(code, int) else 0)


def complain(message: str) -> int:
    """One line on standard error."""
    print(f"verify: {' '.join(message.split())}", file=sys.stderr)
    return USAGE


if __name__ == "__main__":
    main()
