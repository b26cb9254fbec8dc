"""The auditor: what it finds, and that its claims hold on the fields and against planted defects."""

import json
import sys
from dataclasses import asdict
from functools import cache
from typing import Any

import numpy as np
import pytest
import test_defects as defects
from pydantic import TypeAdapter

from mpm_verify.mms.audit import Audit, audit
from mpm_verify.mms.blind_spots import (
    ALWAYS,
    RULES,
    SEEN_BY,
    SEEN_BY_AXISYMMETRIC,
    SEEN_BY_LINE,
    SEEN_BY_SOLID,
    BlindSpotCode,
    rules_of,
)
from mpm_verify.mms.components import square
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.mms.measure import boundary
from mpm_verify.reports.sentences.blind_spots import sentence
from mpm_verify.solver.layout import annulus, rectangle
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, available, create
from mpm_verify.solver.state import Floats
from mpm_verify.verify.main import main

DIAGONAL = {"shear", "rotation", "order", "spin"}
BLIND = {
    "axis_aligned": DIAGONAL | {"start"},
    "axis_aligned:L=2,C=30": DIAGONAL | {"start"},
    "axis_aligned:phase=0.785": DIAGONAL,
    "axis_aligned:phase=0.01": DIAGONAL | {"start"},
    "axis_aligned:phase=1.5707963": DIAGONAL | {"velocity"},
    "axis_aligned:A=1e-5": DIAGONAL | {"start", "amplitude", "crossing"},
    "clamped_shear": {"walls"},
    "localised": {"walls"},
    "bump": {"walls", "rotation", "order", "amplitude", "crossing"},
    "bump:A=0.05": {"walls"},
    "clamped_shear:G=1e-4": {"walls", "rotation", "order", "amplitude", "crossing"},
    "affine": {"gradient", "walls", "stress"},
    "affine:a=0.1,b=0,c=0,d=0": DIAGONAL | {"gradient", "walls", "stress", "start", "plane"},
    "generalised_vortex": {"volume", "walls"},
    "expanding_ring": {"rotation", "order", "spin", "start", "mirror", "walls"},
    "swirl": {"walls"},
    "bar": DIAGONAL | {"start", "plane"},
    "bump3d": {"walls", "rotation", "order", "amplitude", "crossing"},
    "bump3d:A=0.05": {"walls"},
    "swirl3d": {"walls"},
    "bar1d": {"start", "plane"},
    "bump1d": {"velocity", "amplitude", "crossing", "walls", "plane"},
    "bump1d:A=0.05": {"velocity", "walls", "plane"},
    "cylinder_rz": set(),
    "bump_rz": {"walls", "rotation", "order", "amplitude", "crossing"},
    "bump_rz:A=0.05": {"walls"},
    "bump_rz:A=0.05,bore=40": {"walls", "hoop"},
}


class Case:
    """A solution, its exact fields, its audit."""

    def __init__(self, text: str) -> None:
        self.solution: Any = create("mpm_verify.mms.solutions", text)
        self.law: Any = create("mpm_verify.solver.material", self.solution.material)
        self.exact: Manufactured = manufacture(self.solution, self.law, self.law.rho0)
        self.audit: Audit = audit(self.exact, self.solution, self.law)
        self.blind = {str(spot.code) for spot in self.audit.blind if spot not in ALWAYS}


case = cache(Case)


@pytest.mark.parametrize("text", BLIND)
def test_what_is_found(text: str) -> None:
    assert case(text).blind == BLIND[text]
    assert [spot.code for spot in case(text).audit.spots] == [
        *rules_of(case(text).audit.numbers),
        *(one.code for one in ALWAYS),
    ]


@pytest.mark.parametrize("name", available(SOLUTIONS))
def test_every_solution_is_here(name: str) -> None:
    if name not in BLIND:
        pytest.skip(f"write here what a study of {name} is blind to")


def turn(w_t: float) -> float:
    """Angle of R in degrees for the default parameters of affine."""
    s, c = np.sin(w_t), 1 - np.cos(w_t)
    return float(np.degrees(np.abs(np.arctan2(-0.06 * s - 0.08 * c, 2 + 0.1 * s - 0.05 * c))))


NUMBERS = [  # by hand
    ("axis_aligned", "strain", 0.1 * np.pi),
    ("axis_aligned", "displacement", 0.05),
    ("axis_aligned", "J_min", (1 - 0.1 * np.pi) ** 2),
    ("axis_aligned", "J_max", (1 + 0.1 * np.pi) ** 2),
    ("axis_aligned", "gradient", 0.2 * np.pi**2),
    ("axis_aligned:phase=0.785", "start_acceleration", np.sin(0.785)),
    ("axis_aligned:phase=0.785", "start_velocity", np.cos(0.785)),
    ("clamped_shear", "displacement", 0.1),
    ("affine", "rotation_deg", max(turn(w_t) for w_t in np.linspace(0, 2 * np.pi, 999))),
    ("expanding_ring", "start_acceleration", 0.0),
    ("expanding_ring", "edge_traction", 0.0),
    ("generalised_vortex", "edge_traction", 0.0),
    ("generalised_vortex", "edge_motion", 0.0),
    ("axis_aligned", "edge_normal_motion", 0.0),
    ("axis_aligned", "edge_traction", 1.0),
    ("axis_aligned", "edge_motion", 1.0),
]


