"""The paper's sentences held against made runs: each can be reproduced, and each can fail."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.column.claims import beyond, claims, families
from mpm_verify.cases.column.experiment import experiment
from mpm_verify.cases.column.records import Claim, ClaimCode, FinishedRun
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.reports.sentences import column as words

T = np.linspace(0, 1.4, 141)
USUAL = ColumnRun()


def ran(
    front: float = 0.9, height: float = 0.15, kinetic: float = 100.0, potential: float = 80.0,
    creep: float = 0.01, crowding: float = 1.1, **run: Any,
) -> FinishedRun:  # fmt: skip
    """A run that comes to these, in curves of a simple shape."""
    curves = {
        "t": T,
        "front_99": np.minimum(0.0905 + (front - 0.0905) * T / 0.8, front),
        "potential": np.maximum(480 - (480 - potential) * T / 0.8, potential),
        "on_grid": kinetic * np.exp(-(((T - 0.3) / 0.1) ** 2)),
    }
    return FinishedRun(
        replace(USUAL, **run), {"front_99": front, "height": height, "creep": creep, "crowding": crowding}, curves
    )


def said(family: list[FinishedRun], axis: str) -> dict[ClaimCode, Claim]:
    """Claims by their codes."""
    return {claim.code: claim for claim in claims(family, [axis])}


def test_the_experiment() -> None:
    """The bands of the reference values at a = 7, none where nothing was measured."""
    known = experiment(USUAL)
    assert known
    assert known.front == (pytest.approx(0.7197, abs=1e-4), pytest.approx(0.8191, abs=1e-4))
    assert known.height == (pytest.approx(0.173, abs=5e-4), pytest.approx(0.197, abs=5e-4))
    assert experiment(replace(USUAL, aspect=2.0)) is None
    assert (beyond(0.9, (0.7, 0.8)), beyond(0.75, (0.7, 0.8))) == (pytest.approx(0.125), 0.0)
    assert beyond(0.63, (0.7, 0.8)) == pytest.approx(-0.1)


def test_particles() -> None:
    held = said([ran(0.9, 0.08, ppc=1), ran(0.91, 0.15, ppc=4), ran(0.92, 0.17, ppc=9)], "ppc")
    assert [claim.reproduced for claim in held.values()] == [True] * 4
    assert "0.900 m with 1 per cell" in words.found(held[ClaimCode.FRONT_OVER])
    failed = said([ran(0.7, 0.2, ppc=1), ran(0.91, 0.1, ppc=9)], "ppc")
    assert [claim.reproduced for claim in failed.values()] == [False] * 4
    assert said([ran(ppc=4), ran(ppc=9)], "ppc")[ClaimCode.HEIGHT_UNDER_WITH_ONE].reproduced is None
    weak = said([ran(0.7, 0.1, ppc=1, crowding=2.0), ran(0.91, 0.16, ppc=9)], "ppc")
    told = "than the space that they fill, 2.00 times with 1 per cell: those runs are weak"
    assert told in words.found(weak[ClaimCode.FRONT_OVER])
    moving = said([ran(0.7, 0.14, ppc=1), ran(0.91, 0.16, ppc=9, creep=0.2)], "ppc")
    assert moving[ClaimCode.HEIGHT_RISES].reproduced is None
    sinking = said([ran(0.7, 0.14, ppc=1, creep=0.2), ran(0.91, 0.16, ppc=9)], "ppc")
    assert sinking[ClaimCode.HEIGHT_RISES].reproduced is True  # it can only become more so
    assert "fell by up to 20.0 %" in words.found(moving[ClaimCode.HEIGHT_RISES])


def by_measures(one: FinishedRun, **lengths: float) -> FinishedRun:
    """The run with lengths by other measures too; curves end at them."""
    more = {name: one.curves["front_99"] * length / one.front for name, length in lengths.items()}
    return replace(one, values=one.values | lengths | {"creep_fit": one.values["creep"]}, curves=one.curves | more)


def test_a_claim_is_answered_by_every_measure() -> None:
    """The usual first; where another answers otherwise it is told with its numbers, and counted."""
    few = by_measures(ran(0.70, 0.18, ppc=1), front_999=0.76, toe=0.85, height_fit=0.16)
    more = by_measures(ran(0.90, 0.19, ppc=9), front_999=0.95, toe=0.98, height_fit=0.17)
    held = said([few, more], "ppc")
    over, under = held[ClaimCode.FRONT_OVER], held[ClaimCode.HEIGHT_UNDER_WITH_ONE]
    assert list(over.by.items()) == [("front_99", False), ("front_999", False), ("toe", True)]
    assert list(under.by.items()) == [("height", False), ("height_fit", True)]
    assert (over.reproduced, under.reproduced) == (False, False)
    assert [code for code, claim in held.items() if claim.hangs] == [over.code, under.code]
    assert words.found(over).endswith(
        "By the front of 99 % of the mass; the same by that of 99.9 %; by the toe: reproduced "
        "(0.850 m with 1 per cell, 0.980 m with 9 per cell)."
    )
    assert over.runs[0].lengths == {
        "front_99": 0.70,
        "front_999": 0.76,
        "toe": 0.85,
        "height": 0.18,
        "height_fit": 0.16,
    }
    same = said([by_measures(ran(0.9, ppc=1), front_999=0.95, toe=0.98, height_fit=0.15), more], "ppc")
    assert not same[ClaimCode.FRONT_OVER].hangs
    assert words.found(same[ClaimCode.FRONT_OVER]).endswith("; the same by that of 99.9 % and the toe.")


def test_every_claim_hangs_on_a_front_a_height_or_an_energy() -> None:
    """Materials, their curves among it: the toe may part early where the front does not. Energies have no measure."""
    plain = by_measures(ran(0.84), front_999=0.90, toe=0.93, height_fit=0.15)
    sand = by_measures(ran(0.82, material="ubcsand"), front_999=0.80, toe=0.95, height_fit=0.15)
    found = said([plain, sand], "material")
    assert found[ClaimCode.SAND_STIFFER].by == {"front_99": True, "front_999": False, "toe": False}
    assert set(found[ClaimCode.SAND_LATE].by) == {"front_99", "front_999", "toe"}
    assert found[ClaimCode.SAND_EARLY].by == {}
    damped = by_measures(ran(0.8, damping=0.1), front_999=0.85, toe=0.9, height_fit=0.15)
    without = {claim.code for claim in said([plain, damped], "damping").values() if not claim.by}
    assert without == {ClaimCode.POTENTIAL_KEPT, ClaimCode.KINETIC_CHANGED}


def test_runs_stored_before_a_measure_was_made_have_the_others() -> None:
    old = ran(0.9, ppc=1)
    new = by_measures(ran(0.91, ppc=9), front_999=0.95, toe=0.98, height_fit=0.15)
    assert list(said([old, new], "ppc")[ClaimCode.FRONT_OVER].by) == ["front_99"]
    assert words.found(said([old, new], "ppc")[ClaimCode.FRONT_OVER]).endswith("By the front of 99 % of the mass.")


def test_damping() -> None:
    family = [ran(0.9, kinetic=100, potential=80), ran(0.84, kinetic=80, potential=84, damping=0.1)]
    assert [claim.reproduced for claim in said(family, "damping").values()] == [True] * 4
    family = [ran(0.9, kinetic=100, potential=80), ran(0.95, kinetic=99, potential=120, damping=0.1)]
    found = said(family, "damping")
    assert [claim.reproduced for claim in found.values()] == [False] * 4
    assert "8.3 % of the initial potential energy" in words.found(found[ClaimCode.POTENTIAL_KEPT])
    assert "up to 1 %" in words.found(found[ClaimCode.KINETIC_CHANGED])


def test_smoothing() -> None:
    plain, volume = ran(0.9), ran(1.0, 0.3, smoothing="volumetric")
    shear = ran(0.85, smoothing="deviatoric:of=rate")
    assert [c.reproduced for c in said([plain, volume, shear], "smoothing").values()] == [True] * 3
    volume, shear = ran(0.8, 0.1, smoothing="volumetric"), ran(0.95, smoothing="deviatoric")
    assert [c.reproduced for c in said([plain, volume, shear], "smoothing").values()] == [False] * 3
    assert not said([volume, shear], "smoothing")  # nothing to compare them with
    both = said([ran(0.8), ran(0.78, smoothing="deviatoric")], "smoothing")
    assert [claim.reproduced for claim in both.values()] == [None]  # both are where the experiment is


def test_materials() -> None:
    plain, sand = ran(0.84), ran(0.82, material="ubcsand")
    early = np.where(T < 0.2, 0.05, 0.0)  # apart at first, as in the paper
    sand = replace(sand, curves=sand.curves | {"front_99": plain.curves["front_99"] - early})
    assert [claim.reproduced for claim in said([plain, sand], "material").values()] == [True, True, True, None, True]
    far = said([plain, ran(1.0, material="ubcsand:Rf=0.9")], "material")
    assert [claim.reproduced for claim in far.values()] == [False, False, False, None, False]
    much = said([plain, ran(0.7, material="ubcsand")], "material")
    assert much[ClaimCode.SAND_STIFFER].reproduced is False  # by a sixth
    assert "+19.0 %" in words.found(far[ClaimCode.MATERIALS_CLOSE])
    assert not said([plain, ran(material="drucker_prager")], "material")


def test_families_differ_in_one_axis_alone() -> None:
    runs = [ran(ppc=ppc, damping=damping) for ppc in (4, 9) for damping in (0.0, 0.05)]
    assert [[one.run.ppc for one in family] for family in families(runs, "ppc")] == [[4, 9], [4, 9]]
    several = claims(runs, ["ppc", "damping"])
    assert {words.listed(claim.shared) for claim in several} == {
        "no damping",
        "5 % damping",
        "4 per cell",
        "9 per cell",
    }
    assert not claims([ran(ppc=4)], ["ppc"])  # one run is no family
    assert not claims([replace(one, run=replace(one.run, aspect=1.0)) for one in runs], ["ppc"])
    assert not claims([], ["ppc"])


@pytest.mark.parametrize(
    ("axis", "value", "told"),
    [
        ("cells", 14, "14 cells wide"),
        ("damping", 0.05, "5 % damping"),
        ("damping_kind", "objective", "objective damping"),
        ("deformation", "linear", "linear F"),
        ("limit", float("inf"), "no limit"),
        ("limit", 0.5, "limit 0.5"),
        ("smoothing", "none", "no smoothing"),
        ("void", False, "no void"),
        ("gate", float("inf"), "no gate"),
        ("offset", (0.0, 0.25), "offset (0.0, 0.25)"),
    ],
)
def test_words_of_a_value(axis: str, value: Any, told: str) -> None:
    assert words.value(axis, value) == told
