"""The element driver: mixed control against linear elasticity, paths as data and from files, what cannot go on."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mpm_verify.cases.element.curves import EnergyElement, columns, energy_stress, start
from mpm_verify.cases.element.element import Element, ElementFailed, ElementFailure, State, stretch
from mpm_verify.cases.element.exact import exact
from mpm_verify.cases.element.following import follow, moves
from mpm_verify.cases.element.legs import STRESS
from mpm_verify.cases.element.path_file import from_file
from mpm_verify.cases.element.paths import TESTS, given, held
from mpm_verify.cases.element.study import study
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.plugins import create

ELASTIC = Hypoelastic(E=840e3)
every_test = pytest.mark.parametrize("name", [name for name, test in TESTS.items() if not test.motion])


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
            np.testing.assert_allclose(found.strain @ weights, condition.fraction * gone, atol=1e-12)
        else:
            held = found.sigma[:, STRESS[: len(weights)]] @ weights
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
        ("", "must have a header with exx, eyy, and exy or gxy"),
        ("# only\n\n", "must have a header with exx, eyy, and exy or gxy"),
        ("exx,eyy\n0,0\n1,1\n", "must have a header with .* its first line has exx, eyy"),
        ("0,0,0\n0,1,0\n", "its first line has 0, 0, 0"),
        ("exx,ezz,gxz\n0,0,0\n", "its first line has exx, ezz, gxz"),
        ("exx,eyy,exy\n", "must have two rows"),
        ("exx,eyy,exy\n0,0,0\n", "must have two rows"),
        ("exx,eyy,exy\n0,0,0\n0,0,0\n", "must have strains that change"),
        ("exx,eyy,exy\n0,0,0\n0.1,soft,0\n", "line 3: eyy = 'soft' must be a finite number"),
        ("exx,eyy,exy\n0,0,0\n0.1,1_0,0\n", "line 3: eyy = '1_0' must be a finite number"),
        ("exx,eyy,exy\n0,0,0\n0.1,,0\n", "line 3: eyy is empty"),
        ("exx,eyy,exy\n0,0,0\n0.1,nan,0\n", "line 3: eyy = 'nan' must be a finite number"),
        ("exx,eyy,exy\n0,0,0\n0.1,inf,0\n", "line 3: eyy = 'inf' must be a finite number"),
        ("exx,eyy,exy\n0,0,0\n0.1,0\n", "line 3: 2 cells, and the header has 3"),
        ("exx,eyy,exy\n0,0,0\n0,0,01,0\n", "line 3: 4 cells, .* semicolons must separate"),
        ("exx,exx,eyy,exy\n0,0,0,0\n0.1,0,0,0\n", "two columns exx"),
        ("exx,EXX,eyy,exy\n0,0,0,0\n0.1,0,0,0\n", "two columns exx"),
        ("exx,eyy,exy,gxy\n0,0,0,0\n0.1,0,0,0\n", "both exy and gxy"),
        ("exx [%],eyy,exy\n0,0,0\n0.1,0,0\n", r"eyy has no unit; write eyy \[%\] or \[-\]"),
        ("exx [1e-6],eyy,exy\n0,0,0\n0.1,0,0\n", r"exx is in 1e-6; strains are taken in \[%\]"),
        (b"exx,eyy,exy\n\xff\xfe\n", "is not CSV text in UTF-8"),
        ("exx,eyy,exy\n0,0,0\n0.1,0,0\n".encode("utf-16"), "UTF-16 text .* save it as CSV in UTF-8"),
        ("exx,eyy,exy\n0,0,0\n0.1,0,0\n".encode("utf-16-le"), "UTF-16 text"),
    ],
)
def test_a_bad_path_is_one_line(text: str | bytes, words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=words) as told:
        from_file(write(tmp_path, text))
    assert "\n" not in str(told.value)
    with pytest.raises(ValueError, match="no such file"):
        from_file(tmp_path / "none.csv")


@pytest.mark.parametrize(
    "name",
    ["exz", "gyz", "EXZ", "eyx", "gyx", "e33", "eps_zz", "gamma_xz", "ez", "\u03b5zz [%]", "syz", "sigma_xx", "Fxz"],
)
def test_a_strain_that_would_not_be_used_is_refused(name: str, tmp_path: Path) -> None:
    """The line says what is taken; a stress or component of F too."""
    text = f"time,exx,eyy,{name},gxy\n0,0,0,0,0\n1,0.003,-0.01,0.003,0\n"
    with pytest.raises(ValueError, match=r"taken are exx, eyy, and exy or gxy .*, ezz, or a motion Fxx") as told:
        from_file(write(tmp_path, text))
    assert name.partition(" ")[0].lower() in str(told.value)


@pytest.mark.parametrize("name", ["ezz", "exz", "gyz", "eps_33"])
def test_a_strain_out_of_the_plane_that_is_zero_is_taken(name: str, tmp_path: Path) -> None:
    test = from_file(write(tmp_path, f"exx,eyy,{name},gxy\n0,0,0,0\n0.003,-0.01,0.0,0\n"))
    assert test.source is not None
    assert (test.source.zero, test.source.unused) == ((name,), ())
    np.testing.assert_array_equal(test.points, [[0, 0, 0], [0.003, -0.01, 0]])


def test_other_columns_are_named(tmp_path: Path) -> None:
    """Columns told by name, or by number where they have none; a column without name and content is nobody's."""
    test = from_file(write(tmp_path, ",time,exx,eyy,gxy,note,\n0,0,0,0,0,,\n1,1,0.003,-0.01,0,end,\n"))
    assert test.source is not None
    assert test.source.unused == ("column 1 without a name", "time", "note")


