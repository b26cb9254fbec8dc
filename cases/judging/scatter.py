"""Scatter of errors about a fit: how far they may be off by chance, from residuals and what is usual, or replicates.

Residuals of few levels say little, and may be small by luck: Student's factor of two degrees of freedom at 97.5 % is
4.3. Most studies scatter by a few percent. So the usual scatter counts as if it had been measured, with KNOWN degrees
of freedom, and is pooled with that of the residuals. Those of a tenth of it no luck explains: they are taken as they
are. SciPy is imported where it is called.
"""

import numpy as np
from numpy.typing import NDArray

USUAL = 0.03  # relative scatter of an error by how particles lie in their cells
KNOWN = 4.0  # degrees of freedom that it is worth: what a study of six levels says itself
SMOOTH = USUAL / 10  # residuals of two degrees of freedom are below it in 0.5 % of studies that scatter as usual
EXACT = 1e-12  # relative residuals below this are round-off; they stand for a perfect fit


def pooled(residual: float, dof: float) -> tuple[float, float]:
    """Standard deviation of an error by chance and its degrees of freedom, from residuals and the usual scatter.

    Parameters
    ----------
    residual, dof
        Standard deviation of relative residuals, and its degrees of freedom.

    References
    ----------
    Smyth (2004), Stat. Appl. Genet. Mol. Biol. 3, 3, doi:10.2202/1544-6115.1027 (moderated t)
    """
    if residual < SMOOTH:
        return max(residual, EXACT), dof
    total = KNOWN + dof
    return float(np.sqrt((KNOWN * USUAL**2 + dof * residual**2) / total)), total


def limit(residual: float, dof: float, confidence: float, noise: float | None = None) -> float:
    """Largest relative deviation by chance, one-sided.

    Parameters
    ----------
    residual, dof
        Standard deviation of relative residuals, and its degrees of freedom.
    confidence
        Such as 0.975.
    noise
        Relative scatter known from replicates; None where it is unknown and the usual one is pooled.
    """
    from scipy.special import stdtrit

    scatter, dof = pooled(residual, dof) if noise is None else (max(residual, noise, EXACT), dof)
    return float(stdtrit(dof, confidence)) * scatter


def about(x: NDArray[np.float64], y: NDArray[np.float64], degree: int) -> float:
    """Standard deviation of y (n,) about its least-squares polynomial in x; infinite with no degree of freedom left."""
    left = len(x) - degree - 1
    if left < 1:
        return float("inf")
    residual = y - np.polyval(np.polyfit(x, y, degree), x)
    return float(np.sqrt(residual @ residual / left))
