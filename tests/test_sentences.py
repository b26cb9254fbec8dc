"""Words decide nothing: outcomes, exit codes and digests are the same whatever the sentences say. Every code has one.

Each ReasonCode is reached by a study of synthetic Results, each FailureKind ends a run of one.
"""

import ast
import inspect
import math
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import fixtures_study as fixtures
import numpy as np
import pytest

from mpm_verify.cases.harness.analysis import Analysis
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import QuantityPlan, Study
from mpm_verify.cases.harness.verdicts import Finding, findings
from mpm_verify.cases.judging.order import Expectation, Level, Quantity, judge
from mpm_verify.cases.judging.records import Action, Outcome, ReasonCode, Recorded, Wanted
from mpm_verify.cases.judging.stall import CauseCode, Measured, explain
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result, Run
from mpm_verify.reports.export.document import verdict as verdict_row
from mpm_verify.reports.export.junit import write_junit
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, failures, stalls, verdicts
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.source_hash import TOP, closure

SENTENCES = (failures, verdicts, stalls, commands)
SECOND = Expectation(2.0)
DIVERGES = Expectation(None)
STALL = Expectation(None, stall=1.5)
CELLS = (8, 16, 32, 64, 128)
H = 1 / np.array(CELLS)
GIMP = (5.109e-3, 1.881e-3, 8.807e-4, 5.360e-4)
INVERTED = Failure(FailureKind.INVERTED, 21, 35, (2, 2))
LEVEL_KINDS = {FailureKind.NOT_RUN, FailureKind.NO_ERROR, FailureKind.ERROR_NOT_FINITE}  # of no stored run, or by norms


@dataclass(frozen=True)
class Example:
    """Errors of u from 8 cells on, then runs that failed; None is a run that nobody did. `halved`: times the finest."""

    errors: tuple[float, ...]
    expectation: Expectation = SECOND
    failed: tuple[Failure | None, ...] = ()
    halved: float | None = 1.01
    floor: float = 1e-15
    still: bool = False


def clean(order: float = 2.0, count: int = 5) -> tuple[float, ...]:
    """Errors h^order."""
    return tuple((H[:count] ** order).tolist())


def known(h: float, factor: float) -> Expectation:
    """Order 2 with a recorded error, that factor times h squared."""
    return Expectation(2.0, recorded=(Recorded(h, factor * h**2, factor * h**2),))


EXAMPLES = {
    ReasonCode.AS_EXPECTED: Example(clean()),
    ReasonCode.ALL_FAILED: Example((), Expectation(None, failed=FailureKind.INVERTED), (INVERTED,) * 4),
    ReasonCode.DIVERGES: Example((1e-3, 2e-3, 4e-3, 8e-3), DIVERGES, (INVERTED,)),
    ReasonCode.STALLS: Example(GIMP, STALL),
    ReasonCode.ORDER_BELOW: Example(clean(1.5)),
    ReasonCode.CONTAMINATED: Example(tuple((H**2 + 0.08 * H).tolist()), Expectation(2.0, 1.9, 0.3)),
    ReasonCode.MAGNITUDE: Example(clean(), known(1 / 128, 2)),
    ReasonCode.FAR_OFF: Example(clean(), known(1 / 256, 0.4)),
    ReasonCode.NOTHING_MOVES: Example(clean(), still=True),
    ReasonCode.RUN_ENDED: Example(clean(count=4), SECOND, (INVERTED,)),
    ReasonCode.FALLS_SHORT: Example((4.8e-3, 6.7e-3, 1.4e-2, 2.6e-2)),
    ReasonCode.CONVERGES: Example(clean(), DIVERGES),
    ReasonCode.NOTHING_FINISHED: Example((), SECOND, (None,) * 4),
    ReasonCode.TOO_FEW_LEVELS: Example(clean(count=3)),
    ReasonCode.LEVEL_MISSING: Example(clean(count=4), SECOND, (None,)),
    ReasonCode.NEAR_ROUND_OFF: Example(clean(), floor=1e-5),
    ReasonCode.TIME_STEP_UNKNOWN: Example(clean(), halved=None),
    ReasonCode.TIME_STEP_COUPLED: Example(clean(), halved=1.2),
    ReasonCode.ERROR_RISES: Example((*clean(count=4), 1.1 / 64**2)),
    ReasonCode.NOT_SETTLED: Example(tuple(np.exp2(-np.cumsum([6, 2.0, 2.4, 1.8, 2.3])).tolist())),
    ReasonCode.ORDER_ABOVE: Example(clean(2.4)),
    ReasonCode.ORDER_UNDECIDED: Example((2.590e-3, 7.000e-4, 2.050e-4, 5.700e-5)),
    ReasonCode.CONTAMINATION_OPEN: Example(clean(1.9)),
    ReasonCode.ADDS_IN_SQUARE: Example(tuple(np.hypot(0.98**0.5 * H**2, 0.02**0.5 * H[-1] * H).tolist())),
    ReasonCode.MAGNITUDE_CARRIED: Example(clean(), known(1 / 256, 2)),
    ReasonCode.NEITHER: Example((1e-3, 1.1e-3, 0.9e-3, 1e-3), DIVERGES),
}


