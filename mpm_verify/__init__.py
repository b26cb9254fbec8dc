"""Verification and benchmarking of the material point method.

The public API is the list `__all__`; its documentation stands in mpm_verify/verify/api.py.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mpm_verify.verify.api import Judgement, StoredStudy, compare, judge, judge_table, load, manufacture, study

__all__ = ["Judgement", "StoredStudy", "__version__", "compare", "judge", "judge_table", "load", "manufacture", "study"]


def __getattr__(name: str) -> Any:
    """Names are imported when they are asked for: the package itself costs nothing."""
    if name == "__version__":
        from importlib.metadata import version

        return version("mpm-verify")
    if name in __all__:
        return getattr(import_module("mpm_verify.verify.api"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
