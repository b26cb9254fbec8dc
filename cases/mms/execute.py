"""One run of the MMS case: a manufactured solution on one grid, with the errors of u, v, F and sigma."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from mpm_verify.cases.harness.environment import environment
from mpm_verify.cases.harness.memory import forget_peak, peak_memory
from mpm_verify.cases.harness.progress import Progress
from mpm_verify.cases.harness.study import Arrays, parameters
from mpm_verify.cases.mms.exact import audited, manufactured
from mpm_verify.cases.mms.gaps import LOOKS, Gaps
from mpm_verify.cases.mms.norms import Norms, compare, new_sums
from mpm_verify.cases.mms.packing import Packing
from mpm_verify.cases.mms.run import QUANTITIES, Result, Run
from mpm_verify.mms.discretisation import grid_box, time_steps, width
from mpm_verify.mms.duration import lasting
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.mms.square import Square
from mpm_verify.mms.surface import surface
from mpm_verify.mms.surface import walls as sides
from mpm_verify.solver.boundary import Walls, box, moving
from mpm_verify.solver.failure import Failure, FailureKind, RunFailed
from mpm_verify.solver.layout import CENTRED, Layout, parallelograms
from mpm_verify.solver.plugins import (
    LAYOUTS,
    MATERIALS,
    METHODS,
    SMOOTHINGS,
    SOLUTIONS,
    TRANSFERS,
    create,
    optional,
)
from mpm_verify.solver.state import Floats, Grid, Particles
from mpm_verify.solver.step import Model, Scheme, advance, check_time_step

if TYPE_CHECKING:
    from mpm_verify.solver.damping import Damping

PIECE = 4096  # particles
OF_F = (2, 3, 6, 7)  # columns of the sums that are of F and sigma
COUNTED = 40_000  # particles: the outline of a uniform layout with more takes as long as the run's first steps


@dataclass
class Comparison:
    """Body force at the time of x, and errors of each field at its own time level."""

    exact: Manufactured
    norms: Norms
    gaps: Gaps
    packing: Packing | None
    sums: Floats
    lag: float  # time level of x less that of v
    F_lag: float = 0.0  # and less that of F and sigma

    def __call__(self, particles: Particles, t: float) -> None:
        """Write particles.b at time t; add the errors of that time to the norms, the start left out."""
        scalars = self.exact.kernel.scalars(t, t - self.lag)
        compare(
            self.exact.kernel.fill, particles.carried, scalars, particles.X, particles.x, particles.v, particles.F,
            particles.sigma, particles.V0, particles.b, self.sums,
        )  # fmt: skip
        if t <= 0:
            return
        if self.F_lag:
            apart = np.zeros_like(self.sums)
            compare(
                self.exact.kernel.fill, particles.carried, self.exact.kernel.scalars(t - self.F_lag, t - self.lag),
                particles.X, particles.x, particles.v, particles.F, particles.sigma, particles.V0,
                np.empty_like(particles.b), apart,
            )  # fmt: skip
            self.sums[:, OF_F] = apart[:, OF_F]
        self.norms.add(self.sums)


def setup(run: Run) -> tuple[Model, Comparison, int]:
    """Model at t = 0, what compares it with the exact solution, and the number of steps.

    dt = courant_number dx / C, shortened so that whole steps fill the duration, unless it is the one that the paper
    prints. x, F and sigma start exact, v exact at -dt/2; with update-stress-first F and sigma start at -dt: the first
    step takes them to where its forces need them.
    """
    solution: Any = lasting(create(SOLUTIONS, run.solution), run.periods)
    material: Any = create(MATERIALS, run.material)
    dx = width(solution) / run.cells
    lower, upper = grid_box(solution, dx)
    shift = -dx * np.array(run.offset) if moves_grid(solution) else np.zeros(2)
    grid = Grid(dx, lower + shift, upper + shift)
    steps, dt = time_steps(solution, grid.dx, run.courant_number, run.whole_steps, run.turns)
    lag = 0.5 * dt if run.staggered else 0.0
    F_lag = dt if run.staggered and run.stress == "usf" else 0.0

    exact, basis = manufactured(run.solution, run.material, run.damping_inside), create(METHODS, run.method)
    layout = laid_out(run, solution, exact)
    particles, X = basis.populate(layout, material.rho0, lambda X: exact.x(X, 0.0)), layout.X
    particles.x, particles.v = exact.x(X, 0.0), exact.v(X, -lag)
    particles.F, particles.sigma = exact.F(X, -F_lag), exact.sigma(X, -F_lag)
    particles.carried = exact.kernel.columns(X)
    transfer, stress = create(TRANSFERS, run.transfer), run.stress
    scheme = Scheme(transfer, stress, run.staggered)
    held, edge = walls(solution, grid, basis.reference), surface(solution, exact, layout)
    model = Model(
        grid, particles, basis, material, held, dt, scheme, damping_of(run), optional(SMOOTHINGS, run.smoothing), edge
    )
    transfer.start(model, lambda X: velocity_gradient(exact, X, -lag, 1e-3 * dt, basis.reference))
    every = max(1, steps // LOOKS)
    packing = Packing(exact, layout, dx, every) if run.layout != "uniform" or len(layout) <= COUNTED else None
    norms, gaps = Norms(len(particles), float(particles.V0.mean())), Gaps(layout, every)
    return model, Comparison(exact, norms, gaps, packing, new_sums(particles), lag, F_lag), steps


def damping_of(run: Run) -> "Damping | None":
    """Local damping of the solver, None where there is none: its kernel takes a second to compile."""
    if not run.damping:
        return None
    from mpm_verify.solver.damping import Damping

    return Damping(run.damping)


def laid_out(run: Run, solution: Any, exact: Manufactured) -> Layout:
    """Layout of the particles of the run; for a free body that is no square the offset moves the grid."""
    offset = CENTRED if moves_grid(solution) else run.offset
    layout: Layout = create(LAYOUTS, run.layout)(solution, exact, width(solution) / run.cells, run.ppc, offset)
    return layout


def walls(solution: Any, grid: Grid, reference: bool = False) -> Walls:
    """Walls of the solution, at `reference` or where they are; none beside an edge that is pulled or prescribed."""
    if solution.boundary != "moving":
        return box(grid, sides(solution))
    return moving(grid, solution.reference_walls if reference else solution.walls)


def moves_grid(solution: Any) -> bool:
    """Whether the offset moves the grid: no wall ties it to a body whose edges all move.

    A square keeps its edges on faces of cells: in one that an edge cuts, particles of classical MPM are inverted.
    """
    open_ = solution.boundary != "moving" and set(sides(solution)) == {"free"}
    return open_ and not isinstance(solution, Square)


def velocity_gradient(exact: Manufactured, X: Floats, t: float, short: float, reference: bool = False) -> Floats:
    """Velocity gradient L = dF/dt F^-1 (P,2,2), by the central difference of the exact F over t -/+ short.

    With respect to X it is dF/dt: the one of nodes that stay in the `reference` configuration.
    """
    rate: Floats = (exact.F(X, t + short) - exact.F(X, t - short)) / (2 * short)
    L: Floats = rate if reference else rate @ np.linalg.inv(exact.F(X, t))
    return L


def execute(run: Run, tick: Callable[[float], None] = lambda fraction: None) -> tuple[Result, Arrays]:
    """Run to the end, or to where it cannot go on: a failed run is a Result. `tick` hears the fraction that is done."""
    forget_peak()
    model, comparison, steps = setup(run)
    model.watch(comparison.gaps, *filter(None, [comparison.packing]), Progress(tick, steps))
    failure, started, used = None, time.perf_counter(), time.process_time()
    try:
        if not run.force:
            check_time_step(model)
        if comparison.packing:
            comparison.packing.begin(model, must=run.layout != "uniform")
        for _ in range(steps):
            advance(model, comparison)
        comparison(model.particles, model.time)
    except RunFailed as ended:
        failure = ended.failure
    wall, cpu = time.perf_counter() - started, time.process_time() - used
    errors, scale = comparison.norms.errors(), magnitude(comparison.exact, model.particles, steps * model.dt)
    if not failure and not np.isfinite([list(norms.values()) for norms in errors.values()]).all():
        failure = Failure(FailureKind.ERROR_NOT_FINITE, model.steps)
    arrays = snapshot(run, model, comparison)
    result = Result(
        run=run,
        digest=run.digest,
        status="failed" if failure else "finished",
        errors={} if failure else errors,
        steps=model.steps,
        particles=len(model.particles),
        dt=model.dt,
        wall_s=wall,
        cpu_s=cpu,
        crossings=model.crossings,
        gap=comparison.gaps.most,
        packed=comparison.packing.packed if comparison.packing else None,
        audit=audited(run.solution, run.material, run.periods),
        peak_memory_mb=peak_memory(),
        scale=scale,
        floor={} if failure else round_off(scale, model),
        failure=failure,
        environment=environment(),
        parameters=parameters("solution", create(SOLUTIONS, run.solution))
        | parameters("material", create(MATERIALS, run.material)),
    )
    return result, arrays


def magnitude(exact: Manufactured, particles: Particles, duration: float) -> dict[str, float]:
    """Root mean square of the exact quantities, from some thousand positions and sixteen times, weighted by volume."""
    step = max(1, len(particles) // 1000)
    some, volume = particles.X[::step], particles.V0[::step, None] / particles.V0[::step].mean()
    times = duration * (np.arange(16) + 0.5) / 16
    fields = {"u": exact.u, "v": exact.v, "F": exact.F, "sigma": exact.sigma}
    weight = {"sigma": np.array([1.0, 1.0, 1.0, 2.0])}
    squares = {
        q: np.mean([np.sum(volume * (weight.get(q, 1.0) * f(some, t) ** 2).reshape(len(some), -1)) for t in times])
        / len(some)
        for q, f in fields.items()
    }
    return {quantity: sqrt(square) for quantity, square in squares.items()}


def round_off(scale: dict[str, float], model: Model) -> dict[str, float]:
    """Round-off floor: half a digit of the largest number involved, in a random walk over the steps.

    u is the difference of positions of size L, and F of numbers near one; v and sigma have the size of the exact ones.
    """
    walk = np.finfo(float).eps * sqrt(max(1, model.steps))
    size = {**scale, "u": float(np.ptp(model.particles.X)), "F": 1.0}
    return {quantity: float(walk * size[quantity]) for quantity in QUANTITIES}


def snapshot(run: Run, model: Model, comparison: Comparison) -> Arrays:
    """Particles at the last step in the initial order, float32, for figures; points are drawn as if with CPDI.

    Piece by piece: in double precision and at once, it would be the peak of the run's memory.
    """
    p, count = model.particles, len(model.particles)
    shapes: dict[str, tuple[int, ...]] = {"X": (2,), "x": (2,), "F": (2, 2), "corners": (4, 2), "error_u": ()}
    arrays = {name: np.empty((count, *shape), np.float32) for name, shape in shapes.items()}
    known = model.basis.corners(p.x[:1], p.F[:1], p.domain[:1], model.grid.dx) is not None
    r0 = None if known else laid_out(run, create(SOLUTIONS, run.solution), comparison.exact).r0
    for rows in (slice(lo, lo + PIECE) for lo in range(0, count, PIECE)):
        X, x, F, row = p.X[rows], p.x[rows], p.F[rows], p.id[rows]
        corners = model.basis.corners(x, F, p.domain[rows], model.grid.dx)
        if corners is None and r0 is not None:
            corners = parallelograms(x, np.einsum("pab,psb->psa", F, r0[row]))
        error = np.hypot(*(x - comparison.exact.x(X, model.time)).T)
        for name, values in {"X": X, "x": x, "F": F, "corners": corners, "error_u": error}.items():
            arrays[name][row] = values
    return arrays
