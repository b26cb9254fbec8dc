"""`verify objectivity`: its closed forms, its parts, and the whole of it on a coarse block that is quickly done."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from shutil import copytree
from tempfile import mkdtemp

import numpy as np
import pytest

from mpm_verify.cases.harness.analysis import analyse
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Examination
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.cases.objectivity import block as objectivity_block
from mpm_verify.cases.objectivity import rates as objectivity_kinematic
from mpm_verify.cases.objectivity.axes import KINEMATIC, Block
from mpm_verify.cases.objectivity.block import PRINTED, REST, SMALL, blocks, misses, numbers
from mpm_verify.cases.objectivity.exact import rotated, turn
from mpm_verify.cases.objectivity.exam import examination
from mpm_verify.cases.objectivity.findings import INERTIA, MODERATE, ObjectivityRemark, lead, of_runs
from mpm_verify.cases.objectivity.rates import CONTROLS
from mpm_verify.cases.objectivity.result import ObjectivityResult
from mpm_verify.mms.constitutive.simple_shear import SIMPLE_SHEAR
from mpm_verify.reports.frames import read
from mpm_verify.reports.sentences import failures
from mpm_verify.reports.sentences.remarks import notes, sentence
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import NEGATIVE_CONTROLS, RATES, available
from mpm_verify.verify.run import Settings, conduct, page_of

COARSE = Block(cells=4)
WRONG, RIGHT = available(NEGATIVE_CONTROLS), available(RATES)
UNSEEN = {"strain_start", "strain_end", "strain_fixed"}  # by Figure 2


@cache
def coarse_folder() -> Path:
    """A stored study of four cells along the block; the small one is a block of a third, whose steps are a third.

    So it is the arrays of that block that stand under the digest of the small one.
    """
    folder = Path(mkdtemp())
    store, study = Store(folder, "objectivity"), build(Asked("objectivity", {"cells": [4]}), "verify objectivity")
    store.create(study)
    small = blocks(COARSE)[SMALL]
    for run in study.runs:
        result, arrays = case_named("objectivity").execute(replace(run, L=COARSE.L / 3) if run == small else run)
        store.put(replace(result, run=run, digest=run.digest), arrays)
    return folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the stored study, to break."""
    return Path(copytree(coarse_folder(), tmp_path / "out"))


def of_folder(folder: Path) -> Examination:
    """The one examination of a stored study."""
    (found,) = read(folder).analysis.more.examinations.values()
    assert isinstance(found, Examination)
    return found


@cache
def coarse() -> Examination:
    """That of the coarse block."""
    return of_folder(coarse_folder())


def file_of(folder: Path, part: str) -> Path:
    """Arrays of a part: of a block by its name, or of the kinematic part."""
    named = {**blocks(COARSE), KINEMATIC: replace(COARSE, part=KINEMATIC)}
    return folder / "runs" / f"{named[part].digest}.npz"


# ---- the closed form


def test_a_stress_turned_with_its_body() -> None:
    """R diag(h, v) R^T by matrices, its swap at 90 degrees, and the largest shear stress, at 45."""
    angle = np.linspace(-3, 3, 61)
    found = rotated(-0.4, -1.0, angle)
    matrices = np.array([turn(a) @ np.diag([-0.4, -1.0]) @ turn(a).T for a in angle])
    np.testing.assert_allclose(found, matrices[:, [0, 1, 0], [0, 1, 1]], atol=1e-15)
    np.testing.assert_allclose(found[:, 0] + found[:, 1], -1.4, rtol=1e-15)
    np.testing.assert_allclose(found[:, 0] * found[:, 1] - found[:, 2] ** 2, 0.4, rtol=1e-13)
    np.testing.assert_allclose(
        rotated(-0.4, -1.0, np.array([0, np.pi / 2])), [[-0.4, -1, 0], [-1, -0.4, 0]], atol=1e-15
    )
    assert rotated(-3 / 7, -1.0, np.array([np.pi / 4]))[0, 2] == pytest.approx(2 / 7, rel=1e-14)


