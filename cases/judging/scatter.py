"""Scatter of errors about a fit: how far they may be off by chance, from residuals, from replicates, or as is usual.

Residuals of few levels say little, and may be small by luck: Student's factor of two degrees of freedom at 97.5 % is
4.3. Most studies scatter by a few percent. So the scatter is taken to be the usual one, or that of the residuals where
they are larger. Residuals of twice the usual scatter refute it, and those of a tenth no luck can explain: then they are
taken as they are, with Student's factor. SciPy is imported where it is called.
"""

import numpy as np
from numpy.typing import NDArray

USUAL = 0.03  # relative scatter of an error by how particles lie in their cells
ROUGH = 2 * USUAL  # residuals of three degrees of freedom reach this in 0.7 % of studies that scatter as usual
SMOOTH = USUAL / 10  # residuals of three degrees of freedom are below this in 0.1 % of studies that scatter as usual
EXACT = 1e-12  # relative residuals below this are round-off; they stand for a perfect fit


def unusual(residual: float, dof: float) -> bool:
    """Whether residuals with this standard deviation refute the usual scatter; with two degrees of freedom sooner."""
    return residual > (ROUGH if dof > 2 else 0.75 * ROUGH) or residual < SMOOTH


def limit(residual: float, dof: float, confidence: float, noise: float | None = None) -> float:
    """Largest relative deviation by chance, one-sided.

    Parameters
    ----------
    residual, dof
        Standard deviation of relative residuals, and its degrees of freedom.
    confidence
        Such as 0.975.
    noise
        Relative scatter known from replicates; None where it is unknown and the usual one may hold.
    """
    from scipy.special import ndtri, stdtrit

    if noise is not None or unusual(residual, dof):
        return float(stdtrit(dof, confidence)) * max(residual, noise or 0.0, EXACT)
    return float(ndtri(confidence)) * max(residual, USUAL)


def about(x: NDArray[np.float64], y: NDArray[np.float64], degree: int) -> float:
    """Standard deviation of y (n,) about its least-squares polynomial in x; infinite with no degree of freedom left."""
    left = len(x) - degree - 1
    if left < 1:
        return float("inf")
    residual = y - np.polyval(np.polyfit(x, y, degree), x)
    return float(np.sqrt(residual @ residual / left))
