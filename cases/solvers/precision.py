"""Precision of the numbers of an answer, found in the numbers themselves."""

import numpy as np

from mpm_verify.solver.state import Floats

FEW = 8  # different numbers, which may be of single precision by accident


def single(values: Floats) -> float:
    """Standard deviation of the rounding of a field (P,n) whose numbers are all of single precision, however printed.

    Zero for any other: more than a few have to differ, since zeros, ones and halves are of single precision too.
    """
    with np.errstate(over="ignore"):
        short = values.astype(np.float32)
    if not (short == values).all() or len(np.unique(short)) <= FEW:
        return 0.0
    return float(np.finfo(np.float32).eps * np.sqrt(np.mean(np.square(values)) * values.shape[1] / 12))