def ends_of(kind: FailureKind) -> Iterator[Example]:
    """Studies whose finest run, or whose every run, ends with that kind of failure; of NOT_RUN, that is not done."""
    end = None if kind is FailureKind.NOT_RUN else Failure(kind, 7, 3, (1, 2))
    for expectation in (SECOND, DIVERGES, STALL, Expectation(None, failed=kind)):
        yield Example(clean(count=4), expectation, (end,))
        yield Example((), expectation, (end,) * 4)


def made(example: Example) -> tuple[Study[Run], dict[str, Result]]:
    """The study of an example with its Results."""
    count = len(example.errors) + len(example.failed)
    runs = [Run("cpdi", "axis_aligned", "neo_hookean", cells, 4, 0.4) for cells in CELLS[:count]]
    half = replace(runs[-1], courant=0.2)
    results = [result(run, e, example.floor) for run, e in zip(runs, example.errors, strict=False)]
    if example.halved and example.errors:
        results.append(result(half, example.halved * example.errors[-1], example.floor))
    for run, end in zip(runs[len(example.errors) :], example.failed, strict=True):
        if end:
            ended = result(run, 0.0, 0.0)
            results.append(replace(ended, status="failed", errors={}, failure=end))
    results = [replace(one, values={"still": 0.0} if example.still else {}) for one in results]
    plan = QuantityPlan(runs[0], "u", "rms", True, example.expectation)
    study = Study("made", "made", "verify mms --ppc 4", (*runs, half), (plan,), case="mms")
    return study, {one.digest: one for one in results}


def result(run: Run, error: float, floor: float) -> Result:
    """A finished run with that error in everything."""
    errors = {quantity: dict.fromkeys(NORMS, error) for quantity in QUANTITIES}
    return Result(
        run=run, digest=run.digest, status="finished", errors=errors, floor=dict.fromkeys(QUANTITIES, floor),
        steps=10, particles=4 * run.cells**2, crossings=8 * run.cells**2, gap=0.1,
    )  # fmt: skip


@pytest.fixture(autouse=True)
def sources() -> Iterator[None]:
    """Digests without the sources: a second less a test."""
    with fixtures.sources():
        yield


def judged(example: Example) -> Finding:
    """What the rule says."""
    (found,) = findings(*made(example))
    return found


# ---- every code is reached, and has a sentence


@pytest.mark.parametrize("code", ReasonCode)
def test_each_reason_is_reached_and_said(code: ReasonCode) -> None:
    study, results = made(EXAMPLES[code])
    (found,) = findings(study, results)
    assert found.verdict.reason.code is code
    said = commands.reason(study, found)
    assert len(said) > 20
    assert said != code
    assert "None" not in said
    assert said.count("% interval") <= 1  # one confidence
    assert (found.verdict.reason.wanted is not None) == (found.verdict.outcome is Outcome.INCONCLUSIVE)


def test_no_two_reasons_sound_alike() -> None:
    said = [verdicts.said(judged(example).verdict.reason) for example in EXAMPLES.values()]
    assert len(set(said)) == len(ReasonCode) == len(verdicts.SAID)


@pytest.mark.parametrize("kind", FailureKind)
def test_each_failure_is_said(kind: FailureKind) -> None:
    said = failures.failure(Failure(kind, 7, 3, (1, 2)))
    assert said.startswith(failures.kind(kind))
    assert said.endswith(" at step 7, particle 3 in cell (1, 2)")
    assert kind not in said.split()
    assert failures.failure(Failure(kind, step=-1)) == said.removesuffix(" at step 7, particle 3 in cell (1, 2)")


def test_no_two_failures_sound_alike() -> None:
    assert len({failures.kind(kind) for kind in FailureKind}) == len(FailureKind) == len(failures.CAUSES)


