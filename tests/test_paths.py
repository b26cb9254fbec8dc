"""Paths from files beyond strains in the plane: ezz, stresses, legs of both, and motions with their rates."""

import json
from dataclasses import replace
from math import sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller

from mpm_verify.cases.element.begin import begin
from mpm_verify.cases.element.case import check
from mpm_verify.cases.element.curves import element_of
from mpm_verify.cases.element.exact import exact
from mpm_verify.cases.element.exam import deformed, path_ends
from mpm_verify.cases.element.following import Followed, follow
from mpm_verify.cases.element.judged import checks
from mpm_verify.cases.element.motion import Motion
from mpm_verify.cases.element.path_file import from_file
from mpm_verify.cases.element.paths import TESTS, ElementTest
from mpm_verify.cases.element.rates_exact import bend, integrated
from mpm_verify.cases.element.run import ElementRun
from mpm_verify.cases.element.study import study
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.reports.sentences.remarks import sentence
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.plugins import MATERIALS, RATES, available, create
from mpm_verify.solver.state import Floats, Particles
from mpm_verify.verify.commands.element import rated, with_motion

SHEARED = "exx,eyy,gxy\n0,0,0\n0,0,2.5\n0,0,5.0\n"
TURNED = "Fxx,Fxy,Fyx,Fyy,Fzz\n1,0,0,1,1\n1.2,0.5,-0.2,0.9,1.1\n0.3,-1.0,1.1,0.4,1\n"
FLAT = TURNED.replace(",1.1\n", ",1\n", 1)
MIXED = (
    "exx,eyy,ezz,exy,sxx,syy,szz [kPa]\n0,0,0,0,-5000,-5000,-5\n,,,0,-10000,-10000,-10\n"
    ",-0.02,,0,-10000,,-10\n,-0.0199,,0,-10000,,-10\n"
)
SOILS = ("hypoelastic:E=840e3", "mohr_coulomb", "drucker_prager", "ubcsand")
every_rate = pytest.mark.parametrize("rate", available(RATES))


def written(folder: Path, text: str, units: str = "", motion: str = "none") -> ElementTest:
    path = folder / "mine.csv"
    path.write_text(text)
    return from_file(path, units, motion)


def walked(material: Any, test: ElementTest, least: int, stress: float = 5e3) -> Followed:
    return follow(element_of(material, test), test, test.steps(least), begin(material, test, stress))


def of(name: str) -> Any:
    return create(MATERIALS, name)


# ---- strains out of the plane, and stresses


def test_ezz_is_taken(tmp_path: Path) -> None:
    """Linear elasticity with three strains, to round-off; without it the stress is another."""
    test = written(tmp_path, "time,exx,eyy,ezz,gxy\n0,0,0,0,0\n1,0.003,-0.01,0.003,0\n")
    solid = Hypoelastic(E=840e3)
    end = walked(solid, test, 3).sigma[-1] + 5e3 * np.array([1, 1, 1, 0])
    lam, mu = solid.lam, solid.mu
    np.testing.assert_allclose(end[:3], lam * -0.004 + 2 * mu * np.array([0.003, -0.01, 0.003]), atol=1e-9)
    assert test.source is not None
    assert test.source.used == ("exx", "eyy", "gxy", "ezz")
    found = study(solid, test, 5e3, 3)
    assert found.source == "linear elasticity"
    assert max(found.errors) < 1e-12
    assert [one.outcome for one in checks(solid, found)] == [Outcome.PASS]


@pytest.mark.parametrize("name", SOILS)
def test_legs_of_stress_and_strain(name: str, tmp_path: Path) -> None:
    """Each leg ends where its row says: stresses in their units, strains where they are given."""
    test = written(tmp_path, MIXED)
    assert (test.legs, test.mixed, test.size) == (3, True, 4)
    found = walked(of(name), test, 60)
    assert not found.failed
    np.testing.assert_allclose(found.sigma[20, :3], -1e4, rtol=1e-9)
    for row, axial in ((40, -0.02), (60, -0.0199)):
        np.testing.assert_allclose(found.sigma[row, [0, 2]], -1e4, rtol=1e-9)
        assert found.strain[row, 1] == pytest.approx(axial, abs=1e-15)
    assert found.sigma[40, 1] < -1.7e4
    assert found.sigma[60, 1] > found.sigma[40, 1] + 10  # unloaded


