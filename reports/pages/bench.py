"""Page of `verify bench`: what is timed, the speeds beside the processor, and whether threads keep the bits."""

from pathlib import Path

import pandas as pd

from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.page import adder
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures.bench import bars
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages import _plain
from mpm_verify.reports.sentences import bench as said
from mpm_verify.reports.tables import bench


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page, with tables/speed.csv and speed.md; its path. There are no snapshots, whatever `vtk` says.

    Raises StoreError.
    """
    rows = bench.rows(record)
    first = [Section("timed", "What is timed", said.statement(record.study.runs))]
    if rows:
        folder = record.store.folder
        for name in ("figures", "tables"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        pd.DataFrame(rows).to_csv(folder / "tables" / "speed.csv", index=False, lineterminator="\n")
        (folder / "tables" / "speed.md").write_text(f"{said.measured_on(rows)}\n\n{bench.markdown(rows)}")
        head, texts = bench.head(rows), [bench.cells(row, bench.more(rows)) for row in rows]
        named = [" ".join(row[: head.index("nodes")]) for row in texts]
        figure = bars(rows, named, head[head.index("quartiles") - 1])
        drawn = adder(folder / "figures")("speed", figure, "Time of a step of each method.")
        table = Table("Speed", head, tuple(texts), heads=head.index("nodes"))
        first.append(Section("speed", "Speed", [said.measured_on(rows), said.NOTES], [(drawn, said.CAPTION)], [table]))
    return _plain.page(record, first=first)
