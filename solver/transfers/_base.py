"""Contract of a transfer: the fraction of FLIP in a particle's velocity, and the parts of a step where it may do more.

All of them conserve linear momentum: the shape values of a particle sum to one, and their gradients to zero.
"""

from collections.abc import Callable
from typing import ClassVar

from mpm_verify.solver.context import Context
from mpm_verify.solver.state import Floats

Gradient = Callable[[Floats], Floats]


class Transfer:
    """Transfer of velocities between particles and grid; a subclass is a frozen dataclass of its parameters.

    This one has the fraction of FLIP alone.

    Attributes
    ----------
    filters_walls
        Whether what walls give is filtered too: then the reaction of walls is not known when it is taken.
    """

    filters_walls: ClassVar[bool] = False

    @property
    def filters(self) -> bool:
        """Whether the velocities that move the particles are others than those of the equation of motion."""
        return type(self).filter is not Transfer.filter

    @property
    def flip_fraction(self) -> float:
        """Fraction of FLIP: particles take the grid's acceleration; the rest is PIC, the grid's velocity."""
        return 0.0

    def start(self, context: Context, L: Gradient | None = None) -> None:
        """Write what the particles keep besides v, at the start of a run.

        Parameters
        ----------
        context
            Body on its grid.
        L
            Velocity gradient (P,2,2) as a function of X (P,2), by x, or by X of a basis of reference positions; None
            where it is not known.
        """

    def give(self, context: Context, momentum: Floats) -> None:
        """Add to the first two columns of `momentum` (n,4) what the particles' velocities do not tell."""

    def filter(self, context: Context, velocity_acceleration: Floats) -> None:
        """Replace lumped velocities, the first columns (n,4), by those that move and strain the particles.

        What walls take from the velocities of nodes that they hold belongs in `context.walls.filtered` (n,2).
        """

    def take(self, context: Context) -> None:
        """Take from the grid's new velocities what particles keep besides v."""
