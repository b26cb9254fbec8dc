"""Contract of a case, and the way to it by its name: `cases/<name>/case.py` is found, no list holds it.

A case is a module with
    Run, Result      records of cases/harness/study.py; each field of Run can be an axis of a study
    title            (runs) -> what a study of these runs is called unless it says otherwise
and a module `execute.py` beside it, which is read when a run is to be done and whose imports name the Results:
    execute          (run, tick) -> (Result, arrays): runs to the end; what cannot go on is a failed Result
and, where they apply, instead of the defaults of Case:
    AXES             values of the axes that are not asked for, by field
    QUANTITIES, NORMS, JUDGED, expectation      what the order rule is asked, see cases/harness/build.py
    canonical        (values) -> values: one name for one thing
    parts, companions, multiple                 see Case
    check            (runs): raises ValueError with one line for what cannot be run
    examine          (study, results, store) -> Analysis: checks of what is stored
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from types import ModuleType
from typing import Any

from pydantic import TypeAdapter

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, Study
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.plugins import CASES, available, meant


@dataclass(frozen=True)
class Case:
    """Case by its module; what the module does not say has a default here.

    Parameters
    ----------
    name
        Name of its folder below `cases/`.
    module
        The module `cases/<name>/case.py`.
    """

    name: str
    module: ModuleType

    @property
    def Run(self) -> type[RunRecord]:
        """Class of its runs."""
        return self.module.Run  # type: ignore[no-any-return]

    @property
    def title(self) -> Callable[[Sequence[RunRecord]], str]:
        """Title of a study that has none of its own."""
        return self.module.title  # type: ignore[no-any-return]

    @property
    def axes(self) -> Mapping[str, Sequence[Any]]:
        """Values of axes that nobody asked for; any other field has its default."""
        return getattr(self.module, "AXES", {})

    @property
    def quick(self) -> Mapping[str, Sequence[Any]]:
        """Values of axes of a study that takes seconds."""
        return getattr(self.module, "QUICK", {})

    @property
    def quantities(self) -> tuple[str, ...]:
        """Quantities whose errors are refined; none of a case without refinements."""
        return getattr(self.module, "QUANTITIES", ())

    @property
    def norms(self) -> tuple[str, ...]:
        """Norms of the errors."""
        return getattr(self.module, "NORMS", ())

    @property
    def judged(self) -> tuple[tuple[str, str], ...]:
        """Quantities and norms that are judged where something is expected of them."""
        return getattr(self.module, "JUDGED", ())

    @property
    def expectation(self) -> Callable[[RunRecord, str, str], Expectation | None]:
        """Function (run, quantity, norm) -> registered expectation of the refinement of the run, or None."""
        return getattr(self.module, "expectation", lambda run, quantity, norm: None)

    @property
    def multiple(self) -> Callable[[RunRecord], int]:
        """Function (run) -> number whose multiples are the cells that fit the body of the run."""
        return getattr(self.module, "multiple", lambda run: 1)

    @property
    def parts(self) -> Callable[[Any], Sequence[Any]]:
        """Function (Asked) -> parts of it, where usual values of one axis depend on another axis."""
        return getattr(self.module, "parts", lambda asked: [asked])

    @property
    def companions(self) -> Callable[[Sequence[RunRecord]], Sequence[RunRecord]]:
        """Function (runs) -> the runs with those that each of them is held against."""
        return getattr(self.module, "companions", lambda runs: runs)

    @property
    def canonical(self) -> Callable[[dict[str, Any]], dict[str, Any]]:
        """Function (values) -> values with one name for one thing: no parameters that are at their defaults."""
        return getattr(self.module, "canonical", lambda values: values)

    @property
    def check(self) -> Callable[[Sequence[RunRecord]], None]:
        """Function (runs) that raises ValueError, with what to type instead, for runs that cannot be."""
        return getattr(self.module, "check", lambda runs: None)

    @property
    def examine(self) -> Callable[..., Any] | None:
        """Function (study, results, store) -> checks of what is stored; None of a case without checks."""
        return getattr(self.module, "examine", None)

    @property
    def execute(self) -> Callable[..., Any]:
        """Function (run, tick) -> (Result, arrays): a run to its end, or to where it fails."""
        return import_module(f"{CASES}.{self.name}.execute").execute  # type: ignore[no-any-return]


@cache
def case_named(name: str) -> Case:
    """Find a case by its name.

    Parameters
    ----------
    name
        Name of a folder below `cases/` that has a `case.py`.

    Returns
    -------
    Case
        The same object for the same name.

    Raises
    ------
    ValueError
        One line that lists the cases there are.
    """
    if name not in available(CASES):
        near = meant(name, available(CASES))
        raise ValueError(f"no case {name!r}{near}; choose from {', '.join(available(CASES))}")
    return Case(name, import_module(f"{CASES}.{name}.case"))


@cache
def adapters(name: str) -> tuple[TypeAdapter[Any], TypeAdapter[Any]]:
    """Readers of a case's study.json and of its Results, built once: it takes longer than to read a file."""
    case = case_named(name)
    result: type[ResultRecord[Any]] = case.module.Result
    return TypeAdapter(Study[case.Run]), TypeAdapter(result)  # type: ignore[name-defined]
