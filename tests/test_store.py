"""The run store: what is written is read back equal, is never half there, and is lost by nothing that goes wrong."""

import errno
import gc
import json
import os
import re
from dataclasses import fields, replace
from pathlib import Path

import fixtures_study as fixtures
import numpy as np
import pytest

from mpm_verify.cases.harness import identity
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.runner import pending
from mpm_verify.cases.harness.store import Store, StoreError, case_of
from mpm_verify.cases.harness.study import FORMAT, Study
from mpm_verify.cases.judging.order import Expectation
from mpm_verify.cases.judging.records import Recorded
from mpm_verify.cases.mms.run import STARTS, Result, Run
from mpm_verify.solver.failure import Failure, FailureKind
from mpm_verify.solver.plugins import CASES, available
from mpm_verify.verify.main import main

RUN = Run("cpdi", "axis_aligned", "neo_hookean", 8, 4, 0.4)
OTHER = {str: "other", int: 16, float: 0.125, tuple: (0.25, 0.0)}


@pytest.fixture
def store(tmp_path: Path) -> Store:
    made = Store(tmp_path / "study")
    made.create(Study("mms", "title", "verify mms", (RUN,), (), case="mms"))
    return made


def finished(run: Run = RUN) -> Result:
    return fixtures._result(run)


