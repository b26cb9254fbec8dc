"""Studies of the column that ship: by file names, so that nothing heavy is imported to list or complete them."""

import tomllib

from mpm_verify.solver.source_hash import TOP

STUDIES = TOP / "cases" / "column" / "studies"


def shipped() -> list[str]:
    """Their names."""
    return sorted(file.stem for file in STUDIES.glob("*.toml"))


def title(study: str) -> str:
    """What a study calls itself."""
    return str(tomllib.loads((STUDIES / f"{study}.toml").read_text(encoding="utf-8"))["title"])
