"""Components of the fields of an answer: names of their columns, and arrays of all components taken apart."""

from typing import Any

QUANTITIES = {
    "x": ("x", "y"),
    "v": ("vx", "vy"),
    "F": ("Fxx", "Fxy", "Fyx", "Fyy"),
    "sigma": ("sxx", "syy", "szz", "sxy"),
    "X": ("X", "Y"),
    "V": ("V",),
}


def spread(stored: dict[str, Any]) -> dict[str, Any]:
    """Columns of arrays by name; X, x, v, F and sigma may hold all their components."""
    found: dict[str, Any] = {}
    for name, values in stored.items():
        parts = QUANTITIES.get(name)
        if parts is None or values.ndim == 1:
            found[name] = values
            continue
        flat = values.reshape(len(values), -1)
        if name == "F" and flat.shape[1] == 9:
            flat = flat[:, (0, 1, 3, 4)]
        elif name == "sigma" and flat.shape[1] == 9:
            flat = flat[:, (0, 4, 8, 1)]
        elif flat.shape[1] == 3 and len(parts) == 2:
            flat = flat[:, :2]
        if flat.shape[1] != len(parts):
            raise ValueError(name)
        found |= {part: flat[:, k] for k, part in enumerate(parts)}
    return found
