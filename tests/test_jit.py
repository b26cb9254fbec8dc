"""Compilation: one door to Numba, a cache that is never stale and that a second process hits, strict arithmetic."""

import ast
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from fixtures_tree import FLOORS, Tree, copied, forget

from mpm_verify.solver import _jit, cache_folder
from mpm_verify.solver.plugins import available
from mpm_verify.solver.source_hash import TOP

FILES = sorted(file for floor in FLOORS for file in (TOP / floor).rglob("*.py"))
COMPILERS = {"njit", "jit", "vectorize", "guvectorize", "cfunc", "stencil", "jitclass", "overload"}
KERNELS = [file for file in FILES if "import" in file.read_text() and "@kernel" in file.read_text()]


def compilers(source: str) -> list[str]:
    """What a source takes from Numba that compiles."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] == "numba":
            found += [alias.name for alias in node.names if alias.name in COMPILERS]
        elif isinstance(node, ast.Attribute) and node.attr in COMPILERS:
            found.append(ast.unparse(node))
    return found


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(TOP).as_posix())
def test_one_door_to_numba(file: Path) -> None:
    found = compilers(file.read_text())
    if (
        file == TOP / "cases/detect/server.py" or file == TOP / "solver/_jit.py"
    ):  # gives its children a numba.njit of one thread, and compiles nothing
        assert set(found) == {"numba.njit"}
    else:
        assert not found, f"{file.relative_to(TOP)} compiles by {found}: use solver._jit.kernel"


@pytest.mark.parametrize(
    "source",
    ["from numba import njit", "import numba\n@numba.jit\ndef f(): ...", "from numba.extending import overload"],
)
def test_a_second_door_is_seen(source: str) -> None:
    assert compilers(source)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(TOP).as_posix())
def test_no_fastmath(file: Path) -> None:
    for node in ast.walk(ast.parse(file.read_text())):
        assert not (isinstance(node, ast.keyword) and node.arg == "fastmath"), file.relative_to(TOP)


def dispatchers() -> Iterator[tuple[str, Any]]:
    """Every compiled function of the solver, the norms and a manufactured solution, by name."""
    from importlib import import_module

    from numba.core.dispatcher import Dispatcher

    for file in KERNELS:
        import_module(".".join(("mpm_verify", *file.relative_to(TOP).with_suffix("").parts)))
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == "mpm_verify" or name.startswith("exact_"):
            for key, value in vars(module).items():
                if isinstance(value, Dispatcher) and value.py_func.__module__ == name:
                    yield f"{name}.{key}", value


def inlined(dispatcher: Any) -> bool:
    """A helper of other kernels: compiled into them, never by itself."""
    return bool(dispatcher.targetoptions.get("inline", "never") == "always")


def test_options_of_every_kernel() -> None:
    from mpm_verify.mms.manufacture import manufacture
    from mpm_verify.solver.plugins import create

    assert manufacture(
        create("mpm_verify.mms.solutions", "axis_aligned"), create("mpm_verify.solver.material", "neo_hookean"), 1.0
    ).kernel
    seen = dict(dispatchers())
    assert {
        "mpm_verify.solver.transfer.p2g",
        "mpm_verify.solver.basis.cpdi.fill",
        "mpm_verify.cases.mms.norms.compare",
    } <= set(seen)
    assert any(name.startswith("exact_") for name in seen)
    for name, dispatcher in seen.items():
        options = dispatcher.targetoptions
        assert not options.get("fastmath"), name
        assert options["error_model"] == "numpy", name
        if not inlined(dispatcher):  # one explicit signature, compiled at import
            assert len(dispatcher.signatures) == 1, name
            assert not dispatcher._can_compile, name


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Tree]:
    """A copy of the sources that the names of the cache's folders are taken from, and a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    cache_folder.base.cache_clear()
    yield Tree(copied(tmp_path), monkeypatch)
    monkeypatch.undo()
    cache_folder.base.cache_clear()
    forget()


def folders() -> dict[str, str]:
    """Names of the folders of all kernel files."""
    names = (".".join(("mpm_verify", *file.relative_to(TOP).with_suffix("").parts)) for file in KERNELS)
    return {name: _jit._ours.__wrapped__(name).name for name in names}


def moved(before: dict[str, str]) -> set[str]:
    return {name.removeprefix("mpm_verify.") for name, folder in folders().items() if folder != before[name]}


def test_the_cache_follows_what_a_kernel_is_made_from(tree: Tree) -> None:
    before = folders()
    assert len(set(before.values())) == len(KERNELS) > 20
    tree.replace("solver/weights.py", "def bilinear(", "# a comment\n\n\ndef bilinear(")
    tree.replace("solver/transfer.py", '"""', '"""Other words. ')
    tree.append("solver/material/another.py")
    assert moved(before) == set()
    tree.append("solver/basis/mpm.py")
    assert moved(before) == {"solver.basis.mpm", "solver.basis.tlmpm"}
    tree.append("solver/basis/cpdi.py")
    assert moved(before) == {"solver.basis.mpm", "solver.basis.tlmpm", "solver.basis.cpdi"}
    tree.append("solver/basis/_parallelogram.py")
    cpdi = {"solver.basis.cpdi", "solver.basis._cpdi_limited", "solver.basis._parallelogram"}
    assert moved(before) == {"solver.basis.mpm", "solver.basis.tlmpm"} | cpdi
    tree.append("solver/frames.py")
    assert "solver.rates.jaumann" in moved(before)
    assert "solver.transfer" not in moved(before)
    tree.append("solver/weights.py")
    assert {"solver.transfer", "solver.basis.gimp"} <= moved(before)
    assert "solver.material.neo_hookean" not in moved(before)
    tree.append("solver/_jit.py")
    assert moved(before) == {name.removeprefix("mpm_verify.") for name in before}


