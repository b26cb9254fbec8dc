"""What is derived of a solution is kept on disk, by what it stands for, and gives the same bits without SymPy."""

import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from mpm_verify.mms import exact
from mpm_verify.mms.manufacture import manufacture
from mpm_verify.mms.printed import folder, function, printed
from mpm_verify.solver import cache_folder
from mpm_verify.solver.cache_folder import kept
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, available, create

X = np.random.default_rng(7).uniform(0.76, 0.9, (9, 2))  # inside every body of the library
SOLID = np.column_stack([X, X[::-1, 0]])
FIELDS = ("u", "v", "F", "P", "sigma", "b")

ASK = """
import json, sys
import numpy as np
from mpm_verify.cases.mms.exact import audited, manufactured
exact = manufactured("clamped_shear", "neo_hookean")
X = np.array([[0.3, 0.4], [0.61, 0.17]])
values = {q: getattr(exact, q)(X, 0.37).tolist() for q in ("u", "v", "F", "P", "sigma", "b")}
values["columns"] = exact.kernel.columns(X).tolist()
values["scalars"] = exact.kernel.scalars(0.37, 0.36).tolist()
spots = [repr(spot) for spot in audited("clamped_shear", "neo_hookean")]
print(json.dumps([values, spots, "sympy" in sys.modules]))
"""


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own for printed texts; the kernels of the materials are compiled before, into the usual one."""
    for name in ("neo_hookean", "linear_elastic"):
        create(MATERIALS, name)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(cache_folder, "base", lambda: home)
    home = tmp_path / "mpm-verify"
    home.mkdir()
    return home


def test_second_process_needs_no_sympy(tmp_path: Path) -> None:
    """It gives every number of the first one, which derived them, in every digit."""
    env = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    first, second = (
        json.loads(subprocess.run([sys.executable, "-c", ASK], env=env, capture_output=True, check=True).stdout)
        for _ in range(2)
    )
    assert first[:2] == second[:2]
    assert (first[2], second[2]) == (True, False)


@pytest.mark.parametrize("name", available(SOLUTIONS))
def test_kept_functions_give_the_same_bits(name: str, cache: Path) -> None:
    solution, material = create(SOLUTIONS, name), create(MATERIALS, "neo_hookean")
    derived = manufacture(solution, material, material.rho0)
    written, read = (manufacture(solution, material, material.rho0, "a name") for _ in range(2))
    at = {1: X[:, :1], 2: X, 3: SOLID}[len(solution.lower)]
    for field in FIELDS:
        expected = getattr(derived, field)(at, 0.1)
        np.testing.assert_array_equal(getattr(written, field)(at, 0.1), expected)
        np.testing.assert_array_equal(getattr(read, field)(at, 0.1), expected)
    assert "fields" in vars(written)
    assert "fields" not in vars(read)  # nothing was derived


def test_printed_function_is_the_expression() -> None:
    """And has NumPy's names: a logarithm, pi, a sine."""
    x, t = sp.symbols("x t")
    source = printed((x, t), [sp.log(x) * sp.pi + sp.sin(sp.pi * t) ** 2, x - t])
    np.testing.assert_allclose(function(source)(2.0, 0.25), [np.log(2) * np.pi + 0.5, 1.75], rtol=1e-15)


@pytest.mark.parametrize(
    "other",
    [
        ("axis_aligned:A=0.02", "neo_hookean"),
        ("axis_aligned", "neo_hookean:nu=0.2"),
        ("axis_aligned", "linear_elastic"),
    ],
)
def test_another_problem_has_another_folder(other: tuple[str, str], cache: Path) -> None:
    """Another parameter or another solution: the body force of one problem never serves another."""
    from mpm_verify.cases.mms.exact import manufactured

    here, there = manufactured("axis_aligned", "neo_hookean"), manufactured(*other)
    assert here.folder != there.folder
    assert not np.array_equal(here.b(X, 0.1), there.b(X, 0.1))


