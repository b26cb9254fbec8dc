"""The report of a stored study: deterministic, self-contained, complete, and right to the digit."""

import base64
import re
from collections.abc import Iterator
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from unittest.mock import patch

import fixtures_study as fixtures
import numpy as np
import pandas as pd
import pytest

from mpm_verify.cases.harness import identity
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import QuantityPlan
from mpm_verify.cases.judging.order import Expectation
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.blind_spots import ALWAYS
from mpm_verify.reports import words
from mpm_verify.reports.components import audited
from mpm_verify.reports.components.cards import cards
from mpm_verify.reports.figures.error_field import choose, domains
from mpm_verify.reports.frames import read
from mpm_verify.reports.pages import mms
from mpm_verify.reports.pages.mms import page as draw
from mpm_verify.reports.sentences import failures, verdicts
from mpm_verify.solver.failure import Failure, FailureKind


def render(folder: Path) -> Path:
    """Draw the page of a stored study."""
    return draw(read(folder))


@pytest.fixture(autouse=True)
def sources() -> Iterator[None]:
    with fixtures.sources():
        yield


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A whole study, rendered once."""
    made = fixtures.make(tmp_path_factory.mktemp("study"))
    with fixtures.sources():
        render(made)
    return made


@pytest.fixture(scope="module")
def page(folder: Path) -> str:
    return (folder / "report.html").read_text()


class Outline(HTMLParser):
    """Headings, images and tables of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.levels: list[int] = []
        self.images: list[dict[str, str | None]] = []
        self.tags: list[str] = []
        self.figures: list[dict[str, str | None]] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if re.fullmatch("h[1-6]", tag):
            self.levels.append(int(tag[1]))
        if tag == "img":
            self.images.append(dict(attrs))
        if tag == "svg" and dict(attrs).get("role") == "img":
            self.figures.append(dict(attrs))


def files(folder: Path) -> dict[str, bytes]:
    """What render writes."""
    made = [folder / "report.html", *folder.glob("figures/*"), *folder.glob("tables/*")]
    return {str(file.relative_to(folder)): file.read_bytes() for file in made}


def text(page: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", re.sub(r"data:[^\"]+", "", page)))


@pytest.mark.slow
def test_rendering_twice_gives_the_same_bytes(folder: Path) -> None:
    before = files(folder)
    render(folder)
    assert files(folder) == before
    assert {Path(name).suffix for name in before} == {".html", ".svg", ".pdf", ".png", ".csv"}


def test_page_is_self_contained(page: str) -> None:
    outline = Outline(page)
    assert len(outline.figures) == 7  # two panels, local orders, particles and a field for each method
    assert all(len(figure["aria-label"] or "") > 20 for figure in outline.figures)
    assert len(outline.images) == 16  # error fields of runs whose particles are stored: up to 32 cells
    for image in outline.images:
        kind, _, data = (image["src"] or "").partition(",")
        assert kind == "data:image/png;base64"
        assert base64.b64decode(data, validate=True).startswith(b"\x89PNG")
        assert len(image["alt"] or "") > 20
    assert "http" not in re.sub(r"base64,[^\"]+", "", page)
    assert not {"iframe", "object"} & set(outline.tags)
    assert outline.tags.count("script") == page.count("<script>") == 1  # inline, without a source
    assert outline.tags.count("link") == 1  # the empty icon
    assert len(page) < 3e6


def test_headings_are_in_order_and_every_table_has_a_caption(page: str) -> None:
    outline = Outline(page)
    assert outline.levels[0] == 1
    assert outline.levels.count(1) == 1
    assert all(after - before <= 1 for before, after in zip(outline.levels, outline.levels[1:], strict=False))
    assert outline.tags.count("table") == outline.tags.count("caption") > 8


def test_verdicts_come_first_and_in_words(page: str) -> None:
    said = text(page)
    assert "4 of 4 judged quantities PASS, 2 of them as a registered non-convergence." in said
    first = [
        page.index(text) for text in ("CPDI converges", 'class="pill', 'id="figure1"', "<svg role", 'id="verdicts"')
    ]
    assert first == sorted(first)
    assert said.index("4 of 4 judged") < said.index("CPDI, 4 per cell: u in rms")
    assert "Converges as expected" in said
    assert "Sadeghirad et al. 2011" in said
    assert "Does not converge, as registered before the run" in said


