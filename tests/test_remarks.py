"""Sentences and outcomes: every code has words, and no outcome, exit code or stored byte depends on any word."""

import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_column_claims import ran

from mpm_verify.cases.column.claims import SPEAK, claims
from mpm_verify.cases.column.exam import ColumnRemark
from mpm_verify.cases.column.records import ClaimCode
from mpm_verify.cases.element.element import ElementFailure
from mpm_verify.cases.element.exam import ElementRemark
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Examination, Remark
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.objectivity.axes import KINEMATIC, Block
from mpm_verify.cases.objectivity.execute import ObjectivityResult
from mpm_verify.cases.objectivity.findings import ObjectivityRemark
from mpm_verify.cases.objectivity.rates import order_checks, order_errors
from mpm_verify.mms.blind_spots import ALWAYS, AROUND, RULES, SEEN_BY, BlindSpot, BlindSpotCode, judge
from mpm_verify.reports.sentences import blind_spots, column, element, numbers, objectivity, remarks
from mpm_verify.verify.main import main

MODULES = (blind_spots, column, element, numbers, objectivity, remarks)
TIMES = ("command", "environment", "wall_s", "cpu_s", "peak_memory_mb")
EVERY: dict[str, type] = {"column": ColumnRemark, "element": ElementRemark, "objectivity": ObjectivityRemark}


def silence(patch: pytest.MonkeyPatch) -> None:
    """Make every function that writes words, and every word of a table, an x."""
    for module in MODULES:
        for name, held in vars(module).items():
            if callable(held) and getattr(held, "__annotations__", {}).get("return") is str:
                patch.setattr(module, name, lambda *_: "x")
            elif name.isupper() and isinstance(held, dict):
                patch.setattr(module, name, {key: mute(value) for key, value in held.items()})


def mute(value: Any) -> Any:
    """An x, or what says x."""
    return (lambda *_: "x") if callable(value) else "x"


def digest(folder: Path) -> str:
    """Hash of what is stored of a study and its runs: all but pages, figures, tables, times and the folder."""
    text = hashlib.sha256()
    for file in sorted(folder.rglob("*")):
        if file.suffix == ".json":
            content = json.loads(file.read_text())
            text.update(json.dumps({k: v for k, v in content.items() if k not in TIMES}).encode())
        elif file.suffix == ".npz":
            with np.load(file) as stored:
                text.update(b"".join(name.encode() + stored[name].tobytes() for name in sorted(stored.files)))
    return text.hexdigest()


def ask(folder: Path, *words: str) -> tuple[int, str]:
    """Exit code and digest of a command."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "argv", ["verify", *words, "--out", str(folder)])
        with pytest.raises(SystemExit) as end:
            main()
    return int(end.value.code or 0), digest(folder)


@pytest.mark.parametrize(
    "words",
    [
        ("material", "ubcsand", "--test", "isotropic", "--test", "undrained", "--steps", "8"),
        pytest.param(
            ("column", "--cells", "2", "--ppc", "4", "--duration", "0.1"),
            marks=pytest.mark.slow,  # two columns' pages
        ),
    ],
    ids=["material", "column"],
)
def test_no_outcome_depends_on_words(words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    usual = ask(tmp_path / "one" / "out", *words)
    silence(monkeypatch)
    assert ask(tmp_path / "two" / "out", *words) == usual
    text = (tmp_path / "two" / "out" / "report.html").read_text()
    assert '<p class="lead">x' in text  # and the words were gone


def test_no_claim_depends_on_words(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = every_claim()
    silence(monkeypatch)
    assert every_claim() == usual
    assert {column.says(claim) for claim in usual} == {column.found(claim) for claim in usual} == {"x"}


def test_checks_are_stored_without_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Checks, their outcomes and findings are read as they were; the page alone has words."""
    kept = tuple(order_checks({"jaumann": order_errors("jaumann")}))
    run = Block(part=KINEMATIC)
    store = Store(tmp_path, "objectivity")
    store.create(build(Asked("objectivity", {}), ""))
    store.put(ObjectivityResult(run=run, digest=run.digest, status="finished", checks=kept), {})
    silence(monkeypatch)
    assert store.get(run.digest).checks == kept
    found = Examination("objectivity", "t", "c", (Remark("objectivity.increment"),), store.get(run.digest).checks)
    assert (found.outcome, remarks.lead(found)) == ("PASS", "x")
    wrong = (replace(kept[0], expected=1.0),)
    assert replace(found, checks=wrong).outcome == "FAIL"


