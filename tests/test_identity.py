"""A run is known by what derives it: an edit voids the runs that it can change, and no others."""

import ast
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from fixtures_tree import Tree, copied, forget

from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.identity import identity
from mpm_verify.cases.harness.runner import RunnerError, process_pool, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver import own_file, source_hash
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available
from mpm_verify.solver.source_hash import closure, parse

RUN = Run("cpdi", "axis_aligned", "neo_hookean", 8, 4, 0.4)
RUNS = {
    "cpdi": RUN,
    "gimp": replace(RUN, method="gimp"),
    "swirl": replace(RUN, solution="swirl"),
    "apic": replace(RUN, transfer="apic"),
    "graded": replace(RUN, layout="graded"),
    "column": ColumnRun(),
    "jaumann": ColumnRun(material="mohr_coulomb:rate=jaumann"),
    "fbar": ColumnRun(smoothing="fbar"),
}
MMS, COLUMN = {"cpdi", "gimp", "swirl", "apic", "graded"}, {"column", "jaumann", "fbar"}


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Tree]:
    yield Tree(copied(tmp_path), monkeypatch)
    monkeypatch.undo()
    forget()


def digests() -> dict[str, str]:
    return {name: run.digest for name, run in RUNS.items()}


def voided(before: dict[str, str]) -> set[str]:
    return {name for name, digest in digests().items() if digest != before[name]}


# ---- what the closure holds


def test_the_closure_holds_what_computes_and_no_more() -> None:
    for case in ("mms", "column"):
        held = {name.removeprefix("mpm_verify.") for name in closure(f"mpm_verify.cases.{case}.execute")}
        assert {
            f"cases.{case}.execute",
            "solver.step",
            "solver.transfer",
            "solver.transfers._passes",
            "solver._jit",
        } <= held
        assert not {name for name in held if name.startswith(("reports", "verify", "tests"))}
        other = {"mms": "column", "column": "mms"}[case]
        assert not {name for name in held if name.startswith(f"cases.{other}")}
        assert not {"cases.harness.store", "cases.harness.runner", "cases.judging.order", "cases.judging.fit"} & held
        for package in ("solver.basis", "solver.material", "solver.rates", "solver.smoothing", "mms.solutions"):
            assert not {name for name in held if name.startswith(f"{package}.")}, package


@pytest.mark.parametrize("name", available("mpm_verify.solver.basis"))
def test_a_basis_knows_neither_transfers_nor_cases(name: str) -> None:
    held = closure(f"{METHODS}.{name}")
    assert f"{METHODS}.{name}" in held
    assert "mpm_verify.solver.weights" in held
    assert not {n for n in held if "transfer" in n or ".cases." in n or ".mms." in n}


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("x = 1", "x = 1  # a comment"),
        ("def f(x):\n    return x", 'def f(x):\n    """A docstring."""\n\n    return x'),
        ("def f(x): return x", "def f(x: float) -> float: return x"),
        ('raise ValueError("one")', 'raise ValueError(f"{x} two")'),
        ("x = 1", '"""A docstring."""\nx = 1'),
        ("x = 1", "if TYPE_CHECKING:\n    from a import b\nx = 1"),
        ("x = (1,\n 2)", "x = (1, 2)"),
    ],
)
def test_the_same_tree(one: str, other: str) -> None:
    assert parse(one.encode()) == parse(other.encode())


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("x = 1", "x = 2"),
        ("x = 1", "x = 1.0"),
        ("x = 1", "x = -1"),
        ("x = None", "x = ..."),
        ("def f(x=1): pass", "def f(x=2): pass"),
        ("def f(x): return a + x", "def f(x): return x + a"),
        ("@a\ndef f(): pass", "def f(): pass"),
        ("class A:\n    x: int = 1", "class A:\n    x: ClassVar[int] = 1"),
        ("x = [1, [2]]", "x = [[1], 2]"),
        ('raise RunFailed("one")', 'raise RunFailed("two")'),
        ("from a import b", "from a import c"),
        ("if TYPE_CHECKING:\n    x = 1\nelse:\n    x = 2", "if TYPE_CHECKING:\n    x = 1\nelse:\n    x = 3"),
    ],
)
def test_another_tree(one: str, other: str) -> None:
    assert parse(one.encode()).digest != parse(other.encode()).digest


# ---- which runs an edit voids


