"""Sentences about the exactness battery: what each test holds, what it points to, and why it is not asked."""

from collections.abc import Mapping
from typing import Any

from mpm_verify.cases.exact.case import ExactRemark as Code
from mpm_verify.mms.constitutive.tested import FAILED, Part, Reason
from mpm_verify.reports.sentences import exact_others as others
from mpm_verify.reports.sentences.remarks import Words

Numbers = Mapping[str, Any]

HEADINGS = {
    "weights": "Weights, domains and sums over the nodes",
    "large": "Large deformation, and weights at walls",
    "motion": "Rigid motion under uniform forces",
    "walls": "No force, and walls",
    "friction": "Walls with friction",
    "step": "One step from a strained state",
    "edges": "Edges that are pulled or driven",
    "symmetry": "Mirror and quarter turn",
    "stress": "Constitutive model",
    "history": "Memory, strength and cut-off",
    "plastic": "Return mapping",
    "hardening": "Hardening sand",
    "rates": "Objective rates",
    "smoothing": "Smoothing",
    "smoothed": "Smoothing within a run",
    "state": "Stored state and step limit",
    "unusual": "States that no usual run has",
}
HELD = {
    "moments": "Σ N = 1, Σ dN = 0, Σ N x_i = x_p and Σ dN ⊗ x_i = I",
    "positive": "no shape value is negative",
    "domain_moment": "Σ N x_i y_i is the mean of x y over the corners of the domain",
    "domain_area": "the area of each domain is the volume that it stands for",
    "shared_corners": "corners of domains are those of adjacent pieces of the body, which share them",
    "sum_mass": "mass and its first moment, nodes against particles",
    "sum_momentum": "momentum and its first moment, nodes against particles",
    "sum_force": "the sum of nodal forces is that of the body forces",
    "virtual_work": "work of the nodal forces on an affine velocity, random stress",
    "wall_moments": "moments of the weights of a body up to the walls",
    "wide_moments": "moments of the weights of domains of several cells, also behind walls",
    "domain_reach": "a domain is refused where a corner is beyond the grid, two cells behind a wall, and nowhere else",
    "far_work": "sums over the nodes and work of a body that is pressed, or dilated, far",
    "fall": "free fall and throw under a force that grows in time: x, v, F, σ",
    "throw_damped_local": "a throw with the usual local damping",
    "throw_damped_objective": "a throw with objective damping",
    "oscillator_local": "an oscillator with the usual local damping",
    "oscillator_objective": "an oscillator with objective damping",
    "budget": "kinetic and potential energy, work, damping, walls and transfer add up",
    "slide": "a body that slides along rollers keeps its velocity",
    "no_force_free": "no force, no walls: each particle keeps its velocity",
    "no_force_roller": "no force between rollers: each particle keeps its velocity",
    "no_force_fixed": "no force in a fixed box: each particle keeps its velocity",
    "reaction": "reactions of walls are the change of momentum that no other force explains",
    "pushed": "what pushed nodes carry has gone as far and as fast as they, and falls freely along them",
    "friction_slide": "a body on walls at every node goes faster by g_t - μ g_n, or slows down and sticks",
    "friction_stick": "under a tangential force of 0.99 μ g_n a body at rest does not move, to the last bit",
    "friction_leave": "a body that is torn off, or thrown off a floor, is held and strained by nothing",
    "friction_course": "a body under random forces sticks, slips, leaves, falls back and sticks again",
    "friction_damped": "a body that damping would turn into the wall stops there, and is rubbed",
    "friction_momentum": "friction takes μ times the normal momentum that a floor gives",
    "friction_budget": "energies of a body that strikes a floor with friction add up",
    "friction_mirror": "a mirrored or turned body beside two walls with friction gives the mirrored or turned answer",
    "friction_step": "a step of random v, F, σ and b in the corner of two walls with friction, against full matrices",
    "step": "a step of random v, F, σ and b beside walls, against full matrices of weights",
    "affine": "a step of a strained body in an affine velocity: x, v, F",
    "domain_motion": "corners of domains after that step",
    "edge_sums": "sum and first moment of the forces of tractions that grow, by the theorem of Gauss",
    "edge_pulled": "a stressed body that its tractions balance moves on as it is",
    "edge_driven": "the same where two of its edges are driven",
    "edge_affine": "a body whose F grows steadily, with APIC: x, v, F",
    "mirror": "a mirrored body gives the mirrored answer",
    "quarter_turn": "a body turned by 90° gives the turned answer",
    "stress": "σ, zz too, against the complex step of the energy, F without symmetry",
    "stress_turned": "the same with F turned by any angle",
    "stress_even": "the same where both stretches are the same, or nearly, and where there are none",
    "rigid_turn": "a turn of any angle turns the stress and changes no memory",
    "turned_path": "a path of strain that is turned gives the turned stress",
    "increment": "elastic stress increments, zz too, from the stated moduli",
    "constants": "shear and bulk modulus are those of E and ν",
    "wave_speed": "ρ c² is λ + 2 μ",
    "history_sums": "what the memory sums goes on from what it was",
    "plastic_volume": "plastic and void volume are what elasticity leaves",
    "plastic_shear": "plastic shear is what elasticity leaves",
    "strength": "t ≤ s sin φ + c cos φ after strains far beyond yield",
    "cut_off": "a soil that is pulled apart is at its cut-off or apex",
    "void_contact": "a step that closes a void acts from contact on, and one that does not leaves no stress",
    "return_mapping": "the stress is admissible, and plastic strain a non-negative sum of flows of what it reached",
    "return_memory": "the memory has the volume and the shear of that plastic strain",
    "secant": "strain that is no slip is elastic, with the moduli and axes of the middle of the step",
    "hardening": "slip follows the hyperbola, and t is at most the mobilised part of s",
    "flow_rule": "volume and work of the slip are those of the mean mobilised ratio",
    "neutral": "a step of no strain changes nothing, wherever on the yield surface it begins",
    "rate_path": "stress at the end of a path that stretches, shears and turns, extrapolated to steps of no length",
    "work": "work of a step is J σ : D, at its start and at its end",
    "smoothing_means": "projected values against sums by cells and nodes",
    "smoothing_constants": "constants stay",
    "smoothing_adjoint": "Σ V a P(b) = Σ V b P(a)",
    "smoothing_twice": "projected twice is projected once",
    "smoothing_parts": "only the parts that a smoothing names are projected",
    "smoothing_uniform": "a uniform strain is smoothed to itself",
    "smoothing_force": "forces at the nodes are those of the smoothed stress",
    "smoothing_refused": "a material that a smoothing does not take is refused",
    "smoothing_ratio": "F-bar has the projected volume ratio of the step",
    "restart": "a run that goes on from stored arrays gives the same bits",
    "step_limit": "1.05 of the step limit is refused, and 0.95 is not",
    "stable_step": "kinetic energy does not grow below the limit",
    "inverted_ends": "a particle that is inverted ends the step, and is named",
    "left_ends": "a particle beyond the grid ends the step",
    "any_order": "particles in any order give the same step",
    "arrays_along": "every array goes along when rows are put in another order",
    "slabs": "each slab holds its own particles",
    "deformation": "F of a uniform velocity gradient: (I + A) F, and (I + A + A²/2) F",
    "undamped": "damping by nothing is none",
}
PARTS = {
    Part.WEIGHTS: "the weights of the basis: its fill in solver/basis",
    Part.DOMAINS: "the domains of the basis: half sides, corners, convect in solver/basis",
    Part.TO_GRID: "particles to grid: scatter in solver/transfer.py, or give of the transfer",
    Part.MOTION: "the equation of motion: solve in solver/boundary.py, or the load",
    Part.TO_PARTICLES: "grid to particles: gather, deform in solver/transfer.py, advect in solver/transfers/_passes.py",
    Part.STEP: "a pass of the step: solver/step.py, solver/transfer.py, solver/transfers, or the order of passes",
    Part.SYMMETRY: "what tells x from y, or left from right: indices of the weights, walls, forces",
    Part.WALLS: "walls: solve in solver/boundary.py, the fraction of FLIP, solver/pushed.py, or solver/reaction.py",
    Part.FRICTION: "walls with friction: solver/friction.py",
    Part.DAMPING: "solver/damping.py",
    Part.STRESS: "the stress of the constitutive model: its kernel in solver/material",
    Part.RATE: "the objective rate: unrotate and rotate in solver/rates, strain increments in solver/frames.py",
    Part.HISTORY: "what the constitutive model writes to particles.history",
    Part.CUT_OFF: "the tension cut-off or the apex of the constitutive model",
    Part.SMOOTHING: "solver/smoothing",
    Part.STATE: "something that a step needs and the arrays of the particles do not hold",
    Part.BUDGET: "what moves, strains or damps the body without being counted, or solver/energy_budget.py",
    Part.ENDS: "what ends a run: solver/failure.py and who raises it",
    Part.ROWS: "rows of particles: reorder in solver/state.py, solver/slabs.py",
    Part.EDGES: "edges that are pulled or driven: solver/surface.py",
    Part.TIME_STEP: "check_time_step in solver/model.py, or the wave speed of the constitutive model",
}
REASONS = {
    Reason.BLENDS: "particles take a mean of the grid's velocities by construction",
    Reason.NEGATIVE: "the basis has negative weights by construction",
    Reason.NO_DOMAINS: "the weights are those of a point",
    Reason.NOT_FOLLOWED: "domains do not shear and turn with the body by construction",
    Reason.CUT: "the limit of the method cuts its domains",
    Reason.NO_RATE_FORM: "the stress is a function of F",
    Reason.NO_ENERGY: "the material is in rate form and has no energy",
    Reason.IN_STEPS: "the material is in rate form and has the stress of its energy after many steps alone",
    Reason.NO_MODULI: "the material states no moduli",
    Reason.STRETCHED: "the rate carries the stress by the stretch too",
    Reason.NO_FRICTION: "the material has no friction",
    Reason.NO_CUT_OFF: "the material takes any tension",
    Reason.IN_SPACE: "the yield surface is one of all three principal stresses",
    Reason.NO_SURFACES: "its yield surfaces stand in no table here",
    Reason.NO_HARDENING: "the material is not the sand whose hardening is known here",
    Reason.NO_VOID: "the material has no void strain, or holds tension",
    Reason.OPENED: "strain that opens and closes voids is neither elastic nor plastic",
    Reason.NO_SUMS: "the material keeps no such sum, or its moduli change on the way",
    Reason.OWN_AXES: "the material tells its own axes apart",
    Reason.FILTER: "through nodes and back is a filter, and no projector",
    Reason.FILTERED: "the transfer filters velocities after the reaction of walls is taken",
    Reason.BUDGET: "the budget is that of update-stress-last; what a wall gives behind a filter is told by no node",
    Reason.POINTS: "forces on the edge act through points, which balance no stress exactly",
    Reason.REFERENCE: "weights are those of the reference positions, which no particle leaves",
    Reason.OTHER_RATE: "smoothing does not take this rate",
}


