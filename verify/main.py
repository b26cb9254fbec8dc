"""The command `verify`: one file a subcommand in verify/commands, found by its name.

Nothing is imported here that a help text does not need: `verify --help` reads the first line of each command's file.
"""

import contextlib
import os
import sys
from os import _exit  # before a user's file is executed, see solver/own_file.py

from mpm_verify.verify.exits import DEFECT, STOPPED, USAGE

FIRST = ("mms", "methods", "graded", "column", "sweep", "material", "objectivity")  # in the help, in this order
HERE = os.path.dirname(os.path.abspath(__file__))
CASES = os.path.join(os.path.dirname(HERE), "cases")
HELP = """\
Usage: verify COMMAND [OPTIONS]

Verification of the material point method: manufactured solutions, observed orders, verdicts, reports.

Commands (verify COMMAND --help says more):
{commands}
  OWN.py       A case of your own, from its file.

Options: -h, --help, --version, --install-completion, --show-completion

Exit codes: 0 pass, 1 fail, 2 usage or input, 3 inconclusive or nothing judged, 4 nothing could be judged because runs
ended in error, or a defect of verify.
"""


def files() -> dict[str, str]:
    """File of each command by its name: those of FIRST first; a case without a command file has its `case.py`.

    A command is called as the first line of its file says: that of the case `element` is `verify material`.
    """
    own = {file[:-3]: os.path.join(HERE, "commands", file) for file in os.listdir(os.path.join(HERE, "commands"))
           if file.endswith(".py") and not file.startswith("_")}  # fmt: skip
    found = {name: os.path.join(CASES, name, "case.py") for name in os.listdir(CASES)}
    found = {name: file for name, file in found.items() if os.path.exists(file)} | own
    found = {called_by(file) or name: file for name, file in found.items()}
    return {name: found[name] for name in sorted(found, key=lambda name: (name not in FIRST, rank(name)))}


def first_line(file: str) -> str:
    """First line of a file's docstring."""
    with open(file, encoding="utf-8") as text:
        return text.readline().strip().strip('"')


def called_by(file: str) -> str:
    """NAME in a first line that begins with `verify NAME; empty where there is none."""
    words = first_line(file).replace("`", " ").split()
    return words[1].rstrip(":") if words[:1] == ["verify"] else ""


def rank(name: str) -> tuple[int, str]:
    """Rank of a command in the help."""
    return (FIRST.index(name) if name in FIRST else len(FIRST), name)


def help_text() -> str:
    """Text of the help, a line for each command: the first line of their files."""
    lines = []
    for name, file in files().items():
        first = first_line(file)
        told = first.partition("`: ")[2] or first
        lines.append(f"  {name:13}{told[:1].upper()}{told[1:]}")
    return HELP.format(commands="\n".join(lines))


def application(asked: str = "") -> object:
    """Typer application, with the one command that is asked for, or with all of them."""
    from importlib import import_module

    import typer

    app = typer.Typer(name="verify", rich_markup_mode=None, pretty_exceptions_enable=False,
                      context_settings={"help_option_names": ["-h", "--help"]})  # fmt: skip
    app.callback()(root)
    known = files()
    if asked.endswith(".py"):
        import_module("mpm_verify.verify.commands._case").add(app, asked)
        return app
    for name in [asked] if asked in known else known:
        if known[name].startswith(CASES):
            import_module("mpm_verify.verify.commands._case").add(app, name)
        else:
            import_module(f"mpm_verify.verify.commands.{os.path.basename(known[name])[:-3]}").add(app)
    return app


def root() -> None:
    """Verification of the material point method: manufactured solutions, observed orders, verdicts, reports."""


def main() -> None:
    """Entry point: what is wrong in the input is one line on standard error, and exit code 2.

    A defect of this program ends with 4, and with its traceback: 1 would read as a verdict.
    """
    asked = sys.argv[1:2]
    if "_VERIFY_COMPLETE" in os.environ:  # a shell asks what it may complete
        sys.exit(called(""))
    if asked in ([], ["-h"], ["--help"]):
        sys.exit(told(help_text(), 0 if asked else USAGE))
    if asked == ["--version"]:
        from importlib.metadata import version

        sys.exit(told(f"verify {version('mpm-verify')}\n", 0))
    for before, word in zip(sys.argv, sys.argv[1:], strict=False):  # of a variable that is not set
        if not word or (word.startswith("--") and word.endswith("=")):
            name = word or (before if before.startswith("-") else "an argument")
            sys.exit(complain(f"{name.removesuffix('=')} is empty; give it a value, or leave it out"))
    if not asked[0].startswith("-") and not asked[0].endswith(".py") and asked[0] not in files():
        from mpm_verify.solver.plugins import meant

        names = ", ".join(files())
        sys.exit(complain(f"no command {asked[0]!r}{meant(asked[0], files())}; choose from {names}"))
    sys.exit(called(asked[0]))


