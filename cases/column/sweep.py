"""Studies of the column from TOML files: what all runs share, and axes, whose product is run.

    title = "Run-out against damping"
    words = ["What the study is for.", "A sentence or more."]
    finish = 4                        # runs that must come to rest; all, unless it is said

    [run]                             # fields of cases.column.run.ColumnRun
    ppc = 9

    [sweep]                           # fields of ColumnRun, a list of values each
    damping = [0.0, 0.02, 0.05, 0.10]

Those of the paper's figures, and some more, ship with the project, in cases/studies.
"""

import tomllib
from dataclasses import fields
from itertools import product
from pathlib import Path
from typing import Any, get_type_hints

from pydantic import TypeAdapter, ValidationError

from mpm_verify.cases.column.run import PLUGINS, ColumnRun, ColumnStudy
from mpm_verify.cases.harness.shipped import STUDIES, shipped
from mpm_verify.solver.plugins import absolute

ALLOWED = tuple(item.name for item in fields(ColumnRun) if item.name != "case")
PARTS = ("title", "words", "finish", "run", "sweep")
MOST = 1000  # runs of a study: more is a slip of the pen
READ: dict[str, TypeAdapter[Any]] = {name: TypeAdapter(kind) for name, kind in get_type_hints(ColumnRun).items()}


def read(source: str, command: str) -> ColumnStudy:
    """The study of a file, or of a shipped name. Raises ValueError with one line for what is wrong with it."""
    path = Path(source) if source.endswith(".toml") else STUDIES / f"{source}.toml"
    if not source.endswith(".toml") and source not in shipped():
        raise ValueError(f"no study {source!r}; choose from {', '.join(shipped())}, or give a file: path/to/own.toml")
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"cannot read {path}: {(error.strerror or str(error)).lower()}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is no TOML: {error}") from None
    try:
        return build(path.stem, content, command)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def build(name: str, content: dict[str, Any], command: str) -> ColumnStudy:
    """The study of what such a file holds. Raises ValueError."""
    known(content, PARTS, "the file")
    shared, sweep = table(content, "run"), table(content, "sweep")
    both = sorted(shared.keys() & sweep.keys())
    if both:
        raise ValueError(f"{both[0]} must stand in [run] or in [sweep], not in both")
    for key, values in sweep.items():
        if not isinstance(values, list) or not values:
            raise ValueError(f"{key} in [sweep] must be a list of one value or more, not {values!r}")
    points = [dict(zip(sweep, values, strict=True)) for values in product(*sweep.values())]
    if len(points) > MOST:
        raise ValueError(f"[sweep] makes {len(points)} runs, and must make {MOST} or fewer")
    runs = tuple(dict.fromkeys(run_of({**shared, **point}) for point in points))
    words = content.get("words", [])
    if not isinstance(words, list) or not all(isinstance(word, str) for word in words):
        raise ValueError(f"words must be a list of sentences, not {words!r}")
    finish = content.get("finish", len(runs))
    if isinstance(finish, bool) or not isinstance(finish, int) or not 0 <= finish <= len(runs):
        raise ValueError(f"finish = {finish!r} must be a whole number from 0 to the {len(runs)} runs there are")
    title = content.get("title", name.replace("_", " "))
    if not isinstance(title, str):
        raise ValueError(f"title must be a sentence, not {title!r}")
    return ColumnStudy(name, title, command, runs, tuple(sweep), tuple(words), finish)


def known(content: dict[str, Any], allowed: tuple[str, ...], where: str) -> None:
    """Raises ValueError for a key that is not allowed."""
    for key in content:
        if key not in allowed:
            raise ValueError(f"{where} has {key!r}, and may have {', '.join(allowed)}")


def table(content: dict[str, Any], part: str) -> dict[str, Any]:
    """A part of the file, with fields of ColumnRun alone."""
    found = content.get(part, {})
    if not isinstance(found, dict):
        raise ValueError(f"{part} must be a table, [{part}], not {found!r}")
    known(found, ALLOWED, f"[{part}]")
    return found


def run_of(values: dict[str, Any]) -> ColumnRun:
    """A run. Raises ValueError with one line for a value that no column has."""
    from mpm_verify.cases.column.case import check

    read: dict[str, Any] = {key: strictly(key, value) for key, value in values.items()}
    read |= {key: absolute(read[key]) for key in PLUGINS if key in read}
    run = ColumnRun(**read)
    check(run)
    return run


def strictly(key: str, value: Any) -> Any:
    """The value of a field, as TOML has it. Raises ValueError for one of another kind: true is no number here."""
    try:
        return READ[key].validate_python(tuple(value) if isinstance(value, list) else value, strict=True)
    except ValidationError as error:
        says = error.errors()[0]["msg"]
        raise ValueError(f"{key} = {value!r}: {says[0].lower()}{says[1:]}") from None
