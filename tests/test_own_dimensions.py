"""Solutions of one's own on a line, around an axis and in a box: fields, edges, exported cases, and what is refused."""

import json
import re
import sys
from collections.abc import Callable
from math import log
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fixtures_command import Call, caller, one_line
from fixtures_residual import LAW, piola, residual, without_hoop

from mpm_verify.cases.harness.identity import identity
from mpm_verify.mms.check import check
from mpm_verify.mms.export.checking import Outcome
from mpm_verify.mms.export.checking import check as check_sources
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.reports.export.case_folder import read, table_of, write
from mpm_verify.solver.plugins import SOLUTIONS, create
from mpm_verify.verify.commands.export import made

FILE = """import sympy as sp
def displacement(X, t, A={A}):
    {names} = X
    s, c = sp.sin(100 * sp.pi * t), 1 - sp.cos(100 * sp.pi * t)
    return sp.Matrix([{u}])
def domain():
    return {{"lower": {lower}, "upper": {upper}, "duration": 0.02, "speed": {speed}{more}}}
"""
slow = pytest.mark.slow
AXIS = ', "axisymmetric": True'
ROD = {"names": "x,", "lower": "0", "upper": "2", "u": "A*sp.sin(sp.pi*x)*c"}
PULLED = ROD | {"u": "A*sp.sin(sp.pi*x/3)*c", "lower": "(0,)", "upper": "(2,)"}
CAN = {
    "names": "r, z", "lower": "(0, 0)", "upper": "(1, 2)", "more": AXIS,
    "u": "A*sp.sin(sp.pi*r)*sp.cos(sp.pi*z)*c, A*sp.cos(sp.pi*r)*sp.sin(sp.pi*z)*s",
}  # fmt: skip
TUBE = CAN | {"lower": "(1, 0)", "upper": "(2, 1)", "u": "A*r*sp.cos(sp.pi*z)*c, A*sp.sin(sp.pi*z)*r*s"}
BOX = {
    "names": "x, y, z", "lower": "(0, 0, 0)", "upper": "(1, 1, 0.5)",
    "u": "A*sp.sin(sp.pi*x)*sp.sin(sp.pi*y)*sp.sin(2*sp.pi*z)*c, A*x*y*z*(1-x)*(1-y)*(1-2*z)*s, 0",
}  # fmt: skip
BODIES: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {  # parts of a file, and the edges that are found
    "rod": (ROD, ("fixed", "fixed")),
    "rod that is pulled": (PULLED, ("fixed", "pulled")),
    "can": (CAN, ("roller",) * 4),
    "tube that breathes": (TUBE, ("pulled", "pulled", "roller", "roller")),
}
Write = Callable[..., str]


@pytest.fixture
def own(tmp_path: Path) -> Write:
    """Writes a file from its parts and returns its path."""

    def text(parts: dict[str, str], **more: str) -> str:
        path = tmp_path / "own.py"
        path.write_text(FILE.format(**{"A": "0.02", "speed": "110", "more": "", **parts, **more}))
        return str(path)

    return text


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def derived(path: str) -> tuple[Any, Manufactured]:
    """Solution of a file that passed its check, and its fields."""
    solution: Any = create(SOLUTIONS, path)
    check(solution, LAW)
    return solution, manufacture(solution, LAW, LAW.rho0)


@pytest.mark.parametrize("name", [one if "can" not in one else pytest.param(one, marks=slow) for one in BODIES])
def test_the_force_balances_momentum(own: Write, name: str) -> None:
    """Differences and complex steps of the displacement alone; a hoop stress that is dropped leaves a hundredth."""
    parts, kinds = BODIES[name]
    solution, exact = derived(own(parts))
    assert solution.sides == kinds
    assert residual(solution, exact, piola) < 1e-7
    if solution.axisymmetric:
        assert residual(solution, exact, without_hoop) > 1e-2


@slow
def test_a_box_balances_momentum(own: Write) -> None:
    solution, exact = derived(own(BOX))
    assert solution.sides == ("fixed",) * 6
    assert residual(solution, exact, piola) < 1e-7


SHIPPED = {  # a file that says what one of the library does
    "bar1d": {"names": "x,", "lower": "[0]", "upper": "[1]", "u": "A*sp.sin(sp.pi*x)*s", "A": "0.1"},
    "cylinder_rz": {
        "names": "r, z", "lower": "(0, 0)", "upper": "(1, 1)", "more": AXIS, "A": "0.1",
        "u": "A*r*(1-r**2)*sp.cos(sp.pi*z)*s, 0.4*A*sp.cos(sp.pi*r)*sp.sin(sp.pi*z)*c",
    },
}  # fmt: skip


