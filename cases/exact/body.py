"""Small bodies that exact tests are made on: a few cells, several blocks of particles and two slabs, generic states.

Nothing here is at a special position: the offset leaves no particle on a face or at the middle of a cell, F has shear
and rotation and det F is not 1, and rows of random numbers come from one seed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np

from mpm_verify.mms.constitutive.driver import random
from mpm_verify.solver.boundary import Kind, Walls, moving
from mpm_verify.solver.friction import Sides as Four
from mpm_verify.solver.friction import frictional
from mpm_verify.solver.layout import Layout, rectangle
from mpm_verify.solver.plugins import MATERIALS, METHODS, TRANSFERS, available, create
from mpm_verify.solver.state import Floats, Grid, Ints, Particles
from mpm_verify.solver.step import Model, Scheme
from mpm_verify.solver.stress_update import Stress

DX = 0.3  # side of a cell
CELLS, AROUND = np.array([10, 9]), 3  # cells of a grid, and of its rim around the body
FILLED = np.array([5, 4])  # cells of a grid that the body fills
PPC, OFFSET = 4, (0.2, -0.15)
COURANT = 0.3
FREE: Kind = "free"
STRAINED = np.array([[1.06, 0.17], [-0.08, 0.97]])  # F at the start: sheared and turned, det F = 1.04
MIRROR = np.array([[-1.0, 0.0], [0.0, 1.0]])
QUARTER = np.array([[0.0, -1.0], [1.0, 0.0]])
STRESS_UPDATES: tuple[Stress, ...] = ("usl", "musl", "usf")
BLEND = "flip:fraction=0.9"  # of FLIP and PIC
FLIP = {"flip": 1.0, BLEND: 0.9, "pic": 0.0, "apic": 0.0, "fmpm": 0.0}  # fraction of FLIP by transfer
Sides = Kind | Four
Rule = Callable[[Floats, float, float], tuple[Any, Floats, Floats]]


@dataclass(frozen=True)
class Subject:
    """Method and material that are tested, by their specifications."""

    method: str
    material_name: str

    @cached_property
    def basis(self) -> Any:
        """Basis of the method."""
        return create(METHODS, self.method)

    @cached_property
    def material(self) -> Any:
        """Constitutive model."""
        return create(MATERIALS, self.material_name)

    def check(self) -> None:
        """Raise ValueError with one line for a method or material that is not there."""
        _ = self.basis, self.material

    @cached_property
    def speed(self) -> float:
        """Speed of the fastest wave, the scale of velocities."""
        return float(self.material.wave_speed())

    @property
    def stress(self) -> float:
        """Scale of stresses: rho0 c^2."""
        return float(self.material.rho0) * self.speed**2

    @property
    def dt(self) -> float:
        """Length of a step, below the stable one."""
        return COURANT * DX / self.speed

    @property
    def support(self) -> int:
        """Support nodes of a particle: terms of a sum over nodes."""
        return int(self.basis.support)


@dataclass(frozen=True)
class Variant:
    """Transfer and stress update of a step."""

    transfer: str = "flip"
    stress: Stress = "usl"

    @property
    def flip(self) -> float:
        """Fraction of FLIP, as the name says; of a transfer that does not ship, as it says itself."""
        return FLIP.get(self.transfer, self.scheme.transfer.flip_fraction)

    @cached_property
    def scheme(self) -> Scheme:
        """Choices of the step."""
        return Scheme(create(TRANSFERS, self.transfer), self.stress)

    def __str__(self) -> str:
        return f"{self.transfer} {self.stress}"


@cache
def variants() -> tuple[Variant, ...]:
    """Variants of a step: every transfer with every stress update."""
    return tuple(Variant(transfer, stress) for transfer in available(TRANSFERS) for stress in STRESS_UPDATES)


@cache
def layout(filled: bool = False) -> Layout:
    """Layout of a rectangle away from the sides of its grid, or of one that fills it."""
    lower, upper = (np.zeros(2), DX * FILLED) if filled else (DX * AROUND * np.ones(2), DX * (CELLS - AROUND))
    return rectangle(lower, upper, DX, PPC, OFFSET)


def deformed(F: Floats) -> Callable[[Floats], Floats]:
    """Map of reference positions (n,2) by F (2,2) about the middle of the grid."""
    middle = 0.5 * DX * CELLS
    return lambda X: middle + (X - middle) @ F.T


def carried(subject: Subject, nodes: Floats, F: Floats) -> Floats:
    """Positions of nodes (n,2) beside particles deformed by F: their own, or where F takes them from the reference."""
    return deformed(F)(nodes) if subject.basis.reference else nodes


def populated(subject: Subject, pieces: Layout, F: Floats) -> Particles:
    """Particles of a layout, deformed uniformly by F (2,2)."""
    p: Particles = subject.basis.populate(pieces, subject.material.rho0, deformed(F))
    p.x[:], p.F[:] = deformed(F)(p.X), F
    return p


def shaken(subject: Subject, p: Particles, strain: float = 0.03) -> Particles:
    """Particles with random v, F, sigma and b beside what they have; sigma within strength, compression at first."""
    count = len(p)
    p.v[:] = 0.05 * subject.speed * random(count, 2)
    p.b[:] = 0.5 * subject.speed**2 / DX * random(count, 2, seed=1)
    p.F[:] = p.F @ (np.eye(2) + strain * random(count, 2, 2, seed=2))
    p.sigma[:] = 1e-3 * subject.stress * (0.2 * random(count, 4, seed=3) - (1.0, 1.0, 1.0, 0.0))
    return p


def grid(cells: Ints = CELLS) -> Grid:
    """Grid of so many cells."""
    upper: Floats = DX * cells.astype(np.float64)
    return Grid(DX, np.zeros(2), upper)


def modelled(
    subject: Subject, p: Particles, variant: Variant, walls: Walls | Sides = FREE, cells: Ints = CELLS, **more: Any
) -> Model:
    """Model of particles on a grid of so many cells, its walls by their kind or as they are; `more` goes to Model."""
    g = grid(cells)
    held = walls if isinstance(walls, Walls) else frictional(g, (walls,) * 4 if isinstance(walls, str) else walls)
    return Model(g, p, subject.basis, subject.material, held, subject.dt, variant.scheme, **more)


def ruled(rule: Rule) -> Walls:
    """Walls that a rule moves, see solver.boundary.moving."""
    return moving(grid(), rule)


def by_id(p: Particles, name: str) -> Floats:
    """Array of particles in their initial order."""
    found: Floats = p.in_initial_order(name)
    return found


def rest(particles: Particles, t: float) -> None:
    """No body force acts."""
    particles.b[:] = 0.0
