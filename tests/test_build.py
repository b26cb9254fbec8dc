"""Studies from what is asked for: every field of every case's Run is an axis, from options and from TOML alike."""

import json
import re
import sys
import tomllib
from collections.abc import Sequence
from dataclasses import fields
from itertools import pairwise
from pathlib import Path
from typing import Any

import fixtures_study as fixtures
import pytest

from mpm_verify.cases.harness.build import Asked, build, named, union
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.study_file import study_of
from mpm_verify.cases.mms.run import AXES, NORMS, QUANTITIES, QUICK
from mpm_verify.solver.plugins import CASES, available
from mpm_verify.verify.main import main
from mpm_verify.verify.options import values

MAP = (
    '{"columns": {"id": {"from": "id"}, "x": {"from": "x"}}, "files": "p{step}.csv", "format": "text", '
    '"frames": "step"}'
)  # the text of a map, as a run has it
SAMPLES: dict[str, dict[str, str]] = {  # of each case two values of each field, as they are typed
    "mms": {
        "method": "cpdi,gimp", "solution": "axis_aligned,bar", "material": "neo_hookean,linear_elastic",
        "cells": "8,16", "ppc": "4,9", "courant": "0.4,0.2", "transfer": "flip,apic", "stress": "usl,musl",
        "staggered": "yes,no", "force": "no,yes", "offset": "0.25,-0.125", "layout": "uniform,graded",
        "solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}", "solver_version": "1,2", "order": "2,1",
        "time_limit": "60,120", "memory_limit": "0,1000", "start": "half.now.start,zero.now.end",
        "precision": "double,single", "time_step": "h,h2", "columns": MAP.replace("{", "{{").replace("}", "}}"),
        "dim": "2,3", "periods": "0.125,2", "damping": "0,0.05", "manufacture": "none,damping",
        "smoothing": "none,volumetric:of=stress",
    },
    "wave_bar": {
        "method": "cpdi,mpm", "material": "neo_hookean,linear_elastic", "cells": "8,16", "ppc": "4,9",
        "courant": "0.4,0.2", "transfer": "flip,apic", "amplitude": "1e-6,0.001", "periods": "2,3",
        "offset": "0.25,-0.125",
    },
    "box": {
        "method": "cpdi,gimp", "material": "mohr_coulomb:psi=0,drucker_prager:psi=0", "cells": "4,8", "ppc": "4,9",
        "transfer": "flip,pic", "smoothing": "none,volumetric", "damping": "0,0.05", "drop": "0,0.08",
        "jitter": "0,0.3", "seed": "1,2", "pooling": "no,yes", "courant": "0.4,0.2", "duration": "0.1,0.2",
        "width": "0.0905,0.2", "aspect": "3,4", "limit": "0.5,inf", "g": "10,9.81", "control": "no,yes",
    },
    "bench": {
        "method": "cpdi,gimp", "over": "mpm,bspline2", "material": "neo_hookean,hypoelastic", "transfer": "flip,apic",
        "smoothing": "none,volumetric:of=stress", "cells": "8,16", "ppc": "4,9", "pairs": "3,5", "parallel": "2,4",
    },
    "column": {
        "method": "cpdi,gimp", "cells": "4,8", "ppc": "4,9", "material": "mohr_coulomb,ubcsand", "damping": "0,0.05",
        "damping_kind": "local,objective", "smoothing": "none,volumetric", "transfer": "flip,pic",
        "deformation": "exponential,linear", "limit": "0.5,inf", "void": "yes,no", "courant": "0.4,0.2",
        "duration": "0.1,0.2", "start": "none,k0", "left": "roller,fixed", "gate": "inf,0.5", "stops": "yes,no",
        "offset": "0,0;0.25,-0.125", "mirror": "no,yes", "width": "0.0905,0.2", "aspect": "7,5", "channel": "18,12",
        "g": "10,9.81", "floor": "fixed,frictional", "mu": "0.47,0.3", "pooling": "no,yes",
    },
    "element": {
        "material": "mohr_coulomb,ubcsand", "test": "biaxial,isotropic", "stress": "5000,10000", "steps": "100,200",
        "path": "{here}/one.csv,{here}/two.csv", "units": "percent,fraction",
        "start": "isotropic,k0", "motion": "none,simple_shear",
    },
    "exact": {
        "method": "cpdi,gimp", "material": "neo_hookean,hypoelastic", "test": "throw,turn",
        "solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}", "solver_version": "1,2",
        "columns": MAP.replace("{", "{{").replace("}", "}}"), "precision": "double,single", "flip": "yes,no",
        "time_limit": "60,120", "memory_limit": "0,1000",
    },
    "benchmark": {
        "problem": "colliding_bars,cell_crossing", "method": "cpdi,gimp",
        "material": "linear_elastic:E=1,nu=0,linear_elastic:E=2,nu=0", "cells": "16,32", "ppc": "4,9",
        "courant": "0.4,0.2", "transfer": "flip,apic", "smoothing": "none,volumetric", "offset": "0.25,-0.125",
        "control": "no,yes",
    },
    "detect": {"defect": "none,cpdi-corner-weights", "method": "cpdi,mpm", "checks": "full,quick"},
    "objectivity": {
        "L": "1,2", "E": "5e5,1e6", "nu": "0.3,0.25", "rho0": "2650,2000", "g": "10,9.81", "cells": "8,4",
        "ppc": "4,9", "courant": "0.4,0.2", "rate": "jaumann,truesdell", "frame": "no,yes", "part": "block,kinematic",
    },
}  # fmt: skip
OTHER = {"solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}"}
WITH: dict[tuple[str, str], dict[str, str]] = {  # what else has to be asked for
    ("element", "path"): {"test": "path"},
    ("element", "units"): {"test": "path", "path": "{here}/one.csv"},
    ("mms", "manufacture"): {"damping": "0.05"},
    ("column", "mu"): {"floor": "frictional"},
    ("column", "damping_kind"): {"damping": "0.05"},
    ("element", "motion"): {"test": "path", "path": "{here}/one.csv"},
    ("mms", "start"): {"solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}"},
    ("mms", "dim"): {"solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}"},
    ("mms", "precision"): {"solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}"},
    ("mms", "columns"): {"solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}"},
    **{("exact", name): OTHER for name in ("test", "columns", "precision", "flip", "solver_version")},
    ("mms", "solver_version"): {"solver": f"{sys.executable} {{{{case}}}} {{{{out}}}}"},
}
UNNAMED = ("order", "time_limit", "memory_limit")  # fields that say nothing of the numbers
COARSE = {"mms": {"cells": "8,16", "ppc": "4"}, "wave_bar": {"cells": "8,16"}, "column": {"cells": "4", "ppc": "4"}}
COARSE["benchmark"] = {"problem": "colliding_bars", "method": "cpdi", "cells": "16"}
COARSE["exact"] = {"method": "cpdi", "material": "neo_hookean"}
COMPUTED = [case for case in available(CASES) if not case_named(case).Run.given]  # numbers of a table have no axes
EVERY = [(case, item.name) for case in COMPUTED for item in fields(case_named(case).Run)]