def test_what_voids_nothing(tree: Tree) -> None:
    before = digests()
    tree.replace("solver/transfer.py", '"""', '"""Other words. ')
    tree.append("solver/step.py", "# a comment\n")
    tree.replace("solver/basis/cpdi.py", "def fill(", "# a comment\ndef fill(")
    tree.replace("solver/layout.py", "must lie between", "has to lie between")
    tree.replace("cases/mms/run.py", "Cells along a side of the domain.", "Cells.")
    tree.replace("solver/plugins.py", "choose from", "take one of")
    tree.replace("cases/mms/stability.py", "take a shorter duration or", "choose a shorter one or")
    tree.replace("solver/basis/cpdi.py", "Brannon & Burghardt 2011", "Brannon and Burghardt (2011)")
    tree.replace("solver/plugins.py", "or give a file", "or name a file")
    tree.append("reports/pages/mms.py")
    tree.append("verify/commands/mms.py")
    tree.append("cases/mms/case.py")
    tree.append("cases/column/case.py")
    tree.append("cases/harness/build.py")
    tree.append("cases/mms/expectations.py")
    tree.append("cases/judging/order.py")
    tree.append("cases/element/exam.py")
    tree.append("cases/another/execute.py", "def execute(run, tick):\n    return 1\n")
    tree.append("solver/basis/another.py", "x = 1\n")
    assert voided(before) == set()


@pytest.mark.parametrize(
    ("file", "runs"),
    [
        ("solver/transfer.py", MMS | COLUMN),
        ("solver/weights.py", MMS | COLUMN),
        ("solver/transfers/_passes.py", MMS | COLUMN),
        ("solver/basis/gimp.py", {"gimp"}),
        ("solver/basis/cpdi.py", MMS - {"gimp"} | COLUMN),
        ("solver/basis/mpm.py", set()),
        ("solver/transfers/apic.py", {"apic"}),
        ("solver/material/neo_hookean.py", MMS),
        ("solver/material/mohr_coulomb.py", COLUMN),
        ("solver/rates/green_naghdi.py", COLUMN - {"jaumann"}),
        ("solver/rates/jaumann.py", {"jaumann"}),
        ("solver/smoothing/fbar.py", {"fbar"}),
        ("mms/solutions/swirl.py", {"swirl"}),
        ("mms/grading.py", {"graded"}),
        ("mms/derive.py", MMS),
        ("cases/mms/execute.py", MMS),
        ("cases/column/execute.py", COLUMN),
    ],
)
def test_what_an_edit_voids(tree: Tree, file: str, runs: set[str]) -> None:
    before = digests()
    tree.append(file)
    assert voided(before) == runs


# ---- a user's file: what it returned

SOLUTION = """
import json, os, pathlib, time
import sympy as sp
{head}
def displacement(X, t):
    x, y = X
    {body}
    return sp.Matrix([1, 1]) * AMP * sp.sin(sp.pi * x) * sp.sin(sp.pi * y) * (1 - sp.cos(100 * sp.pi * t))
def domain():
    return {{"lower": (0, 0), "upper": (1, 1), "duration": 0.01, "speed": 100}}
"""
READ = 'json.loads((pathlib.Path(__file__).parent / "data.json").read_text())'
Write = Callable[..., str]


def afresh() -> None:
    """As a new process: no user's file was executed yet."""
    own_file._held.clear()


@pytest.fixture
def write(tmp_path: Path) -> Write:
    def text(head: str = "", body: str = "", folder: str = "one") -> str:
        (tmp_path / folder).mkdir(exist_ok=True)
        path = tmp_path / folder / "own.py"
        path.write_text(SOLUTION.format(head=head, body=body))
        return str(path)

    return text


@pytest.mark.parametrize(
    ("head", "body"),
    [
        ("from consts import AMP", ""),
        ("import consts", "AMP = consts.AMP"),
        ("", "from consts import AMP"),
        ("from inner.deep import AMP", ""),
        ("import sys; sys.path.insert(0, str(pathlib.Path(__file__).parent)); import consts", "AMP = consts.AMP"),
    ],
)
def test_a_helper_counts_and_is_read_again(write: Write, head: str, body: str) -> None:
    path = write(head, body)
    folder, run = Path(path).parent, replace(RUN, solution=path)
    (folder / "inner").mkdir()
    (folder / "inner" / "__init__.py").write_text("")
    (folder / "inner" / "deep.py").write_text("from consts import AMP\n")
    seen = {}
    for amplitude in (0.05, 0.01, 0.05):  # in one process, and files of one length within one second
        (folder / "consts.py").write_text(f"AMP = {amplitude}\n")
        seen.setdefault(amplitude, set()).add(run.digest)
    assert {len(digests) for digests in seen.values()} == {1}
    assert seen[0.05] != seen[0.01]
    assert not list(folder.rglob("__pycache__"))