def test_divergence_is_said_plainly_with_the_measured_numbers(page: str) -> None:
    said = text(page)
    plain = "Classical MPM diverges here with refinement, while the paper&#39;s printed norm shows it converging"
    assert f"{plain}: from 1/8 to 1/64 the error in rms grows 5.3-fold (4.814e-3 to 2.573e-2)" in said
    assert "printed falls 4.2-fold" in said
    assert "a seeming order of 0.69" in said


def test_no_divergence_is_claimed_of_a_method_that_converges(tmp_path: Path) -> None:
    fixtures.make(tmp_path, ("cpdi",))
    store = Store(tmp_path)
    study = store.study()
    expected = tuple(replace(d, expectation=Expectation(None)) if d.judged else d for d in study.plans)
    store.create(replace(study, plans=expected))
    said = text(render(tmp_path).read_text())
    assert "FAIL" in said
    assert "Converges, and that was not expected" in said
    assert "diverges here" not in said


def test_every_run_is_listed_with_its_end(folder: Path, page: str) -> None:
    record = read(folder)
    said = text(page)
    assert len(record.study.runs) == 32
    for run in record.study.runs:
        assert run.digest in said
    found = [r.failure for r in record.results.values() if r.failure]
    assert len(found) == 6
    for failure in found:
        assert failures.failure(failure) in said
    assert page.count('class="text failed">failed</td>') == 6


def test_csv_round_trips_to_the_stored_numbers(folder: Path) -> None:
    record = read(folder)
    errors = pd.read_csv(folder / "tables" / "errors.csv")
    runs = pd.read_csv(folder / "tables" / "runs.csv").set_index("digest")
    finished = [r for r in record.results.values() if r.status == "finished"]
    assert len(errors) == 4 * len(finished)
    named = {(r["method"], r["ppc"], r["cells"], r["courant"], r["quantity"]): r for r in errors.to_dict("records")}
    for result in finished:
        run = result.run
        for quantity, norms in result.errors.items():
            row = named[run.method, run.ppc, run.cells, run.courant, quantity]
            assert {norm: row[norm] for norm in norms} == norms
    for result in record.results.values():
        assert (runs.loc[result.digest, "wall_s"], runs.loc[result.digest, "dt"]) == (result.wall_s, result.dt)


def test_the_data_of_a_figure_are_what_is_stored(folder: Path) -> None:
    data = pd.read_csv(folder / "figures" / "figure1_rms.csv")
    assert set(data.series) == {f"{words.method(method)}, {ppc} per cell" for method, ppc in fixtures.U_RMS}
    for (method, ppc), errors in fixtures.U_RMS.items():
        mine = data[data.series == f"{words.method(method)}, {ppc} per cell"]
        np.testing.assert_array_equal(mine.iloc[:, 3], errors)
        np.testing.assert_array_equal(mine.iloc[:, 2], [1 / n for n in fixtures.CELLS[: len(errors)]])


def test_orders_of_the_table_of_the_paper(folder: Path) -> None:
    orders = pd.read_csv(folder / "tables" / "orders.csv")
    wanted = orders[(orders.method == "cpdi") & (orders.ppc == 4) & (orders.quantity == "u")]
    for norm, slopes in {"rms": [2.09, 1.98, 2.00, 2.00], "printed": [3.59, 3.48, 3.50, 3.50]}.items():
        np.testing.assert_allclose(wanted[wanted.norm == norm].order, slopes, atol=0.006)
    assert set(orders[orders.role == "judged"].norm) == {"rms"}


def test_printed_is_nowhere_among_the_judged(folder: Path, page: str) -> None:
    verdicts = pd.read_csv(folder / "tables" / "verdicts.csv")
    assert set(verdicts[verdicts.role == "judged"].norm) == {"rms"}
    assert "printed" not in page[page.index("Errors and orders, one row a level") : page.index('id="shown"')]
    assert "by √8 more than rms: it adds 1.5 orders in 2-D, which the method does not have" in text(page)


