"""Builds the MMS study from what is asked for: its runs, and what it declares to judge and to show.

Four axes are refined apart from each other: cells and particles per cell as a full table, `times` on the finest cells,
and the position of the particles in their cells, `replicates`, at every point of the table.
"""

import re
from dataclasses import dataclass, fields, replace
from math import isqrt
from typing import Any

from mpm_verify.cases.harness.study import NORMS, QUANTITIES, QuantityPlan, Run, Study
from mpm_verify.cases.mms.expectations import JUDGED, expected
from mpm_verify.cases.mms.time_step import check_time_steps
from mpm_verify.mms.cells import fitting
from mpm_verify.mms.energy import check_energy
from mpm_verify.solver.layout import CENTRED, Offset
from mpm_verify.solver.plugins import (
    LAYOUTS,
    MATERIALS,
    METHODS,
    SOLUTIONS,
    TRANSFERS,
    absolute,
    available,
    create,
    is_file,
    on_screen,
    parameters_of,
    split,
)
from mpm_verify.solver.stress_update import check_stress_update

MOST = 64  # replicates


@dataclass(frozen=True)
class Sweep:
    """What is asked for: the axes of the sweep and the settings that all its runs share.

    `courant` is that of the table of cells and particles; `times` are smaller ones for the finest cells.
    """

    methods: tuple[str, ...] = ("cpdi",)
    solution: str = "axis_aligned"
    material: str = ""  # the solution's own
    cells: tuple[int, ...] = (8, 16, 32, 64, 128)
    ppc: tuple[int, ...] = (1, 4, 9)
    courant: float = 0.4
    transfer: str = "flip"
    stress: str = "usl"
    staggered: bool = True
    force: bool = False
    times: tuple[float, ...] = ()
    replicates: int = 1
    layout: str = "uniform"

    @property
    def name(self) -> str:
        """Name of the study: its methods and what is not as usual, so that another sweep gets a folder of its own."""
        changed = {
            item.name: getattr(self, item.name) for item in fields(self) if getattr(self, item.name) != item.default
        }
        words = ["mms", *self.methods, *(str(changed.pop(key)) for key in ("solution", "material") if key in changed)]
        words += [f"{key}-{value}" for key, value in changed.items() if key != "methods"]
        return re.sub(r"[^A-Za-z0-9.]+", "-", " ".join(words)).strip("-")[:120]

    @property
    def fitted(self) -> "Sweep":
        """The same with cells that fill the body, near those that are asked for. Raises ValueError."""
        return replace(self, cells=fitting(create(SOLUTIONS, self.solution), self.cells))

    def check(self) -> None:
        """Raise ValueError with one line that says what is wrong and what is allowed."""
        for method in self.methods:
            if method not in available(METHODS):
                raise ValueError(f"no method {method!r}; choose from {', '.join(available(METHODS))}")
        for count in self.cells:
            if not 2 <= count <= 4096:
                raise ValueError(
                    f"cells = {count} cannot be run; choose whole numbers from 2 to 4096, such as 8,16,32,64"
                )
        for count in self.ppc:
            if count < 1 or isqrt(count) ** 2 != count:
                raise ValueError(f"{count} particles per cell is no square number; choose from 1, 4, 9, 16, ...")
        for courant in (self.courant, *self.times):
            if not 1e-3 <= courant <= 10:
                raise ValueError(f"courant = {courant} cannot be run; choose 0.001 to 10, 0.4 is usual")
            if courant > self.courant:
                raise ValueError(
                    f"courant = {courant} is above the first, {self.courant}; begin with the largest: 0.4,0.2,0.1"
                )
        if not 1 <= self.replicates <= MOST:
            raise ValueError(f"replicates = {self.replicates} cannot be run; choose whole numbers from 1 to {MOST}")
        check_stress_update(self.stress)
        create(TRANSFERS, self.transfer)
        layout = create(LAYOUTS, self.layout)
        solution = create(SOLUTIONS, self.solution)
        law = create(MATERIALS, self.material or solution.material)
        check_energy(law)
        layout.check(solution)
        if is_file(self.solution):
            from mpm_verify.mms.check import check  # derives the fields: some tenths of a second

            check(solution, law, self.cells)


