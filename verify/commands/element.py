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
        own: dict[str, Any] = {key: given.pop(key) for key in ("path", "units", "motion") if key in given}
        for key in ("units", "motion"):
            if key in own and "path" not in own:
                raise ValueError(f"--{key} belongs to --path FILE.csv")
        if "test" in given:
            parts.append(Asked("element", {**given, "test": [*given["test"], PROPERTIES]}))
        elif not own:
            parts.append(Asked("element", given))
        for mine in with_motion(own, rated(name)) if own else []:
            parts.append(Asked("element", {**given, **mine, "test": [PATH]}))
        if own:
            parts.append(Asked("element", {**given, "test": [PROPERTIES]}))
        shown = "-".join(["material", *(Path(one).stem if one.endswith(".py") else one for one in name)])
        study = union(parts, command(), shown.replace(":", "-").replace(",", "-").replace("/", "-"))
    return conduct(study, Settings(named(study, out), **more))


def rated(names: list[str]) -> bool:
    """Whether a material is given its objective rate, which strains in its own axes would leave without effect."""
    from mpm_verify.solver.plugins import split

    return any(item.startswith("rate=") for name in names for item in split(name)[1].split(","))


def with_motion(own: dict[str, Any], rate: bool) -> list[dict[str, Any]]:
    """Values of path, units and motion: where a rate is given, shear strains are a motion unless another is asked."""
    if "motion" in own or not rate:
        return [own]
    from mpm_verify.cases.element.path_file import from_file

    units = own.get("units", [""])[0]
    turning: list[str] = []
    rest: list[str] = []
    for path in own["path"]:
        test = from_file(Path(path), units)
        sheared = not test.motion and not test.mixed and bool(test.points[:, 2].any())
        (turning if sheared else rest).append(path)
    both = [{**own, "path": turning, "motion": ["simple_shear"]}] * bool(turning)
    return both + [{**own, "path": rest}] * bool(rest)


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    study_command(app, "material", ElementRun, material, AXES, {"name": (Names, ...)}, leave_out=("material",))
