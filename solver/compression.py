"""Volume strain that stress holds in compression, its inverse and its energy: what pooling moves between particles.

Three kinds: of a constant bulk modulus, and of moduli that are one power of the mean stress s in the plane, or two, as
those of UBCSAND with ne = me or another. Compression is positive here; in tension it is negative.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss

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


POINTS = 16  # of Gauss-Legendre in ln s: to 1e-9 or better up to 100 kPa, 1e-14 where powers are 0.5 apart
CLOSE = 1e-14  # of ln s


@kernel(inline=True)
def slope_of(constants, s):
    """Modulus of two powers at s."""
    return constants[0] * s ** constants[1] + constants[2] * s ** constants[3]


@kernel(inline=True)
def integral(constants, s, power):
    """Integral of s^power ds / modulus from `least` to s, in ln s."""
    least = constants[4]
    half = 0.5 * np.log(s / least)
    total = 0.0
    for k in range(POINTS):
        at = least * np.exp(half * (1.0 + constants[5 + k]))
        total += constants[5 + POINTS + k] * at ** (1.0 + power) / slope_of(constants, at)
    return half * total


@kernel(VOLUME)
def sum_volume(constants, xx, yy, zz):
    """Integral of ds / modulus from no stress on; below `least` the modulus is that of `least`."""
    least, s = constants[4], -0.5 * (xx + yy)
    first = slope_of(constants, least)
    return least / first + integral(constants, s, 0.0) if s > least else s / first


@kernel(f8(F1, f8))
def sum_stress(constants, strain):
    """Inverse of sum_volume: Newton's steps for ln s over ln strain, which is concave, from below."""
    least = constants[4]
    first = slope_of(constants, least)
    s = strain * first
    if not s > least:
        return s
    for _ in range(60):
        volume = least / first + integral(constants, s, 0.0)
        step = np.log(strain / volume) * volume * slope_of(constants, s) / s
        s *= np.exp(step)
        if abs(step) < CLOSE:
            break
    return s


@kernel(SCALE)
def sum_scale(constants, old, new):
    """Ratio of the mean stresses."""
    return sum_stress(constants, new) / sum_stress(constants, old)


@kernel(STORED)
def sum_stored(constants, xx, yy, zz, xy):
    """Integral of s over the strain of sum_volume."""
    least, s = constants[4], -0.5 * (xx + yy)
    first = slope_of(constants, least)
    return 0.5 * least * least / first + integral(constants, s, 1.0) if s > least else 0.5 * s * s / first


def by_two_powers(bulk: float, of_bulk: float, shear: float, of_shear: float, least: float) -> Compression:
    """Compression of a modulus bulk s^of_bulk + shear s^of_shear, s at least `least`, powers from 0 to 1."""
    constants = np.array([bulk, of_bulk, shear, of_shear, least, *np.concatenate(leggauss(POINTS))])
    return Compression(constants, sum_volume, sum_scale, sum_stored)
