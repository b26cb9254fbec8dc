"""Contract of a case, and the way to it by its name: `cases/<name>/case.py` is found, no list holds it.

A user's case is one file, path/to/own.py, that has the names of both modules.

A case is a module with
    Run, Result      records of cases/harness/study.py; each field of Run can be an axis of a study
    title            (runs) -> what a study of these runs is called unless it says otherwise
and a module `execute.py` beside it, which is read when a run is to be done and whose imports name the Results:
    execute          (run, tick) -> (Result, arrays): runs to the end; what cannot go on is a failed Result
and, where they apply, instead of the defaults of Case:
    AXES             values of the axes that are not asked for, by field
    QUANTITIES, NORMS, JUDGED, expectation      what the order rule is asked, see cases/harness/build.py; the Run then
                                                has the fields REFINES
    canonical        (values) -> values: one name for one thing
    parts, companions, multiple                 see Case
    check            (runs): raises ValueError with one line for what cannot be run
    examine          (study, results, store) -> Analysis: checks of what is stored
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from importlib import import_module
from inspect import isfunction
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from pydantic import TypeAdapter

from mpm_verify.cases.harness.study import REFINED, ResultRecord, RunRecord, Study
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.own_file import guarded, module_of
from mpm_verify.solver.plugins import CASES, available, is_file, meant

REFINES = ("method", "ppc", *REFINED)  # fields of a Run whose errors are judged on refinement


@dataclass(frozen=True, eq=False)
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
    module: Any

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

    def execute(self, run: Any, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Any, Any]:
        """Result and arrays of a run, to its end or to where it fails."""
        module = self.module if is_file(self.name) else import_module(run.computed_by)
        result, arrays = module.execute(run, tick)
        return result, arrays


def case_named(name: str) -> Case:
    """Find a case by its name.

    Parameters
    ----------
    name
        Name of a folder below `cases/` that has a `case.py`, or a user's file, path/to/own.py.

    Returns
    -------
    Case
        The same object for the same name, as long as a file is not changed.

    Raises
    ------
    ValueError
        One line that lists the cases there are, or says what a file lacks.
    """
    if is_file(name):
        return _own(name, module_of(Path(name)))
    if name not in available(CASES):
        near = meant(name, available(CASES))
        raise ValueError(
            f"no case {name!r}{near}; choose from {', '.join(available(CASES))}, or give a file: path/to/own.py"
        )
    return _shipped(name)


@cache
def _shipped(name: str) -> Case:
    return Case(name, import_module(f"{CASES}.{name}.case"))


@cache
def _own(name: str, module: ModuleType) -> Case:
    """A case of a user's file, its records named after the file; what its functions raise is told with the line."""
    lacking = [word for word in ("Run", "Result", "title", "execute") if not hasattr(module, word)]
    if lacking:
        raise ValueError(f"{name} has no {', no '.join(lacking)}; a case has Run, Result, title and execute")
    for word, parent in {"Run": RunRecord, "Result": ResultRecord}.items():
        kind = getattr(module, word)
        if not (isinstance(kind, type) and issubclass(kind, parent) and kind.__module__ == module.__name__):
            raise ValueError(f"{name}: {word} must be a class below {parent.__name__} that is defined in this file")
    known = {item.name for item in fields(module.Run)}
    if hasattr(module, "QUANTITIES") and (missing := [word for word in REFINES if word not in known]):
        raise ValueError(f"{name}: a case with QUANTITIES refines, and its Run has no field {', no '.join(missing)}")
    module.Run.case = name
    held = {word: told(name, value) if isfunction(value) else value for word, value in vars(module).items()}
    return Case(name, SimpleNamespace(**held))


def told(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of a user's file that raises ValueError with one line, whatever it raises."""
    return lambda *given: guarded(Path(name), lambda: function(*given))


def adapters(name: str) -> tuple[TypeAdapter[Any], TypeAdapter[Any]]:
    """Readers of a case's study.json and of its Results, built once: it takes longer than to read a file."""
    return _adapters(case_named(name))


@cache
def _adapters(case: Case) -> tuple[TypeAdapter[Any], TypeAdapter[Any]]:
    result: type[ResultRecord[Any]] = case.module.Result
    return TypeAdapter(Study[case.Run]), TypeAdapter(result)  # type: ignore[name-defined]
