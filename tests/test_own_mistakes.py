"""Mistakes in a user's file: one line with file and line, exit code 2; nothing crashes, all that is stored stays."""

import json
import os
import re
from importlib import import_module
from pathlib import Path

import pytest
from fixtures_command import Call, caller, one_line
from test_own_case import CASE

from mpm_verify.solver.forked import ForkError, forked
from mpm_verify.solver.own_file import OwnFileError
from mpm_verify.solver.plugins import (
    LAYOUTS,
    MATERIALS,
    METHODS,
    RATES,
    SMOOTHINGS,
    TRANSFERS,
    available,
    create,
    load,
    path,
)

DOCUMENT = (Path(__file__).parent.parent / "docs" / "own-plugin.md").read_text()
FILES = {name: text for text, name in re.findall(r"```python\n(# (\w+\.py)\n.*?)```", DOCUMENT, re.S)}
TENT, VENANT, PIC = FILES["tent.py"], FILES["saint_venant.py"], FILES["own_pic.py"]


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def refused(folder: Path, package: str, text: str) -> str:
    """What is said of a plug-in, after the name of its file."""
    (folder / "own.py").write_text(text)
    with pytest.raises(OwnFileError, match=r"^\S*own\.py") as told:
        create(package, str(folder / "own.py"))
    assert "\n" not in str(told.value)
    return str(told.value).removeprefix(str(folder / "own.py"))


def line(text: str, of: str) -> str:
    """Number of the line that has a text, as it is told."""
    return f", line {text[: text.index(of)].count(chr(10)) + 1}: "


# ---- a basis


@pytest.mark.parametrize("package", [METHODS, MATERIALS, TRANSFERS, SMOOTHINGS, LAYOUTS])
def test_what_ships_passes(package: str) -> None:
    for name in available(package):
        import_module(f"{package}._own").check(create(package, name), path(package, name))


@pytest.mark.parametrize("support", ["3", "5", "9"])
def test_a_support_that_is_not_that_of_the_fill(tmp_path: Path, support: str) -> None:
    said = refused(tmp_path, METHODS, TENT.replace("ClassVar[int] = 4", f"ClassVar[int] = {support}"))
    assert said.startswith(f": support = {support}, and fill writes 4 support nodes of a particle; write support = 4")


@pytest.mark.parametrize("support", ["0", "-4", "4.0", "'four'", "True", "10**9", "None"])
def test_a_support_that_none_can_have(tmp_path: Path, support: str) -> None:
    said = refused(tmp_path, METHODS, TENT.replace("ClassVar[int] = 4", f"ClassVar[int] = {support}"))
    assert "must be a whole number from 1 to 256" in said


