"""Plug-ins: each is a file whose name is the word on the command line; its class has that name in CamelCase.

A plug-in may be a user's file, path/to/own.py or path/to/own.py:key=value; of a case, see the contract in
cases/harness/contract.py. A package may have a module `_own`: its `load(path)` makes the class in its own way, where
otherwise the file holds it, and its `check(plugin, path)` says what is wrong with a plug-in before anything runs.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from difflib import get_close_matches
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

from mpm_verify.solver.own_file import OwnFileError, guarded, module_of
from mpm_verify.solver.source_hash import TOP, find

METHODS, MATERIALS, SOLUTIONS, CASES = (
    "mpm_verify.solver.basis",
    "mpm_verify.solver.material",
    "mpm_verify.mms.solutions",
    "mpm_verify.cases",
)
LAYOUTS = "mpm_verify.mms.layouts"
PROBLEMS = "mpm_verify.cases.benchmark.problems"
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
    PROBLEMS: "problem",
}
USUAL_RATE = "green_naghdi"  # objective rate of a material in rate form that names none
FILE = r"(.+?\.py)(?::(\w+=.*|[^/\\]*))?"  # a path and parameters
CONTRACTS = {  # what the class of a kind has at least
    METHODS: ("support", "order", "fill"),
    MATERIALS: ("start", "update", "wave_speed"),
    SOLUTIONS: ("displacement", "boundary", "lower", "upper", "duration", "C", "margin", "material", "layout"),
    TRANSFERS: ("flip_fraction", "start", "give", "filter", "take"),
    LAYOUTS: ("check", "__call__"),
    RATES: ("unrotate", "rotate", "order"),
    NEGATIVE_CONTROLS: ("unrotate", "rotate", "order"),
    SMOOTHINGS: ("of", "where", "stress", "strain", "check"),
    PROBLEMS: ("material", "cells", "setup", "held"),
}


def available(package: str) -> list[str]:
    """Names of the plug-ins in a package, found without importing anything.

    Parameters
    ----------
    package
        A package of KINDS, such as METHODS.

    Returns
    -------
    list of str
        Sorted.
    """
    files = (file.stem for file in folder(package).glob("*.py") if not file.stem.startswith("_"))
    return sorted([*files, *(file.parent.name for file in folder(package).glob("*/execute.py"))])


def folder(package: str) -> Path:
    """Folder of a package."""
    return TOP.joinpath(*package.split(".")[1:])


def path(package: str, name: str) -> Path:
    """File of a plug-in; of a case the `case.py` of its folder."""
    file = folder(package) / f"{name}.py"
    return file if file.exists() else folder(package) / name / "case.py"


def load(package: str, name: str) -> Any:
    """Class of a plug-in.

    Parameters
    ----------
    package
        A package of KINDS, such as METHODS.
    name
        A name in it, or the path of a user's file.

    Returns
    -------
    type
        The class in the file.

    Raises
    ------
    ValueError
        If there is none; it lists the choices, or says what the user's file lacks.
    """
    if is_file(name) and package in CONTRACTS:
        make = _own(package, "load")
        return make(Path(name)) if make else own_class(package, Path(name))
    if name not in available(package):
        choices = ", ".join(available(package)) + (", or give a file: path/to/own.py" if package in CONTRACTS else "")
        near = meant(name, available(package))
        raise ValueError(f"no {KINDS.get(package, 'plug-in')} {name!r}{near}; choose from {choices}")
    return getattr(import_module(f"{package}.{name}"), camel(name))


def _own(package: str, name: str) -> Any:
    """Function of a package for users' files, None where it has none."""
    return getattr(import_module(f"{package}._own"), name, None) if find(f"{package}._own") else None


def meant(word: str, known: Iterable[str]) -> str:
    """` (did you mean cpdi?)` where a known name is near to a word that was typed, otherwise nothing."""
    near = get_close_matches(word.lower(), list(known), 1)
    return f" (did you mean {near[0]}?)" if near else ""


def own_class(package: str, path: Path) -> Any:
    """Class of a user's file: the one named as the file, or else the only one that keeps the contract.

    Raises OwnFileError that says what is missing, of the class named so or of the only one that has a part of it.
    """
    module, contract = module_of(path), CONTRACTS[package]
    found = [c for c in vars(module).values() if isinstance(c, type) and c.__module__ == module.__name__]
    named = [c for c in found if c.__name__ == camel(path.stem)]
    chosen = named or [c for c in found if not lacking(c, contract)]
    chosen = chosen or [c for c in found if len(lacking(c, contract)) < len(contract)]
    kind = f"a {KINDS[package]} has {', '.join(contract)}"
    if len(chosen) != 1:
        several = f"the classes {', '.join(c.__name__ for c in chosen)}: name one {camel(path.stem)}"
        raise OwnFileError(f"{path} has {several if chosen else f'no class {camel(path.stem)}'}; {kind}")
    if missing := lacking(chosen[0], contract):
        raise OwnFileError(f"{path}: the class {chosen[0].__name__} has no {', no '.join(missing)}; {kind}")
    return chosen[0]


