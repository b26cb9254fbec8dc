"""Power and safety of the order rule: counting over known sequences, intervals, what no rule can tell, the page."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fixtures_command import TOP, caller, one_line, process

from mpm_verify.cases.judging.fit import local_orders
from mpm_verify.cases.judging.known import CELLS, KNOWN, Known
from mpm_verify.cases.judging.power import CLEAN, Promise, Row, Standing, floors, interval, measure, promises, row
from mpm_verify.cases.mms.run import AXES, QUICK
from mpm_verify.reports.export import power as files
from mpm_verify.reports.sentences import power as words
from mpm_verify.verify.commands import power as command

DOCS = TOP / "docs"
NAMES = [known.name for known in KNOWN]


def known(name: str) -> Known:
    return next(one for one in KNOWN if one.name == name)


def sizes(levels: str) -> np.ndarray:
    return 1 / np.array(CELLS[levels], dtype=float)


# --- sequences -------------------------------------------------------------------------------------------------------


def test_levels_are_those_of_the_studies() -> None:
    assert CELLS["default"] == tuple(AXES["cells"])
    assert CELLS["quick"] == tuple(QUICK["cells"])
    assert len(CELLS["six levels"]) == 6
    assert len(set(NAMES)) == len(NAMES) > 15


@pytest.mark.parametrize(
    ("name", "levels", "other"),
    [
        ("h^2", "default", 0.0),
        ("h^1.7", "quick", 1.0),
        ("h^2 + 0.005 h", "default", 0.005 / (0.005 + 1 / 128)),
        ("h^2 + 0.005 h", "quick", 0.005 / (0.005 + 1 / 32)),
        ("h^2 + 1e-5", "default", 1e-5 / (1e-5 + 2**-14)),
        ("40% of h in the square", "six levels", 1 - 0.84**0.5),  # 8 %
    ],
)
def test_what_is_not_of_second_order(name: str, levels: str, other: float) -> None:
    one, h = known(name), sizes(levels)
    assert one.other(h) == pytest.approx(other)
    assert one.sound(h) == (other <= 0.1)


def test_a_floor_is_sound_where_it_is_small() -> None:
    assert [known("h^2 + 1e-5").sound(sizes(levels)) for levels in CELLS] == [False, True, False]
    assert [known("h^2 / (1 + 16 h)").sound(sizes(levels)) for levels in CELLS] == [True, False, True]
    assert [known("h^2 + 1e-6").sound(sizes(levels)) for levels in CELLS] == [True, True, True]


@pytest.mark.parametrize("levels", CELLS)
def test_local_orders_of_the_sequences(levels: str) -> None:
    h = sizes(levels)
    orders = {name: local_orders(h, known(name).error(h)) for name in NAMES}
    assert orders["h^1.5"] == pytest.approx(1.5)
    assert orders["order 2.0 to 1.5"] == pytest.approx(np.linspace(2.0, 1.5, len(h) - 1))
    fine = np.array([2e-5, 1e-5, 5e-6])
    tends = {name: float(local_orders(fine, known(name).error(fine))[-1]) for name in NAMES}
    assert [name for name in NAMES if tends[name] == pytest.approx(2, abs=0.01)] == NAMES[:6]


def test_random_signs_add_in_the_square() -> None:
    """The mean over draws is the root of the sum of squares; one draw is off by 2ab/(a² + b²) over sqrt(N)."""
    one, h = known("50% of h in the square"), sizes("default")
    rng = np.random.default_rng(1)
    drawn = np.array([one.drawn(h, 0.0, rng) for _ in range(2000)])
    assert drawn.mean(axis=0) == pytest.approx(one.error(h), rel=5e-4)
    a, b = math.sqrt(0.75) * h**2, 0.5 * h * h[-1]
    expected = a * b / (a**2 + b**2) / np.sqrt(4 / h**2)
    assert drawn.std(axis=0) / one.error(h) == pytest.approx(expected, rel=0.1)
    assert b[-1] / np.hypot(a, b)[-1] == pytest.approx(0.5)


def test_scatter_is_what_it_says() -> None:
    h, rng = sizes("quick"), np.random.default_rng(1)
    drawn = np.log([CLEAN.drawn(h, 0.15, rng) / h**2 for _ in range(1000)])
    assert drawn.std() == pytest.approx(0.15, rel=0.05)
    assert (CLEAN.drawn(h, 0.0, rng) == h**2).all()


# --- counting --------------------------------------------------------------------------------------------------------


def counted(sequence: str, passed: int, failed: int, left: int, **more: object) -> Row:
    sound = sequence == "h^2"
    return replace(Row(sequence, "quick", 0.03, sound, 0.0, passed, failed, left, ""), **more)  # type: ignore[arg-type]


def test_a_row_is_the_same_for_the_same_seed_alone() -> None:
    item = ("h^1.5", "default", 0.03)
    assert row(item, 30, 0) == row(item, 30, 0)
    assert {row(item, 30, seed).failed for seed in range(4)} != {row(item, 30, 0).failed}
    assert row(item, 30, 0).draws == 30


def test_without_scatter_one_draw_stands_for_all() -> None:
    assert row(("h^1", "default", 0.0), 400, 0).failed == 400
    clean = row(("h^2", "quick", 0.0), 400, 0)
    assert (clean.passed, clean.right, clean.wrong, clean.reason) == (400, 400, 0, "")


def test_right_and_wrong() -> None:
    assert (counted("h^2", 5, 2, 3).right, counted("h^2", 5, 2, 3).wrong) == (5, 2)
    assert (counted("h^1", 5, 2, 3).right, counted("h^1", 5, 2, 3).wrong) == (2, 5)


def test_an_interval_of_a_rate() -> None:
    """Wilson's, of 10 in 100 and of 0 in 100."""
    assert interval(10, 100) == pytest.approx((0.0552, 0.1744), abs=1e-4)
    assert interval(0, 100) == pytest.approx((0.0, 0.0370), abs=1e-4)
    assert interval(100, 100) == pytest.approx((0.9630, 1.0), abs=1e-4)


