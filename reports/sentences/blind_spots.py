"""Sentences about what a study of a manufactured solution can see, and what it cannot."""

from collections.abc import Callable

from mpm_verify.mms.blind_spots import (
    CLEAR,
    FAINT,
    OPEN,
    ROUND,
    SEEN_BY,
    SEEN_BY_AXISYMMETRIC,
    SEEN_BY_LINE,
    SEEN_BY_SOLID,
    SMALL,
    BlindSpot,
    BlindSpotCode,
    Numbers,
)
from mpm_verify.reports.sentences.numbers import figure, percent
from mpm_verify.solver.sides import SIDES, SOLID_SIDES

MINUS = "\N{MINUS SIGN}"
Words = Callable[[Numbers], str]


def sentence(spot: BlindSpot) -> str:
    """Sentence on a blind spot or on what is seen; of a blind spot, with the solutions of the library that see it."""
    if not spot.blind:
        return SEEN[spot.code](spot.numbers)
    seers = seen_by(spot.numbers).get(spot.code, ())
    return unseen(spot) + (f" Seen by {', '.join(seers)}." if seers else "")


def seen_by(n: Numbers) -> dict[BlindSpotCode, tuple[str, ...]]:
    """Solutions of the library that see what others of the same dimensions are blind to."""
    if n.get("axisymmetric"):
        return SEEN_BY_AXISYMMETRIC
    return {1.0: SEEN_BY_LINE, 3.0: SEEN_BY_SOLID}.get(n.get("dimension", 2.0), SEEN_BY)


def solid(n: Numbers) -> bool:
    """Whether the solution has three dimensions."""
    return n.get("dimension") == 3


def line(n: Numbers) -> bool:
    """Whether the solution has one dimension."""
    return n.get("dimension") == 1


def hoop(n: Numbers) -> str:
    """Phrase on the sizes of what goes around the axis."""
    return (
        f"The hoop stress over the radius reaches {percent(n['hoop_stress'])} of the force, all terms over the radius "
        f"{percent(n['hoop_terms'])}, and the hoop strain {percent(n['hoop_strain'])} of the largest"
    )


def unseen(spot: BlindSpot) -> str:
    """Sentence on what a study is blind to."""
    return BLIND[spot.code](spot.numbers)


def no_shear(n: Numbers) -> str:
    """Sentence on F that is diagonal, or all but diagonal."""
    how = "F is diagonal everywhere" if n["shear"] == 0 else f"F is all but diagonal (within {figure(n['shear'])})"
    return f"{how}: there is no shear, so a dropped shear stress and a wrong shear sign are invisible."


def no_rotation(n: Numbers) -> str:
    """Sentence on R that is I, or all but I."""
    still = n["rotation_deg"] < ROUND
    how = "Nothing turns" if still else f"The material turns by {figure(n['rotation_deg'])}° at most"
    return (
        f"{how}, F is its own transpose: domain vectors moved by Fᵀ, FᵀF instead of F Fᵀ, a wrong polar "
        "decomposition or stress rate are invisible, and so is the error of domains that stretch but do not turn."
    )


def rotation(n: Numbers) -> str:
    """Sentence on how far the material turns."""
    weakly = ", so rotation is tested, though weakly" if n["rotation_deg"] < CLEAR else ", so rotation is tested"
    return f"The material turns by up to {figure(n['rotation_deg'])}°{weakly}."


def no_volume(n: Numbers) -> str:
    """Sentence on det F that is 1, or all but 1."""
    change = max(1 - n["J_min"], n["J_max"] - 1)
    how = "det F is 1 everywhere" if change < ROUND else f"det F differs from 1 by {figure(change)} at most"
    return f"{how}, so a wrong volumetric response (lambda drops out), a missing 1/J and V0 instead of V are invisible."


def volume(n: Numbers) -> str:
    """Sentence on how far det F goes."""
    low, high = figure(n["J_min"]), figure(n["J_max"])
    how = f"runs from {low} to {high}"
    if low == high:
        how = f"differs from 1 by up to {figure(max(1 - n['J_min'], n['J_max'] - 1))}"
    return f"det F {how}, so the volumetric response takes part."


def begins(part: float, what: str) -> str:
    """Phrase such as `without velocity` or `with 1 % of the largest velocity`."""
    return f"without {what}" if part < ROUND else f"with {percent(part)} of the largest {what}"


