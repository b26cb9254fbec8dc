"""Construction of a study from a case, values of its axes and a number of replicates, checked before anything runs."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from itertools import product
from math import prod
from typing import Any, cast, get_type_hints

from pydantic import TypeAdapter, ValidationError

from mpm_verify.cases.harness.contract import Case, case_named
from mpm_verify.cases.harness.invalid import invalid, wrong
from mpm_verify.cases.harness.refinement import complete, elsewhere, refines
from mpm_verify.cases.harness.study import QuantityPlan, RunRecord, Study, head
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.plugins import create, is_file, label, meant

Values = Mapping[str, Sequence[Any]]
MOST = 10_000  # runs of a study, without those that its judgement adds
FIRST = ("method", "solution", "material")  # axes whose values begin the name of a study


@dataclass(frozen=True)
class Asked:
    """Request for a study, or for one part of it.

    Parameters
    ----------
    case
        Name of a case, a folder of `cases/`.
    values
        Values of the axes by the name of a field of the case's Run; other fields have their usual values.
    replicates
        Runs of each point of a refinement, with the particles elsewhere in their cells.
    quick
        Whether axes that are not given have the values of the case's QUICK.
    """

    case: str
    values: Values
    replicates: int = 1
    quick: bool = False

    @property
    def contract(self) -> Case:
        """Contract of the case."""
        return case_named(self.case)


def build(
    asked: Asked, command: str, name: str = "", title: str = "", words: Sequence[str] = (), finish: int | None = None
) -> Study[Any]:
    """Build the study of one product of axes.

    Parameters
    ----------
    asked
        Case, values of its axes and number of replicates.
    command
        Command that repeats the study.
    name, title, words, finish
        See `union`.

    Returns
    -------
    Study
        Its runs, and the plans of the quantities that it judges or shows.

    Raises
    ------
    ValueError
        One line that says what cannot be run, and what to type instead.
    """
    return union([asked], command, name, title, words, finish)


def union(
    parts: Sequence[Asked],
    command: str,
    name: str = "",
    title: str = "",
    words: Sequence[str] = (),
    finish: int | None = None,
) -> Study[Any]:
    """Build the study of several products of axes of one case.

    Parameters
    ----------
    parts
        One request or more, all of the same case.
    command
        Command that repeats the study.
    name
        Name of its folder; made of the case and of the values that are not usual if empty.
    title
        Title; that of the case if empty.
    words
        Sentences that say what the study is for.
    finish
        Number of runs that must come to their end, of a case that counts them; all of them if None.

    Returns
    -------
    Study
        Each run once, in the order of the parts, and the plans of the quantities that it judges or shows.

    Raises
    ------
    ValueError
        One line that says what cannot be run, and what to type instead.
    """
    case = parts[0].contract
    runs: list[RunRecord] = []
    plans: list[QuantityPlan[Any]] = []
    for part in (one for whole in parts for one in case.parts(whole)):
        more, planned = _runs(part)
        runs += more
        plans += planned
    once = tuple(dict.fromkeys(runs))
    unique: dict[Any, QuantityPlan[Any]] = {}
    for plan in plans:
        unique.setdefault((plan.head, plan.quantity, plan.norm), plan)
    least = len(once) if finish is None else finish
    if isinstance(least, bool) or not isinstance(least, int) or not 0 <= least <= len(once):
        raise ValueError(f"finish = {finish!r} must be a whole number from 0 to the {len(once)} runs there are")
    return Study(
        name or named(parts[0]),
        title or case.title(once),
        command,
        once,
        tuple(unique.values()),
        axes(once),
        tuple(words),
        least,
        case.name,
    )


def _runs(asked: Asked) -> tuple[tuple[Any, ...], list[QuantityPlan[Any]]]:
    """Runs and plans of one product of axes."""
    case = asked.contract
    known = [item.name for item in fields(case.Run)]
    for key in asked.values:
        if key not in known:
            raise ValueError(f"{case.name} has no axis {key!r}{meant(key, known)}; it has {', '.join(known)}")
    if any(not chosen for chosen in asked.values.values()):
        empty = next(key for key, chosen in asked.values.items() if not chosen)
        raise ValueError(f"{empty} has no value; give one or more, or leave it out")
    if asked.replicates != 1 and not (case.quantities and refines(case.Run)):
        raise ValueError(f"{case.name} has no refinement to repeat; leave replicates = {asked.replicates} out")
    usual = case.quick if asked.quick else case.axes
    values = {key: list(dict.fromkeys(asked.values.get(key) or usual.get(key) or ())) for key in known}
    values = {key: [read(case.Run, key, value) for value in chosen] for key, chosen in values.items() if chosen}
    times: list[float] = []
    if case.quantities and refines(case.Run):
        if len(values.get("offset", ())) > 1:
            raise ValueError("offset takes one value in a refinement; give --replicates to shift the particles")
        first, *times = values.get("courant") or [_default(case, "courant")]
        if any(courant > first for courant in times):
            raise ValueError(f"courant = {max(times)} is above the first, {first}; begin with the largest: 0.4,0.2,0.1")
        values["courant"] = [first]
        values |= {key: sorted(values[key]) for key in ("ppc", "cells") if key in values}
        inner = [key for key in ("ppc", "cells") if key in values]
        order = [key for key in values if key not in inner] + inner
    else:
        order = [*(key for key in asked.values if key in values), *(key for key in values if key not in asked.values)]
    if (count := prod(len(values[key]) for key in order) * max(1, asked.replicates)) > MOST:
        raise ValueError(
            f"{count:,} runs are asked for, and {MOST:,} is the most; give fewer values, or several studies"
        )
    points = [dict(zip(order, point, strict=True)) for point in product(*(values[key] for key in order))]
    runs = tuple(dict.fromkeys(make(case, point) for point in points))
    smaller = [make(case, {**point, "courant": courant}) for courant in times for point in points]
    own_plugins(runs)
    case.check((*runs, *smaller, *elsewhere(runs, asked.replicates)))
    if not (case.quantities and refines(case.Run)):
        return tuple(dict.fromkeys(case.companions(runs))), []
    plans = [plan for one in {head(run): run for run in reversed(runs)}.values() for plan in quantity_plans(case, one)]
    rank = {head(run): position for position, run in reversed(list(enumerate(runs)))}
    plans.sort(key=lambda plan: rank[plan.head])
    return complete(runs, plans, times, asked.replicates), plans


def own_plugins(runs: Sequence[RunRecord]) -> None:
    """Make the plug-ins that come from users' files, which checks them. Raises ValueError."""
    for item in fields(runs[0]) if runs else ():
        named = {getattr(run, item.name) for run in runs} if item.metadata.get("plugins") else set()
        for specification in sorted(one for one in named if is_file(one)):
            create(item.metadata["plugins"], specification)


