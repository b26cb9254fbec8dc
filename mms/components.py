"""Names of coordinates, and of the components of a deformation gradient and of a stress by their number.

In one dimension the strain is uniaxial, and xx is all that is told. In axisymmetry x is the radius, y the axis, and zz
the hoop direction, as in plane strain the direction out of the plane.
"""

import numpy as np

from mpm_verify.solver.state import Floats

AXES = "xyz"
COMPONENTS = {1: ("xx",), 2: ("xx", "yy", "zz", "xy"), 3: ("xx", "yy", "zz", "xy", "yz", "xz")}  # by the dimension
STRESSES = {len(ends): ends for ends in COMPONENTS.values()}
HOOP = "zz"
GRADIENTS = {d * d: tuple(a + b for a in AXES[:d] for b in AXES[:d]) for d in COMPONENTS}  # by their number, row by row
GRADIENTS[5] = (*GRADIENTS[4], HOOP)  # of axisymmetry


def at(X: Floats, digits: int = 4) -> str:
    """Text of a reference position (d,): `X = 0.5`, `(X, Y) = (0.5, 0.25)`."""
    names, numbers = AXES[: len(X)].upper(), [f"{value:.{digits}g}" for value in X]
    return f"X = {numbers[0]}" if len(X) == 1 else f"({', '.join(names)}) = ({', '.join(numbers)})"


def square(F: Floats) -> Floats:
    """Square matrices (...,n,n) of components row by row (...,n*n); of the five of axisymmetry 3 x 3."""
    count = F.shape[-1]
    if count != len(GRADIENTS[5]):
        n = round(count**0.5)
        return F.reshape(*F.shape[:-1], n, n)
    found = np.zeros((*F.shape[:-1], 3, 3))
    found[..., :2, :2] = F[..., :4].reshape(*F.shape[:-1], 2, 2)
    found[..., 2, 2] = F[..., 4]
    return found
