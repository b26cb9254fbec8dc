"""Each law against the derivative of its own energy: the stress is written by hand, the energy is what MMS trusts."""

from typing import Any

import numpy as np
import pytest

from solver.plugins import available, create, load
from solver.state import Floats, Particles

LAWS = available("solver.material")
SMALL = {"linear_elastic"}  # consistent with their energy to first order in the amplitude only, as they say
every_law = pytest.mark.parametrize("name", LAWS)
STEP = 1e-30


def first_piola(law: Any, F: Floats) -> Floats:
    """P = dW/dF (3,3) of F (3,3), by the complex step: exact to round-off."""
    P = np.empty((3, 3))
    for i in range(3):
        for j in range(3):
            moved = F.astype(complex)
            moved[i, j] += 1j * STEP
            P[i, j] = law.energy(moved.tolist(), np.log).imag / STEP
    return P


def plane(F: Floats) -> Floats:
    """F (3,3) of plane strain."""
    whole = np.eye(3)
    whole[:2, :2] = F
    return whole


def cauchy(law: Any, F: Floats) -> Floats:
    """sigma = P F^T / J as xx, yy, zz, xy."""
    sigma = first_piola(law, plane(F)) @ plane(F).T / np.linalg.det(F)
    return sigma[[0, 1, 2, 0], [0, 1, 2, 1]]


def stress(law: Any, F: Floats) -> Floats:
    """What the solver computes for F (P,2,2)."""
    count = len(F)
    p = Particles(np.zeros((count, 2)), np.ones(count), np.ones(count), np.zeros((count, 0)))
    p.F, p.sigma = np.ascontiguousarray(F), np.full((count, 4), np.nan)
    law.update(p, 1e-3)
    return p.sigma


def random_f(rng: np.random.Generator, count: int) -> Floats:
    """Large strains and rotations of either sign, det F > 0.1."""
    F = np.eye(2) + 0.8 * rng.standard_normal((4 * count, 2, 2))
    return F[np.linalg.det(F) > 0.1][:count]


def parametrised(name: str) -> list[Any]:
    return [create("solver.material", name + extra) for extra in ("", ":E=70.0,nu=0.45,rho0=3", ":E=2e5,nu=-0.4")]


@pytest.mark.parametrize("name", [name for name in LAWS if name not in SMALL])
def test_stress_is_the_derivative_of_the_energy(name: str) -> None:
    for law in parametrised(name):
        F = random_f(np.random.default_rng(1), 200)
        assert len(F) == 200
        mine, theirs = stress(law, F), np.array([cauchy(law, f) for f in F])
        size = np.abs(theirs).max(axis=1)
        assert (np.abs(mine - theirs).max(axis=1) < 1e-10 * size).all()


@pytest.mark.parametrize("name", sorted(SMALL))
def test_a_small_strain_law_is_consistent_to_first_order(name: str) -> None:
    """Cauchy and first Piola stress differ at second order in the amplitude: the rate is 2, and the difference real."""
    for law in parametrised(name):
        G = np.random.default_rng(2).uniform(-1, 1, (20, 2, 2))
        amplitudes = np.array([1e-2, 1e-3, 1e-4, 1e-5])
        error = []
        for a in amplitudes:
            F = np.eye(2) + a * G
            error.append(np.abs(stress(law, F) - [cauchy(law, f) for f in F]).max() / law.E)
        rates = -np.diff(np.log10(error))
        np.testing.assert_allclose(rates, 2, atol=0.03)
        assert 0.1 < error[0] / amplitudes[0] ** 2 < 20
        P = np.array([first_piola(law, plane(np.eye(2) + 0.3 * g)) for g in G])
        np.testing.assert_allclose(
            stress(law, np.eye(2) + 0.3 * G), P[:, [0, 1, 2, 0], [0, 1, 2, 1]], atol=1e-9 * law.E
        )


@every_law
def test_undeformed_is_free_of_stress(name: str) -> None:
    for law in parametrised(name):
        assert (stress(law, np.eye(2)[None]) == 0).all()
        assert np.abs(first_piola(law, np.eye(3))).max() < 1e-13 * law.E


