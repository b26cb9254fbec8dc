"""The uniform layout where strain is largest, and fewer particles elsewhere; see mms/grading.py."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.grading import Grading
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, Offset


@dataclass(frozen=True)
class Thinned(Grading):
    """`ppc` is the number in a cell where strain is largest; where there is none, ppc / contrast^2."""

    def __call__(self, solution: Any, exact: Manufactured, dx: float, ppc: int, offset: Offset) -> Layout:
        """Rectangles. Raises ValueError for a body that is none."""
        return self.lay(solution, exact, dx, ppc, offset, fewer=True)
