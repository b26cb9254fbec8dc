"""The MMS convergence case: a manufactured solution run on one grid, with the errors of u, v, F and sigma.

The contract of a case is told in cases/harness/contract.py.
"""

import shlex
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from mpm_verify.cases.harness.build import Asked
from mpm_verify.cases.judging.records import Expectation
from mpm_verify.cases.mms.expectations import JUDGED_QUANTITY, expected
from mpm_verify.cases.mms.run import AXES, LINE, NORMS, QUANTITIES, QUICK, SOLID, Result, Run
from mpm_verify.cases.mms.stability import check_time_steps
from mpm_verify.cases.mms.variants import axes, timed_as_usual, variant
from mpm_verify.cases.solvers import column_map
from mpm_verify.cases.solvers.command import PYTHON, program
from mpm_verify.cases.solvers.naming import method_of, version_of
from mpm_verify.mms.cells import fitting, ratios, unit
from mpm_verify.mms.discretisation import axisymmetric, dimension
from mpm_verify.mms.duration import lasting
from mpm_verify.mms.edges import OPEN
from mpm_verify.mms.energy import check_energy
from mpm_verify.mms.solutions._own import sides
from mpm_verify.solver.layout import per_side
from mpm_verify.solver.plugins import (
    LAYOUTS,
    MATERIALS,
    METHODS,
    SMOOTHINGS,
    SOLUTIONS,
    TRANSFERS,
    available,
    canonical_optional,
    create,
    is_file,
    label,
    load,
    split,
)
from mpm_verify.solver.plugins import canonical as canonical_name
from mpm_verify.solver.stress_update import check_stress_update

__all__ = ["AXES", "JUDGED", "NORMS", "QUANTITIES", "QUICK", "Result", "Run"]

COMMAND = "mms"

JUDGED = (JUDGED_QUANTITY,)
REFUTES = tuple((quantity, "rms") for quantity in ("v", "F", "sigma"))
OURS = (  # fields that a solver of somebody else does not take
    "transfer", "stress", "layout", "staggered", "offset", "damping", "manufacture", "smoothing"
)  # fmt: skip
ALONE = ("start", "columns", "precision")  # and fields that the reference solver does not take
THEIRS = {"cells": (8, 16, 32, 64), "ppc": (4,)}  # values that nobody asks for of such a solver
NAMED = ("periods", "damping", "manufacture", "smoothing", "time_step")  # axes that a title tells
SCHEME = {"transfer": "flip", "stress": "usl", "layout": "uniform"}  # the one that expectations are registered for


def title(runs: Sequence[Run]) -> str:
    """Title, such as `CPDI and MPM against the manufactured solution axis_aligned`."""
    methods, solutions = (tuple(dict.fromkeys(getattr(run, key) for run in runs)) for key in ("method", "solution"))
    if any(run.solver for run in runs):
        programs = dict.fromkeys(program(run.solver) for run in runs)
        named = " and ".join(programs)
        return f"{named} against the manufactured solution {', '.join(map(label, solutions))}{beside(runs)}"
    words = [label(method) if is_file(method) else method.upper() for method in methods]
    named = " and ".join(words) if len(words) < 4 else f"{len(words)} methods"
    several = "solutions" if len(solutions) > 1 else "solution"
    return f"{named} against the manufactured {several} {', '.join(map(label, solutions))}{beside(runs)}"


def beside(runs: Sequence[Run]) -> str:
    """Values of the axes of the title that all runs have and that are not usual: `, damping 0.05`."""
    found = {name: {getattr(run, name) for run in runs} for name in NAMED}
    return "".join(f", {name.replace('_', ' ')} {values.pop()}" for name, values in found.items()
                   if len(values) == 1 and values != {getattr(Run, name)})  # fmt: skip


def canonical(values: dict[str, Any]) -> dict[str, Any]:
    """Specifications with only the parameters that differ from their defaults, and the solution's own material."""
    solution = in_precision(values.get("solution", Run.solution), values.get("precision", Run.precision))
    values["solution"] = solution
    values.setdefault("dim", dimension(create(SOLUTIONS, solution)))
    check_dimension(solution, values["dim"])
    values["material"] = canonical_name(MATERIALS, values.get("material") or create(SOLUTIONS, solution).material)
    values["transfer"] = canonical_name(TRANSFERS, values.get("transfer", Run.transfer))
    values["layout"] = canonical_name(LAYOUTS, values.get("layout", Run.layout))
    values["smoothing"] = canonical_optional(SMOOTHINGS, values.get("smoothing", Run.smoothing))
    if values.get("columns"):
        values["columns"] = column_map.read(values["columns"])
    if values.get("solver"):
        values["solver_version"] = values.get("solver_version") or version_of(values["solver"])
    if values.get("solver") and "method" not in values:
        values["method"] = method_of(values["solver"])
    else:
        values["method"] = canonical_name(METHODS, values.get("method", Run.method))
    check_stress_update(values.get("stress", Run.stress))
    offset = values.get("offset", Run.offset)
    if not all(-0.5 < part < 0.5 for part in offset):
        raise ValueError(f"offset = {offset} shifts particles by fractions of their spacing: choose -0.49 to 0.49 each")
    return values


