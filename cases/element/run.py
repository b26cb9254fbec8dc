"""Run and Result of an element test: its axes, and what its study in the strain step has found."""

from dataclasses import dataclass

from mpm_verify.cases.element.axes import AXES, CONFINED, PATH, PROPERTIES, ElementRun
from mpm_verify.cases.element.following import Stopped
from mpm_verify.cases.element.paths import PathSource
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.study import ResultRecord

__all__ = ["AXES", "CONFINED", "PATH", "PROPERTIES", "ElementResult", "ElementRun"]


@dataclass(frozen=True, kw_only=True)
class ElementResult(ResultRecord[ElementRun]):
    """Outcome of one test; curves are in the arrays, `curve/NAME` and `exact/NAME`.

    `source` of the exact curve, `stopped` where the test ends early, errors at the end by number of steps in
    `step_errors` and `counts`, what was read of a path's file, and for `properties` the checks of the material.
    """

    run: ElementRun
    source: str = ""
    stopped: Stopped | None = None
    counts: tuple[int, ...] = ()
    step_errors: tuple[float, ...] = ()
    read: PathSource | None = None
    checks: tuple[Check, ...] = ()
