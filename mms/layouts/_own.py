"""Check of a layout from a user's file."""

from pathlib import Path
from typing import Any

from mpm_verify.mms.layouts.uniform import Uniform
from mpm_verify.solver.own_contract import arguments


def check(layout: Any, path: Path) -> None:
    """Check what its methods take. Raises OwnFileError with one line."""
    arguments(layout, Uniform, path)