def test_changed_source_has_another_folder(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what derives, and of SymPy and NumPy, which print and compute it."""
    import mpm_verify.mms.printed as module

    names = [folder("n", "mpm_verify.mms.manufacture"), folder("m", "mpm_verify.mms.manufacture")]
    with monkeypatch.context() as patch:
        patch.setattr(module, "source_hash", lambda name: "edited")
        names.append(folder("n", "mpm_verify.mms.manufacture"))
    with monkeypatch.context() as patch:
        patch.setattr(module, "_sympy", lambda: "0.0")
        names.append(folder("n", "mpm_verify.mms.manufacture"))
    assert len(set(names)) == 4
    assert folder("n", "mpm_verify.mms.manufacture") == names[0]


def test_user_file_that_changes_is_derived_anew(tmp_path: Path, cache: Path) -> None:
    from mpm_verify.cases.mms.exact import manufactured

    file = tmp_path / "mine.py"
    text = (
        "from sympy import *\ndef displacement(X, t): return [{A}*sin(pi*X[0])*sin(t), 0]\ndomain = lambda: {domain}\n"
    )
    domain = {"lower": (0, 0), "upper": (1, 1), "duration": 1.0, "speed": 40.0}
    values = []
    for A in (0.01, 0.02):
        file.write_text(text.format(A=A, domain=domain))
        values.append(manufactured(str(file), "neo_hookean").u(X, 0.5))
    np.testing.assert_allclose(values[1], 2 * values[0], rtol=1e-14)


def test_full_disk_costs_time_alone(cache: Path) -> None:
    """Nothing can be written where a file stands for the folder; the text is made each time."""
    (cache / "blocked").write_text("")
    assert [kept("blocked", "u", lambda: "made") for _ in range(2)] == ["made", "made"]


def test_nothing_is_left_of_a_write_that_failed(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(source: str, target: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert kept("texts", "u", lambda: "made") == "made"
    assert list((cache / "texts").iterdir()) == []


DAMAGED = {"empty": b"", "cut": b"0123", "binary": b"\xff\xfe\x00", "altered": None, "without its hash": b"made"}


@pytest.mark.parametrize("how", DAMAGED)
def test_damaged_text_is_made_again(cache: Path, how: str) -> None:
    kept("texts", "u", lambda: "made")
    file, content = cache / "texts" / "u", DAMAGED[how]
    whole = file.read_bytes()
    file.write_bytes(whole.replace(b"made", b"mode") if content is None else content)
    assert kept("texts", "u", lambda: "made") == "made"
    assert file.read_bytes() == whole
    assert kept("texts", "u", lambda: "not asked for") == "made"


def test_text_is_made_where_the_cache_is_gone(cache: Path) -> None:
    kept("texts", "u", lambda: "made")
    shutil.rmtree(cache)
    assert kept("texts", "u", lambda: "made") == "made"
    assert (cache / "texts" / "u").exists()


def test_threads_read_whole_texts(cache: Path) -> None:
    """All write the same text at once; who reads it reads all of it or makes it."""
    long = "x" * 200_000

    def ask(number: int) -> str:
        if number % 3 == 0:
            (cache / "texts" / "u").unlink(missing_ok=True)
        return kept("texts", "u", lambda: long)

    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(ask, range(120))) == {long}


def test_damaged_kernel_source_is_written_again(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of the right name with another content is not what its name says."""
    folder_ = cache / "exact"
    folder_.mkdir()
    monkeypatch.setattr(exact, "kept_in", lambda *words: folder_)
    source = "def exact():\n    return 1\n"
    assert exact._load(source)() == 1
    (file,) = folder_.glob("exact_*.py")
    file.write_text("def exact():\n    return 2\n")
    assert exact._load(source)() == 1


MATERIAL = """
from pathlib import Path
from mpm_verify.solver.material.neo_hookean import NeoHookean

class Mine(NeoHookean):
    def energy(self, F, log):
        return float(Path({path!r}).read_text()) * super().energy(F, log)
"""


def test_energy_of_a_users_file_is_kept_nowhere(tmp_path: Path, cache: Path) -> None:
    """It reads another number between the naming and the derivation; who asks later gets what it reads then."""
    from mpm_verify.cases.mms.exact import manufactured

    file, data = tmp_path / "mine.py", tmp_path / "k.txt"
    data.write_text("1.0")
    file.write_text(MATERIAL.format(path=str(data)))
    usual = manufactured("axis_aligned", "neo_hookean").sigma(X, 0.2)
    mine = manufactured("axis_aligned", str(file))
    data.write_text("3.0")
    np.testing.assert_allclose(mine.sigma(X, 0.2), usual, rtol=1e-12)
    assert not mine.folder
