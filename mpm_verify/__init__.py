"""Verification and benchmarking of the material point method. The public API is listed in `__all__`."""

from typing import Any

__all__ = ["__version__"]


def __getattr__(name: str) -> Any:
    """Names that cost an import are looked for when they are asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("mpm-verify")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
