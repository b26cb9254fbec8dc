"""`verify objectivity`: the paper's Figure 2, objective rates against closed forms, and readings that are wrong."""

import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from verify.options import Jobs, Json, Junit, check_count

if TYPE_CHECKING:
    from cases.checks import Examination
    from cases.turning_block import Block


def objectivity(
    cells: Annotated[int, typer.Option(help="Cells along a side of the block, from 4 on.")] = 8,
    ppc: Annotated[int, typer.Option(help="Particles per cell, a square number.")] = 4,
    jobs: Jobs = None,
    out: Annotated[Path, typer.Option(help="Folder of the result.")] = Path("results/objectivity"),
    json_output: Json = False,
    junit: Junit = None,
) -> int:
    """Turn a block under gravity by 90 degrees, and follow objective rates and wrong readings of them."""
    from reports.objectivity_page import page
    from verify.conduct import usage
    from verify.examine import conduct

    with usage():
        from cases.turning_block import Block

        block = Block(cells=cells, ppc=ppc)
        check_count(jobs, "--jobs")
    command = "verify " + shlex.join(sys.argv[1:])
    return conduct(lambda: compute(block, jobs or os.cpu_count() or 1, command), page, out, json_output, junit)


def compute(block: "Block", jobs: int, command: str) -> "Examination":
    """The examination, runs in worker processes."""
    from cases.objectivity import examine
    from cases.runner import process_pool

    with process_pool(jobs) as (executor, _):
        return examine(block, executor, command)
