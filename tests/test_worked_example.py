"""The worked example of docs/own-plugin.md, word for word: three files beside each other, anywhere, and one command."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

TOP = Path(__file__).resolve().parent.parent


FILES = ("tent.py", "saint_venant.py", "breathing.py")


def blocks() -> dict[str, str]:
    """The three files of the example; a block of the page begins with the name of its file."""
    page = (TOP / "docs" / "own-plugin.md").read_text()
    found = {name: text for text, name in re.findall(r"```python\n(# (\S+\.py)\n.*?)```", page, flags=re.DOTALL)}
    return {name: found[name] for name in FILES}


def verify(folder: Path, *arguments: str) -> Any:
    """What `verify ... --json` says of a study that does not pass."""
    done = subprocess.run(
        [sys.executable, "-m", "mpm_verify", *arguments, "--json"],
        cwd=folder, env={**os.environ, "PYTHONPATH": str(TOP)}, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode in (1, 3), done.stderr
    return json.loads(done.stdout)


@pytest.mark.slow  # half a minute, to compile and run in three processes
def test_three_files_are_a_basis_a_material_and_a_solution(tmp_path: Path) -> None:
    written = blocks()
    for name, text in written.items():
        (tmp_path / name).write_text(text)
    got = verify(
        tmp_path, "mms", "--method", "./tent.py,mpm,cpdi", "--solution", "./breathing.py",
        "--material", "./saint_venant.py", "--cells", "8,16,32,64", "--ppc", "4",
        "--out", "study", "--jobs", "2", "--page",
    )  # fmt: skip
    judged = {(Path(v["method"]).stem, v["expected"], v["verdict"]) for v in got["verdicts"] if v["quantity"] == "u"}
    assert judged == {("cpdi", 2.0, "INCONCLUSIVE"), ("tent", 2.0, "FAIL")}  # hats do not keep it where particles cross
    runs = [(Path(r["method"]).stem, r) for r in got["runs"] if r["status"] == "finished"]
    errors = {(method, r["cells"]): r["errors"]["u"]["rms"] for method, r in runs}
    assert errors["tent", 8] == pytest.approx(errors["mpm", 8], rel=1e-6)  # the same basis in other words
    assert errors["cpdi", 16] / errors["cpdi", 32] == pytest.approx(4, rel=0.1)  # stress, energy and solution agree
    assert errors["cpdi", 32] < 0.01 * 0.02  # of the amplitude
    assert {p.name for p in tmp_path.iterdir()} == {*written, "study"}  # nothing is written beside the files
    assert (tmp_path / "study" / "figures" / "error_field_tent.svg").is_file()
