"""Exported cases for tests: made once in a process, and written to a folder."""

from functools import cache
from pathlib import Path

from mpm_verify.mms.discretisation import axisymmetric, dimension
from mpm_verify.mms.export.case import Exported
from mpm_verify.reports.export.case_folder import write
from mpm_verify.solver.plugins import SOLUTIONS, available, create
from mpm_verify.verify.commands.export import made

AROUND = [name for name in available(SOLUTIONS) if axisymmetric(create(SOLUTIONS, name))]
LINE, PLANE, SOLID = (
    [name for name in available(SOLUTIONS) if dimension(create(SOLUTIONS, name)) == d and name not in AROUND]
    for d in (1, 2, 3)
)


@cache
def exported(
    solution: str, cells: int = 4, ppc: int | None = None, material: str = "", dim: int | None = None
) -> Exported:
    """Content of a case."""
    return made(solution, material, cells, ppc, 0.4, 16, dim)


def folder_of(solution: str, folder: Path, **more: int) -> Path:
    """Folder of a case, written anew."""
    write(folder, exported(solution, **more))
    return folder