@pytest.mark.parametrize(("text", "key", "value"), NUMBERS)
def test_numbers(text: str, key: str, value: float) -> None:
    """Sampled, so 2 % of the extremes may be missed."""
    assert case(text).audit.numbers[key] == pytest.approx(value, rel=0.02, abs=1e-12)


def test_sentences_have_the_numbers() -> None:
    said = {spot.code: sentence(spot) for spot in case("axis_aligned:phase=0.785").audit.spots}
    assert "71 % of the largest acceleration" in said["start"]
    assert "0.05 N cells (6.4 at 128)" in said["crossing"]
    assert "without acceleration" in {s.code: sentence(s) for s in case("axis_aligned").audit.spots}["start"]
    assert "with 1 % of" in {s.code: sentence(s) for s in case("axis_aligned:phase=0.01").audit.spots}["start"]


@pytest.mark.parametrize(
    ("key", "text"),
    [
        (key, text)
        for table in (SEEN_BY, SEEN_BY_SOLID, SEEN_BY_LINE, SEEN_BY_AXISYMMETRIC)
        for key, texts in table.items()
        for text in texts
    ],
)
def test_who_is_said_to_see_it_does(key: str, text: str) -> None:
    assert key not in case(text).blind


def changed(c: Case) -> dict[str, float]:
    """What the named defects change, as shares, by the fields' own functions at random places and times."""
    rng, e = np.random.default_rng(3), c.exact
    width = float(c.solution.upper[0] - c.solution.lower[0])
    d = len(c.solution.lower)
    X = rng.permutation(c.solution.layout(width / 24, 2**d).X)[:300]
    T, h = c.solution.duration, 1e-4 * c.solution.duration
    found: dict[str, list[float]] = {}

    def note(key: str, wrong: Floats, right: Floats, size: Floats) -> None:
        found.setdefault(key, []).append(float(np.abs(wrong - right).max() / max(np.abs(size).max(), 1e-300)))

    def matrix(t: float) -> Floats:
        return square(e.F(X, t).reshape(len(X), -1))

    stiffer = manufacture(c.solution, type(c.law)(2 * c.law.mu * 1.45, 0.45, c.law.rho0), c.law.rho0)  # lambda alone
    for t in T * np.array([0.13, 0.31, 0.52, 0.77]):
        F, sigma, v = matrix(t), e.sigma(X, t), e.v(X, t)
        F_T, strain = F.transpose(0, 2, 1), F - np.eye(F.shape[-1])
        L = (matrix(t + h) - matrix(t - h)) / (2 * h) @ np.linalg.inv(F)
        note("shear", sigma * (np.arange(sigma.shape[1]) < 3), sigma, sigma)
        note("rotation", F_T, F, strain)
        note("order", F @ L, L @ F, L * np.abs(strain).max())
        note("spin", L.transpose(0, 2, 1), L, L)
        note("volume", stiffer.P(X, t), e.P(X, t), e.P(X, t))
        note("volume", sigma * np.linalg.det(F)[:, None], sigma, sigma * np.abs(strain).max())
        note("load", 0 * v, e.b(X, t), (e.v(X, t + h) - e.v(X, t - h)) / (2 * h))
        note("gradient", F, F[:1], strain * np.ones((len(X), 1, 1)))
        note("velocity", e.v(X, 0.0), 0 * v, v)
    rates = [np.abs(e.v(X, t + h) - e.v(X, t - h)).max() for t in T * np.linspace(0, 1, 33)]
    found["start"] = [rates[0] / max(rates)]
    return {key: max(values) for key, values in found.items()}


@pytest.mark.parametrize("text", [text for text, blind in BLIND.items() if "amplitude" not in blind])
def test_claims_hold_on_the_fields(text: str) -> None:
    """A defect said to be invisible changes what it touches by less than 5 %, any other by more."""
    c = case(text)
    told = {spot.code for spot in c.audit.spots}
    for key, share in changed(c).items():
        if key not in told:  # in one dimension nothing is said of shear
            continue
        assert (share < 0.05) == (key in c.blind), (key, share)


PLANTS = {  # by the names that tests/test_defects.py gives them
    "F (I + dt L)": ("order", defects.new_f(lambda step, F: defects.times(F, step))),
    "no shear stress": ("shear", defects.no_shear_stress),
    "L transposed": ("spin", defects.new_f(lambda step, F: defects.times(defects.swap(step), F))),
    "domains by F^T": ("rotation", defects.domains(defects.swap)),
}


