"""Verification and benchmarking of the material point method. The public API is listed in `__all__`."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("mpm-verify")
except PackageNotFoundError:  # a checkout that is not installed
    __version__ = "unknown"
