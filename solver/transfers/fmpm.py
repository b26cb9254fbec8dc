"""FMPM(k): PIC with velocities from the full mass matrix, whose inverse is a series of k terms. FMPM(1) is PIC.

With v the lumped velocities after the equation of motion, S from nodes to particles and S+ the lumped map back,

    w = sum_{j<k} (I - A)^j v,   A = S+ S = m_i^-1 sum_p m_p N_ip N_jp;   w <- v + w - A w, k - 1 times
    v_p = S w,  x_p += dt S w,  L = sum w dN

The filter acts on the new velocities, accelerations included, and a held node has the wall's velocity after each term.
It acts too on those that the stress updates musl and usf map for their strain: without it F follows smoother velocities
than the positions do, and with usf the run fails. XPIC(k) filters what was there before the step.
Conserves: linear momentum, since sum m_i (A w)_i = sum m_i w_i. Angular momentum and energy fall, less with each
term: where A leaves the fraction a of a wave, a step of PIC keeps a of it and one of FMPM(k) 1 - (1 - a)^k.
The stable step of usl shrinks with k: dt w < sqrt(2 (a + 1/g)), g = (1 - (1 - a)^k) / a, with w the frequency of that
wave for lumped masses. In one dimension, two particles a cell, the shortest wave has a = 1/4 and w = 2 c/h, and dt c/h
is below 0.79 for k = 1, 0.64 for 2, 0.56 for 4, 0.51 for 8; FLIP, dt w < 2 / sqrt(2 - a), has 0.76.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from mpm_verify.solver.context import Context
from mpm_verify.solver.state import Floats
from mpm_verify.solver.transfers._base import Gradient, Transfer
from mpm_verify.solver.transfers._passes import collect, lumped, spread

HIGHEST = 100  # terms; each takes two passes over the particles


@dataclass(frozen=True)
class Fmpm(Transfer):
    """FMPM(k): velocities from the full mass matrix.

    Parameters
    ----------
    order
        Terms k of the series, a whole number from 1 to HIGHEST.

    Raises
    ------
    ValueError
        For another number of terms.

    References
    ----------
    Nairn & Hammerquist 2021, doi:10.1016/j.cma.2021.113667.
    Hammerquist & Nairn 2017, doi:10.1016/j.cma.2017.01.035, for XPIC(k).
    """

    order: float = 2
    filters_walls: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not (1 <= self.order <= HIGHEST and float(self.order).is_integer()):
            raise ValueError(f"order = {self.order} of FMPM must be a whole number from 1 to {HIGHEST}")

    def start(self, context: Context, L: Gradient | None = None) -> None:
        """Make room for what walls take."""
        context.walls.filtered = np.zeros(context.walls.held.shape)

    def filter(self, context: Context, velocity_acceleration: Floats) -> None:
        """Replace v by w; at held nodes v is the wall's velocity, and w - A w of the last term is what walls take."""
        v, w, walls = velocity_acceleration[:, :2].copy(), velocity_acceleration[:, :2], context.walls
        for _ in range(int(self.order) - 1):
            Aw = lumped(context, spread(context, collect(context, velocity_acceleration)[:, :2]))
            walls.filtered = np.where(walls.held, w - Aw, 0.0)
            w[:] = np.where(walls.held, v, v + w - Aw)
