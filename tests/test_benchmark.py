"""Benchmarks: closed forms, each problem with a magnitude, a rate and an invariant, and that each control fails."""

import json
from dataclasses import asdict, replace
from functools import cache
from math import log2
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import jsonschema
import mpmath as mp
import numpy as np
import pytest

from mpm_verify.cases.benchmark import case
from mpm_verify.cases.benchmark.case import canonical
from mpm_verify.cases.benchmark.execute import execute
from mpm_verify.cases.benchmark.exported import exported
from mpm_verify.cases.benchmark.problem import Held, completed
from mpm_verify.cases.benchmark.problems.cell_crossing import GRADIENTS, formula
from mpm_verify.cases.benchmark.problems.self_weight import SelfWeight
from mpm_verify.cases.benchmark.run import Result, Run
from mpm_verify.cases.benchmark.uniaxial import nominal, stretch
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.judging.records import Reason, ReasonCode
from mpm_verify.cases.judging.richardson import extrapolate
from mpm_verify.reports.export.benchmark_folder import schema as benchmark_schema
from mpm_verify.reports.export.benchmark_folder import words as folder_words
from mpm_verify.reports.export.case_folder import read
from mpm_verify.reports.export.document import schema
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.benchmark import control
from mpm_verify.reports.sentences.verdicts import shown
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.plugins import MATERIALS, METHODS, PROBLEMS, available, create
from mpm_verify.solver.state import Particles
from mpm_verify.verify.main import main
from mpm_verify.verify.terminal.checks import sentence

SHORT = (  # file of a problem of one's own
    '"""Short column: that of the benchmarks, lower."""\nfrom dataclasses import dataclass\n'
    "from mpm_verify.cases.benchmark.problems.self_weight import SelfWeight\n\n\n"
    "@dataclass(frozen=True)\nclass ShortColumn(SelfWeight):\n    H: float = 5.0\n"
)
SOLIDS = {"hencky": "hencky:E=1e4,nu=0,rho0=80", "neo_hookean": "neo_hookean:E=1e4,nu=0,rho0=80"}
KNOWN = {"hencky": (0.30370, 24.233), "neo_hookean": (0.12542, 16.362)}


@pytest.fixture(autouse=True)
def one_thread() -> None:
    use_threads(1)


@cache
def ran(problem: str, **axes: Any) -> Result:
    return execute(Run(**canonical({"problem": problem, **axes})))[0]


def outcomes(problem: str, store: Path, **axes: Any) -> set[str]:
    """Outcomes of the checks of a study."""
    benchmark, asked = (
        case_named("benchmark"),
        {
            "problem": (problem,),
            **{key: value if isinstance(value, tuple) else (value,) for key, value in axes.items()},
        },
    )
    study = build(Asked("benchmark", asked), "")
    results = {run.digest: execute(run)[0] for run in study.runs}
    assert benchmark.examine is not None
    return {str(check.outcome) for check in benchmark.examine(study, results, Store(store, "benchmark")).checks}


@pytest.mark.parametrize("name", list(SOLIDS))
def test_the_column_at_rest_has_its_closed_form(name: str) -> None:
    """Stretch and height by another way, in 30 digits, and as they are quoted."""
    problem, material = SelfWeight(), create(MATERIALS, SOLIDS[name])
    q = mp.mpf(80) * mp.mpf("9.81") * 50 / 10000
    if name == "hencky":
        w = mp.lambertw(q)
        base, height = w / q, 50 * (w + w**2 / 2) / q
    else:
        base = mp.sqrt(q**2 + 1) - q
        height = 50 * mp.quad(lambda s: mp.sqrt(s**2 + 1) - s, [0, q]) / q
    found = stretch(material, problem.stress(material, 0.0)), problem.rest(material, np.array([50.0]))[0]
    assert found == (pytest.approx(float(base.real), rel=1e-12), pytest.approx(float(mp.re(height)), rel=1e-12))
    assert found == (pytest.approx(KNOWN[name][0], abs=5e-6), pytest.approx(KNOWN[name][1], abs=5e-4))