def called(asked: str) -> int:
    """Run a command, and give its exit code."""
    import typer

    from mpm_verify.verify.terminal.output import printing

    try:
        with printing():
            code = application(asked)(standalone_mode=False)  # type: ignore[operator]
        if code == STOPPED:
            raise KeyboardInterrupt
    except typer.TyperException as error:
        code = complain(message_of(error), USAGE if getattr(error, "exit_code", 1) == 1 else error.exit_code)
    except (typer.Abort, KeyboardInterrupt) as error:
        if isinstance(error.__context__, EOFError):  # Typer takes it for an answer that nobody gave
            return defect(error.__context__)
        code = complain("stopped; what was finished is stored, and the same command goes on from there", STOPPED)
    except SystemExit as end:  # of the completion; and 1, which would read as a verdict, where nobody reads a help text
        code = 0 if end.code == 1 else end.code
    except Exception as error:
        from mpm_verify.solver.own_file import blamed

        line = blamed(error)
        return complain(line) if line else defect(error)
    return code if isinstance(code, int) else 0


def defect(error: BaseException) -> int:
    """Print the traceback of an error that is ours, and what to do with it; gives the exit code."""
    with contextlib.suppress(OSError, ValueError, AttributeError):
        import traceback

        traceback.print_exception(error)
    return complain(
        "this is a defect of verify, not of what it verifies; please report it with the lines above", DEFECT
    )


def message_of(error: Exception) -> str:
    """Line of an error of Typer's: of an option that is not there with those that are near to it, else of a value."""
    if near := getattr(error, "possibilities", None):
        return f"no option {getattr(error, 'option_name', '')} (did you mean {' or '.join(near)}?)"
    if said := unreadable(error):
        return said
    line = error.format_message() if hasattr(error, "format_message") else str(error)
    context = getattr(error, "ctx", None)
    command = context.info_name if context is not None and context.parent is not None else ""
    return f"{line.removesuffix('.')}; verify {command} --help says more" if command else line


def unreadable(error: Exception) -> str:
    """Line of a value that cannot be read, and what to type instead; empty of another error."""
    from pydantic import ValidationError

    parameter, cause = getattr(error, "param", None), error.__cause__
    if parameter is None or not isinstance(cause, ValidationError):
        return ""
    from mpm_verify.cases.harness.invalid import KINDS

    first = cause.errors()[0]
    kind, usual = KINDS.get(first["type"], ""), parameter.default
    usual = usual if type(usual) in (int, float) else 2
    what = f"{kind}, such as {usual:g}" if kind.endswith("number") else kind or first["msg"]
    return f"{max(parameter.opts, key=len)} {first['input']!r} cannot be read; write {what}"


def told(text: str, code: int) -> int:
    """Print, to somebody who may have gone; gives the exit code back, or USAGE where nothing can be written."""
    if sys.stdout is None:
        return code
    try:
        sys.stdout.write(text)
        sys.stdout.flush()
    except BrokenPipeError:
        return code
    except (OSError, ValueError, AttributeError) as error:
        return complain(f"cannot write to standard output: {getattr(error, 'strerror', None) or error}")
    return code


def complain(message: str, code: int = USAGE) -> int:
    """Print one line on standard error, if anybody reads it; gives the exit code back."""
    if sys.stderr is None:  # print() would take standard output instead
        return code
    with contextlib.suppress(OSError, ValueError, AttributeError):
        print(f"verify: {' '.join(message.split())}", file=sys.stderr, flush=True)
    return code


def run() -> None:
    """Console script: main, and out. Python takes half a second to take the libraries apart, for nothing."""
    try:
        main()
    except KeyboardInterrupt:
        _exit(complain("stopped; nothing was begun", STOPPED))
    except SystemExit as end:
        with contextlib.suppress(OSError, ValueError, AttributeError):
            sys.stdout.flush()
        _exit(end.code if isinstance(end.code, int) else 0)


if __name__ == "__main__":
    run()
