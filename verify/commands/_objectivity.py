"""`verify objectivity`: the paper's Figure 2, objective rates against closed forms, and readings that are wrong."""

import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from mpm_verify.verify.options.common import Jobs, Json, Junit, check_count

if TYPE_CHECKING:
    from mpm_verify.cases.harness.checks import Examination
    from mpm_verify.cases.objectivity.turning_block import Block


def objectivity(
    cells: Annotated[int, typer.Option(help="Cells along a side of the block, from 4 on.")] = 8,
    ppc: Annotated[int, typer.Option(help="Particles per cell, a square number.")] = 4,
    jobs: Jobs = None,
    out: Annotated[Path, typer.Option(help="Folder of the result.")] = Path("results/objectivity"),
    json_output: Json = False,
    junit: Junit = None,
) -> int:
    """Turn a block under gravity by 90 degrees, and follow objective rates and wrong readings of them."""
    from mpm_verify.verify.conduct import usage
    from mpm_verify.verify.examine import conduct

    from mpm_verify.reports.pages.objectivity import page

    with usage():
        from mpm_verify.cases.objectivity.turning_block import Block

        block = Block(cells=cells, ppc=ppc)
        check_count(jobs, "--jobs")
    command = "verify " + shlex.join(sys.argv[1:])
    return conduct(lambda: compute(block, jobs or os.cpu_count() or 1, command), page, out, json_output, junit)


def compute(block: "Block", jobs: int, command: str) -> "Examination":
    """The examination, runs in worker processes."""
    from mpm_verify.cases.harness.runner import process_pool
    from mpm_verify.cases.objectivity.exam import examine

    with process_pool(jobs) as (executor, _):
        return examine(block, executor, command)
