"""Records that every case has, what is run and what is expected of it: written by the store and read by reports.

A case adds its own fields: its Run is a frozen dataclass below RunRecord whose fields are the axes that a study can
have, its Result one below ResultRecord (see cases/harness/contract.py).
"""

from dataclasses import dataclass, field, fields
from math import inf
from typing import Any, ClassVar, Generic, Literal, TypeVar

from mpm_verify.cases.harness.identity import digest
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.failure import Failure
from mpm_verify.solver.plugins import parameters_of

FORMAT = 2  # of study.json and of every Result; a reader refuses another number
REFINED = ("cells", "courant", "offset")  # fields in which the runs of one refinement differ
Status = Literal["finished", "failed"]
Arrays = dict[str, Any]  # arrays of a run by name
Head = tuple[tuple[str, Any], ...]  # names and values of all other fields of a Run: what a refinement is of


def axis(
    default: Any, text: str, plugins: str = "", choices: tuple[str, ...] = (), whole: bool = False, named: bool = True
) -> Any:
    """Declare a field of a Run, which can be an axis of a study.

    Parameters
    ----------
    default
        Usual value.
    text
        What the field is: the help of its option.
    plugins
        Package whose plug-ins the field names; empty if it names none.
    choices
        Words that the field may be, which complete its option.
    whole
        Whether commas do not separate values of it on the command line.
    named
        Whether it is part of the name of a Result.

    Returns
    -------
    dataclasses.Field
        Default and metadata, from which options, TOML keys and documentation are made.
    """
    return field(
        default=default, metadata={"help": text, "plugins": plugins, "choices": choices, "whole": whole, "named": named}
    )


@dataclass(frozen=True)
class RunRecord:
    """One point of a study; the fields of a subclass are the axes that a study of its case can have.

    A subclass says in `cost` what a run takes and in `particles` and `nodes` how large it is, and raises ValueError
    with one line, which says what to type instead, for values that no run has.
    """

    case: ClassVar[str]
    given: ClassVar[bool] = False  # whether its numbers were given: no command runs another

    @property
    def computed_by(self) -> str:
        """Module whose `execute` runs it, and whose import closure is part of its name."""
        return f"mpm_verify.cases.{self.case}.execute"

    @property
    def plugins(self) -> dict[str, str]:
        """Packages of the fields that name a plug-in which computes."""
        return {item.name: item.metadata["plugins"] for item in fields(self) if item.metadata.get("plugins")}

    @property
    def again(self) -> bool:
        """Whether a stored Result that failed is run again: what failed may have been mended outside."""
        return False

    @property
    def tied(self) -> bool:
        """Whether there is no time step that could be halved apart from the cells."""
        return False

    @property
    def damping_outside(self) -> float:
        """Fraction of the force that damping takes, though the problem has no such force: an error of its own."""
        return 0.0

    @property
    def stiffness(self) -> float:
        """Ratio of bulk to shear modulus, where the volume of each particle is held; 0: not known, or smoothed."""
        return 0.0

    @property
    def strays(self) -> bool:
        """Whether the material is another solid than the one that the problem was made for."""
        return False

    @property
    def edge_noise(self) -> bool:
        """Whether an edge is prescribed, and nothing damps the noise of particles that the grid does not see."""
        return False

    @property
    def digest(self) -> str:
        """Name of the Result: hash of the parameters and of all that computes the run, 16 hex digits."""
        return self.named()

    def named(self, more: str = "") -> str:
        """Digest of the run; `more` is what else it depends on."""
        return digest(self, self.plugins, more)

    @property
    def cost(self) -> float:
        """Particle updates, up to a factor: what a run takes grows with it."""
        return 1.0

    @property
    def updates(self) -> float:
        """Particle updates, as near as they are known before the run."""
        return self.cost

    @property
    def particles(self) -> int:
        """Number of particles, as near as it is known before the run."""
        return 1

    @property
    def nodes(self) -> int:
        """Number of grid nodes, as near as it is known before the run."""
        return 1


R = TypeVar("R", bound=RunRecord)


