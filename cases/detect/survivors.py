"""Survivors among the mutants that somebody has looked at: why nothing can see them, or what does not see them.

The table survivors.toml has a row for each: file, old, new and at, as of a Defect, and either `equivalent` with the
reason, or `gap` with what a check would have to ask. A mutant that is in no row has not been looked at.
"""

import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from mpm_verify.cases.detect.defect import Defect

FILE = Path(__file__).with_name("survivors.toml")
Key = tuple[str, str, str, int]


@cache
def table() -> Mapping[Key, tuple[str, str]]:
    """Reasons by change: of equivalence, and of a gap; one of the two is empty."""
    rows = tomllib.loads(FILE.read_text(encoding="utf-8")).get("survivor", [])
    return {(r["file"], r["old"], r["new"], r.get("at", 0)): (r.get("equivalent", ""), r.get("gap", "")) for r in rows}


def equivalent(one: Defect) -> str:
    """Reason why nothing can see a defect; empty where something should."""
    return one.equivalent or table().get((one.file, one.old, one.new, one.at), ("", ""))[0]