@pytest.mark.parametrize("specification", ["hencky:nu=0.3", "neo_hookean:nu=0.2"])
def test_the_nominal_stress_is_that_of_the_kernel(specification: str) -> None:
    material = create(MATERIALS, specification)
    p = Particles(np.zeros((1, 2)), np.ones(1), np.ones(1), np.zeros((1, 0)))
    p.F[0, 1, 1] = 0.4
    material.start(p)
    material.update(p, 1.0)
    assert nominal(material, 0.4) == pytest.approx(p.sigma[0, 1], rel=1e-12)
    with pytest.raises(ValueError, match="bears no stress"):
        stretch(material, 1.0)


def test_the_stress_of_a_column_belongs_to_its_cells() -> None:
    """Cells have it to round-off; of particles it is off by a quarter of a cell, exactly: an order that is none."""
    for method, cells in (("cpdi", 8), ("tlmpm", 4), ("tlmpm", 8)):
        found = ran("self_weight", method=method, cells=cells)
        assert found.errors["sigma"]["cells"] < 1e-9 * 80 * 9.81 * 50
        assert found.values["base_force"] == pytest.approx(1, abs=1e-9)
        quarter = 80 * 9.81 * 50 / cells / 4
        assert method != "tlmpm" or found.errors["sigma"]["particles"] == pytest.approx(quarter, rel=1e-9)


def test_the_position_of_a_column_is_of_second_order() -> None:
    coarse, fine = (ran("self_weight", method="tlmpm", cells=n).errors["u"]["rms"] for n in (4, 8))
    assert fine == pytest.approx(4.053e-2, rel=1e-3)
    assert 1.6 < log2(coarse / fine) < 2


def test_a_column_rests_where_it_does_with_half_the_time_step() -> None:
    """Where it comes to rest is told by its way: raised fast it swings, and its error depends on the time step."""

    def change(method: str, problem: str = "self_weight") -> float:
        usual, half = (
            execute(Run(**canonical({"problem": problem, "method": method, "cells": 12, "courant": courant})))[0]
            for courant in (0.4, 0.2)
        )
        return abs(half.errors["u"]["rms"] / usual.errors["u"]["rms"] - 1)

    assert change("cpdi") < 0.02
    assert change("tlmpm") < 1e-5  # on nodes that never change, there is one state at rest
    assert change("cpdi", "self_weight:ramp=2") > 0.05


def test_domains_of_fixed_size_do_not_bear_a_column() -> None:
    found = ran("self_weight", method="gimp", cells=8)
    assert found.errors["sigma"]["cells"] > 100
    assert found.errors["u"]["rms"] > 5 * ran("self_weight", method="cpdi", cells=8).errors["u"]["rms"]


@pytest.mark.parametrize(("method", "peak"), [("mpm", 0.55), ("gimp", 0.055), ("bspline2", 0.05386)])
def test_the_spurious_force_is_that_of_the_formula(method: str, peak: float) -> None:
    found = ran("cell_crossing", method=method, cells=20).values
    assert found["spurious_force"] == pytest.approx(peak, rel=1e-3)
    assert found["off_formula"] < 1e-12


@pytest.mark.parametrize("method", ["cpdi", "cpdi2", "cpgimp"])
@pytest.mark.parametrize("ppc", [1, 4, 9])
def test_domains_that_tile_have_none(method: str, ppc: int) -> None:
    assert ran("cell_crossing", method=method, cells=20, ppc=ppc).values["spurious_force"] < 1e-13


def test_the_formula_vanishes_where_particles_fill_cells_alike() -> None:
    positions = np.linspace(0.01, 0.49, 7)
    for gradient in GRADIENTS.values():
        assert np.abs(formula(gradient, 0.5, 1.0, positions)).max() < 1e-14
    assert set(np.abs(formula(GRADIENTS["mpm"], 0.55, 1.1, positions)).round(12)) == {0.0, 0.55}


@pytest.mark.parametrize(("method", "distance"), [("mpm", 1.5), ("cpdi", 2.0), ("bspline2", 2.5), ("bspline3", 3.5)])
def test_bars_touch_at_the_reach_of_their_weights(method: str, distance: float) -> None:
    """Distance of contact that does not fall in cells, and momentum is kept to round-off."""
    for cells in (8, 16):
        found = ran("colliding_bars", method=method, cells=cells).values
        run = Run(**canonical({"problem": "colliding_bars", "method": method, "cells": cells}))
        held = next(held for held in run.stated.held(run) if held.name == "distance")
        assert (held.expected, held.within) == (distance, pytest.approx(0.1 * 0.4, abs=1e-8))  # half of a step
        assert found["distance"] == pytest.approx(distance, abs=held.within)
        assert found["momentum"] < 1e-14


