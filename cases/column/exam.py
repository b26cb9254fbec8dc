"""A study of the column as an Examination: invariants of each run as checks, the paper's claims, what refines."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from mpm_verify.cases.column.aspect import Line, lines
from mpm_verify.cases.column.checks import checks, energy
from mpm_verify.cases.column.claims import CROWDED, claims
from mpm_verify.cases.column.experiment import experiment
from mpm_verify.cases.column.records import Claim, FinishedRun
from mpm_verify.cases.column.refined import Refined, Scattered, refinements, scatter
from mpm_verify.cases.column.run import ColumnResult, ColumnStudy
from mpm_verify.cases.harness.checks import Check, Examination, Remark
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Arrays

GIVEN = 0.06  # of the initial potential energy: with 9 particles per cell and more it is less


class ColumnRemark(StrEnum):
    """Remarks on a study of the column."""

    FINISHED = "column.finished"  # runs that came to their end
    FAILED = "column.failed"
    TO_DO = "column.to_do"
    CLAIMS = "column.claims"  # how many of the paper's sentences are reproduced
    CROWDED = "column.crowded"  # heaps too small for their material
    GIVEN = "column.given"  # energy that pooling gives to crowded particles
    ALONE = "column.alone"  # numbers of the one run there is
    BANDS = "column.bands"  # what the experiment's bands are
    UNREAD = "column.unread"  # files of curves that cannot be read


@dataclass(frozen=True)
class ColumnAnalysis:
    """Analysis of a study: its results by digest, those that came to their end with their curves, and what they say."""

    study: ColumnStudy
    results: Mapping[str, ColumnResult]
    ran: tuple[FinishedRun, ...]
    claims: tuple[Claim, ...]
    refined: tuple[Refined, ...]
    scattered: tuple[Scattered, ...]
    lines: tuple[Line, ...]
    examination: Examination

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks, which decide the exit code."""
        return self.examination.checks


def examine(study: ColumnStudy, results: Mapping[str, ColumnResult], store: Store) -> ColumnAnalysis:
    """Judge what is stored."""
    ended = [(run, results[run.digest]) for run in study.runs if run.digest in results]
    ran = tuple(FinishedRun(run, one.values, curves(store, one)) for run, one in ended if one.status == "finished")
    said = tuple(claims(ran, study.axes))
    unread = [f"runs/{one.digest}.npz" for _, one in ended if not curves(store, one)]
    first = next(iter(results.values()), None)
    examination = Examination(
        f"column-{study.name}", study.title, study.command, tuple(findings(study, ran, said, len(ended), unread)),
        tuple(checks(study, ran)), parameters(study, first), {}, first.environment if first else {},
    )  # fmt: skip
    refined, scattered = tuple(refinements(ran, study.axes)), tuple(scatter(ran, study.axes))
    return ColumnAnalysis(study, results, ran, said, refined, scattered, tuple(lines(ran, study.axes)), examination)


def curves(store: Store, result: ColumnResult) -> dict[str, Any]:
    """Columns over time, by name; none where they cannot be read."""
    found = arrays(store, result)
    return {name[6:]: np.asarray(values, float) for name, values in found.items() if name.startswith("curve_")}


def arrays(store: Store, result: ColumnResult) -> Arrays:
    """All that is stored beside the numbers of a run; nothing where it cannot be read, which decides nothing."""
    try:
        return store.arrays(result.digest)
    except StoreError:
        return {}


def findings(
    study: ColumnStudy, ran: Sequence[FinishedRun], said: Sequence[Claim], done: int, unread: Sequence[str]
) -> list[Remark]:
    """Remarks on what came out."""
    found = [Remark(ColumnRemark.FINISHED, {"finished": len(ran), "runs": len(study.runs)})]
    if done - len(ran):
        found.append(Remark(ColumnRemark.FAILED, {"failed": done - len(ran)}))
    if done < len(study.runs):
        found.append(Remark(ColumnRemark.TO_DO, {"runs": len(study.runs) - done}))
    if said:
        held = [claim.reproduced for claim in said]
        counts = {"reproduced": held.count(True), "not_reproduced": held.count(False), "open": held.count(None)}
        counts["hang"] = sum(claim.hangs for claim in said)
        found.append(Remark(ColumnRemark.CLAIMS, counts))
    crowded = [one for one in ran if one.values["crowding"] > CROWDED]
    if crowded:
        found.append(Remark(ColumnRemark.CROWDED, {"runs": len(crowded), "limit": CROWDED}))
    given = [part for one in ran if (part := one.values.get("given", 0.0) / energy(one)) > GIVEN]
    if given:
        found.append(Remark(ColumnRemark.GIVEN, {"runs": len(given), "limit": GIVEN, "most": max(given)}))
    if len(ran) == 1:
        v = ran[0].values
        found.append(Remark(ColumnRemark.ALONE, {**ran[0].lengths, "lost": v["lost"]}))
    if any(experiment(one.run) for one in ran):
        found.append(Remark(ColumnRemark.BANDS))
    return [*found, Remark(ColumnRemark.UNREAD, {"files": ", ".join(unread)})] if unread else found


def parameters(study: ColumnStudy, first: ColumnResult | None) -> dict[str, float | str]:
    """Parameters that all runs have in common."""
    found: dict[str, float | str] = {
        key: str(value) for key, value in asdict(study.runs[0]).items() if key not in (*study.axes, "case")
    }
    own = first.parameters if first and "material" not in study.axes else {}
    return found | {f"material: {key}": str(value) for key, value in own.items() if key != "domain limit"}
