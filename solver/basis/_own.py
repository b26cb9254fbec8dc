"""Check of a basis from a user's file: its fill is tried in a fork, as a kernel with a wrong index writes anywhere.

A table of far more support nodes than the basis says is filled with guard values; what the fill writes, and where, is
then seen, and compared with what solver/weights.py asks for.
"""

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.solver._jit import BLOCK
from mpm_verify.solver.forked import ForkError, forked
from mpm_verify.solver.layout import Layout, rectangle
from mpm_verify.solver.own_contract import arguments, below, kernel, real, whole
from mpm_verify.solver.own_file import OwnFileError, blamed, guarded, said
from mpm_verify.solver.state import Floats, Grid, Ints
from mpm_verify.solver.weights import FILL, Basis

MOST = 256  # support nodes; those that ship have up to 16
ROOM = 2  # tables are so many times larger than for MOST support nodes
SECONDS = 30.0
DX, LOWER, UPPER, MARGIN = 0.25, np.zeros(2), np.array([1.0, 0.75]), 1.0  # of the body that is tried, and around it
GUARD, NO_NODE = 1.2345678e300, -(2**62) - 12345
ROUND_OFF = 1e-10
FAR = 100 * DX
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Filled:
    """Result of a fill: whether it returned True, rows of nodes (n,B) and of the table (m,B); or what it raised."""

    inside: bool
    node: Ints
    table: Floats
    raised: str = ""


@dataclass(frozen=True)
class Call:
    """Call of a fill: x (b,2), F (b,2,2), domain (b,W) of up to BLOCK particles, and the box for their nodes."""

    x: Floats
    F: Floats
    domain: Floats
    box: Box


def check(basis: Any, path: Path) -> None:
    """Check what a basis states of itself and what its fill writes. Raises OwnFileError with one line."""
    below(basis, Basis, path)
    arguments(basis, Basis, path)
    support = whole(basis, "support", path, 1, MOST, "the support nodes of a particle")
    whole(basis, "domain_size", path, 0, MOST, "the numbers that are kept of a particle's domain")
    real(basis, "order", path, 0.0, 100.0, "a number, the order of the displacement in dx")
    kernel(basis, "fill", path, FILL, "FILL")
    grid = Grid(DX, LOWER - MARGIN, UPPER + MARGIN)
    whole_grid = (0.0, grid.nx - 1.0, 0.0, grid.ny - 1.0)
    layout = rectangle(LOWER, UPPER, DX, 4, (0.1, -0.2))
    calls = [call(basis, path, layout, rows, whole_grid) for rows in (slice(BLOCK), slice(BLOCK, None))]
    results = tried(basis, path, grid, calls)
    for one, result in zip(calls, results, strict=True):
        written(path, support, len(one.x), result)
        weights(path, support, len(one.x), grid, result)
    columns = results[0].node[:support] // grid.ny
    elsewhere = [
        call(basis, path, shifted(layout, shift), slice(1), whole_grid)
        for shift in ((-FAR, 0.0), (FAR, 0.0), (0.0, -FAR), (0.0, FAR), (np.nan, np.nan))
    ]
    slabs = [(columns.max() + 1.0, grid.nx - 1.0, *whole_grid[2:]), (0.0, columns.min() - 1.0, *whole_grid[2:])]
    elsewhere += [call(basis, path, layout, slice(BLOCK), box) for box in slabs]
    for result in tried(basis, path, grid, elsewhere):
        if result.inside:
            raise OwnFileError(
                f"{path}: fill returns True where support nodes lie outside the box from x0 to x1 and y0 to y1, or "
                "where x is not a number; it must return False there, see outside() in solver/weights.py"
            )


def shifted(layout: Layout, shift: tuple[float, float]) -> Layout:
    """The layout elsewhere."""
    return Layout(layout.X + shift, layout.V0, layout.r0)