def test_bars_exchange_their_velocities() -> None:
    coarse, fine = (ran("colliding_bars", cells=n).values for n in (16, 32))
    assert coarse["contact_time"] == pytest.approx(1.0356, abs=1e-3)
    assert abs(fine["contact_time"] - 1) < 0.3 * abs(coarse["contact_time"] - 1)
    assert 0.9 < coarse["stress"] < fine["stress"] < 1
    assert 0.97 < coarse["exit_velocity"] < fine["exit_velocity"] < 1


@pytest.mark.parametrize(
    ("problem", "cells"),
    [("self_weight", 8), ("cell_crossing", 20), ("colliding_bars", (8, 16, 32))],
    ids=lambda one: str(one),
)
def test_the_control_fails(problem: str, cells: int | tuple[int, ...], tmp_path: Path) -> None:
    """Controls: of the column the force and stress of each cell, of a bar what a spoilt stress or mass changes."""
    assert "FAIL" in outcomes(problem, tmp_path, cells=cells, method="cpdi", control=True)


def test_a_limit_is_held_and_not_the_finest_value() -> None:
    runs = build(
        Asked("benchmark", {"problem": ("colliding_bars",), "method": ("cpdi",), "cells": (8, 16, 32)}), ""
    ).runs
    empty = {run.digest: replace(ran("cell_crossing"), run=run, values={"a": 1 + 1 / run.cells**2}) for run in runs}
    series = case.collect(runs)[0]
    held = Held("a", 1.0, "absolute", "", 1e-9)
    (found,) = case.checks(held, series, empty)
    assert (found.name, str(found.outcome)) == ("a, limit", "PASS")
    (found,) = case.checks(replace(held, of="finest"), series, empty)
    assert str(found.outcome) == "FAIL"
    assert len(case.checks(replace(held, of="each"), series, empty)) == 3
    both = case.checks(replace(held, of="each", within=1.0, limit=1e-9), series, empty)
    assert [(one.name, str(one.outcome)) for one in both[2:]] == [("a, 32 cells", "PASS"), ("a, limit", "PASS")]
    wrong = case.checks(replace(held, of="each", expected=1.1, within=1.0, limit=0.01), series, empty)
    assert [str(one.outcome) for one in wrong] == ["PASS"] * 3 + ["FAIL"]
    assert len(case.checks(replace(held, of="each", limit=1e-9), case.collect(runs[:2])[0], empty)) == 2


@pytest.mark.slow
def test_a_block_that_slides_has_the_limit_of_an_elastic_one() -> None:
    """Half of its excess, which goes with the time of a wave, is left with four times E, none of a rigid block."""

    def limit(problem: str) -> float:
        found = [ran(problem, method="cpdi", cells=cells).values["travel"] for cells in (16, 8, 4)]
        return extrapolate((1 / 16, 1 / 8, 1 / 4), found).limit

    soft, stiff = limit("sliding_block"), limit("sliding_block:E=4e7")
    assert (soft, stiff) == (pytest.approx(1.00812, abs=2e-4), pytest.approx(1.00410, abs=2e-4))
    assert 2 * stiff - soft == pytest.approx(1, abs=3e-4)


@pytest.mark.slow
def test_a_column_that_is_pressed_to_an_eighth_needs_its_gravity_more_slowly() -> None:
    """Raised over 8 periods, as usual, the error of 32 cells is 12 % off, whatever the time step; over 16 it is not."""
    found = {
        ramp: [
            ran(f"self_weight:ramp={ramp}", method="cpdi", material="neo_hookean", cells=n).errors["u"]["rms"]
            for n in (16, 32)
        ]
        for ramp in (8, 16)
    }
    assert found[8] == pytest.approx([6.194e-3, 1.231e-3], rel=1e-2)
    assert found[16] == pytest.approx([5.916e-3, 1.394e-3], rel=1e-2)
    orders = {ramp: log2(coarse / fine) for ramp, (coarse, fine) in found.items()}
    assert orders == {8: pytest.approx(2.33, abs=0.03), 16: pytest.approx(2.09, abs=0.03)}


