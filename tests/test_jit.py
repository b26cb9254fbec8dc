"""Compilation: one door to Numba, a cache that is never stale and that a second process hits, strict arithmetic."""

import ast
import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mpm_verify.solver import _jit, sources
from mpm_verify.solver.plugins import available
from mpm_verify.solver.sources import TOP

FLOORS = ("solver", "mms", "cases", "reports", "verify")
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
    if file == TOP / "solver/_jit.py":
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
        if name.partition(".")[0] in ("solver", "cases", "mms") or name.startswith("exact_"):
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
def copy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the sources that the cache folder's name is taken from."""
    top = tmp_path / "copy"
    for floor in FLOORS:
        shutil.copytree(TOP / floor, top / floor, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(_jit, "TOP", top)
    monkeypatch.setattr(sources, "TOP", top)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return top


@pytest.mark.parametrize("file", [*KERNELS, TOP / "solver/_jit.py"], ids=lambda file: file.relative_to(TOP).as_posix())
def test_the_cache_follows_every_kernel_source(copy: Path, file: Path) -> None:
    """A changed byte in any file with a kernel means another folder, and undone the same one again."""
    before = _jit.cache_folder()
    assert before.is_relative_to(copy.parent / "cache")
    assert before == _jit.cache_folder()
    text = (copy / file.relative_to(TOP)).read_text()
    (copy / file.relative_to(TOP)).write_text(text + "#")
    assert _jit.cache_folder() != before
    (copy / file.relative_to(TOP)).write_text(text)
    assert _jit.cache_folder() == before


def test_the_cache_follows_names_and_new_files(copy: Path) -> None:
    before = _jit.cache_folder()
    (copy / "solver/basis/extra.py").write_text("")
    added = _jit.cache_folder()
    (copy / "solver/basis/extra.py").rename(copy / "solver/basis/other.py")
    assert len({before, added, _jit.cache_folder()}) == 3


def test_a_home_that_cannot_be_written(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The cache then goes to a temporary folder; here a file stands where the folder would be."""
    (copy.parent / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(copy.parent / "file"))
    monkeypatch.setattr(_jit.tempfile, "gettempdir", lambda: str(copy.parent / "spare"))
    folder = _jit.cache_folder()
    assert folder.is_relative_to(copy.parent / "spare")
    assert os.access(folder, os.W_OK)


COUNT = """
import json, sys
sys.path.insert(0, "tests")
from test_jit import count
print(json.dumps(count()))
"""


def count() -> dict[str, tuple[int, int]]:
    """Cache hits and misses of every kernel, after a step of each basis with a manufactured body force."""
    from mpm_verify.cases.mms.case import setup
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


def process(**environment: str) -> dict[str, list[int]]:
    """The counts of a new process."""
    done = subprocess.run(
        [sys.executable, "-c", COUNT], capture_output=True, text=True, cwd=TOP, env={**os.environ, **environment}
    )
    assert done.returncode == 0, done.stderr
    counts: dict[str, list[int]] = json.loads(done.stdout)
    assert len(counts) > 10
    return counts


def contents(folder: Path) -> dict[str, float]:
    """Files below a folder and when they were written."""
    return {p.relative_to(folder).as_posix(): p.stat().st_mtime for p in folder.rglob("*") if p.suffix != ".pyc"}


def test_a_second_process_hits_the_cache() -> None:
    """This process has compiled or loaded everything once, so the next one compiles nothing and writes nothing."""
    count()
    before = contents(_jit.CACHE)
    missed = {name: stats for name, stats in process().items() if stats != [1, 0]}
    assert not missed
    assert contents(_jit.CACHE) == before


@pytest.mark.slow
def test_a_cold_and_a_warm_process(tmp_path: Path) -> None:
    """Cold, every kernel is compiled; warm, none is, and the folder stays as it is."""
    cold = process(XDG_CACHE_HOME=str(tmp_path))
    assert all(stats == [0, 1] for stats in cold.values()), cold
    before = contents(tmp_path)
    assert sum(name.endswith(".nbi") for name in before) >= len(cold)
    warm = process(XDG_CACHE_HOME=str(tmp_path))
    assert all(stats == [1, 0] for stats in warm.values())
    assert contents(tmp_path) == before
