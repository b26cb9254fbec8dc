"""Truesdell rate: the stress is carried by F itself, as the second Piola stress J F^-1 sigma F^-T stays the same.

From the start to the middle of the step by A = Fm F0^-1, sigma <- A sigma A^T / det A, there the material with D dt,
then to the end by F1 Fm^-1. Stretch changes the stress too, and not only its axes: a material with a yield surface gets
a stress that has left it, elastically, by what the step stretches. So it is here to be compared with, not for soils.
"""

from typing import ClassVar

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.frames import push_stress, turned_strain
from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate


@kernel(inline=True)
def carry(b, sigma, Axx, Axy, Ayx, Ayy, Bxx, Bxy, Byx, Byy):
    """Write G sigma G^T / det G to sigma, G = B A^-1; zz / det G."""
    J = Axx * Ayy - Axy * Ayx
    per = 1.0 / J
    push_stress(
        b, sigma, (Bxx * Ayy - Bxy * Ayx) * per, (Bxy * Axx - Bxx * Axy) * per, (Byx * Ayy - Byy * Ayx) * per,
        (Byy * Axx - Byx * Axy) * per, J / (Bxx * Byy - Bxy * Byx),
    )  # fmt: skip


@kernel(UNROTATE)
def unrotate(F0, F1, sigma, de):
    """Carry sigma to the middle of the step, and write D dt to de."""
    for b in range(sigma.shape[0] // 4):
        xx, xy, yx, yy = F0[4 * b], F0[4 * b + 1], F0[4 * b + 2], F0[4 * b + 3]
        carry(
            b, sigma, xx, xy, yx, yy, 0.5 * (xx + F1[4 * b]), 0.5 * (xy + F1[4 * b + 1]), 0.5 * (yx + F1[4 * b + 2]),
            0.5 * (yy + F1[4 * b + 3]),
        )  # fmt: skip
        turned_strain(b, de, F0, F1, 1.0, 0.0)


@kernel(ROTATE)
def rotate(F0, F1, sigma):
    """Carry sigma from the middle of the step to its end."""
    for b in range(sigma.shape[0] // 4):
        xx, xy, yx, yy = F1[4 * b], F1[4 * b + 1], F1[4 * b + 2], F1[4 * b + 3]
        carry(
            b, sigma, 0.5 * (xx + F0[4 * b]), 0.5 * (xy + F0[4 * b + 1]), 0.5 * (yx + F0[4 * b + 2]),
            0.5 * (yy + F0[4 * b + 3]), xx, xy, yx, yy,
        )  # fmt: skip


class Truesdell(Rate):
    """Truesdell rate: the stress is convected by F."""

    order: ClassVar[float] = 2.0
    convects: ClassVar[bool] = True
    unrotate = staticmethod(unrotate)
    rotate = staticmethod(rotate)
