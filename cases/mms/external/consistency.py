"""Consistency of an answer with itself: F against its own displacements, volume against F, stress against F."""

from collections.abc import Callable

import numpy as np

from mpm_verify.cases.mms.external.balance import rates
from mpm_verify.cases.mms.external.evidence import Evidence
from mpm_verify.solver.state import Floats

BETTER = 0.5  # factor on a mismatch that is no accident
TIE = 1.1  # factor within which two readings are the same
EXACT = 1e-5  # mismatch of stress and volume, relative to their own change, that rounding does not make
CLOSE, ROUGH = 0.02, 0.25  # of a factor, of F as it is written and of the answer's own displacements
LATE = 0.25  # steps: of a lag that is told

PLANE = (0, 1, 3)  # components in the plane

Advance = Callable[[Floats, Floats], Floats]
ADVANCED: dict[str, Advance] = {  # F from the step A = F_own F_before^-1 and the F before
    "F_twice": lambda A, F: A @ A @ F,
    "F_symmetric": lambda A, F: 0.5 * (A + A.swapaxes(-1, -2)) @ F,
    "L_transposed": lambda A, F: A.swapaxes(-1, -2) @ F,
}


def of_F(e: Evidence) -> dict[str, float]:
    """Reading of F that fits the answer's own displacements; the mismatch so read over the mismatch as it is."""
    if not e.has("F"):
        return {}
    own = e.F_own
    readings = {"F_transposed": own.swapaxes(-1, -2)} | {name: path(own, rule) for name, rule in ADVANCED.items()}
    as_it_is = miss(e.F_given, own)
    found = {name: miss(e.F_given, F) / as_it_is for name, F in readings.items()} if as_it_is else {}
    best = min(found, key=found.__getitem__, default="")
    if not best or not found[best] < BETTER:
        return {}
    same = next(name for name, left in found.items() if left < TIE * found[best])
    return {same: found[same]}


def path(F: Floats, rule: Advance) -> Floats:
    """Deformation gradients (1+K,P,2,2) that a rule would have made of those that are right, frame by frame."""
    with np.errstate(all="ignore"):
        steps = F[1:] @ np.linalg.pinv(F[:-1])
    found = [F[0]]
    for A in steps:
        found.append(rule(A, found[-1]))
    return np.stack(found)


def miss(F: Floats, other: Floats) -> float:
    """Root mean square of a mismatch."""
    return float(np.sqrt(np.mean((F - other) ** 2)))


def of_volume(e: Evidence) -> dict[str, float]:
    """Factor on the change of volume against that of det F, where it is not 1."""
    if not (e.has("V") and e.has("F")):
        return {}
    change, meant = e.given("V")[..., 0] / e.V0 - 1, np.linalg.det(e.F_given[1:]) - 1
    size, gap = float(np.sum(meant**2)), float(np.sum((change - meant) ** 2))
    if not size or gap <= (EXACT**2) * size:
        return {}
    slope = float(np.sum(change * meant)) / size
    left = float(np.sum((change - slope * meant) ** 2))
    return {"volume": slope} if abs(slope - 1) > CLOSE and left < BETTER**2 * gap else {}


def of_stress(e: Evidence, wrong: bool = False) -> dict[str, float]:
    """Sign, factor, factor on its mean in the plane alone, or lag, of sigma against the material's sigma of F.

    Nothing where F is `wrong` and sigma fits that of the answer's own displacements better.
    """
    if not (e.has("sigma") and e.stressed):
        return {}
    F = e.F_given if e.has("F") else e.F_own
    given, all_times = e.given("sigma"), e.sigma(F)
    meant = all_times[1:]
    gap = given - meant
    size, whole = norm(meant), norm(gap)
    exactly = EXACT if e.has("F") else BETTER
    if not np.isfinite(size + whole) or whole <= exactly * size:
        return {}
    if wrong and norm(given - e.sigma(e.F_own[1:])) < BETTER * whole:
        return {}
    slope = inner(given, meant) / size**2
    if norm(given - slope * meant) < BETTER * whole and abs(slope - 1) > CLOSE:
        best = None if e.around else mean_factor(given, meant)
        if best and best[1] < BETTER * norm(given - slope * meant):
            return named(e, best[0])
        return {"sigma_sign" if abs(slope + 1) < (CLOSE if e.has("F") else ROUGH) else "sigma_factor": slope}
    if len(e.frames) < 2:
        return {}
    late = e.dt * rates(all_times, e.times)[1:]
    lag = -inner(gap, late) / inner(late, late)
    if norm(gap + lag * late) < BETTER * whole and abs(lag) > LATE:
        return {"sigma_lag": lag}
    best = None if e.around else mean_factor(given, meant)
    return named(e, best[0]) if best and best[1] < BETTER * whole else {}


def named(e: Evidence, factor: float) -> dict[str, float]:
    """Factor on the mean stress in the plane by its name: that of plane stress, or any."""
    lam, mu = (e.case.record.material.constants.get(name, 0.0) for name in ("lam", "mu"))
    flat = (2 * lam * mu / (lam + 2 * mu) + mu) / (lam + mu) if lam * mu > 0 else 0.0
    return (
        {"plane_stress" if abs(factor / flat - 1) < CLOSE else "sigma_mean": factor} if flat else {"sigma_mean": factor}
    )


def mean_factor(given: Floats, meant: Floats) -> tuple[float, float] | None:
    """Factor on the mean stress in the plane, and what it leaves, where the rest of it is right. None in 3-D."""
    if meant.shape[-1] != 4:
        return None
    mean, rest = (0.5 * (meant[..., 0] + meant[..., 1]), meant[..., PLANE].copy())
    own, other = 0.5 * (given[..., 0] + given[..., 1]), given[..., PLANE].copy()
    rest[..., :2] -= mean[..., None]
    other[..., :2] -= own[..., None]
    size, shear = float(np.sum(mean**2)), float(np.sum(rest**2))
    if not (size and shear) or abs(float(np.sum(rest * other)) / shear - 1) > CLOSE:
        return None
    factor = float(np.sum(mean * own)) / size
    left = float(np.sqrt(2 * np.sum((own - factor * mean) ** 2) + np.sum((rest - other) ** 2)))
    return (factor, left) if abs(factor - 1) > CLOSE else None


def inner(one: Floats, other: Floats) -> float:
    """Sum of products of all components, in two dimensions of those in the plane."""
    return float(np.sum((one * other)[..., PLANE if one.shape[-1] == 4 else slice(None)]))


def norm(values: Floats) -> float:
    """Norm of all components, in two dimensions of those in the plane."""
    return float(np.sqrt(inner(values, values)))