def check_dimension(solution: str, dim: int) -> None:
    """Raise ValueError for dimensions that a solution cannot have: it has its own, or three where it is plane."""
    plugin = create(SOLUTIONS, solution)
    own, around = dimension(plugin), axisymmetric(plugin)
    if dim not in (1, 2, 3) or dim == own or (own, dim, around) == (2, 3, False):
        return
    what = "is axisymmetric" if around else f"has {('one', 'two', 'three')[own - 1]} dimension{'s' * (own > 1)}"
    others = f"take {' or '.join(of_dimension(dim))}" if own == 2 and dim == 1 else "leave it out"
    raise ValueError(f"{label(solution)} {what}, dim = {dim} cannot be; {others}")


def of_dimension(count: int) -> list[str]:
    """Solutions of so many dimensions."""
    return [name for name in available(SOLUTIONS) if getattr(load(SOLUTIONS, name), "coordinates", 2) == count]


def in_precision(solution: str, precision: str) -> str:
    """Canonical specification of a solution, with the parameters of single precision where none are given.

    There they are always stated: a default amplitude that was asked for stays it.
    """
    name, given = split(solution)
    usual = {} if precision != "single" or is_file(name) else getattr(load(SOLUTIONS, name), "in_single", {})
    named = {item.partition("=")[0].strip() for item in given.split(",")}
    items = [*filter(None, [given]), *(f"{key}={value:g}" for key, value in usual.items() if key not in named)]
    short = canonical_name(SOLUTIONS, ":".join(filter(None, [name, ",".join(items)])))
    left = [f"{key}={getattr(create(SOLUTIONS, short), key):g}" for key in usual if f"{key}=" not in short]
    return f"{short}{',' if ':' in short else ':'}{','.join(left)}" if left else short


def check(runs: Sequence[Run]) -> None:
    """Raise ValueError with one line for a solution, material or layout that cannot be run."""
    check_theirs([run for run in runs if run.solver])
    for name in ALONE:
        if any(getattr(run, name) != getattr(Run, name) and not run.solver for run in runs):
            raise ValueError(f"--{name} is for a solver of your own; give --solver too")
    if any(run.columns and run.solver.startswith(PYTHON) for run in runs):
        raise ValueError("--columns is for files; a Python function returns arrays by our names")
    check_ours([run for run in runs if not run.solver])
    check_solutions(runs)


def check_ours(runs: Sequence[Run]) -> None:
    """Raise ValueError for what the reference solver does not have: other dimensions, a smoothing of the material."""
    inside = [run for run in runs if run.manufacture != "none"]
    if inside and not any(run.damping for run in inside):
        raise ValueError("manufacture = 'damping' has no damping to put into the problem; give --damping 0.05 too")
    for smoothing, material in dict.fromkeys((run.smoothing, run.material) for run in runs):
        if smoothing != "none":
            create(SMOOTHINGS, smoothing).check(create(MATERIALS, material))
    check_shifted(runs)
    for run in runs:
        plugin = create(SOLUTIONS, run.solution)
        state = {1: "has one dimension", 3: "has three dimensions"}.get(run.dim, "is axisymmetric")
        if run.dim != 2 or axisymmetric(plugin):
            what = f"--solution {shlex.quote(run.solution)}" + " --dim 3" * (dimension(plugin) == 2 < run.dim)
            has = "is in plane strain" if run.dim == 2 else "has two"
            raise ValueError(
                f"{label(run.solution)} {state} and is for a solver of your own, the reference solver {has}: "
                f"verify mms --solver './mine {{case}} {{out}}' {what}"
            )


