"""What a method promises before any run: how its error falls on refinement. Imports nothing heavy."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Promise:
    """How the error of u falls on refinement: with an `order`, or None; then it `stalls`, or else it grows.

    `source`: who says so, before any run of ours.
    """

    order: float | None
    stalls: bool = False
    source: str = ""
