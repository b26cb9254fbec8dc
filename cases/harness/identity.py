"""Name of a run: hash of its parameters, of the sources that compute it, and of what a user's files returned.

The sources are the import closures (solver/source_hash.py) of the case and of the plug-ins that the run names. A user's
solution counts by what it returns, any other user's file by its closure and by the data that stand in its modules;
both are asked for anew in each process, so that a helper, a data file, the environment and the clock count.
"""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, fields
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

from mpm_verify.solver.own_file import derived
from mpm_verify.solver.plugins import (
    MATERIALS,
    NEGATIVE_CONTROLS,
    RATES,
    SOLUTIONS,
    USUAL_RATE,
    available,
    create,
    is_file,
    load,
    split,
)
from mpm_verify.solver.source_hash import closure, source_hash


def digest(run: Any, plugins: Mapping[str, str], more: str = "") -> str:
    """Digest of a run, 16 hex digits. `plugins`: package of each field that names one; `more`: what else counts."""
    return _digest(run, repr(run), tuple(plugins), sources(run, plugins) + more)


@cache
def _digest(run: Any, written: str, plugins: tuple[str, ...], computed_by: str) -> str:
    """Digest; `written` tells apart runs that are equal, as they differ in fields that are not compared."""
    left_out = {item.name for item in fields(run) if not item.metadata.get("named", True)}
    parameters = {key: value for key, value in asdict(run).items() if key not in left_out}
    for field in plugins:
        name, rest = split(parameters[field])
        if is_file(name):  # wherever it is
            parameters[field] = f":{rest}"
    return hashlib.sha256((json.dumps(parameters, sort_keys=True) + computed_by).encode()).hexdigest()[:16]


def sources(run: Any, plugins: Mapping[str, str]) -> str:
    """Source hash of all that computes the run."""
    own = is_file(run.case)
    parts = [derived(Path(run.case)) if own else source_hash(run.computed_by)]
    parts += [identity(package, getattr(run, field)) for field, package in plugins.items()]
    return hashlib.sha256(" ".join(parts).encode()).hexdigest()


def identity(package: str, specification: str) -> str:
    """Source hash of a plug-in. A user's file that cannot be read any more has one that no other has."""
    if not is_file(specification):
        return _shipped(package, specification)
    try:
        return _own(package, specification, load(package, split(specification)[0]))
    except ValueError:
        return f"unreadable {specification}"


@cache
def _shipped(package: str, specification: str) -> str:
    name, rest = split(specification)
    if name == "none":
        return name
    module = f"{package}.{name}"
    if package != MATERIALS or "mpm_verify.solver.rate_material" not in closure(module):
        return source_hash(module)
    named = dict(item.partition("=")[::2] for item in rest.split(","))
    return source_hash(module) + _rate(named.get("rate", USUAL_RATE))


@cache
def _own(package: str, specification: str, plugin: type) -> str:
    """Hash of a user's file, asked for once for each time that it was executed."""
    made = create(package, specification)
    if package == SOLUTIONS:
        own = import_module(f"{SOLUTIONS}._own")
        text = own.derived(made) + source_hash(own.__name__) + identity(MATERIALS, made.material)
    else:
        text = derived(Path(split(specification)[0]))
        text += _rate(made.rate) if getattr(made, "rate", None) else ""
        text += energy(made) if getattr(made, "energy", None) else ""
    return hashlib.sha256(text.encode()).hexdigest()


def _rate(name: str) -> str:
    return identity(NEGATIVE_CONTROLS if name in available(NEGATIVE_CONTROLS) else RATES, name)


def energy(material: Any) -> str:
    """The stored energy of a user's material in the components of F, as text."""
    import sympy as sp

    F = [[sp.Symbol(f"F{i}{j}", real=True) for j in range(3)] for i in range(3)]
    return str(sp.srepr(sp.sympify(material.energy(F, sp.log))))