ALL_HELD: Mapping[str, str] = HELD | others.HELD
ALL_PARTS: Mapping[str, str] = {str(part): text for table in (PARTS, others.PARTS) for part, text in table.items()}
ALL_REASONS: Mapping[str, str] = {
    str(reason): text for table in (REASONS, others.REASONS) for reason, text in table.items()
}
ALL_HEADINGS = HEADINGS | others.HEADINGS


def holds(n: Numbers) -> str:
    """Sentence for a battery without a miss."""
    left = f"; {n['others']:,} were not asked, each for a reason" if n["others"] else ""
    if n.get("solver"):
        return f"All {n['asked']:,} quantities of {n['runs']} runs are exact to round-off{left}."
    pairs = f"{n['runs']} pair{'s' * (n['runs'] != 1)} of method and material"
    return f"All {n['asked']:,} tests of {pairs} hold to round-off{left}."


def points(n: Numbers) -> str:
    """Sentence on a test that failed: what it holds, by how much it is missed, and what it points to."""
    size = (
        "the run ended" if n["residual"] >= FAILED else f"{n['residual']:.2g}, where round-off makes {n['bound']:.1g}"
    )
    more = f", and {n['failed'] - 1} more" if n["failed"] > 1 else ""
    return (
        f"{n['test']} ({ALL_HELD[str(n['test'])]}): {size} ({n['name']}, {n['run']}{more}). It points to "
        f"{ALL_PARTS[str(n['part'])]}."
    )


REMARKS: dict[str, Words] = {
    Code.HOLDS: holds,
    Code.FAILS: lambda n: f"{n['failed']:,} of {n['asked']:,} tests do not hold.",
    Code.POINTS: points,
    Code.ENDED: lambda n: f"{n['failed']} of {n['runs']} runs failed, and were not held.",
    Code.DIGITS: lambda n: (
        f"Numbers in the files are rounded by {n['rounding']:.1g} of their scale, and bounds are as wide; write 17 "
        "digits."
    ),
    Code.HELD: lambda n: ALL_HELD[str(n["test"])],
    Code.NOT_ASKED: lambda n: f"{n['test']}: {n['count']} times, as {ALL_REASONS[str(n['reason'])]}.",
}
