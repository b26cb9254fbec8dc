"""What there is to see of a manufactured solution: each rule reads the numbers of mms/measure.py and gives one Spot.

A defect is invisible where the term it changes is zero or a hundredth of what stands beside it. That the defects named
do not change such fields, and do change the others, is tested on the fields of every solution and with planted ones
(tests/test_audit.py, tests/test_defects.py).
"""

from collections.abc import Callable
from dataclasses import dataclass

Numbers = dict[str, float]
FAINT = 0.01  # a share below which a term is lost beside the others
WEAK = 0.05  # of the force or the acceleration that matters most
SMALL = 1e-3  # strain below which second order in the strain is lost in the error of a usual grid
TURNED, CLEAR = 1.0, 15.0  # degrees: below the first nothing is seen, from the second on it is not weak
ROUND = 1e-9  # of the largest value: above round-off
FINEST = 128  # cells of the finest usual grid
MINUS = "\N{MINUS SIGN}"

SEEN_BY = {  # solutions of the library that do see it
    "shear": ("clamped_shear", "generalised_vortex", "swirl"),
    "rotation": ("clamped_shear", "generalised_vortex", "swirl"),
    "order": ("clamped_shear", "generalised_vortex", "swirl"),
    "spin": ("clamped_shear", "generalised_vortex", "swirl"),
    "volume": ("axis_aligned", "clamped_shear", "swirl"),
    "gradient": ("axis_aligned", "clamped_shear"),
    "start": ("axis_aligned:phase=0.785", "clamped_shear"),
    "velocity": ("axis_aligned", "clamped_shear"),
    "mirror": ("axis_aligned", "clamped_shear"),
    "amplitude": ("axis_aligned", "clamped_shear"),
    "crossing": ("axis_aligned", "clamped_shear"),
    "walls": ("axis_aligned",),
    "load": ("axis_aligned", "clamped_shear"),
    "stress": ("axis_aligned", "clamped_shear"),
    "plane": ("axis_aligned", "clamped_shear"),
}


@dataclass(frozen=True)
class BlindSpot:
    """One thing a study of the solution cannot see (`blind`), or does see, in one or two sentences."""

    key: str
    sentence: str
    blind: bool


ALWAYS = (
    BlindSpot(
        "orders",
        "Orders alone let defects pass. In a probe apart from this program, of 46 defects planted in a CPDI code, "
        "the order of the displacement caught 33, the orders of all quantities 36, and all checks together, "
        "exactness and physics among them, 44.",
        True,
    ),
    BlindSpot("constants", "A wrong constant leaves the order as it is; only a recorded magnitude sees it.", True),
)


def spot(key: str, blind: bool, cannot: str, can: str) -> BlindSpot:
    """The sentence that applies; of what is blind, with the solutions of the library that see it."""
    return BlindSpot(key, f"{cannot} Seen by {', '.join(SEEN_BY[key])}." if blind else can, blind)


def shear(n: Numbers) -> BlindSpot:
    """Off-diagonal components of F."""
    how = "F is diagonal everywhere" if n["shear"] == 0 else f"F is all but diagonal (within {figure(n['shear'])})"
    return spot(
        "shear",
        n["shear"] <= FAINT * n["strain"],
        f"{how}: there is no shear, so a dropped shear stress and a wrong shear sign are invisible.",
        f"Off-diagonal components of F reach {figure(n['shear'])}, so the shear stress takes part.",
    )


def rotation(n: Numbers) -> BlindSpot:
    """R of the polar decomposition F = R U; F is its own transpose where R = I."""
    angle = f"{figure(n['rotation_deg'])}°"
    how = "Nothing turns" if n["rotation_deg"] < ROUND else f"The material turns by {angle} at most"
    weak = ", so rotation is tested, though weakly" if n["rotation_deg"] < CLEAR else ", so rotation is tested"
    return spot(
        "rotation",
        n["rotation_deg"] < TURNED,
        f"{how}, F is its own transpose: domain vectors moved by Fᵀ, FᵀF in place of F Fᵀ, a wrong polar "
        "decomposition or stress rate are invisible, and so is the error of domains that stretch but do not turn.",
        f"The material turns by up to {angle}{weak}.",
    )


def order(n: Numbers) -> BlindSpot:
    """Whether the order of factors matters in the update of F."""
    return spot(
        "order",
        n["order"] <= FAINT * n["strain"],
        "F and the velocity gradient L commute, so F (I + dt L) in place of (I + dt L) F is invisible.",
        "F and the velocity gradient L do not commute, so a wrong order in the update of F shows.",
    )


def spin(n: Numbers) -> BlindSpot:
    """Skew part of L."""
    return spot(
        "spin",
        n["spin"] <= FAINT,
        "The velocity gradient L is symmetric, so L transposed is invisible.",
        "The velocity gradient L is not symmetric, so L transposed shows.",
    )


def volume(n: Numbers) -> BlindSpot:
    """det F."""
    low, high = n["J_min"], n["J_max"]
    change = max(1 - low, high - 1)
    how = "det F is 1 everywhere" if change < ROUND else f"det F differs from 1 by {figure(change)} at most"
    return spot(
        "volume",
        change <= FAINT * n["strain"],
        f"{how}, so a wrong volumetric law (lambda drops out), a missing 1/J and V0 in place of V are invisible.",
        f"det F runs from {figure(low)} to {figure(high)}, so the volumetric law takes part.",
    )


