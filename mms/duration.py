"""Solution over a number of its periods, in place of the duration that it states."""

from functools import cached_property
from typing import Any


def period(solution: Any) -> float:
    """Period of a solution; its duration, unless it says otherwise."""
    return float(getattr(solution, "period", solution.duration))


def quarters(solution: Any, periods: float) -> int:
    """Quarters of a period in that many periods, 0 for the duration it states; 1 where they are a fraction."""
    count = 4 * (periods or solution.duration / period(solution))
    return max(1, round(count)) if abs(count - round(count)) < 1e-9 else 1


def lasting(solution: Any, periods: float) -> Any:
    """Make the same solution over a number of its periods.

    Parameters
    ----------
    solution
        A plug-in of mms/solutions, or a user's.
    periods
        Number of periods; 0 for the duration that the solution states.

    Returns
    -------
    object
        The solution itself, or one of a class below its own, with another `duration`. What it has found of itself, such
        as its edges, it finds anew.
    """
    if not periods:
        return solution
    kind, duration = type(solution), periods * period(solution)
    given = property(lambda self: duration, lambda self, stated: None)  # a dataclass may set its own
    names = {"duration": given, "__module__": kind.__module__, "__doc__": kind.__doc__}
    made: Any = object.__new__(type(kind.__name__, (kind,), names))
    known = {name: value for name, value in vars(solution).items() if not _found(kind, name)}
    vars(made).update(known)
    return made


def _found(kind: type, name: str) -> bool:
    """Whether an attribute is one that the solution computes when it is asked for."""
    return isinstance(getattr(kind, name, None), cached_property)
