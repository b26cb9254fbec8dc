"""Study of all methods on the solutions that tell them apart: the MMS studies of each solution in one Study."""

from collections.abc import Sequence
from typing import Any

from mpm_verify.cases.harness.build import Asked, union
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms.deviations import SHOWN
from mpm_verify.solver.plugins import METHODS, available

SQUARES = (12, 16, 24, 32, 48, 64, 96)
RINGS = (16, 24, 32, 48, 64, 96)
VORTEX = (32, 48, 64, 96, 128)  # on coarser grids the error is the size of the motion
QUICK: dict[str, tuple[int, ...]] = {"bar": (12, 16, 24, 32, 48, 64)}
LEVELS: dict[str, tuple[int, ...]] = {
    "axis_aligned:A=1e-6": SQUARES,
    "axis_aligned": SQUARES,
    "bar": SQUARES,
    "clamped_shear": SQUARES,
    "swirl": SQUARES,
    "expanding_ring": RINGS,
    "generalised_vortex": VORTEX,
}


def every_method() -> list[str]:
    """Names of all bases, those that tables show first."""
    known = [method for method in SHOWN if method in available(METHODS)]
    return list(dict.fromkeys([*known, *available(METHODS)]))


def build_methods(
    methods: Sequence[str], levels: dict[str, tuple[int, ...]], ppc: Sequence[int], command: str, name: str
) -> Study[Any]:
    """Build one Study of these methods; `levels`: the cells of each solution. Raises ValueError, see build.union."""
    parts = [
        Asked("mms", {"method": methods, "solution": (solution,), "cells": cells, "ppc": ppc})
        for solution, cells in levels.items()
    ]
    return union(parts, command, name, f"{len(methods)} methods on {', '.join(levels)}")
