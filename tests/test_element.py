"""The element driver: mixed control against linear elasticity, paths as data and from files, what cannot go on."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mpm_verify.cases.element.curves import EnergyElement, columns, energy_stress, start
from mpm_verify.cases.element.element import Element, ElementFailed, ElementFailure, State, stretch
from mpm_verify.cases.element.exact import exact
from mpm_verify.cases.element.path_file import from_file
from mpm_verify.cases.element.paths import TESTS, follow, given, held, moves
from mpm_verify.cases.element.study import study
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.plugins import create

ELASTIC = Hypoelastic(E=840e3)
every_test = pytest.mark.parametrize("name", TESTS)


@every_test
def test_every_condition_is_kept(name: str) -> None:
    """Strain conditions go through their share, stress conditions stay, for a law that yields."""
    test, law = TESTS[name], MohrCoulomb()
    found = follow(Element(law), test, test.steps(24), start(law, test, 5e3))
    assert not found.failed
    gone = test.gone(test.steps(24))
    for condition in test.conditions:
        weights = np.array(condition.weights)
        if condition.of == "strain":
            np.testing.assert_allclose(found.strain @ weights, condition.share * gone, atol=1e-12)
        else:
            held = found.sigma[:, [0, 1, 3]] @ weights
            np.testing.assert_allclose(held, held[0], rtol=1e-9)


@every_test
def test_elastic_paths_are_exact_in_any_number_of_steps(name: str) -> None:
    known = exact(ELASTIC, TESTS[name], 5e3)
    assert known is not None
    for steps in (1, 7):
        test = TESTS[name]
        found = columns(test, follow(Element(ELASTIC), test, test.steps(steps), start(ELASTIC, test, 5e3)))
        for key in ("s", "t", "ev", "gamma"):
            size = np.abs(known[0][key]).max() + 1e-9
            assert abs(found[key][-1] - known[0][key][-1]) < 1e-9 * size + 1e-12


def test_oedometric_stress_is_that_of_the_logarithmic_strain() -> None:
    """sigma = M e and K0, for any length."""
    test = replace(TESTS["oedometric"], length=0.3)
    end = follow(Element(ELASTIC), test, 3, np.zeros(4))
    M = ELASTIC.lam + 2 * ELASTIC.mu
    np.testing.assert_allclose(end.sigma[-1], [-0.3 * ELASTIC.lam, -0.3 * M, -0.3 * ELASTIC.lam, 0], rtol=1e-12)


@pytest.mark.parametrize("name", ["neo_hookean", "linear_elastic"])
def test_laws_of_f_meet_the_derivative_of_their_energy(name: str) -> None:
    law = create("mpm_verify.solver.material", f"{name}:E=840e3")
    test = TESTS["biaxial"]
    ends = [follow(kind(law), test, 6, np.zeros(4)) for kind in (Element, EnergyElement)]
    np.testing.assert_allclose(ends[0].sigma, ends[1].sigma, atol=1e-8 * np.abs(ends[1].sigma).max())
    wrong = create("mpm_verify.solver.material", f"{name}:E=840e3,nu=0.31")
    other = follow(EnergyElement(wrong), test, 6, np.zeros(4))
    assert np.abs(ends[0].sigma - other.sigma).max() > 1e-3 * np.abs(other.sigma).max()  # and another law is seen
    assert energy_stress(law, np.zeros(3)) == pytest.approx(np.zeros(4), abs=1e-9)


def test_stretch_is_the_exponential() -> None:
    from scipy.linalg import expm

    strains = np.array([[0.3, -0.2, 0.1], [0.1, 0.1, 0.0], [0.1, 0.1, 1e-9], [-2.0, 1.0, 3.0]])
    for strain, F in zip(strains, stretch(strains), strict=True):
        np.testing.assert_allclose(F, expm(np.array([[strain[0], strain[2]], [strain[2], strain[1]]])), rtol=1e-12)


def test_corners_of_cycles_fall_on_steps() -> None:
    test = TESTS["cyclic_shear"]
    gone = test.gone(test.steps(100))
    assert gone.max() == test.length
    assert gone.min() == -test.length
    assert np.ptp(np.abs(np.diff(gone))) < 1e-15
    assert np.sign(np.diff(gone)).tolist().count(1.0) == len(gone) // 2


def test_what_cannot_go_on_ends_as_data() -> None:
    """Without dilation a failing element cannot grow at a constant lateral stress: step and reason are told."""
    growing = (held(1, 0, 0), given((1, 1, 0), 1.0), given((0, 0, 1), 0.0))
    stuck, law = replace(TESTS["biaxial"], conditions=growing, length=0.05), MohrCoulomb(psi=0.0)
    found = follow(Element(law), stuck, 20, np.array([-5e3, -5e3, -5e3, 0.0]))
    assert found.failed.cause is ElementFailure.NO_STRAIN
    assert found.failed.steps == 20
    assert len(found.sigma) == found.failed.step < 21
    assert np.isfinite(found.sigma).all()
    told = study(law, stuck, 5e3, 20)
    assert told.failed
    assert np.isnan(told.errors).any()


def test_no_strain_leads_to_a_stress_beyond_strength() -> None:
    element = Element(MohrCoulomb())
    state = element.start(np.array([-5e3, -5e3, -5e3, 0.0]))

    def beyond(de: np.ndarray, end: State) -> np.ndarray:
        return np.array([end.sigma[0] + 5e3, end.sigma[1] + 5e4, de[2]])

    with pytest.raises(ElementFailed, match="no_strain"):
        element.solve(state, beyond, np.array([0, -1e-2, 0]), np.array([5e3, 5e3, 1e-2]))


def test_order_is_seen_and_round_off_has_none() -> None:
    """UBCSAND is of order 2, Mohr-Coulomb of order 1 where the axes turn and exact where they do not."""
    sand = study(Ubcsand(), TESTS["undrained"], 5e3, 25)
    assert sand.order == pytest.approx(2, abs=0.1)
    assert study(MohrCoulomb(), TESTS["shear_stress"], 5e3, 25).order == pytest.approx(1, abs=0.15)
    flat = study(MohrCoulomb(), TESTS["biaxial"], 5e3, 10)
    assert np.isnan(flat.order)
    assert max(flat.errors) < 1e-10


# ---- strain paths from files


def write(folder: Path, text: str | bytes) -> Path:
    path = folder / "path.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def test_a_path_from_a_file(tmp_path: Path) -> None:
    """Rows are corners; gxy is twice exy; the curve goes through all of them."""
    test = from_file(write(tmp_path, "exx, eyy, gxy\n0,0,0\n0.001,-0.002,0\n0.001,-0.002,0.004\n"))
    assert test.legs == 2
    found = follow(Element(ELASTIC), test, test.steps(3), np.zeros(4))
    np.testing.assert_allclose(found.strain[[2, 4]], [[1e-3, -2e-3, 0], [1e-3, -2e-3, 2e-3]], atol=1e-15)
    assert moves(test, 4).sum(axis=0) == pytest.approx([1e-3, -2e-3, 2e-3])
    tensor = from_file(write(tmp_path, "eyy,exx,exy\n0,0,0\n-0.002,0.001,0.002\n"))
    np.testing.assert_allclose(tensor.points[-1], [1e-3, -2e-3, 2e-3])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "must have a header with exx, eyy and exy"),
        ("exx,eyy\n0,0\n1,1\n", "must have a header with exx, eyy and exy"),
        ("exx,eyy,exy\n", "must have a header"),
        ("exx,eyy,exy\n0,0,0\n", "must have two rows"),
        ("exx,eyy,exy\n0,0,0\n0,0,0\n", "must have strains that change"),
        ("exx,eyy,exy\n0,0,0\n0.1,soft,0\n", "line 3: eyy = 'soft' must be a number"),
        ("exx,eyy,exy\n0,0,0\n0.1,,0\n", "line 3: eyy = '' must be a number"),
        ("exx,eyy,exy\n0,0,0\n0.1,nan,0\n", "line 3: eyy = nan must be finite"),
        ("exx,eyy,exy\n0,0,0\n0.1,inf,0\n", "line 3: eyy = inf must be finite"),
        ("exx,eyy,exy\n0,0,0\n0.1,50,0\n", "line 3: eyy = 50.0 must be"),
        (b"exx,eyy,exy\n\xff\xfe\n", "is no CSV text"),
    ],
)
def test_a_bad_path_is_one_line(text: str | bytes, words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=words) as told:
        from_file(write(tmp_path, text))
    assert "\n" not in str(told.value)
    with pytest.raises(ValueError, match="no such file"):
        from_file(tmp_path / "none.csv")
