"""Defects of walls with friction, planted one at a time around the kernel of solver/friction.py."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from mpm_verify.solver import friction
from mpm_verify.solver.boundary import Walls

Patch = pytest.MonkeyPatch
NAMES = ("nodes", "normal", "mu", "mass", "momentum_force", "always", "wall", "wall_rate", "held", "held_in_strain",
         "value", "rate", "dt", "cutoff")  # fmt: skip
Change = Callable[[dict[str, Any]], None]


def around(before: Change | None = None, after: Change | None = None) -> Callable[[Patch], None]:
    """Kernel with what it is given changed before it, or what it wrote changed after it."""

    def plant(patch: Patch) -> None:
        original = friction.touch

        def touch(*given: Any) -> float:
            named = dict(zip(NAMES, given, strict=True))
            if before:
                before(named)
            taken: float = original(*(named[name] for name in NAMES))
            if after:
                after(named)
            return taken

        patch.setattr(friction, "touch", touch)

    return plant


def scaled(factor: float) -> Change:
    """Friction coefficient times a factor."""

    def change(named: dict[str, Any]) -> None:
        named["mu"] = factor * named["mu"]

    return change


def of_velocity_before(named: dict[str, Any]) -> None:
    """Contact and impulses by the velocity before the step: forces are left out."""
    named["momentum_force"] = named["momentum_force"].copy()
    named["momentum_force"][:, 2:] = 0.0


def late() -> Change:
    """Contact and impulses by momentum and force of the step before."""
    kept: list[Any] = []

    def change(named: dict[str, Any]) -> None:
        now = named["momentum_force"].copy()
        named["momentum_force"] = kept[-1] if kept and kept[-1].shape == now.shape else now
        kept[:] = [now]

    return change


def held_in_tension(named: dict[str, Any]) -> None:
    """Normal velocity of a node with mass is the wall's, whatever its force."""
    there = (named["normal"] != 0) & (named["mass"] > named["cutoff"])[:, None]
    named["held"][there] = True
    named["value"][there] = 0.0


def sticks(named: dict[str, Any]) -> None:
    """What slips is strained as if it were stuck."""
    named["held_in_strain"][:] = named["held"]


def free(named: dict[str, Any]) -> Any:
    """Velocities of the nodes at the end of the step without walls (n,2)."""
    m = named["mass"][:, None]
    new = named["momentum_force"][:, :2] + named["dt"] * named["momentum_force"][:, 2:]
    return new / np.where(m > named["cutoff"], m, 1.0)


def one_way(named: dict[str, Any]) -> None:
    """Friction towards positive axes alone: what slips the other way does so without it."""
    slips = named["held"] & ~named["held_in_strain"] & (named["value"] > 0)
    named["value"][slips] = free(named)[slips]


def pushes(named: dict[str, Any]) -> None:
    """Friction along the slip."""
    slips = named["held"] & ~named["held_in_strain"]
    named["value"][slips] = (2.0 * free(named) - named["value"])[slips]


def other_coefficient(named: dict[str, Any]) -> None:
    """Coefficients of two walls that meet are swapped."""
    named["mu"] = np.where(named["normal"] != 0, np.where(named["mu"] == 0.3, 0.5, 0.3), 0.0)


def not_handed_on(patch: Patch) -> None:
    """Reaction kept from the particles: their acceleration is that of the wall."""
    around(after=lambda named: named["rate"].fill(0.0))(patch)


def held_at_first(patch: Patch) -> None:
    """All nodes of a wall touch before the first step."""
    original = friction.FrictionalWalls.__post_init__

    def begin(self: friction.FrictionalWalls) -> None:
        original(self)
        self.held_in_strain = self.held | (self.normal != 0)

    patch.setattr(friction.FrictionalWalls, "__post_init__", begin)


def damped_after(patch: Patch) -> None:
    """Contact is decided before damping alone."""
    patch.setattr(friction.FrictionalWalls, "damp", Walls.damp)


FRICTION = {
    "friction 1.1": (around(scaled(1.1)), ("friction_slide", "friction_course", "friction_momentum", "friction_step")),
    "friction 0.98": (around(scaled(0.98)), ("friction_slide", "friction_stick", "friction_step")),
    "friction pushes": (around(after=pushes), ("friction_slide", "friction_momentum", "friction_step")),
    "contact by the velocity before": (around(of_velocity_before), ("friction_slide", "friction_step")),
    "friction one step late": (around(late()), ("friction_slide", "friction_leave")),
    "held in tension": (around(after=held_in_tension), ("friction_leave", "friction_step")),
    "slip strained as stuck": (around(after=sticks), ("friction_step",)),
    "friction one way": (around(after=one_way), ("friction_mirror", "friction_slide", "friction_budget")),
    "coefficients swapped": (around(other_coefficient), ("friction_step",)),
    "touches before the first step": (held_at_first, ("friction_leave", "friction_step")),
    "damping after contact": (damped_after, ("friction_damped",)),
    "reaction of friction kept": (not_handed_on, ("friction_momentum", "friction_step")),
}
