"""What is exported of a solution: sources in other languages, the values they are checked with, the tolerances."""

import re
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path
from time import sleep
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy as sp
from fixtures_export import PLANE, SOLID, exported, folder_of

from mpm_verify.mms.components import AXES, COMPONENTS
from mpm_verify.mms.export import checking
from mpm_verify.mms.export.bounds import UNIT, Bounded, evaluate
from mpm_verify.mms.export.checking import TOOLCHAINS, Checked, Outcome, check, exit_code
from mpm_verify.mms.export.languages import LANGUAGES
from mpm_verify.mms.export.notation import Notation
from mpm_verify.mms.export.process import run
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.mms.straight_line import factors
from mpm_verify.reports.export.case_folder import read, table_of
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.state import Floats

EXTRA = ["bump:A=0.1", "generalised_vortex:A=-1.5,inner=0.5", "swirl:A=-1.2,B=-0.25,L=0.7,C=50", "bar:A=0.2,axis=1"]
EVERY = [*PLANE, *EXTRA, *(pytest.param(name, marks=pytest.mark.slow) for name in SOLID)]
FEW = ["bump", "generalised_vortex", "swirl"]
COMPILED = [name for name in TOOLCHAINS if name not in ("c", "python")]
NEVER_SKIPPED = ("c", "python")


@cache
def known(solution: str) -> tuple[Any, Any, Manufactured]:
    """Solution, material and fields."""
    plugin = create(SOLUTIONS, solution)
    material = create(MATERIALS, plugin.material)
    return plugin, material, manufacture(plugin, material, material.rho0)


def rows(solution: str) -> tuple[Floats, Floats]:
    """Reference positions (R,d) and times (R,) of the values."""
    force = exported(solution).force
    return np.column_stack([force[axis] for axis in "XYZ" if axis in force]), force["t"]


def outcome(folder: Path, language: str) -> Checked:
    """Check of one language; skipped where there is no compiler, but for the two that are everywhere."""
    if TOOLCHAINS[language].program() is None and language not in NEVER_SKIPPED:
        pytest.skip(f"there is no {TOOLCHAINS[language].programs[0]} on this machine")
    record = read(folder)
    return check(folder, language, record.dimension, table_of(folder, record))


# ---- values and tolerances


@pytest.mark.slow
@pytest.mark.parametrize("solution", EVERY)
def test_values_are_those_of_the_library(solution: str) -> None:
    """By the NumPy functions, within four times the tolerance of each: SymPy prints their constants in 15 digits."""
    X, times = rows(solution)
    case, exact, axes = exported(solution), known(solution)[2], AXES[: X.shape[1]]
    for name, ends, values, f in (
        ("b", axes, case.force, exact.b),
        ("u", axes, case.fields, exact.u),
        ("v", axes, case.fields, exact.v),
        ("F", [a + b for a in axes for b in axes], case.fields, exact.F),
        ("s", COMPONENTS[len(axes)], case.fields, exact.sigma),
    ):
        found = np.stack([f(X[k : k + 1], t).ravel() for k, t in enumerate(times)])
        for k, end in enumerate(ends):
            error = np.abs(found[:, k] - values[f"{name}{end}"])
            assert (error <= 4 * values[f"tolerance_{name}{end}"]).all(), (name, end)
    x = np.stack([exact.x(X[k : k + 1], t)[0] for k, t in enumerate(times)])
    np.testing.assert_allclose(np.column_stack([case.force[axis] for axis in axes]), x, rtol=0, atol=5e-14)


