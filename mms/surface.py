"""Edge of a body as its solution says: sides that walls hold, and exact data of those that are pulled or driven."""

from collections.abc import Mapping
from typing import Any

from mpm_verify.mms.discretisation import boundary_kinds
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.solver.boundary import Kind
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.surface import Given, Surface, faces, open_sides

WALLS: Mapping[str, Kind] = {"fixed": "fixed", "roller": "roller", "free": "free", "pulled": "free",
                             "prescribed": "free"}  # fmt: skip


def walls(solution: Any) -> tuple[Kind, Kind, Kind, Kind]:
    """Kinds of the walls on the four sides: none beside an edge that is pulled or prescribed."""
    left, right, bottom, top = (WALLS[kind] for kind in boundary_kinds(solution))
    return left, right, bottom, top


def surface(solution: Any, exact: Manufactured, layout: Layout) -> Surface | None:
    """Edge that is pulled or driven, with exact data; None where no side is.

    Parameters
    ----------
    solution
        Solution on a rectangle.
    exact
        Its fields.
    layout
        Layout of the particles.
    """
    sides = open_sides(boundary_kinds(solution))
    if not sides:
        return None
    return Surface(faces(layout, solution.lower, solution.upper, sides), Given(exact.P, exact.x))