def content(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, hidden ones too."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}


def no_space(*_: object, **__: object) -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


# ---- what is written is read back


@pytest.mark.parametrize(
    "result",
    [
        finished(),
        replace(finished(), status="failed", errors={}, failure=Failure(FailureKind.INVERTED, 21, 35, (2, 2))),
        replace(
            finished(),
            status="failed",
            errors={},
            failure=Failure(FailureKind.UNSTABLE_STEP, numbers={"dt": 0.2, "limit": 0.1}),
        ),
    ],
    ids=["finished", "failed", "failed at once"],
)
def test_result_round_trip(store: Store, result: Result) -> None:
    store.put(result, {})
    assert store.get(result.digest) == result  # tuples come back as tuples, so dataclasses compare equal


def test_numbers_come_back_to_the_last_bit(store: Store) -> None:
    odd = replace(finished(), wall_s=0.1 + 0.2, dt=5e-324, scale={"u": 1 / 3, "v": 1.7976931348623157e308})
    store.put(odd, {})
    assert store.get(odd.digest) == odd


def test_study_round_trip(tmp_path: Path) -> None:
    expectations = (
        Expectation(2.0, source="theory", recorded=(Recorded(1 / 128, 1e-5, 1e-5),)),
        Expectation(None),
        None,
    )
    declared = tuple(fixtures.plan("cpdi", "affine", 4, "u", "rms", e is not None, e) for e in expectations)
    study = Study("mms", "title", "verify mms", (RUN, replace(RUN, force=True)), declared, case="mms")
    Store(tmp_path).create(study)
    assert Store(tmp_path).study() == study


def test_arrays_round_trip(store: Store) -> None:
    arrays = fixtures.arrays(RUN)
    store.put(finished(), arrays)
    found = store.arrays(RUN.digest)
    assert found.keys() == arrays.keys()
    for name, values in arrays.items():
        assert found[name].dtype == values.dtype
        np.testing.assert_array_equal(found[name], values)


def test_what_is_not_stored_is_none(store: Store) -> None:
    assert store.get("0" * 16) is None


def test_create_keeps_results(store: Store) -> None:
    store.put(finished(), {})
    store.create(Study("mms", "another", "verify mms", (), (), case="mms"))
    assert store.get(RUN.digest) == finished()
    assert store.study().title == "another"


# ---- the digest is the name of the run


SPECIAL = {
    "start": STARTS[0],
    "precision": "single",
    "time_step": "h2",
    "dim": 3,
    "manufacture": "damping",
}  # fields that take some words alone


@pytest.mark.parametrize("name", [field.name for field in fields(Run) if field.metadata["named"]])
def test_digest_depends_on_every_field(name: str) -> None:
    value = getattr(RUN, name)
    changed = not value if isinstance(value, bool) else SPECIAL.get(name, OTHER[type(value)])
    assert replace(RUN, **{name: changed}).digest != RUN.digest


def test_digest_depends_on_the_sources(monkeypatch: pytest.MonkeyPatch) -> None:
    before = RUN.digest
    monkeypatch.setattr(identity, "sources", lambda *_: "changed")
    assert RUN.digest != before
    assert len(RUN.digest) == 16


def test_digest_is_repeatable() -> None:
    assert RUN.digest == Run("cpdi", "axis_aligned", "neo_hookean", 8, 4, 0.4).digest


# ---- atomic: old or new, never half


class PowerCutError(BaseException):
    """Not an Exception, as SIGINT is none: the clean-up has to work for both."""


def power_cut(*_: object) -> None:
    raise PowerCutError


@pytest.mark.parametrize("moment", ["os.fsync", "os.replace"])
def test_cut_while_writing_leaves_the_old_content(store: Store, monkeypatch: pytest.MonkeyPatch, moment: str) -> None:
    store.put(finished(), fixtures.arrays(RUN))
    before = content(store.folder)
    monkeypatch.setattr(moment, power_cut)
    with pytest.raises(PowerCutError):
        store.put(replace(finished(), wall_s=1.0), {})
    assert content(store.folder) == before  # no temporary file either


def test_cut_between_arrays_and_result_leaves_the_run_to_be_done(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Arrays are written first: a run whose Result is there has its arrays too."""
    replace_file, calls = os.replace, []

    def cut_at_second(source: str, target: Path) -> None:
        calls.append(target)
        if len(calls) == 2:
            raise PowerCutError
        replace_file(source, target)

    monkeypatch.setattr("os.replace", cut_at_second)
    with pytest.raises(PowerCutError):
        store.put(finished(), fixtures.arrays(RUN))
    assert [target.suffix for target in calls] == [".npz", ".json"]
    assert store.get(RUN.digest) is None


@pytest.mark.parametrize("call", ["os.fsync", "os.replace", "pathlib.Path.open"])
def test_disk_full(store: Store, monkeypatch: pytest.MonkeyPatch, call: str) -> None:
    store.put(finished(), fixtures.arrays(RUN))
    before = content(store.folder)
    monkeypatch.setattr(call, no_space)
    with pytest.raises(StoreError, match="No space left on device; results stored before are kept") as told:
        store.put(finished(replace(RUN, cells=16)), {})
    assert "\n" not in str(told.value)
    monkeypatch.undo()
    assert content(store.folder) == before
    assert store.get(RUN.digest) == finished()


# ---- what is broken is named and left as it is


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is broken and was left as it is"),
        ('{"format": 2, "run": {"method"', "is broken"),
        ("[1, 2]", "is broken"),
        ("null", "is broken"),
        ('{"format": 2}', "is broken"),
        ("\x00\xff", "is broken"),
        ('{"format": 7}', "has format 7, this version reads 2"),
        ("{}", "has format None, this version reads 2"),
    ],
)
@pytest.mark.parametrize("name", ["study.json", "runs/{digest}.json"])
def test_broken_json(store: Store, name: str, text: str, said: str) -> None:
    path = store.folder / name.format(digest=RUN.digest)
    path.write_text(text, encoding="latin-1")
    before = content(store.folder)
    with pytest.raises(StoreError, match=said) as told:
        store.study() if name == "study.json" else store.get(RUN.digest)
    assert str(path) in str(told.value)
    assert "\n" not in str(told.value)
    assert content(store.folder) == before


def test_result_with_a_missing_field_is_broken(store: Store) -> None:
    store.put(finished(), {})
    path = store.runs / f"{RUN.digest}.json"
    data = json.loads(path.read_text())
    del data["errors"]
    path.write_text(json.dumps(data))
    with pytest.raises(StoreError, match="is broken"):
        store.get(RUN.digest)


@pytest.mark.parametrize("text", ['{"format": 1', '{"format": 7}'])
def test_create_does_not_write_over_a_broken_study(store: Store, text: str) -> None:
    (store.folder / "study.json").write_text(text)
    with pytest.raises(StoreError):
        store.create(Study("mms", "title", "verify mms", (), (), case="mms"))
    assert (store.folder / "study.json").read_text() == text


@pytest.mark.parametrize("mine", available(CASES))
def test_a_folder_of_another_case_is_left_as_it_is(store: Store, mine: str) -> None:
    """Its study, its Results and its arrays; one line says whose it is."""
    store.put(finished(), fixtures.arrays(RUN))
    before, other = content(store.folder), Store(store.folder, mine)
    study = Study("x", "x", "x", (case_named(mine).Run(),), (), case=mine)
    if mine == "mms":
        other.create(study)
        assert content(store.folder).keys() == before.keys()
        return
    for refused in (lambda: other.create(study), other.study, lambda: other.get(RUN.digest)):
        with pytest.raises(StoreError, match=f"{store.folder} holds the case mms, not {mine}; use another") as told:
            refused()
        assert "\n" not in str(told.value)
    assert content(store.folder) == before
    assert case_of(store.folder) == "mms"


COMMANDS = {"column": ["column"], "element": ["material", "mohr_coulomb"], "objectivity": ["objectivity"]}


@pytest.mark.parametrize("case", COMMANDS)
def test_a_command_of_another_case_is_refused(
    store: Store, case: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    store.put(finished(), fixtures.arrays(RUN))
    before = content(store.folder)
    monkeypatch.setattr("sys.argv", ["verify", *COMMANDS[case], "--out", str(store.folder)])
    with pytest.raises(SystemExit) as ended:
        main()
    told = capsys.readouterr()
    assert (ended.value.code, told.out) == (2, "")
    assert told.err == f"verify: {store.folder} holds the case mms, not {case}; use another --out folder\n"
    assert content(store.folder) == before


def test_a_result_of_another_format_is_not_read_and_not_run_again(store: Store) -> None:
    """Older numbers are neither judged nor lost: nothing runs until they are out of the way."""
    store.put(finished(), {})
    path = store.runs / f"{RUN.digest}.json"
    for number in (1, FORMAT + 1):
        path.write_text(json.dumps(json.loads(path.read_text()) | {"format": number}))
        before = content(store.folder)
        says = f"{path} has format {number}, this version reads {FORMAT}; use another --out folder"
        for refused in (lambda: store.get(RUN.digest), lambda: pending(store.study(), store)):
            with pytest.raises(StoreError, match=re.escape(says)) as told:
                refused()
            assert "\n" not in str(told.value)
        assert content(store.folder) == before


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "is broken and was left as it is"),
        ("[]", f"is of the case None, and this version has {', '.join(available(CASES))}; use"),
        ('{"format": 2}', "is of the case None"),
        ('{"case": "mms"}', "has format None, this version reads 2"),
        ('{"format": 1, "case": "beam"}', "has format 1, this version reads 2"),
        (
            '{"format": 2, "case": "beam"}',
            f"is of the case beam, and this version has {', '.join(available(CASES))}; use",
        ),
        ('{"format": 2, "case": ["mms"]}', "is of the case "),
    ],
)
def test_whose_a_folder_is(store: Store, text: str, says: str) -> None:
    assert case_of(store.folder) == "mms"
    (store.folder / "study.json").write_text(text)
    with pytest.raises(StoreError, match=says) as told:
        case_of(store.folder)
    assert "\n" not in str(told.value)
    with pytest.raises(StoreError, match=r"is not a study folder: it has no study\.json"):
        case_of(store.folder / "runs")


def test_no_study_folder(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match=r"is not a study folder: it has no study\.json"):
        Store(tmp_path).study()


def test_folder_below_a_file(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(StoreError, match=r"cannot make the study folder .* give a writable one with --out"):
        Store(tmp_path / "file" / "study").create(Study("mms", "title", "verify mms", (), (), case="mms"))


def test_missing_arrays(store: Store) -> None:
    with pytest.raises(StoreError, match=r"delete it and its \.json file to run that run again"):
        store.arrays(RUN.digest)


@pytest.mark.slow
@pytest.mark.parametrize("keep", [0, 100, -30])
def test_broken_arrays(store: Store, keep: int) -> None:
    """Cut to nothing, to its first bytes, and without the end of its directory."""
    store.put(finished(), fixtures.arrays(RUN))
    path = store.runs / f"{RUN.digest}.npz"
    path.write_bytes(path.read_bytes()[:keep])
    with pytest.raises(Exception) as told:  # noqa: PT011 - which one is the question
        store.arrays(RUN.digest)
    kind, text = told.type, str(told.value)
    del told  # a file left open is found now, in this test, and not in the next one
    gc.collect()
    assert kind is StoreError
    assert text.startswith(f"cannot read {path}")
    assert "\n" not in text


def test_no_pickles_are_read(store: Store) -> None:
    """A study folder may come from elsewhere: reading it must not run code."""
    np.savez(store.runs / f"{RUN.digest}.npz", x=np.array([{}], dtype=object))
    with pytest.raises(StoreError, match="cannot read"):
        store.arrays(RUN.digest)


def test_a_folder_in_use_is_refused_and_left_as_it_is(store: Store) -> None:
    before = (store.folder / "study.json").read_bytes()
    with store.locked(), pytest.raises(StoreError, match="another verify works in"), Store(store.folder).locked():
        pytest.fail("two hold the folder")
    with store.locked():
        assert (store.folder / "study.json").read_bytes() == before
