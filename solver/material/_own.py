"""Check of a material from a user's file: what it states of itself, its energy, and one update of a few particles."""

from dataclasses import fields
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.solver.material_model import Material
from mpm_verify.solver.own_contract import arguments, below, called, kernel, real, shown
from mpm_verify.solver.own_file import OwnFileError, guarded
from mpm_verify.solver.state import Particles

COUNT = 5  # particles
STEP = 1e-6
STRAIN = np.array([[2e-5, 1e-5], [-1e-5, 3e-5]])
TINY, MOST = np.finfo(float).tiny, np.finfo(float).max


def check(material: Any, path: Path) -> None:
    """Check a material. Raises OwnFileError with one line."""
    below(material, Material, path)
    arguments(material, Material, path)
    real(material, "rho0", path, TINY, MOST, "a number above zero, the density at reference")
    speed = guarded(path, material.wave_speed)
    if not isinstance(speed, int | float | np.number) or not 0 < speed < inf:
        raise OwnFileError(f"{path}: wave_speed gives {shown(speed)}; it must be a number above zero")
    if material.energy is not None:
        checked_energy(material, path)
    if material.respond is not None:
        in_rate_form(material, path)
    updated(material, path)


def checked_energy(material: Any, path: Path) -> None:
    """Check that the energy is an expression in the components of F, for those of symbols that it is asked with."""
    import sympy as sp

    called(material, "energy", path, "self, F, log", (2,))
    whole = [[sp.Symbol(f"F{i}{j}", real=True) for j in range(3)] for i in range(3)]
    F = [[c if (i == 2) == (j == 2) else sp.Integer(0) for j, c in enumerate(row)] for i, row in enumerate(whole)]
    try:
        W = guarded(path, lambda: material.energy(F, sp.log))
    except OwnFileError as error:
        if not isinstance(error.__cause__, TypeError | AttributeError):
            raise
        raise OwnFileError(f"{error}; F holds symbols: take the log that it is given, and **0.5 for sqrt") from error
    symbols = {symbol for row in whole for symbol in row}
    if not isinstance(W, sp.Expr) or not W.free_symbols:
        raise OwnFileError(
            f"{path}: energy returns {shown(W)}; it must return the stored energy, an expression in the components of F"
        )
    if unknown := W.free_symbols - symbols:
        raise OwnFileError(f"{path}: energy has the unknown symbols {', '.join(sorted(map(str, unknown)))}")


def in_rate_form(material: Any, path: Path) -> None:
    """Check the kernel of a material in rate form, and the constants that it reads."""
    from mpm_verify.solver.objective import RESPOND
    from mpm_verify.solver.rate_material import RateMaterial

    below(material, RateMaterial, path)
    arguments(material, RateMaterial, path)
    kernel(material, "respond", path, RESPOND, "RESPOND")
    if material.out_of_plane not in ("", "trial", "plane"):
        raise OwnFileError(f'{path}: out_of_plane = {shown(material.out_of_plane)} must be "trial", "plane" or ""')
    needs = {"trial": ("lam", "mu"), "plane": ("moduli",)}.get(material.out_of_plane, ())
    lacking = [name for name in needs if getattr(material, name, None) is None]
    if lacking:
        raise OwnFileError(
            f'{path}: out_of_plane = "{material.out_of_plane}" needs {lacking[0]}; see docs/own-plugin.md'
        )
    constants = guarded(path, material.constants)
    if not isinstance(constants, np.ndarray) or constants.dtype != np.float64 or constants.ndim != 1:
        raise OwnFileError(f"{path}: constants gives {shown(constants)}; it must give np.array([...]) of numbers")


def updated(material: Any, path: Path) -> None:
    """Check what start and update leave of a few particles: arrays of the shapes that they had."""
    X = np.linspace(0.1, 0.9, 2 * COUNT).reshape(COUNT, 2)
    particles = Particles(X, np.ones(COUNT), np.ones(COUNT), np.zeros((COUNT, 0)))
    shapes = {item.name: getattr(particles, item.name).shape for item in fields(particles)}
    kept = {name for name, shape in shapes.items() if 0 not in shape}
    with np.errstate(all="ignore"):
        for name, action in {
            "start": lambda: material.start(particles),
            "update": lambda: material.update(particles, STEP),
        }.items():
            particles.F = np.tile(np.eye(2) + STRAIN * (name == "update"), (COUNT, 1, 1))
            guarded(path, action)
            for key, shape in shapes.items():
                whole(path, name, key, getattr(particles, key), shape, key in kept)


def whole(path: Path, method: str, name: str, array: Any, shape: tuple[int, ...], kept: bool) -> None:
    """Check that an array of particles can be worked with; `kept`: that it has the shape that it had."""
    kind = np.int64 if name == "id" else np.float64
    right = isinstance(array, np.ndarray) and array.dtype == kind and array.flags.c_contiguous
    if not right or array.shape[:1] != (COUNT,) or (kept and array.shape != shape):
        text = ", ".join(["P", *map(str, shape[1:])]) if kept else "P, n"
        found = f"{array.dtype} {array.shape}" if isinstance(array, np.ndarray) else shown(array)
        raise OwnFileError(
            f"{path}: {method} leaves particles.{name} as {found} of {COUNT} particles; write to the array itself, "
            f"particles.{name}[:] = ..., {np.dtype(kind)} ({text})"
        )
