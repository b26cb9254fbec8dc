"""Looks of the figures, and files that are the same bytes each time they are written.

Colour tells the method, marker and line tell the particle count, a filled or open marker tells the method again: no
statement hangs on colour alone. Colours: Okabe & Ito (2008), "Color Universal Design". Type is large enough that a
panel can be shown 340 px wide.
"""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
MARKERS = {1: ("o", ":"), 4: ("s", "--"), 9: ("^", "-"), 16: ("D", "-.")}
INK, GREY, LIGHT = "#1b1f24", "#5b6570", "#d8dde2"
RC: dict[Any, Any] = {  # matplotlib types the keys as literals
    "font.family": "DejaVu Sans",  # ships with matplotlib: the same letters on every machine
    "font.size": 11.0,
    "axes.labelsize": 11.5,
    "axes.titlesize": 12.0,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": LIGHT,
    "grid.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "xtick.minor.bottom": False,
    "lines.linewidth": 1.8,
    "lines.markersize": 7.0,
    "legend.frameon": False,
    "svg.hashsalt": "mpm-verify",
    "pdf.fonttype": 3,
}
# Neither a date nor a version: a figure changes when its numbers do.
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
    "png": {"Software": None},
}
PANEL = (4.8, 5.0)  # inches: a panel shown alone


@dataclass(frozen=True)
class Look:
    """How a series is drawn; `legend` and `plot` arguments for matplotlib."""

    colour: str
    marker: str
    line: str
    filled: bool

    @property
    def plot(self) -> dict[str, Any]:
        """Keyword arguments for Axes.plot."""
        face = self.colour if self.filled else "white"
        return {
            "color": self.colour,
            "marker": self.marker,
            "linestyle": self.line,
            "markerfacecolor": face,
            "markeredgewidth": 1.5,
        }


def look(methods: Sequence[str], method: str, ppc: int) -> Look:
    """The look of a series; `methods` are those of the study, in its order."""
    place = list(methods).index(method)
    marker, line = MARKERS.get(ppc, ("v", "-"))
    return Look(COLOURS[place % len(COLOURS)], marker, line, place % 2 == 0)


def number(value: float, _: object = None) -> str:
    """A tick as in the tables: 2e-4, 2.5e-4, 0."""
    digits, exponent = f"{value:.3e}".split("e")
    return f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}" if value else "0"


def save(figure: Figure, folder: Path, name: str, kinds: Sequence[str] = ("svg", "pdf", "png")) -> bytes:
    """Write name.svg, .pdf and .png into `folder` and give the SVG; the same figure gives the same bytes."""
    with rc_context(RC):
        figure.draw_without_rendering()
        figure.set_layout_engine("none")  # laid out once: three formats would do it three times
        for kind in kinds:
            buffer = io.BytesIO()
            figure.savefig(buffer, format=kind, metadata=METADATA[kind], dpi=200)
            (folder / f"{name}.{kind}").write_bytes(buffer.getvalue())
    return (folder / f"{name}.svg").read_bytes()