def test_two_files_do_not_share_their_helpers(write: Write) -> None:
    paths = [write("from consts import AMP", folder=folder) for folder in ("one", "other")]
    for path, amplitude in zip(paths, (0.05, 0.01), strict=True):
        (Path(path).parent / "consts.py").write_text(f"AMP = {amplitude}\n")
    one, other = (identity(SOLUTIONS, path) for path in paths)
    assert one != other
    (Path(paths[1]).parent / "consts.py").write_text("AMP = 0.05  # and a comment\n")
    assert identity(SOLUTIONS, paths[1]) == one
    assert "consts" not in sys.modules


@pytest.mark.parametrize(("head", "body"), [(f"AMP = {READ}", ""), ("", f"AMP = {READ}")])
def test_data_that_are_read_count(write: Write, head: str, body: str) -> None:
    path, found = write(head, body), []
    for amplitude in (0.05, 0.01, 0.05):
        (Path(path).parent / "data.json").write_text(json.dumps(amplitude))
        afresh()
        found.append(identity(SOLUTIONS, path))
    assert found[0] == found[2] != found[1]


def test_the_environment_counts(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    path, found = write('AMP = float(os.environ["AMP"])'), []
    for amplitude in ("0.05", "0.01", "0.05"):
        monkeypatch.setenv("AMP", amplitude)
        afresh()
        found.append(identity(SOLUTIONS, path))
    assert found[0] == found[2] != found[1]


def test_other_processes_derive_the_same(write: Write) -> None:
    """Whatever the order of hashes."""
    path = write("AMP = sp.Rational(1, 20)", "x = x + 0*y; AMP_ = [sp.exp(x * y * t), sp.sqrt(x + y)]")
    code = f"from mpm_verify.cases.mms.run import Run; print(Run('cpdi', {path!r}, 'neo_hookean', 8, 4, 0.4).digest)"
    for seed in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": seed}
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
        assert done.stdout.strip() == replace(RUN, solution=path).digest


CLASS = '''
from dataclasses import dataclass
from mpm_verify.solver.elastic import Elastic
import helper
@dataclass(frozen=True)
class Own(Elastic):
    """{words}"""
    def energy(self, F, log):
        return helper.FACTOR * (F[0][0] ** 2 + F[1][1] ** 2 - log(F[0][0])) {more}
    def update(self, particles, dt):
        pass
'''


@pytest.mark.parametrize("helper", ["FACTOR = {0}", "import os; FACTOR = float(os.environ['FACTOR'])"])
def test_a_material_counts_with_its_helpers_and_data(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, helper: str
) -> None:
    path, found = tmp_path / "own.py", []
    for factor, words, more in (
        (2.0, "a", ""),
        (3.0, "a", ""),
        (2.0, "other words", "  # and more"),
        (2.0, "a", "* 2"),
    ):
        monkeypatch.setenv("FACTOR", str(factor))
        (tmp_path / "helper.py").write_text(helper.format(factor))
        path.write_text(CLASS.format(words=words, more=more))
        afresh()
        found.append(identity(MATERIALS, str(path)))
    assert found[0] == found[2]
    assert len(set(found)) == 3
    assert identity(MATERIALS, f"{path}:E=2") == found[3]  # parameters stand in the run


# ---- in worker processes


def study_of(solution: str, folder: Path) -> tuple[Store, Callable[[], dict[str, Any]]]:
    study = build(Asked("mms", {"solution": [solution], "cells": [8], "ppc": [4]}), "verify mms", "mms")
    store = Store(folder)
    store.create(study)

    def run() -> dict[str, Any]:
        with process_pool(1, "mms") as (pool, _):
            return run_study(study, store, pool, 1)

    return store, run


def test_a_worker_derives_the_same(write: Write, tmp_path: Path) -> None:
    path = write("from consts import AMP")
    (Path(path).parent / "consts.py").write_text("AMP = 0.02\n")
    _, run = study_of(path, tmp_path / "study")
    results = run()
    assert set(results) == {replace(RUN, solution=path, courant=courant).digest for courant in (0.4, 0.2)}
    assert all(result.status == "finished" and result.digest == digest for digest, result in results.items())


@pytest.mark.parametrize(
    ("head", "body"), [("AMP = 0.02 + 1e-12 * time.time()", ""), ("", "AMP = 1e-12 * time.time()")]
)
def test_a_worker_refuses_another_problem(write: Write, tmp_path: Path, head: str, body: str) -> None:
    store, run = study_of(write(head, body), tmp_path / "study")
    with pytest.raises(RunnerError, match=r"^what computes cpdi 8² cells, 4 per cell is not what it was when") as told:
        run()
    assert "\n" not in str(told.value)
    assert not list(store.runs.iterdir())


def test_the_closure_is_found_in_the_text_as_python_imports_it() -> None:
    """Every module of ours that a statement of execute.py names is in the closure, the type checker's left out."""
    import mpm_verify.cases.mms.execute as case

    named = set()
    for node in ast.parse(Path(str(case.__file__)).read_text()).body:
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("mpm_verify"):
            named.add(str(node.module))
    assert len(named) > 10
    assert named <= closure("mpm_verify.cases.mms.execute").keys()


# ---- what a user's file finds elsewhere


def library(folder: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> Path:
    """A module `their_library` in a folder of its own, on Python's path and away from the user's file."""
    folder.mkdir(parents=True, exist_ok=True)
    monkeypatch.syspath_prepend(str(folder))
    (folder / "their_library.py").write_text(text)
    return folder / "their_library.py"


ELSEWHERE = ["import their_library", "from their_library import f", "def late():\n    from their_library import f\n"]


@pytest.mark.parametrize("head", ELSEWHERE)
def test_a_library_elsewhere_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, head: str) -> None:
    file, other = tmp_path / "mine" / "mine.py", library(tmp_path / "there", monkeypatch, "f = 1.0\n")
    file.parent.mkdir()
    file.write_text(head)
    before = source_hash.file_hash(file)
    other.write_text("# a comment\nf = 1.0\n")
    assert source_hash.file_hash(file) == before
    other.write_text("f = 1.05\n")
    assert source_hash.file_hash(file) != before


def test_what_a_library_elsewhere_imports_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A module beside it, and one of a package that it belongs to."""
    file, other = tmp_path / "mine" / "mine.py", library(tmp_path / "there", monkeypatch, "import their_helper\n")
    file.parent.mkdir()
    file.write_text("import their_library\n")
    (other.parent / "their_helper.py").write_text("g = 1.0\n")
    before = source_hash.file_hash(file)
    (other.parent / "their_helper.py").write_text("g = 2.0\n")
    assert source_hash.file_hash(file) != before


def test_an_installed_package_counts_by_its_version(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file, other = tmp_path / "mine.py", library(tmp_path / "site-packages", monkeypatch, "f = 1.0\n")
    file.write_text("import their_library\n")
    monkeypatch.setattr(source_hash, "version", lambda name: "1.0")
    before = source_hash.file_hash(file)
    other.write_text("f = 2.0\n")
    assert source_hash.file_hash(file) == before
    monkeypatch.setattr(source_hash, "version", lambda name: "1.1")
    assert source_hash.file_hash(file) != before


def test_python_and_our_libraries_are_not_read(tmp_path: Path) -> None:
    file = tmp_path / "mine.py"
    file.write_text("import os, numpy, sympy, scipy.optimize, nowhere_to_be_found\n")
    assert set(source_hash.closure("mine", tmp_path)) == {"mine"}


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("symbols('X Y')", "symbols('X Z')"), ("symbols('bx by')", "symbols('by bx')"), ("'at_least'", "'at_most'"),
        ("f'{a} = {b}'", "f'{a} == {b}'"), ("'if x:\\n the'", "'if y:\\n the'"),
    ],
)  # fmt: skip
def test_a_text_that_computes_is_no_sentence(one: str, other: str) -> None:
    assert source_hash.parse(f"x = {one}".encode()) != source_hash.parse(f"x = {other}".encode())


@pytest.mark.parametrize("text", ["'Cells of the grid'", "f'{a} is above {b}'", "'Brannon & Guilkey 2013'"])
def test_a_sentence_does_not_count(text: str) -> None:
    assert source_hash.parse(f"x = {text}".encode()) == source_hash.parse(b"x = 'the other one'")
