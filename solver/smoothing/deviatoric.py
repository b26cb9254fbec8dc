"""Deviatoric smoothing: the deviators of D and stress are those of the cell, p is each particle's own.

The paper's remedy for shear locking: "acts on the deviatoric portion of the stress and strain field".
"""

from dataclasses import dataclass
from typing import ClassVar

from mpm_verify.solver.smoothing._base import Smoothing


@dataclass(frozen=True)
class Deviatoric(Smoothing):
    """Deviatoric smoothing; parameters as of Smoothing."""

    deviatoric: ClassVar[bool] = True
