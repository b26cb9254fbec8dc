"""Studies from TOML files: a case, what all runs share, and axes, whose product is run.

    case = "column"                   # column, unless it is said
    title = "Run-out against damping"
    words = ["What the study is for.", "A sentence or more."]
    finish = 4                        # runs that must come to their end; all, unless it is said
    replicates = 1                    # of each point of a refinement

    [run]                             # fields of the case's Run
    ppc = 9

    [sweep]                           # fields of the case's Run, a list of values each
    damping = [0.0, 0.02, 0.05, 0.10]

A file with several [[part]], each with a [part.run] and a [part.sweep], runs their union.
Those of the paper's figures, and some more, ship with the project, in cases/<case>/studies.
"""

import tomllib
from pathlib import Path
from typing import Any

from mpm_verify.cases.harness.build import Asked, union
from mpm_verify.cases.harness.shipped import shipped, where
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import meant

KEYS = ("case", "title", "words", "finish", "replicates", "run", "sweep", "part")
CASE = "column"


def read(source: str, command: str) -> Study[Any]:
    """Study of a file, or of a shipped name. Raises ValueError with one line for what is wrong with it."""
    if not source.endswith(".toml") and source not in shipped():
        near, names = meant(source, shipped()), ", ".join(shipped())
        raise ValueError(f"no study {source!r}{near}; choose from {names}, or give a file: path/to/own.toml")
    path = Path(source) if source.endswith(".toml") else where(source)
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise ValueError(f"cannot read {path}: {(error.strerror or str(error)).lower()}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path} cannot be read as TOML: {error}") from None
    try:
        return study_of(path.stem, content, command)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None


def study_of(name: str, content: dict[str, Any], command: str) -> Study[Any]:
    """Study of the content of such a file. Raises ValueError."""
    known(content, KEYS, "the file")
    case, title = content.get("case", CASE), content.get("title", name.replace("_", " "))
    words, replicates = content.get("words", []), content.get("replicates", 1)
    if not isinstance(title, str) or not isinstance(case, str):
        raise ValueError(f"case and title must be text, not {case!r} and {title!r}")
    if not isinstance(words, list) or not all(isinstance(word, str) for word in words):
        raise ValueError(f"words must be a list of sentences, not {words!r}")
    if isinstance(replicates, bool) or not isinstance(replicates, int):
        raise ValueError(f"replicates = {replicates!r} must be a whole number")
    parts = content.get("part", [{}])
    if not isinstance(parts, list) or not parts or not all(isinstance(part, dict) for part in parts):
        raise ValueError("part must be tables, [[part]] each")
    asked = []
    for part in parts:
        known(part, ("run", "sweep"), "[[part]]")
        shared = table(content, "run") | table(part, "run")
        sweep = table(content, "sweep") | table(part, "sweep")
        asked.append(Asked(case, values(shared, sweep), replicates))
    return union(asked, command, name, title, words, content.get("finish"))


def values(shared: dict[str, Any], sweep: dict[str, Any]) -> dict[str, list[Any]]:
    """Values by axis. Raises ValueError."""
    both = sorted(shared.keys() & sweep.keys())
    if both:
        raise ValueError(f"{both[0]} must stand in [run] or in [sweep], not in both")
    for key, chosen in sweep.items():
        if not isinstance(chosen, list) or not chosen:
            raise ValueError(f"{key} in [sweep] must be a list of one value or more, not {chosen!r}")
    frozen = {key: [tuple(v) if isinstance(v, list) else v for v in chosen] for key, chosen in sweep.items()}
    return {key: [tuple(v) if isinstance(v, list) else v] for key, v in shared.items()} | frozen


def known(content: dict[str, Any], allowed: tuple[str, ...], part: str) -> None:
    """Raise ValueError for a key that is not allowed."""
    for key in content:
        if key not in allowed:
            raise ValueError(f"{part} has {key!r}{meant(key, allowed)}, and may have {', '.join(allowed)}")


def table(content: dict[str, Any], part: str) -> dict[str, Any]:
    """Table of the file by its name. Raises ValueError for anything else."""
    found = content.get(part, {})
    if not isinstance(found, dict):
        raise ValueError(f"{part} must be a table, [{part}], not {found!r}")
    return found
