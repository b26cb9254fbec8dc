"""Files of a study of the column beside its page: numbers and curves as CSV, snapshots for ParaView."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from mpm_verify.cases.column.exam import ColumnAnalysis
from mpm_verify.cases.column.exam import arrays as read_arrays
from mpm_verify.cases.column.exam import curves as read_curves
from mpm_verify.cases.harness.store import Store
from mpm_verify.reports.export.vtk import write_series
from mpm_verify.reports.frames import flat, joined
from mpm_verify.reports.sentences import column as words
from mpm_verify.reports.sentences import failures

MEASURED = {  # measured numbers that have the name of a parameter: their names in tables
    "damping": "damping_energy", "transfer": "transfer_energy", "void": "void_fraction", "courant": "courant_reached",
}  # fmt: skip


def tables(analysis: ColumnAnalysis, store: Store, folder: Path) -> None:
    """Write numbers of the runs.

    runs.csv: parameters and numbers of each run; curves.csv: each curve of each run, front to residual; profiles.csv:
    the surfaces of each run at its end, by strip.
    """
    rows, curves, profiles = [], [], []
    for run in analysis.study.runs:
        result = analysis.results.get(run.digest)
        if result:
            parameters = flat({name: getattr(run, name) for name in analysis.study.axes})
            failure = failures.cause(result.failure) if result.failure else ""
            head = {"digest": run.digest, "status": result.status, "failure": failure}
            rows.append(joined(head, parameters, measured(result.values)))
            read = read_curves(store, result)
            if not read:
                continue
            named = {"digest": run.digest} | {
                axis: words.value(axis, getattr(run, axis)) for axis in analysis.study.axes
            }
            columns = {name: values for name, values in read.items() if values.ndim == 1}
            curves.append(pd.DataFrame(joined(named, measured(columns))))
            ended = {name: values[-1] for name, values in read.items() if values.ndim == 2}
            middles = (np.arange(len(ended["profile"])) + 0.5) * run.strip
            profiles.append(pd.DataFrame(joined(named, {"x": middles}, ended)))
    pd.DataFrame(rows).to_csv(folder / "runs.csv", index=False)
    for name, parts in {"curves": curves, "profiles": profiles}.items():
        if parts:
            pd.concat(parts).to_csv(folder / f"{name}.csv", index=False, float_format="%.7g")


def measured(values: Mapping[str, Any]) -> dict[str, Any]:
    """Measured numbers by names that no parameter has."""
    return {MEASURED.get(name, name): value for name, value in values.items()}


def files(analysis: ColumnAnalysis, store: Store, folder: Path) -> None:
    """Write the snapshots of each run, see reports/export/vtk.py."""
    folder.mkdir(exist_ok=True)
    for run in analysis.study.runs:
        result = analysis.results.get(run.digest)
        if result and (arrays := read_arrays(store, result)):
            named = {
                key[9:]: values for key, values in arrays.items() if key.startswith("snapshot_") and key != "snapshot_t"
            }
            shots = [{key: values[k] for key, values in named.items()} for k in range(len(arrays["snapshot_t"]))]
            write_series(folder, result.digest, [float(t) for t in arrays["snapshot_t"]], shots)
