"""FLIP: a particle keeps its velocity and takes the grid's acceleration, v_p += dt sum N a_i; a fraction may be PIC.

    v_p <- f (v_p + dt sum N a_i) + (1 - f) sum N v_i        f = fraction;  flip:fraction=0.95 takes 5 % of PIC

Both move x_p with sum N v_i.
Conserves: linear momentum. Angular momentum nearly, some percent a turn: sum m x_p x N a_i is not the torque at the
nodes, and a particle does not move with its own velocity. Energy with the stress updates musl and usf, for as long as
no particle crosses a cell; with usl short waves are damped, in proportion to dt. A blend adds the losses of PIC to each
step by its fraction, so that they grow as dt shrinks.
"""

from dataclasses import dataclass

from mpm_verify.solver.transfers._base import Transfer


@dataclass(frozen=True)
class Flip(Transfer):
    """FLIP, or a blend of FLIP and PIC.

    Parameters
    ----------
    fraction
        Fraction of FLIP in the particle velocity, above 0 and up to 1; none at all is PIC.

    Raises
    ------
    ValueError
        For another fraction.

    References
    ----------
    Brackbill & Ruppel 1986, doi:10.1016/0021-9991(86)90211-1.
    Zhu & Bridson 2005, doi:10.1145/1073204.1073298, for the blend.
    """

    fraction: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.fraction <= 1.0:
            raise ValueError(f"fraction = {self.fraction} of FLIP must lie above 0 and up to 1; 0 is the transfer pic")

    @property
    def flip_fraction(self) -> float:
        """Fraction of FLIP, as it is given."""
        return self.fraction
