"""Check of a smoothing from a user's file."""

from pathlib import Path
from typing import Any

from mpm_verify.solver.own_contract import arguments, below
from mpm_verify.solver.smoothing._base import Smoothing


def check(smoothing: Any, path: Path) -> None:
    """Check what its methods take. Raises OwnFileError with one line."""
    below(smoothing, Smoothing, path)
    arguments(smoothing, Smoothing, path)
