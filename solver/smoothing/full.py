"""Smoothing of both parts. A mean over a cell of a convex set stays in it, so smoothed stresses stay admissible.

With beta = 1 and cells this is a reduced integration by one point: the hourglass velocity v_x ~ (x - x_c)(y - y_c) of a
cell has no smoothed strain and costs nothing. So the default leaves a tenth, and beta = 1 is not allowed.
"""

from dataclasses import dataclass
from typing import ClassVar

from mpm_verify.solver.smoothing._base import Smoothing


@dataclass(frozen=True)
class Full(Smoothing):
    """Smoothing of both parts; parameters as of Smoothing, beta below 1.

    Raises
    ------
    ValueError
        For beta = 1 too.
    """

    beta: float = 0.9
    volumetric: ClassVar[bool] = True
    deviatoric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.beta == 1:
            raise ValueError("beta = 1 must be below 1 with both parts: hourglass modes would have no strain at all")
