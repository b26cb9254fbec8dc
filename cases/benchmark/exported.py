"""Content of a benchmark as another solver reads it: the case, particles at the start, and what is known of its end."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from mpm_verify.cases.benchmark.edges import EdgeRecord, PushedRecord, edges, pushed_nodes
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.mms.export.case import Columns, constants, named, numbers, positions
from mpm_verify.mms.export.record import MaterialRecord
from mpm_verify.solver.plugins import label, parameters_of

FORMAT: Final = "mpm-verify-benchmark-1"
EXPORTED = "cpdi"  # method whose domains are told: half side vectors at reference
LATE = 1e300  # a time at which the body force has its final value


@dataclass(frozen=True)
class KnownRecord:
    """Number of a run and what it is held against, see cases/benchmark/problem.py: Held."""

    name: str
    expected: float
    way: str
    within: float
    of: str
    least: int
    source: str


@dataclass(frozen=True)
class BenchmarkRecord:
    """Benchmark as another solver reads it; plane strain, any consistent set of units.

    Parameters
    ----------
    format, problem, source
        Name of the format with its version; problem, and where it is published.
    grid_lower, grid_upper
        Corners of the grid, lengths.
    cells, dx, ppc, particles
        Cells along the body and their side, particles in a cell and all of them.
    edges
        What each side of the grid holds, and what pulls at it.
    pushed
        Nodes whose velocity on an axis is given.
    gravity
        Body force per mass at the end, (x, y).
    damping
        Fraction of the unbalanced force that local damping takes.
    dt, steps, duration
        Time step of the reference solver, its most steps, and the time that they take.
    parameters, material
        Of the problem and of the constitutive model.
    known
        Numbers, and what each is held against; of one number there may be two bounds.
    """

    format: str
    problem: str
    source: str
    grid_lower: tuple[float, ...]
    grid_upper: tuple[float, ...]
    cells: int
    dx: float
    ppc: int
    particles: int
    edges: dict[str, EdgeRecord]
    pushed: tuple[PushedRecord, ...]
    gravity: tuple[float, ...]
    damping: float
    dt: float
    steps: int
    duration: float
    parameters: dict[str, float]
    material: MaterialRecord
    known: tuple[KnownRecord, ...]


@dataclass(frozen=True)
class Exported:
    """Content of a folder: record, particles (P,) at the start, and columns (P,) that are known of the end, if any."""

    record: BenchmarkRecord
    particles: Columns
    known: Columns


def export(run: Run) -> Exported:
    """Make the content of a folder.

    Parameters
    ----------
    run
        Run with the method EXPORTED, which no failing control is.

    Returns
    -------
    Exported
        In the order of the initial layout.

    Raises
    ------
    ValueError
        For what the problem cannot have.
    """
    problem: Any = run.stated
    problem.check(run)
    setup = problem.setup(run)
    model = setup.model
    setup.load(model.particles, LATE)
    p, grid = model.particles, model.grid
    columns = {name: p.in_initial_order(name) for name in ("X", "x", "v", "F", "sigma", "V0", "m", "domain", "b")}
    particles: Columns = {"id": np.arange(len(p), dtype=np.float64), **positions(columns["X"])}
    particles |= positions(columns["x"], "x") | named("v", columns["v"]) | named("F", columns["F"])
    particles |= named("s", columns["sigma"]) | {"V0": columns["V0"], "m": columns["m"]}
    for side in range(2):
        particles |= named(f"r{side + 1}", columns["domain"][:, 2 * side : 2 * side + 2])
    known = tuple(
        KnownRecord(held.name, held.expected, held.way, held.within, held.of, held.least, held.source)
        for held in problem.held(run)
    )
    values = {key: getattr(problem, item.name) for key, item in parameters_of(problem).items()}
    record = BenchmarkRecord(
        FORMAT, label(run.problem), problem.source, numbers(grid.lower), numbers(grid.upper), run.cells, grid.dx,
        run.ppc, len(p), edges(model), pushed_nodes(model), numbers(np.median(columns["b"], axis=0)),
        model.damping.alpha if model.damping else 0.0, model.dt, setup.steps, setup.steps * model.dt, values,
        MaterialRecord(label(run.material), constants(model.material), getattr(model.material, "formula", "")), known,
    )  # fmt: skip
    return Exported(record, particles, problem.answers(run, columns["X"]))


def exported(problem: str, material: str | None, cells: int, ppc: int | None, courant: float) -> Exported:
    """Content of the folder of a problem with these values, as the command has them. Raises ValueError."""
    from mpm_verify.cases.benchmark.case import canonical

    given: dict[str, Any] = {"problem": problem, "method": EXPORTED, "material": material or ""}
    values = canonical(given)
    made = Run(**values, cells=cells, courant=courant)
    return export(Run(**values, cells=cells, courant=courant, ppc=ppc or made.stated.ppc))
