"""Solvers of somebody else that are Python functions: called in this process, arrays in and frames out."""

import hashlib
import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.solvers.answer import Frame, framed
from mpm_verify.cases.solvers.command import PYTHON
from mpm_verify.cases.solvers.components import NAMES, QUANTITIES, spread
from mpm_verify.cases.solvers.levels import Levels, stated
from mpm_verify.mms.components import AXES
from mpm_verify.mms.export.record import CaseRecord
from mpm_verify.solver.failure import FailureKind, RunFailed
from mpm_verify.solver.own_file import shortened
from mpm_verify.solver.source_hash import file_hash
from mpm_verify.solver.state import Floats

_known: dict[str, Callable[["Case"], Any]] = {}


@dataclass(frozen=True)
class Case:
    """Case for a Python function.

    Parameters
    ----------
    record
        Content of case.json: grid, steps, dt, frames, edges, material.
    particles
        Columns (P,) of particles.csv by name.
    body_force
        Function (X, t) of reference positions (n,d) and a time: force per mass (n,d).
    """

    record: CaseRecord
    particles: Mapping[str, Floats]
    body_force: Callable[[Floats, float], Floats]

    def array(self, name: str, after: str = "") -> Floats:
        """Array of a field by its letter: X, x, v (P,d), F (P,d,d), s (P,4 or 6); `after` is _half or _before.

        In one dimension s is (P,1), and in axisymmetry F is (P,5).
        """
        d, around = self.record.dimension, self.record.axisymmetric
        names = {**QUANTITIES[d], "s": QUANTITIES[d]["sigma"], "X": tuple(AXES[:d].upper())}[name]
        if name == "F" and around:
            names = NAMES[name, 5]
        values = np.stack([self.particles[f"{one}{after}"] for one in names], axis=-1)
        return values.reshape(-1, d, d) if name == "F" and not around else values


def register(function: Callable[[Case], Any]) -> str:
    """Name of a function as the solver of a run."""
    name = f"{PYTHON}{function.__module__}.{getattr(function, '__qualname__', type(function).__qualname__)}"
    _known[name] = function
    return name


def known(name: str) -> Callable[[Case], Any]:
    """Function of a name. Raises ValueError in a process that has not registered it."""
    if name not in _known:
        raise ValueError(f"the solver {name} is a Python function; run it with mpm_verify.study(solver=...)")
    return _known[name]


def version(name: str) -> str:
    """Hash of the file in which a function is defined and of what it imports, 12 hex digits; or of the code alone."""
    function = known(name)
    target = function if hasattr(function, "__code__") else type(function)
    try:
        text = file_hash(Path(inspect.getfile(target)))
    except (TypeError, OSError, SyntaxError):
        text = ""
    code = getattr(function, "__code__", None)
    text += repr((code.co_code, code.co_consts)) if code else ""
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def called(name: str, case: Case, X: Floats, spacing: float) -> tuple[dict[int, Frame], Levels]:
    """Frames of a function, and their levels. Raises RunFailed for one that fails or gives something else.

    The function returns a mapping of steps to arrays x, v, F, sigma, in the order of the particles, or such a mapping
    and one of levels, as result.json has them.
    """
    try:
        given = known(name)(case)
    except Exception as error:
        said = shortened(f"{type(error).__name__}: {error}")
        raise RunFailed(FailureKind.SOLVER_ERROR, -1, numbers={"code": 1.0}, names={"said": said}) from error
    frames, told = given if isinstance(given, tuple) and len(given) == 2 else (given, {})
    if not isinstance(frames, Mapping):
        raise RunFailed(FailureKind.UNREADABLE, -1, names={"file": "what the function returns"})
    found = {}
    for step in case.record.frames:
        if step not in frames:
            raise RunFailed(FailureKind.NO_ANSWER, step, names={"file": f"frame {step}"})
        try:
            columns = spread({key: np.asarray(values) for key, values in frames[step].items()}, X.shape[1])
        except (AttributeError, TypeError, ValueError):
            raise RunFailed(FailureKind.UNREADABLE, step, names={"file": f"frame {step}"}) from None
        columns.setdefault("id", np.arange(len(next(iter(columns.values()), ()))))
        found[step] = framed(columns, X, spacing, f"frame {step}", step)
    return found, stated(told, "the levels")