def precise_force(solution: Any, material: Any, X: list[float], t: float) -> list[float]:
    """b = u'' - Div P / rho0 by differences at 60 digits of the displacement, with the textbook's stress."""
    d = len(X)
    symbols, time = sp.symbols("X Y Z", real=True)[:d], sp.Symbol("t", real=True)
    u = sp.lambdify((*symbols, time), [sp.nsimplify(e, rational=True) for e in
                                       solution.displacement(symbols, time)], "mpmath")  # fmt: skip
    lam, mu, h = (mpmath.mpf(value) for value in (material.lam, material.mu, "1e-15"))

    def difference(f: Any, at: list[Any], k: int) -> list[Any]:
        after, before = ([value + way * h * (i == k) for i, value in enumerate(at)] for way in (1, -1))
        return [(a - b) / (2 * h) for a, b in zip(f(*after), f(*before), strict=True)]

    def stress(*at: Any) -> list[Any]:
        F = mpmath.eye(d)
        for k in range(d):
            for i, slope in enumerate(difference(u, list(at), k)):
                F[i, k] += slope
        T = (F**-1).T
        P = mu * (F - T) + lam * mpmath.log(mpmath.det(F)) * T
        return [P[i, k] for i in range(d) for k in range(d)]

    at = [mpmath.mpf(value) for value in (*X, t)]
    rate = difference(lambda *at: difference(u, list(at), d), at, d)
    slopes = [difference(stress, at, k) for k in range(d)]
    return [float(rate[i] - sum(slopes[k][d * i + k] for k in range(d)) / material.rho0) for i in range(d)]


@pytest.mark.parametrize("solution", [*FEW, *(pytest.param(name, marks=pytest.mark.slow) for name in SOLID)])
def test_values_are_right(solution: str) -> None:
    """To the last digits, by a way of its own; differences of 1e-15 at 60 digits are exact to 1e-28."""
    plugin, material, _ = known(solution)
    (X, times), force = rows(solution), exported(solution).force
    axes = AXES[: X.shape[1]]
    with mpmath.workdps(60):
        for row in (0, 7, 23):
            b = precise_force(plugin, material, X[row].tolist(), float(times[row]))
            np.testing.assert_allclose(b, [force[f"b{axis}"][row] for axis in axes], rtol=3e-14, atol=1e-24)


@pytest.mark.slow
@pytest.mark.parametrize("solution", EVERY)
def test_tolerances_are_narrow(solution: str) -> None:
    """A tenth of a millionth of the largest force or stress at the very most, and not the same in all rows."""
    case = exported(solution)
    for values in (case.force, case.fields):
        for name in (name for name in values if f"tolerance_{name}" in values):
            largest = max(np.abs(values[other]).max() for other in values if other[0] == name[0])
            assert values[f"tolerance_{name}"].max() <= 1e-8 * largest, name
    widths = np.hypot(case.force["tolerance_bx"], case.force["tolerance_by"])
    assert widths.min() > 0
    assert widths.max() > 2 * widths.min()


def test_tolerances_follow_the_conditioning() -> None:
    """The vortex, whose terms cancel, has wider ones than clamped_shear, as a fraction of the force."""
    wide, narrow = (
        np.median(force["tolerance_bx"]) / np.abs(force["bx"]).max()
        for force in (exported("generalised_vortex").force, exported("clamped_shear").force)
    )
    assert narrow < 1e-13 < wide < 1e-10


@pytest.mark.parametrize("solution", ["clamped_shear", "generalised_vortex"])
def test_perturbed_operations_stay_within_the_tolerance(solution: str) -> None:
    """Every statement of the exported code moved by a rounding of random sign, many times, from the infix text."""
    X, times = rows(solution)
    force, rng = exported(solution).force, np.random.default_rng(3)
    text = exported(solution).sources["body_force_infix.txt"].splitlines()
    names = {name: getattr(np, name) for name in ("sin", "cos", "log", "sqrt")}
    worst = np.zeros(2)
    for _ in range(20):
        values: dict[str, Any] = {**names, "X": X[:, 0], "Y": X[:, 1], "t": times}
        for line in text:
            name, _, expression = line.partition(" = ")
            value = eval(expression.replace("^", "**"), values)
            values[name] = value * (1 + UNIT * rng.choice([-1.0, 1.0], np.shape(value)))
        error = [np.abs(values[name] - force[name]) / force[f"tolerance_{name}"] for name in ("bx", "by")]
        worst = np.maximum(worst, np.max(error, axis=1))
    assert (worst < 1).all()
    assert (worst > 1e-3).all()


