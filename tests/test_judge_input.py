"""Files that hold a table, however they are written, and those that do not: one line each, with what to write."""

import json
from pathlib import Path
from typing import Any

import pytest
from fixtures_command import Call, caller, one_line
from hypothesis import given
from hypothesis import strategies as st

from mpm_verify.cases.any_code.reading import ERRORS, ROLES, read
from mpm_verify.cases.any_code.table import Expected, study

Points = list[tuple[float, float]]
PLAIN: Points = [(8.0, 1e-2), (16.0, 2.5e-3), (32.0, 6.25e-4)]


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def points(content: str | bytes, folder: Path, name: str = "errors.csv", exact: bool = True) -> Points:
    """Cells and numbers of a file."""
    file = folder / name
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return [(row.cells, row.number) for row in read(file, exact).rows]


# ---- the same table in other spellings

LINES = ["cells,error", "8,1e-2", "16,2.5e-3", "32,6.25e-4"]
TEXT = "\n".join(LINES)
SPELLINGS: dict[str, str | bytes] = {
    "commas": TEXT,
    "a last line end": TEXT + "\n",
    "line ends of Windows": TEXT.replace("\n", "\r\n"),
    "line ends of old": TEXT.replace("\n", "\r"),
    "a byte-order mark": b"\xef\xbb\xbf" + TEXT.encode(),
    "tabs": TEXT.replace(",", "\t"),
    "spaces": TEXT.replace(",", "   "),
    "semicolons and decimal commas": TEXT.replace(",", ";").replace(".", ","),
    "blank lines": TEXT.replace("\n", "\n\n  \n"),
    "comments": "# my code\n#\n" + TEXT.replace("8,", "# coarse\n8,") + "\n# end",
    "remarks in a line": TEXT.replace("2.5e-3", "2.5e-3 # twice"),
    "a header in a comment": "# cells error\n" + TEXT.partition("\n")[2].replace(",", " "),
    "a header in a comment above nan": "# cells error\n8 1e-2\n16 2.5e-3\n32 6.25e-4",
    "quotes": '"cells","error"\n"8","1e-2"\n"16","2.5e-3"\n"32","6.25e-4"',
    "a spreadsheet": "sep=,\n" + TEXT,
    "capitals": TEXT.replace("cells,error", "CELLS,Error"),
    "units": TEXT.replace("cells,error", "cells [-],error (m)"),
    "exponents of Fortran": TEXT.replace("e-", "D-"),
    "other columns": "\n".join(f"{line},{more}" for line, more in zip(LINES, ("time", "1", "x", ""), strict=True)),
    "another order": "\n".join(",".join(reversed(line.split(","))) for line in LINES),
    "a sign": TEXT.replace("1e-2", "+1e-2"),
}
JSONS: dict[str, Any] = {
    "a list of objects": [{"cells": n, "error": e} for n, e in PLAIN],
    "an object of columns": {"cells": [8, 16, 32], "error": [1e-2, 2.5e-3, 6.25e-4]},
    "texts": [{"cells": "8", "error": "1e-2"}, {"error": "2.5e-3", "cells": 16}, {"cells": 32, "error": 6.25e-4}],
}


@pytest.mark.parametrize("name", SPELLINGS)
def test_spellings(tmp_path: Path, name: str) -> None:
    assert points(SPELLINGS[name], tmp_path) == PLAIN


@pytest.mark.parametrize("file", ["errors.json", "errors.txt"])
@pytest.mark.parametrize("name", JSONS)
def test_json(tmp_path: Path, name: str, file: str) -> None:
    assert points(json.dumps(JSONS[name], indent=1), tmp_path, file) == PLAIN


@pytest.mark.parametrize(("role", "name"), [(role, name) for role in ("h", "cells", "error") for name in ROLES[role]])
def test_names_of_columns(tmp_path: Path, role: str, name: str) -> None:
    """And with another column of the role under its own name, that one is read."""
    other = {"h": "error", "cells": "error", "error": "cells"}[role]
    assert len(points(f"{name},{other}\n8,16\n16,8", tmp_path)) == 2
    if name != role and role != "h":
        assert points(f"{name},{role},{other}\n1,8,16\n2,16,8", tmp_path) == points(
            f"{role},{other}\n8,16\n16,8", tmp_path
        )


