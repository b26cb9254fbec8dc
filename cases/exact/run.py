"""Run and Result of the exactness battery: a method with a material."""

from dataclasses import dataclass
from typing import ClassVar

from mpm_verify.cases.harness.study import ResultRecord, RunRecord, axis
from mpm_verify.mms.constitutive.tested import Tested
from mpm_verify.solver.plugins import MATERIALS, METHODS, available

AXES = {"method": tuple(available(METHODS)), "material": tuple(available(MATERIALS))}
QUICK = {"method": ("cpdi",), "material": ("neo_hookean", "mohr_coulomb")}


@dataclass(frozen=True)
class Run(RunRecord):
    """One battery: every transfer and stress update of a method with a material."""

    method: str = axis("cpdi", "Basis of the method.", METHODS)
    material: str = axis("neo_hookean", "Constitutive model.", MATERIALS)
    case: ClassVar[str] = "exact"

    @property
    def digest(self) -> str:
        """Name of the Result, 16 hex digits: of all transfers and smoothings too."""
        from mpm_verify.cases.harness.identity import identity
        from mpm_verify.solver.plugins import SMOOTHINGS, TRANSFERS

        used = (identity(package, name) for package in (TRANSFERS, SMOOTHINGS) for name in available(package))
        return self.named(" ".join(used))

    @property
    def cost(self) -> float:
        """Particle updates that take as long: a third of a second."""
        return 5e5

    @property
    def particles(self) -> int:
        """Number of particles of its bodies."""
        return 80

    @property
    def nodes(self) -> int:
        """Number of nodes of its grids."""
        return 210

    def __str__(self) -> str:
        return f"{self.method}, {self.material}"


@dataclass(frozen=True, kw_only=True)
class Result(ResultRecord[Run]):
    """Outcome of one battery: its tests."""

    run: Run
    tested: tuple[Tested, ...] = ()