def test_figure2_by_a_rate_and_by_its_closed_form() -> None:
    found = objectivity_kinematic.figure2(COARSE, "green_naghdi")
    exact = objectivity_kinematic.exact_figure2(COARSE, found["t"])
    for name in ("xx", "yy", "xy"):
        np.testing.assert_allclose(found[name], exact[name], atol=1e-8)
    assert exact["xy"].max() == pytest.approx(2 / 7, rel=1e-4)
    assert np.abs(found["own_xy"]).max() < 1e-12


@pytest.mark.parametrize("rate", WRONG)
def test_figure2_sees_all_but_three_misreadings(rate: str) -> None:
    """A tenth of the stress, explicit_jaumann in few steps, stretched_frame at ten times the strain."""
    block = replace(COARSE, E=5e4) if rate == "stretched_frame" else COARSE
    found = objectivity_kinematic.figure2(block, rate, 10 if rate == "explicit_jaumann" else 200)
    exact = objectivity_kinematic.exact_figure2(block, found["t"])
    away = max(float(np.abs(found[name] - exact[name]).max()) for name in ("xx", "yy", "xy"))
    if rate in UNSEEN:
        assert away < 1e-8
    else:
        assert away > 0.1


# ---- the whole


@pytest.mark.slow
def test_all_parts_come_together() -> None:
    """Every check is there and has a number; on this coarse grid those of the runs need not pass, the others must."""
    found = coarse()
    assert len(found.checks) == 10 + 4 + len((*RIGHT, *WRONG)) + 27 + len((*RIGHT, *WRONG))
    assert all(np.isfinite(check.found) for check in found.checks)
    for check in found.checks:
        if check.group != objectivity_block.GROUP:
            assert check.outcome is Outcome.PASS, check
    assert {finding.group for finding in found.findings} <= {"", *found.groups, INERTIA}
    assert {finding.code for finding in found.findings} <= set(ObjectivityRemark)
    assert {name.partition("/")[2] for name in found.curves if name.startswith("control/")} == set(WRONG)
    assert {name.partition("/")[2] for name in found.curves if name.startswith("shear/")} == set(RIGHT)
    assert found.parameters["cells along the block"] == 4
    assert set(found.origins) <= set(found.parameters)


def test_the_runs_of_the_coarse_block() -> None:
    """They swap the stresses within a tenth, the smaller block is closer, and inertia is seen."""
    curves = coarse().curves
    large, small = curves[f"run/{PRINTED}"], curves[f"run/{SMALL}"]
    for curve, bound in ((large, 0.1), (small, 0.05)):
        assert misses(curve, COARSE).max() < bound
        assert curve["xx"][-1] == pytest.approx(-1, abs=bound)
        assert curve["xy"].max() == pytest.approx(2 / 7, abs=bound / 2)
    turned, rest = (curve["own_yy"][curve["t"] > 1].mean() + 1 for curve in (large, curves[f"run/{REST}"]))
    assert rest == pytest.approx(turned, abs=0.01)  # 0.005 and 0.011 with four cells
    for rate in WRONG:
        miss = curves[f"control/{rate}"]["run"][0]
        assert (miss > 0.25) == (rate in {"same_rotation", "printed", "printed_rotation", "stretched_frame"}), rate


def test_a_run_that_ends_early_is_an_error() -> None:
    """And its reason is the name of the check."""
    study, results = read(coarse_folder()).study, read(coarse_folder()).results
    named = {**blocks(COARSE), KINEMATIC: replace(COARSE, part=KINEMATIC)}
    stored = {name: results[run.digest] for name, run in named.items()}
    why = Failure(FailureKind.INVERTED, 7)
    stored[SMALL] = replace(stored[SMALL], status="failed", failure=why, values={})
    (check,) = objectivity_block.checks(COARSE, stored)
    assert (check.outcome, check.name, check.failure) == (Outcome.ERROR, SMALL, why)
    assert failures.check(check.name, check.failure) == f"{SMALL}: det F \N{LESS-THAN OR EQUAL TO} 0 at step 7"
    found = examination(study, COARSE, stored, {})
    assert found.outcome is Outcome.ERROR
    codes = {finding.code for finding in found.findings}
    assert ObjectivityRemark.MISSED in codes
    assert ObjectivityRemark.SWAP not in codes