def build(sweep: Sweep, command: str, name: str) -> Study:
    """The Study of a sweep, checked. Raises ValueError, see Sweep.check."""
    sweep.check()
    solution = canonical(SOLUTIONS, sweep.solution)
    material = canonical(MATERIALS, sweep.material or create(SOLUTIONS, solution).material)
    transfer = canonical(TRANSFERS, sweep.transfer)
    declared = tuple(
        declare(sweep, (method, solution, material), ppc, quantity, norm)
        for method in sweep.methods
        for ppc in sorted(set(sweep.ppc))
        for quantity in QUANTITIES
        for norm in NORMS
    )
    layout = canonical(LAYOUTS, sweep.layout)
    first = Run("", solution, material, 1, 1, sweep.courant, transfer, sweep.stress, sweep.staggered, sweep.force)
    runs = [
        replace(first, method=method, cells=cells, ppc=ppc, layout=layout)
        for method in sweep.methods
        for ppc in sorted(set(sweep.ppc))
        for cells in sorted(set(sweep.cells))
    ]
    finest = [run for run in runs if run.cells == max(sweep.cells)]
    halved = [
        replace(run, courant=run.courant / 2)
        for run in finest
        if any(converges(d) and belongs(d, run) for d in declared)
    ]
    timed = [replace(run, courant=courant) for run in finest for courant in sorted(set(sweep.times), reverse=True)]
    shifted = [replace(run, offset=offset) for run in runs for offset in offsets(sweep.replicates)[1:]]
    every = tuple(dict.fromkeys(runs + halved + timed + shifted))
    if not sweep.force:
        courants = sorted({sweep.courant, *sweep.times})
        check_time_steps(sweep.solution, create(SOLUTIONS, solution), create(MATERIALS, material), every, courants)
    named = (
        " and ".join(m.upper() for m in sweep.methods) if len(sweep.methods) < 4 else f"{len(sweep.methods)} methods"
    )
    title = f"{named} against the manufactured solution {on_screen(solution)}"
    return Study(name, title, command, every, declared)


def offsets(replicates: int) -> list[Offset]:
    """Where the particles of each replicate lie: shares of their spacing in (-1/2, 1/2), the usual place first.

    The others are the Halton sequence (Halton 1960), without its zero: it covers the square evenly, and more replicates
    keep the places of fewer, so that stored runs serve again.
    """
    if replicates == 1:
        return [CENTRED]
    from scipy.stats.qmc import Halton  # slow to import

    places = Halton(2, scramble=False).random(replicates)[1:] - 0.5
    return [CENTRED, *((float(a), float(b)) for a, b in places)]


def declare(sweep: Sweep, names: tuple[str, str, str], ppc: int, quantity: str, norm: str) -> QuantityPlan:
    """A quantity with its registered expectation, of FLIP and update-stress-last alone; u in rms is judged."""
    usual = sweep.courant == Sweep.courant and sweep.staggered
    scheme = (canonical(TRANSFERS, sweep.transfer), sweep.stress, canonical(LAYOUTS, sweep.layout))
    expectation = expected(*names, ppc, quantity, norm, usual) if scheme == ("flip", "usl", "uniform") else None
    judged = expectation is not None and (quantity, norm) == JUDGED
    return QuantityPlan(names[0], names[1], ppc, quantity, norm, judged, expectation)


def converges(declared: QuantityPlan) -> bool:
    """Judged against an order, and so in need of the run with half the time step."""
    return declared.judged and declared.expectation is not None and declared.expectation.order is not None


def belongs(declared: QuantityPlan, run: Run) -> bool:
    """Whether the run is a level of the declared quantity."""
    return (declared.method, declared.solution, declared.ppc) == (run.method, run.solution, run.ppc)


def canonical(package: str, specification: str) -> str:
    """The specification with only the parameters that differ from their defaults, sorted: one name for one thing."""
    plugin: Any = create(package, specification)
    values = {name: (getattr(plugin, item.name), item.default) for name, item in parameters_of(plugin).items()}
    changed = [
        f"{key}={str(value).removesuffix('.0')}" for key, (value, usual) in sorted(values.items()) if value != usual
    ]
    return ":".join([split(absolute(specification))[0], *filter(None, [",".join(changed)])])
