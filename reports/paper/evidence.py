"""Stored studies of the paper as rules read them: finished columns, their claims, errors and orders, checks.

Whatever is not stored is NotStoredError, so that no rule can answer without a Result.
"""

from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from math import log2
from pathlib import Path
from typing import Any

from mpm_verify.cases.column.claims import claims
from mpm_verify.cases.column.records import Claim, ClaimCode, FinishedRun
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.store import StoreError
from mpm_verify.cases.harness.study import ResultRecord
from mpm_verify.reports.frames import Record, read
from mpm_verify.reports.paper.records import NotFinishedError, NotStoredError

Result = ResultRecord[Any]


class Evidence:
    """Stored studies by their names; `read` gives the Record of one. Raises NotStoredError."""

    def __init__(self, read: Callable[[str], Record]) -> None:
        self.record = cache(read)

    def results(self, study: str, **fields: Any) -> list[Result]:
        """Results of a study whose runs have these fields. Raises NotStoredError where one is not stored."""
        record = self.record(study)
        wanted = [run for run in record.study.runs if all(getattr(run, key) == fields[key] for key in fields)]
        if not wanted or any(run.digest not in record.results for run in wanted):
            raise NotStoredError(study)
        return [record.results[run.digest] for run in wanted]

    def one(self, study: str, **fields: Any) -> Result:
        """First finished Result of a study whose run has these fields. Raises NotFinishedError where there is none."""
        found = [one for one in self.results(study, **fields) if one.status == "finished"]
        if not found:
            raise NotFinishedError(study)
        return found[0]

    def columns(self, study: str) -> list[FinishedRun]:
        """Finished columns of a study in its order, all runs of which must be stored."""
        self.results(study)
        return list(self.record(study).analysis.more.ran)

    def ended(self, study: str) -> list[FinishedRun]:
        """Finished columns of a study, of which there are some. Raises NotFinishedError."""
        found = self.columns(study)
        if not found:
            raise NotFinishedError(study)
        return found

    def column(self, study: str, code: ClaimCode, among: Callable[[FinishedRun], bool] | None = None) -> Claim:
        """Claim of the column in a study, or in some of its runs: the answer of the case's own rule."""
        ran = [one for one in self.columns(study) if among is None or among(one)]
        for claim in claims(ran, self.record(study).study.axes):
            if claim.code is code:
                return claim
        raise NotFinishedError(study)

    def errors(self, study: str, norm: str = "rms", **fields: Any) -> dict[int, float]:
        """Error of u by cells, of finished runs with these fields and with the largest time step, coarse to fine."""
        found = self.results(study, **fields)
        largest = max(one.run.courant for one in found)
        kept = sorted((one for one in found if one.run.courant == largest), key=lambda one: one.run.cells)
        return {one.run.cells: one.errors["u"][norm] for one in kept if one.status == "finished"}

    def failures(self, study: str, **fields: Any) -> int:
        """Number of failed runs."""
        return sum(one.status == "failed" for one in self.results(study, **fields))

    def checks(self, study: str) -> tuple[Check, ...]:
        """Checks of a study, all runs of which must be stored."""
        self.results(study)
        return self.record(study).analysis.checks

    def ticks(self, study: str, **fields: Any) -> float:
        """Processor time of a particle update, s: the middle of the finest runs."""
        found = [one for one in self.results(study, **fields) if one.status == "finished" and one.updates and one.cpu_s]
        if not found:
            raise NotFinishedError(study)
        most = max(found, key=lambda one: one.updates)
        return most.cpu_s / most.updates


def slopes(errors: Mapping[int, float]) -> list[float]:
    """Orders between levels next to each other, by cells."""
    levels = list(errors.items())
    return [log2(e / finer) / log2(m / n) for (n, e), (m, finer) in pairwise(levels) if e > 0 and finer > 0]


def below(folder: Path) -> Evidence:
    """Evidence of the studies in the folders below one."""

    def one(study: str) -> Record:
        try:
            return read(folder / study)
        except StoreError:
            raise NotStoredError(study) from None

    return Evidence(one)
