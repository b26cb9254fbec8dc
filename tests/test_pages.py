"""Parts of pages: tables that fit, LaTeX, points of figures, cards of runs, references, an index, differences."""

import csv
import importlib
import io
import json
import re
from base64 import b64decode
from dataclasses import fields as dataclass_fields
from dataclasses import replace
from html import unescape
from math import nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from urllib.parse import unquote, urljoin, urlsplit

import fixtures_study as fixtures
import numpy as np
import pytest
from fixtures_command import Call, caller, one_line
from matplotlib import rc_context
from matplotlib.figure import Figure
from typer.main import get_command

from mpm_verify.cases.bench.run import Run as BenchRun
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.contract import case_named
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.mms.run import Run
from mpm_verify.reports import words
from mpm_verify.reports.compared import Change
from mpm_verify.reports.components import page, references, run_cards
from mpm_verify.reports.components.badges import Badge, shortened
from mpm_verify.reports.components.latex import booktabs
from mpm_verify.reports.components.latex import text as latex_of
from mpm_verify.reports.components.page import TEMPLATES, adder, inside
from mpm_verify.reports.components.references import cited, entries, named
from mpm_verify.reports.components.table import SIZES, Table
from mpm_verify.reports.components.take import beside
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.frames import read
from mpm_verify.reports.indexed import UNREADABLE
from mpm_verify.reports.pages import _diff
from mpm_verify.reports.sentences import commands, must_fail
from mpm_verify.reports.sentences.headline import passed
from mpm_verify.reports.tables.markdown import row
from mpm_verify.solver.plugins import CASES, KINDS, PROBLEMS, available, path
from mpm_verify.verify.commands import diff
from mpm_verify.verify.main import application
from mpm_verify.verify.options import values

WORDLESS = ("mms", "wave_bar")  # cases without sentences of their own


