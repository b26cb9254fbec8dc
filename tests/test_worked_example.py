"""The worked example of README, word for word: three files put in their places in a copy, and run."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

TOP = Path(__file__).resolve().parent.parent
PACKAGES = ("solver", "mms", "cases", "reports", "verify")


def blocks() -> dict[str, str]:
    """The Python blocks of README that begin with the path of a file, by that path."""
    found = re.findall(r"```python\n(# (\S+\.py)\n.*?)```", (TOP / "README.md").read_text(), flags=re.DOTALL)
    return {path: text for text, path in found}


def verify(folder: Path, *arguments: str) -> Any:
    """What `verify ... --json` of the copy says; an exit code of 3 is that nothing is registered."""
    done = subprocess.run(
        [sys.executable, "-m", "mpm_verify.verify.main", *arguments, "--json"],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(folder)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 3, done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow  # the copy has a kernel cache of its own
def test_three_files_are_a_basis_a_law_and_a_solution(tmp_path: Path) -> None:
    for package in PACKAGES:
        shutil.copytree(TOP / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    written = blocks()
    assert set(written) == {"solver/basis/tent.py", "solver/material/saint_venant.py", "mms/solutions/breathing.py"}
    for path, text in written.items():
        assert not (tmp_path / path).exists()  # new, so that no other file is touched
        (tmp_path / path).write_text(text)
    got = verify(
        tmp_path, "mms", "--method", "tent", "--method", "mpm", "--method", "cpdi", "--solution", "breathing",
        "--material", "saint_venant", "--cells", "8,16,32", "--ppc", "4", "--out", "study",
    )  # fmt: skip
    errors = {(r["method"], r["cells"]): r["errors"]["u"]["rms"] for r in got["runs"] if r["status"] == "finished"}
    assert errors["tent", 8] == pytest.approx(errors["mpm", 8], rel=1e-6)  # the same basis in other words
    assert errors["cpdi", 16] / errors["cpdi", 32] == pytest.approx(4, rel=0.1)  # law, energy and solution agree
    assert errors["cpdi", 32] < 0.01 * 0.02  # of the amplitude
