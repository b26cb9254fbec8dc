"""F-bar: the material sees F with the projected volume ratio of the step, (dJ_mean/dJ)^(1/2) F, exponent of the plane.

For comparison with volumetric smoothing, whose finite form it is: of the rate alone. A function of F sees F with the
projection of J itself, (J_mean/J)^(1/2) F: no particle has an F-bar of its own that it takes from cell to cell.
"""

from dataclasses import dataclass

import numpy as np

from mpm_verify.solver.context import Context
from mpm_verify.solver.smoothing._base import Of, Smoothing, Where
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Fbar(Smoothing):
    """F-bar; parameters as of Smoothing, volume ratios through nodes by default.

    Raises
    ------
    ValueError
        Unless of=rate.

    References
    ----------
    de Souza Neto, Peric, Dutko & Owen 1996, doi:10.1016/0020-7683(95)00259-6, for the volume ratio itself.
    Coombs, Charlton, Cortis & Augarde 2018, doi:10.1016/j.cma.2018.01.010, for the stress from F-bar.
    Zhao, Jiang & Choo, Comput. Methods Appl. Mech. Eng. 402 (2022) 115255, for volume ratios through nodes.
    """

    of: Of = "rate"
    where: Where = "node"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.of != "rate":
            raise ValueError(f"of = {self.of!r} must be rate: F-bar leaves the stress as the material gives it")

    def strain(self, context: Context, x: Floats) -> Floats:
        """F (P,2,2) with the mean volume ratio of the step, or of all steps for a function of F."""
        p = context.particles
        if context.material.rate is None:
            return self.bar(context)
        ratio = np.linalg.det(p.F) / np.linalg.det(p.F_old.reshape(-1, 2, 2))
        mean = self.project(context, x, ratio[:, None])[:, 0]
        F_smoothed: Floats = ((1 + self.beta * (mean / ratio - 1)) ** 0.5)[:, None, None] * p.F
        return F_smoothed