def test_bounds() -> None:
    x = Bounded(2.0, 1.0)
    assert (x + 1).error == 1 + 3
    assert (1 - x).error == 1 + 1
    assert (3 * x).error == 3 + 6
    assert (1 / x).error == pytest.approx(0.25 + 0.5)
    assert (0.1 * Bounded(1.0, 0.0)).error == pytest.approx(0.3)  # a constant is rounded twice, the product once
    (log,) = evaluate([("a", "X*X")], ["log(a)"], {"X": 3.0})
    assert (log.value, log.error) == (pytest.approx(np.log(9)), pytest.approx((2 * 9 + 9) / 9 + 4 * np.log(9)))
    with pytest.raises(NameError):
        evaluate([], ["open(X)"], {"X": 1.0})


# ---- languages


@pytest.mark.parametrize("language", NEVER_SKIPPED)
@pytest.mark.parametrize("solution", EVERY)
def test_sources_agree(solution: str, language: str, tmp_path: Path) -> None:
    found = outcome(folder_of(solution, tmp_path), language)
    assert found.outcome is Outcome.AGREES, found
    assert (found.rows, found.failed) == (40, 0)
    assert 0 < found.worst < 1


@pytest.mark.parametrize("language", COMPILED)
@pytest.mark.parametrize("solution", FEW)
def test_sources_agree_in_other_languages(solution: str, language: str, tmp_path: Path) -> None:
    found = outcome(folder_of(solution, tmp_path), language)
    assert found.outcome is Outcome.AGREES, found


@pytest.mark.slow
@pytest.mark.parametrize("language", COMPILED)
@pytest.mark.parametrize("solution", [solution for solution in (*PLANE, *EXTRA, *SOLID) if solution not in FEW])
def test_every_source_agrees_in_other_languages(solution: str, language: str, tmp_path: Path) -> None:
    test_sources_agree_in_other_languages(solution, language, tmp_path)


CHANGES = {
    "a sign": (r"Fyx = ", "Fyx = -1.0*"),
    "another sign": (r"aX = ", "aX = -1.0*"),
    "a constant": (r"\(3846\.153846153846 ", "(3846.15384615 "),
    "the density": (r"aY = ", "aY = 1.00000000001*"),
    "transposed components": (r"dFxy_dX = ", "dFxy_dX = dFyx_dX_swapped + 0.0*"),
    "X for Y": (r"(v\d+ = 3\.141592653589793\*)Y", r"\1X"),
    "components exchanged": ("", ""),
    "degrees": (r"sin\(v0\)", "sin(v0*57.29577951308232)"),
}


def changed(text: str, name: str, language: str) -> str:
    """Source with one defect in it, in the function of the force."""
    start = text.index("body_force(")
    end = text.index("displacement", start)
    code = text[start:end]
    if name == "components exchanged":
        results = {"c": ("values[0] =", "values[1] ="), "python": ("r0 =", "r1 =")}[language]
        code = code.replace(results[0], "?").replace(results[1], results[0]).replace("?", results[1])
    elif name == "transposed components":
        xy, yx = (re.search(rf"dF{c}_dX = (.*?);?\n", code) for c in ("xy", "yx"))
        assert xy
        assert yx
        code = code.replace(f"dFxy_dX = {xy[1]}", "dFxy_dX = ?").replace(f"dFyx_dX = {yx[1]}", f"dFyx_dX = {xy[1]}")
        moved = code.replace("dFxy_dX = ?", f"dFxy_dX = {yx[1]}")
        code = moved if moved != text[start:end] else code
    else:
        code = re.sub(CHANGES[name][0], CHANGES[name][1], code, count=1)
    assert code != text[start:end]
    return text[:start] + code + text[end:]


@pytest.mark.parametrize("name", CHANGES)
@pytest.mark.parametrize("language", NEVER_SKIPPED)
def test_an_altered_source_is_caught(name: str, language: str, tmp_path: Path) -> None:
    folder = folder_of("bump:A=0.05", tmp_path)
    file = folder / LANGUAGES[language].file
    file.write_text(changed(file.read_text(), name, language))
    found = outcome(folder, language)
    assert found.outcome is Outcome.DISAGREES, found
    assert found.failed > 0
    assert found.worst > 1
    assert found.column[:2] in ("bx", "by")