@pytest.fixture
def here(tmp_path: Path) -> str:
    """A folder with two strain paths."""
    for name, most in (("one", 0.01), ("two", 0.02)):
        (tmp_path / f"{name}.csv").write_text(f"exx,eyy,exy\n0,0,0\n0,{-most},0\n")
    return str(tmp_path)


def asked(case: str, field: str, here: str) -> dict[str, list[Any]]:
    """Values of the field, and of what has to be asked for with it, read as those of the command line are."""
    typed = COARSE.get(case, {}) | WITH.get((case, field), {}) | {field: SAMPLES[case][field]}
    return values(case_named(case).Run, {key: [text.format(here=here)] for key, text in typed.items()})


def toml(given: dict[str, Sequence[Any]]) -> dict[str, Any]:
    """What a TOML file with these values in its [sweep] holds; JSON lists are TOML lists but for infinity."""
    lines = [f"{key} = {json.dumps(chosen).replace('Infinity', 'inf')}" for key, chosen in given.items()]
    return tomllib.loads("\n".join(["[sweep]", *lines]))


def column(study: Study[Any], field: str) -> list[Any]:
    """Values of a field over the runs, each once."""
    return list(dict.fromkeys(getattr(run, field) for run in study.runs))


# ---- axes


@pytest.mark.parametrize(("case", "field"), EVERY)
def test_every_field_of_every_run_is_an_axis(case: str, field: str, here: str) -> None:
    """Two values make runs with each of them; of a refinement one offset is given, and replicates shift the rest."""
    given = asked(case, field, here)
    study = build(Asked(case, given), "verify", "t")
    assert set(column(study, field)) >= set(given[field])
    assert (field in study.axes) == (len(given[field]) > 1)
    assert len(set(study.runs)) == len(study.runs) == len({run.digest for run in study.runs}) + same_physics(study)


