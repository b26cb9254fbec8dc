"""Content of a study folder, read once: the Study, its Results, and what the order rule says of them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.analysis import Analysis, analyse
from mpm_verify.cases.harness.axes import level, middle, replicated
from mpm_verify.cases.harness.refinement import Series, collect
from mpm_verify.cases.harness.store import Store, case_of
from mpm_verify.cases.harness.study import Arrays, QuantityPlan, ResultRecord, Study
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.reports import words
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.plugins import label

Run = Any  # of any case
SAID = ("measured",)  # fields that say again what a plan says
USUAL = ("method", "solution", "ppc")  # fields that name a refinement in every table
Result = ResultRecord[Any]


@dataclass(frozen=True)
class Record:
    """Study as stored, with what the order rule and the checks say of it.

    Parameters
    ----------
    store
        The folder.
    study
        Its runs and plans.
    results
        Results of the case by the digest that the study's runs have now; runs not done are not in it.
    earlier
        Whether all results were computed with another source hash than that of what is installed: their numbers stand,
        but a new run of the study would compute them again.
    """

    store: Store
    study: Study[Any]
    results: dict[str, Any]  # Results of the case
    earlier: bool

    @cached_property
    def analysis(self) -> Analysis:
        """Verdicts and checks."""
        return analyse(self.study, self.results, self.store)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings in the order of the plans."""
        return self.analysis.findings

    @cached_property
    def series(self) -> list[Series]:
        """Refinements, one for each method, solution and particle count; methods in order, few particles first."""
        return collect(self.study.runs)

    @cached_property
    def varied(self) -> tuple[str, ...]:
        """Fields in which refinements differ, apart from method, solution and particle count."""
        heads = [dict(series.head) for series in self.series]
        return tuple(name for name in (heads[0] if heads else ())
                     if name not in (*USUAL, *SAID) and len({head[name] for head in heads}) > 1)  # fmt: skip

    @cached_property
    def implied(self) -> tuple[str, ...]:
        """Fields that vary only because problems differ, such as their material."""
        heads = [dict(series.head) for series in self.series]
        if "problem" not in self.varied:
            return ()
        problems = len({head["problem"] for head in heads})
        pairs = {name: len({(head["problem"], head[name]) for head in heads}) for name in self.varied}
        return tuple(name for name, count in pairs.items() if name != "problem" and count == problems)

    @cached_property
    def drawn(self) -> list[Series]:
        """Refinements that figures show: of what else varies, those with the first value that their solution has."""
        first: dict[str, tuple[Any, ...]] = {}
        for s in self.series:
            first.setdefault(_solution(s.first), self._else(s.first))
        return [s for s in self.series if self._else(s.first) == first[_solution(s.first)]]

    def _else(self, run: Run) -> tuple[Any, ...]:
        """Values of a run in what varies beside method, solution and particle count."""
        return tuple(getattr(run, name) for name in self.varied)

    def columns(self, run: Run) -> dict[str, Any]:
        """Names and values that tell the refinement of a run in a table."""
        names = (*(name for name in USUAL if hasattr(run, name)), *self.varied)
        return {name: getattr(run, name) for name in names}

    def label(self, run: Run, solution: bool = True) -> str:
        """Name of the refinement of a run on a page: method and particle count, and what else varies in the study."""
        several = solution and len(self.solutions) > 1
        more = [label(run.solution)] if several else []
        more += [f"{name} {getattr(run, name)}" for name in self.varied if name not in self.implied]
        return ", ".join([words.series(run), *more])

    @property
    def by(self) -> str:
        """Column that tables name a level by: `cells`, or `h` where sizes were given."""
        return str(getattr(self.study.runs[0], "by", "cells")) if self.study.runs else "cells"

    def size(self, h: float) -> float:
        """Level of a cell size in that column: a whole number of cells, or the size without the round-off of 1/h."""
        return round(1 / h) if self.by == "cells" else float(f"{h:.14g}")

    def named(self, h: float) -> str:
        """Level of a cell size as text: `64`, `0.0125`."""
        size = self.size(h)
        return str(size) if isinstance(size, int) else f"{size:.6g}"

    def series_of(self, plan: QuantityPlan[Any]) -> Series:
        """Refinement that a planned quantity is measured on."""
        return next(s for s in self.series if s.head == plan.head)

    @property
    def solutions(self) -> list[str]:
        """Each solution of the study once; none of a case without solutions."""
        return sorted({run.solution for run in self.study.runs if hasattr(run, "solution")})

    @property
    def missing(self) -> list[Run]:
        """Runs that the study asks for and that are not stored."""
        return [run for run in self.study.runs if run.digest not in self.results]

    def result(self, run: Run) -> Any:
        """Stored Result of a run, None if it is still to be done."""
        return self.results.get(run.digest)

    def error(self, run: Run, quantity: str, norm: str) -> float | None:
        """Error of a finished run; None if the run failed, is still to be done, or has no such error."""
        result = self.result(run)
        if result is None or result.status == "failed":
            return None
        found: float | None = result.errors.get(quantity, {}).get(norm)
        return found

    def errors(self, series: Series, quantity: str, norm: str) -> list[tuple[Run, float]]:
        """Finished levels of a series with their error, coarse to fine; of replicates the mean, as is judged."""
        levels = zip(series.runs, replicated(series, self.results, quantity, norm), strict=True)
        return [(run, middle(errors)) for run, errors in levels if errors]

    def failed(self, series: Series) -> list[Run]:
        """Levels of a series that failed, coarse to fine."""
        levels = [(runs[0], level(runs, self.results, "u", "rms")) for runs in series.replicates]
        return [run for run, (_, failure, _) in levels if failure and failure.kind is not FailureKind.NOT_RUN]

    @property
    def replicates(self) -> int:
        """Largest number of runs of one level."""
        return max((len(runs) for series in self.series for runs in series.replicates), default=1)

    def arrays(self, run: Run) -> Arrays:
        """Particles of a stored run at its last step. Raises StoreError if they cannot be read."""
        return self.store.arrays(self.results[run.digest].digest)


