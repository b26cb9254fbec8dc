"""Commands to type for the run that would decide: the command of the study with one option changed."""

import os
import shlex
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.study import QuantityPlan, Study, head
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.records import Action, Outcome, ReasonCode, Wanted
from mpm_verify.cases.mms.expectations import expected
from mpm_verify.mms.discretisation import axisymmetric, dimension
from mpm_verify.reports.sentences import any_code, own_solver, verdicts
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.plugins import METHODS, SOLUTIONS, available, canonical, create, is_file, label, split


def reason(study: Study[Any], found: Finding) -> str:
    """Reason of a verdict, and the option that asks for the run that would decide where nothing does."""
    if found.plan.run.given:
        return ": ".join(filter(None, [verdicts.said(found.verdict.reason), decides(study, found)]))
    if found.plan.expectation is None:
        return verdicts.shown(found.verdict.reason)
    if no_step_decides(found):
        return verdicts.said(found.verdict.reason)
    return verdicts.reason(found.verdict.reason, courants(study, found.plan))


def command(study: Study[Any], found: Finding, folder: Path | None = None) -> str:
    """Command of the study that would decide; empty where no run would, or none can be asked for.

    It goes on in the `folder` of the study where that is not the usual one.
    """
    r = found.verdict.reason
    if r.wanted is None or found.plan.run.given or no_step_decides(found):
        return ""
    if r.wanted.action is Action.FINISH:
        return study.command if r.failed[0].failure.kind is FailureKind.NOT_RUN else ""
    option = verdicts.options(r.wanted, courants(study, found.plan))
    if not option:
        return ""
    words = replaced(typed(study, found.plan, r.wanted), *option)
    if folder is not None and folder.absolute() != Path("results", study.name).absolute():
        words += ["--out", os.path.relpath(folder)]
    return shlex.join(words)


def decides(study: Study[Any], found: Finding, folder: Path | None = None) -> str:
    """Command that would decide; of numbers that were given, what to change in their table."""
    wanted, run = found.verdict.reason.wanted, found.plan.run
    if run.given and wanted:
        return any_code.advice(wanted, run.by, [level.h for level in found.levels], run.exact)
    return command(study, found, folder)


def unregistered(study: Study[Any]) -> str:
    """Phrase on what to type where nothing is registered of a solver of somebody else; empty of any other study."""
    run = study.runs[0]
    if not getattr(run, "solver", "") or "start" in study.axes:
        return ""
    if split(run.method)[0] not in available(METHODS):
        return "; say what is expected: --order 2, or --as METHOD"
    also = f", or --solution {small}" if (small := small_motion(run)) else ""
    return (
        f"; {run.method} has nothing registered on {label(run.solution)} with {run.ppc} per cell: type --order 2{also}"
    )


def small_motion(run: Any) -> str:
    """Solution of a run with a motion that is next to nothing, of which something is registered; empty without one."""
    for key in () if is_file(run.solution) else ("A", "G"):
        small = f"{split(run.solution)[0]}:{key}=1e-6"
        with suppress(ValueError):
            if expected(run.method, canonical(SOLUTIONS, small), run.material, run.ppc, "u", "rms"):
                return small
    return ""


def no_step_decides(found: Finding) -> bool:
    """Whether smaller time steps are asked for where a solver of somebody else loses something in each step."""
    wanted = found.verdict.reason.wanted
    halves = wanted is not None and wanted.action in (Action.HALVE_ALL, Action.HALVE_FINEST)
    return halves and bool(hinted(found) & set(own_solver.LOSSES))


def hinted(found: Finding) -> set[str]:
    """Names of the hints on a solver of somebody else; none of the reference solver."""
    return own_solver.causes(found.results) if getattr(found.plan.run, "solver", "") else set()


FREE = {"plane": "bump", "line": "bump1d", "around": "bump_rz", "space": "bump3d"}  # solutions without walls
LOW = 1.8  # order below which time levels may be to blame


def levels(study: Study[Any], found: Sequence[Finding], folder: Path) -> str:
    """Command that gives a solver of somebody else other time levels, where its order is low; empty elsewhere."""
    if study.command.split()[:2] != ["verify", "mms"] or not any(map(levels_to_blame, found)):
        return ""
    cells = sorted({run.cells for run in study.runs})[-2:]
    words = [word for word in shlex.split(study.command) if word != "--quick"]
    words = replaced(replaced(words, "--cells", ",".join(map(str, cells))), "--start", "all")
    return shlex.join([*words, "--out", f"{os.path.relpath(folder)}-levels"])


