"""Content of an exported case: its record, particles, sources and values to check them against."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.mms.components import AXES, COMPONENTS, GRADIENTS, STRESSES
from mpm_verify.mms.derive import derive
from mpm_verify.mms.discretisation import axisymmetric, dimension, grid_box, output_steps, time_steps, width
from mpm_verify.mms.export.language import Heading
from mpm_verify.mms.export.languages import LANGUAGES
from mpm_verify.mms.export.program import Program, programs
from mpm_verify.mms.export.record import FORMAT, CaseRecord, MaterialRecord, Precision
from mpm_verify.mms.export.selfcheck import at_position, checked, rows
from mpm_verify.mms.export.slice import Slice
from mpm_verify.mms.export.start import Start
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.solver.layout import Layout, per_side
from mpm_verify.solver.plugins import label, parameters_of
from mpm_verify.solver.sides import SOLID_SIDES
from mpm_verify.solver.state import Floats

Columns = dict[str, Floats]  # (n,) each, by name
BODIES = {1: "bar", 2: "rectangle", 3: "box"}


@dataclass(frozen=True)
class Names:
    """Specifications of a solution and a material, as they are told."""

    solution: str
    material: str


@dataclass(frozen=True)
class Exported:
    """Content of a case.

    Parameters
    ----------
    record
        Content of case.json.
    particles
        Columns (P,) of the particles.
    force, fields
        Columns (R,) of values at some rows, and the tolerance of each.
    sources
        Texts by file names.
    """

    record: CaseRecord
    particles: Columns
    force: Columns
    fields: Columns
    sources: dict[str, str]


def export(
    names: Names,
    solution: Any,
    material: Any,
    cells: int,
    ppc: int,
    courant: float = 0.4,
    frames: int = 16,
    checked: bool = True,
    start: Start | None = None,
    precision: Precision = "double",
) -> Exported:
    """Make a case of a manufactured solution on one grid, for another solver.

    Parameters
    ----------
    names
        How solution and material are called.
    solution, material
        Solution, or a slice of one, and constitutive model with an energy.
    cells, ppc
        Cells along the width of the body, and particles in a cell, a square number; of a body in three dimensions a
        cube number, in one any number. Of a slice it is the square number of a layer: there are as many layers as its
        root.
    courant
        C dt / dx, C the reference speed of the solution.
    frames
        Number of output steps.
    checked
        Whether values to check the sources with are made; they take as long as all the rest.
    start
        Time levels that are given by force; None: the case as it is.
    precision
        Precision that the solver computes with.

    Returns
    -------
    Exported
        Record, particles, values to check against, sources.

    Raises
    ------
    ValueError
        For a material without an energy, a count of particles per cell that is not square, and a displacement with
        functions that other languages do not have.
    """
    d, layers = dimension(solution), per_side(ppc) if isinstance(solution, Slice) else 0
    exact = manufacture(solution, material, material.rho0)
    dx = width(solution) / cells
    steps, dt = time_steps(solution, dx, courant)
    layout = solution.layout(dx, ppc)
    code = programs(exact.fields)
    if start:
        code[0] = programs(start.fields(exact.fields, dt))[0]
    around = axisymmetric(solution)
    title = f"{label(names.solution)} in {label(names.material)}{', axisymmetric: x radius, y axis, z around' * around}"
    heading = Heading(title, d, width(solution), ", ".join(COMPONENTS[d]), GRADIENTS[5] if around else ())
    sources = {name: language.files(code, heading) for name, language in LANGUAGES.items()}
    lower, upper = grid_box(solution, dx)
    record = CaseRecord(
        format=FORMAT, solution=label(names.solution), dimension=d,  # type: ignore[arg-type]
        body="ring" if hasattr(plane(solution), "inner") else BODIES[d],  # type: ignore[arg-type]
        lower=numbers(solution.lower), upper=numbers(solution.upper),
        grid_lower=numbers(lower), grid_upper=numbers(upper), cells=cells, dx=dx, ppc=ppc * max(1, layers),
        particles=len(layout), edges=edges(solution), duration=float(solution.duration), steps=steps, dt=dt,
        courant=courant, frames=output_steps(steps, frames), t_half=-dt / 2, t_before=-dt, precision=precision,
        material=MaterialRecord(label(names.material), constants(material), getattr(material, "formula", "")),
        languages={name: tuple(files) for name, files in sources.items()}, layers=layers,
        axisymmetric=around,
    )  # fmt: skip
    force, fields = selfcheck(code, solution, material, layout) if checked else ({}, {})
    texts = {file: text for files in sources.values() for file, text in files.items()}
    columns = particles(exact, layout, material.rho0, dt)
    return Exported(record, start.particles(columns) if start else columns, force, fields, texts)


def numbers(values: Floats) -> tuple[float, ...]:
    """Components as Python's numbers."""
    return tuple(float(value) for value in values)