def test_the_cache_follows_numba(tree: Tree, monkeypatch: pytest.MonkeyPatch) -> None:
    before = folders()
    monkeypatch.setattr(_jit.llvmlite, "__version__", "another")
    assert not set(before.values()) & set(folders().values())


COUNT = """
import json, sys
sys.path.insert(0, sys.argv[1])
from test_jit import count
print(json.dumps(count()))
"""


def count() -> dict[str, tuple[int, int]]:
    """Cache hits and misses of every kernel, after a step of each basis with a manufactured body force."""
    from mpm_verify.cases.mms.execute import setup
    from mpm_verify.cases.mms.run import Run
    from mpm_verify.solver.step import advance

    for method in available("mpm_verify.solver.basis"):
        model, comparison, _ = setup(Run(method, "axis_aligned", "neo_hookean", 8, 4, 0.4))
        advance(model, comparison)
        comparison(model.particles, model.time)
    return {
        name: (sum(d.stats.cache_hits.values()), sum(d.stats.cache_misses.values()))
        for name, d in dispatchers()
        if not inlined(d)
    }


def process(top: Path = TOP, **environment: str) -> dict[str, list[int]]:
    """The counts of a new process, of the package at `top`."""
    done = subprocess.run(
        [sys.executable, "-c", COUNT, str(Path(__file__).parent)], capture_output=True, text=True, cwd=top.parent,
        env={**os.environ, "PYTHONPATH": str(top.parent), **environment},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    counts: dict[str, list[int]] = json.loads(done.stdout)
    assert len(counts) > 10
    return counts


def missed(counts: dict[str, list[int]]) -> set[str]:
    """Files of the kernels that were compiled; each kernel was either compiled or found."""
    assert all(stats in ([1, 0], [0, 1]) for stats in counts.values()), counts
    return {name.rpartition(".")[0].removeprefix("mpm_verify.") for name, stats in counts.items() if stats == [0, 1]}


def contents(folder: Path) -> dict[str, float]:
    """Files below a folder and when they were written."""
    return {p.relative_to(folder).as_posix(): p.stat().st_mtime for p in folder.rglob("*") if p.suffix != ".pyc"}


def copied_cache(folder: Path, to: Path) -> Path:
    """Copy of a folder with the times of its files, which no other process writes to."""
    for path in sorted(folder.rglob("*")):
        there = to / path.relative_to(folder)
        with suppress(FileNotFoundError):  # what another process has just finished writing
            there.mkdir(mode=0o700, parents=True) if path.is_dir() else shutil.copy2(path, there)
    return to


def test_a_second_process_hits_the_cache(tmp_path: Path) -> None:
    """This process has compiled or loaded everything once, so the next one compiles nothing and writes nothing."""
    assert {"mpm_verify.solver.transfer.p2g", "mpm_verify.solver.basis.gimp.fill"} <= count().keys()
    cache = copied_cache(_jit.CACHE, tmp_path / _jit.CACHE.name)
    before = contents(cache)
    assert not missed(process(XDG_CACHE_HOME=str(tmp_path)))
    assert contents(cache) == before


@pytest.mark.slow
def test_only_what_an_edit_changes_is_compiled_again(tmp_path: Path) -> None:
    """Cold, every kernel is compiled; warm, none is, and the folder stays as it is; nor is any after a comment."""
    top, home = copied(tmp_path), str(tmp_path / "cache")
    cold = process(top, XDG_CACHE_HOME=home)
    assert all(stats == [0, 1] for stats in cold.values()), cold
    before = contents(tmp_path / "cache")
    assert sum(name.endswith(".nbi") for name in before) >= len(cold)
    assert not missed(process(top, XDG_CACHE_HOME=home))
    assert contents(tmp_path / "cache") == before
    for name in ("weights", "transfer", "basis/cpdi", "_jit"):
        file = top / f"solver/{name}.py"
        file.write_text("# a comment\n\n" + file.read_text().replace('"""', '"""Other words. ', 1))
    assert not missed(process(top, XDG_CACHE_HOME=home))
    for name, compiled in (
        ("cpdi", {"solver.basis.cpdi"}),
        ("_gimp", {"solver.basis.gimp", "solver.basis.cpgimp"}),
    ):
        with (top / f"solver/basis/{name}.py").open("a") as file:
            file.write("EDITED = 1\n")
        assert missed(process(top, XDG_CACHE_HOME=home)) == compiled
