"""Verdicts and checks as JUnit XML, for CI servers, a test each; what is not a PASS is a failure or an error."""

import os
from collections import Counter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.reports import words
from mpm_verify.reports.components.logs import failed
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, failures, own_solver, stalls


def writable(path: Path | None, option: str) -> None:
    """Raise ValueError now, and not when all runs are done, where a file cannot be written."""
    if path is None:
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(
            f"cannot write {option} {path}: {path.parent} cannot be made; name a file in a folder that can be written"
        ) from error
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise ValueError(f"cannot write {option} {path}: name a file in a folder that can be written")


def write_junit(path: Path, record: Record) -> None:
    """Write the file; OSError where it cannot be written. Times are those of the runs, as stored."""
    study, found = record.study, record.analysis
    suite = ElementTree.Element("testsuite", name=study.name, tests=str(len(found.outcomes)))
    for finding in (f for f in found.findings if f.counts):
        _verdict(suite, record, finding)
    for check in found.checks:
        _check(suite, study.name, check)
    told_apart(suite)
    suite.set("errors", str(found.outcomes.count(Outcome.ERROR)))
    suite.set("failures", str(found.outcomes.count(Outcome.FAIL) + found.outcomes.count(Outcome.INCONCLUSIVE)))
    suite.set("time", f"{sum(result.wall_s for result in record.results.values()):.3f}")
    ElementTree.indent(suite)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)


def told_apart(suite: Any) -> None:
    """Give tests of one name, as a case of somebody's own may have, their number: servers show one of them alone."""
    seen: Counter[tuple[str, str]] = Counter()
    for case in suite:
        name = case.get("classname"), case.get("name")
        seen[name] += 1
        if seen[name] > 1:
            case.set("name", f"{name[1]} ({seen[name]})")


def _verdict(suite: Any, record: Record, finding: Finding) -> None:
    """Test of a judged quantity; its time is that of its levels."""
    plan, v = finding.plan, finding.verdict
    names = [str(value) for key, value in record.columns(plan.run).items() if key != "ppc"]
    case = ElementTree.SubElement(
        suite, "testcase", classname=".".join([record.study.name, *names]),
        name=words.measured(plan, " ") + (f", {plan.run.ppc} per cell" if hasattr(plan.run, "ppc") else ""),
        time=f"{sum(result.wall_s for result in finding.results if result):.3f}",
    )  # fmt: skip
    said = commands.reason(record.study, finding)
    if v.outcome is not Outcome.PASS:
        kind = "error" if v.outcome is Outcome.ERROR else "failure"
        ElementTree.SubElement(case, kind, type=str(v.outcome), message=said)
    stall = [stalls.where(finding.stall) + ".", *stalls.reasons(finding.stall)] if finding.stall else []
    hints = own_solver.hints(result for result in finding.results if result)
    logs = map(str, failed(record, finding.results))
    ElementTree.SubElement(case, "system-out").text = "\n".join([said, *stall, *hints, *logs])


def _check(suite: Any, study: str, check: Check) -> None:
    """Test of a check."""
    case = ElementTree.SubElement(suite, "testcase", classname=f"{study}.{check.group}", name=check.name, time="0")
    if check.outcome is not Outcome.PASS:
        kind = "error" if check.outcome is Outcome.ERROR else "failure"
        message = f"{check.found:.8g}, expected {words.way(check.way)} {check.expected:.8g}, {check.within:.3g}"
        if check.failure:
            message = failures.failure(check.failure)
        ElementTree.SubElement(case, kind, type=str(check.outcome), message=message)
