"""Part of the column's page on the aspect ratio: run-out against it, and the scaling of experiments."""

from collections.abc import Sequence

from mpm_verify.cases.column.aspect import ENOUGH, Line, scaling
from mpm_verify.cases.column.records import MEASURES
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures.aspect import run_out
from mpm_verify.reports.sentences import column as words
from mpm_verify.reports.words import DASH


def aspects(lines: Sequence[Line], add: Add) -> Section:
    """Section of the run-out over the width against height over width."""
    labels = [words.listed(line.shared) or "here" for line in lines]
    image = add("aspect", run_out(lines, labels), "Run-out over width against height over width, and the scaling.")
    head = (*(("runs with",) if len(lines) > 1 else ()), "height / width", "cells of the height", "run-out / width",
            "by 99.9 %", "by the toe", "scaling", "against it", "crowding")  # fmt: skip
    rows = []
    for line, label in zip(lines, labels, strict=True):
        for point in line.points:
            low, high = scaling(point.aspect)
            rows.append((
                *((label,) if len(lines) > 1 else ()), f"{point.aspect:g}",
                f"{point.cells}{' (few)' if point.cells < ENOUGH else ''}", f"{point.run_out:.2f}",
                *(f"{point.by[name]:.2f}" if name in point.by else DASH for name in MEASURES["front"][1:]),
                f"{low:.2f} to {high:.2f}", words.off(point.run_out, (low, high)),
                f"{point.crowding:.2f}"))  # fmt: skip
    return Section("aspect", "Run-out against aspect", [words.ASPECTS.format(few=ENOUGH)], [
        (image, "Run-out against the aspect ratio. Shaded: between the forms in which the scaling is quoted.")
    ], [Table("Run-out of each column", head, tuple(rows), texts=("runs with", "scaling", "against it"))])  # fmt: skip
