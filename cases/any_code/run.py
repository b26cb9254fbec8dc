"""Run and Result of a table: a row of it with its number, from whatever code."""

from dataclasses import dataclass, field
from math import inf, nan
from typing import ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis

NORM = "error"  # the only one: in what norm its errors are, a table need not say
HALF = 0.5  # of the time step


@dataclass(frozen=True)
class Run(RunRecord):
    """One row. Two rows that differ in the fields after `steady` alone stand at the same point of a refinement.

    Raises ValueError with one line for a level without a size.
    """

    method: str = axis("code", "Code or method that the number is of.")
    measured: str = axis("error", "Quantity that the number is of.")
    cells: float = axis(16.0, "One over the cell size.")
    courant: float = axis(1.0, "Time step, as a fraction of that of the table: 1 or 0.5.")
    offset: tuple[float, float] = axis((0.0, 0.0), "Number of the replicate, and zero.")
    exact: bool = axis(True, "Whether the number is an error; otherwise it is a value of the quantity.")
    steady: bool = axis(False, "Whether there is no time step.")
    number: float = field(default=0.0, compare=False)  # the error, or the value
    coarser: float = field(default=nan, compare=False)  # of values: that of the next coarser level,
    coarser_h: float = field(default=0.0, compare=False)  # its cell size,
    turns: bool = field(default=False, compare=False)  # whether the step to it goes another way than the finest step,
    order: float = field(default=2.0, compare=False)  # and the order by which the step becomes an error
    floor: float = field(default=0.0, compare=False)
    by: str = field(default="cells", compare=False)  # `cells` or `h`, as the table says sizes
    line: int = field(default=0, compare=False)  # of the file
    case: ClassVar[str] = "any_code"
    given: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not 0 < self.cells < inf:
            raise ValueError(f"cells = {self.cells} is not a level; a cell size is above zero and finite")

    @property
    def tied(self) -> bool:
        """Whether there is no time step to be halved."""
        return self.steady

    @property
    def h(self) -> float:
        """Cell size, in the unit of the table; that of one over cells in cells."""
        return 1 / self.cells

    def __str__(self) -> str:
        size = f"{self.cells:.15g} cells" if self.by == "cells" else f"h={self.h:.6g}"
        half = ", half the time step" if self.courant == HALF else ""
        again = f", replicate {self.offset[0] + 1:.0f}" if self.offset[0] else ""
        return f"{self.method}, {self.measured}, {size}{again}{half}"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Value of a row: an error, or an estimate of it from two values."""

    run: Run
