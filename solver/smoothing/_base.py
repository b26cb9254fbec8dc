"""Contract of smoothing: the strain that the material sees and the stress of the internal force, projected in parts.

Three-field (Hu-Washizu) mixed form with discontinuous rates and stresses, after Mast et al. 2012. In the plane a tensor
has a volumetric part (xx + yy)/2 and a deviatoric part ((xx - yy)/2, xy); so a smoothed strain stays plane, and rate
and stress projections are adjoint. zz is not in any force and stays as it is. F, domains and volumes move with the
velocities as they are.
"""

from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

import numpy as np

from mpm_verify.solver.context import Context, fail
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.kirchhoff import volume
from mpm_verify.solver.material_model import Material
from mpm_verify.solver.smoothing._project import project, strained, strains
from mpm_verify.solver.state import Floats, Particles

Of = Literal["rate", "stress", "both"]
Where = Literal["cell", "node"]
Into = Literal["force", "history"]
# Their frames turn alone, and the first two by F as it is, the third half by the smoothed strain; one that stretches
# with F would need the smoothed F at the end of the step too.
RATES = ("green_naghdi", "jaumann", "logarithmic")


@dataclass(frozen=True)
class Smoothing:
    """Smoothing of rates and stresses; subclasses choose the parts.

    Parameters
    ----------
    of
        What is smoothed: ``rate``, ``stress`` or ``both``.
    where
        Projection: ``cell``, the mean of a cell, or ``node``, through nodes and back.
    beta
        Fraction of the projection, 0 < beta <= 1; the rest is unprojected.
    into
        ``force``: the smoothed stress acts at the nodes alone; ``history``: the material goes on from it too.

    Attributes
    ----------
    volumetric, deviatoric
        Which parts are smoothed.

    Raises
    ------
    ValueError
        For another word or beta.

    References
    ----------
    Mast, Mackenzie-Helnwein, Arduino, Miller & Shin 2012, doi:10.1016/j.jcp.2012.04.032.
    """

    of: Of = "both"
    where: Where = "cell"
    beta: float = 1.0
    into: Into = "force"
    volumetric: ClassVar[bool] = False
    deviatoric: ClassVar[bool] = False

    def __post_init__(self) -> None:
        for name, value, words in (("of", self.of, Of), ("where", self.where, Where), ("into", self.into, Into)):
            if value not in get_args(words):
                raise ValueError(f"{name} = {value!r} must be one of {', '.join(get_args(words))}")
        if not 0 < self.beta <= 1:
            raise ValueError(f"beta = {self.beta} must lie above 0 and up to 1")

    @property
    def adjoint(self) -> bool:
        """Whether strain and stress are smoothed by one projector, so that the work of one is that of the other."""
        return self.of == "both" and self.where == "cell" and self.into == "force"

    def check(self, material: Material) -> None:
        """Raise ValueError for a material that cannot be smoothed.

        Of a function of F the stress of the force can be, and the volume ratio that it sees, which is F-bar.
        """
        if material.rate is None and self.into == "force" and (self.of == "stress" or not self.deviatoric):
            return
        if material.rate is None:
            raise ValueError(
                "a function of F has no strain rate and no history to smooth: take fbar, volumetric, "
                "or deviatoric:of=stress, full:of=stress, with into=force"
            )
        if material.rate not in RATES:
            raise ValueError(f"smoothing must have a material in rate form with a rate of {', '.join(RATES)}")

    def stress(self, context: Context) -> None:
        """Write particles.sigma_smoothed (P,4), the stress of the internal force, at the start of a step."""
        p = context.particles
        if self.of == "rate":
            return
        smoothed = p.sigma.copy()
        smoothed[:, [0, 1, 3]] = self.smooth(context, context.basis.on_grid(p), p.sigma[:, [0, 1, 3]])
        if self.into == "history":
            p.sigma[:] = smoothed
        else:
            p.sigma_smoothed = smoothed

    def strain(self, context: Context, x: Floats) -> Floats | None:
        """F (P,2,2) whose strain the material is to see, at the end of a step that began at x (P,2); None for F."""
        p = context.particles
        if self.of == "stress":
            return None
        if context.material.rate is None:
            return self.bar(context)
        increments, F_smoothed = np.empty((len(p), 4)), np.empty_like(p.F)
        strains(p.F_old, p.F, increments)
        increments[:, :3] = self.smooth(context, x, increments[:, :3])
        strained(p.F_old, increments, F_smoothed)
        return F_smoothed

    def bar(self, context: Context) -> Floats:
        """F-bar (P,2,2) of a function of F: F with the projected det F in the plane, weighted by initial volumes."""
        p = context.particles
        J = np.linalg.det(p.F)
        mean = self.project(context, context.basis.on_grid(p), J[:, None], p.V0)[:, 0]
        scaled: Floats = np.sqrt(1 + self.beta * (mean / J - 1))[:, None, None] * p.F
        return scaled

    def smooth(self, context: Context, x: Floats, tensor: Floats) -> Floats:
        """Plane tensors xx, yy, xy (P,3) with the chosen parts projected."""
        parts = np.stack([tensor[:, 0] + tensor[:, 1], tensor[:, 0] - tensor[:, 1], 2 * tensor[:, 2]], axis=1) / 2
        chosen = np.flatnonzero([self.volumetric, self.deviatoric, self.deviatoric])
        means = self.project(context, x, np.ascontiguousarray(parts[:, chosen]))
        parts[:, chosen] += self.beta * (means - parts[:, chosen])
        return np.stack([parts[:, 0] + parts[:, 1], parts[:, 0] - parts[:, 1], parts[:, 2]], axis=1)

    def project(self, context: Context, x: Floats, values: Floats, V: Floats | None = None) -> Floats:
        """Project values (P,C), by V (P,), the volumes of the start of the step. Raises RunFailed outside the grid."""
        g, out = context.grid, np.empty_like(values)
        s = (x - g.origin) / g.dx
        inside = ((s >= 0) & (s < (g.nx - 1, g.ny - 1))).all(axis=1)  # NaN is not
        if not inside.all():
            fail(context, int(np.flatnonzero(~inside)[0]), FailureKind.OUTSIDE_GRID)
        nodes = self.where == "node"
        project(x, volumes(context.particles) if V is None else V, values, g.origin, 1.0 / g.dx, g.nx, g.ny, nodes, out)
        return out


def volumes(particles: Particles) -> Floats:
    """Volumes V0 det F (P,) at the start of the step; a function of F keeps no F_old, and is not asked later."""
    F: Floats = particles.F_old if particles.F_old.size else particles.F.reshape(-1, 4)
    V: Floats = particles.V0 * volume(F)
    return V