def same_physics(study: Study[Any]) -> int:
    """Runs that share a name with another: without damping its kind is no matter."""
    if set(study.axes) & set(UNNAMED):
        return len(study.runs) // 2
    return sum(getattr(run, "damping_kind", "") == "objective" and not run.damping for run in study.runs)


@pytest.mark.parametrize(("case", "field"), EVERY)
def test_a_file_asks_for_what_options_ask_for(case: str, field: str, here: str) -> None:
    given = asked(case, field, here)
    by_option = build(Asked(case, given), "verify", "t")
    by_file = study_of("t", {"case": case, **toml(given)}, "verify")
    assert by_file.runs == by_option.runs
    assert by_file.plans == by_option.plans
    assert by_file.axes == by_option.axes


def test_a_product_of_axes() -> None:
    study = build(Asked("column", {"cells": (4, 8), "damping": (0.0, 0.05), "ppc": (4,)}), "verify", "t")
    assert [(run.cells, run.damping, run.ppc) for run in study.runs] == [
        (4, 0.0, 4), (4, 0.05, 4), (8, 0.0, 4), (8, 0.05, 4),
    ]  # fmt: skip
    assert study.axes == ("cells", "damping")
    assert study.finish == 4


def test_values_that_nobody_asks_for_are_the_usual() -> None:
    assert column(fixtures.built(), "cells") == list(AXES["cells"])
    assert column(fixtures.built(), "ppc") == list(AXES["ppc"])
    quick = build(Asked("mms", {}, quick=True), "verify", "t")
    assert (column(quick, "cells"), column(quick, "ppc")) == (list(QUICK["cells"]), list(QUICK["ppc"]))
    chosen = build(Asked("mms", {"cells": (64, 8, 8)}, quick=True), "verify", "t")
    assert (column(chosen, "cells"), column(chosen, "ppc")) == ([8, 64], [4])


def test_a_value_at_its_default_is_no_other_run() -> None:
    """One name for one thing: parameters at their defaults, and the solution's own material."""
    plain = fixtures.built(cells=(8, 16), ppc=(4,))
    wordy = fixtures.built(
        cells=(8, 16, 8), ppc=(4, 4), method=("cpdi", "cpdi"), solution=("axis_aligned:phase=0",),
        material=("neo_hookean",), layout=("uniform",),
    )  # fmt: skip
    assert wordy.runs == plain.runs


