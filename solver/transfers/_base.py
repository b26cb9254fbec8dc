"""What a transfer is: the share of FLIP in a particle's velocity, and the places in the step where it may do more.

All of them conserve linear momentum: the shape values of a particle sum to one, and their gradients to zero.
"""

from collections.abc import Callable
from typing import ClassVar

from mpm_verify.solver.context import Context
from mpm_verify.solver.state import Floats

Gradient = Callable[[Floats], Floats]


class Transfer:
    """Between particles and grid. A subclass is a frozen dataclass of its parameters; this one does no more."""

    share: float = 0.0  # of FLIP: particles take the grid's acceleration; the rest is its velocity
    filters_walls: ClassVar[bool] = False  # what walls give is filtered too: the momentum they gave is not known

    def start(self, context: Context, L: Gradient | None = None) -> None:
        """State of its own for a body whose velocity gradient is L(X) (P,2,2); none means that it is not known."""

    def give(self, context: Context, momentum: Floats) -> None:
        """Add to the first two columns of `momentum` (n,4) what the particles' velocities do not tell."""

    def filter(self, context: Context, velocity_acceleration: Floats) -> None:
        """Make of lumped velocities, the first columns of `velocity_acceleration` (n,4), those that move and strain
        the particles."""

    def take(self, context: Context) -> None:
        """Take from the grid's new velocities what particles keep besides v."""
