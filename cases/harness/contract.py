"""Contract of a case, and the way to it by its name: `cases/<name>/case.py` is found, no list holds it.

A user's case is one file, path/to/own.py, that has the names of both modules.

A case is a module with
    Run, Result      records of cases/harness/study.py; each field of Run can be an axis of a study
    title            (runs) -> what a study of these runs is called unless it says otherwise
and a module `execute.py` beside it, which is read when a run is to be done and whose imports name the Results:
    execute          (run, tick) -> (Result, arrays): runs to the end; what cannot go on is a failed Result; one that
                     takes a `checkpoint` too can go on from there, see checkpoint.py
and, where they apply, instead of the defaults of Case:
    COMMAND          command with an option for each field of Run but those in it: `benchmark {run.problem}`
    AXES             values of the axes that are not asked for, by field
    QUANTITIES, NORMS, JUDGED, expectation      what the order rule is asked, see cases/harness/build.py; the Run then
                                                has the fields REFINES
    canonical        (values) -> values: one name for one thing
    parts, companions, multiple, measures       see Case
    check            (runs): raises ValueError with one line for what cannot be run
    examine          (study, results, store) -> Analysis: checks of what is stored
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from functools import cache, wraps
from importlib import import_module
from inspect import isfunction, signature
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

from pydantic import PydanticUserError, TypeAdapter

from mpm_verify.cases.harness.study import REFINED, ResultRecord, RunRecord, Study
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.own_file import OwnFileError, guarded, module_of, said, shortened
from mpm_verify.solver.plugins import CASES, available, is_file, meant

REFINES = ("method", "ppc", *REFINED)  # fields of a Run whose errors are judged on refinement
GIVES: Mapping[str, tuple[Callable[[Any], bool], str]] = {  # what a function of a user's case returns
    "title": (lambda found: isinstance(found, str) and found != "", "a text"),
    "expectation": (lambda found: found is None or isinstance(found, Expectation), "an Expectation or None"),
    "multiple": (lambda found: isinstance(found, int) and found > 0, "a whole number above zero"),
    "measures": (lambda found: _listed(found, tuple), "pairs of quantity and norm in a list"),
    "parts": (
        lambda found: _listed(found) and all(hasattr(one, "contract") for one in found),
        "Asked in a list",
    ),
    "companions": (lambda found: _listed(found, RunRecord), "runs in a list"),
    "canonical": (lambda found: isinstance(found, dict), "the dictionary of values"),
    "examine": (lambda found: found is None or hasattr(found, "checks"), "an Analysis"),
    "execute": (lambda found: isinstance(found, tuple) and len(found) == 2, "(Result, arrays)"),
}


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
    def command(self) -> str:
        """Command with an option for each other field of a run, `benchmark {run.problem}`; empty where none is."""
        return getattr(self.module, "COMMAND", "")

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
    def judged(self) -> tuple[tuple[str, str], ...] | None:
        """Quantities and norms that are judged where something is expected of them; None: all."""
        return getattr(self.module, "JUDGED", ())

    @property
    def refutes(self) -> tuple[tuple[str, str], ...]:
        """Quantities and norms whose FAIL counts where an order is expected of them, and nothing else of theirs."""
        return getattr(self.module, "REFUTES", ())

    @property
    def expectation(self) -> Callable[[RunRecord, str, str], Expectation | None]:
        """Function (run, quantity, norm) -> registered expectation of the refinement of the run, or None."""
        return getattr(self.module, "expectation", lambda run, quantity, norm: None)

    @property
    def measures(self) -> Callable[[Any], Sequence[tuple[str, str]]]:
        """Function (run) -> quantity and norm of each of its errors; usual are all of QUANTITIES in all of NORMS."""
        usual = tuple((quantity, norm) for quantity in self.quantities for norm in self.norms)
        return getattr(self.module, "measures", lambda run: usual)

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

    def execute(
        self, run: Any, tick: Callable[[float], None] = lambda fraction: None, checkpoint: Any = None
    ) -> tuple[Any, Any]:
        """Result and arrays of a run, to its end or to where it fails; it goes on from a checkpoint if it takes one."""
        module = self.module if is_file(self.name) else import_module(run.computed_by)
        kept = {"checkpoint": checkpoint} if "checkpoint" in signature(module.execute).parameters else {}
        result, arrays = module.execute(run, tick, **kept)
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
        raise OwnFileError(f"{name} has no {', no '.join(lacking)}; a case has Run, Result, title and execute")
    for word, parent in {"Run": RunRecord, "Result": ResultRecord}.items():
        kind = getattr(module, word)
        if not (isinstance(kind, type) and issubclass(kind, parent) and kind.__module__ == module.__name__):
            raise OwnFileError(f"{name}: {word} must be a class below {parent.__name__} that is defined in this file")
        if not is_dataclass(kind) or "__dataclass_fields__" not in vars(kind):
            raise OwnFileError(f"{name}: write @dataclass(frozen=True) before the class {word}")
    known = [item.name for item in fields(module.Run)]
    if hasattr(module, "QUANTITIES") and (missing := [word for word in REFINES if word not in known]):
        raise OwnFileError(f"{name}: a case with QUANTITIES refines, and its Run has no field {', no '.join(missing)}")
    _check_axes(name, module, known)
    _check_judged(name, module)
    module.Run.case = name
    held = {word: told(name, word, value) if isfunction(value) else value for word, value in vars(module).items()}
    return Case(name, SimpleNamespace(**held))


def _check_axes(name: str, module: ModuleType, known: Sequence[str]) -> None:
    """Check that AXES and QUICK of a user's case hold values of fields of its Run."""
    for word in ("AXES", "QUICK"):
        held = getattr(module, word, {})
        if not isinstance(held, Mapping):
            raise OwnFileError(f"{name}: {word} = {shortened(held)} must be a dictionary, such as {{'cells': (8, 16)}}")
        for key, values in held.items():
            if key not in known:
                raise OwnFileError(
                    f"{name}: {word} has {key!r}, which is no field of Run{meant(str(key), known)}; it has "
                    f"{', '.join(known)}"
                )
            if not isinstance(values, tuple | list) or not values:
                raise OwnFileError(f"{name}: {word} has {key!r}: {shortened(values)}; write values, such as (8, 16)")


