"""Folder of studies: of each its verdict, what came out in a line, when it was last written, and its page."""

from dataclasses import dataclass
from datetime import UTC, datetime
from os.path import relpath
from pathlib import Path

from mpm_verify.cases.harness.store import StoreError
from mpm_verify.reports.components.cards import summary
from mpm_verify.reports.frames import Record, read
from mpm_verify.reports.sentences.headline import EARLIER, headline, passed

UNREADABLE = "UNREADABLE"


@dataclass(frozen=True)
class Entry:
    """Study in a folder; `date` as ISO 8601 in UTC, `page` a path from the folder, empty where none is drawn."""

    folder: str
    case: str
    title: str
    outcome: str
    headline: str
    runs: str
    date: str
    page: str


def entries(folder: Path) -> list[Entry]:
    """Studies in a folder and those below it, the last written first. Raises ValueError where there is none."""
    if not folder.is_dir():
        raise ValueError(f"{folder} is not a folder; give one with a study below it, such as results")
    found = [entry(folder, path.parent) for path in folder.rglob("study.json")]
    if not found:
        raise ValueError(f"{folder} has no study below it; give the folder that holds studies, such as results")
    return sorted(found, key=lambda one: (one.date, one.folder), reverse=True)


def entry(folder: Path, study: Path) -> Entry:
    """Study as it is told; one that cannot be read says why."""
    name, page = relpath(study, folder), study / "report.html"
    link = relpath(page, folder) if page.exists() else ""
    try:
        record = read(study)
        outcome, said = str(record.analysis.outcome), line(record)
    except (StoreError, ValueError) as error:
        return Entry(name, "", name, UNREADABLE, str(error), "", written(study), link)
    runs = f"{len(record.study.runs) - len(record.missing)} of {len(record.study.runs)}"
    return Entry(name, record.study.case, record.study.title, outcome, said, runs, written(study), link)


def line(record: Record) -> str:
    """Line on what came out: what methods do where orders are judged, and how many checks pass."""
    judged = headline(record) or (summary(record) if record.study.plans else "")
    return " ".join(filter(None, [judged, passed(record.analysis.checks), EARLIER if record.earlier else ""]))


def written(study: Path) -> str:
    """Time at which the study or its last Result was written, to the minute."""
    files = [study / "study.json", *study.glob("runs/*.json")]
    last = max(file.stat().st_mtime for file in files)
    return datetime.fromtimestamp(last, UTC).strftime("%Y-%m-%d %H:%M")