def test_nothing_is_judged_by_a_limit_of_two_grids() -> None:
    runs = build(Asked("benchmark", {"problem": ("colliding_bars",), "method": ("cpdi",), "cells": (8, 16)}), "").runs
    empty = {run.digest: replace(ran("cell_crossing"), run=run, values={"a": 1.0}) for run in runs}
    held = Held("a", 1.0, "absolute", "", 1e-9)
    (found,) = case.checks(held, case.collect(runs)[0], empty)
    assert (found.name, str(found.outcome), found.unjudged) == ("a, 16 cells", "INCONCLUSIVE", "few_grids")
    assert "a limit takes three grids" in sentence(found)
    (found,) = case.checks(replace(held, of="finest"), case.collect(runs)[0], empty)
    assert str(found.outcome) == "PASS"


@pytest.mark.parametrize("code", [ReasonCode.DIVERGES, ReasonCode.CONVERGES, ReasonCode.NEITHER])
def test_of_what_is_only_shown_nothing_was_expected(code: ReasonCode) -> None:
    reason = Reason(code, {"h_0": 0.125, "error_0": 1.0, "h_1": 0.0625, "error_1": 2.0, "order": 1.0})
    found = shown(reason)
    assert found.startswith("nothing is registered of it: the error ")
    assert "expected" not in found
    assert "surprise" not in found


def test_nothing_is_judged_of_a_column_that_moves() -> None:
    runs = build(Asked("benchmark", {"problem": ("self_weight",), "method": ("cpdi",), "cells": (8, 12, 16)}), "").runs
    held = Held("a", 1.0, "absolute", "", 1e-9, rests=True)
    for at_rest, outcome in ((1.0, "FAIL"), (0.0, "INCONCLUSIVE")):
        some = {
            run.digest: replace(
                ran("cell_crossing"), run=run, values={"a": 2.0, "at_rest": at_rest if run.cells == 12 else 1.0}
            )
            for run in runs
        }
        assert [str(one.outcome) for one in case.checks(held, case.collect(runs)[0], some)] == [outcome]
        each = case.checks(replace(held, of="each"), case.collect(runs)[0], some)
        assert [str(one.outcome) for one in each] == ["FAIL", outcome, "FAIL"]
    assert ran("self_weight", method="tlmpm", cells=4).values["at_rest"] == 1


def test_a_material_is_completed_by_the_problem() -> None:
    assert completed("hencky:E=1", {"E": 2.0, "nu": 0.0, "phi": 3.0}) == "hencky:E=1,nu=0"
    named = canonical({"problem": "self_weight:E=2e4,H=10", "material": "neo_hookean"})
    assert named["material"] == "neo_hookean:E=20000,nu=0,rho0=80"
    assert Run(**named).digest != Run(**canonical({"problem": "self_weight"})).digest


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["selfweight"], "did you mean self_weight?"),
        (["self_weight", "--material", "mohr_coulomb"], "needs a material with an energy"),
        (["colliding_bars", "--method", "tlmpm"], "never meet"),
        (["cell_crossing", "--cells", "8"], "take 12 or more"),
        (["colliding_bars:speed=2"], "at most 0.3"),
        (["colliding_bars", "--material", "hencky"], "closed form is that of linear_elastic alone"),
        (["sliding_block", "--material", "mohr_coulomb"], "does not keep the stress"),
        (["self_weight:E=1e300"], "round-off of so stiff a material"),
        (["colliding_bars", "--offset", "0.5,0.5"], "above -0.5 and below 0.5"),
    ],
)
def test_what_cannot_be_is_one_line(
    arguments: list[str], says: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["verify", "benchmark", *arguments, "--dry-run"])
    with pytest.raises(SystemExit) as ended:
        main()
    text = capsys.readouterr().err
    assert ended.value.code == 2
    assert says in text
    assert text.count("\n") == 1


