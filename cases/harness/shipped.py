"""Studies that ship, by file names, so that nothing heavy is imported to list or complete them."""

import tomllib
from pathlib import Path
from typing import Any

from mpm_verify.solver.plugins import CASES, folder


def files() -> dict[str, Path]:
    """File of each study by its name."""
    return {file.stem: file for file in sorted(folder(CASES).glob("*/studies/*.toml"), key=lambda file: file.stem)}


def shipped() -> list[str]:
    """Names of the studies that ship."""
    return list(files())


def where(study: str) -> Path:
    """File of a study that ships."""
    return files()[study]


def title(study: str) -> str:
    """Title of a study."""
    content: dict[str, Any] = tomllib.loads(where(study).read_text(encoding="utf-8"))
    return str(content["title"])