def test_elastic_legs_have_an_exact_end(tmp_path: Path) -> None:
    solid = Hypoelastic(E=840e3)
    found = study(solid, written(tmp_path, MIXED), 5e3, 6)
    assert found.source == "linear elasticity"
    assert max(found.errors) < 1e-10
    known = exact(replace(solid, nu=0.31), written(tmp_path, MIXED), 5e3)
    assert known is not None
    assert abs(known[0]["ev"][-1] / found.curve["ev"][-1] - 1) > 1e-3


def test_a_triaxial_test_of_ones_own_is_the_ready_made_one(tmp_path: Path) -> None:
    text = "exx,eyy,ezz,exy,sxx,szz\n,0,,0,-5000,-5000\n,-0.05,,0,-5000,-5000\n"
    soil = MohrCoulomb(psi=10.0)
    mine, ready = walked(soil, written(tmp_path, text), 20), walked(soil, TESTS["triaxial_compression"], 20)
    np.testing.assert_allclose(mine.sigma, ready.sigma, atol=1e-9 * 5e3)
    np.testing.assert_allclose(mine.strain, ready.strain, atol=1e-11)


def test_stress_beyond_strength_fails_at_it(tmp_path: Path) -> None:
    """At the step that passes k s3, with the line of the file; what is left is more than any round-off."""
    soil = MohrCoulomb()
    test = written(tmp_path, "exx,eyy,exy,sxx,syy\n0,0,0,-5000,-5000\n,,0,-5000,-9e4\n")
    found = walked(soil, test, 100)
    strength = 5e3 * (1 + sin(np.radians(31))) / (1 - sin(np.radians(31)))
    assert found.failed is not None
    assert found.failed.line == 3
    assert found.failed.step == np.ceil(100 * (strength - 5e3) / 8.5e4)
    assert 1e-6 < found.failed.left < 1
    assert -found.sigma[-1, 1] <= strength
    assert -found.sigma[-1, 1] > strength - 850
    told = study(soil, test, 5e3, 100)
    (remark,) = path_ends([told])
    assert "on the way to line 3 of the file" in sentence(remark)
    assert "a stress beyond the strength cannot be reached" in sentence(remark)
    assert [one.outcome for one in checks(soil, told)] == [Outcome.ERROR]
    reached = written(tmp_path, f"exx,eyy,exy,sxx,syy\n0,0,0,-5000,-5000\n,,0,-5000,{-0.999 * strength}\n")
    assert not walked(soil, reached, 100).failed


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("exx,eyy,exy,syy\n0,0,0,-5\n0,-0.1,0,-5\n", "line 3 gives both eyy and syy; leave one of them empty"),
        ("exx,eyy,exy,syy\n0,0,0,-5\n0,,0,\n", "line 3: eyy is empty; write a number or in syy"),
        ("exx,exy,syy [psi]\n0,0,-5\n0,0,-6\n", r"syy is in psi; stresses are taken in \[Pa\], \[kPa\] or \[MPa\]"),
        ("exx,exy,syy\n0,0,5 %\n0,0,-6\n", "line 2: syy = '5 %' must be a finite number"),
        ("exx,Fxx,Fxy,Fyx,Fyy\n0,1,0,0,1\n0,1,1,0,1\n", "both the strain exx and components of F"),
        ("Fxx,Fxy,Fyy\n1,0,1\n1,1,1\n", "must have a header with Fxx, Fxy, Fyx and Fyy"),
        (
            "Fxx,Fxy,Fyx,Fyy\n1,0,0,1\n0,1,1,0\n",
            "line 3: F has the determinant -1 there or on its way; it must be above zero",
        ),
        ("Fxx,Fxy,Fyx,Fyy\n1,0,0,1\n-1,0,0,-1\n", "line 3: F has the determinant 0 there or on its way"),
        ("Fxx,Fxy,Fyx,Fyy\n1,0,0,1\n1,0,0,1\n", "must have a motion: F that changes"),
        ("Fxx [%],Fxy,Fyx,Fyy\n1,0,0,1\n1,0,1,1\n", "fxx is in percent; components of F have no unit"),
    ],
)
def test_a_bad_mixture_is_one_line(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=words) as told:
        written(tmp_path, text)
    assert "\n" not in str(told.value)


