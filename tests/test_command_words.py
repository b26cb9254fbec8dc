"""Words of the command: names that are near to what was typed, lists with commas, and what is completed."""

from dataclasses import fields
from importlib import import_module
from pathlib import Path
from typing import Any, get_type_hints

import fixtures_study as fixtures
import pytest
from fixtures_command import Call, caller, one_line

from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.study_file import study_of
from mpm_verify.cases.mms import execute as mms
from mpm_verify.reports.frames import read
from mpm_verify.solver.plugins import CASES, MATERIALS, METHODS, SOLUTIONS, available
from mpm_verify.verify.choices import completion
from mpm_verify.verify.options import option, split


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


# ---- did you mean


MEANT = {
    "a command": (["metods"], "methods"),
    "an option": (["mms", "--materal", "x"], "--material"),
    "a method": (["mms", "--method", "cpdi,gmp"], "gimp"),
    "a method in capitals": (["mms", "--method", "CPDI2"], "cpdi2"),
    "a solution": (["mms", "--solution", "axis_alined"], "axis_aligned"),
    "a material": (["column", "--material", "mohr_colomb"], "mohr_coulomb"),
    "a transfer": (["mms", "--transfer", "fip"], "flip"),
    "a parameter": (["mms", "--solution", "axis_aligned:phas=1"], "phase"),
    "a study": (["sweep", "figure33"], "figure3"),
    "a case": (["schema", "colum"], "column"),
    "a schema": (["schema", "case-foldr"], "case-folder"),
    "an audit": (["audit", "swirll"], "swirl"),
}


@pytest.mark.parametrize("name", MEANT)
def test_a_near_name_is_told(verify: Call, name: str) -> None:
    arguments, meant = MEANT[name]
    line = one_line(verify(*arguments))
    assert f"did you mean {meant}?" in line.lower()
    assert line.lower().count("did you mean") == 1


@pytest.mark.parametrize(
    "arguments", [["zzz"], ["mms", "--zzz"], ["mms", "--method", "zzz"], ["sweep", "zzz"], ["schema", "zzz"]]
)
def test_no_name_is_near(verify: Call, arguments: list[str]) -> None:
    assert "did you mean" not in one_line(verify(*arguments)).lower()


@pytest.mark.parametrize(
    ("content", "meant"),
    [({"cas": "mms"}, "case"), ({"run": {"dampin": 0.1}}, "damping"), ({"case": "mmms"}, "mms")],
)
def test_a_near_name_in_a_file(content: dict[str, Any], meant: str) -> None:
    with pytest.raises(ValueError, match=rf"did you mean {meant}\?"):
        study_of("own", content, "verify sweep own.toml")


# ---- lists with commas


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("cpdi:limit=0.5,mpm", ["cpdi:limit=0.5", "mpm"]),
        ("axis_aligned:A=0.01,phase=0.5,bar", ["axis_aligned:A=0.01,phase=0.5", "bar"]),
        ("bar,axis_aligned:A=0.01,phase=0.5", ["bar", "axis_aligned:A=0.01,phase=0.5"]),
        ("a/own.py:A=1,B=2,bar,b/own.py", ["a/own.py:A=1,B=2", "bar", "b/own.py"]),
        ("mohr_coulomb:rate=own.py,phi=30,ubcsand", ["mohr_coulomb:rate=own.py,phi=30", "ubcsand"]),
        ("mpm, cpdi", ["mpm", "cpdi"]),
    ],
)
def test_a_list_with_parameters(text: str, parts: list[str]) -> None:
    assert split(text) == parts


