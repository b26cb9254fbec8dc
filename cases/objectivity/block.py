"""Turning block held against its closed form, its inertial fraction, and every negative control on the same run."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.harness.checks import Check, Curves
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.exact import ramped_column, rotated
from mpm_verify.solver.failure import Failure
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, available
from mpm_verify.solver.state import Floats

PRINTED, SMALL, REST = "block of 1 m", "block of 1 cm", "block of 1 m, not turned"
GROUP = "Figure 2, the CPDI run"
Found = Mapping[str, tuple[Curves, Failure | None]]


def blocks(block: Block) -> dict[str, Block]:
    """Runs by name: as printed, a hundredth of it, the inertial forces alone, and each negative control."""
    named = {PRINTED: block, SMALL: replace(block, L=block.L / 100), REST: replace(block, frame=True)}
    return named | {name: replace(block, rate=name) for name in available(NEGATIVE_CONTROLS)}


def turning(curve: Mapping[str, Floats]) -> NDArray[np.bool_]:
    """Mask of the samples of the turn."""
    late: NDArray[np.bool_] = curve["t"] > 1.0 + 1e-9
    return late


def misses(curve: Mapping[str, Floats], block: Block) -> Floats:
    """Distance of the mean stress from the closed form at each sample of the turn, largest component."""
    late = turning(curve)
    K0 = block.nu / (1 - block.nu)
    exact = rotated(-K0, -1.0, curve["angle"][late])
    mean = np.stack([curve[name][late] for name in ("xx", "yy", "xy")], axis=1)
    found: Floats = np.abs(mean - exact).max(axis=1)
    return found


def checks(block: Block, found: Found) -> list[Check]:
    """Checks of the runs; stresses in units of the mean vertical stress at the end of the ramp."""
    ended = {name: found[name][1] for name in (PRINTED, SMALL, REST) if found[name][1]}
    if ended:
        return [Check(GROUP, name, np.nan, 0.0, "absolute", "", failure=why) for name, why in ended.items()]
    small, large, rest = (found[name][0]["mean"] for name in (SMALL, PRINTED, REST))
    late = turning(small)
    K0 = block.nu / (1 - block.nu)
    end = int(np.argmin(np.abs(small["t"] - 1.0)))
    peak = (1 - K0) / 2
    ramp = large["t"] <= 1.0
    wave = ramped_column(large["t"][ramp], block.material.wave_speed(), block.L)
    ripple = float(np.sqrt(((large["yy"][ramp] - wave) ** 2).mean()))
    static, closed = "static equilibrium", "closed form, stress turned with the block"
    away = np.array([large["own_yy"][turning(large)].mean() + 1, rest["own_yy"][turning(rest)].mean() + 1])
    shear = float(np.sqrt((small["own_xy"][late] ** 2).mean()))
    return [
        Check(GROUP, "1 cm: vertical stress at the end of the ramp", small["yy"][end], -1.0, "absolute", static, 0.005),
        Check(GROUP, "1 cm: horizontal stress there", small["xx"][end], -K0, "absolute", static, 0.005),
        Check(GROUP, "1 cm: largest distance in the turn", misses(small, block).max(), 0.01, "at most", closed),
        Check(GROUP, "1 cm: largest shear stress", small["xy"].max(), peak, "absolute", closed, 0.005),
        Check(GROUP, "1 cm: horizontal stress after 90 degrees", small["xx"][-1], -1.0, "absolute", closed, 0.01),
        Check(GROUP, "1 cm: vertical stress after 90 degrees", small["yy"][-1], -K0, "absolute", closed, 0.01),
        Check(GROUP, "1 cm: co-rotated shear stress, rms over time", shear, 0.005, "at most", "zero by symmetry"),
        Check(GROUP, "1 m: vertical stress in the ramp, rms distance", ripple, 0.003, "at most",
              "linear waves in a column under growing gravity"),
        Check(GROUP, "1 m: inertial fraction of the mean vertical stress", away[0], away[1], "absolute",
              "the same box at rest, with inertial forces", 0.003),
        Check(GROUP, "1 m: largest distance in the turn", misses(large, block).max(), misses(small, block).max(),
              "at least", "inertia and waves of the large block alone"),
    ]  # fmt: skip
