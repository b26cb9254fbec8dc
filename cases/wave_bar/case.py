"""First axial mode of an elastic bar between two walls: its frequency against the closed form.

A bar of length L lies between rollers all round, so that it is strained along its axis alone, and is struck with the
velocity V sin(pi X / L). Then u = V / omega sin(pi X / L) sin(omega t) with omega = pi c / L, c the compression wave of
the material, as long as V / c is small. The frequency is measured between the first and the last zero of the amplitude
of the mode, sum m u sin(pi X / L), over `periods`.

Lumped mass and central differences make it too low by (pi h / L)^2 (1 - C^2) / 24 at the Courant number C, as the
dispersion of linear finite elements (Mullen & Belytschko 1982, doi:10.1002/nme.1620180103). Particles add to it: a
velocity that goes to the grid and back is multiplied twice by 1 - (pi h / L)^2 m / 2, where m is the mean of N s^2 over
the particles at s cells from a node. With hats and particles at the quarter points, m = 3/16.
The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Sequence
from math import pi
from typing import Any

from mpm_verify.cases.judging.records import Expectation, Recorded
from mpm_verify.cases.wave_bar.run import AXES, QUICK, Result, Run
from mpm_verify.solver.plugins import MATERIALS, METHODS, TRANSFERS, create, is_file, label, split
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["AXES", "QUICK", "Result", "Run"]

COMMAND = "wave_bar"

SMALL = 1e-4  # amplitude up to which the bar is linear
HATS = ("mpm", "gimp", "cpgimp", "cpdi", "cpdi2", "tlmpm")  # methods with weights of hats at the quarter points
FINE = 1 / 64  # where the closed form is close enough to be held against
QUANTITIES, NORMS, JUDGED = ("frequency",), ("relative",), (("frequency", "relative"),)


def title(runs: Sequence[Run]) -> str:
    """Title of a study of bars."""
    methods = dict.fromkeys(label(m) if is_file(m) else m.upper() for m in (run.method for run in runs))
    return f"Frequency of the first axial mode of a bar: {', '.join(methods)}"


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults."""
    for key, package in {"method": METHODS, "material": MATERIALS, "transfer": TRANSFERS}.items():
        values[key] = canonical_name(package, values.get(key, getattr(Run, key)))
    return values


def expectation(run: Run, quantity: str, norm: str) -> Expectation | None:
    """Order that the method declares, with the error of the closed form above where the weights are hats."""
    if run.transfer != Run.transfer or run.amplitude > SMALL:
        return None
    basis = create(METHODS, run.method)
    hats = run.ppc == 4 and split(run.method)[0] in HATS
    error = (pi * FINE) ** 2 * ((1 - run.courant**2) / 24 + 3 / 32) if hats else None
    return Expectation(basis.order, source="closed form of the dispersion" if hats else "declared by the method",
                       recorded=(Recorded(FINE, error, error),) if error else ())  # fmt: skip
