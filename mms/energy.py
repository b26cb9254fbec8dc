"""What a law must offer so that a solution can be manufactured for it; imports nothing heavy."""

from typing import Any, Protocol

from mpm_verify.solver.plugins import MATERIALS, available, camel, load


class Energy(Protocol):
    """A law that derives from a stored energy."""

    def energy(self, F: Any, log: Any) -> Any:
        """Stored energy per initial volume of a 3 x 3 deformation gradient."""


def check_energy(material: Any) -> None:
    """Raise ValueError for a law without an energy, such as those in rate form; it names the laws that have one."""
    if hasattr(material, "energy"):
        return
    kind = type(material).__name__
    name = next((name for name in available(MATERIALS) if camel(name) == kind), kind)
    others = ", ".join(name for name in available(MATERIALS) if hasattr(load(MATERIALS, name), "energy"))
    raise ValueError(
        f"{name} has no energy, so no manufactured solution can be derived for it; the material must be one of {others}"
    )
