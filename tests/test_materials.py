"""Each law against the derivative of its own energy: the stress is written by hand, the energy is what MMS trusts.

Laws in rate form have no energy; here is what they share with the others. Their own: test_rates.py and a file a law.
"""

from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.solver.elastic import Elastic
from mpm_verify.solver.plugins import available, create, load
from mpm_verify.solver.rate_material import RateMaterial
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.verify.main import main

LAWS = available("mpm_verify.solver.material")
WITH_ENERGY = [name for name in LAWS if load("mpm_verify.solver.material", name).energy is not None]
ENERGETIC = [name for name in WITH_ENERGY if load("mpm_verify.solver.material", name).rate is None]  # functions of F
ELASTIC = [name for name in LAWS if issubclass(load("mpm_verify.solver.material", name), Elastic)]
HOOKEAN = [*ENERGETIC, "hypoelastic"]  # elastic from no stress on, however small it is
SMALL = {"linear_elastic"}  # consistent with their energy to first order in the amplitude only, as they say
every_law = pytest.mark.parametrize("name", LAWS)
every_energy = pytest.mark.parametrize("name", ENERGETIC)
STEP = 1e-30
OWN = """
import sympy as sp

def displacement(X, t):
    return 0.01 * sp.sin(sp.pi * X[0]) * t, 0 * X[1]

def domain():
    return {"lower": (0, 0), "upper": (1, 1), "duration": 0.01, "speed": 100.0, "material": "hypoelastic"}
"""


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
    if not isinstance(law, RateMaterial):  # a function of F does not read what it writes
        p.sigma[:] = np.nan
    law.start(p)
    p.F = np.ascontiguousarray(F)
    law.update(p, 1e-3)
    return p.sigma


def random_f(rng: np.random.Generator, count: int) -> Floats:
    """Large strains and rotations of either sign, det F > 0.1."""
    F = np.eye(2) + 0.8 * rng.standard_normal((4 * count, 2, 2))
    return F[np.linalg.det(F) > 0.1][:count]


def parametrised(name: str) -> list[Any]:
    return [
        create("mpm_verify.solver.material", name + extra) for extra in ("", ":E=70.0,nu=0.45,rho0=3", ":E=2e5,nu=-0.4")
    ]


@pytest.mark.parametrize("name", [name for name in ENERGETIC if name not in SMALL])
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
    assert (stress(create("mpm_verify.solver.material", name), np.eye(2)[None]) == 0).all()


@every_energy
def test_energy_is_least_where_undeformed(name: str) -> None:
    for law in parametrised(name):
        assert (stress(law, np.eye(2)[None]) == 0).all()
        assert np.abs(first_piola(law, np.eye(3))).max() < 1e-13 * law.E


@pytest.mark.parametrize("count", [1, 31, 32, 33, 1000])
@every_law
def test_any_number_of_particles(name: str, count: int) -> None:
    """Row by row the same, whatever the block and its length."""
    law = create("mpm_verify.solver.material", name)
    F = random_f(np.random.default_rng(3), count)
    one = np.concatenate([stress(law, f[None]) for f in F])
    assert np.isfinite(one).any()
    np.testing.assert_allclose(stress(law, F), one, rtol=1e-14, atol=1e-14 * law.rho0 * law.wave_speed() ** 2)


def turned(sigma: Floats, Q: Floats) -> Floats:
    """Q sigma Q^T of (P,4)."""
    full = sigma[:, [0, 3, 3, 1]].reshape(-1, 2, 2)
    full = Q @ full @ Q.T
    return np.stack([full[:, 0, 0], full[:, 1, 1], sigma[:, 2], full[:, 0, 1]], axis=1)


@pytest.mark.parametrize("angle", [0.3, np.pi / 2, -2.0])
@pytest.mark.parametrize("name", [name for name in ENERGETIC if name not in SMALL])
def test_objective_and_isotropic(name: str, angle: float) -> None:
    """sigma(Q F) = Q sigma(F) Q^T, and sigma(F Q) = sigma(F)."""
    law = create("mpm_verify.solver.material", name)
    F = random_f(np.random.default_rng(4), 100)
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    sigma = stress(law, F)
    size = np.abs(sigma).max(axis=1, keepdims=True)
    assert (np.abs(stress(law, Q @ F) - turned(sigma, Q)) < 1e-12 * size).all()
    assert (np.abs(stress(law, F @ Q) - sigma) < 1e-12 * size).all()


@pytest.mark.parametrize("name", HOOKEAN)
def test_small_strain_limit(name: str) -> None:
    """First order: all laws are Hooke's, in plane strain: sigma = lam tr e + 2 mu e."""
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
@pytest.mark.parametrize("name", ELASTIC)
def test_bad_parameters(name: str, text: str) -> None:
    with pytest.raises(ValueError, match="must"):
        create("mpm_verify.solver.material", f"{name}:{text}")