def quantity_plans(case: Case, run: RunRecord) -> list[QuantityPlan[Any]]:
    """Plans of a refinement: every quantity in every norm, judged where an expectation is registered."""
    found, multiple = [], case.multiple(run)
    for quantity, norm in case.measures(run):
        expectation = _registered(case, case.expectation(run, quantity, norm))
        judged = expectation is not None and (case.judged is None or (quantity, norm) in case.judged)
        refutes = expectation is not None and expectation.order is not None and (quantity, norm) in case.refutes
        found.append(QuantityPlan(run, quantity, norm, judged, expectation, multiple, refutes))
    return found


def _registered(case: Case, expectation: Expectation | None) -> Expectation | None:
    """Expectation of a case, checked for the types of its numbers. Raises ValueError."""
    if expectation is None:
        return None
    try:
        TypeAdapter(Expectation).validate_json(json.dumps(asdict(expectation), default=repr), strict=True)
    except ValidationError as error:
        raise ValueError(f"{case.name}: expectation returns an Expectation with {invalid(error)}") from None
    return expectation


def make(case: Case, values: Mapping[str, Any]) -> RunRecord:
    """Make one run. Raises ValueError with one line for a value that it cannot have."""
    checked = {key: read(case.Run, key, value) for key, value in values.items()}
    named = case.canonical(checked)
    known = [item.name for item in fields(case.Run)]
    if unknown := [key for key in named if key not in known]:
        raise ValueError(f"{case.name}: canonical returns {unknown[0]!r}, and Run has the fields {', '.join(known)}")
    return case.Run(**named)


def read(run: type[RunRecord], key: str, value: Any) -> Any:
    """Value of a field as a TOML file has it. Raises ValueError for another type: true is not a number here."""
    hint = get_type_hints(run)[key]
    try:
        return TypeAdapter(hint).validate_python(tuple(value) if isinstance(value, list) else value, strict=True)
    except ValidationError as error:
        usual: Any = next(item.default for item in fields(run) if item.name == key)
        pair = isinstance(usual, tuple) and all(isinstance(part, float) for part in usual)
        what = f" must be {len(usual)} numbers" if pair else wrong(error.errors()[0])
        such = f", such as {usual}" if pair or type(usual) in (int, float) else ""
        raise ValueError(f"{key} = {value!r}{what}{such}") from None


def axes(runs: Sequence[RunRecord]) -> tuple[str, ...]:
    """Names of the fields in which the runs differ, in their order."""
    names = [item.name for item in fields(runs[0])] if runs else []
    return tuple(name for name in names if len({getattr(run, name) for run in runs}) > 1)


def _default(case: Case, key: str) -> Any:
    return next(item.default for item in fields(case.Run) if item.name == key)


def named(asked: Asked) -> str:
    """Name of a study: its methods and what is not as usual, so that another one gets a folder of its own."""
    case, words = asked.contract, [label(asked.case)]
    values = {key: list(dict.fromkeys(chosen)) for key, chosen in asked.values.items()}
    usual = {item.name: [item.default] for item in fields(case.Run)} | {k: list(v) for k, v in case.axes.items()}
    quick = {key: list(case.quick[key]) for key in FIRST if asked.quick and key in case.quick}
    for key in (key for key in FIRST if key in usual):
        taken: list[Any] = quick.get(key) or usual[key]
        chosen = values.pop(key, taken)
        words += map(str, chosen) if chosen != taken or (key == "method" and case.quantities) else ()
    for item in fields(case.Run):
        if item.metadata.get("whole") and item.name in values:  # a command: the names of its files
            values[item.name] = [re.sub(r"\{\w*\}|[^\s{}]*/", "", text) for text in values[item.name]]
        if item.name in values and values[item.name] != usual[item.name]:
            words += [item.name, *map(str, _flat(values[item.name]))]
    words += ["replicates", str(asked.replicates)] if asked.replicates != 1 else []
    words += ["quick"] if asked.quick and not {"cells", "ppc"} & asked.values.keys() else []
    return re.sub(r"[^A-Za-z0-9.]+", "-", " ".join(words)).strip("-")[:120]


def _flat(values: Iterable[Any]) -> list[Any]:
    found: list[Any] = []
    for value in values:
        found += cast("Iterable[Any]", value) if isinstance(value, tuple) else [value]
    return found
