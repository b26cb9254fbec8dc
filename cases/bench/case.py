"""Speed: processor time of a particle update by each method, over that of another one, on this machine.

A unit square of one material turns in itself between rollers. Ratios are medians over alternating turns within one
process, so that they can be compared with those of another machine, and they hold for the processor that is named
beside them. No time is judged; what is judged is that several threads leave the same bits as one. Threads gain on an
idle machine only: on a busy one they wait for each other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

from mpm_verify.cases.bench.run import AXES, QUICK, Result, Run
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, canonical_optional, create
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "QUICK", "Result", "Run"]


@dataclass(frozen=True)
class BenchAnalysis:
    """Whether threads leave the bits as they are, for each run."""

    checks: tuple[Check, ...]


def title(runs: Sequence[Run]) -> str:
    """Title of a study of speed."""
    return "Speed of a step, over " + ", ".join(dict.fromkeys(run.over for run in runs))


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults."""
    for key, package in {"method": METHODS, "over": METHODS, "material": MATERIALS, "transfer": TRANSFERS}.items():
        values[key] = canonical_name(package, values.get(key, getattr(Run, key)))
    values["smoothing"] = canonical_optional(SMOOTHINGS, values.get("smoothing", Run.smoothing))
    return values


def check(runs: Sequence[Run]) -> None:
    """Raise ValueError for a smoothing that the material of a run cannot have."""
    for run in runs:
        if run.smoothing != "none":
            create(SMOOTHINGS, run.smoothing).check(create(MATERIALS, run.material))


def examine(study: Study[Run], results: Mapping[str, Result], store: Store) -> BenchAnalysis:
    """Hold the bits of several threads against those of one; where one thread alone ran there is nothing to hold."""
    done = (results[run.digest] for run in study.runs if run.digest in results)
    name = "numbers that several threads change"
    return BenchAnalysis(tuple(
        Check(str(one.run), name, one.values.get("differ", nan), 0.0, "at_most", "one order of sums",
              failure=one.failure, unjudged="one_thread" if one.values.get("threads", 1.0) < 2 else "") for one in done
    ))  # fmt: skip
