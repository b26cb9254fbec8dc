"""Convergence as a test of your own, for pytest: a study with the reference solver, and a table of errors."""

from pathlib import Path

import mpm_verify as mv

CELLS = [8, 16, 32, 64]
ERRORS = [3.043e-3, 7.122e-4, 1.800e-4, 4.498e-5]  # of your code, in one norm
HALF_THE_TIME_STEP = 4.49e-5  # on the finest cells


def test_the_method_converges_as_registered(tmp_path: Path) -> None:
    """A registered study, run in seconds."""
    done = mv.study("mms", method="cpdi", solution="axis_aligned", quick=True, out=tmp_path / "study")
    assert done.outcome == "PASS", done.verdicts


def test_a_table_of_errors_has_order_two() -> None:
    """Errors of another code, by the same rule."""
    found = mv.judge(CELLS, ERRORS, order=2, dt_halved=HALF_THE_TIME_STEP)
    assert found.passed, found.reason
