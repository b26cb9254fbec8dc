"""Registry of what is expected of each method on each solution, with its source, before anything runs.

It is what the method promises (`Basis.promises`), or what deviates from that (cases/mms/deviations.py).

Judged is u in rms with 4 and 9 particles per cell; v, F and sigma are registered too, and a FAIL of theirs counts.
An order of u is expected whatever the parameters of solution and material are; a stall, divergence and recorded errors
hold for their defaults alone. An amplitude of 1e-5 or less is a regime of its own: no particle crosses a cell.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from mpm_verify.cases.judging.records import Expectation
from mpm_verify.cases.mms import rates
from mpm_verify.cases.mms.deviations import (
    DEVIATIONS,
    LATER_WITH_9,
    OWN_MATERIAL,
    SHOWN,
    SMALL_AMPLITUDE,
    Deviation,
)
from mpm_verify.cases.mms.recorded import recorded
from mpm_verify.cases.mms.run import QUANTITIES
from mpm_verify.mms.discretisation import dimension
from mpm_verify.mms.solutions._own import sides
from mpm_verify.mms.square import Square
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, create, is_file, load, split
from mpm_verify.solver.promise import Promise

JUDGED_QUANTITY = ("u", "rms")
JUDGED_PPC = (4, 9)
OTHER_PPC = {1: (2, 3), 3: (8, 27)}  # of one dimension and of three
LARGE = ("swirl", "expanding_ring", "generalised_vortex")  # solutions of large deformation, with shear and rotation
SMALL = 1e-5  # amplitude over size
HENCKY = ("hencky", "hencky_rate")  # whose errors, and limits of rates, are recorded apart
STALL = 1.8  # the lower end of the band around order 2
OURS, THEIRS = 0.01, 0.1  # relative distance from a recorded error; sound repeats of ours differ by less than 5e-5
MEASURED = "measured, see docs/methods.md"


@dataclass(frozen=True)
class Entry:
    """One entry of the registry."""

    solution: str
    method: str
    quantity: str
    expectation: Expectation


def registry() -> Iterator[Entry]:
    """Every registered expectation, for the default parameters, and for small amplitudes."""
    methods = [*SHOWN, *(name for name in available(METHODS) if name not in SHOWN)]
    for solution in DEVIATIONS:
        for method in methods:
            for quantity in QUANTITIES:
                expectation = registered(solution, method, quantity)
                if expectation:
                    yield Entry(solution, method, quantity, expectation)


def registered(solution: str, method: str, quantity: str) -> Expectation | None:
    """Expectation that the method promises, or that deviates from it; None where neither says anything of it.

    A measured order has a wide band: it still falls on the grids that it was seen on. The source of a promise is named
    for u where the promise is kept.
    """
    promise: Promise = load(METHODS, method).promises(crossing=crosses(solution))
    known = DEVIATIONS[solution].get(method, Deviation())
    order = known.orders(promise.order)[quantity]
    kept = quantity == "u" and order == promise.order
    source = f"{promise.source}; {MEASURED}" if kept and promise.source else MEASURED
    if known.inverts:
        return Expectation(None, stall_h=1 / known.inverts, source=source)
    if known.fails:
        return Expectation(None, failed=known.fails, source=source)
    if known.stalls:
        return Expectation(None, stall=STALL, stall_h=1 / known.stalls, source=source)
    if order is None:
        grows = promise.order is None and known.u is None and not promise.stalls
        return Expectation(None, source=source) if grows else None
    if quantity == "u" and order == 2:
        return Expectation(order, source=source)
    return Expectation(order, below=min(0.5, 0.8 * order), above=0.6, source=source)


def expected(
    method: str,
    solution: str,
    material: str,
    ppc: int,
    quantity: str,
    norm: str,
    usual: bool = True,
    theirs: bool = False,
) -> Expectation | None:
    """Registered expectation, for canonical specifications; None where there is none: only shown.

    `usual` says that the scheme is the one whose errors are recorded: within 1 % everywhere, or, `theirs`, of a solver
    of somebody else, within 10 % on the finest cells, of one order of the step or another. A user's own solution has
    the order of u that its file declares, or else the one that the method promises.
    """
    plugin: Any = create(SOLUTIONS, solution)
    if norm != "rms" or ppc not in OTHER_PPC.get(dimension(plugin), JUDGED_PPC):
        return None
    if is_file(solution):
        if quantity != "u" or rates.strays(material):
            return None
        if plugin.order:
            return Expectation(plugin.order, source="declared in the solution's file")
        if plugin.edges.uniform and "prescribed" in sides(plugin):
            return None  # no error of second order, only that of momentum on its way between particles and grid
        reach = plugin.edges.reach
        return promised(method, reach > SMALL * float(plugin.upper[0] - plugin.lower[0]))
    found = of_energy(method, solution, material, ppc, quantity, usual, theirs)
    if split(material)[0] not in HENCKY:
        return found
    return rates.expected_of(found, method, solution, material, ppc, quantity, usual and not theirs)


def of_energy(
    method: str, solution: str, material: str, ppc: int, quantity: str, usual: bool, theirs: bool
) -> Expectation | None:
    """Registered expectation in rms on a shipped solution, of a material of finite strain that has an energy."""
    plugin: Any = create(SOLUTIONS, solution)
    name = split(solution)[0]
    regime = SMALL_AMPLITUDE if small(plugin) else name
    if regime not in DEVIATIONS or method not in available(METHODS) or not elastic(material):
        return None
    if regime == name and not crosses(name):  # what is registered holds for the small amplitude of its default
        return promised(method, True) if quantity == "u" else None
    expectation, own = registered(regime, method, quantity), same(material, plugin.material)
    if expectation is None or (name in OWN_MATERIAL and not own):
        return None
    if expectation.order is None and regime == name and solution != name:
        return None
    if expectation.order is None and (not own or (ppc == 9 and later_with_9(method, name, expectation))):
        return None
    if not usual or not own:
        return expectation
    known = recorded(solution, method, ppc, quantity, theirs)
    return replace(expectation, recorded=known, within=THEIRS if theirs else OURS, finest=theirs)


def promised(method: str, crossing: bool) -> Expectation | None:
    """Order of u that a method declares and keeps; None where particles cross cells and it does not.

    A method keeps it that has no other registered on each of the solutions of large deformation.
    """
    name = method.partition(":")[0]
    if name not in available(METHODS) and not is_file(name):  # a solver of somebody else
        return None
    promise: Promise = load(METHODS, name).promises(crossing=crossing)
    deviates = (DEVIATIONS[name].get(method) for name in LARGE)
    ends = (known.stalls or known.fails or known.inverts for known in deviates if known)
    if promise.order is None or (crossing and any(ends)):
        return None
    return Expectation(promise.order, source="declared by the method")


def crosses(solution: str) -> bool:
    """Whether particles cross cells with the default parameters of a solution of the registry."""
    return solution != SMALL_AMPLITUDE and not small(create(SOLUTIONS, solution))


def later_with_9(method: str, solution: str, expectation: Expectation | None) -> bool:
    """Whether the stall, or the end of finer runs, was seen with 4 particles per cell alone."""
    return (
        expectation is not None
        and expectation.order is None
        and (method == "bspline3" or (method, solution) in LATER_WITH_9)
    )


def small(solution: Any) -> bool:
    """Whether no particle will cross a cell: an amplitude that is next to nothing, of a body that fills its cells.

    In the cells that the edge of a ring cuts, particles of classical MPM are inverted whatever the amplitude.
    """
    return isinstance(solution, Square) and solution.amplitude <= SMALL


def elastic(material: str) -> bool:
    """Whether what is registered of neo-Hookean solids holds of a material: one of this package, of finite strain."""
    model: Any = None if is_file(material) else create(MATERIALS, material)
    return model is not None and model.energy is not None and not model.small_strain


def same(one: str, other: str) -> bool:
    """Whether two specifications are the same material."""
    return bool(create(MATERIALS, one) == create(MATERIALS, other))
