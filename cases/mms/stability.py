"""Time steps of a study against the stability limit of the solver, before anything runs."""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from math import ceil, floor, log10
from typing import Any

import numpy as np

from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.discretisation import dimension, time_steps, width
from mpm_verify.mms.duration import lasting
from mpm_verify.mms.manufacture import Manufactured
from mpm_verify.mms.solutions._own import sides
from mpm_verify.solver.plugins import (
    MATERIALS,
    METHODS,
    SOLUTIONS,
    create,
    is_file,
    label,
    load,
    parameters_of,
    split,
)
from mpm_verify.solver.surface import DRIVEN_STEP

CELLS, TIMES = 32, 9  # where and when the velocity at the start is looked at
SLACK = 1e-3  # of that velocity: particles lie elsewhere
MOST_STEPS = 10_000_000
LEAST_COURANT = 1e-3
STIFF = 20.0  # bulk over shear modulus of what is nearly incompressible
NEARLY = (
    0.7  # of the limit, with which hat functions are stable there; from 0.83 on they are not, see docs/materials.md
)


def check_time_steps(runs: Sequence[Run], courants: Sequence[float]) -> None:
    """Raise ValueError, with what to type, where a run takes a step above the stable one: dt > dx / (c + |v|).

    With driven edges the stable step is a fraction of that, and of hat functions in what is nearly incompressible.

    The runs are of one solution in one material over one duration; `courants` are those that were asked for, the
    largest last. What passes here also runs: |v| is the largest over the body in the half step before the start.
    """
    specification, model = runs[0].solution, runs[0].material
    solution, material = lasting(create(SOLUTIONS, specification), runs[0].periods), create(MATERIALS, model)
    steps = {
        (run.cells, run.courant_number): time_steps(
            solution, width(solution) / run.cells, run.courant_number, run.whole_steps, run.turns
        )
        for run in runs
    }
    longest = max(count for count, _ in steps.values())
    if longest > MOST_STEPS:
        raise ValueError(
            f"{label(specification)}: a run would take {longest:.2g} time steps to fill the duration of "
            f"{solution.duration:g}; take a shorter duration or a lower reference speed"
        )
    lag = 0.5 * max(dt for _, dt in steps.values())
    c, v = float(material.wave_speed()), fastest(solution, manufactured(specification, model), lag)
    part = DRIVEN_STEP if "prescribed" in sides(solution) else 1.0  # of the usual limit
    stiff = any(noisy(run) for run in runs)
    allowed = part * (NEARLY if stiff and not any(run.whole_steps for run in runs) else 1.0)
    if any(dt * (c + v) > allowed * width(solution) / cells for (cells, _), (_, dt) in steps.items()):
        if numbers := [run.courant_number for run in runs if run.whole_steps]:
            raise ValueError(printed(specification, numbers, part * float(solution.C) / (c + v)))
        most = max(run.courant_number / run.courant for run in runs)  # not 1 where dt has a path of its own
        raise ValueError(refusal(specification, solution, c, v, courants, most, part, stiff))


def noisy(run: Run) -> bool:
    """Whether noise grows in a run at less than the limit: of hat functions, over the many steps of fast waves."""
    if run.solver or run.stiffness <= STIFF:
        return False
    basis = load(METHODS, run.method)
    return bool(basis.domain_size or basis.gradients_jump)


def fastest(solution: Any, exact: Manufactured, lag: float) -> float:
    """Largest speed of the body over the times from -lag to 0, sampled, with some slack."""
    if (d := dimension(solution)) == 2:
        X = solution.layout(width(solution) / CELLS, 4).corners.reshape(-1, 2)
        most = max(float(np.hypot(*exact.v(X, time).T).max()) for time in np.linspace(-lag, 0.0, TIMES))
    else:
        X = solution.layout((4 if d == 3 else 1) * width(solution) / CELLS, 2**d).X
        most = max(float(np.linalg.norm(exact.v(X, time), axis=1).max()) for time in np.linspace(-lag, 0.0, TIMES))
    return most * (1 + SLACK)


def refusal(
    specification: str,
    solution: Any,
    c: float,
    v: float,
    courants: Sequence[float],
    longest: float = 1.0,
    part: float = 1.0,
    stiff: bool = False,
) -> str:
    """Line with the largest Courant number at this speed and the least speed at this number, as they are typed.

    `longest` is C dt / dx of the longest step over the Courant number, `part` the stable step over dx / (c + |v|);
    `stiff` says that the material is nearly incompressible, where a smaller step is typed.
    """
    C, courant = float(solution.C) / longest, courants[-1]
    limit = rounded(part * C / (c + v), floor)
    part *= NEARLY if stiff else 1.0
    largest = rounded(part * C / (c + v), floor)
    nearly = f", and nearly incompressible it was seen stable up to {largest:g}" if stiff else ""
    above = f"above the stability limit of {limit:g}{nearly}"
    if stiff and courant <= limit:
        above = f"below the stability limit of {limit:g}{nearly}: noise of the particles grows beyond"
    ways = []
    if largest >= LEAST_COURANT:
        typed = [largest, *(other for other in reversed(courants[:-1]) if other < largest)]
        ways.append(f"--courant {','.join(f'{one:g}' for one in typed)}")
    name, least = speed_parameter(solution), courant * (c + v) / part
    if name and courant * v < part * C:  # the body moves faster with it, at most in proportion
        least = max(least, courant * c / (part - courant * v / C))
    faster = rounded(least, ceil)
    if name:
        file, given = split(specification)
        others = [item for item in given.split(",") if item and not item.startswith(f"{name}=")]
        ways.append(f"--solution {shlex.quote(f'{file}:' + ','.join([*others, f'{name}={faster:g}']))}")
    elif is_file(specification):
        ways.append(f'"speed": {faster:g} in domain()')
    return (
        f"{label(specification)}: with waves at {c:.4g}, the body at {v:.3g} and a reference speed of {C:g}, a "
        f"Courant number of {courant:g} is {above}; the speed would have to be "
        f"{faster:g} or more; take {', or '.join(ways)}; --force runs it all the same"
    )


def printed(specification: str, numbers: Sequence[float], largest: float) -> str:
    """Line on the time step that the paper prints: no Courant number is near to it."""
    return (
        f"{label(specification)}: the printed time step is a Courant number of {min(numbers):.3g} to "
        f"{max(numbers):.3g}, above the stability limit of {rounded(largest, floor):g}; take --time-step h, or see it "
        "fail with --force"
    )


def speed_parameter(solution: Any) -> str:
    """Parameter that is the reference speed, as it is typed; empty where none is."""
    for name, field in parameters_of(solution).items():
        if getattr(solution, field.name) == solution.C:
            try:
                if replace(solution, **{field.name: 2 * solution.C}).C == 2 * solution.C:
                    return name
            except ValueError:
                continue
    return ""


def rounded(value: float, way: Any) -> float:
    """Value rounded to three digits, down or up."""
    unit = 10.0 ** (floor(log10(value)) - 2)
    return float(f"{way(value / unit) * unit:.3g}")
