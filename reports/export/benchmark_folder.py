"""Folder of a benchmark for another solver: case.json, case.txt, particles.csv, known.csv, and all of it in words."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from mpm_verify.cases.benchmark.exported import FORMAT, BenchmarkRecord, Exported
from mpm_verify.cases.benchmark.problem import Problem
from mpm_verify.cases.harness.store import Store
from mpm_verify.mms.export.files import CASE, FLAT, PARTICLES, csv
from mpm_verify.mms.export.record import flat
from mpm_verify.reports.export.folder import README, rendered, usable
from mpm_verify.reports.sentences.benchmark import statement
from mpm_verify.reports.sentences.unjudged import SAID

KNOWN = "known.csv"
WAYS = {"relative": "", "absolute": "", "at_most": "at most ", "at_least": "at least "}
OFS = {"limit": "the limit of refinement", "finest": "the finest grid", "each": "every grid"}


def write(folder: Path, case: Exported, problem: Problem) -> list[Path]:
    """Write the files of a benchmark.

    Parameters
    ----------
    folder
        New, empty, or with a benchmark that is written over.
    case, problem
        Content, and the problem that it is of.

    Returns
    -------
    list of Path
        What was written.

    Raises
    ------
    ValueError
        If something else is there.
    """
    usable(folder, benchmark_in, "benchmark")
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        FLAT: "".join(f"{name} {value}\n" for name, value in flat(case.record)),
        PARTICLES: csv(case.particles),
        **({KNOWN: csv({"id": case.particles["id"], **case.known})} if case.known else {}),
        CASE: json.dumps(asdict(case.record), indent=1) + "\n",
        README: words(case, problem),
    }
    for name, text in texts.items():
        Store.write(folder / name, text.encode())
    return [folder / name for name in texts]


def benchmark_in(folder: Path) -> None:
    """Raise ValueError for a folder without a benchmark."""
    try:
        there = json.loads((folder / CASE).read_text(encoding="utf-8")).get("format")
    except (OSError, ValueError, AttributeError):
        there = None
    if there != FORMAT:
        raise ValueError(f"{folder} holds no benchmark")


def words(case: Exported, problem: Problem) -> str:
    """Text of README.md."""
    columns = {name: problem.units.get(name, "") for name in case.known}
    return rendered(
        "benchmark_folder.md.j2", case=case.record, statement=statement(problem), columns=columns, ways=WAYS, ofs=OFS,
        unjudged=SAID,
    )  # fmt: skip


def schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of case.json."""
    found = TypeAdapter(BenchmarkRecord).json_schema(mode="serialization")
    for definition in (found, *found["$defs"].values()):
        definition["additionalProperties"] = False
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **found, "title": "mpm-verify benchmark folder"}
