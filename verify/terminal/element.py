"""Element tests on a terminal, as any study of Examinations."""

from mpm_verify.verify.terminal.examined import show

__all__ = ["show"]
