"""What the paper says of the column, each sentence held against our runs: reproduced or not, with the numbers.

A sentence is about one axis: particles per cell, damping, smoothing, law. It is held against runs that differ in that
axis alone. What "little" and "close" mean is said here, since the paper gives no numbers; None is the answer where our
runs, or what is known of the experiment, cannot tell.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np

from mpm_verify.cases.column.experiment import Experiment, experiment
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver.state import Floats

LITTLE = 0.01  # of the potential energy there was: what can be seen on a figure of it
MARKED = 0.10  # of the largest kinetic energy
CROWDED = 1.2  # from which crowding on a heap is too small for its material
CLOSE = 0.05  # of the front
SCATTER = 0.01  # of the front: what it owes to the places of particles in their cells (study offsets)
NEAR = 0.10  # of the experiment's band


@dataclass(frozen=True)
class FinishedRun:
    """A run that came to its end, its numbers and its curves."""

    run: ColumnRun
    values: dict[str, float]
    curves: dict[str, Floats]

    @property
    def front(self) -> float:
        """At the end, in m."""
        return self.values["front_99"]

    @property
    def height(self) -> float:
        """At the wall at the end, in m."""
        return self.values["height"]


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper, what was found, and whether that is what it says."""

    says: str
    reproduced: bool | None
    found: str
    runs: str = ""  # what the runs share, where a study has several families of them


def claims(ran: Sequence[FinishedRun], axes: Sequence[str]) -> list[Claim]:
    """Of every axis that the paper speaks of, one list a family of runs."""
    found = []
    for axis in axes:
        for family in families(ran, axis):
            known = experiment(family[0].run)
            words = shared(family[0].run, [other for other in axes if other != axis])
            if axis in SPEAK and known and len(family) > 1:
                found += [replace(claim, runs=words) for claim in SPEAK[axis](family, known)]
    return found


def families(ran: Sequence[FinishedRun], axis: str) -> list[list[FinishedRun]]:
    """Runs that differ in one axis alone, in the order of the study."""
    found: dict[ColumnRun, list[FinishedRun]] = {}
    if not ran:
        return []
    usual: Any = {axis: getattr(ran[0].run, axis)}
    for one in ran:
        found.setdefault(replace(one.run, **usual), []).append(one)
    return list(found.values())


def shared(run: ColumnRun, axes: Iterable[str]) -> str:
    """What a run has on these axes, in words."""
    return ", ".join(told(axis, getattr(run, axis)) for axis in axes)


NOTHING = {
    ("smoothing", "none"): "no smoothing", ("start", "none"): "no stress at first", ("limit", inf): "no limit",
    ("gate", inf): "no gate", ("damping", 0.0): "no damping",
}  # fmt: skip


def told(axis: str, value: Any) -> str:
    """A value of an axis in words."""
    if (axis, value) in NOTHING:
        return NOTHING[axis, value]
    if isinstance(value, bool):
        return axis if value else f"no {axis}"
    if axis == "damping":
        return f"{100 * value:g} % damping"
    after = {"cells": "cells wide", "ppc": "per cell", "damping_kind": "damping", "deformation": "F"}
    if axis in after or axis == "smoothing":
        return f"{value} {after.get(axis, axis)}"
    if axis in ("method", "material"):
        return str(value)
    return f"{axis} {f'{value:g}' if isinstance(value, float) else value}"


def rises(values: Sequence[float]) -> bool:
    """Each above the one before."""
    return all(later > earlier for earlier, later in pairwise(values))


def beyond(value: float, band: tuple[float, float]) -> float:
    """How far above (or, negative, below) a band a value is, as a share of its nearer end; zero inside."""
    low, high = band
    return value / high - 1 if value > high else value / low - 1 if value < low else 0.0


def fronts(family: Sequence[FinishedRun], axis: str) -> str:
    """`0.902 m with 1 per cell, ...`."""
    return listed(family, axis, lambda one: one.front)


def heights(family: Sequence[FinishedRun], axis: str) -> str:
    """`0.08 m with 1 per cell, ...`."""
    return listed(family, axis, lambda one: one.height)