END = "    return bad == 0"
NUMBER = "(np.int64(i) + a) * ny + np.int64(j) + c\n"
FILLS = {
    "far nodes": (NUMBER, "10**9\n", "fill writes 1000000000 to node, and the grid that"),
    "nodes below zero": (NUMBER, "-5\n", "fill writes -5 to node"),
    "beyond the table": (END, "    table[3 * 4 * 32] = 1\n" + END, "fill writes beyond table, which has 12 rows"),
    "below the table": (END, "    table[-1] = 1\n" + END, "fill writes beyond table"),
    "anywhere": (END, "    node[10**10] = 1\n" + END, "it ended by SIG"),
    "reads anywhere": (END, "    return x[10**10] == 0", "it ended by SIG"),
    "rows left out": ("product(2 * a + c,", "product(2 * a,", "fill leaves out rows of node"),
    "sum": ("1.0 - abs(py", "1.1 - abs(py", "N that fill writes sums to 1.2 over the support nodes"),
    "gradients": ("(2 * a - 1) * inv_dx", "a * inv_dx", "dN/dx that fill writes sums to 4"),
    "always inside": (END, "    return True", "fill returns True where support nodes lie outside the box"),
    "never inside": (END, "    return False", "fill returns False for particles in the middle of the grid"),
    "not a number": (
        "outside(x0, x1, y0, y1, px, px, py, py)",
        "int(px < x0) + int(px >= x1) + int(py < y0) + int(py >= y1)",
        "or where x is not a number",
    ),
    "raises": (END, "    if x.shape[0] > 2:\n        raise ValueError('no')\n" + END, "ValueError: no"),
    "no kernel": ("@kernel(FILL)\n", "", "fill must be a kernel of the signature FILL: write @kernel(FILL)"),
    "no basis": ("Tent(Basis)", "Tent", "write class Tent(Basis), with Basis from mpm_verify.solver.weights"),
    "order": ("float] = 2.0", "float] = 'two'", "order = 'two' must be a number"),
    "no order": ("    order: ClassVar[float] = 2.0\n", "", "the class Tent has no order; a method has"),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", FILLS)
def test_a_fill_that_is_wrong(tmp_path: Path, name: str) -> None:
    """Some of them end a process; this one goes on."""
    old, new, said = FILLS[name]
    assert old in TENT
    assert said in refused(tmp_path, METHODS, TENT.replace(old, new))


def test_a_fork_that_dies_or_hangs() -> None:
    assert forked(lambda: {"a": 1}, 10) == {"a": 1}
    with pytest.raises(ForkError, match="SIGABRT"):
        forked(os.abort, 10)
    with pytest.raises(ForkError, match=r"not ended after 0\.2 s"):
        forked(lambda: [None for _ in iter(int, 1)], 0.2)
    with pytest.raises(ForkError, match=r"it ended$"):
        forked(lambda: 1 / 0, 10)


# ---- a material, a transfer, a rate

ENERGY = "        three = range(3)"
ENERGIES = {
    "return None": ": energy returns None; it must return the stored energy",
    "return 'x'": ": energy returns 'x'; it must return",
    "return 0": ": energy returns 0; it must return",
    "return F": ": energy returns [[F00, F01, 0]",
    "raise RuntimeError": "RuntimeError",
    "return np.log(F[0][0])": "take the log that it is given",
    "return float(F[0][0])": "F holds symbols",
    "return F[3][0]": "IndexError",
}


@pytest.mark.parametrize("body", ENERGIES)
def test_an_energy_that_is_wrong(tmp_path: Path, body: str) -> None:
    said = refused(tmp_path, MATERIALS, VENANT.replace(ENERGY, f"        {body}\n{ENERGY}"))
    assert ENERGIES[body] in said
    assert said.startswith(line(VENANT, ENERGY) if not ENERGIES[body].startswith(":") else ": ")


HEAD = VENANT.split("    def update")[0]
UPDATE = "    def update(self, particles, dt):\n        "


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (UPDATE + "raise KeyError('k')\n", line(HEAD + UPDATE + "!", "!") + "KeyError: 'k'"),
        (UPDATE + "import sys; sys.exit(0)\n", line(HEAD + UPDATE + "!", "!") + "SystemExit: 0"),
        (UPDATE + "particles.sigma = np.zeros((3, 3))\n", "update leaves particles.sigma as float64 (3, 3)"),
        (UPDATE + "particles.sigma = 0\n", "update leaves particles.sigma as 0"),
        (UPDATE + "particles.sigma = particles.sigma.astype('f')\n", "update leaves particles.sigma as float32 (5, 4)"),
        (
            "    def update(self, particles): pass\n",
            "update must take what is asked of it: update(self, p",
        ),
        ("", ": the class SaintVenant has no update; a material has start, update, wave_speed"),
        (UPDATE + "pass\n    def wave_speed(self, s=None): return 'x'\n", "wave_speed gives 'x'"),
    ],
)
def test_an_update_that_is_wrong(tmp_path: Path, text: str, said: str) -> None:
    assert said in refused(tmp_path, MATERIALS, HEAD + text)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("    def take(self): pass\n", "take must take what is asked of it: take(self, context)"),
        ("    def start(self, context): pass\n", "start(self, context, L=None)"),
        ("    take = 3\n", "take = 3 must be a method, take(self, context)"),
        ("    flip_fraction = 'x'\n", "flip_fraction = 'x' must be a number from 0 to 1"),
        ("    flip_fraction = property(lambda self: 1 / 0)\n", "ZeroDivisionError"),
    ],
)
def test_a_transfer_that_is_wrong(tmp_path: Path, text: str, said: str) -> None:
    assert said in refused(tmp_path, TRANSFERS, f"{PIC}\n{text}")


