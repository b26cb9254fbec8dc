"""Fourth powers of sines on a free body: what bumps of any dimension have in common."""

from dataclasses import dataclass
from math import pi, sqrt
from typing import ClassVar

from mpm_verify.mms.square import Square


@dataclass(frozen=True)
class Bumped(Square):
    """Body of side L with a bump of amplitude A (a length) in its middle, free all around.

    Attributes
    ----------
    gradients
        Sum of the largest derivatives of u, over that of the bump: it bounds F - I.

    Raises
    ------
    ValueError
        For an amplitude with which F could be singular.
    """

    A: float = 1e-6
    boundary: ClassVar[str] = "free"
    gradients: ClassVar[int] = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        steepest = 4 * pi * sqrt(27 / 256) / self.L  # largest derivative of the fourth power, on the lines of symmetry
        self.limit("A", self.A, 1 / (self.gradients * steepest))

    @property
    def margin(self) -> float:
        """Distance by which the grid is wider than the body: one cell where four cover it."""
        return 0.25 * self.L

    @property
    def amplitude(self) -> float:
        """Amplitude over the side."""
        return abs(self.A) / self.L
