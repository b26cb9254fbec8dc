"""What is expected of each method on each solution, registered with its source before anything runs.

Judged is u in rms with 4 and 9 particles per cell; v, F and sigma are registered too, and shown beside what they did.
An order of u is expected whatever the parameters of solution and material are; a stall, divergence and recorded errors
hold for their defaults alone. An amplitude of 1e-5 or less is a regime of its own: no particle crosses a cell.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from mpm_verify.cases.harness.study import QUANTITIES
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, create, is_file, load, split

JUDGED = ("u", "rms")
JUDGED_PPC = (4, 9)
SMALL = 1e-5
STALL = 1.8  # the lower end of the band around order 2

# Orders of u, v, F and sigma; `stalls` and the cells on which it shows at the latest; `diverges`; or `lost` and the
# reason that ends the runs.
REGISTERED: dict[str, dict[str, str]] = {
    "axis_aligned": {
        "mpm": "diverges",
        "gimp": "stalls 64",
        "cpgimp": "2 1.7 1.7 1.7",
        "cpdi": "2 1.7 1.8 1.8",
        "cpdi2": "2 1.7 1.8 1.8",
        "bspline2": "stalls 64",
        "bspline3": "stalls 96",
    },
    "bar": {
        "mpm": "diverges",
        "gimp": "stalls 64",
        "cpgimp": "2 1.9 1.8 1.9",
        "cpdi": "2 1.8 1.8 1.9",
        "cpdi2": "2 1.8 1.8 1.9",
        "bspline2": "stalls 64",
        "bspline3": "stalls 96",
    },
    "clamped_shear": {
        "mpm": "diverges",
        "gimp": "stalls 64",
        "cpgimp": "2 1.9 1.65 1.6",
        "cpdi": "2 1.9 1.65 1.6",
        "cpdi2": "2 1.9 1.65 1.6",
        "bspline2": "stalls 64",
        "bspline3": "stalls 96",
    },
    "swirl": {
        "mpm": "diverges",
        "gimp": "stalls 64",
        "cpgimp": "stalls 96",
        "cpdi": "2 1.9 1.2 1.2",
        "cpdi2": "2 1.9 1.2 1.2",
        "bspline2": "stalls 64",
        "bspline3": "stalls 96",
    },
    "localised": {
        "mpm": "diverges",
        "gimp": "stalls 96",
        "cpgimp": "2 1.7 1.35 1.45",
        "cpdi": "2 1.8 1.35 1.45",
        "cpdi2": "2 1.8 1.35 1.45",
        "bspline2": "stalls 64",
        "bspline3": "stalls 128",
    },
    "expanding_ring": {
        "mpm": "lost det F",
        "gimp": "stalls 64",
        "cpgimp": "stalls 96",
        "cpdi": "2 1.9 1.5 1.65",
        "cpdi2": "2 1.9 1.5 1.65",
        "bspline2": "stalls 64",
        "bspline3": "stalls 96",
    },
    "generalised_vortex": {
        "mpm": "lost det F",
        "gimp": "stalls 64",
        "cpgimp": "lost wider than two cells",
        "cpdi": "2 1.9 1.6 1.9",
        "cpdi2": "2 2 1.6 1.9",
        "bspline2": "stalls 64",
        "bspline3": "2 1.9 1.9 2",
    },
    "affine": {
        "mpm": "diverges",
        "gimp": "stalls 64",
        "cpgimp": "stalls 96",
        "cpdi": "1.8 0.8 0.75 0.8",
        "cpdi2": "1.8 0.8 0.75 0.8",
        "bspline2": "stalls 64",
        "bspline3": "0.75 0.3 0.2 0.2",
    },
    "small amplitude": {
        "mpm": "2 2 1 1",
        "gimp": "2 2 1 1",
        "cpgimp": "2 2 1 1",
        "cpdi": "2 2 1 1",
        "cpdi2": "2 2 1 1",
        "bspline2": "2 2 2 2",
        "bspline3": "2 2 2 2",
    },
}
# With 9 particles per cell these still have order 2 on the finest grids that were run (96 cells), or have not settled:
# their stall lies beyond, and nothing is registered of it.
LATER_WITH_9 = {("cpgimp", "swirl"), ("gimp", "generalised_vortex")}
LARGE = ("swirl", "expanding_ring", "generalised_vortex")  # solutions of large deformation, with shear and rotation
OWN_MATERIAL = ("expanding_ring",)  # with another its edges are not free of traction, and no order is expected
# Who says so: that u of this method converges at order 2, or does not, once particles cross cells.
LITERATURE = {
    ("mpm", "diverges"): "Steffen, Kirby & Berzins 2008",
    ("mpm", "lost"): "Steffen, Kirby & Berzins 2008",
    ("gimp", "stalls"): "Wallstedt & Guilkey 2008",
    ("cpdi", "2"): "Sadeghirad, Brannon & Burghardt 2011",
    ("cpdi2", "2"): "Sadeghirad, Brannon & Guilkey 2013",
    ("bspline2", "stalls"): "Tielen, Wobbes, Moeller & Beuth 2017",
}
MEASURED = "measured, see ARCHITECTURE.md"

# recorded errors of u in rms: (method, solution, ppc) -> (h, error), table in ARCHITECTURE.md
RECORDED = {
    ("cpdi", "axis_aligned", 4): (1 / 128, 1.127e-5),
    ("cpdi", "axis_aligned", 9): (1 / 128, 1.066e-5),
    ("cpdi2", "axis_aligned", 4): (1 / 64, 4.498e-5),
    ("cpgimp", "axis_aligned", 4): (1 / 64, 4.742e-5),
    ("cpdi", "bar", 4): (1 / 64, 8.058e-5),
    ("cpdi2", "bar", 4): (1 / 64, 8.058e-5),
    ("cpgimp", "bar", 4): (1 / 64, 7.504e-5),
    ("cpdi", "clamped_shear", 4): (1 / 64, 8.414e-5),
    ("cpdi2", "clamped_shear", 4): (1 / 64, 8.344e-5),
    ("cpgimp", "clamped_shear", 4): (1 / 64, 7.467e-5),
    ("cpdi", "swirl", 4): (1 / 64, 1.604e-4),
    ("cpdi2", "swirl", 4): (1 / 64, 1.521e-4),
    ("cpdi", "expanding_ring", 4): (1 / 64, 8.088e-5),
    ("cpdi2", "expanding_ring", 4): (1 / 64, 8.610e-5),
    ("cpdi", "generalised_vortex", 4): (1 / 64, 1.045e-2),
    ("cpdi2", "generalised_vortex", 4): (1 / 64, 9.109e-3),
    ("bspline3", "generalised_vortex", 4): (1 / 64, 1.612e-2),
}


@dataclass(frozen=True)
class Entry:
    """One line of the registry."""

    solution: str
    method: str
    quantity: str
    expectation: Expectation


def registry() -> Iterator[Entry]:
    """Every registered expectation, for the default parameters, and for small amplitudes."""
    for solution, methods in REGISTERED.items():
        for method in methods:
            for quantity in QUANTITIES:
                yield Entry(solution, method, quantity, registered(solution, method, quantity))


def registered(solution: str, method: str, quantity: str) -> Expectation:
    """The line of the registry. A measured order has a wide band: it still falls on the grids that it was seen on."""
    words = REGISTERED[solution][method].split()
    said = LITERATURE.get((method, words[0])) if quantity == "u" else None
    source = f"{said}; {MEASURED}" if said else MEASURED
    match words:
        case ["diverges"]:
            return Expectation(None, source=source)
        case ["stalls", cells]:
            return Expectation(None, stall=STALL, stall_h=1 / int(cells), source=source)
        case ["lost", *reason]:
            return Expectation(None, lost=" ".join(reason), source=source)
    order = float(words[QUANTITIES.index(quantity)])
    if quantity == "u" and order == 2:
        return Expectation(order, source=source)
    return Expectation(order, below=min(0.5, 0.8 * order), above=0.6, source=source)


def expected(
    method: str, solution: str, material: str, ppc: int, quantity: str, norm: str, usual: bool = True
) -> Expectation | None:
    """The registered expectation, for canonical specifications; None where there is none: only shown.

    `usual` says that the scheme is the one whose errors are recorded. Of a user's own solution the order of u is
    expected that its file declares, or else the one that the method promises.
    """
    if norm != "rms" or ppc not in JUDGED_PPC:
        return None
    plugin: Any = create(SOLUTIONS, solution)
    if is_file(solution):
        if quantity != "u":
            return None
        declared, promise = plugin.order, promised(method, plugin)
        if declared:
            return Expectation(declared, source="declared in the solution's file")
        return Expectation(promise, source="declared by the method") if promise else None
    name = split(solution)[0]
    regime = "small amplitude" if small(plugin) else name
    if method not in REGISTERED.get(regime, {}) or split(material)[0] != "neo_hookean":
        return None
    expectation, own = registered(regime, method, quantity), same(material, plugin.material)
    if (name in OWN_MATERIAL and not own) or (regime == name and solution != name and expectation.order is None):
        return None
    if expectation.order is None and (not own or (ppc == 9 and later_with_9(method, name, expectation))):
        return None
    h, error = (
        RECORDED.get((method, solution, ppc), (None, None)) if usual and own and quantity == "u" else (None, None)
    )
    return replace(expectation, constant_h=h, constant=error)


def promised(method: str, solution: Any) -> float | None:
    """Order of u that a method declares and keeps on this solution; None where particles cross cells and it does not.

    A method keeps it that is registered with an order on each of the solutions of large deformation.
    """
    crosses = solution.edges.reach > SMALL * float(solution.upper[0] - solution.lower[0])
    keeps = all(method in REGISTERED[name] and registered(name, method, "u").order for name in LARGE)
    if crosses and not keeps:
        return None
    return float(load(METHODS, method).order)


def later_with_9(method: str, solution: str, expectation: Expectation) -> bool:
    """Whether the stall was seen with 4 particles per cell alone."""
    return expectation.stall is not None and (method == "bspline3" or (method, solution) in LATER_WITH_9)


def small(solution: Any) -> bool:
    """Whether no particle will cross a cell: amplitudes A, B, G that are next to nothing, of a body between walls.

    At the free edge of a ring classical MPM loses its det F whatever the amplitude.
    """
    sizes = [abs(getattr(solution, name)) for name in ("A", "B", "G") if hasattr(solution, name)]
    held = solution.boundary in ("roller", "fixed")
    return held and bool(sizes) and max(sizes) <= SMALL * float(solution.upper[0] - solution.lower[0])


def same(one: str, other: str) -> bool:
    """Whether two specifications are the same material."""
    return bool(create(MATERIALS, one) == create(MATERIALS, other))
