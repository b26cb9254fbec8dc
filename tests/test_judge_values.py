"""Values without an exact solution: the worked table of Celik et al. (2008), and where the rule here is stricter."""

import json
from math import sqrt
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from fixtures_command import Call, caller, one_line

from mpm_verify.cases.any_code import reading, table
from mpm_verify.cases.any_code.case import Extrapolated, examine
from mpm_verify.cases.any_code.execute import execute
from mpm_verify.cases.any_code.table import Expected
from mpm_verify.cases.harness.verdicts import Finding, findings
from mpm_verify.cases.judging.records import Outcome, ReasonCode
from mpm_verify.cases.judging.richardson import celik, extrapolate
from mpm_verify.reports.export.document import schema
from mpm_verify.reports.sentences.any_code import code

# Celik et al. (2008), doi:10.1115/1.2960953, Table 1: three quantities behind a backward-facing step, in 2-D. Cells,
# values, and what stands below them: apparent order, extrapolated value, errors and index in per cent.
WORKED = {
    "reattachment length": ((18000, 8000, 4500), (6.063, 5.972, 5.863), 1.53, 6.1685, 1.5, 1.7, 2.2),
    "velocity, p < 1": ((18000, 4500, 980), (10.7880, 10.7250, 10.6050), 0.75, 10.8801, 0.6, 0.9, 1.1),
    "velocity, to and fro": ((18000, 4500, 980), (6.0042, 5.9624, 6.0909), 1.51, 6.0269, 0.7, 0.4, 0.5),
}
H = (1 / 8, 1 / 16, 1 / 32, 1 / 64, 1 / 128)


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


def judged(values: dict[float, float], folder: Path, halved: float | None = None, **expected: Any) -> Any:
    """Finding and extrapolations of one refinement; steady unless a value with half the time step is given."""
    file, finest = folder / "values.csv", min(values)
    head = "h,value" + (",half_dt_value" if halved is not None else "")
    more = (
        {h: f",{halved!r}" if h == finest else "," for h in values} if halved is not None else dict.fromkeys(values, "")
    )
    file.write_text("\n".join([head, *(f"{h!r},{f!r}{more[h]}" for h, f in values.items())]))
    asked = Expected(exact=False, steady=halved is None, **{"order": 2.0, **expected})
    study = table.study(reading.read(file, exact=False), asked, "verify judge", "t")
    results = {run.digest: execute(run)[0] for run in study.runs}
    (found,) = findings(study, results)
    return found, examine(study, results, None).extrapolated


def finding(values: dict[float, float], folder: Path, **expected: Any) -> Finding:
    found: Finding = judged(values, folder, **expected)[0]
    return found


def three(values: dict[float, float], folder: Path, **expected: Any) -> Extrapolated:
    """What the finest three levels say."""
    found: Extrapolated = judged(values, folder, **expected)[1][0]
    return found


# ---- the published table


@pytest.mark.parametrize("name", WORKED)
def test_the_worked_table_of_celik(name: str) -> None:
    """Each number to the digits that are printed; cell sizes of plane cells.

    The 0.9 % of the second quantity is 0.847 % by the formulas of the paper, a little beyond half a unit.
    """
    cells, f, order, limit, relative, extrapolated, index = WORKED[name]
    found = celik([1 / sqrt(n) for n in cells], f)
    assert found.order == pytest.approx(order, abs=0.005)
    assert found.limit == pytest.approx(limit, abs=5e-5)
    for value, printed in ((found.relative, relative), (found.extrapolated, extrapolated), (found.index, index)):
        assert 100 * value == pytest.approx(printed, abs=0.055)


def test_the_worked_table_by_the_command(verify: Call) -> None:
    """Cell sizes in another unit, rows in another order; with three levels nothing is decided."""
    rows = [f"{name.replace(',', '')},{7 / sqrt(n)!r},{f!r}" for name, (cells, values, *_) in WORKED.items()
            for n, f in zip(cells, values, strict=True)]  # fmt: skip
    Path("table.csv").write_text("\n".join(["quantity,h,value", *reversed(rows)]))
    code, out, _ = verify("judge", "table.csv", "--no-exact", "--order", "2", "--steady", "--json", "--page")
    document = json.loads(out)
    jsonschema.validate(document, schema("any_code"))
    assert code == 3
    found = {one["measured"]: one for one in document["more"]["extrapolated"]}
    for name, (_, _, order, limit, _, _, index) in WORKED.items():
        one = found[name.replace(",", "")]["index"]
        assert (one["order"], one["limit"], 100 * one["index"]) == (
            pytest.approx(order, abs=0.005), pytest.approx(limit, abs=5e-5), pytest.approx(index, abs=0.05),
        )  # fmt: skip
    assert found["velocity to and fro"]["stricter"] == "oscillates"
    verdicts = {one["quantity"]: one["code"] for one in document["verdicts"]}
    assert set(verdicts.values()) == {"too_few_levels"}
    page = Path("results/judge-table/report.html").read_text()
    assert all(f">{value}<" in page for _, values, *_ in WORKED.values() for value in map("{:.10g}".format, values))
    assert "Richardson extrapolation and grid convergence index" in page
    assert all(text in page for text in ("6.1685", "10.8801", "6.02687", "2.17 %", "the values go to and fro"))


