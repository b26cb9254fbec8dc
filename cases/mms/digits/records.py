"""Records of a comparison with references: digits by quantity, where the two part, what is not told apart."""

from dataclasses import dataclass, field
from enum import StrEnum

from mpm_verify.cases.mms.digits.reference import Scheme
from mpm_verify.cases.solvers.log import EMPTY, Log
from mpm_verify.solver.failure import Failure

AGREES = 3.0  # digits: with fewer, a quantity parts
NEAR_FLOOR = 0.5  # digits: with so many of those that a file has, its digits and not its numbers part


class Agreement(StrEnum):
    """Outcome of a comparison."""

    AGREES = "agrees"  # the nearest reference agrees in each quantity
    PARTS = "parts"  # in one or more it does not
    FEW_DIGITS = "few_digits"  # where it does not, the file has no more digits
    FAILED = "failed"  # there is no answer
    NO_REFERENCE = "no_reference"  # no run of the reference came to its end


@dataclass(frozen=True)
class Against:
    """Answer held against one reference, by quantity.

    Parameters
    ----------
    scheme
        The reference.
    rms
        Errors of the reference over the frames.
    digits
        Digits in which rms values agree.
    particles
        Digits in which particles agree, frame by frame; empty where rms values alone are known.
    """

    scheme: Scheme
    rms: dict[str, float]
    digits: dict[str, float]
    particles: dict[str, float] = field(default_factory=dict)

    @property
    def agreement(self) -> dict[str, float]:
        """Digits that decide: of particles, where they are known."""
        return self.particles or self.digits

    @property
    def score(self) -> float:
        """Mean digits: a quantity that is off from all references alike does not change their order."""
        return sum(self.agreement.values()) / max(1, len(self.agreement))


@dataclass(frozen=True)
class Parting:
    """First frame and particle where a quantity is off from the nearest reference by more than the digits promise.

    Parameters
    ----------
    quantity
        u, v, F or sigma.
    frame, step
        Number of the frame, from 1 on, and of its step.
    particle, X
        Number of the particle whose difference is largest there, and its reference position.
    difference, size
        That difference, and the rms error of the reference in that frame.
    """

    quantity: str
    frame: int
    step: int
    particle: int
    X: tuple[float, float]
    difference: float
    size: float


@dataclass(frozen=True)
class Alike:
    """Reference that agrees with the nearest in all digits shown, and a stored case that tells them apart.

    Parameters
    ----------
    scheme
        The reference.
    solution, cells
        Stored case in which the two agree in fewest digits; no cells where none tells them apart.
    digits
        Digits there, of the quantity in which they differ most.
    """

    scheme: Scheme
    solution: str = ""
    cells: int = 0
    digits: float = 0.0


@dataclass(frozen=True)
class Compared:
    """Comparison of an answer with references, the nearest first.

    Parameters
    ----------
    rms
        Errors of the answer by quantity, over the frames.
    limit
        Digits that the numbers in its files allow, by quantity.
    against
        References, the nearest first.
    framed
        Whether frames of the references were compared, and not their stored rms values alone.
    farther
        Number of references that the stored rms values leave out, as others are nearer.
    failed
        References that did not come to their end.
    partings
        Quantities that part from the nearest, the first to do so first; none without frames.
    alike
        References that agree with the nearest in all digits shown.
    failure
        Reason why there is no answer.
    log
        What the solver printed.
    still
        Whether no particle leaves its start, in the digits that the files have: then no reference is near.
    """

    rms: dict[str, float]
    limit: dict[str, float]
    against: tuple[Against, ...]
    framed: bool = False
    farther: int = 0
    failed: dict[Scheme, Failure] = field(default_factory=dict)
    partings: tuple[Parting, ...] = ()
    alike: tuple[Alike, ...] = ()
    failure: Failure | None = None
    log: Log = EMPTY
    still: bool = False

    @property
    def nearest(self) -> Against:
        """Nearest reference."""
        return self.against[0]

    @property
    def parts(self) -> tuple[str, ...]:
        """Quantities in which the nearest reference does not agree."""
        return tuple(q for q, digits in self.nearest.agreement.items() if digits < AGREES) if self.against else ()

    @property
    def limited(self) -> tuple[str, ...]:
        """Those of them in which the files have no more digits."""
        return tuple(q for q in self.parts if self.nearest.agreement[q] > self.limit[q] - NEAR_FLOOR)

    @property
    def outcome(self) -> Agreement:
        """Outcome."""
        if self.failure:
            return Agreement.FAILED
        if not self.against:
            return Agreement.NO_REFERENCE
        if not self.parts:
            return Agreement.AGREES
        return Agreement.FEW_DIGITS if self.limited == self.parts else Agreement.PARTS
