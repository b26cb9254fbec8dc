"""The auditor: what a study of a manufactured solution cannot see, and how strong the solution is, from its fields."""

from dataclasses import dataclass
from typing import Any

from mpm_verify.mms.blind_spots import BlindSpot, Numbers, judge
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.mms.measure import Law, measure


@dataclass(frozen=True)
class Audit:
    """Blind spots in a fixed order, what holds for every solution last; `numbers` as mms/measure.py describes them."""

    spots: tuple[BlindSpot, ...]
    numbers: Numbers

    @property
    def blind(self) -> tuple[BlindSpot, ...]:
        """What a study cannot see."""
        return tuple(spot for spot in self.spots if spot.blind)

    @property
    def seen(self) -> tuple[BlindSpot, ...]:
        """What it can."""
        return tuple(spot for spot in self.spots if not spot.blind)


def audit(exact: Manufactured, solution: Any, law: Law) -> Audit:
    """Audit of the fields `exact` that `solution` has in a body of the material `law`; takes some tenths of a second.

    Nothing is known by the solution's name, so one of your own is audited like those of the library.
    """
    numbers = measure(exact, solution, law)
    return Audit(judge(numbers), numbers)
