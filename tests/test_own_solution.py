"""A user's own solution: it runs like those of the library, and what is wrong with a file is one line."""

import re
import sys
from collections.abc import Callable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.harness.identity import identity
from mpm_verify.cases.mms.execute import execute
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.check import FINE, check, determinant, least_det
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.mms.measure import Sampler
from mpm_verify.solver.plugins import SOLUTIONS, absolute, canonical, create, split
from mpm_verify.verify.main import main

EXAMPLE = "tests/own_solution.py"
PARTS = """
import sympy as sp
def displacement(X, t{more}):
    x, y = X
    s, w = sp.sin(sp.pi * x) * sp.sin(sp.pi * y), 1 - sp.cos(100 * sp.pi * t)
    return {u}
def domain():
    return {{"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100{domain}}}
"""
U = "sp.Matrix([0.05 * s * w, 0.03 * s * w])"
Write = Callable[..., str]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes a file from its parts and returns its path."""

    def text(u: str = U, more: str = "", domain: str = "", whole: str | None = None) -> str:
        path = tmp_path / "own.py"
        path.write_text(PARTS.format(u=u, more=more, domain=domain) if whole is None else whole)
        return str(path)

    return text


def checked(path: str, material: str | None = None, cells: tuple[int, ...] = ()) -> Any:
    """The solution, after its check in a material, its own if none is named."""
    solution: Any = create(SOLUTIONS, path)
    check(solution, create("mpm_verify.solver.material", material or solution.material), cells)
    return solution


def errors(path: str, *cells: int) -> list[float]:
    """Error of u in rms, CPDI with 4 particles a cell."""
    material = create(SOLUTIONS, path).material
    return [execute(Run("cpdi", path, material, n, 4, 0.4))[0].errors["u"]["rms"] for n in cells]


def test_the_example_runs_at_second_order() -> None:
    """Held below and above, sliding at the sides; measured 3.455e-3, 8.773e-4, a ratio of 3.94."""
    solution = checked(EXAMPLE, cells=(8, 16))
    assert solution.boundary == ("roller", "roller", "fixed", "fixed")
    assert solution.margin == 0
    coarse, fine = errors(EXAMPLE, 8, 16)
    assert coarse == pytest.approx(3.455e-3, rel=0.02)
    assert 3.7 < coarse / fine < 4.3


def test_free_ends_run(write: Write) -> None:
    """With nu = 0 a stretch along x pulls nowhere along y; it ends without stress, and the edge moves."""
    path = write(
        "sp.Matrix([-0.04 * sp.cos(sp.pi * x) * sp.sin(100 * sp.pi * t + 0.6), 0])",
        domain=', "material": "neo_hookean:nu=0", "boundary": "free"',
    )
    solution = checked(path)
    assert solution.boundary == "free"
    assert 0.04 < solution.margin < 0.06
    coarse, fine = errors(path, 8, 16)
    assert coarse / fine > 2
    with pytest.raises(
        ValueError, match=r"the bottom edge cannot be free: its normal traction .* at .X, Y. = .*, t = "
    ):
        checked(path, "neo_hookean:nu=0.3")


def test_one_free_side(write: Write) -> None:
    """A margin on the free side alone: a wall stands at the edge of the body."""
    path = write("sp.Matrix([0.04 * sp.sin(sp.pi * x / 2) * w, 0])", domain=', "material": "neo_hookean:nu=0"')
    solution = checked(path)
    assert solution.boundary == ("fixed", "free", "roller", "roller")
    np.testing.assert_allclose(solution.margin, [[0, 0], [0.1, 0]], rtol=0.01)


def test_an_order_of_ones_own(write: Write) -> None:
    assert create(SOLUTIONS, write(domain=', "order": 2')).order == 2
    assert create(SOLUTIONS, EXAMPLE).order is None


def test_a_named_boundary(write: Write) -> None:
    assert checked(write(domain=', "boundary": "fixed"')).boundary == "fixed"


def test_a_named_boundary_that_does_not_hold(write: Write) -> None:
    with pytest.raises(
        ValueError, match=r"the left edge cannot be roller: its tangential traction .*; it is fixed: write"
    ):
        checked(write(domain=', "boundary": "roller"'))


def test_parameters(write: Write) -> None:
    path = write("sp.Matrix([A * s * w, B * s * w])", more=", A=0.05, B=0.03")
    solution = create(SOLUTIONS, f"{path}:A=0.01")
    assert [f.name for f in fields(solution)] == ["A", "B"]
    assert asdict(solution) == {"A": 0.01, "B": 0.03}
    assert solution == create(SOLUTIONS, f"{path}:A=0.01")
    u = {A: manufacture(create(SOLUTIONS, f"{path}:A={A}"), create("mpm_verify.solver.material", "neo_hookean"), 1.0).u
         for A in (0.01, 0.02)}  # fmt: skip
    X = np.array([[0.3, 0.4]])
    np.testing.assert_allclose(u[0.02](X, 0.005)[0] / u[0.01](X, 0.005)[0], [2, 1], rtol=1e-12)
    with pytest.raises(ValueError, match=r"own.py has no parameter 'C'; it has A, B"):
        create(SOLUTIONS, f"{path}:C=1")


NAMES = "C L T A B E nu lower upper speed order material boundary sides path functions call displacement self t_ n_"


def test_parameters_of_any_name(write: Write) -> None:
    """Also those that a solution has for itself: they change u, and hide nothing."""
    names = NAMES.split()
    product, more = " * ".join(names), "".join(f", {name}=1.0" for name in names)
    path = write(f"sp.Matrix([0.01 * {product} * s * w, 0])", more=more, domain=', "order": 2')
    law = create("mpm_verify.solver.material", "neo_hookean")
    X = np.array([[0.3, 0.4]])
    u = manufacture(create(SOLUTIONS, path), law, 1.0).u(X, 0.005)[0, 0]
    for name in names:
        solution: Any = create(SOLUTIONS, f"{path}:{name}=2")
        assert (solution.C, solution.order, solution.duration, solution.boundary) == (100, 2, 0.02, "fixed")
        np.testing.assert_allclose(manufacture(solution, law, 1.0).u(X, 0.005)[0, 0], 2 * u, rtol=1e-12)
        assert canonical(SOLUTIONS, f"{path}:{name}=2") == f"{path}:{name}=2"
        assert canonical(SOLUTIONS, f"{path}:{name}=1") == path
    with pytest.raises(ValueError, match=r"own.py has no parameter 'q'; it has A, B, C, E, L, T, "):
        create(SOLUTIONS, f"{path}:q=1")


def test_a_rectangle_and_its_cells(write: Write) -> None:
    whole = PARTS.format(u=U.replace("s * w", "s * w"), more="", domain="").replace(
        '"upper": (1, 1)', '"upper": (3, 1)'
    )
    path = write(whole=whole)
    solution = checked(path, cells=(9, 12))
    assert len(solution.layout(3 / 9, 4)) == 9 * 3 * 4
    with pytest.raises(ValueError, match=r"8 cells over the width of 3 do not fill the height of 1; .*multiples of 3"):
        checked(path, cells=(9, 8))


def test_split() -> None:
    assert split("axis_aligned:A=1,L=2") == ("axis_aligned", "A=1,L=2")
    assert split("dir:1/own.py:A=0.02") == ("dir:1/own.py", "A=0.02")
    assert split("a.py/own.py") == ("a.py/own.py", "")
    assert split("own.py:rate=dir/rate.py,A=1") == ("own.py", "rate=dir/rate.py,A=1")
    assert split("mohr_coulomb:rate=dir/rate.py") == ("mohr_coulomb", "rate=dir/rate.py")
    assert split(r"C:\own.py:A=1") == (r"C:\own.py", "A=1")


def test_identity_is_what_is_returned(write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same solution in another file or in other words is the same; another displacement or domain is another."""
    path = write()
    first = identity(SOLUTIONS, path)
    copy = tmp_path / "copy.py"
    copy.write_text(Path(path).read_text())
    assert identity(SOLUTIONS, str(copy)) == first
    write("sp.Matrix([0.05 * s * w, 0.03 * s * w + 0])  # in other words")
    assert identity(SOLUTIONS, path) == first
    write("sp.Matrix([0.05 * s * w, 0.02 * s * w])")
    assert identity(SOLUTIONS, path) != first
    for domain in (", 'speed': 90", ", 'duration': 0.03", ", 'boundary': 'fixed'", ", 'material': 'linear_elastic'"):
        write(domain=domain)
        assert identity(SOLUTIONS, path) != first
    write("sp.Matrix([A * s * w, 0.03 * s * w])", more=", A=0.05")
    assert identity(SOLUTIONS, path) == first != identity(SOLUTIONS, f"{path}:A=0.04")
    assert identity(SOLUTIONS, str(tmp_path / "gone.py")).startswith("unreadable")
    monkeypatch.chdir(tmp_path)
    assert absolute("own.py:A=1") == f"{path}:A=1"
    assert absolute("axis_aligned:A=1") == "axis_aligned:A=1"


