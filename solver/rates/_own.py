"""Class of a rate from a user's file, with its kernels checked."""

from pathlib import Path
from typing import Any

from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate
from mpm_verify.solver.own_contract import kernel
from mpm_verify.solver.own_file import OwnFileError
from mpm_verify.solver.plugins import RATES, own_class


def load(path: Path) -> type[Rate]:
    """Class of the file. Raises OwnFileError with one line where its kernels are not what a rate has."""
    rate: Any = own_class(RATES, path)
    kernel(rate, "unrotate", path, UNROTATE, "UNROTATE")
    kernel(rate, "rotate", path, ROTATE, "ROTATE")
    if isinstance(rate.order, bool) or not isinstance(rate.order, int | float):
        raise OwnFileError(f"{path}: order = {rate.order!r} must be a number, the order in time of the stress")
    chosen: type[Rate] = rate
    return chosen
