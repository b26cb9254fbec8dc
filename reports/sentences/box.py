"""Words of sand in a box: its statement, captions, and failing controls."""

from inspect import getdoc
from types import ModuleType

from mpm_verify.cases.box import case
from mpm_verify.cases.box.case import SPOILT, named
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import must_fail
from mpm_verify.reports.words import paragraphs

SAND = (
    "The sand at the end of its run. White: a particle without any stress. The colour is its own vertical stress over "
    "that of the whole column at the floor, where sand at rest has 1; the dashes are at the height of the column."
)
ROWS = (
    "Rows are sevenths of the column, means over the last tenth of the time. Shaded: what is asked, where it is "
    "judged: of K for the rows below two thirds of the height together. The sums on the left are those of the forces "
    "on the grid, and say nothing of single particles."
)
TIMES = "How it came to rest. Shaded: what is asked at the end, where it is judged."
NOTES = (
    "Void: the mean void strain, volume that no grain fills; dilation: the mean plastic one. The area is the mean of "
    "det F, which is 1 and both, less what the weight compresses. Largest: that of any particle over the mean of the "
    "lowest row."
)


def statement(module: ModuleType = case) -> list[str]:
    """Statement of the problem, which is the docstring of the case."""
    return paragraphs(getdoc(module) or "")


def control(record: Record) -> str:
    """Sentence on failing controls, by the weight in the lower rows alone: sound sand may miss the rest."""
    checks = record.analysis.checks
    names = dict.fromkeys(named(record.study, run) for run in record.study.runs if run.control)
    return must_fail.said({name: [one.outcome for one in checks if one.group == name and one.name in SPOILT]
                           for name in names})  # fmt: skip
