"""PIC: a particle takes the grid's velocity, v_p = sum N v_i, and so a mean over the particles around it at each step.

Conserves: linear momentum. Angular momentum and energy fall: each step takes a fraction of order (h / wave length)^2,
and a given time 1/dt as much; at a fixed Courant number that is of order h, and so PIC converges with order one.
"""

from dataclasses import dataclass

from mpm_verify.solver.transfers._base import Transfer


@dataclass(frozen=True)
class Pic(Transfer):
    """PIC, the particle-in-cell method; no parameters.

    References
    ----------
    Harlow 1964; see Brackbill & Ruppel 1986, doi:10.1016/0021-9991(86)90211-1.
    """