def test_incomplete_study_says_so(tmp_path: Path) -> None:
    fixtures.make(tmp_path, ("cpdi",), skip=3)
    said = text(render(tmp_path).read_text())
    assert "This study is not complete: 3 runs of 17 not done yet." in said
    assert "not run yet" in said
    assert "INCONCLUSIVE" in said


def test_study_without_any_result(tmp_path: Path) -> None:
    fixtures.make(tmp_path, ("mpm",), skip=15)
    said = text(render(tmp_path).read_text())
    assert "15 runs of 15 not done yet" in said
    assert "ERROR" in said


@pytest.mark.parametrize("method", ["cpdi", "mpm"])
def test_study_with_one_method(tmp_path: Path, method: str) -> None:
    fixtures.make(tmp_path, (method,))
    said = text(render(tmp_path).read_text())
    met = ", 2 of them as a registered non-convergence" * (method == "mpm")
    assert f"2 of 2 judged quantities PASS{met}." in said
    assert words.method("mpm" if method == "cpdi" else "cpdi") + ", 4 per cell" not in said
    assert ("The norm explains this, and so does the duration" in said) == (method == "mpm")


def beside(folder: Path, **other: str) -> None:
    """Add to the study of CPDI the same runs with other values."""
    store = Store(fixtures.make(folder, ("cpdi",)))
    study = store.study()
    runs = tuple(replace(run, **other) for run in study.runs)
    declared = tuple(replace(d, run=replace(d.run, **other)) for d in study.plans)
    store.create(replace(study, runs=study.runs + runs, plans=study.plans + declared))
    for old, new in zip(study.runs, runs, strict=True):
        if (result := store.get(old.digest)) is not None:
            store.put(replace(result, run=new, digest=new.digest), store.arrays(old.digest))


@pytest.mark.slow
@pytest.mark.parametrize("material", ["neo_hookean", "hencky"])
def test_two_solutions_are_told_apart(material: str, tmp_path: Path) -> None:
    """Of one material and of two: each solution has its figures."""
    other = "clamped_shear:G=0.05"
    beside(tmp_path, solution=other, material=material)
    said = text(render(tmp_path).read_text())
    assert f"CPDI, 4 per cell, {other}" in said
    assert said.count("Seen by clamped_shear, generalised_vortex, swirl.") == 2
    names = {file.stem for file in tmp_path.glob("figures/*.svg")}
    assert {"figure1_axis_aligned", "figure1_clamped_shear_G_0_05"} <= names


def test_each_solution_has_what_is_drawn_of_it(tmp_path: Path) -> None:
    """Of what else varies the first value that the solution has: materials of two solutions need not be alike."""
    beside(tmp_path, solution="swirl", material="hencky")
    with fixtures.sources():
        drawn = read(tmp_path).drawn
        assert {(s.first.solution, s.first.material, s.first.ppc) for s in drawn} == {
            (*problem, ppc) for problem in (("axis_aligned", "neo_hookean"), ("swirl", "hencky")) for ppc in (1, 4, 9)
        }
    beside(tmp_path, material="hencky")
    with fixtures.sources():
        assert {s.first.material for s in read(tmp_path).drawn} == {"neo_hookean"}


def test_results_of_earlier_sources_are_shown_and_named_as_such(tmp_path: Path) -> None:
    fixtures.make(tmp_path, ("cpdi",))
    with patch.object(identity, "sources", lambda *_: "later"):
        said = text(render(tmp_path).read_text())
    assert "computed with another version of the source code than is now installed" in said
    assert "2 of 2 judged quantities PASS." in said
    assert "not complete" not in said


def test_text_from_the_store_is_escaped(tmp_path: Path) -> None:
    fixtures.make(tmp_path, ("cpdi",))
    store = Store(tmp_path)
    store.create(replace(store.study(), title="<img src=x>", command="verify mms --out 'a & b'"))
    page = render(tmp_path).read_text()
    assert "<img src=x>" not in page
    assert "&lt;img src=x&gt;" in page
    assert "a &amp; b" in page