# ---- every code has a sentence


@pytest.mark.parametrize("case", EVERY)
def test_every_remark_has_words(case: str) -> None:
    assert set(remarks.table(case)) == set(EVERY[case])
    assert {code.partition(".")[0] for code in EVERY[case]} == {case}


def every_claim() -> list[Any]:
    """Claims on every axis, of made runs."""
    families = {
        "ppc": [ran(0.9, 0.08, ppc=1), ran(0.91, 0.15, ppc=4)],
        "damping": [ran(0.9), ran(0.84, damping=0.1)],
        "smoothing": [ran(0.9), ran(1.0, smoothing="volumetric"), ran(0.85, smoothing="deviatoric")],
        "material": [ran(0.84), ran(0.82, material="ubcsand")],
    }
    assert set(families) == set(SPEAK)
    return [claim for axis, family in families.items() for claim in claims(family, [axis])]


def test_every_claim_has_words() -> None:
    found = every_claim()
    assert [claim.code for claim in found] == list(ClaimCode)
    assert len({column.says(claim) for claim in found}) == len(ClaimCode)
    for text in (*map(column.says, found), *map(column.found, found)):
        assert text[0].isupper()
        assert text.endswith(".")


def numbers_of_a_solution(size: float) -> dict[str, float]:
    """Numbers of the auditor, all of them of one size."""
    names = {name for _, needed in RULES.values() for name in needed} - {"finest"}
    return dict.fromkeys({*names, "strain"}, size)


def spots() -> Iterator[BlindSpot]:
    """Each blind spot both ways."""
    for size in (0.0, 20.0):
        yield from judge(numbers_of_a_solution(size))
    yield from judge(numbers_of_a_solution(20.0) | {"left": 1.0, "top": 2.0, "small_strain": 1.0})
    for size in (0.0, 20.0):
        hoop = {name: size for _, needed in AROUND.values() for name in needed}
        yield from judge(numbers_of_a_solution(20.0) | hoop | {"axisymmetric": 1.0})


def test_every_blind_spot_has_words() -> None:
    every = {spot.code for spot in spots()}
    some = {BlindSpotCode.EDGES, BlindSpotCode.MODEL, BlindSpotCode.HOOP}  # of some solutions alone
    assert every == set(BlindSpotCode) == set(SEEN_BY) | {spot.code for spot in ALWAYS} | some
    for spot in spots():
        for blind in (False, True) if spot.code in RULES | AROUND else (spot.blind,):
            text = blind_spots.sentence(replace(spot, blind=blind))
            assert text[0].isupper() or text.startswith("det F")
            assert text.endswith(".")


@pytest.mark.parametrize("cause", ElementFailure)
def test_every_failure_of_an_element_has_words(cause: ElementFailure) -> None:
    text = element.failed({"cause": cause, "left": 1e-3, "step": 3, "steps": 20})
    assert text.startswith("It failed at step 3 of 20: ")
    assert text.endswith(".")


@pytest.mark.parametrize(("fraction", "text"), [(0.9998, "100 %"), (1.6, "160 %"), (0.0312, "3.1 %"), (0.0, "0 %")])
def test_percentages_have_no_exponent(fraction: float, text: str) -> None:
    assert numbers.percent(fraction) == text
    assert numbers.span(fraction, fraction + 1e-6) == f"{fraction:.2f}"