def test_every_quantity_is_declared_once_in_every_norm() -> None:
    study = fixtures.built(method=("cpdi", "mpm"), cells=(8, 16, 32), ppc=(1, 4))
    named_ = [(plan.run.method, plan.run.ppc, plan.quantity, plan.norm) for plan in study.plans]
    assert named_ == [(m, p, q, n) for m in ("cpdi", "mpm") for p in (1, 4) for q in QUANTITIES for n in NORMS]
    judged = {(plan.run.method, plan.run.ppc, plan.quantity, plan.norm) for plan in study.plans if plan.judged}
    assert judged == {("cpdi", 4, "u", "rms"), ("mpm", 4, "u", "rms")}


# ---- several parts


def test_parts_are_run_together_and_each_run_once() -> None:
    content = tomllib.loads("""
        case = "mms"
        run.ppc = 4
        [[part]]
        sweep.cells = [8, 16]
        [[part]]
        run.method = "gimp"
        sweep.cells = [16, 32]
        [[part]]
        sweep = {cells = [16, 8]}
    """)
    study = study_of("t", content, "verify")
    assert {(run.method, run.cells, run.courant) for run in study.runs} == {
        ("cpdi", 8, 0.4), ("cpdi", 16, 0.4), ("cpdi", 16, 0.2), ("gimp", 16, 0.4), ("gimp", 32, 0.4),
    }  # fmt: skip
    assert len(study.runs) == 5
    assert len(study.plans) == 2 * len(QUANTITIES) * len(NORMS)
    assert [plan.run.method for plan in study.plans][:: len(QUANTITIES) * len(NORMS)] == ["cpdi", "gimp"]
    assert study.axes == ("method", "cells", "courant")
    assert study.finish == 5


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("part = 3", r"part must be tables, \[\[part\]\] each"),
        ("part = []", r"part must be tables, \[\[part\]\] each"),
        ("[[part]]\ntitle = 'a'", r"\[\[part\]\] has 'title', and may have run, sweep"),
        ("[[part]]\nrun.ppc = 4\nsweep.ppc = [4]", r"ppc must stand in \[run\] or in \[sweep\], not in both"),
        ("[run]\nppc = 4\n[[part]]\nsweep.ppc = [4, 9]", "not in both"),
        ("[[part]]\n[[part]]\nrun.ppc = 5", "5 particles per cell is not a square number"),
        ("finish = 2\n[[part]]\nrun.ppc = 4", "finish = 2 must be a whole number from 0 to the 1 runs there are"),
    ],
)
def test_parts_that_cannot_be(text: str, says: str) -> None:
    with pytest.raises(ValueError, match=says) as told:
        study_of("t", tomllib.loads(text), "verify")
    assert "\n" not in str(told.value)


def test_the_first_of_two_plans_of_one_quantity_is_kept() -> None:
    first, second = (Asked("mms", {"cells": cells, "ppc": (4,)}) for cells in ((8, 16), (16, 32)))
    study = union([first, second], "verify")
    assert len(study.plans) == len(QUANTITIES) * len(NORMS)
    assert {plan.run.cells for plan in study.plans} == {8}
    assert {run.cells for run in study.runs} == {8, 16, 32}


# ---- names


@pytest.mark.parametrize(
    ("of", "name"),
    [
        (Asked("mms", {}), "mms-cpdi"),
        (Asked("mms", {"method": ("mpm", "cpdi")}), "mms-mpm-cpdi"),
        (Asked("mms", {"method": ("cpdi",), "cells": AXES["cells"]}), "mms-cpdi"),
        (Asked("mms", {"solution": ("bar",), "cells": (8, 16)}), "mms-cpdi-bar-cells-8-16"),
        (Asked("mms", {"courant": (0.4, 0.2)}, 3), "mms-cpdi-courant-0.4-0.2-replicates-3"),
        (Asked("mms", {"offset": ((0.25, 0.125),)}), "mms-cpdi-offset-0.25-0.125"),
        (Asked("mms", {"staggered": (False,)}), "mms-cpdi-staggered-False"),
        (Asked("mms", {}, quick=True), "mms-cpdi-quick"),
        (Asked("mms", {"cells": (8,)}, quick=True), "mms-cpdi-cells-8"),
        (Asked("column", {}), "column"),
        (Asked("column", {"method": ("cpdi",), "ppc": (9,)}), "column"),
        (Asked("column", {"method": ("mpm",), "ppc": (4, 9)}), "column-mpm-ppc-4-9"),
        (Asked("objectivity", {"cells": (16,)}), "objectivity-cells-16"),
    ],
)
def test_a_study_is_named_by_what_is_not_as_usual(of: Asked, name: str) -> None:
    assert named(of) == name


