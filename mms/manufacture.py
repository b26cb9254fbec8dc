"""manufacture(): a displacement and a material become exact fields and the body force that makes them a solution."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from mpm_verify.mms.discretisation import axisymmetric, dimension
from mpm_verify.mms.energy import Energy, check_energy
from mpm_verify.mms.printed import folder, function, printed
from mpm_verify.solver.cache_folder import kept
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    from mpm_verify.mms.derive import Fields, Solution
    from mpm_verify.mms.exact import ExactKernel

Field = Callable[[Floats, float], Floats]


@dataclass(frozen=True)
class Manufactured:
    """Exact fields as functions of (X, t): reference positions X (P,d), t a number; d = 2 is plane strain.

    d = 1 is uniaxial strain. In axisymmetry X is (radius, axis), and F and P are (P,5): xx, xy, yx, yy, and zz around.

    Parameters
    ----------
    solution, material, rho0
        What they are derived from, at the first use.
    folder
        Folder of the kernel cache where printed functions are kept; none where they are printed anew.
    damping
        Fraction of the unbalanced force that local damping takes, with which the motion is the exact one.
    """

    solution: "Solution"
    material: Energy
    rho0: float
    folder: str = ""
    damping: float = 0.0

    @cached_property
    def fields(self) -> "Fields":
        """Expressions that the functions are printed from."""
        from mpm_verify.mms.derive import derive

        return derive(self.solution, self.material, self.rho0)

    def forced(self, t_velocity: Any = None) -> "Fields":
        """Expressions with the body force that damping needs, against the velocity of `t_velocity`; None: of t."""
        if not self.damping:
            return self.fields
        from mpm_verify.mms.damping import damped

        return damped(self.fields, self.damping, self.fields.t if t_velocity is None else t_velocity)

    def x(self, X: Floats, t: float) -> Floats:
        """Position x (P,d), a length."""
        return X + self.u(X, t)

    @cached_property
    def u(self) -> Field:
        """Displacement u (P,d), a length."""
        return self._function("u", 1)

    @cached_property
    def v(self) -> Field:
        """Velocity v (P,d), length per time."""
        return self._function("v", 1)

    @cached_property
    def F(self) -> Field:
        """Deformation gradient F (P,d,d), rows the components of the position."""
        return self._function("F", 2)

    @cached_property
    def P(self) -> Field:
        """First Piola stress P (P,d,d), rows the components of the traction."""
        return self._function("P", 2)

    @cached_property
    def sigma(self) -> Field:
        """Cauchy stress sigma (P,4): xx, yy, zz, xy, tension positive; or (P,6), with yz and xz last, or (P,1): xx."""
        return self._function("sigma", 0)

    @cached_property
    def b(self) -> Field:
        """Body force per mass b (P,d), length per time squared; with damping against the velocity of the same time."""
        return self._function("b", 1)

    @cached_property
    def kernel(self) -> "ExactKernel":
        """Fields of two coordinates as one compiled kernel for blocks of particles."""
        from mpm_verify.mms.exact import compiled

        return compiled(*json.loads(self.text("kernel", self._kernel_source)))

    def text(self, name: str, make: Callable[[], str]) -> str:
        """Text that was derived of the fields, from the folder or made anew."""
        return kept(self.folder, name, make) if self.folder else make()

    def _kernel_source(self) -> str:
        from mpm_verify.mms.kernel_source import T_VELOCITY, write

        return json.dumps(write(self.forced(T_VELOCITY)))

    def _function(self, name: str, rank: int) -> Field:
        """Function that a field is printed as, of vectors and tensors of a rank, or of 0: as they are listed."""
        listed = rank == 0 or (rank == 2 and axisymmetric(self.solution))
        shape = (-1,) if listed else (dimension(self.solution),) * rank

        def source() -> str:
            f = self.forced()
            if f.long:
                return printed((*f.X, f.t), getattr(f, name), f.inner)
            return printed((*f.X, f.t), f.full(getattr(f, name)))

        compiled = function(self.text(name, source))

        def evaluate(X: Floats, t: float) -> Floats:
            values = [np.broadcast_to(value, len(X)) for value in compiled(*X.T, t)]
            return np.stack(values, axis=-1).astype(np.float64).reshape(len(X), *shape)

        return evaluate


def manufacture(
    solution: "Solution", material: Energy, rho0: float, name: str = "", damping: float = 0.0
) -> Manufactured:
    """Make exact fields, and the body force that they need, from a displacement.

    The source term comes from the material's energy by differentiation, never from the stress the solver computes.

    Parameters
    ----------
    solution
        Displacement as an expression, such as a plug-in of mms/solutions.
    material
        Constitutive model with an energy.
    rho0
        Density at reference, in the units of the material.
    name
        Hash of all that the first three stand for: what is derived is kept on disk by it. Derived anew without one.
    damping
        Fraction of the unbalanced force that local damping takes, see mms/damping.py.

    Returns
    -------
    Manufactured
        x, u, v, F, P, sigma and b as functions of (X, t).

    Raises
    ------
    ValueError
        For a material without an energy; it names those that have one.
    """
    check_energy(material)
    kept_by = f"{name} {rho0!r}" + (f" damping {damping!r}" if damping else "")
    made = Manufactured(solution, material, rho0, folder(kept_by, __name__) if name else "", damping)
    if not name:
        made.fields  # noqa: B018  what cannot be derived is said here, not at the first use
    return made