def check_shifted(runs: Sequence[Run]) -> None:
    """Raise ValueError for shifted particles of a reference configuration in a body that is pulled or driven.

    Domains that faces of cells cut leave a force at the nodes of the edge, the same in each step: it does not converge.
    """
    for run in runs:
        open_ = set(OPEN) & set(sides(create(SOLUTIONS, run.solution))) if any(run.offset) else ()
        if open_ and load(METHODS, run.method).reference:
            raise ValueError(
                f"{run.method} with shifted particles does not converge beside edges that are "
                f"{' or '.join(sorted(open_))}; leave --offset and --replicates out, or take another method"
            )


def check_solutions(runs: Sequence[Run]) -> None:
    """Raise ValueError with one line for a solution, material or layout that no solver can run."""
    cells: dict[tuple[str, str, str, float], set[int]] = {}
    for run in runs:
        cells.setdefault((run.solution, run.material, run.layout, run.periods), set()).add(run.cells)
    for (specification, model, layout, periods), counts in cells.items():
        solution, material = lasting(create(SOLUTIONS, specification), periods), create(MATERIALS, model)
        for run in (run for run in runs if run.solution == specification):
            per_side(run.ppc, dimension(solution))
        check_energy(material)
        create(LAYOUTS, layout).check(solution)
        if is_file(specification):
            from mpm_verify.mms.check import check as check_solution  # derives the fields: some tenths of a second

            check_solution(solution, material, tuple(sorted(counts)))
        of = specification, model, periods
        mine = [run for run in runs if (run.solution, run.material, run.periods) == of and not run.force]
        if mine:
            check_time_steps(mine, sorted({run.courant for run in mine}))


def check_theirs(runs: Sequence[Run]) -> None:
    """Raise ValueError for what a solver of somebody else is not asked for."""
    for name in OURS:
        if any(getattr(run, name) != getattr(Run, name) for run in runs):
            option = name.replace("_", "-")
            raise ValueError(f"--{option} is for the reference solver; leave it out beside --solver")


def parts(asked: Asked) -> list[Asked]:
    """Parts of the request, with cells that fill the body of each solution, where no cells were asked for."""
    theirs = any(asked.values.get("solver", ()))  # each run of it takes as long as it takes: one solution
    several = QUICK["solution"] if asked.quick and not theirs else (Run.solution,)
    asked = replace(asked, values={"solution": several, **asked.values})
    solutions = asked.values["solution"]
    if len(set(asked.values.get("start", ()))) > 1:  # a search for the one that fits
        asked = replace(asked, values={**asked.values, "order": (0.0,)})
    for count, usual in ((3, SOLID), (1, LINE)):
        others = [one for one in solutions if dimension(create(SOLUTIONS, one)) == count]
        if others:
            left = tuple(one for one in solutions if one not in others)
            rest = parts(replace(asked, values={**asked.values, "solution": left})) if left else []
            return [*rest, replace(asked, values={**usual, **asked.values, "solution": tuple(others)})]
    if any(asked.values.get("solver", ())) and not asked.quick:
        asked = replace(asked, values={**THEIRS, **asked.values})
    if "cells" in asked.values or not any(is_file(one) for one in solutions):
        return [asked]
    counts = (QUICK if asked.quick else AXES)["cells"]
    return [
        replace(asked, values={**asked.values, "solution": (one,), "cells": fitting(create(SOLUTIONS, one), counts)})
        for one in solutions
    ]


def multiple(run: Run) -> int:
    """Number of cells of the width whose multiples fill the body; 1 for those of this package, which are square."""
    sides = ratios(create(SOLUTIONS, run.solution)) if is_file(run.solution) else None
    return unit(sides) if sides else 1


def expectation(run: Run, quantity: str, norm: str) -> Expectation | None:
    """Registered expectation, of the usual scheme alone; recorded errors hold for the usual time step and start."""
    if run.order:
        return declared(run.order, quantity, norm, " along dt ~ h2" * run.tied)
    if run.start or any(getattr(run, name) != usual for name, usual in SCHEME.items()):
        return None
    beside = axes(run)
    usual = timed_as_usual(run) and run.offset == Run.offset and not beside
    plain = expected(run.method, run.solution, run.material, run.ppc, quantity, norm, usual, bool(run.solver))
    return variant(run, quantity, norm, plain) if beside else plain


def declared(order: float, quantity: str, norm: str, path: str = "") -> Expectation | None:
    """Expectation of u that --order gives. Of v, F and sigma that they converge: with half that order, at its least."""
    if (quantity, norm) in JUDGED:
        return Expectation(order, source=f"given with --order{path}")
    if (quantity, norm) in REFUTES:
        return Expectation(order / 2, below=order / 4, above=order, source="converges, beside --order")
    return None