@pytest.mark.parametrize("count", [1, 31, 32, 33, 1000])
@every_law
def test_any_number_of_particles(name: str, count: int) -> None:
    """Row by row the same, whatever the block and its length."""
    law = create("solver.material", name)
    F = random_f(np.random.default_rng(3), count)
    one = np.concatenate([stress(law, f[None]) for f in F])
    np.testing.assert_allclose(stress(law, F), one, rtol=1e-14, atol=1e-14 * law.E)


def turned(sigma: Floats, Q: Floats) -> Floats:
    """Q sigma Q^T of (P,4)."""
    full = sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2)
    full = Q @ full @ Q.T
    return np.stack([full[:, 0, 0], full[:, 1, 1], sigma[:, 2], full[:, 0, 1]], axis=1)


@pytest.mark.parametrize("angle", [0.3, np.pi / 2, -2.0])
@pytest.mark.parametrize("name", [name for name in LAWS if name not in SMALL])
def test_objective_and_isotropic(name: str, angle: float) -> None:
    """sigma(Q F) = Q sigma(F) Q^T, and sigma(F Q) = sigma(F)."""
    law = create("solver.material", name)
    F = random_f(np.random.default_rng(4), 100)
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    sigma = stress(law, F)
    size = np.abs(sigma).max(axis=1, keepdims=True)
    assert (np.abs(stress(law, Q @ F) - turned(sigma, Q)) < 1e-11 * size).all()
    assert (np.abs(stress(law, F @ Q) - sigma) < 1e-11 * size).all()


@every_law
def test_small_strain_limit(name: str) -> None:
    """To first order all laws are Hooke's, in plane strain: sigma = lam tr e + 2 mu e."""
    for law in parametrised(name):
        H = 1e-7 * np.random.default_rng(5).standard_normal((50, 2, 2))
        exx, eyy, exy = H[:, 0, 0], H[:, 1, 1], (H[:, 0, 1] + H[:, 1, 0]) / 2
        bulk = law.E * law.nu / ((1 + law.nu) * (1 - 2 * law.nu)) * (exx + eyy)
        shear = law.E / (1 + law.nu)
        hooke = np.stack([bulk + shear * exx, bulk + shear * eyy, bulk, shear * exy], axis=1)
        np.testing.assert_allclose(stress(law, np.eye(2) + H), hooke, atol=1e-5 * np.abs(hooke).max())


@pytest.mark.parametrize(
    "text", ["E=0", "E=-1", "E=nan", "rho0=0", "rho0=-2", "rho0=nan", "nu=0.5", "nu=0.7", "nu=-1", "nu=-3", "nu=nan"]
)
@every_law
def test_bad_parameters(name: str, text: str) -> None:
    with pytest.raises(ValueError, match="must"):
        create("solver.material", f"{name}:{text}")


@every_law
def test_parameters_are_named(name: str) -> None:
    with pytest.raises(ValueError, match="has no parameter 'G'; it has E, nu, rho0"):
        create("solver.material", f"{name}:G=1")
    with pytest.raises(ValueError, match="is no number"):
        create("solver.material", f"{name}:E=soft")
    with pytest.raises(ValueError, match=f"choose from .*{name}"):
        load("solver.material", name + "s")


@every_law
def test_wave_speed(name: str) -> None:
    """rho0 c^2 is the uniaxial stiffness of the energy; 116.02 for the paper's constants."""
    assert create("solver.material", name).wave_speed() == pytest.approx(116.0239, rel=1e-6)
    for law in parametrised(name):
        h = 1e-5
        ends = [first_piola(law, np.diag([1 + s * h, 1, 1]))[0, 0] for s in (1, -1)]
        assert law.wave_speed() ** 2 * law.rho0 == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-8)


def test_parameters_are_frozen() -> None:
    with pytest.raises(AttributeError):
        create("solver.material", LAWS[0]).E = 1.0