def call(basis: Any, path: Path, layout: Layout, rows: slice, box: Box) -> Call:
    """Call for some particles of a layout, a little strained, with the domains that the basis keeps of them."""
    domain = guarded(path, lambda: basis.domain(layout, lambda X: X))
    wanted = (len(layout), basis.domain_size)
    if not isinstance(domain, np.ndarray) or domain.shape != wanted or domain.dtype != np.float64:
        found = getattr(domain, "shape", type(domain).__name__)
        raise OwnFileError(
            f"{path}: domain gives {found}; domain_size = {basis.domain_size} wants numbers of the shape {wanted}"
        )
    F = np.eye(2) + np.array([[0.02, 0.01], [-0.01, 0.03]])
    return Call(layout.X[rows], np.tile(F, (len(layout.X[rows]), 1, 1)), domain[rows], box)


def tried(basis: Any, path: Path, grid: Grid, calls: list[Call]) -> list[Filled]:
    """Results of the fill, one a call, from a fork."""
    try:
        return forked(lambda: [filled(basis.fill, grid, one) for one in calls], SECONDS)  # type: ignore[no-any-return]
    except ForkError as error:
        raise OwnFileError(
            f"{path}: fill does not come to its end for a few particles, {error}: an index of node or table that it "
            "writes or of x, F or domain that it reads is far out of range"
        ) from error


def filled(fill: Any, grid: Grid, one: Call) -> Filled:
    """Result of one call, with guards around the table."""
    node = np.full(ROOM * MOST * BLOCK, NO_NODE)
    table = np.full(3 * ROOM * MOST * BLOCK, GUARD)
    arrays = (np.ascontiguousarray(values).ravel() for values in (one.x, one.F, one.domain))
    inside, raised = False, ""
    try:
        inside = bool(fill(*arrays, *grid.origin, 1.0 / grid.dx, grid.nx, grid.ny, *one.box, table, node))
    except Exception as error:
        raised = blamed(error) or said(error)
    return Filled(inside, node.reshape(-1, BLOCK), table.reshape(-1, BLOCK), raised)


def written(path: Path, support: int, count: int, result: Filled) -> None:
    """Check that all rows of `count` particles are written and no others, by a fill that finds them inside."""
    if result.raised:
        raise OwnFileError(result.raised if str(path.resolve()) in result.raised else f"{path}: {result.raised}")
    rows = np.flatnonzero((result.node != NO_NODE).any(axis=1))
    if len(rows) != support and np.array_equal(rows, np.arange(len(rows))):
        raise OwnFileError(
            f"{path}: support = {support}, and fill writes {len(rows)} support nodes of a particle; write support = "
            f"{len(rows)}, or let fill write as many"
        )
    parts = {"node": (result.node != NO_NODE, support), "table": (result.table != GUARD, 3 * support)}
    for name, (seen, most) in parts.items():
        what = "leaves out rows of" if not seen[:most, :count].all() else "writes beyond" if seen[most:].any() else ""
        if what:
            raise OwnFileError(
                f"{path}: fill {what} {name}, which has {most} rows of {BLOCK} particles where support = {support}: "
                f"{name}[k*{BLOCK} + b], k from 0 to {most - 1}"
            )
    if not result.inside:
        raise OwnFileError(
            f"{path}: fill returns False for particles in the middle of the grid; it must return True where all "
            "support nodes lie in the box from x0 to x1 and y0 to y1"
        )


def weights(path: Path, support: int, count: int, grid: Grid, result: Filled) -> None:
    """Check that nodes are those of the grid, and that values sum to one and gradients to zero."""
    node, table = result.node[:support, :count], result.table[: 3 * support, :count]
    last = grid.nx * grid.ny - 1
    wrong = node[(node < 0) | (node > last)]
    if wrong.size:
        raise OwnFileError(
            f"{path}: fill writes {wrong[0]} to node, and the grid that it is tried on has the nodes 0 to {last}; node "
            "(i, j) has the number i*ny + j"
        )
    names = {"N": (1.0, 1.0), "dN/dx": (0.0, 1 / DX), "dN/dy": (0.0, 1 / DX)}
    for values, (name, (expected, size)) in zip(table.reshape(3, support, count), names.items(), strict=True):
        found = values.sum(axis=0)
        off = np.abs(found - expected)
        b = int(np.argmax(np.where(np.isfinite(off), off, inf)))
        if not off[b] <= ROUND_OFF * max(size, float(np.abs(values[:, b]).sum())):
            raise OwnFileError(
                f"{path}: {name} that fill writes sums to {found[b]:.6g} over the support nodes of a particle, not to "
                f"{expected:g}"
            )