@pytest.fixture
def verify(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Call:
    return caller(monkeypatch, capsys, tmp_path)


# ---- tables


def wide(count: int, columns: int = 12) -> Table:
    """A table whose second half of columns says one thing."""
    head = ("run", *(f"column {k}" for k in range(columns)))
    cells = [
        tuple(f"1.{row}{k}5e-3" if k < columns // 2 else f"same {k}" for k in range(columns)) for row in range(count)
    ]
    return Table("Runs", head, tuple((f"run {row}", *cells[row]) for row in range(count)))


def test_what_all_rows_say_is_said_once() -> None:
    shown = wide(4).folded
    assert shown.columns == ("run", *(f"column {k}" for k in range(6)))
    assert shown.note == "In all rows: " + "; ".join(f"column {k} same {k}" for k in range(6, 12)) + "."
    assert wide(3).folded.columns == wide(3).head  # too few rows to say so
    rows = wide(4).rows
    other = Table("Runs", wide(4).head, (*rows[:3], (*rows[3][:-1], "another")))
    assert other.folded.columns[-1] == "column 11"


def test_nothing_of_a_table_is_lost() -> None:
    table = wide(5)
    (block,) = table.folded.blocks
    said = {cell for row in block[1] for cell in row}
    assert {cell for row in table.rows for cell in row} - said == {f"same {k}" for k in range(6, 12)}


def test_blocks_of_rows() -> None:
    rows = (("a", "8", "1"), ("a", "16", "2"), ("b", "8", "3"))
    shown = Table("Levels", ("series", "cells", "error"), rows, heads=2, grouped=True).folded
    assert shown.columns == ("cells", "error")
    assert shown.leads == 1
    assert shown.blocks == (("a", (("8", "1"), ("16", "2"))), ("b", (("8", "3"),)))


@pytest.mark.parametrize(("columns", "size"), [(2, "s"), (6, "m"), (8, "l"), (20, "x")])
def test_the_size_of_a_table_grows_with_its_columns(columns: int, size: str) -> None:
    row = tuple(f"1.2345e-{k % 9 + 1}" for k in range(columns))
    assert Table("t", tuple("error" for _ in row), (row,), heads=0).folded.size == size
    assert list(SIZES) == ["s", "m", "l"]
    assert sorted(SIZES.values()) == list(SIZES.values())


def test_a_table_as_csv_is_the_table() -> None:
    table = Table('a, "b"', ("x", "y"), (("1,5", 'say "so"'), ("", "2")))
    content = b64decode(table.files[0].link.partition(",")[2]).decode()
    assert [tuple(row) for row in csv.reader(io.StringIO(content))] == [table.head, *table.rows]
    assert [file.name for file in table.files] == ["a_b.csv", "a_b.tex"]


@pytest.mark.parametrize(
    ("cell", "latex"),
    [
        ("1.127e-5", r"$1.127\times10^{-5}$"),
        ("\N{MINUS SIGN}4.0e3", r"$-4.0\times10^{3}$"),
        ("50 % of a_b & c#", r"50 \% of a\_b \& c\#"),
        ("σ ≤ 2 × 10", r"$\sigma$ $\leq$ 2 $\times$ 10"),
        ("\\x{y}~", r"\textbackslash{}x\{y\}\textasciitilde{}"),
        ("order 2.00", "order 2.00"),
    ],
)
def test_cells_in_latex(cell: str, latex: str) -> None:
    assert latex_of(cell) == latex


def test_a_table_in_latex() -> None:
    made = booktabs("Errors", ("series", "cells", "error"), [("a", "8", "1e-3"), ("a", "16", "2.5e-4")], heads=2)
    lines = made.splitlines()
    assert lines[2] == r"\begin{tabular}{llr}"
    assert lines[4:] == [r"series & cells & error \\", r"\midrule", r"a & 8 & $1\times10^{-3}$ \\",
                         r" & 16 & $2.5\times10^{-4}$ \\", r"\bottomrule",
                         r"\end{tabular}", r"\end{table}"]  # fmt: skip
    assert all(line.count("&") == 2 for line in lines if line.endswith(r"\\"))


# ---- figures


def lines_of(*points: list[tuple[float, float]]) -> Figure:
    """Figure of lines on logarithmic axes, the last without a name."""
    with rc_context(style.RC):
        figure, axes = style.panel((4, 3), xlabel="h", ylabel="error")
        for number, line in enumerate(points):
            x, y = zip(*line, strict=True)
            made = axes.loglog(x, y, **({"label": f"series {number}"} if number < len(points) - 1 else {}))
            drawn.of_runs(made, [Run(cells=2 + k) for k in range(len(line))])
    return figure


def test_points_stand_where_they_are_drawn(tmp_path: Path) -> None:
    """Places are in per cent of the figure; equal steps of a logarithmic axis are equal steps on the page."""
    figure = lines_of([(0.01, 1e-4), (0.1, 1e-2), (1.0, 1.0)], [(0.01, 1.0)], [(0.1, 1e-3)])
    told = {Run(cells=2 + k).digest: f"run {k}" for k in range(3)}
    image = adder(tmp_path, told=told)("drawn", figure, "Errors.")
    assert image.series == ("series 0", "series 1")
    assert [p.text for p in image.points] == ["run 0", "run 1", "run 2", "run 0"]
    assert [p.series for p in image.points] == [0, 0, 0, 1]
    first, second, third, other = [(p.left, p.top) for p in image.points]
    np.testing.assert_allclose(np.subtract(second, first), np.subtract(third, second), atol=0.02)
    assert first[0] == other[0]
    assert third[1] == other[1] < first[1]
    assert all(0 < at < 100 for p in image.points for at in (p.left, p.top))
    svg = (tmp_path / "drawn.svg").read_text()
    match = re.search(r'id="series-0-0">\s*<path d="M ([\d.]+) ([\d.]+)', svg)
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg)
    assert match
    assert size
    at = [100 * float(match[k]) / float(size[k]) for k in (1, 2)]
    np.testing.assert_allclose(first, at, atol=0.02)


def test_a_point_without_a_position_takes_its_run_along(tmp_path: Path) -> None:
    """One that is not a number, or zero on a logarithmic axis: those behind it are still of their own runs."""
    figure = lines_of([(0.01, 1e-4), (0.05, nan), (0.1, 0.0), (1.0, 1.0)], [(0.1, 1e-3)])
    told = {Run(cells=2 + k).digest: f"run {k}" for k in range(4)}
    first, last = adder(tmp_path, told=told)("drawn", figure, "Errors.").points
    assert (first.text, last.text) == ("run 0", "run 3")
    assert first.left < last.left < 100
    assert 0 < last.top < first.top < 100


def test_runs_of_a_line_are_as_many_as_its_points() -> None:
    figure = lines_of([(0.1, 1.0), (1.0, 1.0)], [(0.1, 1.0)])
    drawn.of_runs(figure.axes[0].lines[:1], [Run()])
    with pytest.raises(ValueError, match="longer"):
        list(drawn.points(figure))


def test_a_run_without_a_card_has_no_point(tmp_path: Path) -> None:
    assert adder(tmp_path)("drawn", lines_of([(0.1, 1.0)], [(0.1, 1.0)]), "Errors.").points == ()


def test_names_and_colours_of_an_svg_inside_a_page() -> None:
    group = '<g id="axes_1" style="fill: #1b1f24; stroke: #123456" clip-path="url(#p1)"><use href="#m1"/></g></svg>'
    svg = f'<?xml version="1.0"?>\n<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><metadata/>{group}'
    made = inside(svg.replace("<metadata/>", "<metadata>x</metadata>"), "one", 'a "figure"')
    for before, after in (('"axes_1', '"one-axes_1'), ("(#", "(#one-"), ('"#m1', '"#one-m1')):
        group = group.replace(before, after)
    group = group.replace("#1b1f24", "var(--ink, #1b1f24)")
    assert made == f'<svg role="img" aria-label="a &#34;figure&#34;" viewBox="0 0 9 9">{group}'


def test_a_picture_of_an_error_is_bright_where_the_error_is() -> None:
    from PIL import Image

    side = np.linspace(0.05, 0.95, 10)
    x = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    data = run_cards.picture(x, (x[:, 0] > 0.5) * (x[:, 1] > 0.5) * 1.0)
    image = np.asarray(Image.open(io.BytesIO(b64decode(data.partition(",")[2]))).convert("L"), float)
    upper_right, others = image[: len(image) // 2 - 1, len(image) // 2 + 1 :], image[len(image) // 2 + 1 :]
    assert upper_right.min() > 180 > 60 > others.max()


def test_a_page_that_is_too_large_links_to_its_files(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Those of figures, which are beside it; those of tables stay inside."""
    for file in TEMPLATES.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / "own.html.j2").write_text('{% from "parts.html.j2" import takes %}<!--contents-->{{ takes(files) }}')
    monkeypatch.setattr(page, "TEMPLATES", tmp_path)
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "one.svg").write_text("<svg/>")
    files = [beside(tmp_path / "figures" / "one.svg"), wide(2).files[0]]
    small = page.whole("own.html.j2", "Files", files=files)
    monkeypatch.setattr(page, "LARGE", 100)
    large = page.whole("own.html.j2", "Files", files=files)
    assert [text.count('href="figures/one.svg"') for text in (small, large)] == [0, 1]
    assert [text.count("data:image/svg+xml;base64") for text in (small, large)] == [1, 0]
    assert [text.count("data:text/csv") for text in (small, large)] == [1, 1]


# ---- cards of runs


@pytest.mark.parametrize(
    "run",
    [
        Run("gimp", "bar", "neo_hookean", 8, 9, 0.2),
        Run("mpm", "clamped_shear", "hencky", 16, 4, 0.4, transfer="apic", staggered=False, damping=0.05),
    ],
)
def test_the_command_of_a_card_asks_for_its_run(run: Run) -> None:
    study = build(Asked("mms", {"method": ["cpdi"], "cells": [8]}), "verify mms")
    words = commands.of_run(study, run).split()
    assert words[:2] == ["verify", "mms"]
    asked = {name.removeprefix("--"): [value] for name, value in zip(words[2::2], words[3::2], strict=True)}
    found = build(Asked("mms", values(Run, asked)), " ".join(words))
    assert run.digest in {one.digest for one in found.runs}
    assert commands.of_run(study, replace(run, offset=(0.1, 0.2))) == ""


def test_cards_tell_parameters_errors_and_ends(tmp_path: Path) -> None:
    with fixtures.sources():
        record = read(fixtures.make(tmp_path))
        found = {card.digest: dict(card.facts) for card in run_cards.cards(record)}
        run = next(run for run in record.study.runs if (run.method, run.ppc, run.cells) == ("cpdi", 4, 64))
        facts = found[run.digest]
    assert len(found) == 32
    assert facts["Error of u"].startswith("rms 4.498e-5, max ")
    assert facts["Parameters"].startswith("material neo_hookean, cells 64")
    assert sum("det F" in facts["Ended"] for facts in found.values()) == 6


def test_badges_of_what_does_not_pass_come_first() -> None:
    many = [Badge("PASS", "PASS", str(k)) for k in range(20)] + [Badge("FAIL", "FAIL", "bad")]
    shown = shortened(many)
    assert shown[0].text == "bad"
    assert (shown[-1].badge, shown[-1].text) == ("and 9", "more that pass")
    assert shortened(many[:3]) == many[:3]


@pytest.mark.parametrize("case", [name for name in available(CASES) if case_named(name).command])
def test_the_command_of_a_case_has_an_option_for_each_field(case: str) -> None:
    """But for those that it names itself."""
    known = case_named(case)
    name, *inside = known.command.split()
    command: Any = get_command(application(name))
    options = {
        option for parameter in getattr(command, "commands", {}).get(name, command).params for option in parameter.opts
    }
    fields = {item.name for item in dataclass_fields(known.Run) if f"{{run.{item.name}}}" not in inside}
    assert len(fields) > 3
    assert {f"--{field.replace('_', '-')}" for field in fields - {"offset", "given"}} <= options


def test_cases_that_state_no_command_have_no_command_of_a_run() -> None:
    run = BenchRun()
    assert commands.of_run(Study("t", "t", "", (run,), case="bench"), run) == ""


@pytest.mark.parametrize("case", available(CASES))
def test_a_case_with_failing_controls_says_so_itself(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Words of such a case have `control`, which no list repeats."""
    record: Any = SimpleNamespace(study=SimpleNamespace(case=case))
    words_of = importlib.import_module(f"{must_fail.__package__}.{case}") if case not in WORDLESS else must_fail
    monkeypatch.setattr(words_of, "control", lambda record: "it failed, as it must", raising=False)
    assert must_fail.of_case(record) == ("" if case in WORDLESS else "it failed, as it must")


def test_a_users_case_has_no_words_of_ours() -> None:
    record: Any = SimpleNamespace(study=SimpleNamespace(case="/tmp/own.py"))
    assert must_fail.of_case(record) == ""


# ---- references


def test_every_source_of_a_plugin_has_an_entry() -> None:
    known = entries()
    files = [path(package, name) for package in KINDS for name in available(package)]
    found = {doi for file in files for doi in named(file.read_text())}
    assert len(found) > 25
    assert not found - known.keys()
    keys = [re.match(r"@\w+\{([\w-]+),", entry) for entry in known.values()]
    assert len({match[1] for match in keys if match}) == len(known)
    assert all(entry.count("{") == entry.count("}") for entry in known.values())


def test_dois_without_the_signs_around_them() -> None:
    said = "A, doi:10.1002/nme.3110. B (doi:10.1016/j.cma.2017.01.035), doi:10.1016/0045-7825(94)90112-0; C"
    assert list(named(said)) == ["10.1002/nme.3110", "10.1016/j.cma.2017.01.035", "10.1016/0045-7825(94)90112-0"]


def test_a_study_cites_what_it_used(tmp_path: Path) -> None:
    with fixtures.sources():
        found = cited(read(fixtures.make(tmp_path, ("cpdi",))))
    assert found.text.startswith("@software{mpm-verify,")
    assert "sadeghirad2011" in found.text
    assert "sulsky1994" not in found.text
    assert found.count == found.text.count("\n@") + 1
    assert "no entry here" not in found.text


def test_a_source_without_an_entry_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A line tells it that BibTeX passes over, and it is no entry; what is beside it has its own."""
    known = entries()
    lost = known.pop("10.1002/nme.3110")
    monkeypatch.setattr(references, "entries", lambda: known)
    with fixtures.sources():
        found = cited(read(fixtures.make(tmp_path, ("cpdi",))))
    assert found.text.endswith("\n% doi:10.1002/nme.3110, no entry here\n")
    assert lost not in found.text
    assert found.count == found.text.count("\n@") + 1


def test_every_shipped_source_has_an_entry() -> None:
    """Those of all files of a case, not of its case.py alone, and of all plug-ins."""
    files = {file for case in available(CASES) for file in references.of_case(case)}
    files |= {path(kind, name) for kind in KINDS for name in available(kind)}
    used = {doi for file in files for doi in named(file.read_text(encoding="utf-8"))}
    assert len(used) > 20
    assert not used - set(entries())


def test_the_files_of_a_case() -> None:
    """All of its folder, but no problem of a benchmark that a study did not ask for; none of a user's case."""
    assert "10.1103/PhysRevE.72.041301" in {doi for f in references.of_case("column") for doi in named(f.read_text())}
    problems = {path(PROBLEMS, name) for name in available(PROBLEMS)}
    assert not problems & set(references.of_case("benchmark"))
    assert references.of_case("own.py") == []


# ---- a folder of studies


def test_an_index_of_studies(verify: Call, tmp_path: Path) -> None:
    with fixtures.sources():
        one = fixtures.make(tmp_path / "results" / "one", ("cpdi",), largest=0)
        fixtures.make(tmp_path / "results" / "deep" / "two", ("mpm",), skip=3, largest=0)
        broken(tmp_path / "results" / "broken")
        (one / "report.html").write_text("")
        code, out, err = verify("index", "results", "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)["studies"]
    told = {one["folder"]: one for one in found}
    assert told.keys() == {"one", "deep/two", "broken"}
    assert [told[name]["outcome"] for name in ("one", "broken")] == ["PASS", UNREADABLE]
    assert "left as it is" in told["broken"]["headline"]
    assert told["one"]["headline"].startswith("CPDI converges at order 2.0")
    assert (told["one"]["runs"], told["deep/two"]["runs"]) == ("17 of 17", "12 of 15")
    assert (told["one"]["page"], told["deep/two"]["page"]) == ("one/report.html", "")
    assert [one["date"] for one in found] == sorted((one["date"] for one in found), reverse=True)
    text = (tmp_path / "results" / "index.html").read_text()
    assert text.count('href="one/report.html"') == 1
    assert "CPDI converges at order 2.0" in text


def broken(folder: Path) -> None:
    """Make a folder whose study cannot be read."""
    folder.mkdir(parents=True)
    (folder / "study.json").write_text("{")


def test_an_index_leads_to_folders_of_any_name(verify: Call, tmp_path: Path) -> None:
    """Names have signs that mean something in an address: the link, read as one, is the path of the page."""
    names = {"a#1", "b?x=1", "c%20d", "e f", "g:h", 'i"&'}
    for name in names:
        broken(tmp_path / "results" / name)
        (tmp_path / "results" / name / "report.html").write_text("")
    assert verify("index")[0] == 0
    links = re.findall(r'<th scope="row"><a href="(.*?)"', (tmp_path / "results" / "index.html").read_text())
    addresses = [urlsplit(urljoin("file:///results/", unescape(link))) for link in links]
    assert {unquote(one.path) for one in addresses} == {f"/results/{name}/report.html" for name in names}
    assert not any(one.query or one.fragment for one in addresses)


def test_how_many_checks_pass() -> None:
    """One sentence, on every page and in every summary."""
    checks = [Check("g", "n", found, 1.0, "at_most", "") for found in (0.5, 1.0, 2.0)]
    assert [passed(checks), passed(checks[:1]), passed(checks[2:]), passed([])] == [
        "2 of 3 checks pass.", "1 of 1 check passes.", "0 of 1 check passes.", "",
    ]  # fmt: skip


def test_a_row_in_markdown_has_its_cells() -> None:
    assert row(["own|file.py", "a <b>", "two\nlines"]) == "| own\\|file.py | a &lt;b> | two lines |"


def test_an_index_on_a_terminal(verify: Call, tmp_path: Path) -> None:
    broken(tmp_path / "results" / "mine")
    code, out, _ = verify("index")
    assert code == 0
    assert any(line.split()[:2] == [UNREADABLE, "mine"] for line in out.splitlines())
    assert out.splitlines()[-1] == "index: results/index.html"


def test_a_folder_without_studies(verify: Call, tmp_path: Path) -> None:
    assert "results is not a folder" in one_line(verify("index"))
    (tmp_path / "results").mkdir()
    assert "no study below it" in one_line(verify("index"))


# ---- two studies


def changed(folder: Path, factor: float, **more: Any) -> None:
    """Multiply the errors of u of each run of CPDI with 4 per cell."""
    store = Store(folder)
    for run in store.study().runs:
        result = store.get(run.digest)
        if (run.method, run.ppc) == ("cpdi", 4) and result.errors:
            errors = {**result.errors, "u": {norm: e * factor**run.cells for norm, e in result.errors["u"].items()}}
            store.put(replace(result, errors=errors, **more), {})


def test_a_page_of_two_studies(verify: Call, tmp_path: Path) -> None:
    """Each kind of change is counted; a factor of 1.01 a cell turns order and verdict."""
    with fixtures.sources():
        a, b = (fixtures.make(tmp_path / name, ("cpdi",), largest=0) for name in "ab")
        changed(b, 1.01)
        code, out, _ = verify("diff", str(a), str(b), "--page", "changes.html")
        found = json.loads(verify("diff", str(a), str(b), "--json")[1])["changes"]
        alike = verify("diff", str(a), str(a), "--page", "same.html")
    kinds = [one["kind"] for one in found]
    assert code == 1
    assert kinds == sorted(kinds, key=("verdict", "order", "status", "number").index)
    assert {kind: kinds.count(kind) for kind in kinds} == {"verdict": 1, "order": 1, "number": 24}
    order = next(one for one in found if one["kind"] == "order")
    assert order["before"] == pytest.approx(2.0, abs=0.05)
    assert order["before"] - order["after"] > 0.3
    assert out.splitlines()[-1] == "page: changes.html"
    text = re.sub(r"\s+", " ", re.sub("<[^>]+>", " ", (tmp_path / "changes.html").read_text()))
    for said in (
        "DIFFERENT",
        "1 verdicts and checks differ",
        "1 observed orders differ",
        "24 errors and values differ",
    ):
        assert said in text
    assert f"{1.01**128:.6g} times" in text
    assert alike[0] == 0
    assert "ALIKE" in (tmp_path / "same.html").read_text()


def test_a_number_that_one_study_lacks_is_a_dash(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A dash on the terminal and on the page, and an empty ratio."""
    one = Change("run", "u rms", 0.1234567, nan)
    assert (words.value(one.before), words.value(one.after), one.ratio) == ("0.123457", words.DASH, "")
    assert Change("run", "u rms", 0.5, 1.0).ratio == "2 times"
    assert words.DASH in str(_diff.table("Errors", [one]).rows[0])
    printed = io.StringIO()
    monkeypatch.setattr("sys.stdout", printed)
    diff.show([one])
    assert words.DASH in printed.getvalue()
    assert "nan" not in printed.getvalue()


def test_a_page_that_is_none(verify: Call, tmp_path: Path) -> None:
    assert "--page changes must be a file that ends with .html" in one_line(
        verify("diff", "a", "b", "--page", "changes")
    )
