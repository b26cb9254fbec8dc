"""Content of a figure as data: its named lines, where their points are on it, and the runs that these are of."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

_runs: WeakKeyDictionary[Line2D, tuple[str, ...]] = WeakKeyDictionary()  # of a line, a name of a Result each point


@dataclass(frozen=True)
class Point:
    """Point of a line: per cent from the left and from the top of the figure, number of its series, name of its run."""

    left: float
    top: float
    series: int
    run: str


def of_runs(lines: Sequence[Line2D], runs: Sequence[Any]) -> None:
    """Say which run each point of a line is of."""
    for line in lines:
        _runs[line] = tuple(run.digest for run in runs)


def named(figure: Figure) -> dict[str, list[Line2D]]:
    """Lines of all panels by their names, each name once; lines that have none are decoration."""
    found: dict[str, list[Line2D]] = {}
    for line in (line for axes in figure.axes if axes.get_visible() for line in axes.lines):
        name = str(line.get_label())
        if not name.startswith("_") and len(finite(line)):
            found.setdefault(name, []).append(line)
    return found


def finite(line: Line2D) -> Any:
    """Points (N,2) of a line that are numbers."""
    every = data(line)
    return every[np.isfinite(every).all(axis=1)]


def data(line: Line2D) -> Any:
    """Points (N,2) of a line, those that are not numbers too."""
    return np.column_stack([np.asarray(part, float) for part in line.get_data()])


def seen(line: Line2D) -> Any:
    """Mask (N) of the points of a line that have a position: numbers, and above zero along a logarithmic axis."""
    every, axes = data(line), line.axes
    logarithmic = [axes.get_xscale() == "log", axes.get_yscale() == "log"] if axes else [False, False]
    return (np.isfinite(every) & ((every > 0) | ~np.array(logarithmic))).all(axis=1)


def tagged(figure: Figure) -> tuple[str, ...]:
    """Names of the series; their lines get names in the SVG, series-NUMBER-PANEL."""
    found = named(figure)
    for number, lines in enumerate(found.values()):
        for part, line in enumerate(lines):
            line.set_gid(f"series-{number}-{part}")
    return tuple(found)


def points(figure: Figure) -> Iterator[Point]:
    """Points of lines whose runs are known, of a figure that has been laid out."""
    width, height = figure.bbox.size
    for number, lines in enumerate(named(figure).values()):
        for line in (line for line in lines if line in _runs):
            mask = seen(line)
            at = line.get_transform().transform(data(line)[mask]) / (width, height)
            runs = [run for run, has_position in zip(_runs[line], mask, strict=True) if has_position]
            for (x, y), run in zip(at.tolist(), runs, strict=True):
                yield Point(round(100 * x, 2), round(100 * (1 - y), 2), number, run)


def table(figure: Figure) -> pd.DataFrame:
    """Rows, one for each point of a named line, with full digits: panel, series, x, y."""
    rows = []
    for name, lines in named(figure).items():
        for line in lines:
            axes = next(one for one in figure.axes if line in one.lines)
            panel, x, y = (
                axes.get_title(loc="left") or axes.get_title(),
                axes.get_xlabel() or "x",
                axes.get_ylabel() or "y",
            )
            rows += [{"panel": panel, "series": name, x: a, y: b} for a, b in finite(line).tolist()]
    return pd.DataFrame(rows)
