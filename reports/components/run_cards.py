"""Cards of runs: what each was, how it ended, its errors, the command that repeats it, and a picture of its error."""

import io
from base64 import b64encode
from collections.abc import Iterable
from dataclasses import MISSING, dataclass, fields
from typing import Any

import numpy as np
from matplotlib import colormaps
from PIL import Image

from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports import words
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, failures
from mpm_verify.solver.state import Floats

MOST = 60  # pictures of a page
SIDE = 64  # pixels of a picture, at most
FEW = 24  # values of a run that are told


@dataclass(frozen=True)
class RunCard:
    """Card of a run; `facts` are (label, text), `snapshot` a picture as data, `shows` says of what."""

    digest: str
    title: str
    facts: tuple[tuple[str, str], ...]
    command: str
    snapshot: str = ""
    shows: str = ""


def cards(record: Record) -> list[RunCard]:
    """Cards of the stored runs in the order of the study; the first few on which there is an error field have one."""
    found, pictures = [], 0
    for run in record.study.runs:
        if result := record.result(run):
            picture = snapshot(record, run) if pictures < MOST else ""
            pictures += bool(picture)
            shows = f"Size of the error of u over the body at the last step, {run}." if picture else ""
            found.append(RunCard(result.digest, title(record, run), tuple(facts(record, run, result)),
                                 commands.of_run(record.study, run), picture, shows))  # fmt: skip
    return found


def told(record: Record) -> dict[str, str]:
    """Text of each stored run on its points in figures, by the name of its Result."""
    texts = {}
    for run in record.study.runs if record.study.plans else ():
        if result := record.result(run):
            errors = [
                f"{words.quantity(q)} {words.sci(norms['rms'])}" for q, norms in result.errors.items() if "rms" in norms
            ]
            ended = (
                failures.failure(result.failure) if result.failure else "rms errors " + ", ".join(errors) * bool(errors)
            )
            texts[run.digest] = f"{title(record, run)}: {ended if errors or result.failure else 'finished'}"
    return texts


def title(record: Record, run: Any) -> str:
    """Title of a run: its refinement, its level, and the time step where that varies."""
    if not record.study.plans:
        return str(run)
    parts = [record.label(run)] + [f"{record.by} {record.size(1 / run.cells)}"] * hasattr(run, "cells")
    courants = {getattr(one, "courant", None) for one in record.study.runs}
    return ", ".join(parts + [f"Courant {run.courant:g}"] * (len(courants) > 1))


def facts(record: Record, run: Any, result: Any) -> Iterable[tuple[str, str]]:
    """Parameters that are not the usual ones, how the run ended, and its errors in every norm."""
    yield "Parameters", ", ".join(f"{name} {value}" for name, value in unusual(record, run)) or "as usual"
    yield "Ended", failures.failure(result.failure) if result.failure else "finished"
    yield "Size", f"{result.particles} particles, {result.steps} steps of {words.sci(result.dt)}"
    yield "Cost", f"{result.wall_s:.2f} s of wall time, {result.peak_memory_mb:.0f} MB"
    for quantity, norms in result.errors.items():
        yield f"Error of {words.quantity(quantity)}", ", ".join(f"{norm} {words.sci(e)}" for norm, e in norms.items())
    for name, value in list(result.values.items())[:FEW]:
        yield name.replace("_", " "), f"{value:.6g}"
    yield "Name of the Result", result.digest


def unusual(record: Record, run: Any) -> Iterable[tuple[str, str]]:
    """Fields of a run that are not as usual, or vary in the study."""
    for item in fields(run):
        value, usual = getattr(run, item.name), None if item.default is MISSING else item.default
        if value != "" and (value != usual or item.name in record.study.axes):
            yield item.name.replace("_", " "), commands.typed_value(value)


def snapshot(record: Record, run: Any) -> str:
    """Picture of the error of u at the last step as data; empty where no such field is stored."""
    try:
        arrays = record.arrays(run) if record.result(run).status == "finished" else {}
    except (StoreError, KeyError):
        return ""
    x, error = arrays.get("x"), arrays.get("error_u")
    if x is None or error is None or np.ndim(x) != 2 or np.shape(x)[1] != 2 or not np.isfinite(x).all():
        return ""
    return picture(np.asarray(x, float), np.asarray(error, float))


def picture(x: Floats, values: Floats) -> str:
    """Means of values (P,) at positions x (P,2) on a grid of pixels, dark to bright, as the data of a PNG."""
    side = int(np.clip(np.sqrt(len(x)) / 1.2, 4, SIDE))
    low, high = x.min(axis=0), x.max(axis=0)
    size = float((high - low).max()) or 1.0
    column, row = np.clip((x - (low + high - size) / 2) / size * side, 0, side - 1).astype(int).T
    pixel = (side - 1 - row) * side + column
    count = np.bincount(pixel, minlength=side**2).reshape(side, side)
    total = np.bincount(pixel, np.nan_to_num(values), side**2).reshape(side, side)
    mean = total / np.maximum(count, 1)
    rgba = colormaps["cividis"](mean / (mean.max() or 1.0), bytes=True)
    rgba[..., 3] = 255 * (count > 0)
    buffer = io.BytesIO()
    Image.fromarray(rgba).save(buffer, "png")
    return "data:image/png;base64," + b64encode(buffer.getvalue()).decode()
