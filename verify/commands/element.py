"""`verify material NAME`: element tests of a law without a grid, beside closed forms and tables."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpm_verify.solver.plugins import MATERIALS, label
from mpm_verify.verify.options.choices import choices, completion
from mpm_verify.verify.options.common import Json, Junit

if TYPE_CHECKING:
    from mpm_verify.cases.element.paths import ElementTest

CONFINED = 5e3  # the scale of the paper's column


def material(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME",
            help=f"{choices(MATERIALS, own=True)}, with parameters as mohr_coulomb:phi=35,psi=5.",
            autocompletion=completion(MATERIALS),
        ),
    ],
    test: Annotated[
        list[str] | None,
        typer.Option(
            help="isotropic, oedometric, biaxial, constant_s, shear_stress, shear_volume, undrained, cyclic_shear; "
            "may be repeated.",
            show_default="all",
        ),
    ] = None,
    path: Annotated[
        Path | None, typer.Option(help="CSV file with a strain path: columns exx, eyy and exy, or gxy = 2 exy.")
    ] = None,
    stress: Annotated[
        float | None,
        typer.Option(help="Isotropic stress at the start, compression positive.", show_default="5000"),
    ] = None,
    steps: Annotated[int, typer.Option(help="Of the coarsest run; the finest has sixteen times as many.")] = 100,
    out: Annotated[
        Path | None, typer.Option(help="Folder of the result.", show_default="results/material-NAME")
    ] = None,
    json_output: Json = False,
    junit: Junit = None,
) -> int:
    """Drive one element of a law through compression and shear: curves, errors, orders, tables of known values."""
    from mpm_verify.verify.conduct import usage

    with usage():
        from mpm_verify.solver.plugins import create

        law = create(MATERIALS, name)
        tests = chosen(test, path)
        confined = confining(law, stress)
        if not 1 <= steps <= 10_000:
            raise ValueError("--steps takes whole numbers from 1 to 10000")
        from mpm_verify.cases.element.exam import examine
        from mpm_verify.reports.pages.element import page
        from mpm_verify.verify.examine import conduct

    command = "verify " + shlex.join(sys.argv[1:])
    folder = out or Path("results") / f"material-{label(name).replace(':', '-').replace(',', '-').replace('/', '-')}"
    return conduct(lambda: examine(name, law, tests, confined, steps, command), page, folder, json_output, junit)


def chosen(names: list[str] | None, path: Path | None) -> "list[ElementTest]":
    """The tests that are asked for; a path alone is the only one. Raises ValueError."""
    from mpm_verify.cases.element.path_file import from_file
    from mpm_verify.cases.element.paths import TESTS

    for name in names or ():
        if name not in TESTS:
            raise ValueError(f"no test {name!r}; choose from {', '.join(TESTS)}")
    own = [from_file(path)] if path else []
    return [TESTS[name] for name in dict.fromkeys(names or (() if path else TESTS))] + own


def confining(law: Any, stress: float | None) -> float:
    """The stress at the start. Raises ValueError for one that no test can start from."""
    from math import isfinite

    if stress is None:
        return CONFINED
    if hasattr(law, "energy"):
        raise ValueError("--stress: a law of F starts undeformed; give it to a law in rate form")
    if not (isfinite(stress) and stress > 0):
        raise ValueError(f"--stress {stress:g} must be above zero and finite: compression is positive")
    return stress