def amplitude(n: Numbers) -> str:
    """Phrase on the sizes of strain and stress."""
    return (
        f"Components of F {MINUS} I reach {figure(n['strain'])}, stresses {percent(n['stress'])} of rho0 c² "
        "(c the compression wave)"
    )


def no_walls(n: Numbers) -> str:
    """Sentence on what the boundary does instead of letting particles slide along it."""
    moves, pulls = n["edge_motion"] > ROUND, n["edge_traction"] > ROUND
    if n["edge_free"] and pulls:
        return (
            f"The edges are free, and yet the fields have a traction of {percent(n['edge_traction'])} of the largest "
            "stress there: with this material the problem is not the one that is run, and no study of it converges."
        )
    open_ = sum(side in n for side in SOLID_SIDES)  # pulled or prescribed
    if open_ == 2 * n.get("dimension", 2):
        return "No wall holds the body: walls that hold still or let particles slide take no part."
    rest = "The rest of the boundary" if open_ else "The boundary"
    if not (moves or pulls):
        return f"{rest} neither moves nor carries stress: no wall takes part."
    if not moves:
        return f"{rest} does not move: a wall along which particles slide takes no part."
    if not pulls:
        return f"{rest} moves free of stress: no wall takes part."
    return f"{rest} moves as it is prescribed: walls that hold still or let particles slide take no part."


def listed(sides: list[str]) -> str:
    """Phrase such as `the left and top edges are`."""
    *first, last = sides
    if not first:
        return f"the {last} edge is"
    return "all four edges are" if len(sides) == len(SIDES) else f"the {', '.join(first)} and {last} edges are"


def moving_edges(n: Numbers) -> str:
    """Sentence on edges that are pulled or driven, and on what else those can be that nobody has named."""
    driven = [side for side, code in n.items() if code == OPEN["prescribed"]]
    found = [side for side, code in n.items() if code == OPEN["found"]]
    said = [
        f"{listed(sides)} {how}"
        for sides, how in (
            ([side for side in n if side not in driven], "pulled by the exact traction"),
            (driven, "driven by the exact displacement"),
        )
        if sides
    ]
    text = " and ".join(said)
    hint = (
        ": an edge that is no wall and not free is taken to be pulled; name it prescribed "
        'in the "boundary" of domain() to have it driven'
    )
    return f"{text[0].upper()}{text[1:]}{hint * bool(found)}."


def no_plane(n: Numbers) -> str:
    """Sentence on the component that is missing."""
    if line(n):
        return "One dimension: shear, rotation, lateral stresses and all that other directions do are not there."
    still = "one component of u" if n["weaker_component"] <= FAINT else "one component of the gradient"
    if solid(n):
        return f"Not all three dimensions take part: {still} is all but zero, so part of the code is not tested."
    return f"The problem is one-dimensional: {still} is all but zero, so half of the code is not tested."


def small(n: Numbers) -> bool:
    """Whether strains are so small that what is of second order in them is not seen; not of old Results."""
    return n.get("strain", SMALL) < SMALL


def no_order(n: Numbers) -> str:
    """Sentence on factors whose order does not matter."""
    why = "The strains are small" if small(n) else "F and the velocity gradient L commute"
    return f"{why}, so F (I + dt L) instead of (I + dt L) F is invisible."


def spin(n: Numbers) -> str:
    """Sentence on the skew part of L, which moves the body only where strains are not small."""
    where = " in F, though not in u or sigma, for the strains are small" if small(n) else ""
    return f"The velocity gradient L is not symmetric, so L transposed shows{where}."


