"""Values that exported sources should give, as a table: from the columns of the two files of a case."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mpm_verify.mms.components import AXES, COMPONENTS, GRADIENTS
from mpm_verify.solver.state import Floats


@dataclass(frozen=True)
class Table:
    """Table that a driver reads and the one that it should print.

    Parameters
    ----------
    given
        Reference positions, time and current positions, (R, 2d+1).
    names
        Names of the C values of a row.
    values, tolerance
        What is right, (R,C), and the tolerance of each.
    """

    given: Floats
    names: tuple[str, ...]
    values: Floats
    tolerance: Floats


def needed(dimension: int, axisymmetric: bool = False) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Columns that the two tables of values must have: that of the force, and that of the fields."""
    axes = AXES[:dimension]
    force = [f"{kind}{axis}" for kind in ("b", "tolerance_b", "tolerance_at_b") for axis in axes]
    fields = [f"{before}{name}" for name in components(dimension, axisymmetric) for before in ("", "tolerance_")]
    return (*axes.upper(), "t", *axes, *force), (*axes.upper(), "t", *fields)


def components(dimension: int, axisymmetric: bool = False) -> tuple[str, ...]:
    """Names of the components of u, v, F and sigma, in the order in which a driver prints them."""
    axes = AXES[:dimension]
    F = [f"F{end}" for end in GRADIENTS[5 if axisymmetric else dimension**2]]
    return (*(f"{kind}{axis}" for kind in "uv" for axis in axes), *F, *(f"s{end}" for end in COMPONENTS[dimension]))


def table(
    dimension: int, force: Mapping[str, Floats], fields: Mapping[str, Floats], axisymmetric: bool = False
) -> Table:
    """Table of two tables of values. Raises ValueError where they are not of the same rows."""
    axes, fielded = AXES[:dimension], components(dimension, axisymmetric)
    at = [*axes.upper(), "t"]
    if any(len(force[name]) != len(fields[name]) or (force[name] != fields[name]).any() for name in at):
        raise ValueError("the two tables of values are not of the same rows; export the case again")
    b = [f"b{axis}" for axis in axes]
    values = [*(force[name] for name in b), *(force[name] for name in b), *(fields[name] for name in fielded)]
    tolerance = [force[f"tolerance_{name}"] for name in b] + [force[f"tolerance_at_{name}"] for name in b]
    tolerance += [fields[f"tolerance_{name}"] for name in fielded]
    names = (*b, *(f"{name} at x" for name in b), *fielded)
    given = np.column_stack([*(force[name] for name in at), *(force[axis] for axis in axes)])
    return Table(given, names, np.column_stack(values), np.column_stack(tolerance))