def test_names_are_those_of_folders() -> None:
    odd = named(Asked("mms", {"solution": ("../own file.py:A=0.1,B=2",), "cells": range(2, 200)}))
    assert len(odd) <= 120
    assert set(odd) <= set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-")
    assert fixtures.built(cells=(8,), ppc=(4,)).name == "t"
    assert build(Asked("mms", {"cells": (8,), "ppc": (4,)}), "verify").name == "mms-cpdi-cells-8-ppc-4"


@pytest.mark.parametrize(("case", "field"), [pair for pair in EVERY if pair[1] not in ("path", "units", "motion")])
def test_another_value_is_another_folder(case: str, field: str, here: str) -> None:
    """Names by every field: one value after the other, and both, have different names."""
    both = asked(case, field, here)[field]
    names = [named(Asked(case, {field: chosen})) for chosen in ([both[0]], [both[-1]], both)]
    assert len(set(names)) == min(3, 1 + len(both[1:]) * 2)


# ---- what cannot be


@pytest.mark.parametrize(
    ("case", "given", "says"),
    [
        ("mms", {"particles": (4,)}, "mms has no axis 'particles'; it has method, solution, material, cells"),
        (
            "column",
            {"solution": ("bar",)},
            "column has no axis 'solution' (did you mean duration?); it has ",
        ),
        ("mms", {"offset": ((2.0, 2.0),)}, "offset = (2.0, 2.0) shifts particles by fractions of their spacing"),
        ("detect", {"method": ("nope",)}, "no method 'nope'; choose from bspline2"),
        ("beam", {}, "no case 'beam'; choose from any_code, bench, benchmark, box, column, detect, element, exact, "),
        ("mms", {"cells": (8, 1)}, "cells = 1 cannot be run; choose whole numbers from 2 to 4096"),
        ("mms", {"cells": ("8",)}, "cells = '8' must be a whole number"),
        ("mms", {"cells": (True,)}, "cells = True must be a whole number"),
        ("mms", {"staggered": (1,)}, "staggered = 1 must be true or false"),
        ("mms", {"ppc": (5,)}, "5 particles per cell is not a square number; choose from 1, 4, 9, 16"),
        ("mms", {"courant": (0.2, 0.4)}, "courant = 0.4 is above the first, 0.2; begin with the largest: 0.4,0.2,0.1"),
        ("mms", {"courant": (0.4, 1e-9)}, "courant = 1e-09 cannot be run; choose 0.001 to 10"),
        ("mms", {"offset": ((0.0, 0.0), (0.1, 0.0))}, "offset takes one value in a refinement"),
        ("mms", {"offset": ((0.1,),)}, "offset = (0.1,) must be 2 numbers, such as (0.0, 0.0)"),
        ("mms", {"courant": ("fast",)}, "courant = 'fast' must be a number, such as 0.4"),
        ("column", {"mu": (0.3,)}, "mu = 0.3 has no frictional floor or wall; add --floor frictional, or"),
        ("column", {"mu": (0.47,), "floor": ("roller",)}, "mu = 0.47 has no frictional floor or wall; add --floor"),
        ("column", {"damping_kind": ("objective",)}, "has no damping; add --damping 0.05, or leave --damping-kind out"),
        ("column", {"damping_kind": ("local",), "damping": (0.0,)}, "has no damping; add --damping 0.05"),
        ("mms", {"stress": ("late",)}, "late"),
        ("mms", {"method": ("fem",)}, "no method 'fem'; choose from"),
        ("mms", {"solution": ("swril",)}, "no solution 'swril' (did you mean swirl?); choose from"),
        ("mms", {"material": ("mohr_coulomb",)}, "energy"),
        ("mms", {"transfer": ("flop",)}, "no transfer 'flop' (did you mean flip?); choose from"),
        ("column", {"aspect": (6.5001,)}, "must make whole cells"),
        ("element", {"test": ("triaxial",)}, "no test 'triaxial'; choose from isotropic"),
        ("element", {"path": ("a.csv",)}, "path = FILE.csv and test = path belong together"),
        ("objectivity", {"cells": (2,)}, "2 cells along the block must be from 4 to 128"),
        ("wave_bar", {"ppc": (3,)}, "3 particles per cell is not a square number"),
    ],
)
def test_one_line_says_what_is_wrong(case: str, given: dict[str, Sequence[Any]], says: str) -> None:
    with pytest.raises(ValueError, match=re.escape(says)) as told:
        build(Asked(case, given), "verify", "t")
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("count", [0, -1, 65])
def test_replicates_that_cannot_be(count: int) -> None:
    with pytest.raises(ValueError, match=f"replicates = {count} cannot be run; choose whole numbers from 1 to 64"):
        build(Asked("mms", {"cells": (8,)}, count), "verify")


