"""Expressions as NumPy functions, by way of printed Python, which can be kept on disk: then SymPy need not be loaded.

What is kept stands in the folder of the kernel cache, below the hash of what it was derived from and by.
"""

import hashlib
import inspect
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mpm_verify.solver.cache_folder import kernel_folder
from mpm_verify.solver.source_hash import source_hash

if TYPE_CHECKING:
    import sympy as sp


def printed(symbols: Sequence["sp.Symbol"], expressions: Sequence["sp.Expr"]) -> str:
    """Source of a function of the symbols that gives a list of values, common subexpressions first."""
    import sympy as sp

    return inspect.getsource(sp.lambdify(symbols, list(expressions), "numpy", cse=True))


def function(source: str) -> Callable[..., Any]:
    """Function that a printed source defines; its names are NumPy's."""
    names = dict(vars(np))
    exec(compile(source, "<printed>", "exec"), names)
    made: Callable[..., Any] = names["_lambdifygenerated"]
    return made


def folder(name: str, module: str) -> Path:
    """Folder of what `module` derives from what `name` stands for."""
    text = repr((name, source_hash(module), _sympy(), np.__version__))
    return kernel_folder(f"{module.rpartition('.')[2]}-{hashlib.sha256(text.encode()).hexdigest()[:24]}")


@cache
def _sympy() -> str:
    return version("sympy")


def kept(file: Path, make: Callable[[], str]) -> str:
    """Text of a file, made where it is missing. It is written whole or not at all, and a full disk costs time alone."""
    with suppress(OSError):
        return file.read_text(encoding="utf-8")
    text = make()
    temporary = file.with_name(f"{file.name}.{os.getpid()}")
    try:
        temporary.write_text(text, encoding="utf-8")
        os.replace(temporary, file)
    except OSError:
        with suppress(OSError):
            temporary.unlink()
    return text
