"""Run and Result of the exactness battery: a method with a material."""

from dataclasses import dataclass
from typing import ClassVar

from mpm_verify.cases.exact.others.names import TESTS
from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.mms.constitutive.tested import Tested
from mpm_verify.solver.plugins import MATERIALS, METHODS, available, meant

AXES = {"method": tuple(available(METHODS)), "material": tuple(available(MATERIALS))}
OTHERS = {"material": ("neo_hookean",), "test": tuple(TESTS)}  # of a solver of somebody else
QUICK = {"method": ("cpdi",), "material": ("neo_hookean", "mohr_coulomb")}


@dataclass(frozen=True)
class Run(RunRecord):
    """One battery: every transfer and stress update of a method with a material; or one test of an own solver.

    Raises ValueError with one line for what no run has.
    """

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    material: str = axis("neo_hookean", "Constitutive model.", MATERIALS)
    test: str = axis("", "Tests of a solver of your own; usual are all.", choices=tuple(TESTS))
    solver: str = axis(
        "", "Solver of your own: a command such as './mine {case} {out}', see docs/own-solver.md.", whole=True
    )
    solver_version: str = axis("", "Version of that solver; usual is a hash of the files that its command names.")
    columns: str = axis("", "Map of the columns that it writes, a TOML file; see docs/own-solver.md.", whole=True)
    precision: str = axis("double", "Precision that it computes with: double, single.", choices=("double", "single"))
    flip: bool = axis(True, "It keeps the velocity of a particle that no force acts on; no of PIC, APIC and blends.")
    time_limit: float = axis(60.0, "Seconds that a test of a solver of your own may take.", named=False)
    memory_limit: float = axis(0.0, "Address space that it may have, MB; 0: any.", named=False)
    case: ClassVar[str] = "exact"

    def __post_init__(self) -> None:
        if self.test and self.test not in TESTS:
            raise ValueError(f"no test {self.test!r}{meant(self.test, TESTS)}; choose from {', '.join(TESTS)}")
        if self.precision not in ("double", "single"):
            raise ValueError(f"precision = {self.precision!r} must be double or single")
        if not (self.time_limit > 0 and self.memory_limit >= 0):
            raise ValueError("time_limit must be above 0, and memory_limit 0 or more")

    @property
    def computed_by(self) -> str:
        """Module that runs it: with the reference solver, or with one of somebody else."""
        return f"mpm_verify.cases.exact.{'others.' if self.solver else ''}execute"

    @property
    def plugins(self) -> dict[str, str]:
        """Packages of the fields that name a plug-in which computes."""
        known = super().plugins
        return {"material": known["material"]} if self.solver else known

    @property
    def again(self) -> bool:
        """Whether a failed Result is run again: somebody may have mended the solver."""
        return bool(self.solver)

    @property
    def digest(self) -> str:
        """Name of the Result, 16 hex digits: of the reference solver of all transfers, smoothings and rates too."""
        if self.solver:
            return self.named()
        from mpm_verify.cases.harness.identity import identity
        from mpm_verify.solver.plugins import RATES, SMOOTHINGS, TRANSFERS

        used = (identity(package, name) for package in (TRANSFERS, SMOOTHINGS, RATES) for name in available(package))
        return self.named(" ".join(used))

    @property
    def cost(self) -> float:
        """Particle updates that take as long: a third of a second; of an own solver a start, and perhaps a compiler."""
        return 4e6 if self.solver else 5e5

    @property
    def particles(self) -> int:
        """Number of particles of its bodies."""
        return 80

    @property
    def nodes(self) -> int:
        """Number of nodes of its grids."""
        return 210

    def __str__(self) -> str:
        if self.solver:
            return f"{self.method}, {self.test}" + f", {self.material}" * (self.material != type(self).material)
        return f"{self.method}, {self.material}"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one battery: its tests."""

    run: Run
    tested: tuple[Tested, ...] = ()
    log: tuple[str, ...] = ()  # last lines that a solver of somebody else printed
    exit_code: int | None = None  # of that solver
    told: str = ""  # version that its result.json states