def test_no_rule_tells_apart_what_is_near() -> None:
    """The most powerful test of two normal means one deviation apart, at 95 % power: passes the other in 74 %."""
    clean = counted("h^2", 9608, 0, 392)
    assert interval(clean.passed, clean.draws)[0] == pytest.approx(0.957, abs=1e-3)
    x = np.log(sizes("quick"))
    apart = float(np.linalg.norm(x - x.mean()))  # of two orders that differ by one
    near, far = counted("h^1", 0, 1, 0, scatter=apart), counted("h^1", 0, 1, 0, scatter=apart / 6)
    assert near.least(clean) == pytest.approx(0.764, abs=3e-3)
    assert far.least(clean) < 1e-4
    assert near.least(counted("h^2", 0, 0, 9)) == 0
    other = counted("h^1", 392, 9608, 0, scatter=apart)
    assert counted("h^2", 5, 5, 0, scatter=apart).least(other) == pytest.approx(0.764, abs=3e-3)


def test_what_is_hidden_is_like_the_nearest_of_another_verdict() -> None:
    clean, worse, bad = (
        counted("h^2", 95, 0, 5),
        counted("h^2 + 1e-5", 10, 0, 90),
        counted("50% of h in the square", 4, 0, 96),
    )
    found = floors([clean, worse, bad])
    assert found[bad] == max(bad.least(clean), bad.least(worse)) > 0
    assert found[clean] == max(clean.least(bad), clean.least(worse))
    assert floors([replace(one, scatter=0.0) for one in (clean, worse, bad)])[replace(bad, scatter=0.0)] == 0


def test_promises_are_those_of_the_worst() -> None:
    clean, hidden = counted("h^2", 90, 1, 9), counted("h^2 + 1e-6", 90, 0, 10, sound=False)
    near, far = counted("h^1.7", 4, 50, 46), counted("h^1", 0, 100, 0)
    found = promises([clean, hidden, near, far])
    assert [(one.kind, one.row.sequence, one.count) for one in found] == [
        ("bad_passes", "h^1.7", 4), ("sound_fails", "h^2", 1), ("clean_passes", "h^2", 90),
    ]  # fmt: skip
    assert all(one.kept for one in found)


@pytest.mark.parametrize(
    ("kind", "count", "limit", "kept"),
    [("bad_passes", 9, 0.05, True), ("bad_passes", 12, 0.05, False), ("sound_fails", 8, 0.01, False),
     ("clean_passes", 85, 0.95, False), ("clean_passes", 92, 0.95, True)],
)  # fmt: skip
def test_a_promise_is_broken_where_its_interval_says_so(kind: str, count: int, limit: float, kept: bool) -> None:
    assert Promise(kind, counted("h^2", count, 0, 100 - count), count, limit).kept is kept


