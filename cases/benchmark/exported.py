"""Content of a benchmark as another solver reads it: the case, particles at the start, and what is known of its end."""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any, Final

import numpy as np

from mpm_verify.cases.benchmark.edges import EdgeRecord, PushedRecord, edges, pushed_nodes
from mpm_verify.cases.benchmark.run import Run
from mpm_verify.cases.harness.checks import Unjudged
from mpm_verify.mms.export.case import Columns, constants, named, numbers, positions
from mpm_verify.mms.export.record import MaterialRecord
from mpm_verify.solver.plugins import label, parameters_of

FORMAT: Final = "mpm-verify-benchmark-1"
EXPORTED = "cpdi"  # method whose domains are told: half side vectors at reference
EVERY = {  # units of what every benchmark has
    "grid_lower": "m", "grid_upper": "m", "dx": "m", "gravity": "m/s2", "dt": "s", "duration": "s", "traction": "Pa",
    "pushed_lower": "m", "pushed_upper": "m", "pushed_distance": "m", "pushed_duration": "s", "X": "m", "x": "m",
    "v": "m/s", "s": "Pa", "V0": "m2", "m": "kg/m", "r": "m",
}  # fmt: skip
SOLID = {  # and of constants of materials
    **dict.fromkeys(("E", "lam", "mu", "kappa", "c", "sigma_t", "Pa", "s_min", "s_bound"), "Pa"), "rho0": "kg/m3",
    **dict.fromkeys(("phi", "psi", "phi_f", "phi_pt"), "degrees"),
}  # fmt: skip
LATE = 1e300  # a time at which the body force has its final value


@dataclass(frozen=True)
class KnownRecord:
    """Number of a run and what it is held against, see cases/benchmark/problem.py: Held.

    `unjudged` is the code of why the number is shown here and not judged, empty where it is; what `rests` is judged of
    a body at rest alone; `limit`, unless 0, is what the Richardson limit is held within beside every grid.
    """

    name: str
    expected: float
    way: str
    within: float
    of: str
    least: int
    source: str
    unit: str
    unjudged: Unjudged
    rests: bool
    limit: float


@dataclass(frozen=True)
class BenchmarkRecord:
    """Benchmark as another solver reads it; plane strain, per unit of thickness. Units are SI; any consistent set does.

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
    units
        Unit of each number by its name in case.txt, without its component, and of columns; of those without one none.
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
    units: dict[str, str]


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
        KnownRecord(**{item.name: getattr(held, item.name) for item in fields(KnownRecord)})
        for held in problem.held(run)
    )
    values = {key: getattr(problem, item.name) for key, item in parameters_of(problem).items()}
    record = BenchmarkRecord(
        FORMAT, label(run.problem), problem.source, numbers(grid.lower), numbers(grid.upper), run.cells, grid.dx,
        run.ppc, len(p), edges(model), pushed_nodes(model), numbers(np.median(columns["b"], axis=0)),
        model.damping.alpha if model.damping else 0.0, model.dt, setup.steps, setup.steps * model.dt, values,
        MaterialRecord(label(run.material), constants(model.material), getattr(model.material, "formula", "")), known,
        units(problem, values, constants(model.material)),
    )  # fmt: skip
    return Exported(record, particles, problem.answers(run, columns["X"]))


def units(problem: Any, values: Iterable[str], solid: Iterable[str]) -> dict[str, str]:
    """Units of a record by the names of case.txt: those of every benchmark, of parameters, and of the material."""
    found = dict(EVERY)
    found |= {f"parameters_{name}": unit for name in values if (unit := problem.units.get(name))}
    return found | {f"material_{name}": unit for name in solid if (unit := SOLID.get(name))}


def exported(problem: str, material: str | None, cells: int, ppc: int | None, courant: float) -> Exported:
    """Content of the folder of a problem with these values, as the command has them. Raises ValueError."""
    from mpm_verify.cases.benchmark.case import canonical

    given: dict[str, Any] = {"problem": problem, "method": EXPORTED, "material": material or ""}
    values = canonical(given)
    made = Run(**values, cells=cells, courant=courant)
    return export(Run(**values, cells=cells, courant=courant, ppc=ppc or made.stated.ppc))