@every_law
def test_parameters_are_named(name: str) -> None:
    own = ", ".join(item.name for item in fields(load("mpm_verify.solver.material", name)))
    assert "rho0" in own
    with pytest.raises(ValueError, match=f"{name} has no parameter 'G'; it has {own}"):
        create("mpm_verify.solver.material", f"{name}:G=1")
    with pytest.raises(ValueError, match="is not a number"):
        create("mpm_verify.solver.material", f"{name}:rho0=soft")
    with pytest.raises(ValueError, match=r"rho0 = -1.* must"):
        create("mpm_verify.solver.material", f"{name}:rho0=-1")
    with pytest.raises(ValueError, match=f"choose from .*{name}"):
        load("mpm_verify.solver.material", name + "s")


@every_law
def test_wave_speed_is_finite_and_of_no_rate(name: str) -> None:
    c = create("mpm_verify.solver.material", name).wave_speed()
    assert 0 < c < np.inf
    if issubclass(load("mpm_verify.solver.material", name), RateMaterial):
        assert create("mpm_verify.solver.material", f"{name}:rate=jaumann").wave_speed() == c


def test_wave_speed_of_the_elastic_part() -> None:
    """A soil of the same E, nu, rho0 has the same fastest wave: plastic ones are slower."""
    for name in ELASTIC:
        assert create("mpm_verify.solver.material", f"{name}:E=1e4,nu=0.3,rho0=1").wave_speed() == pytest.approx(
            116.0239, rel=1e-6
        )


@every_energy
def test_wave_speed(name: str) -> None:
    """rho0 c^2 is the uniaxial stiffness of the energy; 116.02 for the paper's constants."""
    assert create("mpm_verify.solver.material", name).wave_speed() == pytest.approx(116.0239, rel=1e-6)
    for law in parametrised(name):
        h = 1e-5
        ends = [first_piola(law, np.diag([1 + s * h, 1, 1]))[0, 0] for s in (1, -1)]
        assert law.wave_speed() ** 2 * law.rho0 == pytest.approx((ends[0] - ends[1]) / (2 * h), rel=1e-8)


def test_parameters_are_frozen() -> None:
    with pytest.raises(AttributeError):
        create("mpm_verify.solver.material", LAWS[0]).rho0 = 1.0


@pytest.mark.parametrize("name", [name for name in LAWS if name not in WITH_ENERGY])
def test_no_solution_is_manufactured_without_an_energy(name: str) -> None:
    """One sentence that names the laws that have one."""
    law, solution = create("mpm_verify.solver.material", name), create("mpm_verify.mms.solutions", "axis_aligned")
    with pytest.raises(ValueError, match=f"^{name} has no energy.* must be one of {', '.join(WITH_ENERGY)}$"):
        manufacture(solution, law, law.rho0)
    with pytest.raises(ValueError, match=f"^{name} has no energy"):
        build(Asked("mms", {"material": [name]}), "")


WITHOUT = {
    "mms": ["mms", "--material", "hypoelastic"],
    "mms with parameters": ["mms", "--material", "hypoelastic:rate=jaumann,nu=0.2", "--quick"],
    "audit": ["audit", "axis_aligned", "--material", "hypoelastic"],
    "audit of another": ["audit", "swirl", "--material", "mohr_coulomb:phi=30"],
}


@pytest.mark.parametrize("command", WITHOUT)
def test_commands_refuse_a_law_without_an_energy(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    line = complaint(WITHOUT[command], monkeypatch, capsys, tmp_path)
    assert "has no energy, so no manufactured solution can be derived for it" in line
    assert line.endswith(f"must be one of {', '.join(WITH_ENERGY)}\n")


@pytest.mark.parametrize("command", [["mms"], ["audit", "axis_aligned"]], ids=lambda words: words[0])
def test_commands_refuse_a_rate_that_is_none(
    command: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    line = complaint([*command, "--material", "hypoelastic:rate=spin"], monkeypatch, capsys, tmp_path)
    known = ", ".join(available("mpm_verify.solver.rates"))
    assert line == f"verify: no rate 'spin'; choose from {known}, or give a file: path/to/own.py\n"


def test_commands_refuse_a_file_whose_own_law_has_none(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A user's solution names its material itself."""
    (tmp_path / "own.py").write_text(OWN)
    for command in (["mms", "--solution"], ["audit"], ["graded", "--solution"]):
        assert "hypoelastic has no energy" in complaint([*command, "own.py"], monkeypatch, capsys, tmp_path)


def complaint(
    words: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], folder: Path
) -> str:
    """What the command says on standard error; exit code 2, nothing else said, and no file made."""
    before = sorted(folder.rglob("*"))
    monkeypatch.chdir(folder)
    monkeypatch.setattr("sys.argv", ["verify", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    out, err = capsys.readouterr()
    assert (ended.value.code, out, err.count("\n")) == (2, "", 1)
    assert sorted(folder.rglob("*")) == before
    return err