# ---- the first row

FROM_STRESS = "exx,eyy,exy,sxx,syy\n0,0,0,{0},{0}\n,,0,-6000,-9000\n"


@pytest.mark.parametrize(
    ("name", "start", "stress", "words"),
    [
        (
            "neo_hookean",
            "isotropic",
            -5000,
            "gives sxx = -5000, where a material with a stress from F has 0; write that",
        ),
        ("hencky_rate", "isotropic", 1e-9, "gives sxx = 1e-09, where a material with a stress from F has 0"),
        ("neo_hookean", "isotropic", 0, ""),
        ("mohr_coulomb", "isotropic", -5000, ""),
        ("mohr_coulomb", "k0", -5000, r"gives sxx = -5000, and start = k0 makes it -2424.81; leave --start out"),
        ("ubcsand", "oedometric", -4900, "and start = oedometric makes it"),
        ("mohr_coulomb:c=1000", "none", -5000, "gives sxx = -5000, and start = none makes it 0"),
        ("mohr_coulomb:c=1000", "none", 0, ""),
    ],
)
def test_two_stresses_at_the_start_are_one_line(
    name: str, start: str, stress: float, words: str, tmp_path: Path
) -> None:
    """A first row that says another stress than the start or the energy; what agrees is taken."""
    path = tmp_path / "mine.csv"
    path.write_text(FROM_STRESS.format(stress))
    run = ElementRun(name, "path", start=start, path=str(path))
    if words:
        with pytest.raises(ValueError, match=words) as told:
            check([run])
        assert "\n" not in str(told.value)
        return
    check([run])
    begun = begin(of(name), from_file(path), 5e3, start)
    assert begun.sigma[:2] == pytest.approx(stress)


def test_sand_without_a_start_stops_where_it_has_no_stiffness(tmp_path: Path) -> None:
    """No crash, and no curve: it says the step and the line."""
    found = walked(of("ubcsand"), written(tmp_path, FROM_STRESS.format(0)), 10)
    assert found.failed is not None
    assert (found.failed.step, found.failed.line) == (1, 3)


@pytest.mark.parametrize("name", ["neo_hookean", "hencky", "hencky_rate:rate=logarithmic"])
def test_a_motion_that_starts_deformed(name: str, tmp_path: Path) -> None:
    """The stress of its energy in the first row, as if the way there had been run; that of --start in rate form."""
    whole, second = "Fxx,Fxy,Fyx,Fyy\n1,0,0,1\n1.2,0.3,0,0.9\n", "1.2,0.3,0,0.9\n1.3,0.3,0.1,0.9\n"
    reached = walked(of(name), written(tmp_path, whole), 200).sigma[-1]
    test = written(tmp_path, whole.split("\n")[0] + "\n" + second)
    found = study(of(name), test, 5e3, 50)
    begun = begin(of(name), test, 5e3)
    np.testing.assert_allclose(begun.sigma, reached, rtol=1e-4)
    assert np.abs(begun.sigma).max() > 1e3
    assert found.source == "derivative of the energy"
    assert found.errors[-1] < 1e-6
    assert [one.outcome for one in checks(of(name), found)] == [Outcome.PASS]
    (remark,) = deformed(of(name), [found])
    assert "starts deformed, at Fxx 1.2, Fxy 0.3, Fyx 0, Fyy 0.9: the stress there is that of its energy" in sentence(
        remark
    )
    soil = of("mohr_coulomb")
    assert (begin(soil, test, 5e3).sigma == [-5e3, -5e3, -5e3, 0]).all()
    assert "that of --start" in sentence(deformed(soil, [replace(found, test=test)])[0])
    assert not deformed(soil, [replace(found, test=TESTS["finite_shear"])])


