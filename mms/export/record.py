"""Record of an exported case, as case.json holds it; imports nothing heavy."""

from dataclasses import asdict, dataclass
from typing import Any, Final, Literal

FORMAT: Final = "mpm-verify-case-1"
Precision = Literal["double", "single"]
Edge = Literal["fixed", "roller", "free", "pulled", "prescribed"]


@dataclass(frozen=True)
class MaterialRecord:
    """Constitutive model.

    Parameters
    ----------
    name
        Its name, with parameters that differ from their defaults.
    constants
        Its parameters and Lame's constants by name; stresses, and rho0 a mass per volume.
    sigma
        Formula of the Cauchy stress; empty where none is known.
    """

    name: str
    constants: dict[str, float]
    sigma: str


@dataclass(frozen=True)
class CaseRecord:
    """Case as another solver reads it; any consistent set of units.

    Parameters
    ----------
    format
        Name of the format with its version.
    solution, material
        Manufactured solution and constitutive model.
    dimension
        1, uniaxial strain; 2, plane strain or axisymmetric; 3.
    body
        Shape of the body; a ring in three dimensions is one cell thick.
    lower, upper
        Corners of the body's box, lengths.
    grid_lower, grid_upper
        Corners of the grid, which is wider beside free, pulled and prescribed edges; lengths.
    cells, dx
        Cells along the width of the box, and their side.
    ppc, particles
        Particles in a cell, and all of them.
    edges
        Kind of each edge, by its name: left and right are lower and upper in x, bottom and top in y, back and front
        in z.
    duration, steps, dt, courant
        Time, number of steps, their length, and C dt / dx with the reference speed C of the solution.
    frames
        Step numbers whose state is to be written, the last step among them.
    t_half, t_before
        Times of the columns `_half` and `_before` of the particles: -dt/2 and -dt.
    languages
        Languages that the force is written in, with their files.
    precision
        Precision that the solver computes with.
    layers
        Layers of particles in z of a plane-strain solution that is one cell thick in three dimensions; otherwise it is
        not there.
    axisymmetric
        Whether x is the radius and y the axis, and volumes and masses are per radian; otherwise it is not there.
    """

    format: Literal["mpm-verify-case-1"]
    solution: str
    dimension: Literal[1, 2, 3]
    body: Literal["rectangle", "ring", "box", "bar"]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    grid_lower: tuple[float, ...]
    grid_upper: tuple[float, ...]
    cells: int
    dx: float
    ppc: int
    particles: int
    edges: dict[str, Edge]
    duration: float
    steps: int
    dt: float
    courant: float
    frames: tuple[int, ...]
    t_half: float
    t_before: float
    material: MaterialRecord
    languages: dict[str, tuple[str, ...]]
    precision: Precision = "double"
    layers: int = 0
    axisymmetric: bool = False


def content(record: Any) -> dict[str, Any]:
    """Record as case.json has it: without layers where there is no slice, or axisymmetry where there is none."""
    return {name: value for name, value in asdict(record).items() if name not in ("layers", "axisymmetric") or value}


def flat(record: Any) -> list[tuple[str, str]]:
    """Names and values, one word each, of all that a solver needs: components and frames get names of their own.

    `record` is a dataclass: of a case, or of a benchmark.
    """
    found: list[tuple[str, str]] = []

    def add(name: str, value: Any) -> None:
        if isinstance(value, dict):
            for key, one in value.items():
                add(f"{name}_{key}", one)
        elif isinstance(value, list | tuple):
            counted = name == "frames" or (bool(value) and isinstance(value[0], dict))
            names = [str(k + 1) for k in range(len(value))] if counted else "xyz"
            found.extend([(name, str(len(value)))] * counted)
            for key, one in zip(names, value, strict=False):
                add(f"{name}_{key}", one)
        elif value != "":
            found.append((name, repr(value) if isinstance(value, float) else str(value).replace(" ", "_")))

    for name, value in content(record).items():
        if name == "material":
            add("material", {"name": value["name"], **value["constants"], "sigma": value["sigma"]})
        elif name != "languages":
            add(name, value)
    return found
