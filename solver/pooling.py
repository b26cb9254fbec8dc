"""Pooling: the particles of a cell open, or are compressed, together.

The grid holds the mean of a cell, and nothing what its particles differ by: as they pass through cells, the volume
strain w = void - elastic compression of each takes a random walk, and as it has no stress above zero, most of them are
open in the end while a few carry everything. So after each step, in each cell, by centres,

    D = sum V0 w over particles that are open (w > 0),  C = -sum V0 w over those that are compressed

D < C: the opened ones take part in the mean stress of the cell, and what they were open by comes off its compression.
With r = 1 - D/C and q the fraction of V0 that was open, compression of the others falls to r (1 - q) of what it was,
and each opened particle has the mean that they had, r (sum V0 sigma)/(sum V0), and no void. D > C: the same with
both exchanged, and nothing carries stress where what is open has none. F takes exp(change of w / 2), so that sum V0
ln J of the cell is kept, and domains follow. A particle alone in its cell stays as it is.

Every APART steps the cells are those that are half a cell further on both axes, around the nodes. Otherwise a cell
that is open as a whole stays open where others carry it, and who is alone stays alone: a tenth of the sand at rest.
Between two such steps a wave crosses some cells at usual Courant numbers, so that the grid has answered. More often,
void strain spreads faster than sand can follow: every other step the sand of `verify box` stands 1.6 % higher.
In these steps, and half-way between them in the cells of the grid, compressed particles take a fraction MIXED of the
mean stress for as much of their own. Else what they differ by without being open grows as w does: single ones carry
twelve times the mean of the lowest rows. Half-way, every APART steps, and before the cells are pooled, what is crowded
is relieved, see solver/crowding.py.

New stresses are sums of old ones with weights that add up to 1 at most, so they stay in any strength that is convex
and holds no stress at all, with cohesion too; and elastic energy, which is convex, can only fall. With moduli that
follow the stress this holds for the strains, and stresses keep their directions. The energy that is taken is counted.
Serial loops over particles in their order: the same bits for any number of threads.
"""

from dataclasses import dataclass, field

import numpy as np

from mpm_verify.solver._jit import F1, F2, F3, I1, f8, flag, function_type, i8, kernel, nothing
from mpm_verify.solver.compression import SCALE, STORED, VOLUME, Compression
from mpm_verify.solver.context import Context
from mpm_verify.solver.crowding import Crowding
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats

COUNT, ALL, OPEN, D, C, VOID, PULLED, PRESSED, SUMS = 0, 1, 2, 3, 4, 5, 6, 10, 14  # of a cell; two of stress, four long
APART, MIXED = 16, 0.05  # steps; fraction of the stress: half of what particles differ by is gone in 110 steps
FLAGS = flag[::1]


@kernel(nothing(F2, F1, f8, i8, i8, I1))
def cells_of(x, origin, inv_dx, nx, ny, cell):
    """Write the number of the cell of each position x (P,2), -1 outside the grid and where it is not a number.

    The origin may lie half a cell before that of the grid.
    """
    for p in range(x.shape[0]):
        i = np.floor((x[p, 0] - origin[0]) * inv_dx)
        j = np.floor((x[p, 1] - origin[1]) * inv_dx)
        inside = i >= 0.0 and i < nx and j >= 0.0 and j < ny
        cell[p] = np.int64(i) * ny + np.int64(j) if inside else -1


@kernel(nothing(function_type(VOLUME), F1, I1, F1, F2, F2, i8, F1, F2))
def gather(volume, constants, cell, V0, sigma, history, column, w, sums):
    """Write w (P,), and the sums of each cell that has particles to its row of `sums`."""
    for p in range(cell.shape[0]):
        if cell[p] >= 0:
            for a in range(sums.shape[1]):
                sums[cell[p], a] = 0.0
    for p in range(cell.shape[0]):
        k = cell[p]
        if k >= 0:
            void = history[p, column] if column >= 0 else 0.0
            w[p] = void - volume(constants, sigma[p, 0], sigma[p, 1], sigma[p, 2])
            sums[k, ALL] += V0[p]
            sums[k, COUNT] += 1.0
            side = PULLED if w[p] > 0.0 else PRESSED
            if w[p] > 0.0:
                sums[k, OPEN] += V0[p]
                sums[k, D] += V0[p] * w[p]
                sums[k, VOID] += V0[p] * void
            else:
                sums[k, C] -= V0[p] * w[p]
            for a in range(4):
                sums[k, side + a] += V0[p] * sigma[p, a]


