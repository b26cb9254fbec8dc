"""`verify rates`: simple shear of F to 5 by each objective rate, against its closed form, with errors and orders."""

from dataclasses import fields
from pathlib import Path
from typing import Any

import typer

from mpm_verify.cases.element.axes import MOTION_TESTS, ElementRun
from mpm_verify.solver.plugins import RATES, available
from mpm_verify.verify.options import study_command, values

SOLID = "hypoelastic:E=2.6,rate="  # G = 1 with nu = 0.3


def rates(asked: dict[str, list[str]], out: Path | None, **more: Any) -> int:
    """Shear an elastic solid to 5 by each objective rate: one page of four closed forms, errors and orders."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.harness.build import Asked, build

        shear = {"material": [SOLID + rate for rate in available(RATES)], "test": [*MOTION_TESTS], "start": ["none"]}
        title = "Objective rates in simple shear"
        study = build(Asked("element", {**shear, **values(ElementRun, asked)}), command(), "rates", title)
    return conduct(study, Settings(named(study, out), **more))


def add(app: typer.Typer) -> None:
    """Add the command, with the option for the number of steps."""
    others = tuple(item.name for item in fields(ElementRun) if item.name != "steps")
    study_command(app, "rates", ElementRun, rates, {}, leave_out=others)
