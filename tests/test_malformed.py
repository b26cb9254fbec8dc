"""Malformed result files, levels and case folders, by the hundred: one line each, and nothing that is stored is lost.

Each is a good one with one thing wrong. Bytes changed at random may leave an answer that can be read: then it is read.
"""

import json
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fixtures_command import Call, caller, one_line
from test_own_solver import HEAD, STEPS, X, arrays, csv, points, rows

from mpm_verify.cases.solvers.answer import Frame, read
from mpm_verify.cases.solvers.levels import Levels, levels
from mpm_verify.reports.sentences import failures
from mpm_verify.solver.failure import FailureKind, RunFailed

pytestmark = pytest.mark.slow  # the kinds of mistakes are in tests/test_own_solver.py too
STEP = STEPS[0]
NAMES = HEAD.split(",")
LINES = len(X) + 1
SEEDS = 20
WORDS = ["nan", "inf", "-1e999", "", "1.0.0", "0x1p3", "1,5", "one", "--1", "1e", "\x00"]
WRONG = ["left out", "twice", "cut", "more"]


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def good(folder: Path, ending: str = "csv") -> Path:
    """A file of the exact answer."""
    {"csv": csv, "npz": arrays, "vtu": points}[ending](folder, STEP, rows(STEP))
    return folder / f"result_{STEP}.{ending}"


def refused(folder: Path) -> str:
    """What is said of an answer that cannot be used, in one line."""
    with pytest.raises(RunFailed) as caught:
        read(folder, STEP, X, 0.125)
    said = failures.failure(caught.value.failure)
    assert "\n" not in said
    assert len(said) < 200
    return said


# ---- result files: 15 columns and 65 lines, each wrong in turn


@pytest.mark.parametrize("column", range(len(NAMES)))
@pytest.mark.parametrize("word", WORDS)
def test_a_value_that_is_none(tmp_path: Path, column: int, word: str) -> None:
    """Also in a column that is not needed: whoever writes it has made a mistake."""
    with_word(good(tmp_path), column, word)
    assert "result_3.csv" in refused(tmp_path)


def with_word(path: Path, column: int, word: str) -> None:
    """A table with this word in a column of a row."""
    lines = path.read_text().splitlines()
    values = lines[7].split(",")
    values[column] = word
    lines[7] = ",".join(values)
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("line", range(0, LINES, 4))
@pytest.mark.parametrize("wrong", WRONG)
def test_a_line_that_is_wrong(tmp_path: Path, line: int, wrong: str) -> None:
    with_line(good(tmp_path), line, wrong)
    if line == 0 and wrong == "cut":  # a header of seven columns above rows of fifteen
        assert "cannot be read" in refused(tmp_path)
    elif line or wrong != "more":
        assert refused(tmp_path)


def with_line(path: Path, line: int, wrong: str) -> None:
    """A table with a line that is wrong."""
    lines = path.read_text().splitlines()
    half = lines[line].split(",")[:7]
    lines[line : line + 1] = {
        "left out": [], "twice": [lines[line]] * 2, "cut": [",".join(half)], "more": [lines[line] + ",1,2"],
    }[wrong]  # fmt: skip
    path.write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize("ending", ["csv", "npz", "vtu"])
@pytest.mark.parametrize("part", np.linspace(0.0, 0.97, 12).tolist())
def test_a_file_that_was_cut(tmp_path: Path, ending: str, part: float) -> None:
    """As a full disk or a killed program leaves it."""
    path = good(tmp_path, ending)
    data = path.read_bytes()
    path.write_bytes(data[: int(part * len(data))])
    assert refused(tmp_path)


@pytest.mark.parametrize("ending", ["csv", "npz", "vtu"])
@pytest.mark.parametrize("seed", range(SEEDS))
def test_bytes_changed_at_random(tmp_path: Path, ending: str, seed: int) -> None:
    """Read, or refused in one line."""
    path, rng = good(tmp_path, ending), np.random.default_rng(seed)
    data = bytearray(path.read_bytes())
    for at in rng.integers(0, len(data), 1 + seed % 5):
        data[at] = rng.integers(0, 256)
    path.write_bytes(bytes(data))
    said, frame = tried(tmp_path)
    assert "\n" not in said
    if frame:
        assert frame.fields["x"].shape == X.shape
        assert all(np.isfinite(values).all() for values in frame.fields.values())