@pytest.mark.parametrize("name", ["bar1d", pytest.param("cylinder_rz", marks=slow)])
def test_fields_are_those_of_the_library(own: Write, name: str) -> None:
    theirs = create(SOLUTIONS, name)
    mine, exact = derived(own(SHIPPED[name]))
    known, layout = manufacture(theirs, LAW, LAW.rho0), mine.layout(1 / 6, 4)
    np.testing.assert_array_equal(layout.V0, theirs.layout(1 / 6, 4).V0)
    for field in ("u", "v", "F", "P", "sigma", "b"):
        found, wanted = getattr(exact, field)(layout.X, 0.0047), getattr(known, field)(layout.X, 0.0047)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-13 * np.abs(wanted).max())


def test_volumes_are_per_radian(own: Write) -> None:
    layout = create(SOLUTIONS, own(TUBE)).layout(0.25, 4)
    assert 2 * np.pi * layout.V0.sum() == pytest.approx(np.pi * (2**2 - 1**2), rel=1e-13)


def test_an_axis_is_another_solution(own: Write) -> None:
    around = identity(SOLUTIONS, own(TUBE))
    assert identity(SOLUTIONS, own(TUBE, more="")) != around == identity(SOLUTIONS, own(TUBE))


@pytest.mark.parametrize("name", ["rod that is pulled", pytest.param("can", marks=slow)])
def test_a_case_for_other_solvers(own: Write, name: str, tmp_path: Path) -> None:
    """What it is stands in the record, and its sources have the right values; one that is altered has not."""
    parts, kinds = BODIES[name]
    case = made(own(parts), None, 4, None, 0.4, 16)
    d = len(kinds) // 2
    assert (case.record.dimension, case.record.axisymmetric) == (d, d == 2)
    assert tuple(case.record.edges.values()) == kinds
    folder = tmp_path / "case"
    write(folder, case)
    table = table_of(folder, read(folder))
    assert check_sources(folder, "python", d, table).outcome is Outcome.AGREES
    source = folder / "body_force.py"
    source.write_text(source.read_text().replace("np.sin(", "1.0000000001*np.sin(", 1))
    assert check_sources(folder, "python", d, table).outcome is Outcome.DISAGREES


@pytest.mark.parametrize("name", ["rod", pytest.param("can", marks=slow)])
def test_an_audit_knows_what_is_not_there(own: Write, verify: Call, name: str) -> None:
    code, out, _ = verify("audit", own(BODIES[name][0]))
    assert code == 0
    assert ("One dimension: shear" in " ".join(out.split())) == (name == "rod")
    assert ("The hoop stress over the radius reaches" in " ".join(out.split())) == (name == "can")


CLASS = """from mpm_verify.mms.square import {base}
import sympy as sp
class Own({base}):
    boundary = "{kind}"
    def displacement(self, X, t):
        return sp.Matrix({u})
"""
CLASSES = {
    "Line": ("fixed", "[sp.sin(sp.pi*X[0])/20*(1-sp.cos(100*sp.pi*t))]"),
    "Revolved": ("roller", "[X[0]*(1-X[0]**2)/20*(1-sp.cos(100*sp.pi*t)), 0]"),
}


