"""Words of an Examination: its lead, the notes of each group and its parameters, by the codes that it holds.

The words of a code `case.what` stand in the table REMARKS of the module of the case, beside this one.
"""

from collections.abc import Callable, Mapping
from importlib import import_module

from mpm_verify.cases.harness.checks import Examination, Remark

Numbers = Mapping[str, float | str]
Words = Callable[[Numbers], str]


def table(case: str) -> Mapping[str, Words]:
    """Words of a case by code."""
    found: Mapping[str, Words] = import_module(f"mpm_verify.reports.sentences.{case}").REMARKS
    return found


def sentence(remark: Remark) -> str:
    """Remark in words."""
    return table(remark.code.partition(".")[0])[remark.code](remark.numbers)


def lead(examination: Examination) -> str:
    """Lead: what came out."""
    return " ".join(sentence(remark) for remark in examination.findings if not remark.group)


def leads(examinations: Mapping[str, Examination]) -> list[str]:
    """Leads: what came out of each, with its name where there are several."""
    several = len(examinations) > 1
    return [f"{name}: {lead(one)}" if several else lead(one) for name, one in examinations.items()]


def notes(examination: Examination, group: str) -> list[str]:
    """Notes on a group, a paragraph each."""
    return [sentence(remark) for remark in examination.findings if remark.group == group]


def parameters(examination: Examination) -> dict[str, str]:
    """Parameters with their values, and what is to be said of each."""
    return {name: parameter(examination, name) for name in examination.parameters}


def parameter(examination: Examination, name: str) -> str:
    """Parameter such as `31`, or `0.65 (no effect)`."""
    value = examination.parameters[name]
    text = value if isinstance(value, str) else f"{value:.10g}"
    code = examination.origins.get(name)
    return text if code is None else f"{text} ({sentence(Remark(code))})"


def unread(n: Numbers) -> str:
    """Sentence on the figures of curves that are left out."""
    return left_out("curves", str(n["files"]))


def left_out(what: str, files: str) -> str:
    """Sentence on figures that are left out, as the files of what they show cannot be read."""
    return (
        f"The {what} in {files} cannot be read, and their figures are left out; once they are deleted with their "
        ".json files, the same command computes those runs again."
    )


def missed(n: Numbers) -> str:
    """Sentence such as `2 of 30 checks did not pass; they stand first`."""
    return f"{n['missed']:g} of {n['checks']:g} checks did not pass; they stand first."
