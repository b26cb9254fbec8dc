"""Strains out of the plane, triaxial tests with known ends, and starts: each check is seen to fail where it should."""

import re
from dataclasses import replace
from math import radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.element.begin import begin, oedometric
from mpm_verify.cases.element.case import parts
from mpm_verify.cases.element.element import Element
from mpm_verify.cases.element.exact import exact
from mpm_verify.cases.element.following import follow
from mpm_verify.cases.element.judged import checks
from mpm_verify.cases.element.known_ends import ends
from mpm_verify.cases.element.path_file import from_file
from mpm_verify.cases.element.paths import CELL, TESTS, ElementTest, given
from mpm_verify.cases.element.resolved import check_digits, made
from mpm_verify.cases.element.space import takes
from mpm_verify.cases.element.study import study
from mpm_verify.cases.element.triaxial_exact import MERIDIANS
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.solver.material import hypoelastic
from mpm_verify.solver.material.hypoelastic import Hypoelastic
from mpm_verify.solver.material.mohr_coulomb import MohrCoulomb
from mpm_verify.solver.material.ubcsand import Ubcsand
from mpm_verify.solver.plugins import MATERIALS, create
from mpm_verify.solver.state import Floats

PERFECT = (
    "mohr_coulomb", "mohr_coulomb:psi=20,c=500,sigma_t=1e9", "mohr_coulomb:phi=0,c=1000", "drucker_prager",
    "drucker_prager:cone=compression,c=500,psi=10", "drucker_prager:phi=0,c=1000",
)  # fmt: skip
DRAINED = ("triaxial_compression", "triaxial_extension")
every_perfect = pytest.mark.parametrize("name", PERFECT)


def of(name: str) -> Any:
    return create(MATERIALS, name)


def stepped(material: Any, sigma: Floats, de: Floats) -> Floats:
    """Stress (4,) after one increment, from a stress (4,)."""
    element = Element(material)
    return element.step(replace(element.start(sigma), strain=np.zeros(len(de))), de[None])[0].sigma


@pytest.mark.parametrize("name", [*PERFECT, "hypoelastic"])
def test_zz_is_a_strain_like_the_others(name: str) -> None:
    """Stress and strain with the axes exchanged give the stress with the axes exchanged, to round-off."""
    material, rng, moved = of(name), np.random.default_rng(1), 0
    for _ in range(200):
        sigma = np.append(rng.uniform(-9e3, -1e3, 3), 0.0)
        xx, yy, zz = rng.normal(0, 8e-3, 3)
        straight = stepped(material, sigma, np.array([xx, yy, 0.0, zz]))
        turned = stepped(material, sigma[[2, 1, 0, 3]], np.array([zz, yy, 0.0, xx]))
        np.testing.assert_allclose(turned[[2, 1, 0, 3]], straight, rtol=0, atol=1e-11 * 2e4)
        flat = stepped(material, sigma, np.array([xx, yy, 0.0]))
        moved += bool(np.abs(straight - flat).max() > 1.0)
    assert moved > 50  # zz does something, but at an apex


@pytest.mark.parametrize("name", [*PERFECT, "hypoelastic", "ubcsand"])
def test_plane_strain_is_the_same_bits(name: str) -> None:
    material = of(name)
    for de in np.random.default_rng(2).normal(0, 2e-3, (50, 3)):
        sigma = np.array([-5e3, -6e3, -4e3, 300.0])
        assert np.array_equal(stepped(material, sigma, np.append(de, 0.0)), stepped(material, sigma, de))


@pytest.mark.parametrize("text", ["", "ubcsand:me=0.5"])
def test_a_sand_is_compressed_in_three_directions(text: str) -> None:
    """ds = K(s) deps_v, elastic: s^(1 - me) grows in proportion, of order 2 in the step; K of three directions."""
    sand = of(text or "ubcsand")
    known = (5e3 ** (1 - sand.me) + (1 - sand.me) * sand.KBe * sand.Pa ** (1 - sand.me) * 0.03) ** (1 / (1 - sand.me))
    away = []
    for steps in (80, 160):
        squeezed = tuple(given(weights, -0.01) for weights in np.eye(4)[[0, 1, 3]].tolist())
        test = ElementTest("squeezed", "", (*squeezed, given((0, 0, 1, 0), 0)), 1.0)
        found = follow(Element(sand), test, steps, np.array([-5e3, -5e3, -5e3, 0.0]))
        assert np.ptp(found.sigma[-1, :2]) < 1e-9 * known
        assert found.history[-1, 1] < 1e-12
        away.append(np.abs(-found.sigma[-1, :3] / known - 1).max())  # zz too
    assert away[1] < 2e-4
    assert np.log2(away[0] / away[1]) == pytest.approx(2, abs=0.1)


