"""A user's file as any plug-in: shipped files, saved elsewhere word for word, give the numbers of those that ship."""

from dataclasses import replace
from pathlib import Path

import pytest

from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.mms.execute import execute
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver import plugins
from mpm_verify.solver.plugins import (
    CASES,
    LAYOUTS,
    MATERIALS,
    METHODS,
    RATES,
    SMOOTHINGS,
    SOLUTIONS,
    TRANSFERS,
    available,
    create,
    label,
    load,
    path,
)

RUN = Run("mpm", "bar", "linear_elastic", 8, 4, 0.4)
NAMES = {METHODS: "mpm", SOLUTIONS: "bar", MATERIALS: "linear_elastic", TRANSFERS: "pic", LAYOUTS: "uniform"}


def elsewhere(folder: Path, package: str, name: str, file: str = "my-own.py") -> str:
    """A shipped plug-in under another name in another folder: the only class there that keeps the contract."""
    (folder / file).write_text(path(package, name).read_text())
    return str(folder / file)


@pytest.mark.parametrize(
    ("field", "package"),
    [
        ("method", METHODS),
        ("solution", SOLUTIONS),
        ("material", MATERIALS),
        ("transfer", TRANSFERS),
        ("layout", LAYOUTS),
    ],
)
def test_the_same_numbers(tmp_path: Path, field: str, package: str) -> None:
    run = replace(RUN, transfer="pic")
    own = replace(run, **{field: elsewhere(tmp_path, package, NAMES[package])})
    assert own.digest != run.digest
    (result, _), (shipped, _) = execute(own), execute(run)
    assert result.status == "finished"
    assert result.errors == shipped.errors


@pytest.mark.parametrize("field", ["material", "smoothing", "rate"])
def test_the_same_column(tmp_path: Path, field: str) -> None:
    from mpm_verify.cases.column.execute import execute

    short = ColumnRun(
        method="mpm", material="hypoelastic:rate=jaumann", smoothing="fbar", cells=2, ppc=1, duration=0.01
    )
    if field == "rate":
        short = replace(short, smoothing="none")
        changes = {"material": f"hypoelastic:rate={elsewhere(tmp_path, RATES, 'jaumann')}"}
    elif field == "material":
        changes = {"material": elsewhere(tmp_path, MATERIALS, "hypoelastic") + ":rate=jaumann"}
    else:
        changes = {"smoothing": elsewhere(tmp_path, SMOOTHINGS, "fbar")}
    own = replace(short, **changes)
    assert own.digest != short.digest
    (result, _), (shipped, _) = execute(own), execute(short)
    assert result.status == "finished"
    assert result.values == shipped.values


def test_parameters_and_paths(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere(tmp_path, SOLUTIONS, "bar", "own.py")
    elsewhere(tmp_path, RATES, "jaumann", "rate.py")
    monkeypatch.chdir(tmp_path)
    assert create(SOLUTIONS, "own.py:A=0.02,phase=0.5").A == 0.02
    study = build(Asked("mms", {"solution": ("own.py:A=0.02",), "cells": (8,), "ppc": (4,)}), "verify mms", "mms")
    assert {run.solution for run in study.runs} == {f"{tmp_path}/own.py:A=0.02"}
    assert study.title == "CPDI against the manufactured solution own:A=0.02"
    assert create(MATERIALS, "mohr_coulomb:rate=rate.py").rate == f"{tmp_path}/rate.py"
    assert label("dir/own.py:A=1") == "own:A=1"
    assert label("cpdi:limit=1") == "cpdi:limit=1"
    with pytest.raises(ValueError, match=r"^own.py has no parameter 'B'; it has L, C, A, n, axis, phase$"):
        create(SOLUTIONS, "own.py:B=1")
    with pytest.raises(
        ValueError,
        match=rf"^no case 'own.py'; choose from {', '.join(available(CASES))}$",
    ):
        load(CASES, "own.py")


METHOD = "a method has support, order, fill"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x = 1\n", f"has no class Own; {METHOD}"),
        ("from mpm_verify.solver.basis.mpm import Mpm\n", f"has no class Own; {METHOD}"),  # defined elsewhere
        ("class Own:\n    order = 2\n", f": the class Own has no support, no fill; {METHOD}"),
        ("class A:\n    order = 2\n", f": the class A has no support, no fill; {METHOD}"),
        ("class A:\n    order = 2\nclass B:\n    order = 1\n", f"has the classes A, B: name one Own; {METHOD}"),
        (
            "class A:\n    support = order = fill = 2\nclass B(A): pass\n",
            f"has the classes A, B: name one Own; {METHOD}",
        ),
        ("class A(:\n", ", line 1: invalid syntax"),
        ("\n1 / 0\n", ", line 2: ZeroDivisionError: division by zero"),
        ("import nowhere\n", ", line 1: ModuleNotFoundError: No module named 'nowhere'"),
    ],
)
def test_what_is_missing(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "own.py").write_text(text)
    with pytest.raises(ValueError, match=r"own\.py") as told:
        load(METHODS, str(tmp_path / "own.py"))
    assert str(told.value).removeprefix(str(tmp_path / "own.py")).lstrip() == said.lstrip()


def test_a_class_of_the_files_name_among_others(tmp_path: Path) -> None:
    (tmp_path / "own.py").write_text("class A:\n    support = order = fill = 2\nclass Own(A): pass\n")
    assert load(METHODS, str(tmp_path / "own.py")).__name__ == "Own"


def test_every_kind_but_cases_has_a_contract() -> None:
    assert plugins.KINDS.keys() - plugins.CONTRACTS.keys() == {CASES}


KERNEL = '''
import json, pathlib
import numpy as np
from mpm_verify.solver._jit import F1, kernel, nothing
from beside import scale
FACTOR = json.loads((pathlib.Path(__file__).parent / "data.json").read_text())
@kernel(nothing(F1))
def fill(x):
    """{words}"""
    for a in range(x.shape[0]):
        x[a] = scale(x[a]) * FACTOR
class Own:
    support = order = 1
    fill = staticmethod(fill)
'''
BESIDE = """
from mpm_verify.solver._jit import kernel
@kernel(inline=True)
def scale(x):
    return {factor} * x
"""


def test_a_kernel_of_a_users_file_follows_what_it_imports_and_reads(tmp_path: Path) -> None:
    """What Numba alone would take from its cache: the answer of another helper, or of other data."""
    import numpy as np

    def filled(words: str, factor: float, data: float) -> tuple[float, int]:
        (tmp_path / "own.py").write_text(KERNEL.format(words=words))
        (tmp_path / "beside.py").write_text(BESIDE.format(factor=factor))
        (tmp_path / "data.json").write_text(str(data))
        plugins.module_of.__globals__["_held"].clear()
        fill = load(METHODS, str(tmp_path / "own.py")).fill
        x = np.ones(3)
        fill(x)
        return float(x[0]), sum(fill.stats.cache_hits.values())

    assert filled("one", 2.0, 10.0) == (20.0, 0)
    assert filled("other", 2.0, 10.0) == (20.0, 1)
    assert filled("one", 3.0, 10.0) == (30.0, 0)
    assert filled("one", 3.0, 11.0) == (33.0, 0)
    assert filled("one", 2.0, 10.0) == (20.0, 1)
