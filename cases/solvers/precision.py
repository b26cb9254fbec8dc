"""Precision of the numbers of an answer, found in the numbers themselves."""

import numpy as np

from mpm_verify.solver.state import Floats

FEW = 8  # different numbers, which may be of single precision by accident


def single(values: Floats) -> Floats:
    """Last digits of a field (P,n) whose numbers are all of single precision, however printed; zero of any other.

    More than a few have to differ, since zeros, ones and halves are of single precision too.
    """
    with np.errstate(over="ignore"):
        short = values.astype(np.float32)
    known = (short == values).all() and len(np.unique(short)) > FEW
    return np.abs(values) * float(np.finfo(np.float32).eps) if known else np.zeros_like(values)
