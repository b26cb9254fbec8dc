"""Hypoelastic solid, the linear elastic material of the paper's section 2.2: rate of sigma = lam tr(D) I + 2 mu D.

In uniaxial strain sigma = (lam + 2 mu) ln(stretch). It has no energy: no manufactured solution can be derived for it.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.objective import RESPOND
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats


@kernel(RESPOND)
def respond(constants, sigma, de, history):
    """Add lam tr(de) I + 2 mu de to sigma; constants lam, mu."""
    lam = constants[0]
    shear = 2.0 * constants[1]
    for b in range(sigma.shape[0] // 4):
        bulk = lam * (de[3 * b] + de[3 * b + 1])
        sigma[4 * b] += bulk + shear * de[3 * b]
        sigma[4 * b + 1] += bulk + shear * de[3 * b + 1]
        sigma[4 * b + 2] += bulk
        sigma[4 * b + 3] += shear * de[3 * b + 2]


@dataclass(frozen=True)
class Hypoelastic(RateMaterial, Elastic):
    """Hypoelastic solid, in rate form.

    Parameters
    ----------
    rate
        Objective rate, a file of solver/rates.
    E, nu, rho0
        Young's modulus and density above zero, Poisson's ratio between -1 and 0.5.

    Raises
    ------
    ValueError
        For a parameter that is out of range.
    """

    out_of_plane: ClassVar[Literal["", "trial", "plane"]] = "trial"
    respond = staticmethod(respond)

    def __post_init__(self) -> None:
        Elastic.__post_init__(self)
        RateMaterial.__post_init__(self)

    def constants(self) -> Floats:
        """Constants (2,): lam, mu."""
        return np.array([self.lam, self.mu])
