"""Comparison with references, for the command and for Python: the run, the references, the page."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpm_verify.cases.mms.case import canonical, check
from mpm_verify.cases.mms.digits import reference
from mpm_verify.cases.mms.digits.examine import Examined, Tick, examine
from mpm_verify.cases.mms.digits.records import Compared
from mpm_verify.cases.mms.digits.reference import Scheme
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.discretisation import axisymmetric
from mpm_verify.reports.export.digits import document
from mpm_verify.reports.sentences import digits
from mpm_verify.solver.plugins import METHODS, SOLUTIONS, TRANSFERS, create, label
from mpm_verify.solver.plugins import canonical as canonical_name
from mpm_verify.solver.stress_update import check_stress_update


def run_of(solver: str | Callable[..., Any], solution: str, material: str | None, **more: Any) -> Run:
    """Run of a solver in a case, checked as a study does it. Raises ValueError."""
    if callable(solver):
        from mpm_verify.cases.solvers.callables import register

        solver = register(solver)
    named = canonical({"solver": solver, "solution": solution, "material": material or ""})
    around = axisymmetric(create(SOLUTIONS, named["solution"]))
    if named["dim"] != 2 or around:
        count = "one dimension" if named["dim"] == 1 else "three dimensions"
        told = (
            "is axisymmetric, and the reference is in plane strain" if around else f"has {count}, and the reference two"
        )
        raise ValueError(f"{solution} {told}; choose --solution clamped_shear:G=0.05")
    run = Run(**named, **more)
    check([run])
    return run


def schemes_of(methods: Sequence[str], stresses: Sequence[str], transfers: Sequence[str]) -> tuple[Scheme, ...]:
    """References that are asked for; the usual ones where a list is empty. Raises ValueError."""
    for word in filter(None, stresses):
        check_stress_update(word)
    return reference.schemes(
        [canonical_name(METHODS, name) for name in methods if name] or reference.METHODS,
        [word for word in stresses if word] or reference.STRESSES,
        [canonical_name(TRANSFERS, name) for name in transfers if name] or reference.TRANSFERS,
    )


def examined_of(
    run: Run, chosen: Sequence[Scheme], stored: bool, threads: int = 1, tick: Tick = lambda done, of: None
) -> Examined:
    """Comparison of a run with references. Raises ValueError."""
    from mpm_verify.solver._jit import use_threads
    from mpm_verify.verify.run import check_count

    check_count(threads, "--threads")
    use_threads(threads)
    return examine(run, chosen, stored, tick)


def name_of(examined: Examined) -> str:
    """Name of the folder of a comparison."""
    run = examined.run
    return re.sub(r"[^\w.=-]+", "-", f"compare-{run.method}-{label(run.solution)}-{run.cells}")


def page_of(examined: Examined, folder: Path, command: str) -> Path:
    """Page of a comparison in its folder. Raises StoreError."""
    from mpm_verify.reports.pages._digits import page

    return page(examined, folder, command)


@dataclass(frozen=True)
class Comparison:
    """Comparison of a solver with references.

    Parameters
    ----------
    examined
        What was found.
    command
        Call that repeats it.
    """

    examined: Examined
    command: str

    @property
    def compared(self) -> Compared:
        """Digits by quantity of each reference, the nearest first; where the two part."""
        return self.examined.compared

    @property
    def outcome(self) -> str:
        """agrees, parts, few_digits, failed or no_reference."""
        return str(self.compared.outcome)

    @property
    def exit_code(self) -> int:
        """Exit code of the command that does the same."""
        return int(self.document["exit_code"])

    @property
    def nearest(self) -> str:
        """Nearest reference, such as `MPM, usl, flip`; empty where there is none."""
        return digits.scheme(self.compared.nearest.scheme) if self.compared.against else ""

    @property
    def sentences(self) -> list[str]:
        """Lines on what came out, where the two part, and what is not told apart."""
        return [digits.outcome(self.compared), *digits.sentences(self.compared)]

    @property
    def document(self) -> dict[str, Any]:
        """Content of --json."""
        return document(self.examined.run, self.compared)

    def check(self) -> None:
        """Raise AssertionError with the sentences, unless a reference agrees; for a test of your own."""
        if self.outcome != "agrees":
            raise AssertionError("\n".join(self.sentences))

    def page(self, folder: Path | str = "") -> Path:
        """Draw the page, report.html, with its figure; usual is a folder in results/. Raises StoreError."""
        from mpm_verify.verify.run import folder_of

        return page_of(self.examined, folder_of(name_of(self.examined), Path(folder) if folder else None), self.command)

    def __repr__(self) -> str:
        return f"<{self.outcome}: {digits.outcome(self.compared)}>"
