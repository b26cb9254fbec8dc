"""Environment of a Result: versions, commit, processor."""

import platform
import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from mpm_verify.solver.source_hash import TOP

PACKAGES = ("mpm-verify", "numpy", "numba", "llvmlite", "sympy", "scipy")
COMPUTES = ("python", "processor", "numpy", "numba", "llvmlite", "scipy")  # what bits hang on, beside the sources


@cache
def environment() -> dict[str, str]:
    """Versions of what computes, the commit of the sources, the processor."""
    found = {"python": platform.python_version(), "system": platform.platform(), "processor": processor()}
    for package in PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return {**found, "commit": commit()}


def numerics() -> dict[str, str]:
    """Part of the environment that the bits of a run hang on, beside its sources."""
    found = environment()
    return {name: found[name] for name in COMPUTES}


def commit() -> str:
    """Commit of the sources, with `+` where they are changed; `unknown` outside a checkout."""
    try:
        if git("rev-parse", "--show-toplevel") != str(TOP):  # installed inside another project's checkout
            return "unknown"
        return git("describe", "--always", "--dirty=+", "--abbrev=12", "--exclude=*")
    except (OSError, subprocess.SubprocessError):
        return "unknown"


def git(*arguments: str) -> str:
    """Output of git, run in the folder of the sources."""
    run = ["git", "-C", str(TOP), *arguments]
    return subprocess.run(run, capture_output=True, text=True, check=True, timeout=10).stdout.strip()


def processor() -> str:
    """Name of the processor as the system gives it."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