WRONG = (
    "None", "True", "1j", "[[0, 1], [2]]", "{}", "float('nan')", "10**400", "1e308", "b'1'", "sp.Symbol('z')",
    "object()", "('0', '1')", "[(0,), (1, 2)]", "(1, 1j)", "(1, True)", "(None, 1)", "('1', '2')",
)  # fmt: skip
BAD: dict[str, tuple[dict[str, str], str]] = {
    "syntax": ({"whole": "def displacement(X, t:\n"}, r"own.py, line 1: "),
    "raises on import": ({"whole": "\n\n1 / 0\n"}, r"own.py, line 3: ZeroDivisionError: division by zero$"),
    "leaves": ({"whole": "raise SystemExit('bye')\n"}, r"own.py, line 1: SystemExit: bye$"),
    "raises later": ({"u": "sp.Matrix([nothing, 0])"}, r"own.py, line 6: NameError: name 'nothing' is not defined$"),
    "no function": ({"whole": "x = 1\n"}, r"own.py has no function displacement\(X, t\)$"),
    "no domain": ({"whole": "def displacement(X, t): return 0, 0"}, r"own.py has no function domain\(\)$"),
    "arguments": ({"whole": "def displacement(X): pass\ndef domain(): pass"}, r"displacement must take \(X, t\) and"),
    "a word as default": ({"more": ", A='x'"}, r"parameter A, which needs a number as default, such as A=1.0$"),
    "no default": ({"more": ", *A"}, r"parameter A, which needs a number as default"),
    "a truth as default": ({"more": ", A=True"}, r"parameter A, which needs a number as default"),
    "a huge default": ({"more": ", A=10**400"}, r"parameter A, which needs a number as default"),
    "a truth as component": ({"u": "[s, True]"}, r"displacement must return sp.Matrix"),
    "shape": ({"u": "sp.Matrix([s, s, s])"}, r"displacement must return sp.Matrix\(\[u_x, u_y\]\), not Matrix"),
    "no SymPy": ({"u": "'up'"}, r"displacement must return sp.Matrix.*, not up$"),
    "no expression": ({"u": "[s, 'up']"}, r"displacement must return sp.Matrix"),
    "symbols": ({"u": "sp.Matrix([sp.Symbol('z') * s, s])"}, r"the unknown symbols z; use the X and t it is given$"),
    "a kink": ({"u": "sp.Matrix([s * abs(x - 0.5), s])"}, r"displacement has Abs\(X - 0.5\); use numbers, powers"),
    "complex": ({"u": "sp.Matrix([sp.I * s, s])"}, r"displacement has "),
    "a step": ({"u": "sp.Matrix([s * sp.Piecewise((1, x > 0.5), (0, True)), s])"}, r"displacement has Piecewise"),
    "nothing moves": ({"u": "sp.Matrix([0, 0])"}, r"nothing moves"),
    "u infinite": ({"u": "sp.Matrix([s * sp.log(x), s])"},
                   r"u is not finite at \(X, Y\) = \(0, 0\), t = 0$"),
    "F infinite": ({"u": "sp.Matrix([0.01 * sp.sqrt(x) * sp.sin(sp.pi * x)**0 * y * (1 - x) * w, s])"},
                   r"F is not finite at \(X, Y\) = \(0, 0\), t = "),
    "b infinite": ({"u": "sp.Matrix([0.05 * s * x * sp.sqrt(x) * 0 + 0.05 * x**sp.Rational(3, 2) * (1 - x) * w, 0])"},
                   r"the body force is not finite at \(X, Y\) = \(0, 0\), t = 0"),
    "inverted": ({"u": "sp.Matrix([s * w, 0])"}, r"F is not invertible: det F = -\d\S* at \(X, Y\) = .*, t = 0.01$"),
    "moving edge": ({"u": "sp.Matrix([0.05 * w * x, 0])",
                     "domain": ", 'boundary': ('fixed', 'free', 'roller', 'roller')"},
                    r"the right edge cannot be free: its normal traction is \d.*, \S+ of the largest stress; it is "
                    r'pulled or prescribed: write that, or leave "boundary" out$'),
    "keys": ({"domain": ", 'sped': 1"}, r"domain returns .*; it must return a dictionary with lower"),
    "numbers": ({"domain": ", 'duration': 'long'"}, r"domain has duration = 'long', which is not a finite number$"),
    "corners": ({"domain": ", 'upper': (0, 1)"}, r"domain has upper = \(0, 1\), not above lower = \(0, 0\)$"),
    "three numbers": ({"domain": ", 'upper': (1, 1, 1)"}, r"upper = \(1, 1, 1\); write as many numbers for both$"),
    "no numbers": ({"domain": ", 'upper': ()"}, r"upper = \(\); write two numbers, one on a line, three in a box$"),
    "time": ({"domain": ", 'duration': -1"}, r"domain has duration = -1, which must be above zero$"),
    "order": ({"domain": ", 'order': 0"}, r"domain has order = 0, which must be above zero$"),
    "no time": ({"domain": ", 'duration': None"}, r"domain has duration = None, which is not a finite number$"),
    "boundary in a list": ({"domain": ", 'boundary': ['fixed', ['free'], 3, None]"}, r"; write one of fixed, roller"),
    "boundary": ({"domain": ", 'boundary': 'sticky'"}, r"boundary = sticky; write one of fixed, roller, free, pul"),
    "boundary type": ({"domain": ", 'boundary': 3"}, r"boundary = 3; write one of fixed, roller, free, pulled, presc"),
    "ratio": ({"domain": ", 'upper': (1, 3.14159265)"}, r"no square cells fill a rectangle of 1 x 3.14159"),
    "material": ({"domain": ", 'material': 'jelly'"}, r"no material 'jelly'; choose from"),
    **{
        f"{name} = {value}": ({"domain": f", {name!r}: {value}"}, rf"domain has {name} = .*{said}")
        for name, said in {
            "material": r"; write a name with its parameters, such as 'neo_hookean:E=1e4,nu=0.3'$",
            "boundary": r"; write one of fixed, .*, prescribed, or four of them for left, right, bottom, top$",
            **dict.fromkeys(("lower", "upper"), r", which is not a finite number$"),
            **dict.fromkeys(("duration", "speed", "order"), r", which is not a finite number$"),
        }.items()
        for value in WRONG
        if (name, value) != ("boundary", "None")
    },
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_files(write: Write, name: str) -> None:
    """One line that names the file, and what is wrong with it."""
    parts, said = BAD[name]
    with pytest.raises(ValueError, match=said) as raised:
        checked(write(**parts))
    assert "\n" not in str(raised.value)
    assert name == "material" or re.match(r"\S*own\.py", str(raised.value))


def test_no_such_file() -> None:
    with pytest.raises(ValueError, match=r"^tests/nowhere.py: no such file or directory$"):
        create(SOLUTIONS, "tests/nowhere.py")
    with pytest.raises(ValueError, match=r"choose from .*, or give a file"):
        create(SOLUTIONS, "nowhere")
    with pytest.raises(ValueError, match=r"^own.py: no such file or directory$"):
        create("mpm_verify.solver.material", "own.py")


DIP = "sp.Matrix([-A * (x - 0.50371) * sp.exp(-((x - 0.50371)**2 + (y - 0.49812)**2) / 0.012**2) * s * w, 0])"


@pytest.mark.parametrize(("A", "good"), [(0.495, True), (0.51, False)])
def test_a_dip_between_the_samples(write: Write, A: float, good: bool) -> None:
    """det F is 1 - 2 A at its least, in a spot of a thousandth of the side, which no sample hits."""
    solution: Any = create(SOLUTIONS, write(DIP, more=f", A={A}"))
    sampler = Sampler(manufacture(solution, create("mpm_verify.solver.material", "neo_hookean"), 1.0))
    low, high = np.array([0.0, 0.0, 0.0]), np.array([solution.duration, 1.0, 1.0])
    axes = np.meshgrid(*[np.linspace(0, 1, n) for n in FINE], indexing="ij", sparse=True)
    assert determinant(sampler, low, high, *axes).min() > 0.01
    place, J = least_det(solution, sampler)
    assert pytest.approx(1 - 2 * A, abs=2e-3) == J
    np.testing.assert_allclose(place, [0.01, 0.50371, 0.49812], atol=1e-3)
    if good:
        checked(str(solution.path))
    else:
        with pytest.raises(ValueError, match=r"F is not invertible: det F = -0.0\d+ at .X, Y. = .0.503\d*, 0.498"):
            checked(str(solution.path))


@pytest.mark.parametrize("words", [["audit"]])
def test_command(
    write: Write, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: list[str]
) -> None:
    """`verify audit own.py`: an audit, and exit code 2 with one line for a bad file."""
    for u, code in ((U, 0), ("sp.Matrix([s * w, 0])", 2)):
        monkeypatch.setattr(sys, "argv", ["verify", *words, write(u)])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == code
    out, err = capsys.readouterr()
    assert "cannot see" in out
    assert err.count("\n") == 1
    assert "F is not invertible" in err


@pytest.mark.parametrize(
    ("pi", "least", "most"), [("3.1415926", 4.5e-8, 5.5e-8), ("22 / 7", 0.5e-3, 1.5e-3), ("3.14", 1.5e-3, 2.5e-3)]
)
def test_a_rounded_constant_is_told_from_an_edge_that_moves(write: Write, pi: str, least: float, most: float) -> None:
    """The miss as a fraction of the motion: of a rounded pi, and of edges that move."""
    said = r"the right edge is not quite fixed: .* (\S+) of the largest motion. That looks like a rounded .* sp.pi"
    with pytest.raises(ValueError, match=said) as raised:
        checked(write(f"sp.Matrix([0.02 * sp.sin({pi} * x) * sp.sin({pi} * y) * w] * 2)"))
    assert least < float(str(raised.value).split(" of the largest motion")[0].split()[-1]) < most


def test_a_small_motion_is_no_rounding(write: Write) -> None:
    """An edge that moves by a fiftieth of the largest motion is pulled; one that was named so may look rounded."""
    moves: Any = create(SOLUTIONS, write("sp.Matrix([0.02 * (sp.sin(sp.pi * x) + 0.02 * x) * w, 0])"))
    assert moves.sides == ("fixed", "pulled", "roller", "roller")
    rounded = "sp.Matrix([0.02 * sp.sin(3.14 * x) * sp.sin(sp.pi * y) * w] * 2)"
    checked(write(rounded, domain=", 'boundary': ('fixed', 'prescribed', 'fixed', 'fixed')"))


def test_a_side_that_looks_rounded_in_its_traction(write: Write) -> None:
    """A free end whose stretch should vanish at 1, with pi / 2 as 1.5708."""
    path = write("sp.Matrix([0.04 * sp.sin(1.5708 * x) * w, 0])", domain=', "material": "neo_hookean:nu=0"')
    said = r"the right edge is not quite free: its normal traction .* \de-0[456] of the largest stress. That looks like"
    with pytest.raises(ValueError, match=said):
        checked(path)
