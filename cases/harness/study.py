"""What is run and what is expected of it: the records that every case has, written by the store and read by reports.

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


def axis(default: Any, text: str, plugins: str = "", choices: tuple[str, ...] = ()) -> Any:
    """A field of a Run: its default, what it is (help of its option), and what completes it.

    That is the package whose plug-ins it names, or the words that it may be.
    """
    return field(default=default, metadata={"help": text, "plugins": plugins, "choices": choices})


@dataclass(frozen=True)
class RunRecord:
    """One point of a study. A subclass says in `cost` what it takes and in `particles` how many there are."""

    case: ClassVar[str]

    @property
    def digest(self) -> str:
        """Name of the Result: hash of the parameters and of all that computes the run, 16 hex digits."""
        return self.named()

    def named(self, more: str = "") -> str:
        """The digest; `more` is what else a run depends on."""
        packages = {item.name: item.metadata["plugins"] for item in fields(self) if item.metadata.get("plugins")}
        return digest(self, packages, more)

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
    """What one Run gave, in the units of the problem.

    `errors[quantity][norm]` are judged by the order rule, `values` are other numbers of the run. `scale` is the rms of
    each exact quantity, `floor` its round-off floor. `cpu_s` is the processor time of the steps, all threads, with body
    force and norms; `crossings` are the faces of cells that particles passed, `gap` is how far the corners of domains
    are apart in spacings of particles (None where domains have none); `parameters` are those of the plug-ins.
    Raises ValueError for errors of a finished run that are negative or not finite.
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
    crossings: int = 0
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
    def updates(self) -> int:
        """Particle updates: particles times steps."""
        return self.particles * self.steps


@dataclass(frozen=True)
class QuantityPlan(Generic[R]):
    """A quantity that the study judges, or only shows, with what is expected of it; declared before the study runs.

    `run` is any run of the refinement that it is measured on.
    """

    run: R
    quantity: str
    norm: str
    judged: bool
    expectation: Expectation | None
    multiple: int = 1  # of cells that fill the body of the solution

    @property
    def head(self) -> Head:
        """What the refinement is of."""
        return head(self.run)


@dataclass(frozen=True)
class Study(Generic[R]):
    """The runs of a case and what is declared of them before they run. `command` repeats it.

    `axes` are the fields that it varies, `words` what it is for, `finish` how many runs must come to their end, of a
    case that counts them. `made` names what it was built from, see cases/harness/reuse.py.
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
    """All that names the refinement which a run belongs to."""
    return tuple((item.name, getattr(run, item.name)) for item in fields(run) if item.name not in REFINED)


def without(name: str, of: Head) -> Head:
    """A head without one of its fields: refinements that differ in that field alone have the same."""
    return tuple((key, value) for key, value in of if key != name)


def parameters(kind: str, plugin: Any) -> dict[str, float | str]:
    """Every parameter of a plug-in, the defaults too, each named after its kind."""
    return {f"{kind} {key}": getattr(plugin, item.name) for key, item in parameters_of(plugin).items()}
