"""Volume strain that stress holds in compression, its inverse and its energy: what pooling moves between particles.

Two kinds: of a constant bulk modulus, and of moduli that are one power of the mean stress s in the plane, as those of
UBCSAND with ne = me. Compression is positive here; in tension it is negative.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.solver._jit import F1, F2, Function, f8, function_type, kernel, nothing
from mpm_verify.solver.state import Floats

VOLUME, SCALE, STORED = f8(F1, f8, f8, f8), f8(F1, f8, f8), f8(F1, f8, f8, f8, f8)


@dataclass(frozen=True)
class Compression:
    """Compression of one material.

    Parameters
    ----------
    constants
        Constants (k,) that the kernels read.
    volume
        ``volume(constants, xx, yy, zz)``: elastic volume strain, compression positive.
    scale
        ``scale(constants, old, new)``: factor of the stress that changes this strain from old to new.
    stored
        ``stored(constants, xx, yy, zz, xy)``: elastic energy per volume; of a material that has none as a whole, that
        of the volume alone.
    """

    constants: Floats
    volume: Function
    scale: Function
    stored: Function

    def held(self, sigma: Floats) -> Floats:
        """Elastic volume strain (P,) under sigma (P,4), compression positive."""
        found = np.empty(len(sigma))
        held(self.volume, self.constants, sigma, found)
        return found


@kernel(nothing(function_type(VOLUME), F1, F2, F1))
def held(volume, constants, sigma, out):
    """Write the elastic volume strain (P,) under sigma (P,4)."""
    for p in range(sigma.shape[0]):
        out[p] = volume(constants, sigma[p, 0], sigma[p, 1], sigma[p, 2])


@kernel(VOLUME)
def linear_volume(constants, xx, yy, zz):
    """Trace over three times the bulk modulus, compression positive."""
    return -constants[0] * (xx + yy + zz)


@kernel(SCALE)
def linear_scale(constants, old, new):
    """Stress follows strain."""
    return new / old


@kernel(STORED)
def linear_stored(constants, xx, yy, zz, xy):
    """Energy of linear elasticity, as Elastic.stored_energy has it."""
    trace = xx + yy + zz
    return constants[1] * (xx * xx + yy * yy + zz * zz + 2.0 * xy * xy - constants[2] * trace * trace)


def linear(solid: Any) -> Compression:
    """Compression of a material of constant E and nu."""
    constants = np.array([(1 - 2 * solid.nu) / solid.E, 1 / (4 * solid.mu), solid.nu / (1 + solid.nu)])
    return Compression(constants, linear_volume, linear_scale, linear_stored)


@kernel(VOLUME)
def power_volume(constants, xx, yy, zz):
    """Integral of ds / (stiff max(s, least)^power), from no stress on; s = -(xx + yy)/2 of the plane."""
    stiff, power, least = constants[0], constants[1], constants[2]
    s = -0.5 * (xx + yy)
    slope = stiff * least**power
    if not s > least:
        return s / slope
    if power == 1.0:
        return least / slope + np.log(s / least) / stiff
    return least / slope + (s ** (1.0 - power) - least ** (1.0 - power)) / ((1.0 - power) * stiff)


@kernel(inline=True)
def mean_stress(constants, strain):
    """Inverse of power_volume."""
    stiff, power, least = constants[0], constants[1], constants[2]
    slope = stiff * least**power
    beyond = strain - least / slope
    if not beyond > 0.0:
        return strain * slope
    if power == 1.0:
        return least * np.exp(stiff * beyond)
    return (least ** (1.0 - power) + (1.0 - power) * stiff * beyond) ** (1.0 / (1.0 - power))


@kernel(SCALE)
def power_scale(constants, old, new):
    """Ratio of the mean stresses."""
    return mean_stress(constants, new) / mean_stress(constants, old)


@kernel(STORED)
def power_stored(constants, xx, yy, zz, xy):
    """Integral of s over the strain of power_volume."""
    stiff, power, least = constants[0], constants[1], constants[2]
    s = -0.5 * (xx + yy)
    slope = stiff * least**power
    if not s > least:
        return 0.5 * s * s / slope
    return 0.5 * least * least / slope + (s ** (2.0 - power) - least ** (2.0 - power)) / ((2.0 - power) * stiff)


def by_power(stiff: float, power: float, least: float) -> Compression:
    """Compression of a modulus ds/d(volume) = stiff max(s, least)^power, 0 <= power <= 1."""
    return Compression(np.array([stiff, power, least]), power_volume, power_scale, power_stored)
