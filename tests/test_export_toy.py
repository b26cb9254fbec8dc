"""A case folder is enough: a program that reads nothing else has the digits of other programs, and order 2."""

import shutil
from math import log2
from pathlib import Path

import pytest
from fixtures_export import folder_of
from toy_solver import Toy

DIGITS = {"bump": (4.139e-8, 1.079e-8, 2.737e-9), "clamped_shear:G=1e-6": (7.253e-8, 1.787e-8, 4.415e-9)}


def errors(solution: str, folder: Path, cells: tuple[int, ...] = (8, 16), **more: object) -> list[float]:
    """Errors of u on some numbers of cells."""
    return [Toy(folder_of(solution, folder / str(n), cells=n), **more).error() for n in cells]


@pytest.mark.parametrize("solution", DIGITS)
def test_digits(solution: str, tmp_path: Path) -> None:
    assert [float(f"{error:.3e}") for error in errors(solution, tmp_path)] == list(DIGITS[solution][:2])


@pytest.mark.slow
@pytest.mark.parametrize("solution", DIGITS)
def test_digits_on_finer_cells(solution: str, tmp_path: Path) -> None:
    assert [float(f"{error:.3e}") for error in errors(solution, tmp_path, (32,))] == list(DIGITS[solution][2:])


@pytest.mark.parametrize("levels", ["last", "first", "end"])
@pytest.mark.parametrize("solution", ["bump", "clamped_shear:G=1e-6"])
def test_each_row_of_the_table_of_time_levels_is_of_second_order(solution: str, levels: str, tmp_path: Path) -> None:
    coarse, fine = errors(solution, tmp_path, levels=levels)
    assert 1.9 < log2(coarse / fine) < 2.2


def test_the_force_at_nodes_is_of_second_order(tmp_path: Path) -> None:
    """b at current positions, for programs that take it there; nodes beyond the edges of the body too."""
    coarse, fine = errors("clamped_shear:G=1e-6", tmp_path, at_nodes=True)
    assert 1.9 < log2(coarse / fine) < 2.2


def test_another_time_level_is_of_first_order(tmp_path: Path) -> None:
    """Update-stress-first with F at t = 0: the table matters."""
    measured = []
    for n in (8, 16):
        folder = shutil.copytree(folder_of("clamped_shear:G=1e-6", tmp_path / str(n), cells=n), tmp_path / f"{n} at 0")
        table = (folder / "particles.csv").read_text().splitlines()
        names = table[0].split(",")
        at = {name: names.index(name) for name in names}
        for k, line in enumerate(table[1:], 1):
            row = line.split(",")
            for name in ("Fxx", "Fxy", "Fyx", "Fyy"):
                row[at[f"{name}_before"]] = row[at[name]]
            table[k] = ",".join(row)
        (folder / "particles.csv").write_text("\n".join(table) + "\n")
        measured.append(Toy(folder, "first").error())
    assert log2(measured[0] / measured[1]) < 1.5
