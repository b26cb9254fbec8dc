"""kernel(): Numba compilation with strict IEEE arithmetic and a disk cache that is never stale.

Numba looks only at the file of a kernel: a helper changed in another file leaves the old answer in its cache. So the
cache folder carries the hash of all sources that hold kernels. No other file calls njit (tests/test_structure.py).
"""

import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

# Threads wait for each other five times a step. Those that spin as long as the OpenMP library likes starve whatever
# shares their processors, each other included: five times slower on a busy machine. Those that never spin lose a fifth
# on an idle one to being woken. So they spin for less than 0.1 ms. Read once, so set before Numba is loaded.
os.environ.setdefault("GOMP_SPINCOUNT", "20000")

import numba
from numba import boolean, float64, int64, types, void

from mpm_verify.solver.sources import TOP, digest

Function = Callable[..., Any]

BLOCK = 32  # particles in a weights table: 16 neighbours of 32 particles are 16 kB, half of a level-1 cache

F1, F2, F3, I1 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1]
f8, i8, flag, nothing = float64, int64, boolean, void


def cache_folder() -> Path:
    """Where compiled kernels are kept: below $XDG_CACHE_HOME, or a temporary folder where that cannot be written."""
    kernels = [*TOP.glob("solver/**/*.py"), *TOP.glob("mms/*.py"), TOP / "cases/mms/norms.py"]
    name = f"{digest(kernels)[:16]}-numba{numba.__version__}"
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    for base in (home / "mpm-verify", Path(tempfile.gettempdir()) / f"mpm-verify-{os.getuid()}"):
        try:
            (base / name).mkdir(parents=True, exist_ok=True)
        except OSError:
            continue
        if os.access(base / name, os.W_OK):
            return base / name
    return Path(tempfile.mkdtemp(prefix="mpm-verify-"))


CACHE = cache_folder()
settings: Any = numba.config
settings.CACHE_DIR = str(CACHE)
# The vectoriser for straight-line code is off by default in Numba. It changes no operation and no order of operations,
# and the transfers gain a quarter.
settings.SLP_VECTORIZE = 1


def kernel(signature: Any = None, *, parallel: bool = False, inline: bool = False) -> Callable[[Function], Function]:
    """Compile a function at import for one explicit signature; with `inline`, make it a helper of other kernels."""

    def compile_function(function: Function) -> Function:
        if inline:
            return numba.njit(inline="always", error_model="numpy")(function)
        compiled = numba.njit(signature, parallel=parallel, error_model="numpy", cache=True)(function)
        # A kernel passed as a value is looked up by its signature each time, 25 us, and then twice in its library by
        # its name, 20 us each: more than half of a step of a small run.
        (result,) = compiled.overloads.values()
        compiled.get_compile_result = lambda _: result
        result.library.get_pointer_to_function = cache(result.library.get_pointer_to_function)
        return compiled

    return compile_function


def function_type(signature: Any) -> Any:
    """The type of a kernel passed as a value: called by address, so that one compiled transfer serves every basis."""
    return types.FunctionType(signature)


def use_threads(threads: int) -> None:
    """Threads of the parallel kernels from now on; more than the machine has are no use and not taken."""
    numba.set_num_threads(max(1, min(threads, settings.NUMBA_NUM_THREADS)))
