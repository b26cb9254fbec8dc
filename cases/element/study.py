"""Study of the strain step of one element test: the errors at each number of steps, and the order."""

from dataclasses import dataclass
from math import log2
from typing import Any

import numpy as np

from mpm_verify.cases.element.begin import begin
from mpm_verify.cases.element.curves import columns, element_of
from mpm_verify.cases.element.exact import Columns, exact
from mpm_verify.cases.element.following import Followed, Stopped, follow
from mpm_verify.cases.element.paths import ElementTest

DOUBLED, FINE = (1, 2, 4, 8, 16), 64  # steps of the study, and of what stands for the truth where nothing is known
ROUND_OFF = 1e-9  # relative errors below it have no order


@dataclass(frozen=True)
class ElementStudy:
    """Study of one test: its curve, the exact one and its source, errors at each number of steps, and order.

    `curve` is empty where it cannot be read; an exact curve is known where `source` says what it is.
    """

    test: ElementTest
    curve: Columns
    failed: Stopped | None
    truth: Columns | None
    source: str
    steps: tuple[int, ...]
    errors: tuple[float, ...]

    @property
    def order(self) -> float:
        """Order between the two finest that are above round-off; not a number where there are none.

        Against the test's own curve the last is left out: a quarter of that curve's steps has too much of its error.
        """
        seen = [error for error in (self.errors if self.source else self.errors[:-1]) if error > ROUND_OFF]
        return log2(seen[-2] / seen[-1]) if len(seen) > 1 else float("nan")


def study(material: Any, test: ElementTest, stress: float, steps: int, start: str = "isotropic") -> ElementStudy:
    """Run the test with once, twice, ... sixteen times the steps."""
    element, begun = element_of(material, test), begin(material, test, stress, start)
    counts = tuple(n * test.steps(steps) for n in DOUBLED)
    runs = [follow(element, test, n, begun) for n in counts]
    known = exact(material, test, stress, begun)
    truth, source = known or (None, "")
    if truth is None and not any(run.failed for run in runs):
        finest = follow(element, test, FINE * counts[0], begun)
        truth_end = None if finest.failed else columns(test, finest)
    else:
        truth_end = truth
    errors = tuple(distance(test, run, truth_end) for run in runs)
    return ElementStudy(test, columns(test, runs[-1]), first_failure(runs), truth, source, counts, errors)


def first_failure(runs: list[Followed]) -> Stopped | None:
    """Failure of the finest run of those that ended early."""
    return next((run.failed for run in reversed(runs) if run.failed), None)


def distance(test: ElementTest, run: Followed, truth: Columns | None) -> float:
    """Error at the end of the path: of s and t over the largest stress, of the volume over the largest strain.

    Where lateral strains are found or stresses given also of the vertical strain; along a motion of the shear stress,
    and the stress at the start does not count in the largest, as it says nothing of what the rate makes.
    """
    if run.failed or truth is None:
        return float("nan")
    mine = columns(test, run)
    before = truth["s"][0] if test.motion else 0.0
    size = max(float(np.abs([truth["s"] - before, truth["t"]]).max()), 1e-300)
    stresses = ("s", "t", "tau") if test.motion else ("s", "t")
    strains = ("ev", "ey") if test.axial or test.mixed else ("ev",)
    stress = max(abs(mine[name][-1] - truth[name][-1]) for name in stresses) / size
    length = max(float(np.abs(run.strain - run.strain[0]).max()), 1e-300)
    return float(max(stress, *(abs(mine[name][-1] - truth[name][-1]) / length for name in strains)))
