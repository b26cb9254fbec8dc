"""Builds the MMS study from what is asked for: its runs, and what it declares to judge and to show."""

import re
from dataclasses import dataclass, fields, replace
from math import isqrt
from typing import Any

from cases.expectations import expected
from cases.study import NORMS, QUANTITIES, Declared, Run, Study
from solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, create


@dataclass(frozen=True)
class Sweep:
    """What is asked for: the axes of the sweep and the settings that all its runs share."""

    methods: tuple[str, ...] = ("cpdi",)
    solution: str = "axis_aligned"
    material: str = "neo_hookean"
    cells: tuple[int, ...] = (8, 16, 32, 64, 128)
    ppc: tuple[int, ...] = (1, 4, 9)
    courant: float = 0.4
    flip: float = 1.0
    staggered: bool = True
    force: bool = False

    @property
    def name(self) -> str:
        """Name of the study: its methods and what is not as usual, so that another sweep gets a folder of its own."""
        changed = {
            item.name: getattr(self, item.name) for item in fields(self) if getattr(self, item.name) != item.default
        }
        words = ["mms", *self.methods, *(str(changed.pop(key)) for key in ("solution", "material") if key in changed)]
        words += [f"{key}-{value}" for key, value in changed.items() if key != "methods"]
        return re.sub(r"[^A-Za-z0-9.]+", "-", " ".join(words)).strip("-")[:120]

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
        if not 1e-3 <= self.courant <= 10:
            raise ValueError(f"courant = {self.courant} cannot be run; choose 0.001 to 10, 0.4 is usual")
        if not 0 <= self.flip <= 1:
            raise ValueError(f"flip = {self.flip} must lie between 0 (PIC) and 1 (FLIP)")
        create(SOLUTIONS, self.solution)
        create(MATERIALS, self.material)


def build(sweep: Sweep, command: str, name: str) -> Study:
    """The Study of a sweep, checked. Raises ValueError, see Sweep.check."""
    sweep.check()
    solution, material = canonical(SOLUTIONS, sweep.solution), canonical(MATERIALS, sweep.material)
    declared = tuple(
        declare(sweep, (method, solution, material), ppc, quantity, norm)
        for method in sweep.methods
        for ppc in sorted(set(sweep.ppc))
        for quantity in QUANTITIES
        for norm in NORMS
    )
    runs = [
        Run(method, solution, material, cells, ppc, sweep.courant, sweep.flip, sweep.staggered, sweep.force)
        for method in sweep.methods
        for ppc in sorted(set(sweep.ppc))
        for cells in sorted(set(sweep.cells))
    ]
    halved = [
        replace(run, courant=run.courant / 2)
        for run in runs
        if run.cells == max(sweep.cells) and any(converges(d) and belongs(d, run) for d in declared)
    ]
    title = f"{' and '.join(m.upper() for m in sweep.methods)} against the manufactured solution {solution}"
    return Study(name, title, command, tuple(runs + halved), declared)


def declare(sweep: Sweep, names: tuple[str, str, str], ppc: int, quantity: str, norm: str) -> Declared:
    """A quantity with its registered expectation; judged if it has one. Of PIC blends nothing is registered."""
    usual = sweep.courant == Sweep.courant and sweep.staggered
    expectation = expected(*names, ppc, quantity, norm, usual) if sweep.flip == 1 else None
    return Declared(names[0], names[1], ppc, quantity, norm, expectation is not None, expectation)


def converges(declared: Declared) -> bool:
    """Judged against an order, and so in need of the run with half the time step."""
    return declared.expectation is not None and declared.expectation.order is not None


def belongs(declared: Declared, run: Run) -> bool:
    """Whether the run is a level of the declared quantity."""
    return (declared.method, declared.solution, declared.ppc) == (run.method, run.solution, run.ppc)


def canonical(package: str, specification: str) -> str:
    """The specification with only the parameters that differ from their defaults, sorted: one name for one thing."""
    plugin: Any = create(package, specification)
    values = {item.name: (getattr(plugin, item.name), item.default) for item in fields(plugin)}
    changed = [
        f"{key}={repr(value).removesuffix('.0')}" for key, (value, usual) in sorted(values.items()) if value != usual
    ]
    return ":".join([specification.partition(":")[0], *filter(None, [",".join(changed)])])
