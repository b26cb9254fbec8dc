"""Helper of the B-spline bases: how far behind a wall a particle may slip."""

from mpm_verify.solver._jit import kernel
from mpm_verify.solver.state import PAD


@kernel(inline=True)
def beyond(p, n):
    """1 if the position p, in cells, is half a cell or more behind a wall, or a NaN; 0 otherwise.

    Up to there the polynomials of the last cell go on. They have negative weights there, and further out nodes would
    get a negative mass.
    """
    return int(not (p > PAD - 0.5)) + int(not (p < n - 0.5 - PAD))
