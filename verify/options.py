"""Options of commands that run a study: one for each field of the case's Run, and those that all of them have.

A field takes one value, or several with commas, and is then an axis of the study. Values are read as the types of the
Run say; names of plug-ins are completed from file names, so that neither Numba nor SymPy is imported for a help text.
"""

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Annotated, Any, get_args, get_type_hints

import typer
from typer.core import TyperCommand

from mpm_verify.verify.choices import choices, completing, completion

Jobs = Annotated[int | None, typer.Option(help="Runs at a time.", show_default="processors / threads")]
Threads = Annotated[int, typer.Option(help="Threads of one run; any number gives the same bits.")]
Out = Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/NAME-OF-THE-STUDY")]
Json = Annotated[bool, typer.Option("--json", help="One JSON document on standard output, nothing else.")]
Junit = Annotated[Path | None, typer.Option(help="Write verdicts and checks as JUnit XML.")]
Summary = Annotated[
    Path | None,
    typer.Option(
        help="Append a summary in Markdown to this file.",
        envvar="GITHUB_STEP_SUMMARY",
        show_envvar=False,
        show_default="$GITHUB_STEP_SUMMARY",
    ),
]
Page = Annotated[
    bool | None,
    typer.Option(
        "--page/--no-page", help="Draw the page.", show_default="page, unless --json, --junit or --quick ask for less"
    ),
]
Vtk = Annotated[bool, typer.Option("--vtk", help="Write snapshots for ParaView.")]
Minutes = Annotated[
    float,
    typer.Option(
        "--checkpoint",
        metavar="MINUTES",
        help="Minutes between two checkpoints, from which a run that was killed goes on; inf for none.",
    ),
]