@pytest.mark.parametrize("base", ["Line", pytest.param("Revolved", marks=slow)])
def test_a_class_of_ones_own(base: str, tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    kind, u = CLASSES[base]
    path.write_text(CLASS.format(base=base, kind=kind, u=u))
    solution, exact = derived(str(path))
    assert residual(solution, exact, piola) < 1e-7
    path.write_text(CLASS.format(base=base, kind="free", u=u))
    with pytest.raises(ValueError, match="cannot be free"):
        derived(str(path))


REFUSED: dict[str, tuple[dict[str, str], str]] = {
    "numbers of corners": (ROD | {"upper": "(2, 1)"}, r"write as many numbers for both$"),
    "a displacement of two": (ROD | {"u": "x*c, 0"}, r"must return sp.Matrix\(\[u_x\]\), not"),
    "a displacement of one": (CAN | {"u": "r*c"}, r"must return sp.Matrix\(\[u_x, u_y\]\), not"),
    "a displacement in a box": (BOX | {"u": "x*c"}, r"must return sp.Matrix\(\[u_x, u_y, u_z\]\), not"),
    "a roller": (ROD | {"more": ', "boundary": "roller"'}, r"write one of fixed, free, pulled, prescribed, or two"),
    "four ends": (ROD | {"more": ', "boundary": ("fixed",) * 4'}, r"or two of them for left, right$"),
    "an end that is none": (ROD | {"more": ', "boundary": "free"'}, r"left edge cannot be free.* at X = 0, t = "),
    "a kink in a line": (ROD | {"u": "A*x*abs(x - 1)*c"}, r"displacement has Abs\(X - 1\)"),
    "inside out on a line": (ROD | {"A": "1"}, r"det F = -\d\S* at X = 1(\.\d+)?, t = "),
    "an axis of one coordinate": (ROD | {"more": AXIS}, r"has a radius and an axis: lower and upper are two numbers"),
    "a radius below zero": (CAN | {"lower": "(-1, 0)", "upper": "(0, 2)"}, r"a radius of 0 or more$"),
    "an axis that is none": (CAN | {"more": ', "axisymmetric": "yes"'}, r"axisymmetric = yes; write True or False$"),
    "a hole in the axis": (CAN | {"u": "A*sp.cos(r)*c, 0"}, r"left edge is the axis, where .*its normal displacement"),
    "a cone": (CAN | {"u": "0, A*r*(1-z/2)*z*c"}, r"left edge is the axis, where .*its tangential traction is"),
    "a load on the axis": (
        CAN | {"more": AXIS + ', "boundary": ("pulled", "roller", "roller", "roller")'}, r"cannot be pulled: name it"
    ),
    "inside out around": (CAN | {"A": "0.3"}, r"det F = -\d\S* at \(X, Y\) = "),
    "faces of a box": (BOX | {"more": ', "boundary": ("fixed",) * 4'}, r"six of them for left, .*, back, front$"),
    "sides of a box": (BOX | {"upper": "(1, 1, 0.7071)"}, r"no square cells fill a box of 1 x 1 x 0.7071"),
}  # fmt: skip


@pytest.mark.parametrize("name", [pytest.param(one, marks=slow) if "around" in one else one for one in REFUSED])
def test_what_is_wrong_is_one_line(own: Write, name: str) -> None:
    parts, said = REFUSED[name]
    with pytest.raises(ValueError, match=said) as raised:
        derived(own(parts))
    assert re.match(r"\S*own\.py", str(raised.value))


def test_a_grid_that_reaches_beyond_the_axis_is_refused(own: Write) -> None:
    thin: Any = create(SOLUTIONS, own(TUBE | {"lower": "(0.1, 0)", "upper": "(1.1, 1)"}))
    with pytest.raises(ValueError, match=r"with 8 cells the grid .* begins at a radius of -0.025; take more cells"):
        check(thin, LAW, (8, 16))
    check(thin, LAW, (16,))


@pytest.mark.parametrize(
    ("name", "says"),
    [("rod", "has one dimension and is for a solver of your own, the reference solver has two: verify mms --solver "),
     ("can", "is axisymmetric and is for a solver of your own, the reference solver is in plane strain: verify mms ")],
)  # fmt: skip
def test_the_reference_solver_has_two_dimensions(own: Write, verify: Call, name: str, says: str) -> None:
    path = own(BODIES[name][0])
    said = one_line(verify("mms", "--quick", "--solution", path))
    assert says in said
    assert said.strip().endswith(f"--solution {path}")


TOYS: dict[
    str, tuple[dict[str, str] | None, tuple[int, ...], tuple[str, ...]]
] = {  # errors of u on the levels, in rms over 16 frames
    "python1d": (ROD, (16, 32, 64), ("2.886e-08", "7.126e-09", "1.774e-09")),
    "python-rz": (None, (8, 12, 16), ("7.447e-08", "3.373e-08", "1.924e-08")),
}
HOOP = "    inner[:, :, 0] += N * (V * around / x[:, 0])[:, None]  # the hoop stress pulls inwards\n"


@slow
@pytest.mark.parametrize("toy", TOYS)
def test_a_program_is_judged_on_it(own: Write, verify: Call, toy: str) -> None:
    """Order 2; without its hoop stress a program keeps an error that no cells make smaller."""
    parts, cells, known = TOYS[toy]
    verify("example", toy, "toy")
    file = Path("toy/solver.py")
    for fault in ("", HOOP) if toy == "python-rz" else ("",):
        file.write_text(file.read_text().replace(fault, "") if fault else file.read_text())
        solution = own(parts, A="1e-6", speed="100") if parts else str(Path(__file__).parent / "own_can.py")
        errors = judged(verify, solution, cells, "faulty" if fault else "sound")
        order = log(errors[-2] / errors[-1]) / log(cells[-1] / cells[-2])
        if fault:
            assert order < 0.2
        else:
            assert tuple(f"{error:.3e}" for error in errors) == known
            assert 1.9 < order < 2.1


def judged(verify: Call, solution: str, cells: tuple[int, ...], out: str) -> list[float]:
    """Errors of u of the toy."""
    typed = f"{sys.executable} toy/solver.py {{case}} {{out}}"
    words = ["--solution", solution, "--cells", ",".join(map(str, cells)), "--order", "2", "--courant", "0.4"]
    _, said, _ = verify("mms", "--solver", typed, *words, "--quick", "--json", "--out", out)
    runs = [run for run in json.loads(said)["runs"] if run["courant"] == 0.4]
    return [run["errors"]["u"]["rms"] for run in sorted(runs, key=lambda run: run["cells"])]
