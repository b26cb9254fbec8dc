"""Check of a transfer from a user's file."""

from pathlib import Path
from typing import Any

from mpm_verify.solver.own_contract import arguments, below, real
from mpm_verify.solver.transfers._base import Transfer


def check(transfer: Any, path: Path) -> None:
    """Check its fraction of FLIP, and what its methods take. Raises OwnFileError with one line."""
    below(transfer, Transfer, path)
    real(transfer, "flip_fraction", path, 0.0, 1.0, "a number from 0 to 1, the fraction of FLIP")
    arguments(transfer, Transfer, path)