def constants(material: Any) -> dict[str, float]:
    """Parameters of a material that are numbers, and Lame's constants where it has them."""
    named = [item.name for item in parameters_of(material).values()]
    found = {name: getattr(material, name, None) for name in [*named, "lam", "mu"]}
    return {name: float(value) for name, value in found.items() if isinstance(value, int | float)}


def plane(solution: Any) -> Any:
    """Solution that a slice is cut from, or the solution itself."""
    return solution.plane if isinstance(solution, Slice) else solution


def edges(solution: Any) -> dict[str, Any]:
    """Kinds of the edges by their names: the sides of a rectangle, the faces of a box, or the two circles of a ring."""
    if isinstance(solution, Slice):
        return edges(solution.plane) | solution.faces
    given = solution.boundary
    if hasattr(solution, "inner"):
        return {"inner": given, "outer": given}
    sides = SOLID_SIDES[: 2 * dimension(solution)]
    kinds = [given] * len(sides) if isinstance(given, str) else list(given)
    kinds = ["prescribed" if kind == "moving" else kind for kind in kinds]
    return dict(zip(sides, kinds, strict=True))


def named(letter: str, values: Floats, after: str = "") -> Columns:
    """Columns of an array (n,...) by its components: x of a vector, xx of a tensor."""
    flat = values.reshape(len(values), -1)
    count = flat.shape[1]
    ends: Sequence[str] = {"s": STRESSES, "F": GRADIENTS}.get(letter, {count: AXES[:count]})[count]
    return dict(zip((f"{letter}{end}{after}" for end in ends), flat.T, strict=True))


def particles(exact: Manufactured, layout: Layout, rho0: float, dt: float) -> Columns:
    """Columns (P,) of the particles: positions, and what moves at 0, -dt/2 (`_half`) and -dt (`_before`)."""
    X = layout.X
    found: Columns = {"id": np.arange(len(X), dtype=np.float64), **positions(X)}
    found |= positions(exact.x(X, 0.0), "x")
    found |= named("v", exact.v(X, 0.0)) | named("F", exact.F(X, 0.0)) | named("s", exact.sigma(X, 0.0))
    found |= named("v", exact.v(X, -dt / 2), "_half")
    found |= named("F", exact.F(X, -dt), "_before") | named("s", exact.sigma(X, -dt), "_before")
    found |= {"V0": layout.V0, "m": rho0 * layout.V0}
    for side in range(X.shape[1]):
        found |= named(f"r{side + 1}", layout.r0[:, side])
    return found


def positions(values: Floats, first: str = "X") -> Columns:
    """Columns of positions (n,d), X and Y or x and y."""
    letters = AXES.upper() if first == "X" else AXES
    return {letters[k]: values[:, k] for k in range(values.shape[1])}


def selfcheck(code: Sequence[Program], solution: Any, material: Any, layout: Layout) -> tuple[Columns, Columns]:
    """Columns (R,) of the force at some rows, and of the fields there, with the tolerance of each value."""
    exact, known = derive(solution, material, material.rho0, exact=True), {program.name: program for program in code}
    X, times = rows(layout, float(solution.duration))
    found = {
        name: checked(known[program], expressions, exact, X, times)
        for name, program, expressions in (
            ("b", "body_force", exact.b), ("u", "displacement", exact.u), ("v", "velocity", exact.v),
            ("F", "deformation", exact.F), ("s", "stress", exact.sigma),
        )
    }  # fmt: skip
    at = {**positions(X), "t": times}
    tensor = (len(X), *known["deformation"].shape)
    force = at | named("b", found["b"].values) | named("tolerance_b", found["b"].tolerance)
    beside = at_position(found["b"], exact, X, times, width(solution))
    force |= positions(X + found["u"].values, "x") | named("tolerance_at_b", beside.tolerance)
    values: Columns = dict(at)
    for name in "uvFs":
        one = found[name]
        shape = tensor if name == "F" else one.values.shape
        values |= named(name, one.values.reshape(shape))
        values |= {f"tolerance_{key}": column for key, column in named(name, one.tolerance.reshape(shape)).items()}
    return force, values
