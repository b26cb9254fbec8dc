"""References: runs of the solver here whose frames an answer of somebody else's solver is held against."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from mpm_verify.cases.mms.execute import setup
from mpm_verify.cases.mms.external.execute import FRAMES
from mpm_verify.cases.mms.run import Run
from mpm_verify.cases.solvers.answer import Frame
from mpm_verify.cases.solvers.asking import Answer
from mpm_verify.cases.solvers.levels import Levels
from mpm_verify.mms.discretisation import output_steps, time_steps, width
from mpm_verify.solver.failure import RunFailed
from mpm_verify.solver.layout import Layout
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.plugins import SOLUTIONS, create
from mpm_verify.solver.state import Floats
from mpm_verify.solver.step import advance, check_time_step

METHODS = ("mpm", "gimp", "cpgimp", "cpdi", "bspline2", "bspline3", "tlmpm")
STRESSES = ("usl", "musl", "usf")
TRANSFERS = ("flip", "pic", "apic")


@dataclass(frozen=True)
class Scheme:
    """Scheme of a reference: its basis, when it updates stress, and how velocities are transferred."""

    method: str
    stress: str = "usl"
    transfer: str = "flip"


def schemes(
    methods: Sequence[str] = METHODS, stresses: Sequence[str] = STRESSES, transfers: Sequence[str] = TRANSFERS
) -> tuple[Scheme, ...]:
    """Every scheme of these methods, stress updates and transfers."""
    return tuple(Scheme(*words) for words in product(methods, stresses, transfers))


def reference(run: Run, scheme: Scheme) -> Run:
    """Run of the reference of a scheme, in the case of a run of another solver."""
    return replace(
        run,
        method=scheme.method,
        stress=scheme.stress,
        transfer=scheme.transfer,
        solver="",
        solver_version="",
        order=0.0,
    )


@dataclass
class Kept(Observer):
    """Observer that keeps the frames of some steps, particles in the order of the case."""

    steps: frozenset[int]
    frames: dict[int, Frame] = field(default_factory=dict)

    def after_step(self, model: Model) -> None:
        """Keep x, v, F and sigma, if this step is one of them."""
        if model.steps in self.steps:
            self.frames[model.steps] = Frame(dict(self.fields(model)))

    @staticmethod
    def fields(model: Model) -> Iterator[tuple[str, Floats]]:
        """Fields of the particles, (P,2) and (P,4), by name."""
        for name in ("x", "v", "F", "sigma"):
            values = model.particles.in_initial_order(name)
            yield name, values.reshape(len(values), -1)


def laid_out(run: Run) -> tuple[Layout, float]:
    """Layout of the particles of a run, in the order of the case, and the length of its time steps."""
    solution = create(SOLUTIONS, run.solution)
    dx = width(solution) / run.cells
    layout: Layout = solution.layout(dx, run.ppc)
    return layout, time_steps(solution, dx, run.courant)[1]


def run_frames(run: Run) -> Answer:
    """Frames of a run of the reference at the output steps of the case, with the levels of its fields.

    Its answer has no frames, and says why, where the run cannot go on.
    """
    kept = Kept(frozenset())
    try:
        model, load, steps = setup(run)
        kept = Kept(frozenset(output_steps(steps, FRAMES)))
        model.watch(kept)
        if not run.force:
            check_time_step(model)
        for _ in range(steps):
            advance(model, load)
    except RunFailed as ended:
        return Answer({}, Levels(), ended.failure)
    return Answer(kept.frames, Levels(load.lag / model.dt, load.F_lag / model.dt))
