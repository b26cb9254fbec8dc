"""The verdicts as JUnit XML, for CI servers: a test a judged quantity; what is not a PASS is a failure or an error."""

import os
from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from mpm_verify.cases.harness.checks import Examination
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.solver.plugins import on_screen


def check_junit(path: Path | None) -> None:
    """Raise ValueError now, and not when all runs are done, where the file cannot be written."""
    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"cannot write --junit {path}: {path.parent} is no folder that can be made") from error
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise ValueError(f"cannot write --junit {path}: name a file in a folder that can be written")


def write_junit(path: Path, study: Study, found: Sequence[Finding]) -> None:
    """Write the file; OSError where it cannot be written."""
    judged = [f for f in found if f.plan.judged]
    suite = ElementTree.Element("testsuite", name=study.name, tests=str(len(judged)))
    for finding in judged:
        d, v = finding.plan, finding.verdict
        name = f"{d.quantity} {d.norm}, {d.ppc} per cell"
        case = ElementTree.SubElement(
            suite, "testcase", classname=f"{study.name}.{d.method}.{on_screen(d.solution)}", name=name
        )
        if v.outcome is not Outcome.PASS:
            kind = "error" if v.outcome is Outcome.ERROR else "failure"
            ElementTree.SubElement(case, kind, type=str(v.outcome), message=v.reason)
        stall = [finding.stall.where + ".", *finding.stall.reasons] if finding.stall else []
        ElementTree.SubElement(case, "system-out").text = "\n".join([v.reason, *stall])
    outcomes = [f.verdict.outcome for f in judged]
    suite.set("errors", str(outcomes.count(Outcome.ERROR)))
    suite.set("failures", str(outcomes.count(Outcome.FAIL) + outcomes.count(Outcome.INCONCLUSIVE)))
    ElementTree.indent(suite)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)


def write_checks(path: Path, examination: Examination) -> None:
    """The checks of an examination as JUnit XML; OSError where it cannot be written."""
    checks = examination.checks
    suite = ElementTree.Element("testsuite", name=examination.name, tests=str(len(checks)))
    for check in checks:
        case = ElementTree.SubElement(suite, "testcase", classname=f"{examination.name}.{check.group}", name=check.name)
        if check.outcome is not Outcome.PASS:
            kind = "error" if check.outcome is Outcome.ERROR else "failure"
            message = f"{check.found:.8g}, expected {check.way} {check.expected:.8g}, {check.within:.3g}"
            ElementTree.SubElement(case, kind, type=str(check.outcome), message=message)
    outcomes = [check.outcome for check in checks]
    suite.set("errors", str(outcomes.count(Outcome.ERROR)))
    suite.set("failures", str(outcomes.count(Outcome.FAIL)))
    ElementTree.indent(suite)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)