@pytest.mark.parametrize(("errors", "orders"), [
    ((0, 16, 4, 1, 0.25), [2.0, 2.0, 2.0]), ((64, 16, 4, 1, 0), [2.0, 2.0, 2.0]), ((64, 16, 0, 1, 0.25), [2.0, 2.0]),
])  # fmt: skip
def test_an_order_stands_beside_the_finer_of_its_two_cells(
    verify: Call, errors: tuple[float, ...], orders: list[float]
) -> None:
    Path("table.csv").write_text("\n".join(["h,error", *(f"{2.0**-k},{e}" for k, e in enumerate(errors))]))
    rows = [line.split() for line in verify("judge", "table.csv", "--order", "2")[1].splitlines()]
    found = [row for row in rows if len(row) > 2 and row[-2].endswith(("e+00", "e+01", "e-01"))]
    assert [float(row[-1]) for row in found] == orders
    beside = [k for k in range(1, 5) if errors[k - 1] and errors[k]]
    assert [float(row[-3]) for row in found] == [2.0**-k for k in beside]


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0, 3.7])
@pytest.mark.parametrize("h", [(1.0, 2.0, 4.0), (0.3, 0.7, 0.8), (1 / 42, 1 / 28, 1 / 14)])
def test_both_agree_on_a_power_law(h: tuple[float, ...], order: float) -> None:
    f = [3.0 - 0.2 * x**order for x in h]
    paper, ours = celik(h, f), extrapolate(h, f, formal=order)
    assert paper.order == pytest.approx(order, rel=1e-9)
    assert paper.limit == pytest.approx(3.0, rel=1e-9)
    assert paper.index * abs(f[0]) == pytest.approx(ours.uncertainty, rel=1e-6)


@pytest.mark.parametrize("f", [(1.0, 1.0, 2.0), (1.0, 2.0, 2.0), (0.0, 1.0, 2.0)])
def test_no_index_of_equal_or_zero_values(f: tuple[float, ...]) -> None:
    found = celik((1.0, 2.0, 4.0), f)
    assert found.order != found.order
    assert found.index != found.index


@pytest.mark.parametrize("ratio", [1e-300, 1e-9, 1.0, 1e9, 1e300])
@pytest.mark.parametrize("h", [(1.0, 1.0001, 1e9), (1.0, 1e8, 1e9), (1.0, 2.0, 2.0001)])
@pytest.mark.parametrize("sign", [1, -1])
def test_any_levels_have_an_order_or_none(h: tuple[float, ...], ratio: float, sign: int) -> None:
    """Nothing overflows."""
    f = (1.0, 2.0, 2.0 + sign * ratio)
    assert celik(h, f).order >= 0 or celik(h, f).index != celik(h, f).index
    assert extrapolate(h, f).kind in ("converges", "oscillates", "unsettled", "equal")


# ---- the rule on estimates


@pytest.mark.parametrize("h", [H, (0.3, 0.2, 0.14, 0.1, 0.05)])
@pytest.mark.parametrize("order", [1.0, 2.0, 3.0])
def test_estimates_of_a_power_law_are_its_errors(tmp_path: Path, h: tuple[float, ...], order: float) -> None:
    """With sizes in any ratio, from above and from below; the coarsest level has none."""
    for size in (0.7, -0.02):
        found = finding({x: 5.0 + size * x**order for x in h}, tmp_path, order=order)
        assert [level.h for level in found.levels] == pytest.approx(h[1:], rel=1e-14)
        assert [level.errors[0] for level in found.levels] == pytest.approx(
            [abs(size) * x**order for x in h[1:]], rel=1e-8
        )
        assert found.verdict.outcome is Outcome.PASS


@pytest.mark.parametrize(("observed", "outcome"), [(1.0, "FAIL"), (1.5, "FAIL"), (2.0, "PASS"), (2.6, "INCONCLUSIVE")])
def test_another_order_is_seen(tmp_path: Path, observed: float, outcome: str) -> None:
    """Levels of one ratio: each estimate is wrong by one factor, and the order is the observed one."""
    found = finding({h: 1.0 + h**observed for h in H}, tmp_path)
    assert str(found.verdict.outcome) == outcome
    assert found.verdict.observed == pytest.approx(observed, rel=1e-9)


