"""Layout of as many particles as the uniform one has, moved to where strain is expected; see mms/grading.py."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.grading import Grading
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, Offset


@dataclass(frozen=True)
class Graded(Grading):
    """Graded layout, where `ppc` is the mean number in a cell; parameters as of Grading."""

    def __call__(self, solution: Any, exact: Manufactured, dx: float, ppc: int, offset: Offset) -> Layout:
        """Lay rectangles, see Grading.lay."""
        return self.lay(solution, exact, dx, ppc, offset, fewer=False)