def _solution(run: Run) -> str:
    """Solution of a run; none of a case without solutions."""
    return getattr(run, "solution", "")


def read(folder: Path) -> Record:
    """Read a study folder as a Record. Raises StoreError if it is not a study folder, or broken."""
    store = Store(folder, case_of(folder))
    study = store.study()
    return Record(store, study, *held(store, study))


def held(store: Store, study: Any) -> tuple[dict[str, Any], bool]:
    """Results of a study by digest, and whether all of them have an earlier source hash, as there are no others."""
    exact = {run.digest: result for run in study.runs if (result := store.get(run.digest))}
    if exact:
        return exact, False
    old = {repr(result.run): result for result in _all(store)}  # every field, those that are not compared too
    found = {run.digest: old[repr(run)] for run in study.runs if repr(run) in old}
    return found, bool(found)


def _all(store: Store) -> Iterator[Result]:
    """Every stored Result, the last written last: what a report of yesterday's study is made from."""
    files = sorted(store.runs.glob("*.json"), key=lambda file: (file.stat().st_mtime_ns, file.name))
    for file in files:
        result = store.get(file.stem)
        if result is not None:
            yield result


def joined(*parts: Mapping[str, Any]) -> dict[str, Any]:
    """Row of several parts. Raises ValueError where two of them have a column of the same name."""
    row: dict[str, Any] = {}
    for part in parts:
        both = row.keys() & part.keys()
        if both:
            raise ValueError(f"two columns of a table have the name {sorted(both)[0]!r}")
        row |= part
    return row


def flat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Values with a pair as two columns, NAME_x and NAME_y."""
    found: dict[str, Any] = {}
    for name, value in values.items():
        pair = isinstance(value, tuple)
        found |= dict(zip((f"{name}_x", f"{name}_y"), value, strict=True)) if pair else {name: value}
    return found