@every_perfect
@pytest.mark.parametrize("test", [*DRAINED, "triaxial_undrained"])
def test_triaxial_tests_are_exact(name: str, test: str) -> None:
    """In any number of steps, against the closed form; strength and dilation are told with their formulas."""
    material = of(name)
    found = study(material, TESTS[test], 5e3, 7)
    assert found.source == "closed form"
    assert max(found.errors) < 1e-11
    checks = ends(material, found)
    assert len(checks) == 2 * (test in DRAINED)
    assert all(check.outcome is Outcome.PASS for check in checks)


def test_strengths_as_they_are_known() -> None:
    """(k - 1) s3 + 2 c sqrt(k), 2 c of Tresca, and 2 c sqrt(k) of unconfined compression."""
    soil, k = of("mohr_coulomb:phi=30,psi=10,c=1000,sigma_t=1e9"), 3.0
    test = TESTS["triaxial_compression"]
    q = study(soil, test, 5e3, 5).curve["q"][-1]
    assert q == pytest.approx((k - 1) * 5e3 + 2e3 * np.sqrt(k), rel=1e-12)
    assert study(soil, test, 5e3, 5, "none").curve["q"][-1] == pytest.approx(2e3 * np.sqrt(k), rel=1e-12)
    assert study(of("mohr_coulomb:phi=0,c=1000"), test, 5e3, 5).curve["q"][-1] == pytest.approx(2e3, rel=1e-12)
    weak = study(soil, TESTS["triaxial_extension"], 5e3, 5).curve["q"][-1]
    assert weak == pytest.approx(-(5e3 - (5e3 - 2e3 * np.sqrt(k)) / k), rel=1e-12)


def test_a_wrong_meridian_or_flow_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The strength of extension on the side of compression, and flow along phi: both checks of the end miss."""
    soil = MohrCoulomb(psi=10.0)
    found = study(soil, TESTS["triaxial_compression"], 5e3, 5)
    monkeypatch.setitem(MERIDIANS, "mohr_coulomb", lambda soil, side: right(soil, -side))
    assert [check.outcome for check in ends(soil, found)] == [Outcome.FAIL] * 2
    monkeypatch.undo()
    wrong = MohrCoulomb(psi=31.0).constants()
    monkeypatch.setattr(MohrCoulomb, "constants", lambda self: wrong)
    flowing = study(soil, TESTS["triaxial_compression"], 5e3, 5)
    assert flowing.errors[-1] > 0.1
    assert [check.outcome for check in ends(soil, flowing)] == [Outcome.PASS, Outcome.FAIL]


right = MERIDIANS["mohr_coulomb"]


def test_a_lateral_stress_that_is_not_held_is_seen() -> None:
    """Plane strain in place of the cell pressure of zz: another stiffness, by 1/(1 - nu^2)."""
    soil, test = Hypoelastic(E=840e3), TESTS["triaxial_compression"]
    flat = replace(test, conditions=(CELL[0], given((0, 0, 0, 1), 0), *test.conditions[2:]))
    known = exact(soil, test, 5e3)
    assert known is not None
    q = follow(Element(soil), flat, 4, np.array([-5e3, -5e3, -5e3, 0.0])).sigma[-1]
    assert (q[0] - q[1]) / known[0]["q"][-1] == pytest.approx(1 / (1 - 0.3**2), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("test", DRAINED)
def test_sand_is_of_order_2(test: str) -> None:
    found = study(Ubcsand(), TESTS[test], 5e3, 50)
    assert found.errors[-1] < 1e-7
    assert found.order == pytest.approx(2, abs=0.1)


def test_sand_is_held_against_quadrature() -> None:
    """UBCSAND; its lateral strains differ, as the plane alone yields."""
    sand, test = Ubcsand(), "triaxial_extension"
    found = study(sand, TESTS[test], 5e3, 8)
    assert found.source == "quadrature"
    assert found.errors[-1] < 1e-5
    assert found.truth is not None
    for name in ("q", "ex", "ez"):
        assert found.curve[name][-1] == pytest.approx(found.truth[name][-1], rel=1e-4)
    assert abs(found.curve["ex"][-1] - found.curve["ez"][-1]) > 1e-3
    other = follow(Element(replace(sand, Rf=0.7)), TESTS[test], 60, np.array([-5e3, -5e3, -5e3, 0.0])).sigma[-1]
    assert abs((other[0] - other[1]) / found.truth["q"][-1] - 1) > 1e-3


@pytest.mark.slow
def test_sand_at_failure() -> None:
    """Low stress: the path goes on beyond failure, whose strength and flow are known."""
    sand = Ubcsand()
    found = study(sand, TESTS["triaxial_extension"], 500.0, 30)
    assert found.errors[-1] < 1e-6
    assert [check.outcome for check in ends(sand, found)] == [Outcome.PASS] * 2
    assert found.curve["q"][-1] == pytest.approx(-500 * 2 * sand.eta_f / (1 + sand.eta_f), rel=1e-10)


def test_k0_of_what_starts_at_rest() -> None:
    """nu/(1 - nu) by the material itself, Jaky's, and the one of the table that UBCSAND comes to."""
    test = TESTS["triaxial_compression"]
    for soil in (MohrCoulomb(), Hypoelastic(E=840e3)):
        state = begin(soil, test, 5e3, "oedometric")
        assert state.sigma[1] == pytest.approx(-5e3, rel=1e-12)
        assert state.sigma[[0, 2]] / state.sigma[1] == pytest.approx(0.3 / 0.7, rel=1e-9)
        assert not state.strain.any()
    jaky = begin(MohrCoulomb(), test, 5e3, "k0").sigma
    assert jaky[[0, 2]] == pytest.approx(-5e3 * (1 - sin(radians(31))), rel=1e-15)
    sand = oedometric(Ubcsand(), 5e3)
    assert sand is not None
    assert sand.sigma[0] / sand.sigma[1] == pytest.approx(0.523, abs=1e-3)
    assert sand.history[0] == pytest.approx(0.313, abs=1e-3)
    weak = begin(MohrCoulomb(phi=20.0), test, 5e3, "oedometric")  # K0 k < 1: it slides on the way
    assert weak.sigma[0] / weak.sigma[1] > 0.3 / 0.7 + 0.05
    assert weak.history[0] > 0


