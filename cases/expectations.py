"""What is expected of each method on each solution, registered with its source before anything runs.

Judged is u in rms with 4 and 9 particles per cell; all else is shown. An order is expected whatever the parameters of
solution and material are; non-convergence and recorded errors hold for the default parameters alone.
"""

from dataclasses import replace

from cases.records import Expectation

JUDGED = ("u", "rms")
JUDGED_PPC = (4, 9)

DIVERGES = "particles cross cells: Steffen, Kirby & Berzins 2008; measured, see ARCHITECTURE.md"
SECOND = "Sadeghirad, Brannon & Burghardt 2011; recorded table in ARCHITECTURE.md"

EXPECTED: dict[tuple[str, str], Expectation] = {
    ("cpdi", "axis_aligned"): Expectation(2.0, source=SECOND),
    ("mpm", "axis_aligned"): Expectation(None, source=DIVERGES),
    ("cpdi", "clamped_shear"): Expectation(2.0, source="Sadeghirad, Brannon & Burghardt 2011"),
    ("mpm", "clamped_shear"): Expectation(None, source=DIVERGES),
}

# recorded errors of u in rms: (method, solution, ppc) -> (h, error), table in ARCHITECTURE.md
RECORDED = {
    ("cpdi", "axis_aligned", 4): (1 / 128, 1.127e-5),
    ("cpdi", "axis_aligned", 9): (1 / 128, 1.066e-5),
}


def expected(
    method: str, solution: str, material: str, ppc: int, quantity: str, norm: str, usual: bool = True
) -> Expectation | None:
    """The registered expectation, for canonical specifications; None where there is none: only shown.

    `usual` says that the scheme is the one whose errors are recorded.
    """
    name, law = solution.partition(":")[0], material.partition(":")[0]
    expectation = EXPECTED.get((method, name))
    if expectation is None or (quantity, norm) != JUDGED or ppc not in JUDGED_PPC or law != "neo_hookean":
        return None
    if (name, law) != (solution, material):  # parameters of one's own
        return None if expectation.order is None else expectation
    h, error = RECORDED.get((method, solution, ppc), (None, None)) if usual else (None, None)
    return replace(expectation, constant_h=h, constant=error)
