"""States that no usual run has: particles inverted or beyond the grid, rows in any order, large strain increments.

The body is longer than those of body.py, so that it lies in three slabs.
"""

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np

from mpm_verify.cases.exact.body import Subject, by_id, rest
from mpm_verify.mms.constitutive.tested import Part, Reason, Tested, attempt, bound, not_asked, off
from mpm_verify.solver.boundary import box
from mpm_verify.solver.damping import Damping
from mpm_verify.solver.failure import Failure, FailureKind, RunFailed
from mpm_verify.solver.layout import rectangle
from mpm_verify.solver.model import Deformation, Model, Scheme
from mpm_verify.solver.slabs import Slabs
from mpm_verify.solver.state import Grid, Ints, Particles
from mpm_verify.solver.step import advance, grid_to_particles

CELLS = np.array([24.0, 6.0])  # of a unit
FAR = (0.0, 500.0)
RATE, STRETCH = np.array([[0.2, -0.5], [0.3, 0.1]]), np.array([[1.1, 0.2], [-0.1, 0.9]])  # dt L, and F before
ORDERS: dict[Deformation, float] = {"linear": 0.0, "exponential": 0.5}  # factor of A^2 in a step of F
ARRAYS = ("F_old", "history", "sigma_smoothed", "work", "affine_velocity", "carried")


def tests(subject: Subject) -> list[Tested]:
    """Failures that end a step, rows in any order, F after a large increment, and damping by nothing."""
    asked: list[tuple[str, Part, Callable[[Subject], float], float]] = [
        ("inverted_ends", Part.ENDS, inverted, 0.0),
        ("any_order", Part.ROWS, any_order, bound(4 * subject.support)),
        ("arrays_along", Part.ROWS, arrays_along, 0.0),
        ("slabs", Part.ROWS, slabs, 0.0),
        *((f"deformation {word}", Part.TO_PARTICLES, partial(deformation, word), bound(4 * subject.support))
          for word in ORDERS),
        ("undamped", Part.DAMPING, undamped, 0.0),
    ]  # fmt: skip
    found = [one for item in asked for one in attempt(item[0], item[1], partial(held, subject, *item))]
    if subject.basis.reference:
        return [*found, not_asked("left_ends", Part.ENDS, Reason.REFERENCE)]
    return found + attempt("left_ends", Part.ENDS, partial(held, subject, "left_ends", Part.ENDS, left, 0.0))


def held(subject: Subject, name: str, part: Part, residual: Callable[[Subject], float], most: float) -> Tested:
    """Test of a residual against its bound."""
    return Tested(name, residual(subject), most, part)


def body(subject: Subject, deformation: Deformation = "linear", order: Ints | None = None) -> Model:
    """Body of unit cells without walls, three slabs long, its particles in some order."""
    grid = Grid(1.0, np.zeros(2), CELLS)
    particles = subject.basis.populate(rectangle(np.array([2.0, 2.0]), CELLS - 2.0, 1.0, 4), subject.material.rho0)
    if order is not None:
        particles.reorder(order)
    dt = 0.1 / subject.speed
    scheme = Scheme(deformation=deformation)
    return Model(grid, particles, subject.basis, subject.material, box(grid, "free"), dt, scheme)


def waved(subject: Subject, model: Model, steps: int = 1) -> Model:
    """Model after steps from a velocity that is a sine of the initial positions."""
    model.particles.v[:] = 1e-3 * subject.speed * np.sin(model.particles.X)
    for _ in range(steps):
        advance(model, rest)
    return model


def ended(model: Model) -> Failure | None:
    """Failure that ends the next step, if one does."""
    try:
        advance(model, rest)
    except RunFailed as end:
        return end.failure
    return None


def inverted(subject: Subject) -> float:
    """0 where a step ends at a particle that is inverted, and names it; 1 where not."""
    model = body(subject)
    p, row = model.particles, len(model.particles) // 2
    p.F[row] = [[-0.4, 0.1], [0.0, 0.6]]
    p.sigma[row] = 0.0
    p.id[:] = p.id[::-1].copy()
    name, found = int(p.id[row]), ended(model)
    return float(found is None or found.kind is FailureKind.NOT_FINITE or found.particle != name)


def left(subject: Subject) -> float:
    """0 where a step ends at a particle that has left the grid, 1 where not."""
    model = body(subject)
    p, row = model.particles, len(model.particles) // 2
    p.x[row] += FAR
    if p.domain.shape[1] == 8:  # corners of their own
        p.domain[row] += np.tile(FAR, 4)
    found = ended(model)
    return float(found is None or found.kind is not FailureKind.OUTSIDE_GRID)


def any_order(subject: Subject) -> float:
    """Distance of v and F after a step from those of the same particles in another order."""
    usual = waved(subject, body(subject))
    order = np.random.default_rng(3).permutation(len(usual.particles))
    mixed = waved(subject, body(subject, order=order))
    scale = {"v": subject.speed, "F": 1.0}
    return max(off(by_id(mixed.particles, n), by_id(usual.particles, n), s) for n, s in scale.items())


def arrays_along(subject: Subject) -> float:
    """Number of arrays of particles that do not go along when rows are put in another order."""
    p, order = Particles(np.arange(8.0).reshape(4, 2), np.arange(4.0), np.arange(4.0), np.zeros((4, 1))), [2, 0, 3, 1]
    for name in ARRAYS:
        setattr(p, name, np.arange(8.0).reshape(4, 2))
    p.F[:, 0, 0], p.sigma[:, 0] = np.arange(4.0), np.arange(4.0)
    before = {name: getattr(p, name).copy() for name in vars(p)}
    p.reorder(np.array(order))
    return float(sum(not np.array_equal(getattr(p, name), array[order]) for name, array in before.items()))


def slabs(subject: Subject) -> float:
    """Number of slabs that hold particles of another, after a sort of rows in any order; 1 more for rows in none."""
    model, found = body(subject), Slabs()
    model.particles.reorder(np.random.default_rng(3).permutation(len(model.particles)))
    found.sort(model.grid, model.particles, model.particles.x)
    column = np.floor(model.particles.x[:, 0] - model.grid.origin[0]).astype(int) // found.slab_columns
    parts = [np.unique(column[a:b]).tolist() for a, b in pairwise(found.start)]
    return float(sum(part not in ([], [s]) for s, part in enumerate(parts)) + (found.start[-1] != len(column)))


def deformation(word: Deformation, subject: Subject) -> float:
    """Distance of F from (I + A + A^2/2) F, or (I + A) F, in a uniform velocity gradient of A = dt L."""
    model = body(subject, word)
    L = RATE / model.dt
    stretch = np.eye(2) if subject.method.partition(":")[0] == "cpdi2" else STRETCH  # its domain is F
    nodes = model.grid.nodes @ stretch.T if subject.basis.reference else model.grid.nodes
    model.grid.velocity_acceleration[:, :2] = nodes @ L.T
    model.particles.F[:] = stretch
    before = model.particles.F.copy()
    grid_to_particles(model)
    expected = (np.eye(2) + RATE + ORDERS[word] * RATE @ RATE) @ before
    return off(model.particles.F, expected, float(np.abs(CELLS).max()))


def undamped(subject: Subject) -> float:
    """Number of components of v that damping by nothing changes."""
    damped = body(subject)
    damped.damping = Damping(0.0)
    pair = [waved(subject, model, 2).particles.v for model in (body(subject), damped)]
    return float((pair[0] != pair[1]).sum())
