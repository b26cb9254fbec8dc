"""Registry of what is expected of Hencky solids: recorded errors, and the limit of a rate that has no energy.

With the logarithmic rate, and with Truesdell's at nu = 0, the material in rate form is the one of its energy: the order
is the method's. A negative control claims the same, and is to be refused. Green-Naghdi and Jaumann agree with the
logarithmic rate where nothing turns, and converge to another solution elsewhere: a stall, with its errors recorded.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from mpm_verify.cases.judging.records import Expectation, Recorded
from mpm_verify.cases.mms.recorded import Row, read, refinement
from mpm_verify.cases.mms.run import TURNING, Run, strays_on
from mpm_verify.solver.plugins import (
    MATERIALS,
    NEGATIVE_CONTROLS,
    SOLUTIONS,
    available,
    canonical,
    create,
    split,
)

TABLE = Path(__file__).with_name("recorded_rates.csv")
HEAD = ("material", "solution", "method", "ppc", "cells")  # fields of a run that a row of the table is of
SHEARED = "clamped_shear:G=0.1"  # shears so far that rates differ by more than grids of 24 cells and more err
SLIGHT = "clamped_shear:G=0.01"  # Truesdell's is another solid by so much that on larger shears no order falls
METHOD, PPC = "cpdi", 4
CELLS = (8, 12, 16, 24, 32, 48)
CONVECTED = "truesdell"
WITHIN = 0.01  # relative distance from a recorded error, as of the others
STALL, STALL_H = 1.8, 1 / 32  # local order that the limit of another rate keeps below, from these cells on
SOURCE = "measured, see docs/materials.md"


def runs() -> Iterator[Run]:
    """Runs of the table."""
    asked = [("hencky", one, 32) for one in ("axis_aligned", "clamped_shear", "swirl")]
    asked += [("hencky_rate", one, 32) for one in ("clamped_shear", "swirl")] + [("hencky_rate", SHEARED, 48)]
    asked += [(f"hencky_rate:rate={rate}", SHEARED, 48) for rate in TURNING]
    asked += [(f"hencky_rate:rate={CONVECTED}", SLIGHT, 32), (f"hencky_rate:rate={CONVECTED},nu=0", "swirl", 32)]
    for material, solution, most in asked:
        names = canonical(SOLUTIONS, solution), canonical(MATERIALS, material)
        yield from (Run(METHOD, *names, cells, PPC) for cells in CELLS if cells <= most)


def expected_of(
    expectation: Expectation | None, method: str, solution: str, material: str, ppc: int, quantity: str, usual: bool
) -> Expectation | None:
    """Expectation of a Hencky solid, from what is registered of a neo-Hookean one; recorded errors where `usual`."""
    model: Any = create(MATERIALS, material)
    if model.rate in available(NEGATIVE_CONTROLS):
        material = claimed(material)
    elif strays_on(model, solution):
        return limit(method, solution, material, ppc, quantity) if usual else None
    known = recorded(material, solution, method, ppc, quantity) if usual and expectation else ()
    return replace(expectation, recorded=known, within=WITHIN) if expectation and known else expectation


def strays(material: str) -> bool:
    """Whether a material is another solid than the one of its energy, by its rate."""
    return bool(getattr(create(MATERIALS, material), "strays", False))


def claimed(material: str) -> str:
    """Material that a negative control is taken for: the same with the usual rate."""
    name, given = split(material)
    return canonical(MATERIALS, f"{name}:{','.join(one for one in given.split(',') if not one.startswith('rate='))}")


def limit(method: str, solution: str, material: str, ppc: int, quantity: str) -> Expectation | None:
    """Stall of u on the limit of a rate, where its errors are recorded."""
    known = recorded(material, solution, method, ppc, quantity)
    if quantity != "u" or not known:
        return None
    return Expectation(None, stall=STALL, stall_h=STALL_H, recorded=known, within=WITHIN, source=SOURCE)


def recorded(material: str, solution: str, method: str, ppc: int, quantity: str) -> tuple[Recorded, ...]:
    """Recorded errors of a refinement, coarse to fine."""
    return refinement(table().get((material, solution, method, str(ppc)), ()), quantity)


def table() -> Mapping[tuple[str, ...], list[Row]]:
    """Rows of recorded_rates.csv by material, solution, method and particles per cell."""
    return read(TABLE, "material", "solution", "method", "ppc")
