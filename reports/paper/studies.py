"""Studies behind the paper's figures and tables, from studies.toml beside this, in full or quick."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.shipped import where
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.study_file import study_of
from mpm_verify.solver.plugins import meant

TABLE = Path(__file__).with_name("studies.toml")
FULL, QUICK = "full", "quick"


@dataclass(frozen=True)
class PaperStudy:
    """Study by its name, with the parts of the paper that it is behind, and the content of its file in full."""

    name: str
    parts: tuple[str, ...]
    content: Mapping[str, Any]
    quick: Mapping[str, Any]

    def build(self, mode: str, command: str) -> Study[Any]:
        """Build the study in full or quick. Raises ValueError."""
        content = merged(self.content, self.quick) if mode == QUICK else self.content
        return study_of(self.name, dict(content), command)


@cache
def studies() -> dict[str, PaperStudy]:
    """All studies by name, in the order of the paper."""
    found = {}
    for name, row in tomllib.loads(TABLE.read_text(encoding="utf-8")).items():
        own = {key: value for key, value in row.items() if key not in ("parts", "shipped", "quick")}
        file = tomllib.loads(where(row["shipped"]).read_text(encoding="utf-8")) if "shipped" in row else {}
        found[name] = PaperStudy(name, tuple(row["parts"]), file | own, row.get("quick", {}))
    return found


def chosen(only: str) -> list[PaperStudy]:
    """Studies of some parts, `4,5`, or by their names; all if empty. Raises ValueError for a part that is none."""
    wanted = [word.strip() for word in only.split(",") if word.strip()]
    known = [*sorted({part for one in studies().values() for part in one.parts}), *studies()]
    for word in wanted:
        if word not in known:
            raise ValueError(f"--only {word!r} is no part{meant(word, known)}; choose from {', '.join(known)}")
    return [one for one in studies().values() if not wanted or set(wanted) & {one.name, *one.parts}]


def merged(content: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Content with changes put in: tables by their keys, all else as it stands.

    A value that changes under [run] is taken out of [sweep] and of [[part]], and the other way round.
    """
    found = dict(content)
    for key, value in changes.items():
        both = isinstance(value, Mapping) and isinstance(found.get(key), Mapping)
        found[key] = {**found[key], **value} if both else value
    for one, other in (("run", "sweep"), ("sweep", "run")):
        if one in found and other in found:
            fixed = changes.get(other, {})
            found[one] = {key: value for key, value in found[one].items() if key not in fixed}
    return found


def names(of: Sequence[PaperStudy]) -> list[str]:
    """Names of studies."""
    return [one.name for one in of]
