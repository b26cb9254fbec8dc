"""Defects of constitutive models, of what surrounds a step of them, and of walls that push, planted one at a time."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mpm_verify.solver.material import hencky
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.pushed import PushedWalls
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.reaction import Reaction
from mpm_verify.solver.smoothing._base import Smoothing

Patch = pytest.MonkeyPatch
Plant = Callable[[Patch], None]


def around(kind: Any, name: str, change: Callable[..., None]) -> Plant:
    """Method of a class, and then a change; it gets the object and the arguments of the method."""

    def plant(patch: Patch) -> None:
        original = getattr(kind, name)

        def method(self: Any, *given: Any) -> None:
            original(self, *given)
            change(self, *given)

        patch.setattr(kind, name, method)

    return plant


def parameters(kind: Any, **factors: float) -> Plant:
    """Constants of a material with other parameters."""

    def plant(patch: Patch) -> None:
        original = kind.constants

        def constants(self: Any) -> Any:
            return original(replace(self, **{name: factor * getattr(self, name) for name, factor in factors.items()}))

        patch.setattr(kind, "constants", constants)

    return plant


def derived(kind: Any, name: str, factor: float) -> Plant:
    """Property that a class makes of its parameters, by a factor."""

    def plant(patch: Patch) -> None:
        original = getattr(kind, name).fget
        patch.setattr(kind, name, property(lambda self: factor * original(self)))

    return plant


def no_number(patch: Patch) -> None:
    """Hencky solid without a stress where its stretches are the same: 0/0."""
    original = hencky.stress

    def stress(F: Any, sigma: Any, lam: float, mu: float) -> None:
        original(F, sigma, lam, mu)
        sigma[(F[:, 0, 0] == F[:, 1, 1]) & (F[:, 0, 1] == -F[:, 1, 0])] = np.nan

    patch.setattr(hencky, "stress", stress)


def closed_late(patch: Patch) -> None:
    """Stress 1 % high in the step that closes a void."""
    original = RateMaterial.update

    def update(self: Any, particles: Any, *given: Any) -> None:
        column = self.memory.index("void")
        before = particles.history[:, column].copy()
        original(self, particles, *given)
        particles.sigma[(before > 0) & (particles.history[:, column] == 0)] *= 1.01

    patch.setattr(RateMaterial, "update", update)


def half_in_memory(patch: Patch) -> None:
    """Half of the plastic shear remembered, by the kernel."""
    original = MohrCoulomb.respond

    def respond(constants: Any, sigma: Any, de: Any, history: Any) -> None:
        before = history[::3].copy()
        original(constants, sigma, de, history)
        history[::3] -= 0.5 * (history[::3] - before)

    patch.setattr(MohrCoulomb, "respond", staticmethod(respond))


def more_work(material: Any, particles: Any, *given: Any) -> None:
    particles.work *= 1.001


def at_rest(walls: PushedWalls, *given: Any) -> None:
    walls.rate[:] = 0.0


def too_little(reaction: Reaction, *given: Any) -> None:
    reaction.force *= 0.999


def rounded_to_failure(patch: Patch) -> None:
    """States on the yield surface whose slip is rounded below zero fail."""
    original = Ubcsand.respond

    def respond(constants: Any, sigma: Any, de: Any, history: Any) -> None:
        original(constants, sigma, de, history)
        if not de.any():
            history[::700] = constants[7]

    patch.setattr(Ubcsand, "respond", staticmethod(respond))


MATERIAL: dict[str, tuple[Plant, tuple[str, ...], str]] = {
    "no stress of equal stretches": (no_number, ("stress_even",), "hencky"),
    "void closes with more": (closed_late, ("void_contact",), "mohr_coulomb"),
    "void with cohesion closes with more": (closed_late, ("void_contact",), "mohr_coulomb:c=1000"),
    "flow 1 % off": (parameters(MohrCoulomb, psi=1.01), ("return_mapping",), "mohr_coulomb"),
    "half of gamma_p in the kernel": (half_in_memory, ("return_memory",), "mohr_coulomb"),
    "bulk modulus 0.1 % high": (parameters(Ubcsand, KBe=1.001), ("secant",), "ubcsand"),
    "hyperbola 0.1 % off": (parameters(Ubcsand, Rf=0.999), ("hardening",), "ubcsand"),
    "constant volume 0.1 % off": (parameters(Ubcsand, phi_pt=0.999), ("flow_rule",), "ubcsand"),
    "property eta_f 0.1 % low": (derived(Ubcsand, "eta_f", 0.999), ("hardening", "flow_rule"), "ubcsand"),
    "property eta_cv 0.1 % low": (derived(Ubcsand, "eta_cv", 0.999), ("flow_rule",), "ubcsand"),
    "property shift 0.1 % low": (derived(Ubcsand, "shift", 0.999), ("hardening", "flow_rule"), "ubcsand:c=1000"),
    "neutral loading fails": (rounded_to_failure, ("neutral",), "ubcsand"),
    "work 0.1 % high": (around(RateMaterial, "update", more_work), ("work",), "hypoelastic"),
    "smoothing takes all": (lambda p: p.setattr(Smoothing, "check", lambda self, material: None),
                            ("smoothing_refused",), "neo_hookean"),
    "reaction 0.1 % low": (around(Reaction, "after_motion", too_little), ("reaction",), "neo_hookean"),
    "pushed without acceleration": (around(PushedWalls, "move", at_rest), ("pushed",), "neo_hookean"),
}  # fmt: skip