@dataclass(frozen=True, kw_only=True)
class ResultRecord(Generic[R]):
    """Outcome of one Run, in the units of the problem.

    Parameters
    ----------
    run, digest
        The Run, and its name in the store.
    status
        `finished`, or `failed` with a `failure`.
    steps, particles, dt
        Time steps taken, number of particles, length of a step.
    wall_s, cpu_s, peak_memory_mb
        Wall time and processor time of the steps in s (all threads, with body force and norms), peak memory in MB.
    errors
        `errors[quantity][norm]`, which the order rule judges; empty of a failed run.
    values
        Other numbers of the run by name.
    scale, floor
        By quantity: rms of the exact quantity, and its round-off floor.
    crossings
        Number of cell faces that particles crossed, summed over particles and steps; None where nobody counted.
    gap
        Distance of corners of domains that should coincide, in particle spacings; None where domains have no corners.
    failure
        What ended a failed run.
    environment, parameters
        Versions and machine; parameters of the plug-ins.

    Raises
    ------
    ValueError
        For errors of a finished run that are negative or not finite.
    """

    run: R
    digest: str
    status: Status
    steps: int = 0
    particles: int = 0
    dt: float = 0.0
    wall_s: float = 0.0
    cpu_s: float = 0.0
    peak_memory_mb: float = 0.0
    errors: dict[str, dict[str, float]] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    scale: dict[str, float] = field(default_factory=dict)
    floor: dict[str, float] = field(default_factory=dict)
    crossings: int | None = 0
    gap: float | None = None
    failure: Failure | None = None
    environment: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, float | str] = field(default_factory=dict)
    format: int = FORMAT

    def __post_init__(self) -> None:
        values = [value for norms in self.errors.values() for value in norms.values()]
        if self.status == "finished" and not all(0 <= value < inf for value in values):
            raise ValueError("a finished run has errors that are finite and not negative")

    @property
    def strain(self) -> float:
        """Largest component of F - I where the material is one of small strains and these are not; else 0."""
        return 0.0

    @property
    def still(self) -> bool:
        """Whether nothing moves in an answer of somebody else's solver."""
        return False

    @property
    def updates(self) -> int:
        """Particle updates: particles times steps."""
        return self.particles * self.steps


@dataclass(frozen=True)
class QuantityPlan(Generic[R]):
    """Plan of a quantity, made before the study runs: what is expected of it, and whether it is judged or only shown.

    Parameters
    ----------
    run
        Any run of the refinement that the quantity is measured on.
    quantity, norm
        Keys of `ResultRecord.errors`.
    judged
        Whether the verdict counts; a quantity that is only shown decides nothing.
    refutes
        Whether a FAIL of it counts, while its other outcomes are only shown.
    expectation
        What is registered; None where nothing is.
    multiple
        Number whose multiples are the cells that fill the body of the solution.
    """

    run: R
    quantity: str
    norm: str
    judged: bool
    expectation: Expectation | None
    multiple: int = 1
    refutes: bool = False

    @property
    def head(self) -> Head:
        """All fields that the runs of the refinement share."""
        return head(self.run)


@dataclass(frozen=True)
class Study(Generic[R]):
    """Runs of a case, and the plans of their quantities, made before anything runs.

    Parameters
    ----------
    name, title
        Name of its folder, and title of its page.
    command
        Command that repeats it.
    runs
        Each run once.
    plans
        Quantities that are judged or shown, one for each refinement, quantity and norm.
    axes
        Fields of the Run that the study varies.
    words
        Sentences that say what it is for.
    finish
        Number of runs that must come to their end, of a case that counts them.
    case
        Name of the case.
    made
        Name of what it was built from, see cases/harness/reuse.py.
    format
        Number of the stored format.
    """

    name: str
    title: str
    command: str
    runs: tuple[R, ...]
    plans: tuple[QuantityPlan[R], ...] = ()
    axes: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    finish: int = 0
    case: str = ""
    made: str = ""
    format: int = FORMAT


def head(run: RunRecord) -> Head:
    """Name the refinement that a run belongs to.

    Parameters
    ----------
    run
        Run of any case.

    Returns
    -------
    tuple of (str, value)
        Names and values of all fields but those that a refinement varies (REFINED) and those that do not tell runs
        apart (compare=False).
    """
    told = (item.name for item in fields(run) if item.compare and item.name not in REFINED)
    return tuple((name, getattr(run, name)) for name in told)


def without(name: str, of: Head) -> Head:
    """Head without one of its fields: refinements that differ in that field alone have the same."""
    return tuple((key, value) for key, value in of if key != name)


def parameters(kind: str, plugin: Any) -> dict[str, float | str]:
    """Parameters of a plug-in, the defaults too, each named after its kind."""
    return {f"{kind} {key}": getattr(plugin, item.name) for key, item in parameters_of(plugin).items()}
