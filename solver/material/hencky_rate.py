"""Hencky solid in rate form: an objective rate of the Kirchhoff stress is lam tr(D) I + 2 mu D.

With the logarithmic rate it is the Hencky solid of solver/material/hencky.py, whose energy it states, and so are the
solutions that are manufactured for it: with another rate, or a wrong one, it is another solid, which has no energy. But
stress that is convected, F^-1 tau F^-T = mu (I - C^-1) for lam = 0, is neo-Hookean: that it states with Truesdell's.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.material.hencky import energy
from mpm_verify.solver.material.hypoelastic import respond
from mpm_verify.solver.material.neo_hookean import NeoHookean
from mpm_verify.solver.plugins import RATES, available
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class HenckyRate(RateMaterial, Elastic):
    """Hencky solid in rate form.

    Parameters
    ----------
    rate
        Objective rate, a file of solver/rates; of another than the logarithmic one the stress is no function of F.
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.

    Raises
    ------
    ValueError
        For a parameter that is out of range.

    References
    ----------
    Xiao, Bruhns & Meyers 1997, doi:10.1007/BF01213020, and doi:10.1023/A:1007356925912 for the solid.
    """

    respond = staticmethod(respond)
    kirchhoff: ClassVar[bool] = True
    rate: str = "logarithmic"

    def __post_init__(self) -> None:
        Elastic.__post_init__(self)
        RateMaterial.__post_init__(self)

    def constants(self) -> Floats:
        """Constants (2,): lam, mu."""
        return np.array([self.lam, self.mu])

    @property
    def convected(self) -> bool:
        """Whether it is the neo-Hookean solid, by the rate that convects stress and without a lateral strain."""
        return self.rate == "truesdell" and self.nu == 0

    @property
    def strays(self) -> bool:
        """Whether its rate has no energy; a negative control, or a rate of a user's file, claims to have it."""
        return self.rate in available(RATES) and self.rate != "logarithmic" and not self.convected

    def energy(self, F: Any, log: Callable[[Any], Any]) -> Any:
        """Energy W per initial volume that the right rate gives; F is 3 x 3, of numbers or symbols."""
        if self.convected:
            return NeoHookean(self.E, self.nu, self.rho0).energy(F, log)
        return energy(self.lam, self.mu, F, log)
