"""The registry: nothing the library ships is without an expectation, and none is applied where it does not hold."""

from pathlib import Path

import fixtures_study as fixtures
import pytest
from typer.testing import CliRunner

from mpm_verify.cases.mms.deviations import DEVIATIONS, SHOWN, SMALL_AMPLITUDE
from mpm_verify.cases.mms.expectations import (
    JUDGED_PPC,
    STALL,
    crosses,
    expected,
    later_with_9,
    registered,
    registry,
)
from mpm_verify.cases.mms.methods import LEVELS, QUICK, build_methods, every_method
from mpm_verify.cases.mms.run import QUANTITIES
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.plugins import MATERIALS, METHODS, SOLUTIONS, available, canonical, create, load
from mpm_verify.verify.main import application

STORED = Path(__file__).with_name("expectations.txt")
OWN = str(Path(__file__).with_name("own_solution.py"))
LAW = "neo_hookean"


def of(method: str, solution: str, quantity: str = "u", ppc: int = 4, material: str = "", norm: str = "rms"):
    """The expectation as a study asks for it, with canonical names."""
    spec = canonical(SOLUTIONS, solution)
    law = canonical(MATERIALS, material or create(SOLUTIONS, solution).material)
    return expected(method, spec, law, ppc, quantity, norm)


@pytest.mark.parametrize("solution", available(SOLUTIONS))
@pytest.mark.parametrize("method", available(METHODS))
def test_everything_shipped_is_registered_with_its_source(method: str, solution: str) -> None:
    if method not in SHOWN or solution not in DEVIATIONS:
        pytest.skip(f"register what {method} does on {solution}: cases/mms/deviations.py")
    for quantity in QUANTITIES:
        for ppc in JUDGED_PPC:
            found = of(method, solution, quantity, ppc)
            if ppc == 9 and later_with_9(method, solution, registered(solution, method, quantity)):
                assert found is None
                continue
            assert found is not None
            assert found.source


def test_the_registry_names_nothing_else() -> None:
    assert set(DEVIATIONS) <= {*available(SOLUTIONS), SMALL_AMPLITUDE}
    assert set(SHOWN) <= set(available(METHODS))
    assert all(set(methods) <= set(SHOWN) for methods in DEVIATIONS.values())
    entries = [entry for entry in registry() if entry.method in SHOWN]
    assert len(entries) == len(DEVIATIONS) * len(SHOWN) * len(QUANTITIES)


def test_what_is_registered_is_what_was() -> None:
    """A line each: solution, method, quantity, what is expected, the band in all digits, the source."""
    lines = []
    for entry in (entry for entry in registry() if entry.method in SHOWN):
        e = entry.expectation
        band = "-" if e.order is None else f"{e.order - e.below!r} to {e.order + e.above!r}"
        stall = f" from 1/{1 / e.stall_h:g} on" if e.stall_h else ""
        lines.append(f"{entry.solution} {entry.method} {entry.quantity}: {e.kind}{stall} | {band} | {e.source}")
    assert lines == STORED.read_text(encoding="utf-8").splitlines()


def test_nothing_registered_repeats_a_promise() -> None:
    """What stands in the table is another order of u, a number beside it, a stall's cells, or how runs end."""
    for solution, methods in DEVIATIONS.items():
        for method, deviation in methods.items():
            promise = load(METHODS, method).promises(crossing=crosses(solution))
            assert deviation != type(deviation)()
            assert deviation.u is None or deviation.u != promise.order
            assert not (deviation.stalls and deviation.fails)


def test_a_method_without_an_entry_is_expected_to_keep_its_promise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(DEVIATIONS["bar"], "cpdi")
    monkeypatch.delitem(DEVIATIONS["bar"], "gimp")
    assert of("cpdi", "bar").order == 2
    assert of("cpdi", "bar", "v") is None
    assert of("gimp", "bar") is None  # it promises a stall, and on which cells is not known


@pytest.mark.parametrize("solution", ["axis_aligned:A=1e-6", "clamped_shear:G=1e-6", "bump", "bump:L=2"])
@pytest.mark.parametrize("method", available(METHODS))
def test_at_small_amplitude_every_method_is_of_second_order(method: str, solution: str) -> None:
    found = of(method, solution)
    assert found is not None
    assert found.order == 2


