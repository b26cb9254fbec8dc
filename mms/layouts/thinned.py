"""Layout that is uniform where strain is largest, and has fewer particles elsewhere; see mms/grading.py."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.grading import Grading
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, Offset


@dataclass(frozen=True)
class Thinned(Grading):
    """Thinned layout, with `ppc` particles in a cell where strain is largest; parameters as of Grading.

    Where there is no strain, ppc / contrast^2.
    """

    def __call__(self, solution: Any, exact: Manufactured, dx: float, ppc: int, offset: Offset) -> Layout:
        """Lay rectangles, see Grading.lay."""
        return self.lay(solution, exact, dx, ppc, offset, fewer=True)
