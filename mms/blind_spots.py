"""Rules of the auditor: each reads the numbers of mms/measure.py and gives one BlindSpot, a code with numbers.

A defect is invisible where the term it changes is zero or a hundredth of what stands beside it. That the defects named
in reports/sentences/blind_spots.py do not change such fields, and do change the others, is tested on the fields of
every solution and with planted ones (tests/test_audit.py, tests/test_defects.py).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

from mpm_verify.solver.sides import SOLID_SIDES

Numbers = dict[str, float]
OPEN = {"pulled": 1.0, "prescribed": 2.0, "found": 3.0}  # kinds of edges; the last: pulled, as it is nothing else
FAINT = 0.01  # fraction below which a term is not seen beside the others
WEAK = 0.05  # fraction of the force or the acceleration that matters most
SMALL = 1e-3  # strain below which second order in the strain is not seen in the error of a usual grid
TURNED, CLEAR = 1.0, 15.0  # degrees: below the first nothing is seen, from the second on it is not weak
ROUND = 1e-9  # fraction of the largest value: above round-off
FINEST, SOLID_FINEST = 128, 16  # cells of the finest usual grid, and of that in three dimensions
CONSISTENT = 1e-4  # strain up to which a model of small strains has the stress of its energy
QUARTER = 0.25  # cells: of 4 particles in a cell, each is a quarter of a cell from its face


class BlindSpotCode(StrEnum):
    """Codes of what a study of a solution may be blind to."""

    SHEAR = "shear"  # off-diagonal components of F
    ROTATION = "rotation"  # R of F = R U; F is its own transpose where R = I
    ORDER = "order"  # order of the factors in the update of F
    SPIN = "spin"  # skew part of the velocity gradient L
    VOLUME = "volume"  # det F
    GRADIENT = "gradient"  # change of F over the body
    START = "start"  # acceleration at t = 0: what the half-step start corrects
    VELOCITY = "velocity"  # velocity at t = 0
    MIRROR = "mirror"  # whether u_x(X, Y) = u_y(Y, X)
    AMPLITUDE = "amplitude"  # strain and stress
    CROSSING = "crossing"  # displacement in cells
    WALLS = "walls"  # what the boundary does: held, sliding, free or prescribed
    EDGES = "edges"  # edges that are pulled or prescribed, where there are some
    LOAD = "load"  # body force against inertia
    STRESS = "stress"  # divergence of the stress against body force and inertia
    PLANE = "plane"  # one-dimensional motion
    HOOP = "hoop"  # what an axisymmetric program has beside a plane one
    MODEL = "model"  # strains too large for the constitutive model, where they are
    ORDERS = "orders"  # what an observed order does not show, of any solution
    CONSTANTS = "constants"  # what leaves the order as it is, of any solution


@dataclass(frozen=True)
class BlindSpot:
    """One thing a study of the solution cannot see (`blind`), or does see, with the numbers that say so."""

    code: BlindSpotCode
    blind: bool
    numbers: Numbers = field(default_factory=dict)


ALWAYS = (BlindSpot(BlindSpotCode.ORDERS, True), BlindSpot(BlindSpotCode.CONSTANTS, True))
SEEN_BY = {  # solutions of the library that see what others are blind to
    BlindSpotCode.SHEAR: ("clamped_shear", "generalised_vortex", "swirl"),
    BlindSpotCode.ROTATION: ("clamped_shear", "generalised_vortex", "swirl"),
    BlindSpotCode.ORDER: ("clamped_shear", "generalised_vortex", "swirl"),
    BlindSpotCode.SPIN: ("clamped_shear", "generalised_vortex", "swirl"),
    BlindSpotCode.VOLUME: ("axis_aligned", "clamped_shear", "swirl"),
    BlindSpotCode.GRADIENT: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.START: ("axis_aligned:phase=0.785", "clamped_shear"),
    BlindSpotCode.VELOCITY: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.MIRROR: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.AMPLITUDE: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.CROSSING: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.WALLS: ("axis_aligned",),
    BlindSpotCode.LOAD: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.STRESS: ("axis_aligned", "clamped_shear"),
    BlindSpotCode.PLANE: ("axis_aligned", "clamped_shear"),
}
LINE = (  # what a solution in one dimension may see at all
    BlindSpotCode.VOLUME, BlindSpotCode.GRADIENT, BlindSpotCode.START, BlindSpotCode.VELOCITY, BlindSpotCode.AMPLITUDE,
    BlindSpotCode.CROSSING, BlindSpotCode.WALLS, BlindSpotCode.LOAD, BlindSpotCode.STRESS,
)  # fmt: skip
SEEN_BY_LINE: dict[BlindSpotCode, tuple[str, ...]] = {
    code: ("bump1d",) if code is BlindSpotCode.START else ("bar1d",) for code in LINE
}
SEEN_BY_AXISYMMETRIC: dict[BlindSpotCode, tuple[str, ...]] = {
    code: ("cylinder_rz",) for code in (*SEEN_BY, BlindSpotCode.HOOP) if code is not BlindSpotCode.MIRROR
}
SEEN_BY_SOLID: dict[BlindSpotCode, tuple[str, ...]] = {  # of three dimensions
    code: ("swirl3d",) for code in SEEN_BY if code is not BlindSpotCode.WALLS
}


def volume_kept(n: Numbers) -> bool:
    """Whether det F changes too little beside the strain."""
    return max(1 - n["J_min"], n["J_max"] - 1) <= FAINT * n["strain"]


def walls_idle(n: Numbers) -> bool:
    """Whether no particle slides along a wall that it presses on; in one dimension whether none holds the body."""
    moves, through, pulls = (n[f"edge_{what}"] > ROUND for what in ("motion", "normal_motion", "traction"))
    if n.get("dimension") == 1:  # where nothing slides: whether an end is held
        return not pulls
    return bool(n["edge_free"]) or not (moves and pulls and not through)


def one_dimensional(n: Numbers) -> bool:
    """Whether one component of u, or one of its gradient, is all but zero, or there is but one."""
    return n.get("dimension") == 1 or n["weaker_component"] <= FAINT or n["weaker_direction"] <= FAINT


Rules = dict[BlindSpotCode, tuple[Callable[[Numbers], bool], tuple[str, ...]]]
RULES: Rules = {  # when it is blind, what tells it
    BlindSpotCode.SHEAR: (lambda n: n["shear"] <= FAINT * n["strain"], ("shear",)),
    BlindSpotCode.ROTATION: (lambda n: n["rotation_deg"] < TURNED, ("rotation_deg",)),
    BlindSpotCode.ORDER: (lambda n: n["order"] <= FAINT * n["strain"] or n["strain"] < SMALL, ("order", "strain")),
    BlindSpotCode.SPIN: (lambda n: n["spin"] <= FAINT, ("spin", "strain")),
    BlindSpotCode.VOLUME: (volume_kept, ("J_min", "J_max")),
    BlindSpotCode.GRADIENT: (lambda n: n["gradient"] <= FAINT * n["strain"], ("gradient",)),
    BlindSpotCode.START: (lambda n: n["start_acceleration"] <= WEAK, ("start_acceleration",)),
    BlindSpotCode.VELOCITY: (lambda n: n["start_velocity"] <= FAINT, ("start_velocity",)),
    BlindSpotCode.MIRROR: (lambda n: n["mirror"] <= FAINT, ("mirror",)),
    BlindSpotCode.AMPLITUDE: (lambda n: n["strain"] < SMALL, ("strain", "stress")),
    BlindSpotCode.CROSSING: (lambda n: n["finest"] * n["displacement"] < QUARTER, ("displacement", "finest")),
    BlindSpotCode.WALLS: (walls_idle, ("edge_motion", "edge_normal_motion", "edge_traction", "edge_free")),
    BlindSpotCode.LOAD: (lambda n: n["load"] <= WEAK, ("load",)),
    BlindSpotCode.STRESS: (lambda n: n["stress_force"] <= WEAK, ("stress_force",)),
    BlindSpotCode.PLANE: (one_dimensional, ("weaker_component", "weaker_direction")),
}
AROUND: Rules = {  # of axisymmetry alone
    BlindSpotCode.HOOP: (
        lambda n: n["hoop_stress"] <= FAINT or n["hoop_strain"] <= FAINT,
        ("hoop_stress", "hoop_terms", "hoop_strain"),
    ),
}


def rules_of(n: Numbers) -> Rules:
    """Rules that say anything: some do not of one dimension and of axisymmetry, and one is of that alone."""
    if n.get("dimension") == 1:
        return {code: RULES[code] for code in (*LINE, BlindSpotCode.PLANE)}
    if n.get("axisymmetric"):
        return {code: rule for code, rule in RULES.items() if code is not BlindSpotCode.MIRROR} | AROUND
    return RULES


def judge(measured: Numbers) -> tuple[BlindSpot, ...]:
    """One BlindSpot for each rule, in the order of the rules, and what holds for every solution last."""
    state = tuple(name for name in ("dimension", "axisymmetric") if name in measured)  # of plane strain none is told
    known = {**measured, "finest": float(SOLID_FINEST if measured.get("dimension") == 3 else FINEST)}
    moves = tuple(side for side in SOLID_SIDES if side in measured)  # pulled or prescribed
    more = {BlindSpotCode.WALLS: moves}
    rules = (
        BlindSpot(code, blind(known), {name: known[name] for name in (*names, *more.get(code, ()), *state)})
        for code, (blind, names) in rules_of(known).items()
    )
    edges = BlindSpot(BlindSpotCode.EDGES, False, {side: measured[side] for side in moves})
    model = BlindSpot(BlindSpotCode.MODEL, True, {"strain": measured["strain"]})
    strained = bool(measured.get("small_strain")) and measured["strain"] > CONSISTENT
    return (*rules, *[edges] * bool(moves), *[model] * strained, *ALWAYS)