def tried(folder: Path) -> tuple[str, Frame | None]:
    """What is said of an answer, or what it is."""
    try:
        return "", read(folder, STEP, X, 0.125)
    except RunFailed as error:
        return failures.failure(error.failure), None


OTHERS: dict[str, Callable[[Path], object]] = {
    "a folder": lambda path: path.mkdir(),
    "a link to nothing": lambda path: path.symlink_to("nowhere.csv"),
    "a link to itself": lambda path: path.symlink_to(path.name),
    "spaces alone": lambda path: path.write_text(" \n \n\t\n"),
    "no header": lambda path: np.savetxt(path, rows(STEP), delimiter=","),
    "a page": lambda path: path.write_text("<html><body>502 Bad Gateway</body></html>\n"),
    "JSON": lambda path: path.write_text(json.dumps({"x": [1, 2], "y": [3, 4]})),
    "UTF-16": lambda path: path.write_bytes("id,x,y\n0,1,2\n".encode("utf-16")),
    "a column twice": lambda path: path.write_text("id,x,x,y\n" + "".join(f"{k},0,0,0\n" for k in range(len(X)))),
    "an id with a half": lambda path: path.write_text("id,x,y\n" + "".join(f"{k}.5,0,0\n" for k in range(len(X)))),
    "ids from one": lambda path: path.write_text("id,x,y\n" + "".join(f"{k + 1},0,0\n" for k in range(len(X)))),
    "an id that is negative": lambda path: path.write_text("id,x,y\n" + "".join(f"{-k},0,0\n" for k in range(len(X)))),
    "an id too large": lambda path: path.write_text("id,x,y\n" + "".join(f"{k}e300,0,0\n" for k in range(len(X)))),
    "quotes that do not close": lambda path: path.write_text('id,x,y\n"0,1,2\n' * len(X)),
    "a very long line": lambda path: path.write_text("id," + "x" * 10**6 + "\n"),
    "many columns": lambda path: path.write_text(",".join(f"c{k}" for k in range(300)) + "\n"),
}


@pytest.mark.parametrize("name", OTHERS)
def test_what_is_no_table(tmp_path: Path, name: str) -> None:
    OTHERS[name](tmp_path / f"result_{STEP}.csv")
    assert refused(tmp_path)


NPZ: dict[str, dict[str, object]] = {
    "objects": {"x": np.array([{}] * len(X), dtype=object)},
    "texts": {"x": np.full((len(X), 2), "one")},
    "complex numbers": {"x": X + 1j, "id": np.arange(len(X))},
    "a number": {"x": 3.0},
    "nothing": {},
    "four components": {"x": np.zeros((len(X), 4)), "id": np.arange(len(X))},
    "another length": {"x": X, "v": X[1:], "id": np.arange(len(X))},
    "no ids": {"x": X},
    "transposed": {"x": X.T, "id": np.arange(len(X))},
    "three axes": {"x": np.zeros((len(X), 2, 2)), "id": np.arange(len(X))},
    "F of six": {"x": X, "F": np.zeros((len(X), 6)), "id": np.arange(len(X))},
}


@pytest.mark.parametrize("name", NPZ)
def test_arrays_that_are_none(tmp_path: Path, name: str) -> None:
    np.savez(tmp_path / f"result_{STEP}.npz", **NPZ[name])  # type: ignore[arg-type]
    assert refused(tmp_path)


# ---- levels


VALUES = ["null", '"x"', "[]", "{}", "99", "-3", "1e999", "NaN", '"0.5 steps"', "true" * 2]
BAD_LEVELS = [f'{{"{key}": {value}}}' for key in ("v_lag", "F_lag") for value in VALUES]
BAD_LEVELS += [
    "",
    " ",
    "[]",
    "null",
    "3",
    '"v_lag"',
    "{",
    '{"v_lag": 0.5',
    "{'v_lag': 0.5}",
    "[" * 10**5,
    "\x00",
    "v_lag = 0",
]