# ---- motions


def test_rates_matter_where_something_turns(tmp_path: Path) -> None:
    """A shear of 5 with G = 1: xy -0.959 with Jaumann; with Green-Naghdi xy 2.905 and xx 2.704; 5 in own axes."""
    for rate, known in (("jaumann", (-0.958924, 0.716338)), ("green_naghdi", (2.905369, 2.704361))):
        solid = of(f"hypoelastic:E=2.6,rate={rate}")
        for text, motion in ((SHEARED, "simple_shear"), ("Fxx,Fxy,Fyx,Fyy\n1,0,0,1\n1,5,0,1\n", "none")):
            end = walked(solid, written(tmp_path, text, "fraction", motion), 800)
            assert (end.sigma[-1, 3], end.sigma[-1, 0] + 5e3) == pytest.approx(known, abs=2e-4)
        still = walked(solid, written(tmp_path, SHEARED, "fraction"), 2)
        assert still.sigma[-1, 3] == pytest.approx(5.0, rel=1e-9)


def test_a_rate_that_is_given_makes_shear_a_motion(tmp_path: Path) -> None:
    """Unless the path does not shear, has stresses, or another motion is asked for."""
    for name, text in (("a", SHEARED), ("b", "exx,eyy,gxy\n0,0,0\n0,-0.01,0\n"), ("c", FLAT)):
        (tmp_path / f"{name}.csv").write_text(text)
    paths = [str(tmp_path / f"{name}.csv") for name in "abc"]
    own = {"path": paths, "units": ["fraction"]}
    assert rated(["mohr_coulomb", "hypoelastic:E=3,rate=jaumann"])
    assert not rated(["mohr_coulomb:phi=30"])
    first, second = with_motion(own, True)
    assert (first["path"], first["motion"]) == (paths[:1], ["simple_shear"])
    assert (second["path"], "motion" in second) == (paths[1:], False)
    assert with_motion(own, False) == [own]
    assert with_motion({**own, "motion": ["none"]}, True) == [{**own, "motion": ["none"]}]


@every_rate
def test_finite_shear_meets_its_closed_form(rate: str) -> None:
    """Of order 2 in the step; Truesdell's is exact in any number; the closed form of another rate is missed."""
    solid = of(f"hypoelastic:E=2.6,rate={rate}")
    found = study(solid, TESTS["finite_shear"], 1.0, 50, "none")
    assert found.source == "closed form"
    gamma = found.curve["gamma"]
    assert np.abs(found.curve["tau"] - SIMPLE_SHEAR[rate](gamma)[:, 2]).max() < 1e-5
    other = SIMPLE_SHEAR["jaumann" if rate != "jaumann" else "logarithmic"](gamma)[:, 2]
    assert np.abs(found.curve["tau"] - other).max() > 1
    assert found.order == pytest.approx(2, abs=0.02) if rate != "truesdell" else max(found.errors) < 1e-13
    assert all(one.outcome is Outcome.PASS for one in checks(solid, found))
    first = replace(found, errors=tuple(1e-7 * 2**n for n in range(4, -1, -1)))  # small, and of order 1
    assert [one.outcome for one in checks(solid, first)] == [Outcome.PASS, Outcome.FAIL]


@pytest.mark.parametrize("wrong", ["same_rotation", "strain_start", "explicit_jaumann", "printed_rotation"])
def test_a_wrong_rate_is_seen(wrong: str) -> None:
    """Negative controls against the closed form of Green-Naghdi or Jaumann: neither error nor order is met."""
    rate = "jaumann" if "jaumann" in wrong else "green_naghdi"
    solid, right = of(f"hypoelastic:E=2.6,rate={wrong}"), of(f"hypoelastic:E=2.6,rate={rate}")
    known = exact(right, TESTS["finite_shear"], 1.0, begin(right, TESTS["finite_shear"], 1.0, "none"))
    assert known is not None
    ends = [walked(solid, TESTS["finite_shear"], steps, 1e-9).sigma[-1, 3] for steps in (200, 400)]
    away = [abs(end - known[0]["tau"][-1]) for end in ends]
    assert away[1] > 5e-3
    assert np.log2(away[0] / away[1]) < 1.2


