"""The study of all methods on the solutions that tell them apart: the MMS studies of each solution in one Study."""

from dataclasses import dataclass

from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms.deviations import SHOWN
from mpm_verify.cases.mms.sweep import Sweep, build
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


@dataclass(frozen=True)
class Comparison:
    """Methods, solutions and particles per cell to compare; `levels` gives the cells of each solution."""

    methods: tuple[str, ...]
    levels: dict[str, tuple[int, ...]]
    ppc: tuple[int, ...] = (4,)


def everything() -> Comparison:
    """Every basis there is, on every solution of LEVELS; those that tables show first, in their order."""
    known = [method for method in SHOWN if method in available(METHODS)]
    return Comparison(tuple(dict.fromkeys([*known, *available(METHODS)])), LEVELS)


def build_methods(comparison: Comparison, command: str, name: str) -> Study:
    """One Study of all. Raises ValueError, see Sweep.check."""
    parts = [
        build(Sweep(comparison.methods, solution, cells=cells, ppc=comparison.ppc), command, name)
        for solution, cells in comparison.levels.items()
    ]
    runs = tuple(run for part in parts for run in part.runs)
    declared = tuple(d for part in parts for d in part.plans)
    title = f"{len(comparison.methods)} methods on {', '.join(comparison.levels)}"
    return Study(name, title, command, runs, declared)