def _check_judged(name: str, module: ModuleType) -> None:
    """Check that QUANTITIES and NORMS of a user's case are words, and that JUDGED and REFUTES have pairs of them."""
    words = {word: getattr(module, word, ()) for word in ("QUANTITIES", "NORMS")}
    for word, held in words.items():
        if not isinstance(held, tuple | list) or not all(isinstance(item, str) for item in held):
            raise OwnFileError(f"{name}: {word} = {shortened(held)} must be words with a comma, such as ('u',)")
    for told_, pair in ((t, pair) for t in ("JUDGED", "REFUTES") for pair in _pairs(getattr(module, t, ()))):
        if not isinstance(pair, tuple) or len(pair) != 2:
            raise OwnFileError(f"{name}: {told_} = {shortened(getattr(module, told_))} must be pairs, such as "
                               "(('u', 'rms'),)")  # fmt: skip
        for item, (word, held) in zip(pair, words.items(), strict=True):
            if item not in held:
                raise OwnFileError(f"{name}: {told_} has {pair!r}, and {word} has {', '.join(held) or 'nothing'}")
    if words["QUANTITIES"] and not words["NORMS"]:
        raise OwnFileError(f"{name}: a case with QUANTITIES has NORMS too, such as ('rms',)")


def _pairs(found: Any) -> Sequence[Any]:
    """Pairs of a list; what is none is looked at as one."""
    return found if isinstance(found, tuple | list) else [found]


def _listed(found: Any, kind: type = object) -> bool:
    """Whether this is a list or tuple of one kind."""
    return isinstance(found, list | tuple) and all(isinstance(one, kind) for one in found)


def told(name: str, word: str, function: Callable[..., Any]) -> Callable[..., Any]:
    """Function of a user's file that raises OwnFileError with one line, whatever it raises or returns."""
    right, spelled = GIVES.get(word, (lambda found: True, ""))

    @wraps(function)
    def call(*given: Any, **named: Any) -> Any:
        found = guarded(Path(name), lambda: function(*given, **named))
        if not right(found):
            raise OwnFileError(f"{name}: {word} must return {spelled}, not {shortened(found)}")
        return found

    return call


def adapters(name: str) -> tuple[TypeAdapter[Any], TypeAdapter[Any]]:
    """Readers of a case's study.json and of its Results, built once: it takes longer than to read a file."""
    return _adapters(case_named(name))


@cache
def _adapters(case: Case) -> tuple[TypeAdapter[Any], TypeAdapter[Any]]:
    result: type[ResultRecord[Any]] = case.module.Result
    try:
        return TypeAdapter(Study[case.Run]), TypeAdapter(result)  # type: ignore[name-defined]
    except (PydanticUserError, NameError) as error:
        if not is_file(case.name):
            raise
        raise OwnFileError(f"{case.name}: Run or Result has a field that cannot be stored: {said(error)}") from error
