"""kernel(): Numba compilation with strict IEEE arithmetic and a disk cache that is never stale.

Numba looks only at the file of a kernel: a helper changed in another file leaves the old answer in its cache, and an
edited comment a useless one. So the kernels of a file are kept in a folder that carries the hash of the file's import
closure (solver/source_hash.py) and of the versions of Numba and llvmlite; the processor stands in Numba's own index.
No other file calls njit (tests/test_jit.py).
"""

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import CodeType
from typing import Any

# Threads wait for each other five times a step. Those that spin as long as the OpenMP library likes starve whatever
# shares their processors, each other included: five times slower on a busy machine. Those that never spin lose a fifth
# on an idle one to being woken. So they spin for less than 0.1 ms. Read once, so set before Numba is loaded.
os.environ.setdefault("GOMP_SPINCOUNT", "20000")

import llvmlite
import numba
from numba import boolean, float64, int64, types, void
from numba.core.caching import CacheImpl, _CacheLocator
from numba.core.errors import NumbaError

from mpm_verify.solver import own_file
from mpm_verify.solver.cache_folder import base, kernel_folder
from mpm_verify.solver.source_hash import PACKAGE, TOP, source_hash

Function = Callable[..., Any]

BLOCK = 32  # particles in a weights table: 16 support nodes of 32 particles are 16 kB, half of a level-1 cache

F1, F2, F3, I1 = float64[::1], float64[:, ::1], float64[:, :, ::1], int64[::1]
f8, i8, flag, nothing = float64, int64, boolean, void


CACHE = base()
settings: Any = numba.config
settings.CACHE_LOCATOR_CLASSES = ""  # nobody else's
# The vectoriser for straight-line code is off by default in Numba. It changes no operation and no order of operations,
# and the transfers gain a quarter.
settings.SLP_VECTORIZE = 1


def kept_in(name: str, *hashes: str) -> Path:
    """The folder of the kernels of one file, by its name and the hashes of what they are made from."""
    text = repr((name, numba.__version__, llvmlite.__version__, *hashes))
    return kernel_folder(f"{name}-{hashlib.sha256(text.encode()).hexdigest()[:24]}")


def folder_of(function: Function) -> Path | None:
    """Folder of a compiled function; None for one that stands in no file.

    A file that was generated into such a folder is kept with its kernels. A user's file counts with the data in its
    modules, which Numba takes for constants.
    """
    file, module = Path(function.__code__.co_filename), function.__module__
    if file.parent.parent == CACHE:
        return file.parent
    if not file.is_file():
        return None
    if module.partition(".")[0] == PACKAGE and file.is_relative_to(TOP):
        return _ours(module)
    return kept_in(file.stem, module, own_file.digest({"__file__": str(file), **function.__globals__}))


@cache
def _ours(module: str) -> Path:
    return kept_in(".".join(module.split(".")[-2:]), module, source_hash(module))


class Locator(_CacheLocator):
    """Tells Numba where the functions that kernel() compiles are kept, and what their source is worth."""

    def __init__(self, function: Function, file: str) -> None:
        self.function, self.folder = function, function.folder  # type: ignore[attr-defined]
        self._py_file = file  # Numba asks for it when it warns

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self.folder)

    def get_source_stamp(self) -> str:
        """The folder's name: it holds the hash."""
        return str(self.folder.name)

    def get_disambiguator(self) -> str:
        """Hash that tells functions of one name in one file apart: their numbers and names, not their line."""
        code = self.function.__code__
        numbers = [c for c in code.co_consts if not isinstance(c, str | CodeType | None)]
        return hashlib.sha256(repr((numbers, code.co_names, code.co_varnames)).encode()).hexdigest()[:8]

    @classmethod
    def from_function(cls, function: Function, file: str) -> "Locator | None":
        """Locator of a function that kernel() compiles; None for any other."""
        return cls(function, file) if hasattr(function, "folder") else None


CacheImpl._locator_classes = [Locator, *CacheImpl._locator_classes]


def kernel(signature: Any = None, *, parallel: bool = False, inline: bool = False) -> Callable[[Function], Function]:
    """Compile a function at import for one explicit signature.

    Parameters
    ----------
    signature
        Numba signature such as ``nothing(F2, f8)``; an inlined helper needs none.
    parallel
        Whether ``prange`` loops run on several threads.
    inline
        Whether this is a helper that is written into the kernels that call it.

    Returns
    -------
    Callable
        Decorator that returns the compiled function.
    """

    def compile_function(function: Function) -> Function:
        if inline:
            return numba.njit(inline="always", error_model="numpy")(function)
        folder = folder_of(function)
        function.folder = folder  # type: ignore[attr-defined]
        compiled = loaded(function, signature, folder, {"parallel": parallel, "error_model": "numpy"})
        # A kernel passed as a value is looked up by its signature each time, 25 us, and then twice in its library by
        # its name, 20 us each: more than half of a step of a small run.
        (result,) = compiled.overloads.values()
        compiled.get_compile_result = lambda _: result
        result.library.get_pointer_to_function = cache(result.library.get_pointer_to_function)
        return compiled

    return compile_function


def loaded(function: Function, signature: Any, folder: Path | None, options: dict[str, Any]) -> Any:
    """Function compiled or read from its folder; what is damaged there goes, and a full disk costs time alone."""
    if folder is None:
        return numba.njit(signature, cache=False, **options)(function)
    try:
        return numba.njit(signature, cache=True, **options)(function)
    except NumbaError:
        raise
    except Exception:  # of pickle and of Numba, for a file that was cut
        for file in folder.glob(f"*{function.__name__}-*.nb[ci]"):
            file.unlink(missing_ok=True)
    try:
        return numba.njit(signature, cache=True, **options)(function)
    except OSError:
        return numba.njit(signature, cache=False, **options)(function)


def function_type(signature: Any) -> Any:
    """The type of a kernel passed as a value: called by address, so that one compiled transfer serves every basis."""
    return types.FunctionType(signature)


def use_threads(threads: int) -> None:
    """Set the threads of the parallel kernels from now on; more than the machine has are no use and not taken."""
    numba.set_num_threads(max(1, min(threads, settings.NUMBA_NUM_THREADS)))
