"""Regular layout of a solution: the same number of particles in every cell."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.layout import Layout, Offset


@dataclass(frozen=True)
class Uniform:
    """Uniform layout, as the solution lays its body out; no parameters."""

    def check(self, solution: Any) -> None:
        """Do nothing: every body can be laid out so."""

    def __call__(self, solution: Any, exact: Manufactured, dx: float, ppc: int, offset: Offset) -> Layout:
        """Lay `ppc` particles, a square number, in each cell of side dx."""
        layout: Layout = solution.layout(dx, ppc, offset)
        return layout
