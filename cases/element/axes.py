"""Axes of element tests. Names of tests are those of paths.py, which is heavier to import."""

from dataclasses import dataclass
from hashlib import sha256
from math import inf
from pathlib import Path
from typing import ClassVar

from mpm_verify.cases.harness.study import RunRecord, axis
from mpm_verify.solver.plugins import MATERIALS

CONFINED = 5e3  # the scale of the paper's column
PROPERTIES, PATH = "properties", "path"  # what is known of the material beside curves; the path of a file
PLANE_TESTS = (
    "isotropic", "oedometric", "biaxial", "constant_s", "shear_stress", "shear_volume", "undrained", "cyclic_shear",
)  # fmt: skip
TRIAXIAL_TESTS = ("triaxial_compression", "triaxial_extension", "triaxial_undrained")
MOTION_TESTS = ("finite_shear",)
TEST_NAMES = (*PLANE_TESTS, *TRIAXIAL_TESTS, *MOTION_TESTS)
STARTS = ("isotropic", "none", "k0", "oedometric")
MOTIONS = ("none", "simple_shear")
AXES = {"test": (*PLANE_TESTS, PROPERTIES)}
MOST_STEPS = 10_000


@dataclass(frozen=True)
class ElementRun(RunRecord):
    """One element test of a material. Raises ValueError with one line for what no test has."""

    material: str = axis("mohr_coulomb", "Constitutive model.", MATERIALS)
    test: str = axis("biaxial", f"{', '.join(TEST_NAMES)}, or {PROPERTIES}: tables and limits of the material.",
                     choices=(*TEST_NAMES, PROPERTIES))  # fmt: skip
    stress: float = axis(CONFINED, "Isotropic stress at the start, compression positive, Pa.")
    start: str = axis("isotropic", "Stress at the start: isotropic; none; k0, lateral 1 - sin phi of the vertical "
                      "--stress; oedometric, as loading without lateral strain by the material itself leaves.",
                      choices=STARTS)  # fmt: skip
    steps: int = axis(100, "Strain steps of the coarsest run; the finest has 16 times as many; from 50 on they settle.")
    path: str = axis("", "CSV file with a path: columns exx, eyy, exy or gxy = 2 exy, ezz; sxx, syy, sxy, szz for "
                     "stresses; or Fxx, Fxy, Fyx, Fyy, Fzz.")  # fmt: skip
    units: str = axis("", "Units of the strains in that file: percent or fraction; usual is what its header says.",
                      choices=("percent", "fraction"))  # fmt: skip
    motion: str = axis("none", "Strains of that file as a motion: simple_shear, F = [[1, gxy], [0, 1]] diag(exp exx, "
                       "exp eyy), so that the rate counts; usual where the material is given one.",
                       choices=MOTIONS)  # fmt: skip
    case: ClassVar[str] = "element"

    def __post_init__(self) -> None:
        known = (*TEST_NAMES, PROPERTIES, PATH)
        if self.test not in known:
            raise ValueError(f"no test {self.test!r}; choose from {', '.join(known[:-1])}")
        if not 1 <= self.steps <= MOST_STEPS:
            raise ValueError(f"steps = {self.steps} cannot be run; choose whole numbers from 1 to {MOST_STEPS}")
        if not 0 < self.stress < inf:
            raise ValueError(f"stress = {self.stress:g} must be above zero and finite: compression is positive")
        if bool(self.path) != (self.test == PATH):
            raise ValueError("path = FILE.csv and test = path belong together; give both or neither")
        if self.units and not self.path:
            raise ValueError("units needs a strain path from a file; give path = FILE.csv too")
        if self.motion != "none" and not self.path:
            raise ValueError("motion needs a strain path from a file; give path = FILE.csv too")
        for name, words in (("start", STARTS), ("motion", MOTIONS)):
            if getattr(self, name) not in words:
                raise ValueError(f"no {name} {getattr(self, name)!r}; choose from {', '.join(words)}")

    @property
    def cost(self) -> float:
        """Steps of all runs of the test, in updates of a small grid run."""
        return 100.0 * self.steps

    @property
    def digest(self) -> str:
        """Name of the Result, 16 hex digits; of a path from a file also its content."""
        return self.named(file_digest(self.path) if self.path else "")

    def __str__(self) -> str:
        return f"{self.material}, {self.test}"


def file_digest(path: str) -> str:
    """Hash (SHA-256) of the content of a file; of one that cannot be read any more, text that no other has."""
    try:
        return sha256(Path(path).read_bytes()).hexdigest()
    except OSError:
        return f"unreadable {path}"
