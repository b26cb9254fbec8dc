"""Exactness battery on a terminal: each part with its checks, and what came out in words."""

from mpm_verify.verify.terminal.examined import show

__all__ = ["show"]
