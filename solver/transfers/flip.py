"""FLIP: a particle keeps its velocity and takes the grid's acceleration, v_p += dt sum N a_i; a share may be PIC.

    v_p <- s (v_p + dt sum N a_i) + (1 - s) sum N v_i        s = share;  flip:share=0.95 takes 5 % of PIC

Both move x_p with sum N v_i. Source: Brackbill & Ruppel 1986; the blend: Zhu & Bridson 2005.
Conserves: linear momentum. Angular momentum nearly, some percent a turn: sum m x_p x N a_i is not the torque at the
nodes, and a particle does not move with its own velocity. Energy with the stress orders musl and usf, for as long as
no particle crosses a cell; with usl short waves are damped, in proportion to dt. A blend adds the losses of PIC in its
share of each step, so that they grow as dt shrinks.
"""

from dataclasses import dataclass

from mpm_verify.solver.transfers._base import Transfer


@dataclass(frozen=True)
class Flip(Transfer):
    """`share`: of FLIP in the particle velocity, above 0 up to 1; none at all is PIC. Raises ValueError otherwise."""

    share: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.share <= 1.0:
            raise ValueError(f"share = {self.share} of FLIP must lie above 0 and up to 1; 0 is the transfer pic")