@pytest.mark.parametrize("text", BAD_LEVELS, ids=lambda text: text[:20] or "empty")
def test_levels_that_are_none(tmp_path: Path, text: str) -> None:
    (tmp_path / "result.json").write_text(text)
    with pytest.raises(RunFailed) as caught:
        levels(tmp_path)
    assert caught.value.failure.kind is FailureKind.UNREADABLE
    said = failures.failure(caught.value.failure)
    known = (
        "it is empty",
        "it is no JSON, line 1",
        "it is not of the form",
        "v_lag is not a number from -2 to 2",
        "F_lag is",
    )
    assert said.removeprefix("result.json cannot be read: ").startswith(known)
    assert "\n" not in said


def test_levels_that_are_a_folder(tmp_path: Path) -> None:
    (tmp_path / "result.json").mkdir()
    with pytest.raises(RunFailed):
        levels(tmp_path)
    assert levels(tmp_path / "nowhere") == Levels()


# ---- through the command: exit code 4, one line, and what was stored stays

PICK = """
n=$(cat number)
echo $((n + 1)) > number
echo "answer $n"
steps=$(sed -n 's/^frames_[0-9]* //p' $1/case.txt)
[ $n = 0 ] || steps=${steps%%[!0-9]*}
for file in answers/$n/*; do
    case $file in
        *.json) cp -R $file $2/ ;;
        *) for step in $steps; do cp -R $file $2/result_$step.${file##*.}; done ;;
    esac
done
"""  # of a malformed answer the first frame is enough


def answers(folder: Path) -> int:
    """Write malformed answers of one frame into numbered folders, none of which can be used; how many."""
    number = 0

    def another() -> Path:
        nonlocal number
        number += 1
        made = folder / str(number)
        made.mkdir(parents=True)
        return made

    for column in range(len(NAMES)):
        for word in WORDS:
            with_word(good(another()), column, word)
    for line in range(0, LINES, 4):
        for wrong in WRONG:
            if line or wrong != "more":
                with_line(good(another()), line, wrong)
    for ending in ("csv", "npz", "vtu"):
        for part in np.linspace(0.0, 0.97, 12):
            path = good(another(), ending)
            path.write_bytes(path.read_bytes()[: int(part * path.stat().st_size)])
    for write in OTHERS.values():
        write(another() / f"result_{STEP}.csv")
    for found in NPZ.values():
        np.savez(another() / f"result_{STEP}.npz", **found)  # type: ignore[arg-type]
    for text in BAD_LEVELS:
        made = another()
        good(made)
        (made / "result.json").write_text(text)
    return number


def test_each_malformed_answer_ends_a_study_with_exit_code_4(verify: Call, tmp_path: Path) -> None:
    """More than 300, each given back by a program that ends well: one line each, and what is stored stays as it is."""
    count = answers(tmp_path / "answers")
    assert count >= 300
    (tmp_path / "pick.sh").write_text(PICK)
    (tmp_path / "number").write_text("0")
    (tmp_path / "answers" / "0").mkdir()
    good(tmp_path / "answers" / "0")
    asked = ("mms", "--solver", "sh pick.sh {case} {out}", "--solution", "clamped_shear", "--cells", "4", "--jobs", "1",
             "--time-step", "h2", "--courant", "0.2", "--order", "2", "--out", "study", "--json",
             "--no-page")  # fmt: skip
    code, out, _ = verify(*asked, "--solver-version", "sound")
    (sound,) = json.loads(out)["runs"]
    assert (code, sound["status"]) == (3, "finished"), sound
    kept = {path: path.read_bytes() for path in (tmp_path / "study" / "runs").glob("*")}

    code, out, err = verify(*asked, "--solver-version", ",".join(str(number) for number in range(1, count + 1)))
    found = {int(run["log"][0].removeprefix("answer ")): run for run in json.loads(out)["runs"]}
    assert code == 4
    assert err == ""
    assert sorted(found) == list(range(1, count + 1))
    for number, run in found.items():
        assert run["status"] == "failed", (number, run["errors"])
        assert run["reason"], number
        assert "\n" not in run["reason"]
        assert len(run["reason"]) < 200
    assert {str(run["failure"]["kind"]) for run in found.values()} >= {"unreadable", "not_finite", "no_column"}
    assert {path: path.read_bytes() for path in kept} == kept


