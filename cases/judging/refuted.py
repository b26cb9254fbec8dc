"""Refutation from below: whether errors lie so far from all that are sound that no scatter explains it.

Sound are errors that tend to the expected order p and have nearly reached it: h^p / (1 + a h), with a so small that the
order of the finest pair is in the band, mixed with as much of a lower order or a floor as is allowed, which adds or
adds in the square. The nearest of them is a fit. Where it leaves more than another description of the same errors does,
by more than chance, the errors are not sound.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mpm_verify.cases.judging.contamination import Nearest, nearest, relative, terms
from mpm_verify.cases.judging.fit import Array, Fit
from mpm_verify.cases.judging.scatter import EXACT, limit

SURE, SQUARED = 0.99, 0.998  # one-sided; more for squares, which are looked at beside sums
BESIDE = 0.95  # where the interval of the slope has to be below the band too
REACHED = 0.2  # below the expected order: what the finest pair of sound errors may be, whatever the band
STARTS = 5  # values of a: sums of two would fall on coarse levels, as a leak does
RESOLUTION = 0.005  # of a fraction


@dataclass(frozen=True)
class Refutation:
    """Errors of a fit, and the nearest sound ones.

    Parameters
    ----------
    fit
        The errors.
    order, low
        Expected order, and the order from which on a pair of levels has reached it.
    """

    fit: Fit
    order: float
    low: float

    @cached_property
    def starts(self) -> list[Array]:
        """Errors (n,) of the expected order and those that are still on their way to it, 1 on the finest level."""
        x = self.fit.h / self.fit.h[-1]
        behind = min(self.order - self.low, REACHED)
        most = min(1.0, (x[-2] ** behind - 1) / (x[-2] - 1))
        return [x**self.order / (1 - s + s * x) for s in np.linspace(0, most, STARTS)]

    @cached_property
    def mixed(self) -> tuple[Nearest, Nearest]:
        """Best fit of order, lower order and floor, where they add and where their squares add."""
        plain, square = (nearest(self.fit.h, self.fit.error, self.order, power) for power in (1, 2))
        return plain, square

    @property
    def told(self) -> Nearest:
        """The better of the two fits: a sum, unless a sum of squares leaves less by more than chance."""
        plain, square = self.mixed
        chance = self.chance(square.left, square.dof, SQUARED) if square.dof else plain.left
        return square if plain.left > np.hypot(square.left, chance) + EXACT else plain

    @cached_property
    def scaled(self) -> Array:
        """Errors (n,), 1 on the finest level."""
        found: Array = self.fit.error / self.fit.error[-1]
        return found

    def left(self, allowed: float) -> float:
        """Norm of what the nearest sound errors leave, with `allowed` of the finest of another order."""
        return min(self._left(start, power, allowed) for start in self.starts for power in (1, 2))

    def _left(self, start: Array, power: int, allowed: float) -> float:
        """Norm of what is left of the error, or of its square, in terms of the error."""
        most = allowed if power == 1 else 1 - (1 - allowed) ** 2
        mixed = [(1 - most) * start**power + most * other for other in terms(self.fit.h, self.order, power)[1:]]
        return relative([start**power, *mixed], self.scaled**power)[1] / power

    def shown(self, left: float, dof: float, allowed: float, sure: float) -> bool:
        """Whether a description that leaves so much is better than all that are sound, by more than chance.

        The usual scatter is pooled, and where the residuals say more they are taken at their word.
        """
        return dof >= 1 and self.left(allowed) > np.hypot(left, self.chance(left, dof, sure)) + EXACT

    def chance(self, left: float, dof: float, sure: float) -> float:
        """Largest relative deviation by chance."""
        scatter, noise = left / float(np.sqrt(dof)), self.fit.noise
        return max(limit(scatter, dof, sure, noise), limit(scatter, dof, sure, 0.0))

    def below(self, allowed: float) -> bool:
        """Whether a power of h of its own is better than all that is sound."""
        dof = len(self.fit.h) - 2
        return self.shown(self.fit.rough * float(np.sqrt(dof)), dof, allowed, BESIDE)

    def contaminated(self, allowed: float) -> bool:
        """Whether more than `allowed` of the finest error is of another order."""
        sure = {1: SURE, 2: SQUARED}
        return any(self.shown(one.left, one.dof, allowed, sure[one.power]) for one in self.mixed)

    def least(self, allowed: float) -> float:
        """Smallest fraction of the finest error that is of another order, as far as scatter goes, above `allowed`."""
        low, high = allowed, 1.0
        while high - low > RESOLUTION:
            middle = (low + high) / 2
            low, high = (middle, high) if self.contaminated(middle) else (low, middle)
        return low