@pytest.mark.parametrize(
    ("old", "new", "column"),
    [("values[0] = ", "values[0] = 1e-13 + ", "u"), ("size > width / 40", "size > width / 1e9", "at x"),
     ("= goal0 ", "= 1e-9 + goal0 ", "at x")],
)  # fmt: skip
def test_an_altered_field_or_newton_step_is_caught(old: str, new: str, column: str, tmp_path: Path) -> None:
    folder = folder_of("swirl", tmp_path)
    file = folder / "body_force.h"
    text = file.read_text()
    start = text.index("mms_displacement") if column == "u" else text.index("mms_newton_step")
    assert old in text[start:]
    file.write_text(text[:start] + text[start:].replace(old, new, 1))
    found = outcome(folder, "c")
    assert found.outcome is Outcome.DISAGREES, found
    assert column in found.column


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("#error it was edited\n", Outcome.NOT_COMPILED),
        ("__attribute__((constructor)) static void ends(void) { __builtin_trap(); }\n", Outcome.NOT_RUN),
        ("#include <stdio.h>\n__attribute__((constructor)) static void says(void) { puts(\"hello\"); }\n",
         Outcome.NOT_READ),
    ],
)  # fmt: skip
def test_a_source_that_does_not_run(source: str, expected: Outcome, tmp_path: Path) -> None:
    folder = folder_of("bump", tmp_path)
    file = folder / "body_force.h"
    file.write_text(source + file.read_text())
    found = outcome(folder, "c")
    assert found.outcome is expected
    assert exit_code([found]) == 1


def test_a_source_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(checking, "RUNS", 0.5)
    folder = folder_of("bump", tmp_path)
    with (folder / "body_force.py").open("a") as file:
        file.write("\nwhile True:\n    pass\n")
    found = outcome(folder, "python")
    assert found.outcome is Outcome.NOT_RUN
    assert found.ended
    assert found.ended.code is None


def ended(process: int) -> bool:
    """Whether there is no such process, or nothing of it but its entry."""
    try:
        return Path(f"/proc/{process}/stat").read_text().split()[2] in "ZX"
    except OSError:
        return True


def wait_for(true: Callable[[], bool]) -> bool:
    """Whether something becomes true within some seconds."""
    for _ in range(100):
        if true():
            return True
        sleep(0.05)
    return False


def test_what_a_program_started_ends_with_it(tmp_path: Path) -> None:
    """The group is ended too, where the program leaves something behind, or its time is up."""
    for waits, code in (("", 0), ("; sleep 60", None)):
        words = ["sh", "-c", f"sleep 61 & echo $!{waits}"]
        assert run(words, tmp_path, 1.0).code == code
        child = (tmp_path / "out.txt").read_text().strip()
        assert wait_for(lambda child=child: ended(int(child)))


def test_no_compiler_is_no_failure(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    folder = folder_of("bump", tmp_path)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    record = read(folder)
    known = table_of(folder, record)
    c, python = (check(folder, name, record.dimension, known) for name in NEVER_SKIPPED)
    assert (c.outcome, python.outcome) == (Outcome.NO_COMPILER, Outcome.AGREES)
    assert [exit_code(found) for found in ([c], [python], [c, python], [])] == [3, 0, 0, 3]


def test_single_precision(tmp_path: Path) -> None:
    """The device functions with MMS_REAL float: errors of a tolerance that is wider by the ratio of the roundings."""
    folder = folder_of("bump:A=0.05", tmp_path)
    record = read(folder)
    known = table_of(folder, record)
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    checking.prepare(folder, scratch, "cuda", 2, known)
    compiler = shutil.which("c++") or shutil.which("g++")
    assert compiler
    command = [compiler, "-DMMS_REAL=float", "-std=c++11", "-o", "driver", "driver.cpp"]
    subprocess.run(command, cwd=scratch, check=True, timeout=60)
    given = (scratch / "rows.txt").read_text()
    done = subprocess.run(["./driver"], cwd=scratch, check=True, input=given, capture_output=True, text=True)
    found = np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])
    here = [k for k, name in enumerate(known.names) if "at x" not in name]
    ratio = np.abs(found - known.values)[:, here] / (2.0**29 * known.tolerance[:, here])
    assert ratio.max() < 1
    assert ratio.max() > 1e-3


# ---- notation