def listed(family: Sequence[FinishedRun], axis: str, length: Callable[[FinishedRun], float]) -> str:
    """A length of each run, with what the run has on the axis."""
    return ", ".join(f"{length(one):.3f} m with {told(axis, getattr(one.run, axis))}" for one in family)


def band(limits: tuple[float, float]) -> str:
    """In m."""
    return f"{limits[0]:.3f} to {limits[1]:.3f} m"


def of_particles(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Figure 4."""
    few = sorted(family, key=lambda one: one.run.ppc)
    first, last = few[0], few[-1]
    return [
        Claim("Run-out is over-predicted whatever the number of particles.",
              all(beyond(one.front, known.front) > 0 for one in few),
              f"The front comes to {fronts(few, 'ppc')}; the experiment's band is {band(known.front)}.{crowds(few)}"),
        Claim("The final height rises with the number of particles.", settled(few, rises([one.height for one in few])),
              f"It is {heights(few, 'ppc')}.{falling(few)}"),
        Claim("With one per cell the final height is under-predicted.",
              beyond(first.height, known.height) < 0 if first.run.ppc == 1 else None,
              f"It is {heights([first], 'ppc')}; the experiment's is {band(known.height)}."),
        Claim("With more it reaches roughly the experiment's.", abs(beyond(last.height, known.height)) <= NEAR,
              f"It is {heights([last], 'ppc')}, {off(last.height, known.height)}; up to {100 * NEAR:.0f} % counts as "
              "roughly."),
    ]  # fmt: skip


def crowds(family: Sequence[FinishedRun]) -> str:
    """Which runs have a heap too small for its material, as a sentence; nothing where there are none."""
    crowded = [one for one in family if one.values["crowding"] > CROWDED]
    if not crowded:
        return ""
    named = " and ".join(f"{one.values['crowding']:.2f} times with {told('ppc', one.run.ppc)}" for one in crowded)
    return f" But of the space they are in particles keep {named} as their volume: those runs are weak evidence."


def settled(family: Sequence[FinishedRun], found: bool) -> bool | None:
    """Whether heights rise; None where one may still fall below the one before."""
    falls = [
        later.height - earlier.height < later.values["creep"] * later.height for earlier, later in pairwise(family)
    ]
    return None if found and any(falls) else found


def falling(family: Sequence[FinishedRun]) -> str:
    """How much heights still change, as a sentence."""
    most = max(family, key=lambda one: abs(one.values["creep"]))
    return f" In the last fifth of the time they still fell by up to {100 * most.values['creep']:.1f} %."


def off(value: float, limits: tuple[float, float]) -> str:
    """`28 % below the band`."""
    away = beyond(value, limits)
    return "in the band" if not away else f"{100 * abs(away):.0f} % {'above' if away > 0 else 'below'} the band"


def of_damping(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Figures 5 and 6."""
    rising = sorted(family, key=lambda one: one.run.damping)
    first, last = rising[0], rising[-1]
    start = float(first.curves["potential"][0])
    potential, kinetic = (largest_change(first, last, name) for name in ("potential", "on_grid"))
    most = float(first.curves["on_grid"].max())
    least = float(last.curves["on_grid"].max())
    return [
        Claim("Run-out falls as damping grows.", rises([-one.front for one in rising]),
              f"The front comes to {fronts(rising, 'damping')}."),
        Claim("It comes closer to the experiment.",
              abs(beyond(last.front, known.front)) < abs(beyond(first.front, known.front)),
              f"From {off(first.front, known.front)} to {off(last.front, known.front)}, {band(known.front)}."),
        Claim("Potential energy is not discernibly changed by damping.", potential <= LITTLE * start,
              f"With {told('damping', last.run.damping)} it changes by up to {100 * potential / start:.1f} % of the "
              f"initial potential energy, and kinetic energy by up to {100 * kinetic / start:.1f} % of it: alike. From "
              f"{100 * LITTLE:.0f} % on a change can be seen on a figure."),
        Claim("Kinetic energy is markedly changed.", kinetic >= MARKED * most,
              f"By up to {100 * kinetic / most:.0f} % of its largest value, which falls by "
              f"{100 * (1 - least / most):.0f} %. From {100 * MARKED:.0f} % on it counts as marked."),
    ]  # fmt: skip


def largest_change(one: FinishedRun, other: FinishedRun, name: str) -> float:
    """The largest difference of two curves at equal times."""
    t = one.curves["t"]
    return float(np.abs(one.curves[name] - np.interp(t, other.curves["t"], other.curves[name])).max())


def of_smoothing(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Figure 7."""
    by = {one.run.smoothing.partition(":")[0]: one for one in reversed(family)}
    plain, found = by.get("none"), []
    if plain and (one := by.get("volumetric")):
        found += [
            Claim("Volumetric smoothing over-predicts the run-out.", beyond(one.front, known.front) > 0,
                  f"The front comes to {one.front:.3f} m; the experiment's band is {band(known.front)}. It is "
                  f"{1000 * (one.front - plain.front):+.0f} mm from where it comes without smoothing."),
            Claim("Volumetric smoothing over-predicts the height of the slope.", beyond(one.height, known.height) > 0,
                  f"The height at the wall is {one.height:.3f} m, and {plain.height:.3f} m without smoothing; the "
                  f"experiment's is {band(known.height)}."),
        ]  # fmt: skip
    if plain and (one := by.get("deviatoric")):
        near, far = (abs(beyond(each.front, known.front)) for each in (one, plain))
        found.append(
            Claim("Deviatoric smoothing reduces the run-out, towards the experiment.",
                  None if near == far == 0 else one.front < (1 - SCATTER) * plain.front and near < far,
                  f"The front comes to {one.front:.3f} m with and {plain.front:.3f} m without it, "
                  f"{off(one.front, known.front)} and {off(plain.front, known.front)}; up to "
                  f"{100 * SCATTER:.0f} % is scatter."))  # fmt: skip
    return found


def of_law(family: Sequence[FinishedRun], known: Experiment) -> list[Claim]:
    """Figure 8."""
    by = {one.run.material.partition(":")[0]: one for one in reversed(family)}
    if not {"mohr_coulomb", "ubcsand"} <= by.keys():
        return []
    plain, sand = by["mohr_coulomb"], by["ubcsand"]
    apart = sand.front / plain.front - 1
    t, front = sand.curves["t"], sand.curves["front_99"]
    difference = front - np.interp(t, plain.curves["t"], plain.curves["front_99"])
    early = float(np.abs(difference[t <= 0.17]).max(initial=0.0))
    return [
        Claim("UBCSAND and Mohr-Coulomb end close to each other.", abs(apart) <= CLOSE,
              f"The fronts come to {sand.front:.3f} m and {plain.front:.3f} m, {100 * apart:+.1f} %; up to "
              f"{100 * CLOSE:.0f} % counts as close."),
        Claim("UBCSAND is marginally stiffer: it runs out a little less.", -CLOSE <= apart < 0,
              f"The front of UBCSAND comes {1000 * abs(sand.front - plain.front):.0f} mm "
              f"{'less far' if apart < 0 else 'further'}, "
              f"its height at the wall is {sand.height:.3f} m against {plain.height:.3f} m."),
        Claim("Both come close to the experiment.",
              all(abs(beyond(one.front, known.front)) <= NEAR for one in (plain, sand)),
              f"UBCSAND {off(sand.front, known.front)}, Mohr-Coulomb {off(plain.front, known.front)}, "
              f"{band(known.front)}; up to {100 * NEAR:.0f} % counts as close."),
        Claim("UBCSAND follows the experiment in the first 0.17 s.", None,
              "No curve of the experiment is at hand."),
        Claim("UBCSAND follows Mohr-Coulomb later, and not before 0.17 s.", abs(float(difference[-1])) < early,
              f"The two fronts differ by up to {1000 * early:.0f} mm until 0.17 s, and by "
              f"{1000 * abs(float(difference[-1])):.0f} mm at the end."),
    ]  # fmt: skip


Speaker = Callable[[Sequence[FinishedRun], Experiment], list[Claim]]
SPEAK: dict[str, Speaker] = {
    "ppc": of_particles,
    "damping": of_damping,
    "smoothing": of_smoothing,
    "material": of_law,
}
