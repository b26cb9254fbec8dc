"""PIC: a particle takes the grid's velocity, v_p = sum N v_i, and so a mean of its neighbours at each step.

Source: Harlow 1964; see Brackbill & Ruppel 1986.
Conserves: linear momentum. Angular momentum and energy are lost: each step takes a share of order (h / wave length)^2,
and a given time 1/dt as much; at a fixed Courant number that is of order h, and so PIC converges with order one.
"""

from dataclasses import dataclass

from mpm_verify.solver.transfers._base import Transfer


@dataclass(frozen=True)
class Pic(Transfer):
    """No parameters."""
