"""Page of a study that consists of Examinations: one after the other, with their names where there are several."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from mpm_verify.cases.harness.checks import Examination
from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports.components.examined import Section, Sections, render
from mpm_verify.reports.components.logs import failed
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.references import cited
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import leads

Overview = Callable[[Mapping[str, Examination], Add], Sequence[Section]]


def page(
    record: Record,
    sections: Sections,
    kinds: Sequence[str] = ("svg", "pdf", "png"),
    overview: Overview = lambda found, add: (),
) -> Path:
    """Write the page of `record.analysis.more.examinations`, `overview` of all first; its path. Raises StoreError."""
    found: Mapping[str, Examination] = record.analysis.more.examinations
    if not found:
        raise StoreError(f"{record.store.folder} holds no part that can be drawn: run its study to the end")

    def drawn(_: Examination, add: Add) -> Sequence[Section]:
        return [*overview(found, add), *every(found, sections, add)]

    return render(record.store.folder, whole(record, found), drawn, kinds, said=" ".join(leads(found)),
                  logs=failed(record), cite=cited(record))  # fmt: skip


def whole(record: Record, found: Mapping[str, Examination]) -> Examination:
    """All of them as one; parameters begin with the name of their Examination where there are several."""
    first, several = next(iter(found.values())), len(found) > 1
    named = [(f"{name}: " * several, one) for name, one in found.items()]
    return replace(
        first,
        title=record.study.title,
        checks=record.analysis.checks,
        findings=tuple(finding for one in found.values() for finding in one.findings),
        parameters={before + key: value for before, one in named for key, value in one.parameters.items()},
        origins={before + key: code for before, one in named for key, code in one.origins.items()},
    )


def every(found: Mapping[str, Examination], sections: Sections, add: Add) -> Sequence[Section]:
    """Sections of each, with its name in front where there are several."""
    if len(found) == 1:
        return sections(next(iter(found.values())), add)
    parts = []
    for number, (name, one) in enumerate(found.items(), 1):
        mine = sections(one, numbered(add, number))
        parts += [replace(part, key=f"{part.key}-{number}", heading=f"{name}: {part.heading}") for part in mine]
    return parts


def numbered(add: Add, number: int) -> Add:
    """Adder of figures with a number behind their names."""
    return lambda key, figure, alt: add(f"{key}_{number}", figure, alt)