@pytest.mark.parametrize("name", ["nothing", "empty", "binary", "half", "nan", "levels", "folder"])
def test_the_store_keeps_what_it_has(verify: Call, tmp_path: Path, name: str) -> None:
    """A right answer at 8 cells is stored; at 12 comes one that is none; the first is not run again, nor lost."""
    code, _, _ = verify("example", "python", "toy")
    assert code == 0
    wrong = {
        "nothing": "p.unlink()", "empty": "p.write_text('')", "binary": "p.write_bytes(bytes(range(256)) * 9)",
        "half": "p.write_text('\\n'.join(p.read_text().splitlines()[:99]))",
        "nan": "p.write_text(p.read_text().replace('0.', 'nan '))", "folder": "p.unlink(); p.mkdir()",
        "levels": "(out / 'result.json').write_text('[')",
    }[name]  # fmt: skip
    solver = tmp_path / "toy" / "solver.py"
    more = f"if record['cells'] == 12:\n    p = sorted(out.glob('result_*.csv'))[0]\n    {wrong}\n"
    solver.write_text(solver.read_text() + more)
    typed = f"{sys.executable} toy/solver.py {{case}} {{out}}"
    asked = ("mms", "--solver", typed, "--solution", "bump", "--order", "2", "--out", "study", "--json")
    code, out, _ = verify(*asked, "--cells", "8")
    first = json.loads(out)["runs"]
    assert code == 3
    code, out, _ = verify(*asked, "--cells", "8,12")
    found = {(run["cells"], run["courant"]): run for run in json.loads(out)["runs"]}
    assert code == 3
    assert found[12, 0.4]["status"] == "failed"
    kept = next(run for run in first if run["courant"] == 0.4)
    assert found[8, 0.4]["errors"] == kept["errors"]
    assert found[8, 0.4]["wall_s"] == kept["wall_s"]  # so it was not run again


# ---- case folders


JSON_VALUES = [None, "x", [], {}, -1, 1e999, True, "é" * 50]
JSON_KEYS = ["format", "dimension", "dx", "cells", "particles", "edges", "frames", "material", "languages", "dt"]


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An exported case."""
    from mpm_verify.reports.export.case_folder import write
    from mpm_verify.verify.commands.export import made

    folder = tmp_path_factory.mktemp("cases") / "case"
    write(folder, made("bump", None, 4, 1, 0.4, 4))
    return folder


@pytest.mark.parametrize("key", JSON_KEYS)
@pytest.mark.parametrize("value", [*JSON_VALUES, "missing"], ids=str)
def test_a_record_that_is_wrong(verify: Call, tmp_path: Path, case: Path, key: str, value: object) -> None:
    folder = copied(case, tmp_path)
    record = json.loads((folder / "case.json").read_text())
    record[key] = value
    if value == "missing":
        record.pop(key)
    (folder / "case.json").write_text(json.dumps(record))
    before = files(folder)
    code, out, _ = said = verify("check-force", "case", "--lang", "python")
    if code == 0:  # of another type or value, and the sources agree: nothing that they are checked with has changed
        assert type(value) in (float, bool, int, list, dict, str)
        assert "agree" in out
    else:
        assert code == 2
        assert "case.json" in one_line(said)
    assert files(folder) == before


@pytest.mark.parametrize("file", ["case.json", "selfcheck.csv", "selfcheck_fields.csv"])
@pytest.mark.parametrize("wrong", ["missing", "empty", "cut", "binary", "header", "words", "folder", "list"])
def test_a_folder_that_is_wrong(verify: Call, tmp_path: Path, case: Path, file: str, wrong: str) -> None:
    folder = copied(case, tmp_path)
    path = folder / file
    text = path.read_text()
    path.unlink()
    if wrong == "folder":
        path.mkdir()
    elif wrong == "binary":
        path.write_bytes(bytes(range(256)))
    elif wrong != "missing":
        path.write_text({"empty": "", "cut": text[: len(text) // 2], "header": text.split("\n")[0],
                         "words": text.replace("0.", "zero "), "list": "[1, 2]"}[wrong])  # fmt: skip
    before = files(folder)
    line = one_line(verify("check-force", "case", "--lang", "python"))
    assert file in line or "case" in line
    assert files(folder) == before


def copied(case: Path, folder: Path) -> Path:
    """A copy of a case."""
    import shutil

    return Path(shutil.copytree(case, folder / "case"))


def files(folder: Path) -> dict[str, bytes]:
    """Content of all files of a folder."""
    return {
        str(path): path.read_bytes() for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts
    }