def gradient(n: Numbers) -> BlindSpot:
    """Change of F over the body."""
    return spot(
        "gradient",
        n["gradient"] <= FAINT * n["strain"],
        "F is the same everywhere at a time: the stress has no gradient, so what depends on one is invisible.",
        f"The gradient of F reaches {figure(n['gradient'])} over the body's width, so the stress has one too.",
    )


def start(n: Numbers) -> BlindSpot:
    """Acceleration at t = 0: what the half-step start corrects."""
    part = percent(n["start_acceleration"])
    how = "out acceleration" if n["start_acceleration"] < ROUND else f" {part} of the largest acceleration"
    return spot(
        "start",
        n["start_acceleration"] <= WEAK,
        f"The motion starts with{how}, so a missing half-step start is invisible.",
        f"The motion starts with {part} of the largest acceleration, so a missing half-step start shows.",
    )


def velocity(n: Numbers) -> BlindSpot:
    """Velocity at t = 0."""
    part = percent(n["start_velocity"])
    how = "out velocity" if n["start_velocity"] < ROUND else f" {part} of the largest velocity"
    return spot(
        "velocity",
        n["start_velocity"] <= FAINT,
        f"The body starts with{how}, so wrong initial velocities are invisible.",
        f"The body starts with {part} of the largest velocity, so wrong initial velocities show.",
    )


def mirror(n: Numbers) -> BlindSpot:
    """u_x(X, Y) = u_y(Y, X)?"""
    return spot(
        "mirror",
        n["mirror"] <= FAINT,
        "The motion is its own mirror image in the diagonal X = Y, so x and y exchanged throughout is invisible.",
        "The motion is not the same in x and y, so axes that are exchanged show.",
    )


def amplitude(n: Numbers) -> BlindSpot:
    """Strain and stress."""
    size = (
        f"Components of F {MINUS} I reach {figure(n['strain'])}, stresses {percent(n['stress'])} of rho0 c² "
        "(c the compression wave)"
    )
    return spot(
        "amplitude",
        n["strain"] < SMALL,
        f"{size}: so small that ln J cannot be told from J {MINUS} 1, nor V0 from V, nor the place x from X.",
        f"{size}.",
    )


def crossing(n: Numbers) -> BlindSpot:
    """Displacement in cells; of 4 particles in a cell, each is a quarter of a cell from its face."""
    cells = figure(FINEST * n["displacement"])
    return spot(
        "crossing",
        FINEST * n["displacement"] < 0.25,
        f"At {FINEST} cells the largest displacement is {cells} cells, so of 4 particles in a cell none crosses into "
        "another: what crossing does is invisible.",
        f"At N cells the largest displacement is {figure(n['displacement'])} N cells ({cells} at {FINEST}), so "
        "particles cross cells.",
    )


def walls(n: Numbers) -> BlindSpot:
    """What the boundary does: held, sliding, free or prescribed."""
    moves, through, pulls = (n[f"edge_{what}"] > ROUND for what in ("motion", "normal_motion", "traction"))
    if n["edge_free"] and pulls:
        cannot = (
            f"The edges are free, and yet the fields have a traction of {percent(n['edge_traction'])} of the largest "
            "stress there: with this material the problem is not the one that is run, and no study of it converges."
        )
    elif not (moves or pulls):
        cannot = "The boundary neither moves nor carries stress: no wall takes part."
    elif not moves:
        cannot = "The boundary does not move: a wall along which particles slide takes no part."
    elif not pulls:
        cannot = "The boundary moves free of stress: no wall takes part."
    else:
        cannot = "The boundary moves as it is prescribed: walls that hold still or let particles slide take no part."
    can = "Particles slide along walls that they press on; walls that hold them and free edges take no part."
    return spot("walls", bool(n["edge_free"]) or not (moves and pulls and not through), cannot, can)


def load(n: Numbers) -> BlindSpot:
    """Body force against inertia."""
    return spot(
        "load",
        n["load"] <= WEAK,
        f"The body force is at most {percent(n['load'])} of the largest acceleration, so one that is dropped or wrong "
        "is hard to see.",
        f"The body force reaches {figure(n['load'])} times the largest acceleration, so one that is dropped shows.",
    )


def stress(n: Numbers) -> BlindSpot:
    """Divergence of the stress against body force and inertia."""
    part = percent(n["stress_force"])
    return spot(
        "stress",
        n["stress_force"] <= WEAK,
        f"The divergence of the stress is {part} of what the body force and the inertia are: the load alone moves the "
        "body, so wrong internal forces hardly show.",
        f"The divergence of the stress is {part} of the larger of body force and inertia: internal forces take part.",
    )


def plane(n: Numbers) -> BlindSpot:
    """One-dimensional motion."""
    still = n["weaker_component"] <= FAINT
    return spot(
        "plane",
        still or n["weaker_direction"] <= FAINT,
        f"The problem is one-dimensional: {'one component of u' if still else 'one component of the gradient'} is all "
        "but zero, so half of the code is not tested.",
        "Both components move, and both x and y have gradients.",
    )


def percent(part: float) -> str:
    """0 %, 3.1 %, 160 %."""
    return f"{figure(100 * part)} %"


def figure(value: float) -> str:
    """Two digits, and no exponent but for small numbers."""
    if abs(value) < 1e-12:
        return "0"
    return f"{float(f'{value:.2g}'):.0f}" if abs(value) >= 10 else f"{value:.2g}"


RULES: tuple[Callable[[Numbers], BlindSpot], ...] = (
    shear, rotation, order, spin, volume, gradient, start, velocity, mirror, amplitude, crossing, walls, load, stress,
    plane,
)  # fmt: skip