def test_from_rest_the_ends_are_the_same() -> None:
    soil = MohrCoulomb(c=500.0, sigma_t=1e9)
    for how in ("k0", "oedometric"):
        found = study(soil, TESTS["triaxial_compression"], 5e3, 6, how)
        assert found.source == "closed form"
        assert max(found.errors) < 1e-9
        assert [check.outcome for check in ends(soil, found)] == [Outcome.PASS] * 2


@pytest.mark.parametrize(
    ("name", "start", "words"),
    [
        ("hypoelastic", "k0", "start = k0 must have a material with an angle of friction"),
        ("mohr_coulomb", "none", "start = none: triaxial_compression of a soil without cohesion has no strength"),
        ("mohr_coulomb:void=1", "isotropic", "triaxial_compression strains zz, and mohr_coulomb:void=1 keeps a void"),
        ("neo_hookean", "isotropic", "triaxial_compression strains zz, and neo_hookean is in plane strain here"),
    ],
)
def test_what_cannot_be_put_through_it_is_one_line(name: str, start: str, words: str) -> None:
    values = {"material": [name], "test": ["triaxial_compression"], "start": [start]}
    with pytest.raises(ValueError, match=words):
        build(Asked("element", values), "verify")


@pytest.mark.parametrize("name", ["mohr_coulomb", "drucker_prager", "ubcsand", "mohr_coulomb:c=1000"])
def test_a_stress_that_no_step_resolves_is_one_line(name: str) -> None:
    """At 1e-9 Pa, and the stress that is told instead is taken; strength is met there with 16 times the steps."""
    words = r"one strain step of triaxial_compression makes more .* choose ([0-9.e+-]+) or more"
    asked = {"material": [name], "test": ["triaxial_compression"]}
    with pytest.raises(ValueError, match=words) as told:
        build(Asked("element", {**asked, "stress": [1e-9]}), "verify")
    assert "\n" not in str(told.value)
    found = re.search(words, str(told.value))
    assert found is not None
    enough = float(found[1])
    build(Asked("element", {**asked, "stress": [enough]}), "verify")
    assert 1e-3 < enough < 50
    with pytest.raises(ValueError, match="or more"):
        build(Asked("element", {**asked, "stress": [enough / 2]}), "verify")


def test_stresses_below_round_off_in_a_file_are_one_line(tmp_path: Path) -> None:
    path = tmp_path / "mine.csv"
    for stress, fine in ((1e-9, False), (1.0, True)):
        path.write_text(f"exx,eyy,ezz,exy,sxx,szz\n,0,,0,-{stress},-{stress}\n,-0.05,,0,-{stress},-{stress}\n")
        test = from_file(path)
        if fine:
            check_digits(of("mohr_coulomb"), test)
            continue
        with pytest.raises(ValueError, match=r"stresses up to 1e-09 are below round-off in mohr_coulomb; write 0\.001"):
            check_digits(of("mohr_coulomb"), test)
        check_digits(of("hypoelastic"), test)


