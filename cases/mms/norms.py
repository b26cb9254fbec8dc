"""Error norms, computed here and nowhere else.

With e the error of a particle at a step, N_t steps and N_p particles (weights V0 / mean V0 where volumes differ):

    rms      sqrt(sum_n sum_p |e|^2 / (N_t N_p))      the norm that verdicts use
    max      max over n, p of |e|
    final    rms over the particles at the last step
    printed  sqrt(sum_n sum_p |e|^2) / (N_t N_p)      paper eq. (7) as printed: rms / sqrt(N_t N_p), so it shrinks with
                                                      every step and particle added; shown beside rms, never judged
|e| is the Euclidean norm for u and v, the Frobenius norm for F (2 x 2) and for sigma (3 x 3: xx, yy, zz, twice xy).
"""

from dataclasses import dataclass, field
from math import sqrt

import numpy as np
from numba import prange

from mpm_verify.cases.mms.run import QUANTITIES
from mpm_verify.mms.exact import ROOM, Exact
from mpm_verify.solver._jit import BLOCK, F1, F2, F3, i8, kernel, nothing
from mpm_verify.solver.state import Floats, Particles

CHUNK = 128 * BLOCK  # particles of one partial sum; fixed, so that the sums have one order for any number of threads
SUMS = 8  # sums of squared errors of u, v, F, sigma, and the largest ones


@kernel(inline=True)
def tally(lanes, q, b, weight, square):
    """Add one squared error of quantity q to the sums of lane b."""
    lanes[q * BLOCK + b] += weight * square
    largest = lanes[(4 + q) * BLOCK + b]
    lanes[(4 + q) * BLOCK + b] = square if square > largest else largest


@kernel(nothing(F1, F1, F1, F1, F1, F1, F1, F1, F1))
def tally_block(out, X, x, v, F, sigma, V0, b, lanes):
    """Tally the squared errors of a block, all arrays flat; short loops over few arrays, so that each vectorises."""
    n = V0.shape[0]
    for i in range(n):
        ex = x[2 * i] - X[2 * i] - out[i]
        ey = x[2 * i + 1] - X[2 * i + 1] - out[BLOCK + i]
        tally(lanes, 0, i, V0[i], ex * ex + ey * ey)
    for i in range(n):
        ex = v[2 * i] - out[2 * BLOCK + i]
        ey = v[2 * i + 1] - out[3 * BLOCK + i]
        tally(lanes, 1, i, V0[i], ex * ex + ey * ey)
    for i in range(n):
        exx = F[4 * i] - out[4 * BLOCK + i]
        exy = F[4 * i + 1] - out[5 * BLOCK + i]
        eyx = F[4 * i + 2] - out[6 * BLOCK + i]
        eyy = F[4 * i + 3] - out[7 * BLOCK + i]
        tally(lanes, 2, i, V0[i], exx * exx + exy * exy + eyx * eyx + eyy * eyy)
    for i in range(n):
        exx = sigma[4 * i] - out[8 * BLOCK + i]
        eyy = sigma[4 * i + 1] - out[9 * BLOCK + i]
        ezz = sigma[4 * i + 2] - out[10 * BLOCK + i]
        exy = sigma[4 * i + 3] - out[11 * BLOCK + i]
        tally(lanes, 3, i, V0[i], exx * exx + eyy * eyy + ezz * ezz + 2.0 * exy * exy)
    for i in range(n):
        b[2 * i] = out[12 * BLOCK + i]
        b[2 * i + 1] = out[13 * BLOCK + i]


@kernel(nothing(Exact, i8, i8, F2, F1, F2, F2, F2, F3, F2, F1, F2, F1))
def compare_chunk(exact, start, end, carried, scalars, X, x, v, F, sigma, V0, b, sums):
    """Write the sums (8,) of the particles start ... end-1."""
    width = carried.shape[1]
    columns = carried.reshape(-1)
    Xs, xs, vs, bs = X.reshape(-1), x.reshape(-1), v.reshape(-1), b.reshape(-1)
    Fs, sigmas = F.reshape(-1), sigma.reshape(-1)
    out = np.empty(ROOM * BLOCK)
    lanes = np.zeros(SUMS * BLOCK)
    for lo in range(start, end, BLOCK):
        hi = min(lo + BLOCK, end)
        exact(columns[lo * width : hi * width], scalars, hi - lo, out)
        tally_block(
            out, Xs[2 * lo : 2 * hi], xs[2 * lo : 2 * hi], vs[2 * lo : 2 * hi], Fs[4 * lo : 4 * hi],
            sigmas[4 * lo : 4 * hi], V0[lo:hi], bs[2 * lo : 2 * hi], lanes,
        )  # fmt: skip
    for q in range(4):
        sums[q] = lanes[q * BLOCK : (q + 1) * BLOCK].sum()
        sums[4 + q] = lanes[(4 + q) * BLOCK : (5 + q) * BLOCK].max()


@kernel(nothing(Exact, F2, F1, F2, F2, F2, F3, F2, F1, F2, F2), parallel=True)
def compare(exact, carried, scalars, X, x, v, F, sigma, V0, b, sums):
    """Write the body force to b, and the squared errors of each chunk to sums (chunks, 8)."""
    for c in prange(sums.shape[0]):
        start = c * CHUNK
        end = min(X.shape[0], start + CHUNK)
        compare_chunk(exact, start, end, carried, scalars, X, x, v, F, sigma, V0, b, sums[c])


@dataclass
class Norms:
    """Sums over the steps so far; `particles` and their mean volume make them means."""

    particles: int
    volume: float  # mean V0
    steps: int = 0
    squares: Floats = field(default_factory=lambda: np.zeros(4))
    largest: Floats = field(default_factory=lambda: np.zeros(4))
    last: Floats = field(default_factory=lambda: np.zeros(4))

    def add(self, sums: Floats) -> None:
        """Add one step: `sums` (chunks, 8) from compare."""
        self.steps += 1
        self.last = sums[:, :4].sum(axis=0) / self.volume
        self.squares += self.last
        self.largest = np.maximum(self.largest, sums[:, 4:].max(axis=0))

    def errors(self) -> dict[str, dict[str, float]]:
        """Every norm of every quantity."""
        points = max(1, self.steps) * self.particles
        return {
            quantity: {
                "rms": sqrt(self.squares[q] / points),
                "max": sqrt(self.largest[q]),
                "final": sqrt(self.last[q] / self.particles),
                "printed": sqrt(self.squares[q]) / points,
            }
            for q, quantity in enumerate(QUANTITIES)
        }


def new_sums(particles: Particles) -> Floats:
    """Room for the sums of all chunks, (chunks, 8)."""
    return np.zeros((-(-len(particles) // CHUNK), SUMS))
