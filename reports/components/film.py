"""A run as an animation inside the page: positions of its particles, packed as whole numbers, drawn on a canvas.

Particles are coloured in bands by the height at which they began, as the sand of the experiment was layered. Positions
are kept to 1/65534 of the picture, one of many is drawn where there are more than the page should carry.
"""

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.reports.figures.column import BANDS, DARK, PALE, away

MOST = 16_000  # particles of all films of a page: each costs 57 frames of four bytes
EACH = 4_000


@dataclass(frozen=True)
class Film:
    """Film of particles, as the page draws it.

    `data`: base64 of unsigned 16-bit numbers, little-endian: x and y of each particle, frame after frame; 65535 is
    outside the picture. `bands`: one character a particle, its colour; `wide`, `high`: what the whole range is, in m;
    `times` in s.
    """

    label: str
    data: str
    bands: str
    times: str
    wide: float
    high: float
    colours: str = f"{DARK},{PALE}"


def film(run: ColumnRun, arrays: Mapping[str, Any], label: str, wide: float, most: int = EACH) -> Film:
    """Film of a stored run, `wide` metres of it."""
    frames = away(run, arrays["frame_x"])
    frames = frames[:, :: -(-frames.shape[1] // most)]
    high = 1.02 * run.height
    scaled = np.clip(np.nan_to_num(frames / [wide, high]), 0, 1) * 65534
    scaled[~((frames <= [wide, high]).all(axis=2))] = 65535  # what has flown out of the picture
    bands = (frames[0, :, 1] / run.height * BANDS).astype(int) % 2
    return Film(
        label,
        base64.b64encode(scaled.round().astype("<u2").tobytes()).decode(),
        "".join(map(str, bands)),
        ",".join(f"{t:.3f}" for t in arrays["frame_t"]),
        wide,
        high,
    )
