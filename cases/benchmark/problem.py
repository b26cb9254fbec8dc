"""Contract of a problem with a known answer: a file of cases/benchmark/problems, or a file of a user's.

The docstring of the file is the statement of the problem, with its source; the class has its parameters as fields, each
with the usual value, and says how it is set up, what is measured, and what is known of that:

    measures, expectation   errors whose order is judged on refinement, see cases/harness/build.py
    held                    numbers that are held against what is known: each run's, or the Richardson limit of three
                            levels; an exact invariant is one with a bound of round-off
    spoilt runs             `run.control` is the failing control: the same problem with a mistake in it, which must not
                            pass; it shows that what is judged can fail
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import ClassVar, Literal

from mpm_verify.cases.benchmark.run import Run
from mpm_verify.cases.harness.checks import Unjudged, Way
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.model import Load, Model, Observer, no_load
from mpm_verify.solver.plugins import MATERIALS, create, parameters_of, split
from mpm_verify.solver.plugins import canonical as canonical_name
from mpm_verify.solver.state import Floats

Pair = tuple[str, str]  # quantity and norm
Errors = dict[str, dict[str, float]]
CONSTANTS = ("E", "nu", "rho0")  # parameters of a problem that are its material's too
UNITS = {
    "E": "Pa", "rho0": "kg/m3", "g": "m/s2", "H": "m", "B": "m", "R": "m", "T": "s", "q": "Pa", "speed": "m/s",
    "theta": "degrees", "x": "m", "y": "m", "syy": "Pa",
}  # fmt: skip
AT_REST = "at_rest"  # value of a run: 1, or 0 of one that ended before
FIGURE, EXACT = "curves/", "exact"  # array curves/FIGURE/CURVE (2,n), x and y; EXACT is the known answer


@dataclass(frozen=True)
class Measured:
    """Outcome of a run.

    Parameters
    ----------
    errors
        By quantity and norm: those that the problem says in `measures`.
    values
        Other numbers by name; `held` holds some of them against what is known.
    curves
        Curves by figure and name, each two rows (2,n): x and y. The curve named exact is the known answer.
    scale, floor
        By quantity: its size, and its round-off floor.
    """

    errors: Errors = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    curves: Mapping[tuple[str, str], Floats] = field(default_factory=dict)
    scale: dict[str, float] = field(default_factory=dict)
    floor: dict[str, float] = field(default_factory=dict)


class Watch(Observer):
    """Observer of a run that measures it; `done` ends the run before its last step."""

    done = False

    def found(self, model: Model) -> Measured:
        """Numbers of the run, after its last step."""
        raise NotImplementedError


@dataclass(frozen=True)
class Setup:
    """Problem on one grid: the model at t = 0, the most steps, what measures it, and its body force."""

    model: Model
    steps: int
    watch: Watch
    load: Load = no_load


@dataclass(frozen=True)
class Held:
    """Number of a run, `values[name]`, and what it is held against.

    Parameters
    ----------
    name
        Key of Measured.values.
    expected, way, within, source
        See cases/harness/checks.py: Check.
    of
        ``limit``: the Richardson limit of the finest three levels, or the finest value where they do not approach one;
        with fewer levels nothing is judged; ``finest``: the value on the finest cells; ``each``: that of every run.
    least
        Cells from which on the values come to their limit by one order: coarser grids are left out of it, and with
        fewer than three of the others nothing is held. 0 where coarse grids are as near as fine ones.
    unjudged
        Why the number is shown and not judged, such as parameters that its band was not measured at; usual is nothing.
    limit
        What the Richardson limit is held within too, beside ``each``, where there are three levels; 0: it is not.
    rests
        Whether it is that of a body at rest, so that nothing is judged of a run whose value AT_REST is 0.
    unit
        Unit of the number and of what it is held against; empty of a ratio or a count.
    """

    name: str
    expected: float
    way: Way
    source: str
    within: float = 0.0
    of: Literal["limit", "finest", "each"] = "limit"
    least: int = 0
    unjudged: Unjudged = ""
    rests: bool = False
    limit: float = 0.0
    unit: str = ""


@dataclass(frozen=True)
class Drawn:
    """Figure: what is on its axes, with units, and what it shows; curves are lines, or marks of single values."""

    x: str
    y: str
    caption: str
    lines: bool = False


@dataclass(frozen=True)
class Problem:
    """Problem with a known answer; its fields are its parameters, those of CONSTANTS are its material's too.

    Attributes
    ----------
    source
        Where it is published, with a DOI.
    material
        Usual constitutive model, with parameters that no field has.
    cells, quick, ppc
        Usual numbers of cells, those of a quick study, and particles per cell.
    methods, smoothings
        Usual methods and smoothings.
    figures
        Figures by the names that Measured.curves has.
    tied
        Whether there is no time step that could be halved.
    units
        Units of its parameters, and of known columns of the end, by name; of a ratio or a count none.
    """

    source: ClassVar[str] = ""
    material: ClassVar[str]
    cells: ClassVar[tuple[int, ...]] = (8, 16, 32, 64)
    quick: ClassVar[tuple[int, ...]] = (8, 12, 16, 24)
    ppc: ClassVar[int] = 4
    methods: ClassVar[tuple[str, ...]] = ("cpdi",)
    smoothings: ClassVar[tuple[str, ...]] = ("none",)
    figures: ClassVar[Mapping[str, Drawn]] = {}
    tied: ClassVar[bool] = False
    units: ClassVar[Mapping[str, str]] = UNITS

    @property
    def constants(self) -> dict[str, float]:
        """Parameters that are those of its material."""
        return {item.name: getattr(self, item.name) for item in fields(self) if item.name in CONSTANTS}

    def band(self, run: Run, *free: str) -> Unjudged:
        """Mark of a number with a band measured at the usual parameters, where others than `free` are not these."""
        same = all(getattr(self, one.name) == one.default for one in fields(self) if one.name not in free)
        known = create(MATERIALS, run.material) == create(MATERIALS, completed(self.material, self.constants))
        return "" if same and known else "not_usual"

    def check(self, run: Run) -> None:
        """Raise ValueError with one line, which says what to type instead, for a run that cannot be."""

    def setup(self, run: Run) -> Setup:
        """Problem on the grid of a run; spoilt where `run.control`."""
        raise NotImplementedError

    def measures(self, run: Run) -> tuple[Pair, ...]:
        """Quantity and norm of each error; none of a problem that is not judged by an order."""
        return ()

    def expectation(self, run: Run, quantity: str, norm: str) -> Expectation | None:
        """Expectation of an error on refinement; None where it is only shown."""
        return None

    def held(self, run: Run) -> tuple[Held, ...]:
        """Numbers that are held against what is known, of a refinement that `run` belongs to."""
        return ()

    def answers(self, run: Run, X: Floats) -> dict[str, Floats]:
        """Known columns (n,) of the end by name, at reference positions X (n,2), for other solvers."""
        return {}

    def particles(self, run: Run) -> int:
        """Number of particles, about."""
        return run.cells * run.ppc

    def updates(self, run: Run) -> float:
        """Particle updates, about."""
        return 40.0 * run.cells * self.particles(run)


def completed(material: str, constants: Mapping[str, float]) -> str:
    """Material with the constants of the problem, but for those that it is given itself."""
    name, rest = split(material)
    given = [item.partition("=")[0] for item in rest.split(",")]
    takes = parameters_of(create(MATERIALS, material))
    more = [f"{key}={value!r}" for key, value in constants.items() if key in takes and key not in given]
    return canonical_name(MATERIALS, ":".join(filter(None, [name, ",".join(filter(None, [rest, *more]))])))
