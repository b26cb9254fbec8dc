"""Run and Result of a campaign: one defect in a copy of the package, and what each check answers."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from typing import ClassVar, Literal

from mpm_verify.cases.detect.defect import NONE, Defect, defects
from mpm_verify.cases.detect.mutate import mutant
from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.solver.plugins import METHODS

Sets = Literal["full", "quick"]
ORDERS, EXACT = ("axis_aligned", "clamped_shear"), ("exact",)
JUDGES = ("norms", "rule", "store", "numbers")  # known answers of what judges: they compute nothing with the solver
OTHERS = (*JUDGES, "benchmark", "derivation", "wave_bar", "column", "smoothing", "objectivity", "material")
CHECKS = {"full": (*ORDERS, *EXACT, *OTHERS), "quick": (*ORDERS, *EXACT, "rule", "norms")}
USUAL = "cpdi"
EACH = 7  # of the defects in a quick campaign


@cache
def one(name: str) -> Defect:
    """Defect of a table, or a mutant. Raises ValueError for another name."""
    if name.startswith("mutant:"):
        return mutant(name)
    if name not in defects():
        raise ValueError(f"no defect {name!r}; verify detect --list prints them, mutant:FILE:NUMBER is one of a file")
    return defects()[name]


@dataclass(frozen=True)
class Run(RunRecord):
    """One planted copy. Raises ValueError for a defect that is not there."""

    defect: str = axis("none", "Defects by name, see --list, or mutant:FILE:NUMBER; usual are all of them.")
    method: str = axis(USUAL, "Method that is examined; a defect of one method is examined with that.", METHODS)
    checks: Sets = axis("full", "Checks that are asked: full, or those of quick.")
    case: ClassVar[str] = "detect"

    def __post_init__(self) -> None:
        one(self.defect)

    @property
    def digest(self) -> str:
        """Name of the Result: parameters, the change, what is examined and the checks."""
        from mpm_verify.cases.detect.plant import examined

        planted = one(self.defect)
        change = repr((planted.file, planted.old, planted.new, planted.at))
        return self.named(examined() + sha256(change.encode()).hexdigest())

    @property
    def cost(self) -> float:
        """Particle updates that take as long, about 6 s."""
        return 2e7

    def __str__(self) -> str:
        return f"{self.defect}, {self.method}"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome: what each check said, a code for what it found first, and the processor time of the child in s.

    Beside the outcomes of verdicts there are CRASH and HANG, of the check at which the child ended, and NOT_RUN.
    """

    run: Run
    outcomes: dict[str, str] = field(default_factory=dict)
    evidence: dict[str, str] = field(default_factory=dict)


def asked(run: "Run") -> tuple[str, ...]:
    """Checks that a run is asked.

    A mistake in what judges is asked of the judge and of studies that it judges, as it changes nothing computed; one in
    the solver not of the judge, whose known answers compute nothing with it.
    """
    planted = one(run.defect)
    judges = (*ORDERS, *JUDGES, "benchmark")
    if planted.kind == "judge":
        return tuple(check for check in CHECKS[run.checks] if check in judges)
    return tuple(check for check in CHECKS[run.checks] if check not in JUDGES or not planted.file.startswith("solver/"))


def mixed(names: Iterable[str]) -> tuple[str, ...]:
    """Names in an order that mixes the parts: a campaign that is stopped has seen some of each."""
    return tuple(sorted(names, key=lambda name: (name != NONE, sha256(name.encode()).hexdigest())))


AXES = {"defect": mixed(defects())}
_kinds = {
    kind: [d.name for d in defects().values() if d.kind == kind] for kind in ("order", "robustness", "judge", "placebo")
}
QUICK = {"defect": tuple(name for names in _kinds.values() for name in names[::EACH]), "checks": ("quick",)}