def test_a_lead_counts_what_missed() -> None:
    checks = list(coarse().checks)
    passed = [check for check in checks if check.outcome is Outcome.PASS]
    curves = coarse().curves
    small = numbers(COARSE, curves[f"run/{SMALL}"])
    turns = lead(COARSE, passed, small, ["strain_end"])
    assert turns.code == ObjectivityRemark.TURNS
    assert f"reaches {curves[f'run/{SMALL}']['xy'].max():.3f} of the vertical stress" in sentence(turns)
    assert "the closed form has 0.286." in sentence(turns)
    assert f"All {len(WRONG)} negative controls are seen" in sentence(turns)
    failed = replace(passed[0], found=np.nan)
    missed = lead(COARSE, [failed, *passed[1:]], small, [])
    assert sentence(missed).startswith(f"1 of {len(passed)} checks did not pass")


# ---- what it says


def test_the_words_about_shear_stresses_and_their_numbers() -> None:
    """Where the paper's sentence holds and where it cannot, with what these runs gave."""
    found = coarse()
    printed, small = found.curves[f"run/{PRINTED}"], found.curves[f"run/{SMALL}"]
    text = " ".join(notes(found, objectivity_block.GROUP))
    assert "That holds for the co-rotated components" in text
    assert "It cannot hold for the components in fixed axes" in text
    assert "rises to 0.286 of the vertical stress, at 45 degrees" in text
    assert f"the small block reaches {small['xy'].max():.3f}." in text
    own = np.abs(printed["own_xy"][printed["t"] > 1])
    quarter = len(own) // 4
    assert f"rises to {100 * own[:quarter].max():.2g} % of the vertical stress as the turn begins" in text
    assert f"is {100 * own[-quarter:].max():.2g} % at its end" in text
    assert own[-quarter:].max() < own[:quarter].max() < 0.1
    inertia = " ".join(notes(found, INERTIA))
    assert "ω² L / g is 0.25" in inertia
    assert f"{100 * (printed['own_yy'][printed['t'] > 1].mean() + 1):.2g} %" in inertia


def test_the_controls_that_figure_2_does_not_see() -> None:
    """Named by what they miss there, with the orders that a turn with strain gives them."""
    (unseen,) = [f for f in coarse().findings if f.code == ObjectivityRemark.CONTROLS]
    assert set(unseen.numbers) == UNSEEN
    assert list(unseen.numbers.values()) == pytest.approx([1, 1, 1], abs=0.1)
    (printed,) = [f for f in coarse().findings if f.code == ObjectivityRemark.PRINTED]
    assert printed.numbers["miss"] == coarse().curves["control/printed"]["kinematic"][0] > 0.1
    text = notes(coarse(), CONTROLS)[0]
    assert all(name in text for name in UNSEEN)
    assert not [name for name in set(WRONG) - UNSEEN - {"stretched_frame"} if name in text]


def test_words_take_their_numbers_from_the_runs() -> None:
    """Other curves, other numbers."""
    t = np.linspace(0.02, 2, 100)
    own = np.where(t > 1, 0.03 * np.exp(-3 * (t - 1)), 0.0)
    angle = np.pi / 2 * np.maximum(0, t - 1)
    curve = {
        "t": t,
        "angle": angle,
        "xx": 0 * t,
        "yy": 0 * t,
        "xy": 0.25 * np.sin(2 * angle),
        "own_xy": own,
        "own_yy": 0 * t - 0.96,
        "shear": own,
    }
    of_run = numbers(COARSE, curve)
    found = of_runs(COARSE, of_run, of_run, of_run)
    first, inertia = (
        " ".join(sentence(one) for one in found if one.group == group) for group in (objectivity_block.GROUP, INERTIA)
    )
    assert "rises to 2.8 % of" in first
    assert "is 0.29 % at its end" in first
    assert "the small block reaches 0.250." in first
    assert "misses its static value by 4 %" in inertia


def test_simple_shear_as_the_words_say() -> None:
    """A moderate shear: the shear stresses agree within 5 %, as is told, and not much further."""
    for gamma, together in ((0.5 * MODERATE, True), (MODERATE, True), (2 * MODERATE, False)):
        s12 = [float(SIMPLE_SHEAR[rate](np.array([gamma]))[0, 2]) for rate in RIGHT]
        assert (max(s12) / min(s12) < 1.05) == together
        if gamma == MODERATE:
            (told,) = [f for f in coarse().findings if f.code == ObjectivityRemark.NOT_UNIQUE]
            assert told.numbers["spread"] == pytest.approx(max(s12) / min(s12) - 1)