def test_the_command_judges_and_its_control_fails(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for more, code in (([], 0), (["--control"], 1)):
        command = ["verify", "benchmark", "cell_crossing", "--method", "mpm,cpdi", "--json", "--out", str(tmp_path)]
        monkeypatch.setattr("sys.argv", [*command, *more])
        with pytest.raises(SystemExit) as ended:
            main()
        document = json.loads(capsys.readouterr().out)
        jsonschema.validate(document, schema("benchmark"))
        assert ended.value.code == code == document["exit_code"]


@pytest.mark.parametrize(
    ("found", "says"),
    [
        ((2.0, 1.0, 2.0), "The failing control failed, as it must: 2 of 3 refused."),
        ((1.0, 1.0), "ALARM: a control that must fail passed"),
        ((1.0, np.nan), "is undecided, or ended in an error"),
    ],
)
def test_a_control_that_passes_is_the_alarm(found: tuple[float, ...], says: str) -> None:
    run = Run(control=True)
    some = tuple(Check(case.part(run), "a", one, 1.0, "absolute", "", 0.1) for one in found)
    record: Any = SimpleNamespace(study=SimpleNamespace(runs=[run]), findings=(), analysis=SimpleNamespace(checks=some))
    assert says in control(record)
    record.study.runs = [Run()]
    assert control(record) == ""


def test_parts_of_checks_tell_apart_what_a_study_varies() -> None:
    """Each refinement has a part of its own, which says in what it is not as the problem has it."""
    axes = {"material": ("hencky", "hencky:E=2e4", "neo_hookean"), "transfer": ("flip", "apic"), "ppc": (4, 9),
            "smoothing": ("none", "volumetric"), "method": ("cpdi", "tlmpm")}  # fmt: skip
    runs = build(Asked("benchmark", {"problem": ("self_weight",), **axes}, quick=True), "").runs
    told = {case.part(series.first) for series in case.collect(runs)}
    assert len(told) == 48
    assert {"self_weight, cpdi", "self_weight, tlmpm, neo_hookean, 9 per cell, apic"} <= told
    assert "self_weight, cpdi volumetric, E=20000" in told
    assert case.part(replace(runs[0], offset=(0.25, 0.0), courant=0.2)).endswith("courant 0.2, offset 0.25,0")


def test_a_label_leaves_out_what_goes_with_the_problem(tmp_path: Path) -> None:
    for materials, told in (((), "CPDI, 4 per cell, problem self_weight"), (("hencky", "neo_hookean"), "material")):
        more = {"material": materials} if materials else {"problem": ("self_weight", "cell_crossing")}
        study = build(Asked("benchmark", {"problem": ("self_weight",), "method": ("cpdi",), **more}, quick=True), "")
        record = Record(Store(tmp_path, "benchmark"), study, {}, False)
        assert told in record.label(study.runs[0])
        assert ("material" in record.label(study.runs[0])) is bool(materials)


def test_a_page_states_each_problem(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["verify", "benchmark", "cell_crossing", "--page", "--out", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        main()
    text = (tmp_path / "report.html").read_text()
    assert ended.value.code == 0
    assert "spurious force inside a uniformly stressed bar" in text
    assert "7 of 7 checks pass." in text
    assert (tmp_path / "figures" / "cell_crossing_force.svg").is_file()


def test_a_problem_of_ones_own_is_a_file(tmp_path: Path) -> None:
    own = tmp_path / "short_column.py"
    own.write_text(SHORT)
    run = Run(**canonical({"problem": str(own), "cells": 4}))
    found = execute(run)[0]
    assert found.values["cell_stress"] < 1e-8 * 80 * 9.81 * 5
    assert run.digest != Run(**canonical({"problem": "self_weight:H=5", "cells": 4})).digest


PURE = {
    "parameters": ("nu", "damping", "mu", "rough", "settlement", "transits", "stretch", "ramp"),
    "material": ("name", "sigma", "nu", "void"),
}


def test_an_exported_benchmark_says_what_is_not_judged_here() -> None:
    """Codes of the reasons are those of the checks here, and the words say them."""
    usual = exported("rankine", None, 16, None, 0.4)
    steep = exported("rankine", "mohr_coulomb:phi=50", 16, None, 0.4)
    for made, why in ((usual, ""), (steep, "not_usual")):
        assert {one.name: one.unjudged for one in made.record.known if one.name in ("Kp", "Ka")} == {
            "Kp": why,
            "Ka": why,
        }
    said = folder_words(steep, create(PROBLEMS, "rankine"))
    assert said.count("; not judged: how near it comes was measured at the usual parameters |") == 2
    assert "; not judged:" not in folder_words(usual, create(PROBLEMS, "rankine"))
    block = exported("sliding_block", None, 16, None, 0.4)
    assert "; the limit of refinement within 0.0" in folder_words(block, create(PROBLEMS, "sliding_block"))
    column = exported("self_weight", None, 16, None, 0.4)
    assert {one.name: (one.unit, one.rests) for one in column.record.known} == {
        "height": ("m", True), "base_stretch": ("", True), "base_force": ("", True), "cell_stress": ("Pa", True)
    }  # fmt: skip


@pytest.mark.parametrize("problem", available(PROBLEMS))
def test_every_problem_is_exported(
    problem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for more, code in (([], 0), ([], 0), (["--frames", "3"], 2)):  # a folder of a benchmark is written over
        cells = "17" if problem == "footing" else "16"  # which is odd: an edge lies in the middle of a cell
        monkeypatch.setattr("sys.argv", ["verify", "export", problem, "--cells", cells, "--to", str(tmp_path), *more])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == code
    case = json.loads((tmp_path / "case.json").read_text())
    table = np.genfromtxt(tmp_path / "particles.csv", delimiter=",", names=True)
    assert len(table) == case["particles"]
    area = 4 * (table["r1x"] * table["r2y"] - table["r1y"] * table["r2x"])
    assert area == pytest.approx(table["V0"], rel=1e-12)
    assert case["known"]
    stated = Run(**canonical({"problem": problem, "cells": int(cells)}))
    told = [{key: asdict(held)[key] for key in case["known"][0]} for held in stated.stated.held(stated)]
    assert set(case["known"][0]) >= {"name", "expected", "way", "within", "of", "least", "source"}
    assert case["known"] == told  # each of them, two bounds of one number too
    jsonschema.validate(case, benchmark_schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**case, "known": [{**told[0], "unjudged": "nobody_knows"}]}, benchmark_schema())
    readme = (tmp_path / "README.md").read_text()
    assert f"cells of side {case['dx']} m from" in readme
    assert sum(f"| {one['name']} |" in line for line in readme.splitlines() for one in told) >= len(told)
    assert {edge["kind"] for edge in case["edges"].values()} <= {"free", "roller", "fixed", "frictional", "pushed"}
    flat = dict(line.split(" ", 1) for line in (tmp_path / "case.txt").read_text().splitlines())
    assert float(flat["dx"]) == case["dx"]
    assert [flat[f"known_{k}_name"] for k in range(1, len(told) + 1)] == [one["name"] for one in told]
    assert flat["units_dx"] == "m"
    pure = {name for name, _ in flat.items() if name.startswith(("parameters_", "material_"))} - {
        name.removeprefix("units_") for name in flat
    }  # ratios, exponents, flags and words
    assert pure <= {f"{part}_{name}" for part, names in PURE.items() for name in names}
    with pytest.raises(ValueError, match="holds a benchmark, which has no body-force sources to check"):
        read(tmp_path)


def test_a_problem_of_ones_own_is_exported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "short_column.py"
    own.write_text(SHORT)
    monkeypatch.setattr("sys.argv", ["verify", "export", str(own), "--cells", "4", "--to", str(tmp_path / "case")])
    with pytest.raises(SystemExit) as ended:
        main()
    table = np.genfromtxt(tmp_path / "case" / "particles.csv", delimiter=",", names=True)
    assert ended.value.code == 0
    assert table["V0"].sum() == pytest.approx(5.0 * 1.25)


def test_an_exported_column_says_where_it_rests() -> None:
    found = exported("self_weight", None, 16, None, 0.4)
    assert {side: edge.kind for side, edge in found.record.edges.items()} == {
        "left": "roller", "right": "roller", "bottom": "roller", "top": "free"
    }  # fmt: skip
    assert found.record.gravity == (0.0, -9.81)
    assert found.known["syy"] == pytest.approx(-80 * 9.81 * (50 - found.particles["Y"]))
    assert 0 < found.known["y"].min() < found.known["y"].max() < 24.233


@pytest.mark.parametrize("problem", available(PROBLEMS))
@pytest.mark.parametrize("method", available(METHODS))
def test_every_problem_says_what_is_known_of_every_method(problem: str, method: str) -> None:
    run = Run(**canonical({"problem": problem, "method": method}))
    stated = run.stated
    assert stated.source
    assert all(held.source for held in stated.held(run))
    for quantity, norm in stated.measures(run):
        expected = stated.expectation(run, quantity, norm)
        assert expected is None or expected.source


@pytest.mark.slow
@pytest.mark.parametrize("problem", available(PROBLEMS))
def test_the_usual_study_passes(problem: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["verify", "benchmark", problem, "--no-page", "--out", str(tmp_path)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 0