@every_rate
def test_any_motion_has_a_differential_equation(rate: str, tmp_path: Path) -> None:
    """Turned, stretched and pulled out of the plane, from an anisotropic stress: of order 2 against it."""
    solid = of(f"hypoelastic:rate={rate}")
    test = written(tmp_path, FLAT if rate == "truesdell" else TURNED)
    found = study(solid, test, 5e3, 50)
    assert found.source == "differential equation to 1e-12"
    assert found.order == pytest.approx(2, abs=0.05)
    assert found.errors[-1] < 2e-5
    assert [one.outcome for one in checks(solid, found)] == [Outcome.PASS] * 2


@every_rate
def test_the_equation_itself_in_simple_shear(rate: str) -> None:
    """It meets the closed forms to 1e-10: two independent sources."""
    solid = of(f"hypoelastic:E=2.6,rate={rate}")
    first, last = TESTS["finite_shear"].points
    end = integrated(solid, first, last, np.zeros(4), np.array([0.0, 1.0]))[-1]
    np.testing.assert_allclose(end[[0, 1, 3]], SIMPLE_SHEAR[rate](np.array([5.0]))[0], atol=1e-10)


def test_the_bend_of_the_logarithmic_spin_is_smooth() -> None:
    left, right = bend(1e-2 * (1 - 1e-12)), bend(1e-2 * (1 + 1e-12))
    assert left == pytest.approx(right, rel=1e-9)
    assert bend(0.0) == 0.0


@pytest.mark.parametrize("name", ["mohr_coulomb", "ubcsand", "hypoelastic:rate=logarithmic"])
def test_a_motion_is_what_the_solver_does(name: str, tmp_path: Path) -> None:
    """The same bits as Material.update along the same F."""
    material, test = of(name), written(tmp_path, FLAT)
    found = walked(material, test, 40)
    p = Particles(np.zeros((1, 2)), np.ones(1), np.ones(1), np.zeros((1, 0)))
    p.F[:], p.sigma[:] = np.eye(2), [-5e3, -5e3, -5e3, 0.0]
    material.start(p)
    for F in found.strain[1:]:
        p.F[:] = F[[0, 2, 4, 1]].reshape(2, 2)
        material.update(p, 1.0)
    assert np.array_equal(found.sigma[-1], p.sigma[0])
    assert np.array_equal(found.history[-1], p.history[0])


@pytest.mark.parametrize("name", ["neo_hookean", "linear_elastic"])
def test_a_motion_of_an_energy(name: str, tmp_path: Path) -> None:
    """Exact in any number of steps, by the derivative of the energy; a rotation of it is seen."""
    material, test = of(name), written(tmp_path, FLAT)
    found = study(material, test, 1.0, 4)
    assert found.source == "derivative of the energy"
    assert max(found.errors) < 1e-12
    other = walked(material, written(tmp_path, FLAT.replace("-1.0", "-0.9")), 4)
    assert abs(other.sigma[-1, 3] - found.curve["tau"][-1]) > 1


def test_stress_is_held_along_a_motion(tmp_path: Path) -> None:
    """Simple shear by F under a constant vertical stress: Fyy is found, and the stress stays."""
    text = "Fxx,Fxy,Fyx,syy\n1,0,0,-5000\n1,0.3,0,-5000\n"
    found = walked(MohrCoulomb(psi=10.0), written(tmp_path, text), 60)
    assert not found.failed
    np.testing.assert_allclose(found.sigma[:, 1], -5e3, rtol=1e-9)
    assert found.strain[-1, 1] > 1.01  # it dilates
    assert isinstance(element_of(MohrCoulomb(), written(tmp_path, text)), Motion)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("hypoelastic:rate=truesdell", TURNED, "which rate=truesdell does not carry here"),
        ("neo_hookean", TURNED, "neo_hookean is in plane strain here"),
        ("mohr_coulomb:void=1", "exx,eyy,exy,szz\n0,0,0,-5\n0,-0.01,0,-5\n", "keeps a void strain here"),
    ],
)
def test_what_a_material_cannot_follow_is_one_line(name: str, text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=words):
        check([ElementRun(material=name, test="path", path=str(path))])