def test_names_are_told_apart() -> None:
    """A name stands for one role in a table of errors, and for one in a table of values."""
    for number in ("error", "value"):
        roles = ("h", "cells", number, "method", "quantity", "replicate", f"half_dt_{number}")
        names = [name for role in roles for name in ROLES[role]]
        assert len(set(names)) == len(names)
    assert len(ERRORS) > 50


@pytest.mark.parametrize(
    ("text", "h"), [("0.125", 0.125), ("1/8", 0.125), (" 1 / 8 ", 0.125), ("1e3", 1e3), ("12", 12.0)]
)
def test_cell_sizes(tmp_path: Path, text: str, h: float) -> None:
    ((cells, _),) = points(f"h,error\n{text},1", tmp_path)
    assert 1 / cells == pytest.approx(h, rel=1e-15)


def test_a_size_is_read_before_a_count(tmp_path: Path) -> None:
    """A count may be of all cells; the size needs no thought."""
    assert points("cells,h,error\n64,1/8,1", tmp_path) == [(8.0, 1.0)]
    found = read(tmp_path / "errors.csv")
    assert (found.by, found.taken, found.unused) == ("h", {"h": "h", "error": "error"}, ("cells",))


@given(
    st.lists(st.tuples(st.integers(1, 10**6), st.floats(0, 1e300)), min_size=1, max_size=8, unique_by=lambda p: p[0])
)
def test_numbers_are_read_as_they_were_written(pairs: list[tuple[int, float]]) -> None:
    """Every digit, by CSV and by JSON."""
    import tempfile

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        csv = "\n".join(["cells,error", *(f"{n},{e!r}" for n, e in pairs)])
        data = json.dumps([{"cells": n, "error": e} for n, e in pairs])
        assert points(csv, folder) == points(data, folder, "errors.json") == [(float(n), e) for n, e in pairs]


# ---- what cannot be read


def lines(*rows: str, head: str = "cells,error") -> str:
    return "\n".join([head, *rows])


