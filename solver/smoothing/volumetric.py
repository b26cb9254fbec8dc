"""Volumetric smoothing: theta = tr D and p = (xx + yy)/2 are those of the cell. Relieves volumetric locking.

It leaves deviators as they are, so that a stress within a cone can be outside it afterwards: for friction alone p may
be lowered below what the particle's own deviator needs.
"""

from dataclasses import dataclass
from typing import ClassVar

from mpm_verify.solver.smoothing._base import Smoothing


@dataclass(frozen=True)
class Volumetric(Smoothing):
    """Volumetric smoothing; parameters as of Smoothing."""

    volumetric: ClassVar[bool] = True
