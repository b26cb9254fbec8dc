"""`verify material NAME`: element tests of a constitutive model without a grid, beside closed forms and tables."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.cases.element.axes import AXES, PATH, PROPERTIES, ElementRun
from mpm_verify.solver.plugins import MATERIALS
from mpm_verify.verify.choices import choices, completion
from mpm_verify.verify.options import study_command, values

Names = Annotated[
    list[str],
    typer.Argument(
        metavar="NAME",
        help=f"{choices(MATERIALS)}, with parameters as mohr_coulomb:phi=35,psi=5; several with spaces.",
        autocompletion=completion(MATERIALS),
    ),
]


def material(name: list[str], asked: dict[str, list[str]], out: Path | None, **more: Any) -> int:
    """Drive one element of a material through compression and shear: curves, errors, orders, known values."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.harness.build import Asked, union

        given: dict[str, Any] = values(ElementRun, asked) | {"material": name}
        parts = []
        own: dict[str, Any] = {key: given.pop(key) for key in ("path", "units") if key in given}
        if "units" in own and "path" not in own:
            raise ValueError("--units belongs to --path FILE.csv")
        if "test" in given or not own:
            tests = [*given.get("test", AXES["test"]), PROPERTIES]
            parts.append(Asked("element", {**given, "test": tests}))
        if own:
            parts.append(Asked("element", {**given, **own, "test": [PATH]}))
            parts.append(Asked("element", {**given, "test": [PROPERTIES]}))
        shown = "-".join(["material", *(Path(one).stem if one.endswith(".py") else one for one in name)])
        study = union(parts, command(), shown.replace(":", "-").replace(",", "-").replace("/", "-"))
    return conduct(study, Settings(named(study, out), **more))


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    study_command(app, "material", ElementRun, material, AXES, {"name": (Names, ...)}, leave_out=("material",))
