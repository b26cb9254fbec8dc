"""A plug-in is a file: its name is the word on the command line, and the class in it has that name in CamelCase."""

from dataclasses import fields
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

from solver.sources import TOP

METHODS, MATERIALS, SOLUTIONS, CASES = "solver.basis", "solver.material", "mms.solutions", "cases.library"
KINDS = {METHODS: "method", MATERIALS: "material", SOLUTIONS: "solution", CASES: "case"}


def available(package: str) -> list[str]:
    """Names of the plug-ins in a package such as `solver.basis`, found without importing anything."""
    return sorted(file.stem for file in folder(package).glob("*.py") if not file.stem.startswith("_"))


def folder(package: str) -> Path:
    """Where the files of a package are."""
    return TOP.joinpath(*package.split("."))


def load(package: str, name: str) -> Any:
    """The class of plug-in `name`. Raises ValueError that lists the choices where there is no such file."""
    if name not in available(package):
        raise ValueError(f"no {KINDS.get(package, 'plug-in')} {name!r}; choose from {', '.join(available(package))}")
    return getattr(import_module(f"{package}.{name}"), camel(name))


def camel(name: str) -> str:
    """`neo_hookean` -> `NeoHookean`; all plug-in classes are named so, `cpdi` -> `Cpdi` among them."""
    return "".join(part.capitalize() for part in name.split("_"))


def create(package: str, specification: str) -> Any:
    """The plug-in with its parameters from `name` or `name:key=value,key=value`.

    Raises ValueError with one line that says what is allowed.
    """
    name, _, rest = specification.partition(":")
    plugin = load(package, name)
    allowed = [item.name for item in fields(plugin)]
    parameters: dict[str, float] = {}
    for item in filter(None, rest.split(",")):
        key, _, value = item.partition("=")
        if key not in allowed:
            raise ValueError(f"{name} has no parameter {key!r}; it has {', '.join(allowed) or 'none'}")
        if key in parameters:
            raise ValueError(f"{name}: {key} is given twice")
        parameters[key] = number(name, key, value)
    return plugin(**parameters)


def number(name: str, key: str, value: str) -> float:
    """The value of a parameter. Raises ValueError for what is no finite number."""
    try:
        parsed = float(value)
    except ValueError:
        raise ValueError(f"{name}: {key}={value!r} is no number") from None
    if not isfinite(parsed):
        raise ValueError(f"{name}: {key}={value} must be a finite number")
    return parsed
