"""Names of somebody else's solver: its version, and what it is called where a method is named."""

import re

from mpm_verify.cases.solvers.command import PYTHON, program, version


def version_of(solver: str) -> str:
    """Version of a solver of somebody else: a command, or a Python function."""
    if not solver.startswith(PYTHON):
        return version(solver)
    from mpm_verify.cases.solvers.callables import version as of_function

    return of_function(solver)


def method_of(solver: str) -> str:
    """Name of its program as that of a method: the file's, `run.sh`, of Python without its ending."""
    return re.sub(r"[^\w.-]+", "_", program(solver).removesuffix(".py"))
