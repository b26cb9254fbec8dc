"""Exported sources of languages that need more than a compiler: CUDA and Warp's snippets, and Julia.

Warp and the grammar of Julia are where the public codes are, in the interpreter that ADAPTERS_PYTHON names; `make
adapters` makes one. Elsewhere these tests are skipped. Warp runs the exported functions on the CPU and compiles them
for CUDA; Julia itself is not needed, and not run.
"""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fixtures_command import TOP
from fixtures_export import folder_of

from mpm_verify.mms.export.checking import Checked, Outcome, compared, filled
from mpm_verify.mms.export.expected import Table
from mpm_verify.reports.export.case_folder import read, table_of

PYTHON = os.environ.get("ADAPTERS_PYTHON", sys.executable)
WARP, TREE = TOP / "examples" / "warp_snippet.py", TOP / "tests" / "julia_tree.py"
EXAMPLE = TOP / "cases" / "mms" / "external" / "examples" / "julia" / "solver.jl.in"


@pytest.fixture(autouse=True)
def foreign(request: pytest.FixtureRequest) -> None:
    """Skip a test whose program is not there."""
    needed = "tree_sitter_julia" if "julia" in request.node.name else "warp"
    probe = "import importlib.util as u, sys; sys.exit(u.find_spec(sys.argv[1]) is None)"
    if subprocess.run([PYTHON, "-c", probe, needed], capture_output=True).returncode:
        pytest.skip(f"{PYTHON} has no {needed}: run make adapters")


def asked(script: Path, known: Table, *words: str) -> Checked:
    """Outcome of what a script prints for the rows of a case."""
    rows = "\n".join(" ".join(map(repr, row)) for row in known.given.tolist())
    done = subprocess.run([PYTHON, str(script), *words], input=rows, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr[-2000:]
    return compared(script.stem, PYTHON, done.stdout, known)


def case(solution: str, folder: Path) -> Table:
    return table_of(folder, read(folder_of(solution, folder)))


def changed(file: Path, old: str, new: str) -> None:
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


# ---- Warp: the device functions, on the CPU


@pytest.mark.slow
@pytest.mark.parametrize("solution", ["clamped_shear", "swirl3d"])
def test_warp_gives_the_right_values(solution: str, tmp_path: Path) -> None:
    """To the tolerance of each row, as of the other languages; and they are compiled for CUDA, as double."""
    known = case(solution, tmp_path)
    found = asked(WARP, known, str(tmp_path), "--ptx", str(tmp_path / "ptx"))
    assert found.outcome is Outcome.AGREES, found
    assert found.rows == 40
    assert 0 < found.worst < 0.5
    (made,) = (tmp_path / "ptx").glob("*.ptx")
    text = made.read_text()
    assert ".target sm_75" in text
    assert text.count("fma.rn.f64") + text.count("mul.rn.f64") > 50


@pytest.mark.slow
def test_warp_in_single_precision(tmp_path: Path) -> None:
    """The force is off by rounding, some 1e-7 of its largest value, and not by more."""
    known = case("clamped_shear", tmp_path)
    rounded = replace(known, tolerance=np.full_like(known.tolerance, np.inf))
    size = np.abs(known.values[:, :2]).max()
    rounded.tolerance[:, :2] = 2e-6 * size
    found = asked(WARP, rounded, str(tmp_path), "--precision", "single")
    assert found.outcome is Outcome.AGREES, found
    assert found.worst > 1e-3  # double precision would be below 1e-8


@pytest.mark.slow
def test_a_fault_in_a_warp_snippet_is_seen(tmp_path: Path) -> None:
    known = case("clamped_shear", tmp_path)
    changed(tmp_path / "body_force.cuh", "values[0] = aX - ", "values[0] = aX + ")
    found = asked(WARP, known, str(tmp_path))
    assert found.outcome is Outcome.DISAGREES
    assert found.column.startswith("b")


# ---- Julia: the grammar, and values by its syntax tree


def parsed(*files: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([PYTHON, str(TREE), *map(str, files)], capture_output=True, text=True)


@pytest.mark.parametrize("solution", ["clamped_shear", "swirl3d"])
def test_julia_sources_are_julia(solution: str, tmp_path: Path) -> None:
    case(solution, tmp_path)
    driver = tmp_path / "driver.jl"
    driver.write_text(filled("drivers/driver.jl", dimension=2, stress=4, header="", prefix=""))
    done = parsed(tmp_path / "body_force.jl", driver, EXAMPLE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    changed(tmp_path / "body_force.jl", "return (r1, ", "return (r1, , ")
    done = parsed(tmp_path / "body_force.jl", driver)
    assert done.returncode == 1
    assert done.stdout.startswith(f"{tmp_path / 'body_force.jl'}:")


@pytest.mark.parametrize("solution", ["clamped_shear", "swirl3d"])
def test_julia_sources_have_the_right_values_by_their_tree(solution: str, tmp_path: Path) -> None:
    """All but the force at a current position, whose loop is parsed alone; a constant changed in a digit is seen."""
    whole = case(solution, tmp_path)
    kept = [k for k, name in enumerate(whole.names) if not name.endswith(" at x")]
    known = replace(whole, names=tuple(whole.names[k] for k in kept), values=whole.values[:, kept],
                    tolerance=whole.tolerance[:, kept])  # fmt: skip
    assert len(kept) < len(whole.names)
    file = tmp_path / "body_force.jl"
    found = asked(TREE, known, "--values", str(file))
    assert found.outcome is Outcome.AGREES, found
    assert 0 < found.worst < 0.5
    changed(file, "3.141592653589793", "3.141592653588793")
    assert asked(TREE, known, "--values", str(file)).outcome is Outcome.DISAGREES