@kernel(
    f8(
        *[function_type(signature) for signature in (VOLUME, SCALE, STORED)],
        F1,
        I1,
        F1,
        F2,
        F2,
        F3,
        F2,
        i8,
        F1,
        F2,
        f8,
        FLAGS,
    )
)
def settle(volume, scale, stored, constants, cell, V0, F_old, sigma, F, history, column, w, sums, mixed, renewed):
    """Write stress, void strain, F and F_old of particles in cells that are open and compressed; the energy taken.

    Compressed ones take the fraction `mixed` of the mean, where the cell is compressed as a whole. `renewed` (P,) is
    set where a particle that was open has a stress, or one that had some has none any more.
    """
    taken = 0.0
    for p in range(cell.shape[0]):
        k = cell[p]
        if k < 0 or sums[k, COUNT] < 2.0 or not (sums[k, C] > 0.0 and (sums[k, D] > 0.0 or mixed > 0.0)):
            continue
        opens = sums[k, D] > sums[k, C]
        less, most = (sums[k, C], sums[k, D]) if opens else (sums[k, D], sums[k, C])
        kept = 1.0 - less / most
        mean = kept / sums[k, ALL]
        opened = sums[k, OPEN] / sums[k, ALL]
        before = stored(constants, sigma[p, 0], sigma[p, 1], sigma[p, 2], sigma[p, 3])
        void = history[p, column] if column >= 0 else 0.0
        strain = void - w[p]
        if opens == (w[p] > 0.0):
            part = kept * (opened if opens else (1.0 - opened) * (1.0 - mixed))
            joins = 0.0 if opens else mixed * mean
            void *= part
            new = part * strain + joins * sums[k, C]
            if joins > 0.0:
                for a in range(4):
                    sigma[p, a] = part * sigma[p, a] + joins * sums[k, PRESSED + a]
                strain = volume(constants, sigma[p, 0], sigma[p, 1], sigma[p, 2])
            by = scale(constants, strain, new) if strain != 0.0 else 0.0
            for a in range(4):
                sigma[p, a] *= by
        else:
            side = PULLED if opens else PRESSED
            void = mean * sums[k, VOID] if opens else 0.0
            new = mean * (sums[k, VOID] - sums[k, D]) if opens else mean * sums[k, C]
            theirs = volume(constants, sums[k, side], sums[k, side + 1], sums[k, side + 2])
            by = scale(constants, theirs, new) if theirs != 0.0 else 0.0
            for a in range(4):
                sigma[p, a] = by * sums[k, side + a]
            renewed[p] = True
        change = void - new - w[p]
        J = F[p, 0, 0] * F[p, 1, 1] - F[p, 0, 1] * F[p, 1, 0]
        after = stored(constants, sigma[p, 0], sigma[p, 1], sigma[p, 2], sigma[p, 3])
        taken += V0[p] * J * (before - np.exp(change) * after)
        if column >= 0:
            history[p, column] = void
        stretch = np.exp(0.5 * change)
        for a in range(2):
            for b in range(2):
                F[p, a, b] *= stretch
                F_old[p, 2 * a + b] *= stretch
    return taken


@dataclass
class Pooling:
    """Pooling of void strain, compression and stress in each cell, and relief of what is crowded.

    Attributes
    ----------
    taken
        Elastic energy that it has taken so far, per thickness.
    crowding
        Relief of crowded particles, half-way between two steps around the nodes and before the cells are pooled.
    """

    taken: float = 0.0
    crowding: Crowding = field(default_factory=Crowding)
    compression: Compression | None = field(default=None, repr=False)
    sums: Floats = field(default_factory=lambda: np.zeros((0, SUMS)), repr=False)

    def start(self, material: Material) -> None:
        """Take the compression of the material. Raises ValueError for one that states none."""
        if material.compression is None:
            raise ValueError(
                "pooling must have a material that opens without stress; choose mohr_coulomb, drucker_prager, ubcsand, "
                "or --pooling no"
            )
        self.compression = material.compression()

    def pool(self, context: Context) -> None:
        """Relieve what is crowded, if it is its step, then pool the cells of a body whose material was just updated."""
        p, grid, material, own = context.particles, context.grid, context.material, self.compression
        assert own is not None
        assert isinstance(material, RateMaterial)
        apart, between = (context.steps % APART == APART // part - 1 for part in (1, 2))
        if between:
            self.crowding.relieve(context)
        if len(self.sums) != grid.nx * grid.ny:
            self.sums = np.zeros((grid.nx * grid.ny, SUMS))
        column = material.memory.index("void") if "void" in material.memory else -1
        cell, w, renewed = np.empty(len(p), np.int64), np.zeros(len(p)), np.zeros(len(p), np.bool_)
        origin = grid.origin - 0.5 * grid.dx * apart
        cells_of(context.basis.on_grid(p), origin, 1.0 / grid.dx, grid.nx, grid.ny, cell)
        gather(own.volume, own.constants, cell, p.V0, p.sigma, p.history, column, w, self.sums)
        self.taken += settle(
            own.volume, own.scale, own.stored, own.constants, cell, p.V0, p.F_old, p.sigma, p.F, p.history, column, w,
            self.sums, MIXED * (apart or between), renewed,
        )  # fmt: skip
        if renewed.any():
            material.renew(p, np.flatnonzero(renewed))
        if apart or between:
            material.mobilise(p)
