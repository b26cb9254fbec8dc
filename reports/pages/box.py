"""Page of `verify box`: the problem, the sand at rest, what its rows carry, how it came to rest, and the checks."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from mpm_verify.cases.box.case import named
from mpm_verify.cases.box.run import ROWS, Run
from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.page import Add, adder
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures import box as draw
from mpm_verify.reports.frames import Record
from mpm_verify.reports.pages import _plain
from mpm_verify.reports.sentences import box as said

PANELS = 4  # of the figure of the sand
HEAD = ("run", "without stress", "void", "dilation", "area", "top", "largest", "K, rows from the floor")


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    folder = record.store.folder / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    first = [Section("problem", "The problem", said.statement()), *sections(record, adder(folder))]
    return _plain.page(record, first=first, lead=said.control(record))


def sections(record: Record, add: Add) -> list[Section]:
    """Sections of what came out; figures of the runs whose curves can be read."""
    rested = [(named(record.study, run), run, one) for run in record.study.runs
              if (one := record.result(run)) and not one.failure]  # fmt: skip
    if not rested:
        return []
    rows = tuple((label, *numbers(one.values)) for label, _, one in rested)
    table = Table("The sand at rest", HEAD, rows, texts=HEAD[-1:])
    runs = [(label, run, found) for label, run, one in rested if (found := arrays(record, run, one.values))]
    rest = Section("rest", "The sand at rest", [said.NOTES], tables=[table])
    if not runs:
        return [rest]
    idle = "; ".join(f"{label} {100 * one.values['free']:.0f} %" for label, _, one in rested)
    alt = f"Particles by the vertical stress that each carries. Without any stress: {idle}."
    sand = add("sand", draw.sand(runs[:PANELS]), alt)
    carried = add("rows", draw.rows(runs), "Vertical stress over weight, and K, of each row.")
    came = add("times", draw.times(runs), "Particles without stress, and top, against time.")
    return [
        replace(rest, figures=[(sand, said.SAND)], wide=len(runs) > 2),
        Section("rows", "Rows, and how it came to rest", figures=[(carried, said.ROWS), (came, said.TIMES)]),
    ]


def numbers(v: dict[str, float]) -> tuple[str, ...]:
    """Numbers of a run as text."""
    K = " ".join(f"{v[f'K_{k}']:.2f}" for k in range(1, ROWS + 1))
    strains = (f"{round(v[name], 4) + 0.0:.4f}" for name in ("void", "dilated", "volume"))  # no minus before a zero
    return f"{100 * v['free']:.1f} %", *strains, f"{v['top']:.3f}", f"{v['largest']:.1f}", K


def arrays(record: Record, run: Run, v: dict[str, float]) -> dict[str, Any]:
    """Arrays of a run, with what its rows carry at rest; nothing where they cannot be read."""
    try:
        found = dict(record.arrays(run))
    except StoreError:
        return {}
    rested = {key: [v[f"{key}_{k}"] for k in range(1, ROWS + 1)] for key in ("weight", "K")}
    density = float(record.results[run.digest].parameters["rho0"])
    return found | {"rested": rested, "bottom": density * run.g * run.height}
