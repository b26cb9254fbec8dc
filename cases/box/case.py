"""Box of sand: a column that falls into a smooth box, and rests there with no voids, under its weight.

Sand without dilation and cohesion, 7 cells wide and 21 high, its particles shifted at random, falls from 8 cm onto the
floor of a box whose sides nothing sticks to, with a little damping. Its end is known:

    no particle is without stress, as sand at rest has no voids
    sigma_yy is the weight above, as the sides carry none
    sigma_xx = K sigma_yy with K from nu/(1 - nu), sides that do not give way, to about 0.5
    the sand has the area that it had

Sums over the rows of the grid are those of the forces, and right whatever the particles carry; single particles are
not. What is below the scale of the grid is what this case is for.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import nan
from typing import Any

from mpm_verify.cases.box.run import LOW, QUICK, ROWS, Result, Run
from mpm_verify.cases.harness.checks import Check, Unjudged, Way
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.solver.plugins import MATERIALS, METHODS, SMOOTHINGS, TRANSFERS, canonical_optional, create, label
from mpm_verify.solver.plugins import canonical as canonical_name

__all__ = ["QUICK", "Result", "Run"]

COMMAND = "box"

FREE, WEIGHT, TOP, LARGEST, MOVING = 0.05, 0.05, 0.03, 8.0, 1e-4
K, AROUND = 0.475, 0.075  # 0.40 to 0.55
CARRIED = [f"V sigma_yy over the weight above, row {k}" for k in range(1, ROWS + 1)]
SPOILT = frozenset(CARRIED[:LOW])  # by sides that carry weight; without pooling the rest fails too, and K with one seed


@dataclass(frozen=True)
class BoxAnalysis:
    """Numbers of all boxes, each beside what it is held against."""

    checks: tuple[Check, ...]


def title(runs: Sequence[Run]) -> str:
    """Title of a study of boxes."""
    return "Sand in a box, at rest" + ", failing control" * all(run.control for run in runs)


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults."""
    for key, package in {"method": METHODS, "material": MATERIALS, "transfer": TRANSFERS}.items():
        values[key] = canonical_name(package, values.get(key, getattr(Run, key)))
    values["smoothing"] = canonical_optional(SMOOTHINGS, values.get("smoothing", Run.smoothing))
    return values


def check(runs: Sequence[Run]) -> None:
    """Raise ValueError for what no box can have, by setting up a small one of each kind."""
    from mpm_verify.cases.box.execute import setup  # what computes takes a second to import

    for run in runs:
        if create(METHODS, run.method).reference:
            raise ValueError(
                f"{label(run.method)} keeps its nodes in the reference configuration, where no grain meets another; "
                "choose --method cpdi"
            )
    small = (replace(run, cells=2, ppc=4, aspect=2.0, duration=1e-2, seed=1) for run in runs)
    for kind in dict.fromkeys(small):
        setup(kind)


def examine(study: Study[Run], results: Mapping[str, Result], store: Store) -> BoxAnalysis:
    """Hold the numbers of each run against the known end."""
    done = (results[run.digest] for run in study.runs if run.digest in results)
    return BoxAnalysis(tuple(one for result in done for one in checks(study, result)))


def checks(study: Study[Run], result: Result) -> list[Check]:
    """Checks of one run."""
    group, v = named(study, result.run), result.values
    free, band = known(result.run)

    def held(name: str, key: str, expected: float, way: Way, source: str, within: float = 0.0, why: Unjudged = ""
             ) -> Check:  # fmt: skip
        return Check(group, name, v.get(key, nan), expected, way, source, within, result.failure, why)

    return [
        held("kinetic energy of the grid over m g H", "moving", MOVING, "at_most", "rest"),
        held("fraction of particles without stress", "free", FREE, "at_most", "no voids", why=free),
        *(held(name, f"weight_{k}", 1.0, "absolute", "equilibrium", WEIGHT) for k, name in enumerate(CARRIED, 1)),
        held("sigma_xx over sigma_yy below two thirds", "K_low", K, "absolute", "smooth sides at rest", AROUND, band),
        held("top over the height of the column", "top", 1.0, "absolute", "area kept", TOP, band),
        held("largest sigma_yy over its mean in the lowest row", "largest", LARGEST, "at_most", "no particle alone",
             why=band),
    ]  # fmt: skip


def known(run: Run) -> tuple[Unjudged, Unjudged]:
    """Marks of what is known of sand without cohesion, and of bands that were measured: of the usual sand, with CPDI.

    Rest and equilibrium are known of any sand.
    """
    from mpm_verify.solver.voids import remembering

    sand, usual = (remembering(create(MATERIALS, name)) for name in (run.material, Run.material))
    same = sand == usual and canonical_name(METHODS, run.method) == Run.method
    return "not_usual" if sand.cohesion else "", "" if same else "not_usual"


def named(study: Study[Run], run: Run) -> str:
    """Group of the checks of a run: what the study varies, or what it is."""
    return ", ".join(told(axis, getattr(run, axis)) for axis in study.axes) or str(run)


def told(axis: str, value: Any) -> str:
    """Value of an axis as it is typed, such as `ppc 4` or `control yes`."""
    return f"{axis} {('no', 'yes')[value] if isinstance(value, bool) else value}"