SAME = {
    "byte order mark": "\ufeffexx,eyy,gxy\n0,0,0\n0.002,-0.01,0.004\n",
    "tabs": "time\texx\teyy\tgxy\n0\t0\t0\t0\n1\t0.002\t-0.01\t0.004\n",
    "semicolons": "exx;eyy;gxy\n0;0;0\n0.002;-0.01;0.004\n",
    "decimal commas": "sep=;\nexx;eyy;gxy\n0;0;0\n0,002;-0,01;4,0e-3\n",
    "tabs and decimal commas": "exx\teyy\tgxy\n0\t0\t0\n0,002\t-0,01\t0,004\n",
    "quotes": '"exx","eyy","gxy"\n"0","0","0"\n"0,002","-0,01","0.004"\n',
    "spaces": "  exx   eyy gxy\n 0 0  0\n0.002  -1e-2 4.0D-3\n",
    "comments": "# a path\n\nexx,eyy,gxy # fractions\n0,0,0\n# turns\n\n0.002,-0.01,0.004 # end\n,,\n",
    "header in a comment": "# exx eyy gxy\n0 0 0\n2.0e-03 -1.0e-02 4.0e-03\n",
    "line ends": "exx,eyy,gxy\r\n0,0,0\r\n0.002,-0.01,0.004\r\n",
    "old line ends": "exx,eyy,gxy\r0,0,0\r0.002,-0.01,0.004\r",
    "upper case": " EXX , Eyy ,GXY\n0, 0, 0\n 0.002 , \u22120.01,0.004\n",
    "per cent": "exx [%],eyy [%],gxy [%]\n0,0,0\n0.2,-1.0,0.4\n",
    "per cent by name": "exx_pct;eyy (percent);gxy in %\n0;0;0\n0,2;-1,0;0,4\n",
    "per cent and spaces": "exx [%] eyy [%] gxy [-]\n0 0 0\n0.2 -1.0 0.004\n",
    "per cent in the cells": "exx,eyy,gxy\n0,0,0\n0.2 %,-1%,0.4%\n",
    "fractions by name": "exx [-],eyy [m/m],gxy [1]\n0,0,0\n0.002,-0.01,0.004\n",
}


@pytest.mark.parametrize("kind", SAME)
def test_one_path_in_many_hands(kind: str, tmp_path: Path) -> None:
    test = from_file(write(tmp_path, SAME[kind]))
    np.testing.assert_allclose(test.points, [[0, 0, 0], [0.002, -0.01, 0.002]], rtol=1e-15)


def test_strains_that_may_be_percentages(tmp_path: Path) -> None:
    """A question with what to type; each answer is taken, up to what a strain can be; a contradiction is not."""
    path = write(tmp_path, "exx,eyy,gxy\n0,0,0\n0,-1.0,0\n0,-5.0,0\n")
    with pytest.raises(ValueError, match=r"line 3: eyy = -1.0 .* in per cent\? .*--units percent; .*--units fraction"):
        from_file(path)
    np.testing.assert_allclose(from_file(path, "percent").points[:, 1], [0, -0.01, -0.05])
    np.testing.assert_allclose(from_file(path, "fraction").points[:, 1], [0, -1, -5])
    with pytest.raises(ValueError, match="--units pct must be one of percent, fraction"):
        from_file(path, "pct")
    write(tmp_path, "exx,eyy,gxy\n0,0,0\n0,0.5,0\n")
    assert from_file(path).points[1, 1] == 0.5
    write(tmp_path, "exx,eyy,gxy\n0,0,0\n0,-10.5,0\n")
    with pytest.raises(ValueError, match=r"line 3: eyy = -10.5 is a strain of -10.5; write strains up to 10"):
        from_file(path, "fraction")
    write(tmp_path, "exx [%],eyy [%],gxy [%]\n0,0,0\n0,-1.0,0\n")
    np.testing.assert_allclose(from_file(path, "percent").points[:, 1], [0, -0.01])
    with pytest.raises(ValueError, match="exx is in percent by its header, not in fraction; leave --units out"):
        from_file(path, "fraction")
