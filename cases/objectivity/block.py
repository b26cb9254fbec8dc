"""Turning block held against its closed form, its inertial fraction, and every negative control on the same run."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.study import ResultRecord
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.exact import ramped_column, rotated
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, available
from mpm_verify.solver.state import Floats

PRINTED, SMALL, REST = "block of 1 m", "block of 1 cm", "block of 1 m, not turned"
GROUP = "Figure 2, the CPDI run"
SETTLED = 8  # cells along the block that the bounds are made for; with fewer the grid's error grows as h^2
Results = Mapping[str, ResultRecord[Block]]


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


def numbers(block: Block, mean: Mapping[str, Floats]) -> dict[str, float]:
    """Numbers of a run that came to its end, by which it is checked and told; stresses in units of |sigma_v|.

    `xx_ramp`, `yy_ramp` at the end of the ramp, `xx_end`, `yy_end` at that of the turn; `miss` of the closed form,
    largest in the turn; `peak` of the shear stress; `ripple` about linear waves in the ramp, rms; in the turn `own_yy`
    beyond its static value, mean, `own_xy` rms, its `early` and `late` largest in the first and last quarter, and
    `particle`, the largest of any particle.
    """
    late, ramp = turning(mean), mean["t"] <= 1.0
    end = int(np.argmin(np.abs(mean["t"] - 1.0)))
    wave = ramped_column(mean["t"][ramp], block.material.wave_speed(), block.L)
    own = np.abs(mean["own_xy"][late])
    quarter = max(1, len(own) // 4)
    found = {
        "xx_ramp": mean["xx"][end],
        "yy_ramp": mean["yy"][end],
        "xx_end": mean["xx"][-1],
        "yy_end": mean["yy"][-1],
        "miss": misses(mean, block).max(),
        "peak": mean["xy"].max(),
        "ripple": np.sqrt(((mean["yy"][ramp] - wave) ** 2).mean()),
        "own_yy": mean["own_yy"][late].mean() + 1,
        "own_xy": np.sqrt((mean["own_xy"][late] ** 2).mean()),
        "early": own[:quarter].max(),
        "late": own[-quarter:].max(),
        "particle": mean["shear"][late].max(),
    }
    return {name: float(value) for name, value in found.items()}


def checks(block: Block, results: Results) -> list[Check]:
    """Checks of the runs; stresses in units of the mean vertical stress at the end of the ramp."""
    ended = {name: results[name].failure for name in (PRINTED, SMALL, REST) if results[name].failure}
    if ended:
        return [Check(GROUP, name, np.nan, 0.0, "absolute", "", failure=why) for name, why in ended.items()]
    small, large, rest = (results[name].values for name in (SMALL, PRINTED, REST))
    K0, grid = block.nu / (1 - block.nu), max(1.0, (SETTLED / block.cells) ** 2)
    near, far, low = 0.005 * grid, 0.01 * grid, 0.003 * grid
    static, closed = "static equilibrium", "closed form, stress turned with the block"
    return [
        Check(GROUP, "1 cm: vertical stress at the end of the ramp", small["yy_ramp"], -1.0, "absolute", static, near),
        Check(GROUP, "1 cm: horizontal stress there", small["xx_ramp"], -K0, "absolute", static, near),
        Check(GROUP, "1 cm: largest distance in the turn", small["miss"], far, "at_most", closed),
        Check(GROUP, "1 cm: largest shear stress", small["peak"], (1 - K0) / 2, "absolute", closed, near),
        Check(GROUP, "1 cm: horizontal stress after 90 degrees", small["xx_end"], -1.0, "absolute", closed, far),
        Check(GROUP, "1 cm: vertical stress after 90 degrees", small["yy_end"], -K0, "absolute", closed, far),
        Check(GROUP, "1 cm: co-rotated shear stress, rms over time", small["own_xy"], near, "at_most",
              "zero by symmetry"),
        Check(GROUP, "1 m: vertical stress in the ramp, rms distance", large["ripple"], low, "at_most",
              "linear waves in a column under growing gravity"),
        Check(GROUP, "1 m: inertial fraction of the mean vertical stress", large["own_yy"], rest["own_yy"], "absolute",
              "the same box at rest, with inertial forces", low),
        Check(GROUP, "1 m: largest distance in the turn", large["miss"], small["miss"], "at_least",
              "inertia and waves of the large block alone"),
    ]  # fmt: skip
