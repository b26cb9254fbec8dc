"""Matrix of a campaign: for each kind and maker of defects, the fraction that each check notices."""

from collections.abc import Sequence

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from mpm_verify.cases.detect.rates import Row, real
from mpm_verify.reports.figures import style


def matrix(found: Sequence[Row], checks: Sequence[str]) -> Figure:
    """Figure: a row for each class of defects, a column for each check, numbers in per cent of the class."""
    mine = real(found)
    classes = sorted({(row.kind, row.by) for row in mine})
    members = [[row for row in mine if (row.kind, row.by) == one] for one in classes]
    columns = [*checks, "any"]
    table = np.array(
        [
            [
                np.mean([bool(row.changed) if check == "any" else check in row.changed for row in some])
                for check in columns
            ]
            for some in members
        ]
    ).reshape(len(classes), len(columns))
    with rc_context(style.RC):
        figure = Figure(figsize=(0.62 * len(columns) + 3.2, 0.36 * len(classes) + 2.0), layout="constrained")
        axes = figure.subplots()
        axes.imshow(table, cmap="Blues", vmin=0, vmax=1, aspect="auto")
        axes.set_xticks(range(len(columns)), [name.replace("_", " ") for name in columns], rotation=45, ha="right")
        axes.set_yticks(
            range(len(classes)),
            [f"{kind}, {by} ({len(some)})" for (kind, by), some in zip(classes, members, strict=True)],
        )
        axes.grid(False)
        axes.tick_params(length=0)
        for spine in axes.spines.values():
            spine.set_visible(False)
        for i, row in enumerate(table):
            for j, value in enumerate(row):
                if value:
                    axes.text(
                        j,
                        i,
                        f"{100 * value:.0f}",
                        ha="center",
                        va="center",
                        fontsize=9.5,
                        color="white" if value > 0.55 else style.INK,
                    )
        axes.axvline(len(checks) - 0.5, color="white", linewidth=3)
    return figure
