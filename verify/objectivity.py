"""`verify objectivity`: the paper's Figure 2, objective rates against closed forms, and readings that are wrong."""

import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from cases.checks import Examination
    from cases.turning_block import Block


def objectivity(
    cells: Annotated[int, typer.Option(help="Cells along a side of the block, from 4 on.")] = 8,
    ppc: Annotated[int, typer.Option(help="Particles per cell, a square number.")] = 4,
    jobs: Annotated[int | None, typer.Option(help="Runs at a time.", show_default="processors")] = None,
    out: Annotated[Path, typer.Option(help="Folder of the result.")] = Path("results/objectivity"),
    json_output: Annotated[
        bool, typer.Option("--json", help="One JSON document on standard output, nothing else.")
    ] = False,
    junit: Annotated[Path | None, typer.Option(help="Write the checks as JUnit XML.")] = None,
) -> int:
    """Turn a block under gravity by 90 degrees, and follow objective rates and wrong readings of them."""
    from reports.objectivity_page import page
    from verify.conduct import usage
    from verify.examine import conduct

    with usage():
        from cases.turning_block import Block

        block = Block(cells=cells, ppc=ppc)
        if jobs is not None and jobs < 1:
            raise ValueError("--jobs takes whole numbers from 1 on")
    command = "verify " + shlex.join(sys.argv[1:])
    return conduct(lambda: compute(block, jobs or os.cpu_count() or 1, command), page, out, json_output, junit)


def compute(block: "Block", jobs: int, command: str) -> "Examination":
    """The examination, runs in worker processes."""
    from cases.objectivity import examine
    from cases.runner import process_pool

    with process_pool(jobs) as (executor, _):
        return examine(block, executor, command)
