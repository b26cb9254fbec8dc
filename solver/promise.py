"""Promise of a method before any run: how its error falls on refinement. Imports nothing heavy."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Promise:
    """Promise of how the error of u falls on refinement.

    Parameters
    ----------
    order
        Order in dx; None where the error does not fall with one.
    stalls
        Without an order: whether the error stalls, or else grows.
    source
        Publication that says so, before any run.
    """

    order: float | None
    stalls: bool = False
    source: str = ""