Dask = Annotated[
    str | None,
    typer.Option(
        "--dask",
        metavar="ADDRESS",
        help="Run on the workers of a Dask cluster: the address of its scheduler, or a scheduler file.",
        show_default="this machine",
    ),
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Print the runs and what they take, and run nothing.")]
Yes = Annotated[bool, typer.Option("--yes", help="Run a study of more than an hour.")]
COMMON: dict[str, tuple[Any, Any]] = {
    "jobs": (Jobs, None), "threads": (Threads, 1), "out": (Out, None), "json_output": (Json, False),
    "junit": (Junit, None), "summary": (Summary, None), "page": (Page, None), "dry_run": (DryRun, False),
    "yes": (Yes, False), "dask": (Dask, None),
}  # fmt: skip


class StudyCommand(TyperCommand):
    """Command whose yes-or-no fields can be given as flags too: --force, --no-staggered."""

    flags: frozenset[str] = frozenset()

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse arguments in which flags have become --name=yes and --name=no."""
        return super().parse_args(ctx, [self.spelled(word, args[k + 1 :]) for k, word in enumerate(args)])

    def spelled(self, word: str, after: list[str]) -> str:
        """Argument with its value, where it is a flag."""
        name = word.removeprefix("--no-").removeprefix("--").replace("-", "_")
        if not word.startswith("--") or name not in self.flags:
            return word
        if word.startswith("--no-"):
            return f"--{name.replace('_', '-')}=no"
        return word if self.valued(after) else f"{word}=yes"

    def valued(self, after: list[str]) -> bool:
        """Whether the next argument is a value: yes or no, or any text where the command takes no text by itself."""
        if not after or after[0].startswith("-"):
            return False
        alone = any(item.param_type_name == "argument" for item in self.params)
        return not alone or bool(re.fullmatch(r"(yes|no|true|false)(,(yes|no|true|false))?", after[0]))


def study_command(
    app: typer.Typer,
    name: str,
    run: type[Any],
    function: Callable[..., int],
    usual: Mapping[str, Any],
    more: Mapping[str, tuple[Any, Any]] | None = None,
    leave_out: tuple[str, ...] = (),
) -> None:
    """Add a command: an option for each field of `run`, `more` options of its own, and the common ones.

    `usual` are values of axes that nobody asks for, for the help. The function is called with `asked`, the texts by
    field, and with all else by name.
    """
    axes = [item for item in fields(run) if item.name not in leave_out]
    hints = get_type_hints(run)
    own = {item.name: (option(item, hints, usual), None) for item in axes} | dict(more or {})
    names = [item.name for item in axes]

    def call(**given: Any) -> int:
        check_dask(given["dask"])
        asked = {key: given.pop(key) for key in names}
        return function(asked={key: text for key, text in asked.items() if text}, **given)

    call.__doc__ = function.__doc__
    flags = frozenset(item.name for item in axes if hints[item.name] is bool)
    command = type("Command", (StudyCommand,), {"flags": flags})
    app.command(name, cls=command)(signed(call, own))


def common(function: Callable[..., int]) -> Callable[..., int]:
    """Command with the options that all studies have, beside those in the signature of the function.

    It gets `out`, and the others as `**more`, keywords of Settings.
    """

    def call(**given: Any) -> int:
        check_dask(given["dask"])
        return function(**given)

    call.__doc__, parameters = function.__doc__, inspect.signature(function).parameters.values()
    typed = [item for item in parameters if item.name != "out" and item.kind is not inspect.Parameter.VAR_KEYWORD]
    return signed(call, {item.name: (item.annotation, item.default) for item in typed})


def check_dask(address: str | None) -> None:
    """Raise an error of one line where no scheduler listens: a study takes a while to build, and would end then."""
    if address is None:
        return
    from mpm_verify.cases.harness.scheduler import check_reachable

    try:
        check_reachable(address)
    except ValueError as error:
        raise typer.TyperException(str(error)) from error


def signed(call: Callable[..., int], own: Mapping[str, tuple[Any, Any]]) -> Callable[..., int]:
    """Give a function the signature that Typer reads: annotation and default of its own options, then the common."""
    parameters = [
        inspect.Parameter(key, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)
        for key, (annotation, default) in {**own, **COMMON}.items()
    ]
    call.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    call.__annotations__ = {item.name: item.annotation for item in parameters}
    return call


def option(item: Any, hints: Mapping[str, Any], usual: Mapping[str, Any]) -> Any:
    """Option of a field; it may be repeated, and takes several values with commas."""
    plugins, kind = item.metadata.get("plugins", ""), hints[item.name]
    words = ("yes", "no") if kind is bool else item.metadata.get("choices") or literal(kind)
    text = item.metadata.get("help", "")
    if plugins:
        text += f" {choices(plugins, own=True)}; parameters as name:key=value."
    complete = completion(plugins) if plugins else completing(lambda: words)
    default = usual.get(item.name, () if item.default is MISSING else (item.default,))
    shown = ",".join(spelled(value) for value in default)
    names = f"--{item.name.replace('_', '-')}"
    return Annotated[
        list[str] | None,
        typer.Option(names, help=text, autocompletion=complete, show_default=shown or False, metavar="TEXT"),
    ]


def literal(kind: Any) -> tuple[str, ...]:
    """The words of a Literal, none of another type."""
    return tuple(word for word in get_args(kind) if isinstance(word, str))


def spelled(value: Any) -> str:
    """Value as it is typed."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


def values(run: type[Any], asked: Mapping[str, list[str]]) -> dict[str, list[Any]]:
    """Values of axes from what was typed. Raises ValueError with one line that says what to type instead."""
    hints = get_type_hints(run)
    whole = {item.name for item in fields(run) if item.metadata.get("whole")}
    return {
        key: list(texts) if key in whole else [one for text in texts for one in parsed(key, hints[key], text)]
        for key, texts in asked.items()
    }


def parsed(key: str, kind: Any, text: str) -> list[Any]:
    """Values in one text. Raises ValueError."""
    if get_args(kind) and all(item is float for item in get_args(kind)):
        return [pair(key, part) for part in text.split(";")]
    return [single(key, kind, part, text) for part in split(text)]


def split(text: str) -> list[str]:
    """Split `a:x=1,y=2,b` into `a:x=1,y=2` and `b`: what is key=value goes on with the parameters before it."""
    found: list[str] = []
    for part in text.split(","):
        if found and re.fullmatch(r"\w+=[^:]*", part.strip()):
            found[-1] += f",{part.strip()}"
        else:
            found.append(part.strip())
    return found


WORDS = {"yes": True, "true": True, "no": False, "false": False}
EXAMPLES: dict[Any, str] = {
    int: "whole numbers, such as 8,16,32",
    float: "numbers, such as 0.4,0.2,0.1",
    bool: "yes or no",
}


def single(key: str, kind: Any, part: str, typed: str) -> Any:
    """One value, `part` of what was typed. Raises ValueError."""
    option_name = f"--{key.replace('_', '-')}"
    try:
        if kind is bool:
            return WORDS[part.lower()]
        return kind(part) if kind in (int, float) else part
    except (ValueError, KeyError):
        raise ValueError(f"{option_name} {typed!r} cannot be read; write {EXAMPLES[kind]}") from None


def pair(key: str, text: str) -> tuple[float, float]:
    """Two numbers of a text such as `0.25,-0.1`. Raises ValueError."""
    try:
        x, y = (float(part) for part in text.split(","))
    except ValueError:
        raise ValueError(f"--{key} {text!r} must be two numbers, such as 0.25,-0.1") from None
    return x, y
