"""A study of the column as an Examination: invariants of each run as checks, the paper's sentences, what refines."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from mpm_verify.cases.column.checks import checks
from mpm_verify.cases.column.claims import CROWDED, Claim, FinishedRun, claims, shared, told
from mpm_verify.cases.column.experiment import UNCERTAIN, experiment
from mpm_verify.cases.column.refined import Refined, Scattered, refinements, scatter
from mpm_verify.cases.column.run import ColumnResult, ColumnRun, ColumnStudy
from mpm_verify.cases.harness.checks import Check, Examination
from mpm_verify.cases.harness.store import Store


@dataclass(frozen=True)
class ColumnAnalysis:
    """What a study holds: its results by digest, those that came to their end with their curves, and what they say."""

    study: ColumnStudy
    results: Mapping[str, ColumnResult]
    ran: tuple[FinishedRun, ...]
    claims: tuple[Claim, ...]
    refined: tuple[Refined, ...]
    scattered: tuple[Scattered, ...]
    examination: Examination

    @property
    def checks(self) -> tuple[Check, ...]:
        """What decides the exit code."""
        return self.examination.checks

    def label(self, run: ColumnRun) -> str:
        """A run by what the study varies; by its method, mesh and law where it varies nothing."""
        return shared(run, self.study.axes or ("method", "cells", "ppc", "material"))


def examine(study: ColumnStudy, results: Mapping[str, ColumnResult], store: Store) -> ColumnAnalysis:
    """Judge what is stored."""
    ended = [(run, results[run.digest]) for run in study.runs if run.digest in results]
    ran = tuple(FinishedRun(run, one.values, curves(store, one)) for run, one in ended if one.status == "finished")
    said = tuple(claims(ran, study.axes))
    first = next(iter(results.values()), None)
    examination = Examination(
        f"column-{study.name}", study.title, study.command, lead(study, ran, said, len(ended)),
        tuple(checks(study, ran)), parameters(study, first), {}, first.environment if first else {},
    )  # fmt: skip
    refined, scattered = tuple(refinements(ran, study.axes)), tuple(scatter(ran, study.axes))
    return ColumnAnalysis(study, results, ran, said, refined, scattered, examination)


def curves(store: Store, result: ColumnResult) -> dict[str, Any]:
    """Columns over time, by name."""
    arrays = store.arrays(result.digest)
    return {name[6:]: np.asarray(values, float) for name, values in arrays.items() if name.startswith("curve_")}


def lead(study: ColumnStudy, ran: Sequence[FinishedRun], said: Sequence[Claim], done: int) -> str:
    """What came out, in words."""
    words = [f"{len(ran)} of {len(study.runs)} runs came to their end."]
    if done - len(ran):
        words.append(f"{done - len(ran)} could not go on; the table says where and why.")
    if done < len(study.runs):
        words.append(f"{len(study.runs) - done} are still to be done: the same command goes on.")
    if said:
        found = [claim.reproduced for claim in said]
        open_ = f", {found.count(None)} cannot be told" if None in found else ""
        words.append(f"Sentences of the paper: {found.count(True)} reproduced, {found.count(False)} not{open_}.")
    crowded = [one for one in ran if one.values["crowding"] > CROWDED]
    if crowded:
        words.append(f"In the heap of {len(crowded)} of them particles keep more than {CROWDED:g} times the volume of "
                     "the space that they are in: such a heap is too small for its material.")  # fmt: skip
    if len(ran) == 1:
        v = ran[0].values
        words.append(f"The front comes to {v['front_99']:.3f} m, and the height at the wall is {v['height']:.3f} m. "
                     f"The method itself loses {100 * v['lost']:.1f} % of the energy.")  # fmt: skip
    return " ".join([*words, UNCERTAIN] if any(experiment(one.run) for one in ran) else words)


def parameters(study: ColumnStudy, first: ColumnResult | None) -> dict[str, str]:
    """What all runs share."""
    found = {key: str(value) for key, value in asdict(study.runs[0]).items() if key not in (*study.axes, "case")}
    if "damping" in found:
        found["damping"] = told("damping", study.runs[0].damping)
    laws = first.parameters if first and "material" not in study.axes else {}
    return found | {f"material: {key}": str(value) for key, value in laws.items() if key != "domain limit"}