def test_folder_that_is_no_study_is_one_clear_line(tmp_path: Path) -> None:
    with pytest.raises(StoreError, match=r"not a study folder"):
        render(tmp_path)


def test_domains_are_the_deformed_parallelograms() -> None:
    arrays = {
        "x": np.array([[0.5, 0.25]], np.float32),
        "F": np.array([[[2.0, 1.0], [0.0, 1.0]]], np.float32),
        "r0": np.array([[[0.125, 0.0], [0.0, 0.125]]], np.float32),
    }
    corners = [[0.5 - 0.375, 0.125], [0.5 + 0.125, 0.125], [0.5 + 0.375, 0.375], [0.5 - 0.125, 0.375]]
    np.testing.assert_allclose(domains(arrays)[0], corners)


def test_field_is_of_the_run_asked_for_or_the_nearest_that_finished(folder: Path) -> None:
    record = read(folder)
    first, other = choose(record, "cpdi", "axis_aligned"), choose(record, "mpm", "axis_aligned", 128, 9)
    assert first
    assert (first.cells, first.ppc) == (16, 4)
    assert other
    assert (other.cells, other.ppc) == (64, 9)


def test_what_the_auditor_said_stands_beside_each_verdict_and_at_the_end(tmp_path: Path) -> None:
    record = read(fixtures.make(tmp_path, ("cpdi",)))
    shear, volume = "F is diagonal everywhere: there is no shear, ", "det F runs from 0.5 to 1.7, "
    assert all(card.unseen.startswith(shear) for card in cards(record))
    assert not [card.unseen for card in cards(record) if "Seen by" in card.unseen]
    assert len(audited.blind(record, "axis_aligned")) == 3
    assert len(audited.seen(record, "axis_aligned")) == 1
    page = text(render(tmp_path).read_text())
    assert f"Not seen here. {shear}" in page
    assert "Seen by clamped_shear, generalised_vortex, swirl." in page
    assert volume in page


def test_results_without_an_audit_say_what_always_holds(tmp_path: Path) -> None:
    folder = fixtures.make(tmp_path, ("cpdi",))
    record = read(folder)
    bare = replace(record, results={key: replace(r, audit=()) for key, r in record.results.items()})
    assert audited.blind_spots(bare, "axis_aligned") == ALWAYS
    assert {card.unseen for card in cards(bare)} == {""}


@pytest.mark.parametrize(
    ("value", "written"),
    [(1.127e-5, "1.127e-5"), (0.0, "0"), (float("nan"), words.DASH), (None, words.DASH), (12345.0, "1.234e4")],
)
def test_numbers_are_written_alike(value: float | None, written: str) -> None:
    assert words.sci(value) == written


def test_words_of_expectations_and_failures() -> None:
    expected = QuantityPlan(Run(solution="affine"), "u", "rms", True, Expectation(2.0))
    assert verdicts.registered(expected.expectation) == "2.00 (1.80 to 2.30)"
    assert verdicts.registered(Expectation(None)) == "diverges"
    assert words.series(Run("mpm", "affine", "neo_hookean", 8, 9, 0.4)) == "MPM, 9 per cell"
    assert (
        failures.failure(Failure(FailureKind.INVERTED, 3, 7, (1, 2)))
        == "det F ≤ 0 at step 3, particle 7 in cell (1, 2)"
    )
    assert words.order(-0.476) == f"{words.MINUS}0.48"


def test_where_nothing_finished_a_card_says_so_and_nothing_of_what_it_sees(tmp_path: Path) -> None:
    record = read(fixtures.make(tmp_path, ("cpdi",)))
    assert all(card.finished for card in cards(record))
    failed = {key: replace(r, status="failed", errors={}, failure=Failure(FailureKind.INVERTED, 3))
              for key, r in record.results.items()}  # fmt: skip
    (card, *more) = cards(replace(record, results=failed))
    assert not any(one.finished or one.unseen or one.seen for one in (card, *more))
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(mms, "cards", lambda record: [card])
        page = text(render(tmp_path).read_text())
    assert "Nothing finished. What a study of this solution sees" in page
    assert "Not seen here" not in page
