"""Expressions as NumPy functions, by way of printed Python, which can be kept on disk: then SymPy need not be loaded.

What is kept stands in the folder of the kernel cache, below the hash of what it was derived from and by.
"""

import hashlib
import inspect
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

import numpy as np

from mpm_verify.solver.source_hash import source_hash

if TYPE_CHECKING:
    import sympy as sp


def printed(
    symbols: Sequence["sp.Symbol"],
    expressions: Sequence["sp.Expr"],
    inner: "Mapping[sp.Symbol, sp.Expr] | None" = None,
) -> str:
    """Source of a function of the symbols that gives a list of values, common subexpressions first.

    `inner` has expressions of symbols that the others are written in, which are computed before them.
    """
    import sympy as sp

    from mpm_verify.mms.straight_line import assignments

    def ordered(targets: Sequence["sp.Expr"]) -> tuple[list[Any], list["sp.Expr"]]:
        order = assignments(inner or {}, list(enumerate(targets)))
        return order[: -len(targets)], [e for _, e in order[-len(targets) :]]

    return inspect.getsource(sp.lambdify(symbols, list(expressions), "numpy", cse=ordered if inner else True))


def function(source: str) -> Callable[..., Any]:
    """Function that a printed source defines; its names are NumPy's."""
    names = dict(vars(np))
    exec(compile(source, "<printed>", "exec"), names)
    made: Callable[..., Any] = names["_lambdifygenerated"]
    return made


def folder(name: str, module: str) -> str:
    """Folder in the kernel cache of what `module` derives from what `name` stands for."""
    text = repr((name, source_hash(module), _sympy(), np.__version__))
    return f"{module.rpartition('.')[2]}-{hashlib.sha256(text.encode()).hexdigest()[:24]}"


@cache
def _sympy() -> str:
    return version("sympy")
