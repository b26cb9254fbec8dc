"""Exact fields as a kernel: one call gives u, v, F, sigma and b for a block of particles.

Its source, of mms/kernel_source.py, is compiled by the same kernel() as the solver. The file is in the kernel cache,
with what it is compiled to, named by its content.
"""

import hashlib
import importlib.util
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mpm_verify.mms.printed import function
from mpm_verify.solver._jit import F1, function_type, i8, kept_in, nothing
from mpm_verify.solver.cache_folder import write
from mpm_verify.solver.source_hash import source_hash
from mpm_verify.solver.state import Floats

EXACT = nothing(F1, F1, i8, F1)  # columns[C*b + c], scalars[s], particles in the block, out[row*BLOCK + b]
Exact = function_type(EXACT)
ROWS = {"u": (0, 1), "v": (2, 3), "F": (4, 5, 6, 7), "sigma": (8, 9, 10, 11), "b": (12, 13)}  # of `out`
ROOM = 16  # rows of `out`, two of them scratch for logarithms


@dataclass(frozen=True)
class ExactKernel:
    """Kernel of signature EXACT, and what it takes: columns(X) (P,C) and scalars(t, t_velocity) (S,)."""

    fill: Callable[..., None]
    columns: Callable[[Floats], Floats]
    scalars: Callable[[float, float], Floats]


def compiled(source: str, columns_source: str, scalars_source: str) -> ExactKernel:
    """Kernel of three sources that mms/kernel_source.py writes."""
    columns, scalars = function(columns_source), function(scalars_source)

    def columns_of(X: Floats) -> Floats:
        values = columns(X[:, 0], X[:, 1])
        table = np.empty((len(X), max(1, len(values))))
        for c, value in enumerate(values):
            table[:, c] = value
        return table

    def scalars_at(t: float, t_velocity: float) -> Floats:
        return np.array([*scalars(t, t_velocity), 0.0], dtype=np.float64)

    return ExactKernel(_load(source), columns_of, scalars_at)


def _load(source: str) -> Any:
    """Import the source from its file, which is written where it is not there or not the same."""
    content = hashlib.sha256(source.encode()).hexdigest()
    name = f"exact_{content[:16]}"
    path = kept_in("exact", content, source_hash("mpm_verify.mms.exact")) / f"{name}.py"
    if not path.is_file() or path.read_bytes() != source.encode():
        write(path, source)
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # Numba's cache looks a kernel's module up by name when it is loaded again
    spec.loader.exec_module(module)
    return module.exact