BAD: dict[str, tuple[str | bytes, str]] = {
    "empty": ("", "must have a header with cells or h, and error"),
    "blank": ("\n \n\t\n", "must have a header with cells or h, and error"),
    "comments alone": ("# nothing\n", "must have a header"),
    "a header alone": ("cells,error\n", "has 0 rows below its header"),
    "a binary file": (bytes(range(256)) * 20, "not text; save it as CSV in UTF-8"),
    "UTF-16": (TEXT.encode("utf-16"), "UTF-16 text or not text"),
    "another encoding": ("méthode,error\n8,1".encode("latin-1"), "not CSV text in UTF-8"),
    "no header": ("8,1e-2\n16,2.5e-3", "no column cells or h and no error: found 8, 1e-2; names that are read: cells"),
    "no size": ("level,error\n1,1", "has no column cells or h: found level, error"),
    "no error": ("cells,foo\n8,1", "has no column error: found cells, foo; names that are read: cells: cells, n, nx"),
    "values": ("cells,value\n8,1", "of values, not errors, add --no-exact"),
    "two errors": ("cells,l2,linf\n8,1,1", "l2 and linf could each be the column error; name one of them error"),
    "two of a name": ("cells,error,Error\n8,1,1", "has two columns error"),
    "a ragged row": (lines("8,1", "16,1,2"), "line 3: 3 cells, and the header has 2"),
    "decimal commas between commas": (lines("8,0,1"), "where a comma is the decimal sign, semicolons must separate"),
    "a negative error": (lines("8,1", "16,-0.1"), "line 3: error = '-0.1' must not be negative"),
    "a negative infinity": (lines("8,-inf"), "line 2: error = '-inf' must not be negative"),
    "a true minus": (lines("8,\N{MINUS SIGN}0.1"), "must not be negative"),
    "a word": (lines("8,small"), "line 2: error = 'small' must be a number, or nan for a run that failed"),
    "an empty error": (lines("8,", "16,1"), "line 2: error is empty; write a number, or nan"),
    "an empty size": (lines(",1"), "line 2: cells is empty; must be a whole number"),
    "half a cell": (lines("8.5,1"), "line 2: cells = '8.5' must be a whole number from 1 on"),
    "no cell": (lines("0,1"), "cells = '0' must be a whole number"),
    "cells beyond counting": (lines("1e400,1"), "cells = '1e400' must be a whole number"),
    "negative cells": (lines("-8,1"), "cells = '-8' must be a whole number"),
    "a thousand with a comma": ("cells;error\n1,000;1", "cells = '1,000' must be a whole number"),
    "cells that are not a number": (lines("nan,1"), "cells = 'nan' must be a whole number"),
    "a size of zero": (lines("0,1", head="h,error"), "line 2: h = '0' must be a cell size above zero"),
    "a negative size": (lines("-0.1,1", head="h,error"), "h = '-0.1' must be a cell size above zero"),
    "a size over zero": (lines("1/0,1", head="h,error"), "h = '1/0' must be a cell size above zero"),
    "an infinite size": (lines("inf,1", head="h,error"), "h = 'inf' must be a cell size above zero"),
    "a tiny size": (lines("1e-320,1", head="h,error"), "must be a cell size above zero"),
    "the same cells": (lines("8,1", "16,1", "8,2"), "line 4: cells = 8 of code error is there already, in line 2"),
    "the same size": (lines("0.1,1", "1/10,2", head="h,error"), "line 3: h = 0.1 of code error is there already"),
    "the same replicate": (
        lines("8,1,a", "8,1,a", head="cells,error,replicate"), "replicate a of cells = 8 of code error is there",
    ),
    "sizes far apart": (lines("1,1", "1e-300,1", head="h,error"), "cell sizes of code error go from 1 to 1e-300"),
    "no method": (lines("8,1,fem", "16,1,", head="cells,error,method"), "line 3: method is empty; write the method"),
    "a negative half": (lines("8,1,-1", head="cells,error,half_dt_error"), "half_dt_error = '-1' must not be negative"),
    "too many rows": (lines(*(f"{n},1" for n in range(1, 5002))), "has 5001 rows below its header, and must have 1"),
}  # fmt: skip
BAD_JSON = {
    "not JSON": ("{", "cannot be read as JSON: line 1"),
    "empty": ("[]", "must be a list of objects, one a row, or an object of columns, with cells or h, and error"),
    "a number": ("[1]", "must be a list of objects"),
    "an object of numbers": ('{"cells": 8}', "must be a list of objects"),
    "columns of different lengths": ('{"cells": [8, 16], "error": [1]}', "different lengths (cells 2, error 1)"),
    "empty columns": ('{"cells": [], "error": []}', "must be a list of objects"),
    "yes or no": ('[{"cells": 8, "error": true}]', "row 1: error = true must be a number or a text"),
    "a list": ('[{"cells": 8, "error": [1]}]', "row 1: error = [1] must be a number or a text"),
    "null": ('[{"cells": 8, "error": 1}, {"cells": 16, "error": null}]', "row 2: error is empty"),
    "a key that is not there": ('[{"cells": 8, "error": 1}, {"error": 2}]', "row 2: cells is empty"),
    "the same cells": ('[{"cells": 8, "error": 1}, {"cells": 8, "error": 2}]', "row 2: cells = 8 of code error is"),
    "too deep": ("[" * 100_000, "cannot be read as JSON: it nests too deep"),
}  # fmt: skip


def refused(verify: Call, file: str, said: str, *options: str) -> None:
    line = one_line(verify("judge", file, "--order", "2", *options))
    assert file in line
    assert said in line, line
    assert not Path("results").exists()


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_read_is_one_line(verify: Call, name: str) -> None:
    content, said = BAD[name]
    Path("errors.csv").write_bytes(content if isinstance(content, bytes) else content.encode())
    refused(verify, "errors.csv", said)


