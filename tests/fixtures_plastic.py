"""What the tests of plastic laws share: a law under given strains, and Koiter's rule by enumeration of active planes.

The enumeration knows no regions and no order of principal stresses: nine planes, three of them the cut-off's, and every
set of up to three that may be active. Of these it takes the one whose multipliers and excesses have the right signs.
"""

from itertools import combinations, permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mpm_verify.solver.state import Floats

AXES = list(permutations(range(3), 2))


def stiffness(law: Any) -> Floats:
    """D (3,3) of principal stresses."""
    return law.lam * np.ones((3, 3)) + 2 * law.mu * np.eye(3)


def respond(law: Any, sigma: Floats, de: Floats | None = None) -> tuple[Floats, Floats]:
    """New stress (P,4) and history (P,H) after a strain increment de (P,3)."""
    out, history = sigma.copy(), np.zeros((len(sigma), len(law.memory)))
    de = np.zeros((len(sigma), 3)) if de is None else de
    law.respond(law.constants(), out.reshape(-1), np.ascontiguousarray(de).reshape(-1), history.reshape(-1))
    return out, history


def returned(law: Any, trial: Floats) -> Floats:
    """Return of principal stresses (P,3), as xx, yy, zz."""
    return respond(law, np.column_stack([trial, np.zeros(len(trial))]))[0][:, :3]


def turned(sigma: Floats, angle: Floats) -> Floats:
    """R sigma R^T of (P,4), each by its angle (P,)."""
    R = np.stack([np.cos(angle), -np.sin(angle), np.sin(angle), np.cos(angle)], axis=-1).reshape(-1, 2, 2)
    out = R @ sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2) @ R.transpose(0, 2, 1)
    return np.column_stack([out[:, 0, 0], out[:, 1, 1], sigma[:, 2], out[:, 0, 1]])


def eigenvalues(sigma: Floats) -> Floats:
    """Principal stresses (P,3) of (P,4), largest first, by LAPACK."""
    whole = np.zeros((len(sigma), 3, 3))
    whole[:, 0, 0], whole[:, 1, 1], whole[:, 2, 2] = sigma[:, 0], sigma[:, 1], sigma[:, 2]
    whole[:, 0, 1] = whole[:, 1, 0] = sigma[:, 3]
    values: Floats = np.linalg.eigvalsh(whole)[:, ::-1]
    return values


def planes(law: Any) -> tuple[Floats, Floats, Floats]:
    """Normals a (9,3), offsets (9,) and flows b (9,3): six planes of Mohr-Coulomb, three of the cut-off."""
    k, m = ((1 + np.sin(angle)) / (1 - np.sin(angle)) for angle in np.radians([law.phi, law.psi]))
    a, b = np.zeros((9, 3)), np.zeros((9, 3))
    for row, (i, j) in enumerate(AXES):
        a[row, i], a[row, j], b[row, i], b[row, j] = k, -1, m, -1
    a[6:], b[6:] = np.eye(3), np.eye(3)
    return a, np.r_[np.full(6, 2 * law.c * np.sqrt(k)), np.full(3, law.sigma_t)], b


def excess(law: Any, sigma: Floats) -> Floats:
    """Largest a . sigma - offset over the nine planes, (P,)."""
    a, offset, _ = planes(law)
    return (sigma @ a.T - offset).max(axis=1)


def enumerated(law: Any, trial: Floats, use: int = 9) -> tuple[Floats, Floats]:
    """Stress (P,3) by Koiter's rule over the first `use` planes, and what remains of its inequalities (P,).

    Both as shares of the size of the trial stress. A remainder that is not round-off: no flow leads back.
    """
    a, offset, b = (item[:use] for item in planes(law))
    D = stiffness(law)
    a_size = np.abs(a).max(axis=1)
    size = np.abs(trial).max(axis=1) + offset.max()
    f = trial @ a.T - offset
    best, left = trial.copy(), (f / a_size).max(axis=1).clip(0) / size
    for active in (list(chosen) for count in (1, 2, 3) for chosen in combinations(range(use), count)):
        M = a[active] @ D @ b[active].T
        if np.linalg.cond(M) > 1e9:
            continue
        multiplier = np.linalg.solve(M, f[:, active].T).T
        sigma = trial - multiplier @ b[active] @ D
        wrong = np.maximum(
            ((sigma @ a.T - offset) / a_size).max(axis=1), -(multiplier * np.diag(D)[0]).min(axis=1)
        ).clip(0) / size  # fmt: skip
        better = wrong < left
        best[better], left[better] = sigma[better], wrong[better]
    return best, left