@pytest.mark.parametrize(
    ("kind", "numbers", "said"),
    [
        (FailureKind.UNSTABLE_STEP, {"dt": 0.5, "limit": 0.2}, "dt = 0.5 is above the stability limit 0.2"),
        (FailureKind.DOMAIN_TOO_WIDE, {"width": 2.1, "limit": 2.0}, "the particle's domain is wider than two cells"),
        (FailureKind.DOMAIN_TOO_WIDE, {"width": 1.1, "limit": 1.0}, "the particle's domain is wider than a cell"),
        (FailureKind.TIME_LIMIT, {"seconds": 60.0}, "the solver took longer than 60 s"),
    ],
)
def test_a_failure_says_its_numbers(kind: FailureKind, numbers: dict[str, float], said: str) -> None:
    assert failures.cause(Failure(kind, numbers=numbers)) == said


def stalled() -> Any:
    """A stall in which every cause but a failed run has numbers."""
    errors = (6.4e-3, 1.6e-3, 6e-4, 4e-4)
    found = explain(
        Measured(
            (8, 16, 32, 64),
            errors,
            (2.0, 4.0, 8.0, 16.0),
            (0.2,) * 4,
            4,
            1e-14,
            4e-4,
            (9, (5e-4, 3e-4)),
            damping=0.1,
            stiffness=5e3,
            strays=True,
            edge_noise=True,
            strain=0.05,
            size=0.1,
        )
    )
    assert found is not None
    return found


@pytest.mark.parametrize("code", CauseCode)
def test_each_cause_is_said(code: CauseCode) -> None:
    if code is CauseCode.FAILED_RUN:
        assert stalls.NAMES[code] == "a failed run"
        return
    (cause,) = [cause for cause in stalled().causes if cause.code is code]
    assert cause.numbers
    assert stalls.measured(cause) in " ".join(stalls.why(stalled()))
    if code is not CauseCode.CROSSINGS:  # they are always measured
        assert len(stalls.measured(replace(cause, numbers={}))) > 10
    assert len({*stalls.NAMES.values()}) == len(CauseCode)


# ---- words decide nothing


def silenced(monkeypatch: pytest.MonkeyPatch, modules: Sequence[ModuleType] = SENTENCES) -> int:
    """Replace every function that makes a sentence by one that says x; how many there are."""
    count = 0
    for module in modules:
        for name, function in inspect.getmembers(module, inspect.isfunction):
            if function.__module__ != module.__name__:
                continue
            said = "x" if function.__annotations__["return"] is str else ["x"]
            if function.__annotations__["return"] in (str, list[str]):
                monkeypatch.setattr(module, name, lambda *a, said=said, **k: said)
                count += 1
    return count


def decided(example: Example) -> tuple[Any, ...]:
    """All that must not depend on words: verdict, exit code, names of the Results, and what a CI job reads as codes."""
    study, results = made(example)
    (found,) = findings(study, results)
    return found.verdict, Analysis((found,)).exit_code, tuple(run.digest for run in study.runs), found.stall


EVERY = [*EXAMPLES.values(), *(one for kind in FailureKind if kind not in LEVEL_KINDS for one in ends_of(kind))]
EVERY += list(ends_of(FailureKind.NOT_RUN))


def test_words_decide_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    before = [decided(example) for example in EVERY]
    assert silenced(monkeypatch) > 30
    assert verdicts.said(before[0][0].reason) == failures.failure(INVERTED) == stalls.where(stalled()) == "x"
    assert [decided(example) for example in EVERY] == before
    assert {code for _, code, *_ in before} == {0, 1, 3, 4}


@pytest.mark.parametrize(("kind", "other"), [(k, o) for k, o in product(FailureKind, repeat=2) if k is not o][::7])
def test_kinds_decide(kind: FailureKind, other: FailureKind) -> None:
    """The check above can fail: where one kind is registered, another one is no PASS."""
    expectation = Expectation(None, failed=kind)
    for end, outcome in ((kind, Outcome.PASS), (other, Outcome.ERROR)):
        levels = [Level(float(h), (), Failure(end)) for h in H]
        assert judge(levels, expectation, floor=0.0, dt_halved=None).outcome is outcome


@pytest.mark.parametrize("kind", FailureKind)
def test_only_inverted_particles_on_a_finer_grid_are_divergence(kind: FailureKind) -> None:
    levels = [Level(1 / 8, (1e-3,)), Level(1 / 16, (), Failure(kind))]
    outcome = judge(levels, DIVERGES, floor=0.0, dt_halved=None).outcome
    assert outcome is (Outcome.PASS if kind is FailureKind.INVERTED else Outcome.INCONCLUSIVE)