def walls(study: Study[Any], found: Sequence[Finding], folder: Path) -> str:
    """Command of the same study of a body without walls, where the order is low beside some; empty elsewhere."""
    solutions = {run.solution for run in study.runs} if study.case == "mms" else set()
    if study.command.split()[:2] != ["verify", "mms"] or not any(map(levels_to_blame, found)):
        return ""
    if (
        not solutions
        or not all(has_walls(one) for one in solutions)
        or any(run.start or run.dim == 3 for run in study.runs)
    ):
        return ""
    kinds = {kind(one) for one in solutions}
    if len(kinds) > 1:
        return ""
    free = FREE[kinds.pop()]
    words = replaced(shlex.split(study.command), "--solution", free)
    return shlex.join([*words, "--out", f"{os.path.relpath(folder)}-{free}"])


def kind(solution: str) -> str:
    """Key of FREE of a solution: its dimensions, and whether they are around an axis."""
    plugin = create(SOLUTIONS, solution)
    return "around" if axisymmetric(plugin) else {1: "line", 2: "plane"}.get(dimension(plugin), "space")


def has_walls(solution: str) -> bool:
    """Whether a solution has edges that hold the body."""
    given = getattr(create(SOLUTIONS, solution), "boundary", "free")
    return bool({"fixed", "roller"} & ({given} if isinstance(given, str) else set(given)))


def levels_to_blame(found: Finding) -> bool:
    """Whether time levels may be why a solver of somebody else has not the order that is expected."""
    verdict, solver = found.verdict, str(getattr(found.plan.run, "solver", ""))
    if not found.plan.judged or not solver or verdict.outcome is Outcome.PASS:
        return False
    named = hinted(found)
    if named and not named & set(own_solver.TIMES):
        return False
    low = verdict.observed is not None and 0 < verdict.observed < LOW
    return low or verdict.reason.code is ReasonCode.TIME_STEP_COUPLED


def courants(study: Study[Any], plan: QuantityPlan[Any]) -> tuple[float, ...]:
    """Courant numbers of the runs of a planned quantity, the largest first."""
    return tuple(sorted({run.courant for run in study.runs if head(run) == plan.head}, reverse=True))


def typed(study: Study[Any], plan: QuantityPlan[Any], wanted: Wanted) -> list[str]:
    """Words of the study's command, or of one of its case that has the series where another made the study."""
    words = shlex.split(study.command)
    if words[:2] == ["verify", study.case]:
        return [relative(word) for word in words]
    usual = {item.name: item.default for item in fields(plan.run)}
    words = ["verify", study.case]
    for name, value in plan.head:
        if value != usual[name] or name == "ppc":
            words += [f"--{name.replace('_', '-')}", relative(str(value))]
    return replaced(words, "--cells", ",".join(map(str, wanted.cells)))


def of_run(study: Study[Any], run: Any) -> str:
    """Command that runs this run; empty where none is known: of numbers that were given, and of particles elsewhere."""
    case = case_named(study.case)
    if run.given or not case.command or any(getattr(run, "offset", ())):
        return ""
    asked = {"method", "solution", *case.axes}
    words = ["verify", *case.command.format(run=run).split()]
    for item in fields(run):
        value = getattr(run, item.name)
        if f"{{run.{item.name}}}" not in case.command and (value != item.default or item.name in asked):
            words += [f"--{item.name.replace('_', '-')}", relative(typed_value(value))]
    return shlex.join(words)


def typed_value(value: Any) -> str:
    """Value of a field as it is typed."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


def replaced(words: Sequence[str], option: str, value: str) -> list[str]:
    """Words with the option at their end, and nowhere else."""
    kept: list[str] = []
    for before, word in zip(["", *words], words, strict=False):
        if option not in (before, word) and not word.startswith(f"{option}="):
            kept.append(word)
    return [*kept, option, value]


def relative(word: str) -> str:
    """Word of a command: a solution by its path as it is typed in this folder; any other word as it is."""
    option, equals, specification = word.partition("=") if word.startswith("--solution=") else ("", "", word)
    if not (is_file(specification) and os.path.isabs(specification)):
        return word
    path, parameters = split(specification)
    return option + equals + ":".join(filter(None, [os.path.relpath(path), parameters]))
