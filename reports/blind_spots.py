"""What a study cannot see, by the name of its solution.

Source: measured with planted defects, of which tests/test_defects.py holds some.
"""

DIAGONAL = (
    "F is diagonal everywhere, so shear, rotation and transposes are invisible: domain vectors moved by the transpose "
    "of F, a dropped shear stress, F (I + dt L) in the wrong order, L transposed, FᵀF in place of F Fᵀ, "
    "a wrong shear sign. The solution clamped_shear sees these."
)
STARTS_AT_REST = (
    "The acceleration is zero at the start, so a missing half-step start is invisible. A phase in axis_aligned, "
    "or the solution clamped_shear, sees it."
)
SMALL = (
    "At so small an amplitude ln J cannot be told from J \N{MINUS SIGN} 1, nor the initial volume from the present one."
)
CLAMPED = ("The boundary does not move: a wall along which particles slide takes no part.",)
UNIFORM = (
    "F is the same everywhere: the stress has no gradient, so what depends on one is invisible.",
    "The edge is prescribed on nodes of cells that the body does not fill, a set that changes by whole cells.",
)
ALWAYS = (
    (
        "Orders alone let defects pass. In a probe apart from this program, of 46 defects planted in a CPDI code, "
        "the order of the displacement caught 33, the orders of all quantities 36, and all checks together, "
        "exactness and physics among them, 44."
    ),
    "A wrong constant leaves the order as it is; only a recorded magnitude sees it.",
)


def parameters(solution: str) -> tuple[str, dict[str, float]]:
    """Name and numbers of a specification such as `axis_aligned:A=0.01,phase=0.5`; what is no number is left out."""
    name, _, rest = solution.partition(":")
    pairs = [part.partition("=") for part in rest.split(",") if part]
    numbers = {}
    for key, _, value in pairs:
        try:
            numbers[key.strip()] = float(value)
        except ValueError:
            continue
    return name, numbers


def blind_spots(solution: str) -> list[str]:
    """Sentences on what a study of this solution cannot see; what holds for every solution comes last."""
    name, given = parameters(solution)
    found: list[str] = []
    if name == "axis_aligned":
        found.append(DIAGONAL)
        if given.get("phase", 0.0) == 0.0:
            found.append(STARTS_AT_REST)
    elif name == "clamped_shear":
        found.extend(CLAMPED)
    elif name == "affine":
        found.extend(UNIFORM)
    if any(abs(given.get(size, 1.0)) <= 1e-3 for size in ("A", "G")):
        found.append(SMALL)
    return [*found, *ALWAYS]