def test_names_of_f_in_many_hands(tmp_path: Path) -> None:
    same: list[Floats] = [
        written(tmp_path, FLAT.replace("Fxx,Fxy,Fyx,Fyy,Fzz", header)).points
        for header in ("Fxx,Fxy,Fyx,Fyy,Fzz", "F11,F12,F21,F22,F33", "f_xx [-],f_xy,F_yx,F.yy,FZZ")
    ]
    for points in same:
        np.testing.assert_array_equal(points, same[0])


# ---- commands


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def test_the_command_shears(verify: Call, tmp_path: Path) -> None:
    """A path of strains to 5 and a rate: the JSON has the motion's end, and says that it was one; not with none."""
    (tmp_path / "shear.csv").write_text("exx,eyy,gxy\n0,0,0\n0,0,5.0\n")
    words = ("--path", str(tmp_path / "shear.csv"), "--units", "fraction", "--steps", "50", "--json")
    code, said, err = verify("material", "hypoelastic:E=2.6,rate=jaumann", *words)
    assert (code, err) == (0, "")
    told = json.loads(said)
    (one,) = told["more"].values()
    numbers = {finding["code"]: finding["numbers"] for finding in one["findings"]}
    assert numbers["element.path_end"]["xy"] == pytest.approx(sin(5.0), abs=1e-5)
    assert "element.path_motion" in numbers
    assert "element.rate_idle" not in numbers
    assert {run["motion"] for run in told["runs"] if run["path"]} == {"simple_shear"}
    code, said, _ = verify("material", "hypoelastic:E=2.6,rate=jaumann", *words, "--motion", "none")
    (one,) = json.loads(said)["more"].values()
    numbers = {finding["code"]: finding["numbers"] for finding in one["findings"]}
    assert (code, numbers["element.path_end"]["xy"]) == (0, pytest.approx(5.0, rel=1e-9))
    assert "element.rate_idle" in numbers


@pytest.mark.slow
def test_the_page_of_rates(verify: Call, tmp_path: Path) -> None:
    """Four closed forms, a figure of all, values at whole shears, and errors by number of steps."""
    code, said, err = verify("rates", "--steps", "50", "--out", str(tmp_path / "out"), "--json", "--page")
    assert (code, err) == (0, "")
    told = json.loads(said)
    assert told["outcome"] == "PASS"
    assert len(told["more"]) == len(available(RATES))
    page = (tmp_path / "out" / "report.html").read_text()
    for text in ("Objective rates in simple shear", "Stresses at whole shears, finest run", "2.7043", "800 steps"):
        assert text in page
    assert page.index("Objective rates in simple shear</h2>") < page.index(": Simple shear of F to 5</h2>")


def test_a_rate_of_the_kirchhoff_stress_knows_the_volume(tmp_path: Path) -> None:
    """With the logarithmic rate a stretch by 1.3 ends in the stress of the energy; another factor is J = 1.3."""
    file = tmp_path / "stretch.csv"
    file.write_text("Fxx,Fxy,Fyx,Fyy\n1,0,0,1\n1.3,0,0,1\n")
    test = from_file(file, "fraction")
    one, other = (study(create(MATERIALS, name), test, 5e3, 400) for name in ("hencky", "hencky_rate"))
    assert other.curve["sx"][-1] == pytest.approx(one.curve["sx"][-1], rel=1e-5)
    assert other.errors[-1] < 1e-6


@pytest.mark.parametrize(("name", "known"), [
    ("hencky_rate", True), ("hencky_rate:rate=jaumann", False), ("hencky_rate:rate=truesdell", False),
    ("hencky_rate:rate=truesdell,nu=0", True),
])  # fmt: skip
def test_only_a_rate_with_an_energy_is_held_against_it(name: str, known: bool) -> None:
    assert (exact(create(MATERIALS, name), TESTS["finite_shear"], 5e3) is not None) is known
