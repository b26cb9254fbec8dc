"""Problems that people ask for, as their files stand: edges that move and pull, and what cannot be compressed."""

from pathlib import Path

import numpy as np
import pytest
from fixtures_command import Call, caller

from mpm_verify.cases.mms.execute import execute
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, canonical, create
from mpm_verify.solver.state import Floats

GROWN = "A*(1-sp.cos(100*sp.pi*t))/2"
FILE = """import sympy as sp
def displacement(X, t, A=0.01):
    x, y = X
    {before}
    return {GROWN}*sp.Matrix([{u}])
def domain():
    return {{"lower": (0, 0), "upper": (1, {height}), "duration": 0.02, "speed": 100{more}}}
"""
POLYNOMIAL = {"u": "x**5+y**2, x**2+y**5", "more": ', "material": "linear_elastic:nu=0"'}
DRIVEN = {
    "before": "h = sp.Rational(1, 2)",
    "u": "(1+x)*(y/h)**2*(1-y/h)**2*sp.sin(2*sp.pi*x)*sp.cos(3*sp.pi*y/h)+4*x*y/h*(1-y/h), x*(1-x)*sp.sin(2*sp.pi*y/h)",
    "height": "0.5", "more": ', "material": "neo_hookean:nu=0.4"',
}  # fmt: skip
STREAM = {"before": "psi = sp.sin(sp.pi*x)**2*sp.sin(sp.pi*y)**2", "u": "sp.diff(psi, y), -sp.diff(psi, x)"}


def written(folder: Path, text: dict[str, str]) -> str:
    path = folder / "mine.py"
    path.write_text(FILE.format(**({"before": "", "height": "1", "more": "", "GROWN": GROWN} | text)))
    return str(path)


def errors(path: str, cells: tuple[int, ...], courant: float = 0.4, material: str = "") -> Floats:
    """Errors of u of CPDI with 4 particles per cell."""
    name = canonical(MATERIALS, material or create(SOLUTIONS, path).material)
    return np.array([execute(Run("cpdi", path, name, n, 4, courant))[0].errors["u"]["rms"] for n in cells])


def orders(found: Floats, cells: tuple[int, ...]) -> Floats:
    local: Floats = np.log(found[:-1] / found[1:]) / np.log(np.array(cells[1:]) / cells[:-1])
    return local


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "kinds", "recorded", "order"),
    [
        (POLYNOMIAL, ("pulled",) * 4, 3.044e-4, 1.84),
        (DRIVEN, ("fixed", "pulled", "fixed", "fixed"), 3.801e-4, 1.94),
    ],
    ids=["polynomial", "driven edge"],
)
def test_edges_of_files_as_they_stand(
    text: dict[str, str], kinds: tuple[str, ...], recorded: float, order: float, tmp_path: Path
) -> None:
    path = written(tmp_path, text)
    assert create(SOLUTIONS, path).sides == kinds
    found = errors(path, (8, 16))
    assert found[0] == pytest.approx(recorded, rel=0.01)
    assert orders(found, (8, 16))[0] == pytest.approx(order, abs=0.02)


@pytest.fixture
def call(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


@pytest.mark.slow
def test_strains_too_large_for_the_material_end_on_a_floor_that_is_named(tmp_path: Path, call: Call) -> None:
    """As it stands F - I reaches 0.047 of a material of small strains: orders 1.96 1.68 0.94 0.24. With A=1e-6 PASS."""
    path = written(tmp_path, POLYNOMIAL)
    code, out, _ = call("mms", "--quick", "--solution", path, "--no-page")
    said = " ".join(out.split())
    assert code == 1
    assert all(f" {order} " in said for order in ("1.96", "1.68", "0.94", "0.24"))
    assert "FAIL" in said
    assert "it falls to a floor of 3.8e-5" in said
    stall = said[said.index("STALL") :]
    assert "Strains too large for a material of small strains" in stall
    assert "a floor of 5.1e-05" in stall
    assert "Cell crossings" not in stall
    code, out, _ = call("mms", "--quick", "--solution", f"{path}:A=1e-6", "--no-page")
    assert code == 0
    assert "order 1.99 (" in " ".join(out.split())
    assert "STALL" not in out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("nu", "courant", "recorded", "known"),
    [
        (0.45, 0.2, 9.587e-4, (1.82, 1.98)),
        (0.49, 0.12, 1.318e-3, (2.09, 2.16)),
        (0.499, 0.06, 4.604e-3, (1.24, 1.07)),
    ],
)
def test_a_stream_function_towards_incompressibility(
    nu: float, courant: float, recorded: float, known: tuple[float, ...], tmp_path: Path
) -> None:
    """Order 2 up to 0.49; at 0.499 it locks, with 7.9 times the error of 0.3 on 24 cells."""
    cells = (12, 16, 24)
    found = errors(written(tmp_path, STREAM), cells, courant, f"neo_hookean:nu={nu}")
    assert found[0] == pytest.approx(recorded, rel=0.01)
    assert orders(found, cells) == pytest.approx(known, abs=0.02)
    assert found[-1] / 2.646e-4 == pytest.approx({0.45: 0.96, 0.49: 1.14, 0.499: 7.9}[nu], rel=0.01)
