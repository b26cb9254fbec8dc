"""A plug-in is a file: its name is the word on the command line, and the class in it has that name in CamelCase.

A package with a module `_own` takes the path of a user's file too: `_own.load(path)` makes a class of it.
"""

import hashlib
import re
from dataclasses import Field, fields
from functools import cache
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

from mpm_verify.solver.sources import TOP

METHODS, MATERIALS, SOLUTIONS, CASES = (
    "mpm_verify.solver.basis",
    "mpm_verify.solver.material",
    "mpm_verify.mms.solutions",
    "mpm_verify.cases",
)
LAYOUTS = "mpm_verify.mms.layouts"
TRANSFERS = "mpm_verify.solver.transfers"
RATES, NEGATIVE_CONTROLS = "mpm_verify.solver.rates", "mpm_verify.solver.negative_controls"
SMOOTHINGS = "mpm_verify.solver.smoothing"
KINDS = {
    METHODS: "method",
    MATERIALS: "material",
    SOLUTIONS: "solution",
    CASES: "case",
    TRANSFERS: "transfer",
    LAYOUTS: "layout",
    RATES: "rate",
    NEGATIVE_CONTROLS: "negative control",
    SMOOTHINGS: "smoothing",
}


def available(package: str) -> list[str]:
    """Names of the plug-ins in a package such as `solver.basis`, found without importing anything."""
    files = (file.stem for file in folder(package).glob("*.py") if not file.stem.startswith("_"))
    return sorted([*files, *(file.parent.name for file in folder(package).glob("*/case.py"))])


def folder(package: str) -> Path:
    """Where the files of a package are."""
    return TOP.joinpath(*package.split(".")[1:])


def path(package: str, name: str) -> Path:
    """File of a plug-in; of a case the `case.py` of its folder."""
    file = folder(package) / f"{name}.py"
    return file if file.exists() else folder(package) / name / "case.py"


def load(package: str, name: str) -> Any:
    """The class of plug-in `name`, or of a user's file. Raises ValueError that lists the choices if there is none."""
    own = (folder(package) / "_own.py").exists()
    if own and is_file(name):
        return import_module(f"{package}._own").load(Path(name))
    if name not in available(package):
        choices = ", ".join(available(package)) + (", or give a file: path/to/own.py" if own else "")
        raise ValueError(f"no {KINDS.get(package, 'plug-in')} {name!r}; choose from {choices}")
    return getattr(import_module(f"{package}.{name}"), camel(name))


def is_file(specification: str) -> bool:
    """Whether this names a user's file: its name ends in .py."""
    return split(specification)[0].endswith(".py")


def split(specification: str) -> tuple[str, str]:
    """Name and parameters of `name:key=value`; a path may have colons of its own."""
    path = re.fullmatch(r"(.+\.py)(?::([^/\\]*))?", specification)
    if path:
        return path[1], path[2] or ""
    name, _, rest = specification.partition(":")
    return name, rest


def absolute(specification: str) -> str:
    """The specification with a user's file by its whole path, so that it means the same in another folder."""
    name, rest = split(specification)
    return ":".join(filter(None, [str(Path(name).resolve()), rest])) if is_file(name) else specification


def on_screen(specification: str) -> str:
    """Name on screen: of a user's file its stem, with the parameters."""
    name, rest = split(specification)
    return ":".join(filter(None, [Path(name).stem, rest])) if is_file(name) else specification


@cache
def source(path: Path) -> str:
    """Text of a user's file, read once a process: what is hashed is what is run. Raises ValueError."""
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{path}: {(error.strerror or str(error)).lower()}") from None
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no text") from None


def identity(specification: str) -> str:
    """What a specification stands for: a user's file by its content, wherever it is; anything else by its words.

    A file that cannot be read any more has an identity that no other has.
    """
    name, rest = split(specification)
    if not is_file(name):
        return specification
    try:
        return f"{hashlib.sha256(source(Path(name)).encode()).hexdigest()}:{rest}"
    except ValueError:
        return f"unreadable {specification}"


def camel(name: str) -> str:
    """`neo_hookean` -> `NeoHookean`; all plug-in classes are named so, `cpdi` -> `Cpdi` among them."""
    return "".join(part.capitalize() for part in name.split("_"))


def create(package: str, specification: str) -> Any:
    """The plug-in with its parameters from `name` or `name:key=value,key=value`.

    Raises ValueError with one line that says what is allowed.
    """
    name, rest = split(specification)
    plugin = load(package, name)
    allowed = parameters_of(plugin)
    given: dict[str, float | str] = {}
    for item in filter(None, rest.split(",")):
        key, _, value = item.partition("=")
        if key not in allowed:
            raise ValueError(f"{name} has no parameter {key!r}; it has {', '.join(allowed) or 'none'}")
        field = allowed[key]
        if field.name in given:
            raise ValueError(f"{name}: {key} is given twice")
        given[field.name] = number(name, key, value) if field.type in (float, "float") else value
    return plugin(**given)


def parameters_of(plugin: Any) -> "dict[str, Field[Any]]":
    """Fields of a plug-in by the name that a user types: a field may bear another, so that it hides no attribute."""
    return {item.metadata.get("typed", item.name): item for item in fields(plugin)}


def number(name: str, key: str, value: str) -> float:
    """The value of a parameter. Raises ValueError for what is no finite number."""
    try:
        parsed = float(value)
    except ValueError:
        raise ValueError(f"{name}: {key}={value!r} is no number") from None
    if not isfinite(parsed):
        raise ValueError(f"{name}: {key}={value} must be a finite number")
    return parsed
