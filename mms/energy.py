"""Energy that a material must have so that a solution can be manufactured for it; imports nothing heavy."""

from typing import Any, Protocol

from mpm_verify.solver.plugins import MATERIALS, available, load


class Energy(Protocol):
    """Constitutive model that derives from a stored energy."""

    def energy(self, F: Any, log: Any) -> Any:
        """Stored energy per initial volume of a 3 x 3 deformation gradient."""


def check_energy(material: Any) -> None:
    """Raise ValueError for a material without an energy, such as those in rate form; it names those that have one."""
    if material.energy is not None:
        return
    others = ", ".join(name for name in available(MATERIALS) if load(MATERIALS, name).energy is not None)
    raise ValueError(
        f"{material.name or type(material).__name__} has no energy, so no manufactured solution can be derived for it; "
        f"the material must be one of {others}"
    )