def test_it_names_what_planted_defects_have_shown() -> None:
    assert {plant.id for plant in defects.INVISIBLE} == set(PLANTS)
    for key, _ in PLANTS.values():
        assert key in case("axis_aligned").blind
        assert key not in case("clamped_shear").blind


@pytest.mark.parametrize("text", ["axis_aligned:phase=0.785", "clamped_shear", "expanding_ring"])
@pytest.mark.parametrize("name", PLANTS)
def test_claims_hold_against_planted_defects(name: str, text: str) -> None:
    """Seen where the error grows by a fifth at least, blind where it stays within 5 %: 16 cells, CPDI."""
    key, plant = PLANTS[name]
    ratio = defects.finest(defects.sweep(plant, text, (16,))) / defects.finest(
        defects.sweep(defects.nothing, text, (16,))
    )
    assert (ratio > 1.2) == (key not in case(text).blind), ratio
    assert ratio > 1.2 or abs(ratio - 1) < 0.05


def test_free_edges_with_a_traction_are_told() -> None:
    """The ring is free of traction for nu = 0 alone."""
    own, other = (
        audit(manufacture(ring, law, law.rho0), ring, law)
        for ring in (create(SOLUTIONS, "expanding_ring"),)
        for law in (create(MATERIALS, ring.material), create(MATERIALS, "neo_hookean"))
    )
    said = [next(sentence(spot) for spot in a.spots if spot.code == BlindSpotCode.WALLS) for a in (own, other)]
    assert "no study of it converges" not in said[0]
    assert "no study of it converges" in said[1]


def test_boundary_of_a_rectangle() -> None:
    X, normal = boundary(rectangle(np.array([1.0, 0.0]), np.array([3.0, 1.0]), 0.25, 4))
    assert len(X) == 2 * (15 + 7)  # without the four corners
    for axis, side, sign in ((0, 1.0, -1), (0, 3.0, 1), (1, 0.0, -1), (1, 1.0, 1)):
        there = np.isclose(X[:, axis], side)
        np.testing.assert_allclose(normal[there, axis], sign)
        assert there.sum() == (7 if axis == 0 else 15)


def test_boundary_of_a_ring() -> None:
    X, normal = boundary(annulus(0.75, 1.25, 0.25, 4))
    R = np.hypot(*X.T)
    inner = np.isclose(R, 0.75)
    assert (inner | np.isclose(R, 1.25)).all()
    np.testing.assert_allclose(normal, np.where(inner, -1, 1)[:, None] * X / R[:, None], atol=1e-12)


def test_it_can_be_stored() -> None:
    stored = TypeAdapter(Audit)
    result = case("clamped_shear").audit
    assert stored.validate_json(stored.dump_json(result)) == result


def spoken(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *words: str) -> tuple[Any, str, str]:
    monkeypatch.setattr(sys, "argv", ["verify", "audit", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return ended.value.code, *capsys.readouterr()


@pytest.mark.parametrize("columns", ["80", "120"])
def test_command(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], columns: str) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    code, out, _ = spoken(monkeypatch, capsys, "axis_aligned")
    assert code == 0
    assert max(map(len, out.splitlines())) <= 120
    blind, seen = out.split("\nsees")
    assert "axis_aligned in neo_hookean" in blind
    assert all(f"\n{key}" in blind for key in (*BLIND["axis_aligned"], "orders", "constants"))
    assert "\nvolume" in seen
    assert "J_min" in seen


def test_command_as_json(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    code, out, _ = spoken(monkeypatch, capsys, "clamped_shear", "--json", "--material", "neo_hookean:nu=0.2")
    document = json.loads(out)
    assert code == 0
    assert document["material"] == "neo_hookean:nu=0.2"
    assert len(document["blind_spots"]) == len(RULES) + len(ALWAYS)
    ours = asdict(case("clamped_shear").audit)["numbers"]
    assert document["numbers"]["strain"] == ours["strain"]
    assert document["numbers"]["stress"] != ours["stress"]  # another material


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nope"], "choose from affine, axis_aligned"),
        (["axis_aligned:q=1"], "no parameter 'q'"),
        (["axis_aligned", "--material", "nope"], "no material 'nope'"),
        (["missing.py"], "missing.py: no such file"),
    ],
)
def test_bad_names(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    code, out, err = spoken(monkeypatch, capsys, *words)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert said in err


@pytest.mark.parametrize(("A", "told"), [(0.05, True), (1e-6, False)])
def test_strains_too_large_for_the_model_are_told(A: float, told: bool) -> None:
    """Linear elasticity, whose stress is that of its energy for small strains alone."""
    solution: Any = create(SOLUTIONS, f"axis_aligned:A={A}")
    material: Any = create(MATERIALS, "linear_elastic")
    spots = audit(manufacture(solution, material, material.rho0), solution, material).spots
    said = [sentence(spot) for spot in spots if spot.code is BlindSpotCode.MODEL]
    assert [text.startswith("The constitutive model is one of small strains, and comp") for text in said] == [
        True
    ] * told
