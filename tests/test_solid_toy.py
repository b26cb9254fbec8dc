"""The toy of three dimensions: its digits, its order, a plane case one cell thick, and faults that are seen in F."""

import json
import shutil
import sys
from math import log
from pathlib import Path

import pytest
from fixtures_command import Call, caller

pytestmark = pytest.mark.slow

OLD = "F = F + dt * velocity[i].transpose(0, 2, 1) @ dN @ F"
FAULTS = {
    "L transposed": "F = F + (dt * velocity[i].transpose(0, 2, 1) @ dN).transpose(0, 2, 1) @ F",
    "symmetric part of L": "L = dN.transpose(0, 2, 1) @ velocity[i]; F = F + dt / 2 * (L + L.transpose(0, 2, 1)) @ F",
}
SWIRL = "swirl3d:A=1e-6,B=1e-6"
DIGITS = {  # u, v and F in rms over 16 frames, on 6, 8 and 12 cells
    "bump3d": (("5.058e-08", "3.372e-05", "7.097e-07"), ("2.834e-08", "1.819e-05", "4.755e-07"),
               ("1.246e-08", "6.923e-06", "2.854e-07")),
}  # fmt: skip


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def judged(verify: Call, solution: str, cells: str, *more: str, fault: str = "") -> list[dict[str, dict[str, float]]]:
    """Errors of the toy on some numbers of cells, by quantity and norm."""
    shutil.rmtree("toy", ignore_errors=True)
    verify("example", "python3d", "toy")
    if fault:
        file = Path("toy/solver.py")
        assert OLD in file.read_text()
        file.write_text(file.read_text().replace(OLD, FAULTS[fault]))
    typed = f"{sys.executable} toy/solver.py {{case}} {{out}}"
    words = ["--solution", solution, "--cells", cells, "--courant", "0.4", "--as", "mpm", "--quick", "--json"]
    words += [] if "--out" in more else ["--out", "study"]
    _, out, _ = verify("mms", "--solver", typed, *words, *more)
    runs = [run for run in json.loads(out)["runs"] if run["courant"] == 0.4]
    return [run["errors"] for run in sorted(runs, key=lambda run: run["cells"])]


@pytest.mark.parametrize("solution", DIGITS)
def test_digits(verify: Call, solution: str) -> None:
    found = judged(verify, solution, "6,8,12")
    for errors, digits in zip(found, DIGITS[solution], strict=True):
        assert tuple(f"{errors[q]['rms']:.3e}" for q in ("u", "v", "F")) == digits
    coarse, middle, fine = (errors["u"]["rms"] for errors in found)
    assert 1.95 < log(coarse / middle) / log(8 / 6) < 2.1
    assert 1.95 < log(middle / fine) / log(12 / 8) < 2.1


def test_a_plane_case_one_cell_thick_has_the_plane_digits(verify: Call) -> None:
    """Those of other programs in two dimensions, on 8, 12 and 16 cells."""
    found = judged(verify, "clamped_shear:G=1e-6", "8,12,16", "--dim", "3", "--ppc", "4")
    assert [errors["u"]["rms"] for errors in found] == pytest.approx((7.253e-8, 3.208e-8, 1.787e-8), rel=2e-4)


def order(found: list[dict[str, dict[str, float]]], quantity: str) -> float:
    """Observed order of two levels, on 6 and 8 cells."""
    coarse, fine = (errors[quantity]["rms"] for errors in found)
    return log(coarse / fine) / log(8 / 6)


def test_a_planted_fault_is_seen_in_f(verify: Call) -> None:
    """At small amplitude u and v are what they were, and F hardly converges."""
    right = judged(verify, SWIRL, "6,8")
    assert [f"{errors['u']['rms']:.3e}" for errors in right] == ["1.758e-08", "1.053e-08"]
    assert 1.4 < order(right, "F") < 1.6
    for fault in FAULTS:
        wrong = judged(verify, SWIRL, "6,8", "--out", fault.replace(" ", "_"), fault=fault)
        for quantity in ("u", "v"):
            assert order(wrong, quantity) == pytest.approx(order(right, quantity), abs=1e-3)
        assert abs(order(wrong, "F")) < 0.5
        assert wrong[1]["F"]["rms"] > 1.5 * right[1]["F"]["rms"]