@pytest.mark.parametrize(
    ("kind", "count", "limit", "standing", "said"),
    [
        ("bad_passes", 5, 0.05, Standing.SHOWN, "yes"),
        ("bad_passes", 6, 0.05, Standing.OPEN, "not shown"),
        ("bad_passes", 12, 0.05, Standing.BROKEN, "NO"),
        ("clean_passes", 95, 0.95, Standing.SHOWN, "yes"),
        ("clean_passes", 94, 0.95, Standing.OPEN, "not shown"),
        ("clean_passes", 85, 0.95, Standing.BROKEN, "NO"),
    ],
)
def test_a_rate_that_is_not_as_wanted_is_not_said_to_be_kept(
    kind: str, count: int, limit: float, standing: Standing, said: str
) -> None:
    """One draw beyond what is wanted is enough, and the exit code hangs on the interval alone."""
    one = Promise(kind, counted("h^2", count, 0, 100 - count), count, limit)
    assert one.standing is standing
    assert one.kept == (standing is not Standing.BROKEN)
    assert words.promise(one)[-1] == said
    assert words.sentence(one).endswith(
        {"yes": "wanted: kept", "NO": "wanted: not kept", "not shown": "wanted: not shown to be kept, nor broken"}[said]
    )


def test_every_sequence_is_measured_on_every_level() -> None:
    asked: list[object] = []

    def mapping(function: object, items: list[object]) -> list[Row]:
        asked.extend(items)
        return []

    assert measure(1, 0, mapping) == []
    assert len(asked) == len(set(asked)) == len(KNOWN) * len(CELLS) * 4


# --- files, command --------------------------------------------------------------------------------------------------


def test_the_page_is_that_of_the_table() -> None:
    rows = files.read(DOCS / "power.csv")
    assert len(rows) == len(KNOWN) * len(CELLS) * 4
    assert files.markdown(rows) == (DOCS / "power.md").read_text()
    text = (DOCS / "power.md").read_text()
    assert text.count("| NO |") == sum(not one.kept for one in promises(rows))
    assert text.count("| not shown |") == sum(one.standing is Standing.OPEN for one in promises(rows)) == 4


@pytest.mark.parametrize("item", [("h^2", "quick", 0.03), ("h^1.7", "default", 0.03)])
def test_the_table_is_that_of_the_rule(item: tuple[str, str, float]) -> None:
    """Counted again: after a change of the rule, verify power --out docs."""
    (stored,) = [one for one in files.read(DOCS / "power.csv") if (one.sequence, one.levels, one.scatter) == item]
    assert row(item, stored.draws, 0) == stored


@pytest.mark.slow
def test_the_whole_table_is_that_of_the_rule(tmp_path: Path) -> None:
    done = process("power", "--draws", "60", "--jobs", "2", "--out", str(tmp_path))
    rows = {(one.sequence, one.levels, one.scatter): one for one in files.read(tmp_path / "power.csv")}
    stored = {(one.sequence, one.levels, one.scatter): one for one in files.read(DOCS / "power.csv")}
    assert rows.keys() == stored.keys()
    for key, one in rows.items():
        assert abs(one.passed / one.draws - stored[key].passed / stored[key].draws) < 0.25, key
        assert one.sound == stored[key].sound
    assert done.code == (0 if all(one.kept for one in promises(list(rows.values()))) else 1)


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    near = counted("20% of h in the square", 9, 0, 91)
    counted_rows = [counted("h^2", 90, 1, 9), counted("h^1.7", 4, 50, 46), near]
    monkeypatch.setattr(command, "measured", lambda *_: counted_rows)
    assert command.power(draws=100, seed=0, out=tmp_path, json_output=False) == 0
    said = capsys.readouterr().out
    assert "h^1.7 bad 4 / 50 / 46" in " ".join(said.split())
    assert "quick   worst bad passes   h^1.7" in said
    assert "quick, 3 % scatter: 20 % of h in the square passes 9.0 %, by any rule at least 66.1 %" in said
    assert files.read(tmp_path / "power.csv") == counted_rows
    assert (tmp_path / "power.png").stat().st_size > 10_000
    monkeypatch.setattr(command, "measured", lambda *_: [counted("h^2", 50, 5, 45), counted("h^1", 0, 9, 0)])
    assert command.power(draws=100, seed=0, out=tmp_path, json_output=True) == 1
    told = json.loads(capsys.readouterr().out)
    assert [one["kept"] for one in told["promises"]] == [True, False, False]
    assert told["promises"][1]["sentence"].startswith("quick: worst sound fails, h² with 3 % scatter, in 5.0 % of")


@pytest.mark.parametrize("words", [("--draws", "49"), ("--jobs", "0"), ("--seed", "-1")])
def test_misuse_is_one_line(
    words: tuple[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert words[0] in one_line(caller(monkeypatch, capsys, tmp_path)("power", *words, "--out", "new"))
    assert not (tmp_path / "new").exists()
