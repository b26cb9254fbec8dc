"""Element tests as data: conditions on strains and stresses, three in plane strain and four with zz, and a length.

A strain condition gives the increment of a combination of xx, yy, xy (tensor) and zz, a stress condition holds one
where it was. Compression is along y. A path of one's own comes from a CSV file (path_file.py, legs.py); a motion is a
path of F (motion.py). How they are followed stands in following.py.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from mpm_verify.solver.state import Floats

CYCLES = 3


@dataclass(frozen=True)
class Condition:
    """Condition on a combination with `weights` of xx, yy, xy, and of zz in a test that strains it.

    Of the strain, which goes through `fraction` of the length of the path; or of the stress, which stays.
    """

    of: Literal["strain", "stress"]
    weights: tuple[float, ...]
    fraction: float = 0.0


XX, YY, XY = (Condition("strain", w) for w in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))


def given(weights: tuple[float, ...], fraction: float) -> Condition:
    """Condition that gives a strain."""
    return Condition("strain", weights, fraction)


def held(*weights: float) -> Condition:
    """Condition that holds a stress."""
    return Condition("stress", weights)


@dataclass(frozen=True)
class PathSource:
    """Content of the file of a path: columns that are `used`, and those that are not strains.

    Strains out of the plane are `zero` in every row; `largest` is the largest strain component. `lines` are those of
    the rows, `stresses` the columns that control a stress, `motion` the word for how F came about, if it did.
    """

    name: str
    used: tuple[str, ...]
    unused: tuple[str, ...] = ()
    zero: tuple[str, ...] = ()
    largest: float = 0.0
    lines: tuple[int, ...] = ()
    stresses: tuple[str, ...] = ()
    motion: str = ""


@dataclass(frozen=True)
class ElementTest:
    """Element test, with the `length` of its path in strain.

    `shear`: its curves are of xy; `closed`: the volume is kept; `cyclic`: to either side CYCLES times and back to the
    middle; `loose`: it starts at this fraction of the stress; `axial`: lateral stresses or strains are equal, so that q
    is drawn; `motion`: its points are F: xx, yy, xy, zz, yx. Of a path from a file `points` are the strains at the
    corners (R,n), and `targets` the stresses (R,n), each not a number where it is not given.
    """

    name: str
    title: str
    conditions: tuple[Condition, ...]
    length: float
    shear: bool = False
    closed: bool = False
    cyclic: bool = False
    loose: float = 1.0
    axial: bool = False
    motion: bool = False
    points: Floats = field(default_factory=lambda: np.zeros((0, 3)), compare=False)
    targets: Floats = field(default_factory=lambda: np.zeros((0, 3)), compare=False)
    source: PathSource | None = field(default=None, compare=False)

    @property
    def size(self) -> int:
        """Number of its components of strain: 3 in plane strain, 4 with zz, 5 of a motion."""
        return self.points.shape[1] if len(self.points) else len(self.conditions)

    @property
    def mixed(self) -> bool:
        """Whether stresses are given in a path from a file."""
        return len(self.targets) > 0

    @property
    def legs(self) -> int:
        """Number of straight pieces: a number of steps is a multiple of it, so that no step goes around a corner."""
        return max(1, len(self.points) - 1, 4 * CYCLES * self.cyclic)

    def steps(self, least: int) -> int:
        """Smallest number of steps from `least` on that is the same on each piece."""
        return -(-least // self.legs) * self.legs

    def gone(self, steps: int) -> Floats:
        """Strain (steps+1,) by which the path has gone along its conditions, there and back."""
        fraction = np.linspace(0, 1, steps + 1)
        if not self.cyclic:
            return fraction * self.length
        corners = np.concatenate([[0.0], np.tile([1.0, 0.0, -1.0, 0.0], CYCLES)])
        there: Floats = np.interp(fraction * self.legs, np.arange(self.legs + 1), corners) * self.length
        return there


CELL = (held(1, 0, 0, 0), held(0, 0, 0, 1), given((0, 0, 1, 0), 0))  # the pressure of a triaxial cell stays
TESTS = {
    test.name: test
    for test in (
        ElementTest(
            "isotropic", "Isotropic compression", (given((1, 0, 0), -0.5), given((0, 1, 0), -0.5), XY), 0.01
        ),
        ElementTest("oedometric", "Oedometric compression", (XX, given((0, 1, 0), -1), XY), 0.01, loose=0.01),
        ElementTest("biaxial", "Drained biaxial compression", (held(1, 0, 0), given((0, 1, 0), -1), XY), 0.055),
        ElementTest(
            "constant_s", "Shear at constant mean stress", (given((1, -1, 0), 1), held(0.5, 0.5, 0), XY), 0.07
        ),
        ElementTest(
            "shear_stress", "Simple shear at constant vertical stress",
            (XX, held(0, 1, 0), given((0, 0, 1), 0.5)), 0.05, shear=True,
        ),
        ElementTest(
            "shear_volume", "Simple shear at constant volume", (XX, YY, given((0, 0, 1), 0.5)), 0.02,
            shear=True, closed=True,
        ),
        ElementTest(
            "undrained", "Undrained biaxial compression", (given((1, 0, 0), 1), given((0, 1, 0), -1), XY), 0.01,
            closed=True,
        ),
        ElementTest(
            "cyclic_shear", "Cyclic simple shear at constant vertical stress",
            (XX, held(0, 1, 0), given((0, 0, 1), 0.5)), 0.02, shear=True, cyclic=True,
        ),
        ElementTest("triaxial_compression", "Drained triaxial compression", (*CELL, given((0, 1, 0, 0), -1)), 0.05,
                    axial=True),
        ElementTest("triaxial_extension", "Drained triaxial extension", (*CELL, given((0, 1, 0, 0), 1)), 0.025,
                    axial=True),
        ElementTest(
            "triaxial_undrained", "Undrained triaxial compression",
            (given((1, 0, 0, 0), 0.5), given((0, 0, 0, 1), 0.5), given((0, 1, 0, 0), -1), given((0, 0, 1, 0), 0)), 0.02,
            closed=True, axial=True,
        ),
        ElementTest(
            "finite_shear", "Simple shear of F to 5", (), 5.0, shear=True, closed=True, motion=True,
            points=np.array([[1.0, 1.0, 0.0, 1.0, 0.0], [1.0, 1.0, 5.0, 1.0, 0.0]]),
        ),
    )
}  # fmt: skip
