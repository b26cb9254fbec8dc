"""`verify graded`: uniform layouts of particles against layouts that are finer where strain is expected."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mpm_verify.solver.plugins import METHODS, SOLUTIONS
from mpm_verify.verify.choices import choices, completion, integers
from mpm_verify.verify.options import common, split

if TYPE_CHECKING:
    from mpm_verify.cases.mms.graded import Plan
    from mpm_verify.reports.frames import Record


def graded(
    method: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{choices(METHODS)}; may be repeated.",
            autocompletion=completion(METHODS),
            show_default="cpdi, gimp and mpm",
        ),
    ] = None,
    solution: Annotated[
        list[str] | None,
        typer.Option(
            help=f"{choices(SOLUTIONS)}; may be repeated; on rectangles only.",
            autocompletion=completion(SOLUTIONS),
            show_default="localised and axis_aligned",
        ),
    ] = None,
    cells: Annotated[str, typer.Option(help="Cells along a side of the domain.")] = "16,32,64",
    ppc: Annotated[str, typer.Option(help="Particles per cell of the uniform layouts, square numbers.")] = "1,4,9",
    contrast: Annotated[
        float, typer.Option(help="Particles per length where strain is largest, over those where there is none.")
    ] = 2.0,
    power: Annotated[float, typer.Option(help="Exponent of the strain that particles per length follow.")] = 0.25,
    *,
    out: Path | None,
    **more: Any,
) -> int:
    """Error against cost of uniform, graded and thinned layouts. Nothing is judged: exit code 3."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.mms.graded import Plan, build_graded

        usual = Plan()
        plan = Plan(
            listed(method) or usual.methods,
            listed(solution) or usual.solutions,
            integers(cells, "--cells"),
            integers(ppc, "--ppc", "4,9"),
            contrast,
            power,
        )
        study = build_graded(plan, command(), name(plan))
    return conduct(study, Settings(named(study, out), show=show, **more))


def listed(texts: list[str] | None) -> tuple[str, ...]:
    """Names from an option that may be repeated and has several with commas, each once."""
    return tuple(dict.fromkeys(one for text in texts or () for one in split(text)))


def name(plan: "Plan") -> str:
    """Name of the study: what is not as usual in it."""
    import re
    from dataclasses import fields

    words = ["graded"]
    for item in fields(plan):
        value = getattr(plan, item.name)
        if value != item.default:
            words += [item.name, *(map(str, value) if isinstance(value, tuple) else [f"{value:g}"])]
    return re.sub(r"[^A-Za-z0-9.]+", "-", " ".join(words)).strip("-")[:120]


def show(record: "Record", page: Path | None) -> None:
    """Print errors and orders, and what graded and thinned layouts save."""
    from mpm_verify.reports.components.show_graded import OVERVIEW, WHAT, overview
    from mpm_verify.verify.terminal import table
    from mpm_verify.verify.terminal.table import bare, listened

    table.show(record, page)
    found, out = overview(record), listened(110)
    drawn = bare()
    for column in OVERVIEW:
        drawn.add_column(column, justify="left" if column in OVERVIEW[:4] else "right")
    for row in found.rows:
        drawn.add_row(*row)
    out.print(f"\n{found.caption}\n")
    out.print(drawn)
    out.print(f"\n{WHAT}")


def add(app: typer.Typer) -> None:
    """Add the command."""
    app.command("graded")(common(graded))