def test_four_values_are_three_levels(tmp_path: Path) -> None:
    found = finding({h: 1.0 + h**2 for h in H[:4]}, tmp_path)
    assert found.verdict.reason.code is ReasonCode.TOO_FEW_LEVELS
    wanted = found.verdict.reason.wanted
    assert wanted is not None
    assert wanted.h == 1 / 128  # a finer row, not one that is there


@pytest.mark.parametrize(("halved", "code"), [(1.0, ReasonCode.TIME_STEP_COUPLED), (1.0 + 1.001 / 128**2, None)])
def test_half_the_time_step_counts(tmp_path: Path, halved: float, code: ReasonCode | None) -> None:
    """The value with half the step, against the difference to the next coarser level."""
    found = finding({h: 1.0 + h**2 for h in H}, tmp_path, halved=halved)
    assert found.verdict.reason.code is (code or ReasonCode.AS_EXPECTED)


STRICTER = {  # values on the finest three levels, and what is said
    "converges": [1.01, 1.04, 1.16],
    "capped": [1.001, 1.008, 1.064],
    "oscillates": [1.0, 1.1, 1.05],
    "unsettled": [1.0, 1.5, 1.6],
    "equal": [2.0, 2.0, 1.0],
}


@pytest.mark.parametrize("name", STRICTER)
def test_where_ours_is_the_stricter(tmp_path: Path, name: str) -> None:
    """The procedure has an order for values that go to and fro and apart; here half the range is given."""
    values = STRICTER[name]
    found = three(dict(zip((0.1, 0.2, 0.4), values, strict=True)), tmp_path)
    assert code(found) == name
    if name in ("oscillates", "unsettled"):
        assert found.index.order > 0
        assert found.ours.uncertainty == pytest.approx((max(values) - min(values)) / 2)
    if name == "capped":
        assert found.index.order == pytest.approx(3.0)
        assert found.ours.uncertainty > found.index.index * found.f[0]
        assert code(three(dict(zip((0.1, 0.2, 0.4), values, strict=True)), tmp_path, order=3.0)) == "converges"


def test_values_that_go_to_and_fro_do_not_pass(tmp_path: Path) -> None:
    """Their differences alone would: they fall with order 2."""
    steps = [h**2 for h in H]
    values = {h: 1.0 + sign * step for h, step, sign in zip(H, steps, (1, -1, 1, -1, 1), strict=True)}
    found = finding(values, tmp_path)
    assert found.verdict.reason.code is ReasonCode.LEVEL_MISSING
    assert str(found.verdict.reason.failed[0].failure.kind) == "oscillates"
    assert finding({h: 1.0 + step for h, step in zip(H, steps, strict=True)}, tmp_path).verdict.outcome is Outcome.PASS


def test_a_value_that_is_not_finite_is_a_failed_level(tmp_path: Path) -> None:
    """And so is the next finer one, which has nothing to be held against."""
    found = finding({h: float("nan") if h == 1 / 32 else 1.0 + h**2 for h in H}, tmp_path)
    assert [level.ended is not None for level in found.levels] == [False, True, True, False]


def test_a_column_by_the_name_of_its_quantity(verify: Call) -> None:
    Path("drag.csv").write_text("h,Cd\n" + "".join(f"{h},{-1.5 - h**2}\n" for h in H))
    code, out, _ = verify("judge", "drag.csv", "--no-exact", "--order", "2", "--steady", "--no-page")
    assert code == 0
    assert "PASS  code, Cd, order 2 expected" in out
    assert "Cd as value" in out
    assert "extrapolated -1.5, GCI" in " ".join(out.split())


REFUSED = {
    "errors": ("h,error\n0.1,1\n", "no column value", "of errors, leave --no-exact out"),
    "two quantities": ("h,Cd,Cl\n0.1,1,1\n", "no column value", "found h, Cd, Cl"),
    "one level": ("h,value\n0.1,1\n", "has one level of code value", "write two at least"),
    "replicates": (
        "h,value,seed\n0.1,1,1\n0.1,2,2\n0.05,1,1\n",
        "line 3: replicates of values",
        "their mean in one row",
    ),
    "a word": ("h,value\n0.1,big\n", "line 2: value = 'big' must be a number", "nan"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_table_of_values(verify: Call, name: str) -> None:
    text, *said = REFUSED[name]
    Path("values.csv").write_text(text)
    line = one_line(verify("judge", "values.csv", "--no-exact"))
    assert all(word in line for word in said), line