@pytest.mark.parametrize("finish", [True, -1, 3, 1.0, "all"])
def test_finish_counts_runs(finish: Any) -> None:
    with pytest.raises(ValueError, match="must be a whole number from 0 to the 2 runs there are"):
        build(Asked("column", {"ppc": (4, 9), "cells": (4,)}), "verify", finish=finish)
    assert build(Asked("column", {"ppc": (4, 9), "cells": (4,)}), "verify", finish=0).finish == 0


def test_the_courant_numbers_after_the_first_are_of_the_finest_cells() -> None:
    study = fixtures.built(cells=(8, 16, 32), ppc=(1,), courant=(0.4, 0.2, 0.1, 0.05))
    found = {cells: [run.courant for run in study.runs if run.cells == cells] for cells in (8, 16, 32)}
    assert found == {8: [0.4], 16: [0.4], 32: [0.4, 0.2, 0.1, 0.05]}
    assert all(a > b for a, b in pairwise(found[32]))


# ---- the command that runs a file


def swept(folder: Path, monkeypatch: pytest.MonkeyPatch, *words: str) -> int:
    """Exit code of `verify sweep` on a file with two small columns."""
    text = "finish = 0\n[run]\ncells = 4\nppc = 4\nduration = 0.02\n[sweep]\nvoid = [true, false]"
    (folder / "two.toml").write_text(text)
    monkeypatch.setattr("sys.argv", ["verify", "sweep", str(folder / "two.toml"), "--out", str(folder / "out"), *words])
    with pytest.raises(SystemExit) as ended:
        main()
    return int(str(ended.value.code))


def test_a_dry_run_of_a_file_runs_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert swept(tmp_path, monkeypatch, "--dry-run") == 0
    assert capsys.readouterr().out.count("to do  ") == 2
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "made"),
    [
        (["--yes", "--no-page"], set()),
        pytest.param(["--yes"], {"report.html"}, marks=pytest.mark.slow),  # eight seconds each, for the page
        pytest.param(["--vtk"], {"report.html", "vtk"}, marks=pytest.mark.slow),
    ],
    ids=["yes", "page", "vtk"],
)
def test_options_of_a_file_are_what_they_say(
    words: list[str], made: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert swept(tmp_path, monkeypatch, *words, "--jobs", "1") == 0
    assert len(list((tmp_path / "out" / "runs").glob("*.json"))) == 2
    assert {name for name in ("report.html", "vtk") if (tmp_path / "out" / name).exists()} == made
