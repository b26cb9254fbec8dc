"""Components of the fields of an answer, in one to three dimensions, by the names of their columns."""

from typing import Any

import numpy as np

from mpm_verify.mms.components import AXES, COMPONENTS, GRADIENTS, HOOP
from mpm_verify.solver.state import Floats


def quantities(dimension: int) -> dict[str, tuple[str, ...]]:
    """Columns of x, v, F row by row, sigma, X and the volume; in two dimensions of zz of F too, for axisymmetry."""
    axes = AXES[:dimension]
    around = {"Fzz": (f"F{HOOP}",)} if dimension == 2 else {}
    return {
        "x": tuple(axes),
        "v": tuple(f"v{a}" for a in axes),
        "F": tuple(f"F{end}" for end in GRADIENTS[dimension**2]),
        **around,
        "sigma": tuple(f"s{end}" for end in COMPONENTS[dimension]),
        "X": tuple(axes.upper()),
        "V": ("V",),
    }


QUANTITIES = {dimension: quantities(dimension) for dimension in COMPONENTS}
NAMES = {  # of an array with all components, by its name and their number
    (name, len(parts)): parts for dimension in COMPONENTS for name, parts in QUANTITIES[dimension].items()
} | {("F", len(ends)): tuple(f"F{end}" for end in ends) for ends in GRADIENTS.values()}
UPPER = (0, 4, 8, 1, 5, 2)  # components of a symmetric tensor with nine, in the order of COMPONENTS
WEIGHTS = {
    1: np.array([1.0]),
    4: np.array([1.0, 1.0, 1.0, 2.0]),
    6: np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0]),
}  # of a sum of squares


def reference(columns: dict[str, Floats], dimension: int) -> Floats:
    """Reference positions (P,d) of columns of particles."""
    return np.stack([columns[axis] for axis in AXES[:dimension].upper()], axis=-1)


def spread(stored: dict[str, Any], dimension: int = 2) -> dict[str, Any]:
    """Columns of arrays by name; X, x, v, F and sigma may hold all their components. Raises ValueError.

    All of them are one component in one dimension alone.
    """
    found: dict[str, Any] = {}
    for name, values in stored.items():
        if values.ndim == 1 or name not in {one for one, _ in NAMES}:
            found[name] = values
            continue
        flat = values.reshape(len(values), -1)
        if name == "sigma" and flat.shape[1] == 9:
            flat = flat[:, UPPER]
        few = flat.shape[1] == 1 < dimension and len(QUANTITIES[2].get(name, ())) > 1
        if few or (name, flat.shape[1]) not in NAMES:
            raise ValueError(name)
        parts = NAMES[name, flat.shape[1]]
        found |= {part: flat[:, k] for k, part in enumerate(parts)}
    return found
