"""The regular layout of a solution: the same number of particles in every cell."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, Offset


@dataclass(frozen=True)
class Uniform:
    """As the solution lays its body out."""

    def check(self, solution: Any) -> None:
        """Every body can be laid out so."""

    def __call__(self, solution: Any, exact: Manufactured, dx: float, ppc: int, offset: Offset) -> Layout:
        """`ppc` particles in each cell of side dx."""
        layout: Layout = solution.layout(dx, ppc, offset)
        return layout