def test_a_rate_without_kernels(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text(path(RATES, "jaumann").read_text().replace("@kernel(ROTATE)\n", ""))
    with pytest.raises(OwnFileError, match=r"own.py, line \d+: rotate must be a kernel of the signature ROTATE"):
        load(RATES, str(tmp_path / "own.py"))


def test_a_text_with_a_zero_byte(tmp_path: Path) -> None:
    assert refused(tmp_path, METHODS, "x = 1\ny = '\0'\n").startswith(", line 2: a byte that is zero")


# ---- in a run

LATE = "if len(particles) > 10: "
RAISES = "    if ny > 18 and x[0] > 0.5:\n        raise ValueError('no')\n"  # not on the grid that it is tried on
MMS = ("mms", "--cells", "8", "--ppc", "4", "--out", "study")


@pytest.mark.slow
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_update_that_raises_in_a_run(verify: Call, jobs: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file and its line, from a worker process too."""
    monkeypatch.setattr("mpm_verify.verify.run.SMALL", 0.0)
    text = HEAD + UPDATE + LATE + "raise KeyError('k')\n"
    Path("own.py").write_text(text)
    said = one_line(verify("mms", "--cells", "8,12", *MMS[3:], "--material", "./own.py", "--jobs", jobs))
    assert f"own.py{line(text, LATE)}KeyError: 'k'; this was the run cpdi " in said


@pytest.mark.parametrize(
    ("option", "text", "said"),
    [
        ("material", HEAD + UPDATE + LATE + "particles.sigma = np.zeros((3, 3))\n", "with the shape (3, 3)"),
        ("transfer", f"{PIC}\n    def take(self, context):\n        1 / 0\n", "line 14: ZeroDivisionError"),
        ("method", TENT.replace(END, RAISES + END), "ValueError: no"),
        ("layout", path(LAYOUTS, "uniform").read_text().replace("return layout", "return 3"), "cannot be worked with"),
    ],
)  # fmt: skip
def test_what_shows_in_a_run_alone(verify: Call, option: str, text: str, said: str) -> None:
    Path("own.py").write_text(text)
    cells = ("mms", "--cells", "16", *MMS[3:])
    assert f"{Path.cwd()}/own.py" in (told := one_line(verify(*cells, f"--{option}", "./own.py")))
    assert said in told


def test_a_material_that_raises_in_an_element_test(verify: Call) -> None:
    Path("own.py").write_text(
        HEAD + "    seen = []\n" + UPDATE + "self.seen.append(1)\n        1 / (len(self.seen) < 9)\n"
    )
    assert "own.py, line 25: ZeroDivisionError" in one_line(verify("material", "./own.py", "--test", "isotropic"))


def test_what_a_file_prints_is_no_part_of_the_document(verify: Call) -> None:
    text = VENANT.replace(ENERGY, f"        print('energy')\n{ENERGY}").replace(
        UPDATE, f"{UPDATE}print('run')\n        "
    )
    Path("own.py").write_text(f"print('read')\n{text}")
    _, out, err = verify(*MMS, "--material", "./own.py", "--json")
    assert json.loads(out)["case"] == "mms"
    assert {"read", "energy"} <= set(err.split())


def test_the_title_has_the_files_name(verify: Call) -> None:
    Path("tent.py").write_text(TENT)
    _, out, _ = verify(*MMS, "--method", "./tent.py", "--json")
    assert json.loads(out)["title"] == "tent against the manufactured solution axis_aligned"


# ---- a case

EXPECTED = 'return Expectation(2.0, source="the remainder of the midpoint rule")'
GIVEN = 'return Result(run=run, digest=run.digest, status="finished", errors={"integral": {"relative": error}}), {}'
BEFORE = {  # nothing is made
    "expectation": (EXPECTED, "return 2", "expectation must return an Expectation or None, not 2"),
    "order": (EXPECTED, "return Expectation(order='x')", "with order = 'x' must be a number"),
    "band": (EXPECTED, "return Expectation(2.0, below=-1)", "line 36: ValueError: below = -1"),
    "AXES": ('{"cells"', '{"celsl"', "AXES has 'celsl', which is no field of Run (did you mean cells?)"),
    "values of AXES": ("(8, 16, 32, 64)", "8", "AXES has 'cells': 8; write values, such as (8, 16)"),
    "kinds of values": ("(8, 16,", "('a', 16,", "cells = 'a' must be a whole number"),
    "JUDGED": ('"relative"),)', '"max"),)', "JUDGED has ('integral', 'max'), and NORMS has relative"),
    "QUANTITIES": ('("integral",), (', '"integral", (', "QUANTITIES = integral must be words with a comma"),
    "title": ('return "Midpoint rule"', "pass", "title must return a text, not None"),
    "canonical": ("def title", "def canonical(v):\n    return {'a': 1}\n\n\ndef title", "canonical returns 'a', and"),
    "dataclass": ("@dataclass(frozen=True)\nclass Run", "class Run", "write @dataclass(frozen=True) before"),
}  # fmt: skip
IN_A_RUN = {
    "quantity": ('errors={"integral"', 'errors={"w"', "without errors['integral']['relative']; it has {'w':"),
    "another run": ("run=run, digest", "run=Run(), digest", "execute returns the Result of another run"),
    "status": ('"finished"', '"ok"', "Result cannot be stored: status = 'ok' must be 'finished' or 'failed'"),
    "failed": ('"finished"', '"failed"', "has no failure"),
    "no arrays": (GIVEN, GIVEN[:-4], "execute must return (Result, arrays), not Result("),
    "nothing": (GIVEN, "pass", "execute must return (Result, arrays), not None"),
    "objects": (GIVEN, GIVEN[:-2] + "{'a': object()}", "Object arrays cannot be saved"),
    "values": ("status=", "values={'a': 'b'}, status=", "Result cannot be stored: values.a = 'b'"),
    "examine": ("def title", "def examine(a, b, c):\n    return 3\n\n\ndef title", "examine must return an Analysis"),
}  # fmt: skip


@pytest.mark.parametrize("name", BEFORE | IN_A_RUN)
def test_a_case_that_is_wrong(verify: Call, name: str) -> None:
    """Once the file is right, the same folder goes on."""
    old, new, said = (BEFORE | IN_A_RUN)[name]
    assert old in CASE
    Path("own.py").write_text(CASE.replace(old, new))
    told = one_line(verify("./own.py", "--out", "study"))
    assert said in told
    assert "own.py" in told or name == "kinds of values"
    assert Path("study").exists() == (name in IN_A_RUN)
    Path("own.py").write_text(CASE)
    assert verify("./own.py", "--out", "study", "--json")[0] == 0


def test_a_case_that_has_moved(verify: Call) -> None:
    Path("own.py").write_text(CASE)
    verify("./own.py", "--out", "study", "--json")
    Path("own.py").rename("other.py")
    assert "put the file back there, or run it where it is now" in one_line(verify("report", "study"))


# ---- particles that cannot be read


@pytest.mark.slow
@pytest.mark.parametrize("change", ["delete", "truncate", "alter"])
def test_particles_that_cannot_be_read(verify: Call, change: str) -> None:
    verify("mms", "--cells", "16", *MMS[3:])
    for file in Path("study/runs").glob("*.npz"):
        data = file.read_bytes()
        changed = data[:-30] if change == "truncate" else data[:500] + bytes(len(data) - 700) + data[-200:]
        file.unlink() if change == "delete" else file.write_bytes(changed)
    code, out, err = verify("report", "study", "--field", "16,4")
    page = Path("study/report.html").read_text()
    assert (code, out) == (0, "report: study/report.html\n")
    assert err.startswith("verify: cannot read study/runs/")
    assert err.endswith("delete it and its .json file to run that run again\n")
    assert err.count("\n") == 1
    assert "cannot be read, and their figures are left out" in page
    assert "finished with its particles stored" not in page