def region(law: Any, trial: Floats, sigma: Floats, tolerance: float = 1e-9) -> NDArray[np.str_]:
    """Which part of the surface holds the principal stress sigma (P,3): by the sorted stress itself."""
    s1, s2, s3 = np.sort(sigma)[:, ::-1].T
    near = tolerance * np.abs(trial).max(axis=1)
    moved = np.abs(sigma - trial).max(axis=1) > near
    a, offset, _ = planes(law)
    k = -a[0].max() / a[0].min()
    apex = offset[0] / (k - 1) if k > 1 else np.inf
    plane, cut = np.abs(k * s1 - s3 - offset[0]) < near * k, np.abs(s1 - law.sigma_t) < near
    major, minor = s1 - s2 < near, s2 - s3 < near
    names: list[tuple[str, Any]] = [
        ("elastic", ~moved),
        ("apex", (major & minor & (np.abs(s1 - apex) < near))),
        ("cut-off apex", cut & major & minor),
        ("corner s1 = s2", cut & plane & major),
        ("corner s2 = s3", cut & plane & minor),
        ("plane and cut-off", cut & plane),
        ("cut-off edge", cut & major),
        ("cut-off", cut),
        ("edge s1 = s2", plane & major),
        ("edge s2 = s3", plane & minor),
        ("plane", plane),
    ]
    return np.select([test for _, test in names], [name for name, _ in names], "nowhere")


def drive(law: Any, sigma: Floats, de: Any, held: int, steps: int) -> tuple[Floats, Floats]:
    """Stress (steps,4) and strain in yy (steps,) while the stress component `held` stays: (0 xx or 1 yy).

    `de` gives the strain increment (3,) for the one that is sought, and the secant method finds that one.
    """
    target, stresses, sought, last = sigma[0, held], [], [], 0.0
    for _ in range(steps):
        x0, x1 = last, last + 1e-7
        r0 = respond(law, sigma, np.array([de(x0)]))[0][0, held] - target
        for _ in range(60):
            r1 = respond(law, sigma, np.array([de(x1)]))[0][0, held] - target
            if abs(r1) <= 1e-13 * abs(target) or r1 == r0:
                break
            x0, x1, r0 = x1, x1 - r1 * (x1 - x0) / (r1 - r0), r1
        assert abs(r1) < 1e-11 * abs(target)
        sigma, _ = respond(law, sigma, np.array([de(x1)]))
        last = x1
        stresses.append(sigma[0])
        sought.append(x1)
    return np.array(stresses), np.array(sought)


def simple_shear(law: Any, p0: float, shear: float, steps: int) -> tuple[float, float]:
    """tau / |s_yy| and de_yy / dgamma at the end, from isotropic p0, with s_yy constant and e_xx = 0."""
    per = shear / steps
    sigma, de = drive(law, -p0 * np.array([[1.0, 1.0, 1.0, 0.0]]), lambda x: [0.0, x, per / 2], 1, steps)
    return sigma[-1, 3] / p0, de[-1] / per


def biaxial(law: Any, p0: float, strain: float, steps: int) -> tuple[Floats, Floats]:
    """Stress (steps,4) and de_xx / |de_yy| (steps,): shortened in y by `strain` with s_xx constant."""
    per = strain / steps
    sigma, de = drive(law, -p0 * np.array([[1.0, 1.0, 1.0, 0.0]]), lambda x: [x, -per, 0.0], 0, steps)
    return sigma, de / per
