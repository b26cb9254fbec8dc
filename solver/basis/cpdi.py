"""CPDI: hat functions averaged over a parallelogram that deforms with the particle.

The field is interpolated bilinearly from the four corners x + (-r1-r2, r1-r2, r1+r2, -r1+r2), r_i = F r0_i. So
N = 1/4 sum S(corner), and dN is the exact mean gradient of that interpolation over the domain. It is written from the
corners, because the literature holds both half and full side vectors. Order 2, large deformation included.
Source: Sadeghirad, Brannon & Burghardt 2011; paper eqs. (2), (3). The paper leaves the gradient weights out; they are
edge integrals of the interpolation, divided by the area.

With cpdi:limit=1 no half diagonal r1 +- r2 is longer than one cell: longer ones are cut to it, each in its direction
(Homel, Brannon & Guilkey 2016). Without it, domains of a flow grow beyond the next ones and tie together what has
parted; with it, they part. The volume of the particle stays J V0, and is the area of its domain no longer.
"""

from dataclasses import dataclass, replace
from math import inf
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.basis._parallelogram import half_sides, parallelogram, passed
from mpm_verify.solver.layout import Layout, parallelograms
from mpm_verify.solver.state import Floats
from mpm_verify.solver.weights import FILL, Basis, Position, Promise


@kernel(FILL)
def fill(x, F, r0, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the four nodes around each corner, sixteen in all; see solver/weights.py."""
    bad = 0
    for b in range(x.shape[0] // 2):
        r1x, r1y, r2x, r2y = half_sides(b, 4 * b, F, r0)
        bad += passed(b, x, r1x, r1y, r2x, r2y, ox, oy, inv_dx, x0, x1, y0, y1)
        parallelogram(b, x, r1x, r1y, r2x, r2y, ox, oy, inv_dx, ny, table, node)
    return bad == 0


@dataclass(frozen=True)
class Cpdi(Basis):
    """CPDI: sixteen support nodes, order 2.

    Parameters
    ----------
    limit
        Longest half diagonal of a domain, in cells, above zero.

    Raises
    ------
    ValueError
        For another limit.

    References
    ----------
    Sadeghirad, Brannon & Burghardt 2011, doi:10.1002/nme.3110.
    Homel, Brannon & Guilkey 2016, doi:10.1002/nme.5151, for the limit.
    """

    limit: float = inf
    support: ClassVar[int] = 16
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    domain_size: ClassVar[int] = 4
    domain_motion: ClassVar[str] = "deformed"
    faces_carry: ClassVar[bool] = True
    has_limit: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not self.limit > 0:
            raise ValueError(f"limit = {self.limit} must be above zero: half a diagonal of a domain, in cells")
        if self.limit < inf:
            from mpm_verify.solver.basis._cpdi_limited import fill_limited  # takes two seconds to compile

            object.__setattr__(self, "fill", fill_limited)
            object.__setattr__(self, "domain_size", 5)

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Order of u, the same when particles cross cells."""
        return Promise(cls.order, source="Sadeghirad, Brannon & Burghardt 2011")

    def limited(self, limit: float) -> "Cpdi":
        """Basis with half diagonals no longer than `limit`, in cells; itself if it has a limit."""
        return self if self.limit < inf else replace(self, limit=limit)

    def domain(self, layout: Layout, position: Position) -> Floats:
        """Initial half side vectors r0 (P,4), which F moves; with a limit (P,5), that too."""
        r0 = layout.r0.reshape(-1, 4).copy()
        return r0 if self.limit == inf else np.column_stack([r0, np.full(len(r0), self.limit)])

    @staticmethod
    def corners(x: Floats, F: Floats, domain: Floats, dx: float) -> Floats:
        """Corners (P,4,2) x - r1 - r2 and so on, r = F r0, cut where there is a limit."""
        r = np.einsum("pab,psb->psa", F, domain[:, :4].reshape(-1, 2, 2))
        if domain.shape[1] == 5:
            half = np.stack([r[:, 0] + r[:, 1], r[:, 0] - r[:, 1]], axis=1)
            half *= np.minimum(1.0, dx * domain[:, 4:] / np.linalg.norm(half, axis=2))[:, :, None]
            r = np.stack([half[:, 0] + half[:, 1], half[:, 0] - half[:, 1]], axis=1) / 2
        return parallelograms(x, r)

    @staticmethod
    def cut(F: Floats, domain: Floats, dx: float) -> NDArray[np.bool_]:
        """Whether a half diagonal is longer than the limit (P,)."""
        r0 = domain[:, :4].reshape(-1, 2, 2)
        one, other = r0[:, 0] + r0[:, 1], r0[:, 0] - r0[:, 1]
        longest = np.maximum(*(np.hypot(*(F[:, :, 0].T * d[:, 0] + F[:, :, 1].T * d[:, 1])) for d in (one, other)))
        too_long: NDArray[np.bool_] = longest > (dx * domain[:, 4] if domain.shape[1] == 5 else inf)
        return too_long
