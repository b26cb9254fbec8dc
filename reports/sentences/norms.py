"""Sentences on the norm as the paper prints it, which falls with the counts that it divides by."""

from collections.abc import Iterable

from mpm_verify.cases.mms.run import Run

HALVED = {  # what half the cell divides it by, and how much order that adds, by the counts that are twice as many then
    1: ("√2", "half an order"), 2: ("2", "an order"), 3: ("√8", "1.5 orders"), 4: ("4", "2 orders"),
}  # fmt: skip
COUNTED = {  # what more particles per cell divide it by, in so many dimensions
    1: ("1 → 2 → 4", "√2 and 2"), 2: ("1 → 4 → 9", "2 and 3"), 3: ("1 → 8 → 27", "√8 and √27"),
}  # fmt: skip


def printed(runs: Iterable[Run]) -> str:
    """Sentences on what a finer grid and more particles add to it.

    Half the cell has twice the particles on each axis, and twice the steps; a solver of one's own is compared in as
    many frames as before.
    """
    kinds = sorted({(run.dim, not run.solver) for run in runs})
    halved = ", ".join(
        f"by {HALVED[d + steps][0]} more than rms: it adds {HALVED[d + steps][1]} in {d}-D" for d, steps in kinds
    )
    grows = " or ".join(f"{COUNTED[d][0]} particles per cell divides it by {COUNTED[d][1]}" for d, _ in kinds)
    return (
        f"At fixed particles per cell and Courant number each halving of the cell divides printed {halved}, which the "
        f"method does not have. At a fixed grid {grows} though nothing improves."
    )