def test_kinds() -> None:
    assert of("mpm", "axis_aligned").kind == "diverges"
    assert of("cpdi", "axis_aligned").kind == "order 2"
    known = {round(1 / one.h): one.low for one in of("cpdi", "axis_aligned").recorded}
    assert known[128] == pytest.approx(1.127e-5, rel=5e-4)
    assert (of("gimp", "bar").kind, of("gimp", "bar").stall) == ("stalls", STALL)
    assert of("cpgimp", "generalised_vortex").failed is FailureKind.DOMAIN_TOO_WIDE
    assert of("mpm", "expanding_ring").kind == "failed inverted"
    assert of("cpdi", "clamped_shear", "F").order == pytest.approx(1.65)


def test_where_nothing_is_expected() -> None:
    """Another norm or particle count; stalls with parameters of one's own; a ring whose edges carry traction."""
    assert of("cpdi", "axis_aligned", norm="printed") is None
    assert of("cpdi", "axis_aligned", ppc=1) is None
    assert of("gimp", "axis_aligned:phase=0.5") is None
    assert of("cpdi", "axis_aligned:phase=0.5").order == 2
    assert of("cpdi", "axis_aligned:phase=0.5").recorded == ()
    assert of("cpdi", "expanding_ring", material=LAW) is None
    assert of("cpdi", "axis_aligned", material="linear_elastic") is None
    assert of("mpm", "swirl:A=1e-6") is None  # B is not small
    assert of("mpm", "swirl:A=1e-6,B=1e-6").order == 2
    assert of("mpm", "expanding_ring:A=1e-6") is None  # at a free edge no amplitude is small
    assert of("bspline3", "bar", ppc=9) is None
    assert of("mpm", "bump:A=0.05") is None  # what is registered holds for its small default
    assert of("cpgimp", "bump:A=0.05") is None
    assert (of("cpdi", "bump:A=0.05").order, of("cpdi", "bump:A=0.05", "v")) == (2, None)


def test_an_own_solution_has_the_order_of_its_file(tmp_path: Path) -> None:
    """Its file names none: it is the method's own, where the method keeps it."""
    assert of("cpdi", OWN).source == "declared by the method"
    assert of("cpdi", OWN).order == 2
    assert of("mpm", OWN) is None  # particles cross cells
    declares = tmp_path / "declares.py"
    declares.write_text(Path(OWN).read_text().replace('"speed": 100}', '"speed": 100, "order": 1.5}'))
    assert of("cpdi", str(declares)).order == 1.5
    assert of("cpdi", str(declares), "v") is None


def test_only_u_in_rms_is_judged() -> None:
    study = fixtures.built(cells=(8, 16, 32, 64), ppc=(4,))
    assert [(d.quantity, d.norm) for d in study.plans if d.judged] == [("u", "rms")]
    assert {d.quantity for d in study.plans if d.expectation} == set(QUANTITIES)
    assert [r.courant for r in study.runs].count(0.2) == 1  # half the time step, for what is judged


def test_the_study_of_all_methods_judges_each_on_each_solution() -> None:
    study = build_methods(every_method(), LEVELS, (4,), "verify methods", "methods")
    judged = [(d.run.method, d.run.solution) for d in study.plans if d.judged]
    assert len(judged) == len(set(judged)) == len(available(METHODS)) * len(LEVELS)
    assert len({run.digest for run in study.runs}) == len(study.runs)
    assert all(len(cells) >= 4 for cells in (*LEVELS.values(), *QUICK.values()))


def test_a_comparison_of_two() -> None:
    study = build_methods(("cpdi", "gimp"), {"bar": (8, 16)}, (4,), "verify methods", "two")
    assert {(r.method, r.cells, r.courant) for r in study.runs} == {
        ("cpdi", 8, 0.4), ("cpdi", 16, 0.4), ("gimp", 8, 0.4), ("gimp", 16, 0.4), ("cpdi", 16, 0.2)
    }  # fmt: skip


def test_the_table_and_its_json() -> None:
    import json

    runner, app = CliRunner(), application("expectations")
    text = runner.invoke(app, ["expectations", "--solution", "bar"]).output
    assert "diverges" in text
    assert "2 (1.8\N{EN DASH}2.3)" in text
    entries = json.loads(runner.invoke(app, ["expectations", "--method", "mpm", "--json"]).output)
    assert len(entries) == len(DEVIATIONS) * len(QUANTITIES)
    assert {e["expected"] for e in entries if e["solution"] == "bar"} == {"diverges"}
    refused = runner.invoke(app, ["expectations", "--method", "none"])
    assert refused.exit_code != 0
