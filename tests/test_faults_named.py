"""Mistakes that the parts beside the plain solver may have, each planted alone in a copy and asked for by one check."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from mpm_verify.cases.detect.defect import defects
from mpm_verify.cases.detect.plant import Planted, copied

EXACT = """
from mpm_verify.cases.exact import battery
from mpm_verify.cases.exact.body import Subject
from mpm_verify.solver._jit import use_threads
use_threads(1)
print(*{{one.test for one in battery.tested({group!r}, Subject("cpdi", {material!r})) if not one.passed}})
"""
EDGES, FRICTION, HENCKY, AT_REST = (
    EXACT.format(group=group, material=material)
    for group, material in (
        ("edges", "neo_hookean"), ("friction", "hypoelastic"), ("stress", "hencky"), ("motion", "hencky"))
)  # fmt: skip
DERIVATION = """
from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.solver.plugins import SOLUTIONS, create
from mpm_verify.verify.detecting.known import CLOSE, residuals
can = create(SOLUTIONS, "cylinder_rz")
print(*(key for key, value in residuals(manufactured("cylinder_rz", can.material), can) if not value < CLOSE))
"""
FOOTING = """
from mpm_verify.cases.benchmark.case import canonical
from mpm_verify.cases.benchmark.execute import execute
from mpm_verify.cases.benchmark.run import Run
result, _ = execute(Run(**canonical({"problem": "footing", "cells": 5, "smoothing": "fbar"})))
print("" if abs(result.values["bearing"] / (2 + 3.141592653589793) - 1) < 0.02 else "bearing")
"""
FAULTS = {  # what is asked, and a word of the answer
    "edge-reference-area": (EDGES, "edge_driven"),  # traction on the reference area
    "edge-normal-inwards": (EDGES, "edge_sums"),
    "edge-tangent-for-normal": (EDGES, "edge_sums"),
    "edge-traction-late": (EDGES, "edge_"),
    "edge-position-late": (EDGES, "edge_"),
    "hoop-terms-missing": (DERIVATION, "b"),
    "hencky-near-one": (AT_REST, "fall"),  # arcosh near 1 by a naive formula: no number in the undeformed state
    "hencky-naive-ratio": (HENCKY, "stress"),
    "friction-scaled": (FRICTION, "friction_slide"),
    "reaction-half-of-the-nodes": (FOOTING, "bearing"),
}


def answer(copy: Path, question: str) -> str:
    """Answer of a copy of the package, in a process of its own."""
    ways = {**os.environ, "PYTHONPATH": str(copy)}
    done = subprocess.run([sys.executable, "-c", question], env=ways, cwd=copy, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.strip()


@pytest.mark.slow
def test_each_is_seen_and_none_in_the_sound_package(tmp_path: Path) -> None:
    copy = copied(tmp_path)
    assert {question: answer(copy, question) for question, _ in FAULTS.values()} == dict.fromkeys(
        (question for question, _ in FAULTS.values()), ""
    )
    for name, (question, word) in FAULTS.items():
        assert defects()[name].listed, name
        with Planted(copy, defects()[name]):
            assert word in answer(copy, question), name