@pytest.mark.parametrize("name", BAD_JSON)
def test_json_that_cannot_be_read_is_one_line(verify: Call, name: str) -> None:
    content, said = BAD_JSON[name]
    Path("errors.json").write_text(content)
    refused(verify, "errors.json", said)


def test_no_file_and_a_folder(verify: Call) -> None:
    Path("folder.csv").mkdir()
    refused(verify, "nowhere.csv", "no such file or directory")
    refused(verify, "folder.csv", "is a directory")


OPTIONS = {
    "--order": ("0", "-1", "nan", "inf", "21"),
    "--below": ("0", "-0.1", "nan", "inf"),
    "--above": ("0", "nan"),
    "--floor": ("-1e-9", "nan", "inf"),
}


@pytest.mark.parametrize(
    ("option", "value"), [(option, value) for option, values in OPTIONS.items() for value in values]
)
def test_options_that_cannot_be(verify: Call, option: str, value: str) -> None:
    Path("errors.csv").write_text(TEXT)
    assert option in one_line(verify("judge", "errors.csv", f"{option}={value}"))


def test_no_time_step_and_half_of_it(verify: Call) -> None:
    Path("errors.csv").write_text("cells,error,half_dt_error\n8,1,1\n")
    refused(verify, "errors.csv", "half a time step, and --steady that there is none; leave one out", "--steady")


def test_replicates_of_a_level_are_its_own(tmp_path: Path) -> None:
    """Whatever they are called: a seed that another level does not have is no other level."""
    file = tmp_path / "errors.csv"
    file.write_text("cells,seed,error\n8,17,1\n8,4,2\n16,99,3\n")
    made = study(read(file), Expected(), "", "t")
    assert [(run.cells, run.offset, run.number) for run in made.runs] == [
        (8.0, (0.0, 0.0), 1.0), (8.0, (1.0, 0.0), 2.0), (16.0, (0.0, 0.0), 3.0),
    ]  # fmt: skip


def test_a_size_and_a_count_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    """Cells along a side, of all the plane or of all space may stand beside h, and sizes may be rounded."""
    sides = [8, 12, 16, 24, 32]
    for power in (1, 2, 3):
        rows = [(f"{1 / n:.2g}", n**power) for n in sides]
        text = "\n".join(f"{count},{h},{1e-2 / n}" for (h, count), n in zip(rows, sides, strict=True))
        assert len(points(f"cells,h,error\n{text}", tmp_path)) == 5
    wrong = "\n".join(f"{n},{1 / (20 if n == 16 else n)},{1e-2 / n}" for n in sides)
    with pytest.raises(ValueError, match=r"line 4: h = '0\.05' and ncells = 16 contradict each other: h times") as said:
        points(f"ncells,h,error\n{wrong}", tmp_path)
    assert "is 1 elsewhere; mend one, or leave a column out" in str(said.value)
    assert "\n" not in str(said.value)
    assert len(points(f"elements,h,error\n{wrong}", tmp_path)) == 5  # of an adapted mesh they may be any number
    plane = "\n".join(f"{n**2},{1 / (20 if n == 16 else n)},{1e-2 / n}" for n in sides)
    with pytest.raises(ValueError, match=r"line 4: h = '0\.05' and ncells = 256 .*: h\^2 times ncells is 1 elsewhere"):
        points(f"ncells,h,error\n{plane}", tmp_path)


def test_sizes_are_compared_within_a_refinement(tmp_path: Path) -> None:
    """Triangles are twice as many as quads of the same size."""
    rows = "\n".join(
        f"{m},{k * n**2},{1 / n},{1e-2 / n}" for m, k in (("quad", 1), ("tri", 2)) for n in (8, 16, 32, 64)
    )
    assert len(points(f"method,ncells,h,error\n{rows}", tmp_path)) == 8
