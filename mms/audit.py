"""Auditor: what a study of a manufactured solution cannot see, and how strong the solution is, from its fields."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.blind_spots import BlindSpot, Numbers, judge
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.mms.measure import WaveMaterial, measure


@dataclass(frozen=True)
class Audit:
    """Blind spots in a fixed order, what holds for every solution last; `numbers` as mms/measure.py describes them."""

    spots: tuple[BlindSpot, ...]
    numbers: Numbers

    @property
    def blind(self) -> tuple[BlindSpot, ...]:
        """Blind spots: what a study cannot see."""
        return tuple(spot for spot in self.spots if spot.blind)

    @property
    def seen(self) -> tuple[BlindSpot, ...]:
        """Rest of the list: what a study can see."""
        return tuple(spot for spot in self.spots if not spot.blind)


def audit(exact: Manufactured, solution: Any, material: WaveMaterial) -> Audit:
    """Find what a study of a manufactured solution cannot see; takes some tenths of a second.

    Nothing is known by the solution's name, so one of your own is audited like those of the library.

    Parameters
    ----------
    exact
        Fields of the solution in the material.
    solution
        Solution: body, duration, boundary.
    material
        Constitutive model.

    Returns
    -------
    Audit
        Blind spots, what is seen, and the numbers that say so.
    """
    numbers = measure(exact, solution, material)
    return Audit(judge(numbers), numbers)