BLIND: dict[BlindSpotCode, Words] = {
    BlindSpotCode.SHEAR: no_shear,
    BlindSpotCode.ROTATION: no_rotation,
    BlindSpotCode.ORDER: no_order,
    BlindSpotCode.SPIN: lambda n: "The velocity gradient L is symmetric, so L transposed is invisible.",
    BlindSpotCode.VOLUME: no_volume,
    BlindSpotCode.GRADIENT: lambda n: (
        "F is the same everywhere at a time: the stress has no gradient, so what depends on one is invisible."
    ),
    BlindSpotCode.START: lambda n: (
        f"The motion starts {begins(n['start_acceleration'], 'acceleration')}, so a missing half-step start is "
        "invisible."
    ),
    BlindSpotCode.VELOCITY: lambda n: (
        f"The body starts {begins(n['start_velocity'], 'velocity')}, so wrong initial velocities are invisible."
    ),
    BlindSpotCode.MIRROR: lambda n: (
        "The motion is its own mirror image in a diagonal plane, so two axes exchanged throughout is invisible."
        if solid(n)
        else "The motion is its own mirror image in the diagonal X = Y, so x and y exchanged throughout is invisible."
    ),
    BlindSpotCode.AMPLITUDE: lambda n: (
        f"{amplitude(n)}: so small that ln J cannot be told from J {MINUS} 1, V0 from V, nor the position x from the "
        "reference position X."
    ),
    BlindSpotCode.CROSSING: lambda n: (
        f"At {n['finest']:g} cells the largest displacement is {figure(n['finest'] * n['displacement'])} cells, so of "
        f"{8 if solid(n) else 2 if line(n) else 4} particles in a cell none crosses into another: what crossing does "
        "is invisible."
    ),
    BlindSpotCode.WALLS: no_walls,
    BlindSpotCode.LOAD: lambda n: (
        f"The body force is at most {percent(n['load'])} of the largest acceleration, so one that is dropped or wrong "
        "is hard to see."
    ),
    BlindSpotCode.STRESS: lambda n: (
        f"The divergence of the stress is {percent(n['stress_force'])} of what the body force and the inertia are: the "
        "load alone moves the body, so wrong internal forces hardly show."
    ),
    BlindSpotCode.PLANE: no_plane,
    BlindSpotCode.HOOP: lambda n: f"{hoop(n)}: a hoop term that is missing is hard to see.",
    BlindSpotCode.MODEL: lambda n: (
        f"The constitutive model is one of small strains, and components of F {MINUS} I reach {figure(n['strain'])}: "
        "its stress is that of its energy to first order alone, so the error ends on a floor that no cells remove."
    ),
    BlindSpotCode.ORDERS: lambda n: (
        "Orders alone let defects pass; exact solutions, invariants and recorded magnitudes catch some that no order "
        "shows."
    ),
    BlindSpotCode.CONSTANTS: lambda n: (
        "A wrong constant leaves the order as it is; only a recorded magnitude sees it."
    ),
}  # fmt: skip
SEEN: dict[BlindSpotCode, Words] = {
    BlindSpotCode.SHEAR: lambda n: (
        f"Off-diagonal components of F reach {figure(n['shear'])}, so the shear stress takes part."
    ),
    BlindSpotCode.ROTATION: rotation,
    BlindSpotCode.ORDER: lambda n: (
        "F and the velocity gradient L do not commute, so a wrong order in the update of F shows."
    ),
    BlindSpotCode.SPIN: spin,
    BlindSpotCode.VOLUME: volume,
    BlindSpotCode.GRADIENT: lambda n: (
        f"The gradient of F reaches {figure(n['gradient'])} over the body's width, so the stress has one too."
    ),
    BlindSpotCode.START: lambda n: (
        f"The motion starts {begins(n['start_acceleration'], 'acceleration')}, so a missing half-step start shows."
    ),
    BlindSpotCode.VELOCITY: lambda n: (
        f"The body starts {begins(n['start_velocity'], 'velocity')}, so wrong initial velocities show."
    ),
    BlindSpotCode.MIRROR: lambda n: (
        f"The motion is not the same in x and y{', nor in z' * solid(n)}, so axes that are exchanged show."
    ),
    BlindSpotCode.AMPLITUDE: lambda n: f"{amplitude(n)}.",
    BlindSpotCode.CROSSING: lambda n: (
        f"At N cells the largest displacement is {figure(n['displacement'])} N cells "
        f"({figure(n['finest'] * n['displacement'])} at {n['finest']:g}), so particles cross cells."
    ),
    BlindSpotCode.WALLS: lambda n: (
        "The ends press on what holds them, so a wall takes part; free ends take none."
        if line(n)
        else "Particles slide along walls that they press on; walls that hold them and free edges take no part."
    ),
    BlindSpotCode.EDGES: moving_edges,
    BlindSpotCode.LOAD: lambda n: (
        f"The body force reaches {figure(n['load'])} times the largest acceleration, so one that is dropped shows."
    ),
    BlindSpotCode.STRESS: lambda n: (
        f"The divergence of the stress is {percent(n['stress_force'])} of the larger of body force and inertia: "
        "internal forces take part."
    ),
    BlindSpotCode.PLANE: lambda n: (
        "All components move, and x, y and z have gradients."
        if solid(n)
        else "Both components move, and both x and y have gradients."
    ),
    BlindSpotCode.HOOP: lambda n: f"{hoop(n)}, so a hoop term that is missing shows.",
}  # fmt: skip
