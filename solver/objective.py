"""Objective integration of materials in rate form: the stress goes along with the motion, the material sees strain.

A *rate* (solver/rates) is two kernels over the flat arrays of a block. `unrotate(F0, F1, sigma, de)` brings the Cauchy
stress at the start of the step into the frame of the material, in place, and writes the strain increment D dt in that
frame; `rotate(F0, F1, sigma)` brings the stress that the material gives to the end of the step. The *material* is one
kernel in between, `respond(constants, sigma, de, history)`. F0, F1: xx, xy, yx, yy; sigma: xx, yy, zz, xy; de: xx, yy,
xy (of the tensor).

Strain increments are those of the middle of the step, L dt = (F1 - F0) ((F0 + F1)/2)^-1: second order, and without
strain in a rigid rotation of any angle. With F0 in place of the mean a rotation by a strains by -a^2/2 a step.
"""

from typing import ClassVar

import numpy as np
from numba import prange

from mpm_verify.solver._jit import BLOCK, F1, F2, F3, Function, function_type, kernel, nothing

UNROTATE, ROTATE, RESPOND = nothing(F1, F1, F1, F1), nothing(F1, F1, F1), nothing(F1, F1, F1, F1)
SIGNATURE = nothing(function_type(UNROTATE), function_type(ROTATE), function_type(RESPOND), F1, F2, F3, F3, F2, F2, F2)


class Rate:
    """Objective rate: how stress goes along with the motion.

    Attributes
    ----------
    order
        Order in time of the stress, 0 if it does not converge.
    convects
        Whether it carries the stress by F, and divides it by the change of volume.
    unrotate, rotate
        Kernels of signatures UNROTATE and ROTATE.
    """

    order: ClassVar[float]
    convects: ClassVar[bool] = False
    unrotate: ClassVar[Function]
    rotate: ClassVar[Function]


@kernel(nothing(function_type(UNROTATE), function_type(ROTATE), function_type(RESPOND), *[F1] * 8))
def integrate_block(unrotate, rotate, respond, constants, F_old, F_smoothed, F, sigma, history, work, de):
    """Integrate one step of a block, all arrays flat; F becomes F_old of the next."""
    unrotate(F_old, F_smoothed, sigma, de)
    first = sigma.copy()
    asked = de.copy()  # a material may take from the strain increment what it gives no stress for
    respond(constants, sigma, de, history)
    for b in range(work.shape[0] // 2):
        J = 0.5 * (F_old[4 * b] * F_old[4 * b + 3] - F_old[4 * b + 1] * F_old[4 * b + 2])
        J += 0.5 * (F[4 * b] * F[4 * b + 3] - F[4 * b + 1] * F[4 * b + 2])
        xx, yy, xy = J * asked[3 * b], J * asked[3 * b + 1], 2.0 * J * asked[3 * b + 2]
        work[2 * b] += first[4 * b] * xx + first[4 * b + 1] * yy + first[4 * b + 3] * xy
        work[2 * b + 1] += sigma[4 * b] * xx + sigma[4 * b + 1] * yy + sigma[4 * b + 3] * xy
    rotate(F_old, F, sigma)
    for a in range(F.shape[0]):
        F_old[a] = F[a]


@kernel(SIGNATURE, parallel=True)
def integrate(unrotate, rotate, respond, constants, F_old, F_smoothed, F, sigma, history, work):
    """Integrate one step of all particles, from F_old (P,4) to F (P,2,2): sigma (P,4), history (P,H), work (P,2).

    The strain is that of the way from F_old to `F_smoothed` (P,2,2), which is F where nothing smooths it. Work is per
    reference volume, of the stress at the start and at the end of the step; that of the material is the mean.
    """
    count = F.shape[0]
    memory = history.shape[1]
    olds = F_old.reshape(-1)
    smoothed = F_smoothed.reshape(-1)
    Fs = F.reshape(-1)
    sigmas = sigma.reshape(-1)
    histories = history.reshape(-1)
    works = work.reshape(-1)
    for block in prange((count + BLOCK - 1) // BLOCK):
        lo = block * BLOCK
        hi = min(lo + BLOCK, count)
        de = np.empty(3 * BLOCK)
        integrate_block(
            unrotate, rotate, respond, constants, olds[4 * lo : 4 * hi], smoothed[4 * lo : 4 * hi], Fs[4 * lo : 4 * hi],
            sigmas[4 * lo : 4 * hi], histories[memory * lo : memory * hi], works[2 * lo : 2 * hi],
            de[: 3 * (hi - lo)],
        )  # fmt: skip
