"""Components of the fields of an answer, in two dimensions and in three, by the names of their columns."""

import numpy as np

from mpm_verify.mms.components import AXES, COMPONENTS
from mpm_verify.solver.state import Floats


def quantities(dimension: int) -> dict[str, tuple[str, ...]]:
    """Columns of x, v, F row by row, and sigma."""
    axes = AXES[:dimension]
    return {
        "x": tuple(axes),
        "v": tuple(f"v{a}" for a in axes),
        "F": tuple(f"F{a}{b}" for a in axes for b in axes),
        "sigma": tuple(f"s{end}" for end in COMPONENTS[dimension]),
    }


QUANTITIES = {dimension: quantities(dimension) for dimension in (2, 3)}
NAMES = {  # of an array with all components, by its name and their number
    (name, len(parts)): parts
    for dimension in (2, 3)
    for name, parts in {**QUANTITIES[dimension], "X": tuple(AXES[:dimension].upper())}.items()
}
UPPER = (0, 4, 8, 1, 5, 2)  # components of a symmetric tensor with nine, in the order of COMPONENTS
WEIGHTS = {4: np.array([1.0, 1.0, 1.0, 2.0]), 6: np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])}  # of a sum of squares


def reference(columns: dict[str, Floats], dimension: int) -> Floats:
    """Reference positions (P,d) of columns of particles."""
    return np.stack([columns[axis] for axis in AXES[:dimension].upper()], axis=-1)
