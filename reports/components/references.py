"""BibTeX of what a study used: this program, and the sources that its case and its plug-ins name by their DOIs."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mpm_verify.reports.components.page import TEMPLATES
from mpm_verify.reports.components.take import File, encoded
from mpm_verify.reports.frames import Record
from mpm_verify.solver.plugins import CASES, KINDS, available, folder, path, split

DOI = re.compile(r"doi:(10\.\d{4,9}/[^\s\"`]+)")


@dataclass(frozen=True)
class Cited:
    """BibTeX entries as one text, with a line for each DOI that has none; how many they are, and as a file."""

    text: str
    count: int
    file: File


def cited(record: Record) -> Cited:
    """Entries of what a study used, this program first."""
    known, used = entries(), dois(record)
    found = [known[doi] for doi in used if doi in known]
    missing = "".join(f"% doi:{doi}, no entry here\n" for doi in used if doi not in known)
    text = "\n".join(filter(None, [program(record), *found, missing]))
    return Cited(text, 1 + len(found), encoded("references.bib", "BibTeX", text.encode()))


def entries() -> dict[str, str]:
    """Entries of references.bib by DOI."""
    every = re.split(r"\n(?=@)", (TEMPLATES / "references.bib").read_text(encoding="utf-8"))
    return {re.findall(r"doi = \{(.*?)\}", entry)[0]: entry.strip() + "\n" for entry in every}


def dois(record: Record) -> list[str]:
    """DOIs in the files of the case and of the plug-ins of all runs, each once, in the order of the runs."""
    files = dict.fromkeys([*of_case(record.study.case), *(file for run in record.study.runs for file in plugins(run))])
    return list(dict.fromkeys(doi for file in files for doi in named(file.read_text(encoding="utf-8"))))


def of_case(case: str) -> list[Path]:
    """Files of a shipped case but its plug-ins, `case.py` first; a user's own names nothing that is known here."""
    if case not in available(CASES):
        return []
    file, apart = path(CASES, case), {folder(package) for package in KINDS if package != CASES}
    return [file, *(one for one in sorted(file.parent.rglob("*.py")) if one != file and one.parent not in apart)]


def plugins(run: Any) -> Iterator[Path]:
    """Files of the shipped plug-ins of a run."""
    for field, package in run.plugins.items():
        name = split(str(getattr(run, field)))[0]
        if name in available(package):
            yield path(package, name)


def named(text: str) -> Iterable[str]:
    """DOIs in a text, without the signs that end a sentence or a bracket."""
    for doi in DOI.findall(text):
        plain = doi.rstrip(".,;:")
        yield plain[:-1].rstrip(".,;:") if plain.endswith(")") and plain.count(")") > plain.count("(") else plain


def program(record: Record) -> str:
    """Entry of this program, with its version and the command of the study."""
    try:
        here = version("mpm-verify")
    except PackageNotFoundError:
        here = "not installed"
    commits = {result.environment.get("commit", "unknown") for result in record.results.values()}
    commit = next(iter(commits)) if len(commits) == 1 else "several"
    lines = {"title": "{mpm-verify}: verification and benchmarking of the material point method", "version": here,
             "note": f"Commit {commit}"}  # fmt: skip
    return "@software{mpm-verify,\n" + "".join(f"  {key} = {{{value}}},\n" for key, value in lines.items()) + "}\n"
