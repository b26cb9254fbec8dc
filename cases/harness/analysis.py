"""Analysis of a study that has run: verdicts of the order rule, checks of the case, and the exit code of both."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.controls import Control, controls
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import ResultRecord, Study
from mpm_verify.cases.harness.verdicts import Finding, findings
from mpm_verify.cases.judging.records import Outcome, worst

EXIT = {Outcome.PASS: 0, Outcome.FAIL: 1, Outcome.INCONCLUSIVE: 3, Outcome.ERROR: 4}


@dataclass(frozen=True)
class Analysis:
    """Verdicts and checks: `findings` of the order rule with their `controls`, `checks` of the case, `more` or None."""

    findings: tuple[Finding, ...] = ()
    checks: tuple[Check, ...] = ()
    more: Any = None
    controls: tuple[Control, ...] = ()

    @property
    def outcomes(self) -> list[Outcome]:
        """Outcomes of all that decides."""
        return [f.verdict.outcome for f in self.findings if f.counts] + [check.outcome for check in self.checks]

    @property
    def outcome(self) -> Outcome:
        """Worst of the outcomes, a FAIL before an ERROR; INCONCLUSIVE where nothing is judged."""
        return worst(self.outcomes)

    @property
    def exit_code(self) -> int:
        """Exit code: 0 pass, 1 fail, 3 inconclusive or nothing judged, 4 nothing to judge, as runs ended in error."""
        return EXIT[self.outcome]


def analyse(study: Study[Any], results: Mapping[str, ResultRecord[Any]], store: Store) -> Analysis:
    """Judge what is stored; `results` by digest, those not there are runs not done."""
    case = case_named(study.case)
    more = case.examine(study, results, store) if case.examine else None
    found = tuple(findings(study, results)) if study.plans else ()
    spoilt = controls(study, results, found, lambda finding: Analysis((finding,)).exit_code == 0)
    return Analysis(found, tuple(more.checks) if more else (), more, spoilt)
