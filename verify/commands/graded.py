"""`verify graded`: uniform layouts of particles against layouts that are finer where strain is expected."""

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mpm_verify.solver.plugins import METHODS, SOLUTIONS
from mpm_verify.verify.commands.mms import repeatable
from mpm_verify.verify.options.choices import choices, completion, integers
from mpm_verify.verify.options.common import Jobs, Json, check_count

if TYPE_CHECKING:
    from mpm_verify.cases.mms.graded import Plan


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
    power: Annotated[float, typer.Option(help="Of the strain that particles per length follow.")] = 0.25,
    jobs: Jobs = None,
    out: Annotated[Path | None, typer.Option(help="Study folder.", show_default="results/graded")] = None,
    json_output: Json = False,
) -> int:
    """Error against cost of uniform, graded and thinned layouts. Nothing is judged: exit code 3."""
    from mpm_verify.verify.conduct import Settings, conduct, usage

    with usage():
        from mpm_verify.cases.mms.graded import Plan, build_graded

        usual = Plan()
        plan = Plan(
            tuple(dict.fromkeys(method or usual.methods)),
            tuple(dict.fromkeys(solution or usual.solutions)),
            integers(cells, "--cells"),
            integers(ppc, "--ppc"),
            contrast,
            power,
        )
        study = build_graded(plan, "verify " + shlex.join(repeatable(sys.argv[1:])), name(plan))
        check_count(jobs, "--jobs")
    folder = out or Path("results") / study.name
    code = conduct(study, Settings(folder, jobs, 1, json_output))
    if not json_output:
        show(folder)
    return code


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


def show(folder: Path) -> None:
    """Print what graded and thinned layouts save."""
    from rich.table import Table

    from mpm_verify.reports.components.show_graded import OVERVIEW, WHAT, overview
    from mpm_verify.reports.frames import read
    from mpm_verify.verify.terminal.output import printing
    from mpm_verify.verify.terminal.table import Listened

    found, out = overview(read(folder)), Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, 110)
    drawn = Table(box=None, pad_edge=False, header_style="dim")
    for column in OVERVIEW:
        drawn.add_column(column, justify="left" if column in OVERVIEW[:4] else "right")
    for row in found.rows:
        drawn.add_row(*row)
    with printing():
        out.print(f"\n{found.caption}\n")
        out.print(drawn)
        out.print(f"\n{WHAT}")
