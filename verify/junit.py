"""The verdicts as JUnit XML, for CI servers: a test a judged quantity; what is not a PASS is a failure or an error."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from cases.records import Outcome
from cases.study import Study
from cases.verdicts import Finding


def write_junit(path: Path, study: Study, found: Sequence[Finding]) -> None:
    """Write the file; OSError where it cannot be written."""
    judged = [f for f in found if f.declared.judged]
    suite = ElementTree.Element("testsuite", name=study.name, tests=str(len(judged)))
    for finding in judged:
        d, v = finding.declared, finding.verdict
        name = f"{d.quantity} {d.norm}, {d.ppc} per cell"
        case = ElementTree.SubElement(suite, "testcase", classname=f"{study.name}.{d.method}.{d.solution}", name=name)
        if v.outcome is not Outcome.PASS:
            kind = "error" if v.outcome is Outcome.ERROR else "failure"
            ElementTree.SubElement(case, kind, type=str(v.outcome), message=v.reason)
        ElementTree.SubElement(case, "system-out").text = v.reason
    outcomes = [f.verdict.outcome for f in judged]
    suite.set("errors", str(outcomes.count(Outcome.ERROR)))
    suite.set("failures", str(outcomes.count(Outcome.FAIL) + outcomes.count(Outcome.INCONCLUSIVE)))
    ElementTree.indent(suite)
    path.parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)