def test_documents_keep_their_codes(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """JSON and JUnit with other words: the same codes and numbers, and the words in their own fields alone."""

    def written(example: Example) -> tuple[dict[str, Any], str]:
        study, results = made(example)
        record = Record(Store(tmp_path, "mms"), study, results, earlier=False)
        write_junit(tmp_path / "out.xml", record)
        row = verdict_row(record, record.findings[0])
        case = ElementTree.parse(tmp_path / "out.xml").getroot()[0]
        assert [child.get("message") for child in case if child.tag != "system-out"] in ([], [row.pop("reason")])
        if row["wanted"]:
            row["wanted"].pop("command")
        row.pop("stall")
        row.pop("reason", None)
        return row, ElementTree.tostring(case[0] if case[0].tag != "system-out" else case, "unicode")[:20]

    before = [written(example) for example in EXAMPLES.values()]
    assert [row["code"] for row, _ in before] == list(EXAMPLES)
    silenced(monkeypatch)
    assert [written(example) for example in EXAMPLES.values()] == before


# ---- what to type


@pytest.mark.parametrize(
    ("code", "option"),
    [
        (ReasonCode.TOO_FEW_LEVELS, "--cells 8,16,32,64"),
        (ReasonCode.NEAR_ROUND_OFF, "--cells 4,8,16,32,64"),
        (ReasonCode.TIME_STEP_UNKNOWN, "--courant 0.4,0.2"),
        (ReasonCode.TIME_STEP_COUPLED, "--courant 0.2"),
        (ReasonCode.MAGNITUDE_CARRIED, "--cells 8,16,32,64,128,256"),
    ],
)
def test_advice_is_an_option_and_a_whole_command(code: ReasonCode, option: str) -> None:
    study, results = made(EXAMPLES[code])
    (found,) = findings(study, results)
    assert commands.reason(study, found).endswith(f": run with {option}")
    assert commands.command(study, found) == f"verify mms --ppc 4 {option}"
    typed = replace(study, command="verify mms --cells=8,16 --courant 0.4 --ppc 4")
    words = shlex.split(commands.command(typed, found))
    assert " ".join(words[-2:]) == option
    assert sum(word.startswith(option.split()[0]) for word in words) == 1


def test_a_run_that_has_to_finish() -> None:
    """One that nobody did is done by the same command; one that failed, by none."""
    study, results = made(EXAMPLES[ReasonCode.LEVEL_MISSING])
    (found,) = findings(study, results)
    assert commands.command(study, found) == study.command
    study, results = made(Example(clean(count=4), SECOND, (Failure(FailureKind.EMPTY_CELL, 7, 3, (1, 2)),)))
    (found,) = findings(study, results)
    assert found.verdict.reason.wanted == Wanted(Action.FINISH, 1 / 128, CELLS)
    assert commands.command(study, found) == ""


def test_where_everything_is_as_expected_there_is_nothing_to_type() -> None:
    study, results = made(EXAMPLES[ReasonCode.AS_EXPECTED])
    assert commands.command(study, findings(study, results)[0]) == ""


@pytest.mark.parametrize(
    ("cells", "multiple", "asked"),
    [
        ((12, 16, 24), 1, 36),  # 24^2 / 16
        ((12, 16, 24, 32), 1, 43),  # 32^2 / 24 = 42.7
        ((12, 16, 24, 32), 4, 44),
        ((6, 9, 12), 3, 15),  # 16 is none
        ((5, 10, 15), 5, 25),  # 22.5
        ((10, 11, 12), 1, 13),
        ((64, 128, 224), 64, 384),  # 392
        ((30, 60, 61), 30, 90),  # of 62.0 the nearest multiple is not finer
        ((8,), 1, 16),
    ],
)
def test_the_cells_that_are_asked_for_are_finer_and_fill_the_body(
    cells: tuple[int, ...], multiple: int, asked: int
) -> None:
    levels = [Level(1 / n, (1 / n**2,)) for n in cells]
    wanted = Quantity(levels, SECOND, 0.0, None, multiple).finer
    assert wanted == Wanted(Action.ADD_LEVEL, 1 / asked, (*cells, asked))
    assert asked % multiple == 0


def test_cell_sizes_that_are_no_cells_are_asked_for_as_such() -> None:
    levels = [Level(h, (h**2,)) for h in (3.0, 2.0, 1.5)]
    got = judge(levels, SECOND, floor=0.0, dt_halved=None)
    assert got.reason.wanted == Wanted(Action.ADD_LEVEL, 1.125)
    assert verdicts.reason(got.reason, (0.4,)).endswith(": run h=1.125")


def test_a_solution_by_its_path_is_typed_as_in_this_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    study, results = made(EXAMPLES[ReasonCode.TOO_FEW_LEVELS])
    (found,) = findings(study, results)
    own = f"{tmp_path}/below/own.py:A=0.1"
    for words in (["--solution", own], [f"--solution={own}"]):
        study = replace(study, command=shlex.join(["verify", "mms", *words]))
        assert commands.command(study, found) == (
            f"verify mms {' '.join(words).replace(f'{tmp_path}/', '')} --cells 8,16,32,64"
        )


def test_a_study_of_another_command_is_asked_for_as_one_of_verify_mms() -> None:
    study, results = made(EXAMPLES[ReasonCode.TIME_STEP_COUPLED])
    study = replace(study, command="verify methods --quick")
    (found,) = findings(study, results)
    words = shlex.split(commands.command(study, found))
    assert words[:2] == ["verify", "mms"]
    assert words[-2:] == ["--courant", "0.2"]
    assert words[words.index("--cells") + 1] == "8,16,32,64,128"
    assert words[words.index("--ppc") + 1] == "4"


# ---- the numeric layer compares no sentences

WORDY = {"reason", "reasons", "text", "why", "where", "message", "sentence", "said", "failed", "failure", "ended"}
MEANT = {"domain limit", "NUMBER OF ATOMS"}  # a parameter of stored columns, and of a LAMMPS dump


def name_of(node: ast.expr) -> str:
    """The last word of `level.failed` or `failed`; nothing of another expression."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def compared(source: str) -> list[str]:
    """Comparisons with a sentence: a string with a space, or a string sought in what a sentence would be kept in."""
    return [ast.unparse(node) for node in ast.walk(ast.parse(source)) if is_sentence(node)]


def is_sentence(node: ast.AST) -> bool:
    """Whether this compares with a sentence."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
        return node.func.attr in ("startswith", "endswith", "find") and name_of(node.func.value) in WORDY
    if not isinstance(node, ast.Compare):
        return False
    sides = [node.left, *node.comparators]
    texts = {s.value for s in sides if isinstance(s, ast.Constant) and isinstance(s.value, str)} - MEANT
    words = {name_of(side) for side in sides} & WORDY or any(
        isinstance(side, ast.Call) and name_of(side.func) == "str" for side in sides
    )
    sought = any(isinstance(op, ast.In | ast.NotIn) for op in node.ops)
    phrases = any(" " in text.strip() for text in texts)
    return phrases or (bool(words) and sought and any(text.isalnum() or len(text) > 3 for text in texts))


@pytest.mark.parametrize("floor", ["solver", "mms", "cases"])
def test_no_sentence_is_compared(floor: str) -> None:
    found = {str(file.relative_to(TOP)): compared(file.read_text()) for file in (TOP / floor).rglob("*.py")}
    assert {file: lines for file, lines in found.items() if lines} == {}


@pytest.mark.parametrize(
    "line",
    [
        'lost = "det F" in level.failed',
        'NOT_RUN = "not run yet" == why',
        'x = "coupled" not in verdict.reason',
        'x = "det" in str(failure)',
        'x = level.failed.startswith("det")',
        'x = text == "the run ended"',
    ],
)
def test_a_compared_sentence_is_seen(line: str) -> None:
    assert compared(line)


@pytest.mark.parametrize("line", ['x = "limit" in run.method', 'x = way == "at_most"', 'x = kind == "fixed"', "a < b"])
def test_what_is_no_sentence_may_be_compared(line: str) -> None:
    assert not compared(line)


def test_the_numeric_layer_imports_no_sentences() -> None:
    for floor in ("solver", "mms", "cases"):
        for file in (TOP / floor).rglob("*.py"):
            assert "reports.sentences" not in file.read_text(), file


def test_names_of_results_hash_no_words() -> None:
    """The closure of what computes a run has what makes its failures, and nothing that says them."""
    modules = closure("mpm_verify.cases.mms.execute")
    assert any("solver.failure" in name for name in modules)
    assert not [name for name in modules if "reports" in name]


def test_numbers_are_finite() -> None:
    """What goes into a JSON document."""
    for example in EVERY:
        numbers = judged(example).verdict.reason.numbers.values()
        flat = [n for value in numbers for n in (value if isinstance(value, tuple) else (value,))]
        assert all(math.isfinite(n) for n in flat)
