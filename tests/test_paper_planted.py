"""Solvers that are broken on purpose turn the entries of the ledger that hang on what is broken, and not others."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from mpm_verify.cases.detect.defect import defects
from mpm_verify.cases.detect.plant import Planted, copied

ASKED: dict[str, tuple[str, set[str], set[str]]] = {  # defect: studies, claims that turn, and claims that do not
    "cpdi-vectors-not-moved": ("cell_crossing,rotation", {"F1", "F2", "F4"}, set()),
    "rotation-old-both": ("figure2", {"F15", "F19"}, {"F18"}),  # which is before the turn
    "sand-modulus": ("cell_crossing,ubcsand", {"U1"}, {"F1"}),
}


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return copied(tmp_path_factory.mktemp("planted"))


def changed(copy: Path, only: str, out: Path) -> tuple[int, dict[str, Any]]:
    """Exit code and ledger of a small quick ledger by the copy."""
    command = [sys.executable, "-m", "mpm_verify", "paper", "--quick", "--only", only, "--jobs", "1", "--json"]
    done = subprocess.run([*command, "--out", str(out)], capture_output=True, text=True, cwd=copy, timeout=600)
    assert done.returncode in (0, 1), done.stderr
    return done.returncode, json.loads(done.stdout)


@pytest.mark.slow
@pytest.mark.parametrize("name", ASKED)
def test_a_broken_solver_turns_the_right_entries(copy: Path, tmp_path: Path, name: str) -> None:
    only, turned, kept = ASKED[name]
    with Planted(copy, defects()[name]):
        code, found = changed(copy, only, tmp_path)
    moved = {one["claim"] for one in found["changes"]}
    statuses = {one["claim"] for one in found["changes"] if one["what"] == "status"}
    assert code == 1
    assert turned == statuses
    assert not kept & moved