x, y = sp.symbols("x y")
WRITTEN = [
    (-x + y, "y - x", "y - x"),
    (-x, "-x", "0 - x"),
    (-x - y, "-x - y", "0 - x - y"),
    (y * (-x - 1), "y*(-1.0 - x)", "y*(0 - 1.0 - x)"),
    (sp.sin(-2 * x), "-sin(2.0*x)", "0 - sin(2.0*x)"),
    (x**3, "x*x*x", "x*x*x"),
    (y / x**2, "y/(x*x)", "y/(x*x)"),
    (1 / x, "1.0/x", "1.0/x"),
    (x / (2 * y), "0.5*x/y", "0.5*x/y"),
    (sp.sqrt(x) / y, "sqrt(x)/y", "sqrt(x)/y"),
    (x ** sp.Rational(-3, 2), "1.0/pow(x, 1.5)", "1.0/x^1.5"),
    ((x + y) ** 2, "pow((x + y), 2.0)", "(x + y)^2.0"),
    (sp.pi * x / 3, "0.3333333333333333*3.141592653589793*x", "0.3333333333333333*3.141592653589793*x"),
    (sp.Float(0.1) * x, "0.1*x", "0.1*x"),
    (x - sp.Float(1e-6), "x - 1e-06", "x - 1e-06"),
]


@pytest.mark.parametrize(("expression", "c", "infix"), WRITTEN)
def test_notation(expression: sp.Expr, c: str, infix: str) -> None:
    assert Notation()(expression).replace("x*0.5", "0.5*x") in (c, c.replace("0.1*x", "x*0.1"))
    text = LANGUAGES["infix"].notation(expression)
    assert text == infix
    value = eval(text.replace("^", "**"), {"x": 1.3, "y": 0.7, "sin": np.sin, "sqrt": np.sqrt})
    assert value == pytest.approx(float(expression.subs({x: 1.3, y: 0.7})), rel=1e-14)


@pytest.mark.parametrize("value", [0.1, 1 / 3, 5e-324, 1.7976931348623157e308, 2**53 + 2.0, np.pi, 1e16])
def test_literals_are_read_as_the_same_double(value: float) -> None:
    assert float(Notation().number(value)) == value
    assert LANGUAGES["fortran"].notation.number(value) == f"{value!r}_dp"


def test_a_function_that_no_language_has() -> None:
    with pytest.raises(ValueError, match="gamma cannot be written"):
        Notation()(sp.gamma(x))


def test_small_powers() -> None:
    assert [factors(sp.Integer(n)) for n in (-9, -8, -1, 0, 1, 8, 9)] == [0, -8, -1, 0, 1, 8, 0]
    assert factors(sp.S.Half) == 0


@pytest.mark.parametrize("solution", EVERY)
def test_infix_is_for_plain_parsers(solution: str) -> None:
    """Names, numbers, + - * / ^, brackets and calls: no sign in front, no **, each name once and before it is read."""
    text = exported(solution).sources["body_force_infix.txt"]
    assert "**" not in text
    assert not re.search(r"(^|[(,=*/^+-])\s*-", text, re.MULTILINE)
    names = {*"XYZ"[: exported(solution).record.dimension], "t", "sin", "cos", "tan", "exp", "log", "sqrt"}
    for line in text.splitlines():
        name, equals, expression = line.partition(" = ")
        assert equals
        assert name not in names
        assert set(re.findall(r"(?<![\d.])[A-Za-z]\w*", expression)) <= names, line
        assert re.fullmatch(r"[\w\s.+\-*/^()]+", expression), line
        names.add(name)
    assert {"bx", "by"} <= names


@pytest.mark.parametrize("language", list(LANGUAGES))
@pytest.mark.parametrize("solution", EVERY)
def test_sources_are_short(solution: str, language: str) -> None:
    """Lines too: Fortran takes 132 characters."""
    files = exported(solution).record.languages[language]
    texts = [exported(solution).sources[file] for file in files]
    assert sum(map(len, texts)) < (20_000 if exported(solution).record.dimension == 2 else 40_000)
    most = {"infix": 400 if exported(solution).record.dimension == 2 else 1200, "fortran": 130}.get(language, 200)
    assert max(len(line) for text in texts for line in text.splitlines()) <= most  # infix: an expression a line
    assert all("1e+00" not in text and "pow(p" not in text for text in texts)
