"""Error of u over the square at the last step of one run, on the domains of its particles.

Domains are drawn as the method has them, so that gaps and overlaps are seen. Methods that know points only are drawn
with the parallelograms x ± r1 ± r2, r_i = F r0_i: Sadeghirad, Brannon & Burghardt (2011), doi:10.1002/nme.3110.
"""

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from mpm_verify.cases.harness.study import Arrays
from mpm_verify.cases.mms.run import Run
from mpm_verify.reports import words
from mpm_verify.reports.figures import style
from mpm_verify.reports.frames import Record
from mpm_verify.solver.state import Floats

CELLS, PPC = 16, 4  # fine enough to show the field, coarse enough to see each domain
CORNERS = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
OUTLINED = 4096  # more domains than that are drawn without outlines: they would be all outline


def choose(record: Record, method: str, solution: str, cells: int = CELLS, ppc: int = PPC) -> Run | None:
    """Finished run of a method nearest to that many cells, then particles per cell; None if none finished."""
    runs = [run for s in record.drawn for run in s.runs if (run.method, run.solution) == (method, solution)]
    done = [run for run in runs if (r := record.result(run)) and r.status == "finished"]
    return min(done, key=lambda r: (abs(np.log2(r.cells / cells)), abs(r.ppc - ppc), r.cells, r.ppc), default=None)


def domains(arrays: Arrays) -> NDArray[np.float64]:
    """Corners (P,4,2) at the last step. Older results have r0[p,0], r0[p,1], half side vectors at t = 0, instead."""
    if "corners" in arrays:
        return np.asarray(arrays["corners"], float)
    r = np.einsum("pij,pkj->pki", arrays["F"].astype(float), arrays["r0"].astype(float))
    corners: NDArray[np.float64] = arrays["x"].astype(float)[:, None, :] + np.einsum("ck,pki->pci", CORNERS, r)
    return corners


def error_field(run: Run, arrays: Arrays) -> Figure:
    """Figure of |u - u_exact| on the domains; the domains are one picture inside the SVG, the rest is drawn."""
    corners, error = domains(arrays), arrays["error_u"].astype(float)
    with rc_context(style.RC | {"axes.grid": False}):
        figure = Figure(figsize=(5.0, 5.2), layout="constrained")
        axes = figure.subplots()
        bar = draw(figure, axes, corners, error)
        bar.set_label("|error of u| at the last step")
        axes.set_title(
            f"{words.series(run)}, {run.cells} {words.TIMES} {run.cells} cells", loc="left", fontweight="bold"
        )
    return figure


def limits(corners: NDArray[np.float64], axis: int) -> tuple[float, float]:
    """Limits of an axis: the domains, with a little air."""
    values = corners[..., axis][np.isfinite(corners[..., axis])]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    return low - 0.015 * (high - low), high + 0.015 * (high - low)


def draw(figure: Figure, axes: Axes, corners: Floats, values: Floats) -> Colorbar:
    """Draw values (P,), from zero up, on domains with corners (P,4,2); gives the colour bar."""
    outline = 0.35 if len(corners) <= OUTLINED else 0.0
    patches = PolyCollection(list(corners), cmap="cividis", edgecolors="white" if outline else "face")
    patches.set(array=values, linewidths=outline or 0.2, rasterized=True)
    patches.set_clim(0.0, float(np.nanmax(values)) or 1.0)
    axes.add_collection(patches)
    axes.set(aspect="equal", xlabel="x", ylabel="y", xlim=limits(corners, 0), ylim=limits(corners, 1))
    bar = figure.colorbar(patches, ax=axes, location="bottom", shrink=0.9, aspect=28, pad=0.02)
    bar.locator, bar.formatter = MaxNLocator(4), FuncFormatter(style.number)
    return bar