@pytest.mark.slow
def test_several_methods_and_solutions_are_one_study(
    verify: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """And one page, with a section a solution and a verdict each; results are made up."""

    def execute(run: Any, tick: object) -> tuple[Any, dict[str, Any]]:
        known = fixtures.Run("cpdi", "axis_aligned", "neo_hookean", run.cells, run.ppc, run.courant)
        result = fixtures._result(known)
        return type(result)(**{**vars(result), "run": run, "digest": run.digest}), fixtures.arrays(known)

    monkeypatch.setattr(mms, "execute", execute)
    words = ["--method", "cpdi:limit=0.5,mpm", "--solution", "axis_aligned:A=0.01,phase=0.5,bar"]
    code, _, err = verify("mms", *words, "--cells", "8,16", "--ppc", "4", "--jobs", "1", "--out", "study")
    assert (code, err) == (3, "")
    record = read(tmp_path / "study")
    assert {(run.method, run.solution) for run in record.study.runs} == {
        (method, solution)
        for method in ("cpdi:limit=0.5", "mpm")
        for solution in ("axis_aligned:A=0.01,phase=0.5", "bar")
    }
    page = (tmp_path / "study" / "report.html").read_text()
    assert all(f"<h2>{solution}" in page or f">{solution}</h" in page for solution in record.solutions)
    assert len(list((tmp_path / "study").glob("**/report.html"))) == 1
    names = {file.stem for file in (tmp_path / "study" / "figures").glob("figure1_*.svg")}
    assert {"figure1_bar", "figure1_axis_aligned_A_0_01_phase_0_5"} <= names


def test_a_parameter_of_a_method_is_read_before_a_run() -> None:
    """And one that is at its default is none."""
    with pytest.raises(ValueError, match="cpdi has no parameter 'limt'"):
        build(Asked("mms", {"method": ["cpdi:limt=1"], "cells": [8]}), "", "t")
    with pytest.raises(ValueError, match="limit='wide' is not a number"):
        build(Asked("mms", {"method": ["cpdi:limit=wide"], "cells": [8]}), "", "t")
    (run, *_) = build(Asked("mms", {"method": ["cpdi:limit=0.50"], "cells": [8], "ppc": [1]}), "", "t").runs
    assert run.method == "cpdi:limit=0.5"


# ---- completion


def completed(case: str, name: str, text: str = "") -> list[str]:
    """What the option of a field completes."""
    run = getattr(import_module(f"{CASES}.{case}.{ {'element': 'axes', 'objectivity': 'axes'}.get(case, 'run')}"),
                  {"mms": "Run", "column": "ColumnRun", "element": "ElementRun"}.get(case, "Run"))  # fmt: skip
    item = next(item for item in fields(run) if item.name == name)
    (info,) = option(item, get_type_hints(run), {}).__metadata__
    found: list[str] = info.autocompletion(text)
    return found


CHOICES = [
    ("mms", "stress", ["usl", "musl", "usf"]),
    ("mms", "staggered", ["yes", "no"]),
    ("mms", "method", available(METHODS)),
    ("mms", "solution", available(SOLUTIONS)),
    ("column", "material", available(MATERIALS)),
    ("column", "start", ["none", "k0", "oedometric"]),
    ("column", "left", ["roller", "fixed", "frictional"]),
    ("column", "damping_kind", ["local", "objective"]),
    ("column", "deformation", ["exponential", "linear"]),
    ("column", "mirror", ["yes", "no"]),
    ("element", "units", ["percent", "fraction"]),
]


@pytest.mark.parametrize(("case", "name", "words"), CHOICES)
def test_choices_are_completed(case: str, name: str, words: list[str]) -> None:
    assert completed(case, name) == words
    first = words[-1]
    assert first in completed(case, name, first[:2])
    assert all(word.startswith(first[:2]) for word in completed(case, name, first[:2]))
    assert completed(case, name, "nothing_like_it") == []


def test_tests_of_an_element_are_completed() -> None:
    from mpm_verify.cases.element.paths import TESTS

    assert completed("element", "test") == [*TESTS, "properties"]


def test_numbers_are_not_completed() -> None:
    assert completed("mms", "cells") == completed("column", "g") == []


def test_the_last_of_a_list_is_completed() -> None:
    assert completion(METHODS)("mpm,cpdi") == ["mpm,cpdi", "mpm,cpdi2"]
    assert completion(METHODS)("mpm,nothing") == []


@pytest.mark.parametrize("case", available(CASES))
def test_what_is_completed_is_taken(case: str) -> None:
    """Every word that a field completes is one that a run can have."""
    contract = case_named(case)
    if case == "objectivity":
        pytest.skip("its words are no options")
    for item in fields(contract.Run):
        for word in item.metadata.get("choices") or ():
            needs = {"path": "a.csv", "test": "path"} if item.name in ("units", "motion") else {}
            assert getattr(contract.Run(**{**needs, item.name: word}), item.name) == word
