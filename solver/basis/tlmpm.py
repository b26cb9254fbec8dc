"""Total Lagrangian MPM: hat functions at the reference position, so no particle ever crosses a cell.

Weights and reference gradients dN0 are those of X, step after step. The gradients are pushed forward, dN = F^-T dN0,
and with V = J V0 the kernels of every method then give the force of the first Piola-Kirchhoff stress, P = J sigma F^-T,
and the rate of F of the reference gradient of v:

    f_i = -sum V sigma dN_i = -sum V0 P dN0_i        L F = (sum v_i dN_i^T) F = sum v_i dN0_i^T

The nodes are material points, which stand in the reference configuration for ever: masses do not change, no body meets
another, and a wall holds the edge of the body that was there at first. Order 2, large deformation included.
Source: de Vaucorbeil, Nguyen & Hutchinson 2020.
"""

from typing import ClassVar

import numpy as np

from mpm_verify.solver._jit import BLOCK, kernel
from mpm_verify.solver.basis.mpm import fill as hats
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.state import Floats
from mpm_verify.solver.weights import FILL, Basis, Position, Promise

B = BLOCK


@kernel(inline=True)
def push_forward(F, table):
    """Replace reference gradients dN0 of four nodes a particle by F^-T dN0."""
    for b in range(F.shape[0] // 4):
        xx = F[4 * b]
        xy = F[4 * b + 1]
        yx = F[4 * b + 2]
        yy = F[4 * b + 3]
        per_J = 1.0 / (xx * yy - xy * yx)
        for k in range(4):
            gx = table[(4 + k) * B + b] * per_J
            gy = table[(8 + k) * B + b] * per_J
            table[(4 + k) * B + b] = yy * gx - yx * gy
            table[(8 + k) * B + b] = xx * gy - xy * gx


@kernel(FILL)
def fill(x, F, X, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node):
    """Write N and dN of the four nodes of the cell that holds X, for any finite x; see solver/weights.py."""
    inside = hats(X, F, X, ox, oy, inv_dx, nx, ny, x0, x1, y0, y1, table, node)
    push_forward(F, table)
    bad = 0
    for a in range(x.shape[0]):
        bad += int(not (abs(x[a]) < np.inf))
    return inside and bad == 0


class Tlmpm(Basis):
    """Total Lagrangian MPM: four support nodes, order 2.

    References
    ----------
    de Vaucorbeil, Nguyen & Hutchinson 2020, doi:10.1016/j.cma.2019.112783.
    """

    support: ClassVar[int] = 4
    order: ClassVar[float] = 2.0
    fill = staticmethod(fill)
    domain_size: ClassVar[int] = 2
    reference: ClassVar[bool] = True

    @classmethod
    def promises(cls, crossing: bool) -> Promise:
        """Order of u, the same whether or not particles would cross cells."""
        return Promise(cls.order, source="de Vaucorbeil, Nguyen & Hutchinson 2020")

    @staticmethod
    def domain(layout: Layout, position: Position) -> Floats:
        """Reference positions (P,2), which stay."""
        return layout.X.copy()