# ---- stored, and drawn again


def test_the_page_is_made_of_what_is_stored(folder: Path) -> None:
    text = page_of(read(folder)).read_text()
    for part in ("Figure 2: a block is loaded", "Negative controls", "Orders in time", "Objective is not unique"):
        assert part in text
    for name in (*RIGHT, *WRONG):
        assert name.replace("_", " ") in text
    assert len(list((folder / "figures").glob("*.png"))) == text.count('<svg role="img"') == 8


@pytest.mark.slow
@pytest.mark.parametrize(("part", "figures"), [(SMALL, 5), (REST, 6), (KINEMATIC, 4), ("printed", 8)])
def test_curves_that_cannot_be_read_cost_figures_alone(
    part: str, figures: int, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Not a check, not a word but those that say so, not the exit code."""
    file = file_of(folder, part)
    file.write_bytes(file.read_bytes()[:1000])
    found, whole = of_folder(folder), coarse()
    assert found.checks == whole.checks
    assert found.findings[:-1] == whole.findings
    told = found.findings[-1]
    assert (told.code, told.numbers) == (ObjectivityRemark.UNREAD, {"files": f"runs/{file.name}"})
    study = read(folder).study
    assert conduct(study, Settings(folder)) == analyse_code(folder)
    out = " ".join(capsys.readouterr().out.split())
    assert f"The curves in runs/{file.name} cannot be read, and their figures are left out" in out
    text = (folder / "report.html").read_text()
    assert f"The curves in runs/{file.name} cannot be read" in text
    assert text.count('<svg role="img"') == figures


def analyse_code(folder: Path) -> int:
    """Exit code of the study whose arrays are all there."""
    whole = read(coarse_folder())
    return analyse(whole.study, whole.results, whole.store).exit_code


def test_a_second_time_nothing_is_computed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every part is a run of the store."""
    study = read(folder).study
    assert len(study.runs) == len(set(study.runs)) == 3 + len(WRONG) + 1
    for part in ("execute", "prescribed"):
        monkeypatch.setattr(f"mpm_verify.cases.objectivity.{part}.execute", lambda *_: pytest.fail("computed"))
    before = {file: file.stat().st_mtime_ns for file in (folder / "runs").iterdir()}
    conduct(study, Settings(folder, page=False))
    assert {file: file.stat().st_mtime_ns for file in (folder / "runs").iterdir()} == before


def made(part: str, nu: float) -> Block:
    """A block or the kinematic part of another material."""
    return replace({**blocks(COARSE), KINEMATIC: replace(COARSE, part=KINEMATIC)}[part], nu=nu)


def test_several_blocks_are_told_apart(folder: Path) -> None:
    """Names by what they differ in, in checks and headings, whatever that is."""
    study: Study[Block] = build(Asked("objectivity", {"cells": [4], "nu": [0.3, 0.2]}), "")
    stored = read(folder).results
    results: dict[str, ObjectivityResult] = dict(stored)
    for part, run in {**blocks(COARSE), KINEMATIC: replace(COARSE, part=KINEMATIC)}.items():
        other = made(part, 0.2)
        results[other.digest] = replace(stored[run.digest], run=other, digest=other.digest)
    found = analyse(study, results, Store(folder, "objectivity"))
    assert list(found.more.examinations) == ["nu 0.3", "nu 0.2"]
    half = len(found.checks) // 2
    assert all(check.group.startswith("nu 0.3: ") for check in found.checks[:half])
    assert all(check.group.startswith("nu 0.2: ") for check in found.checks[half:])


@pytest.mark.slow
def test_verify_objectivity_passes(tmp_path: Path) -> None:
    """As the command runs it, in this process: the block of a hundredth takes most of its time."""
    study = build(Asked("objectivity", {}), "verify objectivity")
    assert conduct(study, Settings(tmp_path, page=False, jobs=1)) == 0
    missed = [check for check in of_folder(tmp_path).checks if check.outcome is not Outcome.PASS]
    assert not missed