def lacking(plugin: type, contract: Sequence[str]) -> list[str]:
    """Names that the contract asks for and a class has neither as a field nor as an attribute that does something."""
    known = {item.name for item in fields(plugin)} if is_dataclass(plugin) else set()
    there = {name for name in contract if not getattr(getattr(plugin, name, None), "__isabstractmethod__", False)}
    return [name for name in contract if name not in known and not (name in there and hasattr(plugin, name))]


def is_file(specification: str) -> bool:
    """Whether this names a user's file: its name ends in .py."""
    return split(specification)[0].endswith(".py")


def split(specification: str) -> tuple[str, str]:
    """Name and parameters of `name:key=value`; a path may have colons of its own, and a parameter may be a path."""
    file = None if re.match(r"\w+:\w+=", specification) else re.fullmatch(FILE, specification)
    if file:
        return file[1], file[2] or ""
    name, _, rest = specification.partition(":")
    return name, rest


def label(specification: str) -> str:
    """The specification with a user's file by its stem, for people."""
    name, rest = split(specification)
    return ":".join(filter(None, [Path(name).stem, rest])) if is_file(name) else specification


def absolute(specification: str) -> str:
    """The specification with a user's file by its whole path, so that it means the same in another folder."""
    name, rest = split(specification)
    return ":".join(filter(None, [str(Path(name).resolve()), rest])) if is_file(name) else specification


def camel(name: str) -> str:
    """`neo_hookean` -> `NeoHookean`; all plug-in classes are named so, `cpdi` -> `Cpdi` among them."""
    return "".join(part.capitalize() for part in name.split("_"))


def optional(package: str, specification: str) -> Any:
    """Make a plug-in with its parameters; None of `none`. Raises ValueError as `create`."""
    return None if specification == "none" else create(package, specification)


def canonical_optional(package: str, specification: str) -> str:
    """One name for one thing, as `canonical`, or ``none``. Raises as `canonical`."""
    return specification if specification == "none" else canonical(package, specification)


def create(package: str, specification: str) -> Any:
    """Make a plug-in with its parameters.

    Parameters
    ----------
    package
        A package of KINDS, such as METHODS.
    specification
        ``name`` or ``name:key=value,key=value``; a user's file by its path in place of the name.

    Returns
    -------
    object
        The plug-in: a basis, material, solution, transfer, layout or smoothing.

    Raises
    ------
    ValueError
        One line that says what is allowed.
    """
    name, rest = split(specification)
    plugin = load(package, name)
    allowed = parameters_of(plugin)
    given: dict[str, float | str] = {}
    for item in filter(None, rest.split(",")):
        key, _, value = item.partition("=")
        if key not in allowed:
            near = meant(key, allowed)
            raise ValueError(f"{name} has no parameter {key!r}{near}; it has {', '.join(allowed) or 'none'}")
        field = allowed[key]
        if field.name in given:
            raise ValueError(f"{name}: {key} is given twice")
        given[field.name] = number(name, key, value) if field.type in (float, "float") else absolute(value)
    return own(package, Path(name), plugin, given) if is_file(name) else plugin(**given)


def own(package: str, path: Path, plugin: Any, given: dict[str, float | str]) -> Any:
    """Plug-in of a user's file, checked once for each time that the file was executed. Raises ValueError."""
    needed = {key: item for key, item in parameters_of(plugin).items() if item.init and item.name not in given}
    bare = [key for key, item in needed.items() if item.default is MISSING and item.default_factory is MISSING]
    if bare:
        raise OwnFileError(f"{path}: {bare[0]} has no value; write {path}:{bare[0]}=..., or a default in the file")
    try:
        made = plugin(**given)
    except (TypeError, AttributeError, ArithmeticError, LookupError, RuntimeError, AssertionError):  # not ValueError:
        made = guarded(path, lambda: plugin(**given))  # that of a parameter out of range says it well
    known = (package, plugin, *sorted(given.items()))
    if known not in _checked:
        if check := _own(package, "check"):
            check(made, path)
        _checked.add(known)
    return made


_checked: set[tuple[Any, ...]] = set()  # plug-ins of users' files, with their parameters


def parameters_of(plugin: Any) -> "dict[str, Field[Any]]":
    """Fields of a plug-in by the name that a user types: a field may bear another, so that it hides no attribute."""
    known = fields(plugin) if is_dataclass(plugin) else ()
    return {item.metadata.get("typed", item.name): item for item in known}


def canonical(package: str, specification: str) -> str:
    """The specification with only the parameters that differ from their defaults, sorted: one name for one thing."""
    plugin: Any = create(package, specification)
    values = {name: (getattr(plugin, item.name), item.default) for name, item in parameters_of(plugin).items()}
    changed = [
        f"{key}={str(value).removesuffix('.0')}" for key, (value, usual) in sorted(values.items()) if value != usual
    ]
    return ":".join([split(absolute(specification))[0], *filter(None, [",".join(changed)])])


def number(name: str, key: str, value: str) -> float:
    """Value of a parameter. Raises ValueError for what is not a finite number."""
    try:
        parsed = float(value)
    except ValueError:
        raise ValueError(f"{name}: {key}={value!r} is not a number") from None
    if not isfinite(parsed):
        raise ValueError(f"{name}: {key}={value} must be a finite number")
    return parsed
