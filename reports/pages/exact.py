"""Page of `verify exact`: each group of tests with its worst residuals, what each points to, and what is not asked."""

from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.exact.case import ExactRemark
from mpm_verify.cases.harness.checks import Examination
from mpm_verify.reports.components.examined import Section
from mpm_verify.reports.components.examined_study import page as examined_page
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import exact as said
from mpm_verify.reports.sentences.remarks import sentence
from mpm_verify.reports.words import sci

HEAD = ("test", "what it holds", "asked", "failed", "largest residual", "bound", "with", "points to")


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    return examined_page(record, sections)


def sections(examination: Examination, add: Add) -> Sequence[Section]:
    """Sections, one for each group of tests."""
    return [section(examination, group) for group in said.ALL_HEADINGS if group in examination.groups]


def section(examination: Examination, group: str) -> Section:
    """Section of a group."""
    mine = [one for one in examination.findings if one.group == group]
    rows = tuple(
        (
            str(one.numbers["test"]),
            sentence(one),
            str(one.numbers["asked"]),
            str(one.numbers["failed"]),
            sci(float(one.numbers["residual"])),
            sci(float(one.numbers["bound"])),
            f"{str(one.numbers['name']).partition(' ')[2]} {one.numbers['run']}".strip(),
            said.ALL_PARTS[str(one.numbers["part"])],
        )
        for one in mine
        if one.code == ExactRemark.HELD
    )
    left = [sentence(one) for one in mine if one.code == ExactRemark.NOT_ASKED]
    text = [f"Not asked: {' '.join(left)}"] if left else []
    table = Table("Tests", HEAD, rows, texts=("what it holds", "with", "points to"))
    return Section(group, said.ALL_HEADINGS[group], text, (), [table] if rows else [])