def test_a_coarse_step_at_a_low_stress_gives_no_verdict() -> None:
    """Extension from 100 Pa, where the coarsest step makes 6 times that: none of ERROR; sound and spoilt at 5000 Pa."""
    soil, test = of("mohr_coulomb"), TESTS["triaxial_extension"]
    assert made(soil, test, 100.0, 50) == pytest.approx((soil.lam + 2 * soil.mu) * 0.025 / 50 / 100)
    coarse = study(soil, test, 100.0, 50)
    assert coarse.failed is not None
    assert not checks(soil, coarse)
    fine = study(soil, test, 5e3, 50)
    assert {check.outcome for check in checks(soil, fine)} == {Outcome.PASS}
    spoilt = replace(fine, failed=replace(coarse.failed, steps=50))
    assert {check.outcome for check in checks(soil, spoilt)} == {Outcome.ERROR}


def test_who_is_asked_without_being_told() -> None:
    """Materials that can be strained out of the plane go through the triaxial tests as well."""
    both = parts(Asked("element", {"material": ("mohr_coulomb", "neo_hookean")}))
    asked = [set(one.values["test"]) for one in both]
    assert {"triaxial_compression", "triaxial_extension", "triaxial_undrained", "biaxial", "properties"} < asked[0]
    assert not any(name.startswith("triaxial") for name in asked[1])
    assert not takes(of("neo_hookean"))
    assert not takes(of("ubcsand:void=1"))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('= "trial"', '= "space"', 'out_of_plane = \'space\' must be "trial", "plane" or ""'),
        ('= "trial"', '= "plane"', 'out_of_plane = "plane" needs moduli'),
    ],
)
def test_a_material_of_ones_own_says_how_zz_reaches_it(old: str, new: str, words: str, tmp_path: Path) -> None:
    source = Path(hypoelastic.__file__).read_text()
    own = tmp_path / "own.py"
    own.write_text(source.replace("Hypoelastic", "Own"))
    found = study(of(str(own)), TESTS["triaxial_compression"], 5e3, 4)
    known = study(Hypoelastic(), TESTS["triaxial_compression"], 5e3, 4)
    assert found.curve["q"][-1] == pytest.approx(known.curve["q"][-1], rel=1e-12)
    own.write_text(source.replace("Hypoelastic", "Own").replace(old, new))
    with pytest.raises(ValueError, match=words):
        of(str(own))


def test_a_stress_that_is_held_stays_over_many_steps() -> None:
    """What Newton leaves of the cell pressure does not add up."""
    found = follow(Element(MohrCoulomb()), TESTS["triaxial_compression"], 400, np.array([-5e3, -5e3, -5e3, 0.0]))
    assert np.abs(found.sigma[:, [0, 2]] + 5e3).max() < 1e-11 * 5e3


@pytest.mark.slow
def test_a_biaxial_test_of_sand_beyond_failure() -> None:
    """At 1 kPa it fails on the way: the exact curve goes on with the flow at failure, and no order is asked for."""
    sand = Ubcsand()
    found = study(sand, TESTS["biaxial"], 1e3, 50)
    assert found.truth is not None
    assert found.errors[-1] < 1e-6  # the other sign of the flow: 3.4e-3
    assert found.truth["ey"][-1] == pytest.approx(TESTS["biaxial"].length, rel=1e-9)
    names = {check.name: check.outcome for check in checks(sand, found)}
    assert names == {"error at the end, finest": Outcome.PASS}


@pytest.mark.parametrize(
    ("name", "test", "known"),
    [
        ("mohr_coulomb", "isotropic", True),
        ("mohr_coulomb:phi=10,nu=0.2", "isotropic", False),
        ("mohr_coulomb:phi=0,c=1000", "isotropic", False),
        ("mohr_coulomb:phi=0,c=1000", "oedometric", False),
        ("mohr_coulomb:phi=45", "oedometric", True),
    ],
)
def test_a_soil_that_yields_in_compression_has_no_elastic_curve(name: str, test: str, known: bool) -> None:
    """In plane strain zz lags behind: 2 nu of xx in even compression, K0 of yy in oedometric compression."""
    material = create(MATERIALS, name)
    assert (exact(material, TESTS[test], 5e3) is not None) is known
    if known:
        assert study(material, TESTS[test], 5e3, 5).errors[-1] < 1e-12
