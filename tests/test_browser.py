"""The pages in a real browser, light, dark and on paper: missing images, console errors, scrolling, clipped figures,
cut tables, network, keyboard; and that these checks can fail."""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import fixtures_study as fixtures
import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from mpm_verify.cases.harness.analysis import Analysis
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.checks import Check
from mpm_verify.cases.harness.runner import InProcess, run_study
from mpm_verify.cases.harness.store import Store
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.harness.study_file import study_of
from mpm_verify.cases.objectivity import execute as objectivity_execute
from mpm_verify.cases.objectivity import rates as objectivity_kinematic
from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.cases.objectivity.exact import rotated
from mpm_verify.cases.objectivity.rates import STEPS
from mpm_verify.reports.frames import Record, read
from mpm_verify.verify.run import page_of

CHROMIUM, DRIVER = Path("/usr/bin/chromium"), Path("/usr/bin/chromedriver")
WIDTHS = (1280, 768, 390)
PAPER = 703  # pixels: A4 between margins of 12 mm
ARGUMENTS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
MISSING = (
    "return [...document.images].filter(i => !(i.complete && i.naturalWidth > 0)).map(i => i.alt || i.src.slice(0, 60))"
)
OVERFLOW = "const d = document.documentElement; return d.scrollWidth - d.clientWidth"
FIGURES = "svg[role=img]"
SMALLEST = f"""
return Math.min(...[...document.querySelectorAll("{FIGURES}")].map(i => i.getBoundingClientRect().width / innerWidth))
"""
# texts, legends and axes of a figure that are not inside its canvas
CLIPPED = f"""
return [...document.querySelectorAll("{FIGURES}")].filter(svg => svg.getBoundingClientRect().width).flatMap(svg => {{
  const canvas = svg.getBoundingClientRect();
  const parts = svg.querySelectorAll("[id*='-text_'], [id*='-legend_'], [id*='-axis_'], [id*='-series-'] use");
  return [...parts].filter(part => {{
    const box = part.getBoundingClientRect();
    return box.width && (box.left < canvas.left - 1 || box.right > canvas.right + 1 || box.top < canvas.top - 1
      || box.bottom > canvas.bottom + 1);
  }}).map(part => svg.getAttribute("aria-label").slice(0, 40) + ": " + part.id);
}})
"""
# tables that are wider than their box, and cells that are not inside it or not seen
CUT = """
return [...document.querySelectorAll("table")].flatMap(table => {
  const box = table.parentElement.getBoundingClientRect(), wrong = [];
  for (const cell of table.querySelectorAll("tbody tr > *")) {
    const at = cell.getBoundingClientRect();
    const seen = at.width && at.right < box.right + 1 && at.left > box.left - 1;
    if (cell.textContent && !seen) wrong.push(cell.textContent);
  }
  const heads = [...table.querySelectorAll("thead th")].map(head => head.textContent);
  if (!table.tHead.getBoundingClientRect().width) {
    const named = new Set([...table.querySelectorAll("td")].map(cell => cell.dataset.head));
    const leads = table.querySelector("tbody tr:not(.group)").querySelectorAll("th").length;
    wrong.push(...heads.slice(leads).filter(head => !named.has(head)));
  }
  return wrong.slice(0, 2).map(text => table.caption.textContent.slice(0, 40) + ": " + text.slice(0, 40));
})
"""
LOADED = (
    "return performance.getEntriesByType('resource').map(one => one.name).filter(name => !name.startsWith('data:'))"
)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[webdriver.Chrome]:
    """Headless Chromium with a profile of its own. Where CI is set, a missing browser is a failure."""
    absent = [str(path) for path in (CHROMIUM, DRIVER) if not path.exists()]
    if absent:
        say = pytest.fail if os.environ.get("CI") else pytest.skip
        say(f"the report cannot be opened in a browser: {' and '.join(absent)} not installed")
    options = webdriver.ChromeOptions()
    options.binary_location = str(CHROMIUM)
    for argument in (*ARGUMENTS, f"--user-data-dir={tmp_path_factory.mktemp('profile')}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(str(DRIVER)))
    yield driver
    driver.quit()


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a whole study."""
    with fixtures.sources():
        return page_of(read(fixtures.make(tmp_path_factory.mktemp("study"))))


@pytest.fixture(scope="module")
def unfinished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The report of a study with runs still to be done."""
    with fixtures.sources():
        return page_of(read(fixtures.make(tmp_path_factory.mktemp("study"), skip=20)))


def console(browser: webdriver.Chrome) -> list[str]:
    """What the console said since it was last asked."""
    return [entry["message"] for entry in browser.get_log("browser")]  # type: ignore[no-untyped-call]  # selenium


def look(
    browser: webdriver.Chrome, page: Path, width: int, scheme: str = "light", media: str = "screen"
) -> dict[str, Any]:
    """What is wrong with a page `width` pixels wide, with all that folds unfolded: empty where nothing is."""
    metrics = {"width": width, "height": 800, "deviceScaleFactor": 1, "mobile": False}
    features = [{"name": "prefers-color-scheme", "value": scheme}]
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": media, "features": features})
    browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)  # a window cannot be 360 wide
    console(browser)  # drops what earlier pages said
    browser.get(page.as_uri())
    browser.execute_script("document.querySelectorAll('details').forEach(d => d.open = true)")
    found = {
        "missing": browser.execute_script(MISSING),
        "overflow": max(0, browser.execute_script(OVERFLOW)),
        "console": console(browser),
        "cut": browser.execute_script(CUT),
        "clipped": browser.execute_script(CLIPPED),
        "loaded": browser.execute_script(LOADED),
    }
    return {name: wrong for name, wrong in found.items() if wrong}


def count(browser: webdriver.Chrome, selector: str = FIGURES) -> int:
    """Number of elements of the page."""
    return len(browser.find_elements("css selector", selector))


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", WIDTHS)
def test_whole_study(browser: webdriver.Chrome, page: Path, width: int, scheme: str) -> None:
    assert look(browser, page, width, scheme) == {}
    assert count(browser) == 7


def test_paper_has_each_column(browser: webdriver.Chrome, page: Path) -> None:
    assert look(browser, page, PAPER, media="print") == {}
    assert count(browser, "tr") > 100
    assert browser.execute_script("return getComputedStyle(document.querySelector('nav')).display") == "none"


def luminance(colour: str) -> float:
    """Relative luminance of `rgb(r, g, b)`, as the guidelines for accessible content define it."""
    parts = [int(part) / 255 for part in colour[4:-1].split(",")]
    red, green, blue = (p / 12.92 if p <= 0.03928 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


COLOURS = """
const of = (selector, name) => getComputedStyle(document.querySelector(selector))[name];
return [of("body", "backgroundColor"), of("body", "color"), of("figure [id$='-patch_1'] path", "fill"),
  ...[...document.querySelectorAll("[id^='figure1_rms-series-'] path")].map(path => getComputedStyle(path).stroke)]
"""


@pytest.mark.parametrize(("scheme", "media"), [("light", "screen"), ("dark", "screen"), ("dark", "print")])
def test_text_and_lines_stand_out_from_their_ground(
    browser: webdriver.Chrome, page: Path, scheme: str, media: str
) -> None:
    """Text 7 : 1, lines of figures 3 : 1; on paper the ground is white, whatever the screen was."""
    look(browser, page, 1280, scheme, media)
    ground, ink, paper, *lines = [luminance(one) for one in browser.execute_script(COLOURS) if one != "none"]
    assert (ground < 0.1) == (paper < 0.1) == ((scheme, media) == ("dark", "screen"))
    assert contrast(ink, ground) > 7
    assert len(lines) > 3
    assert min(contrast(line, paper) for line in lines) > 3


def contrast(a: float, b: float) -> float:
    """Ratio of two luminances."""
    return (max(a, b) + 0.05) / (min(a, b) + 0.05)


@pytest.mark.parametrize("width", [1280, 390])
def test_unfinished_study(browser: webdriver.Chrome, unfinished: Path, width: int) -> None:
    assert look(browser, unfinished, width) == {}


def test_figures_take_the_width_of_a_phone(browser: webdriver.Chrome, page: Path) -> None:
    assert look(browser, page, 360) == {}
    assert browser.execute_script(SMALLEST) > 0.8


# ---- pointer and keyboard


def opened(browser: webdriver.Chrome, page: Path) -> Callable[[str], Any]:
    """Show a page as wide as a desk, and give the query of one of its elements."""
    look(browser, page, 1280)
    return lambda selector: browser.find_element("css selector", selector)


FIRST = "#figure1 + .panels figure:first-child"  # error of u in rms
COVERED = "return getComputedStyle(document.querySelector(arguments[0])).display"


def test_points_tell_their_run_and_open_its_card(browser: webdriver.Chrome, page: Path) -> None:
    """Points answer pointer and keys; the card has parameters, errors, command and a picture, and closes by Escape."""
    one = opened(browser, page)
    points = browser.find_elements("css selector", f"{FIRST} .point")
    assert len(points) == sum(map(len, fixtures.U_RMS.values()))
    assert [point.get_attribute("tabindex") for point in points].count("0") == 1
    browser.execute_script("arguments[0].focus()", points[0])
    assert (
        one(".tip").text
        == "CPDI, 1 per cell, cells 8, Courant 0.4: rms errors u 2.884e-3, v 9.229e-1, F 3.172e-2, σ 2.596e2"
    )
    points[0].send_keys(Keys.ARROW_RIGHT)
    assert "cells 16, Courant 0.4: rms errors u 1.029e-3" in one(".tip").text
    browser.switch_to.active_element.send_keys(Keys.ENTER)
    card = one("dialog")
    assert card.get_attribute("open") is not None
    assert card.find_element("css selector", "h2").text == "CPDI, 1 per cell, cells 16, Courant 0.4"
    for said in ("rms 1.029e-3, max 3.190e-3", "finished", "verify mms --method cpdi --solution axis_aligned"):
        assert said in card.text
    assert card.find_element("css selector", "img").get_attribute("alt")
    ActionChains(browser).send_keys(Keys.ESCAPE).perform()
    assert card.get_attribute("open") is None
    assert browser.switch_to.active_element == points[1]
    ActionChains(browser).move_to_element(points[3]).perform()
    assert "cells 64" in one(".tip").text
    points[3].click()
    assert "cells 64" in one("dialog h2").text
    one("dialog button").click()
    assert one("dialog").get_attribute("open") is None


def test_a_series_is_hidden_with_its_points(browser: webdriver.Chrome, page: Path) -> None:
    one = opened(browser, page)
    button = one(f"{FIRST} .series button:nth-child(2)")
    assert button.text == "CPDI, 4 per cell"
    assert count(browser, f"{FIRST} .off") == 0
    button.click()
    assert count(browser, f"{FIRST} .point.off") == len(fixtures.U_RMS["cpdi", 4])
    assert browser.execute_script(COVERED, f"{FIRST} [id$='-series-1-0']") == "none"
    assert browser.execute_script(COVERED, f"{FIRST} [id$='-series-0-0']") != "none"
    button.send_keys(Keys.SPACE)
    assert count(browser, f"{FIRST} .off") == 0


SHOWN = """
return [...document.querySelectorAll("#orders + div + .scroll tbody:first-of-type tr:not(.group):not([hidden])")]
  .slice(0, arguments[0]).map(row => row.cells[1].textContent)
"""


def test_tables_sort_within_their_blocks_and_filter(browser: webdriver.Chrome, page: Path) -> None:
    one = opened(browser, page)
    first = browser.execute_script(SHOWN, 5)
    assert [float(e) for e in first] == list(fixtures.U_RMS["cpdi", 1])
    head = one("#orders + div + .scroll th:nth-child(2) button")
    head.click()
    assert [float(e) for e in browser.execute_script(SHOWN, 5)] == sorted(fixtures.U_RMS["cpdi", 1])
    head.send_keys(Keys.ENTER)
    assert browser.execute_script(SHOWN, 5) == first
    assert one("#orders + div + .scroll th:nth-child(2)").get_attribute("aria-sort") == "descending"
    one("#orders + div + .scroll input").send_keys("MPM, 9 per cell: u")
    assert one("#orders + div + .scroll output").text == "5 of 30 rows"
    assert count(browser, "#orders + div + .scroll .group:not([hidden])") == 1


TREE = """
const every = selector => [...document.querySelectorAll(selector)];
const named = one => one.getAttribute("aria-label") || one.textContent.trim();
return {
  landmarks: ["header", "nav[aria-label]", "main", "footer"].map(one => every(`body > ${one}`).length),
  nameless: every("a, button, input, svg[role=img], [role=region]").filter(one => !named(one)).length,
  dead: every('a[href^="#"]').filter(one => !document.getElementById(one.hash.slice(1))).length,
  twice: every("[id]").length - new Set(every("[id]").map(one => one.id)).size,
}
"""


def test_landmarks_names_and_links(browser: webdriver.Chrome, page: Path) -> None:
    """Each control has a name, each link a goal, each name one element; the first stop leads past the contents."""
    opened(browser, page)
    assert browser.execute_script(TREE) == {"landmarks": [1, 1, 1, 1], "nameless": 0, "dead": 0, "twice": 0}
    browser.execute_script("document.activeElement.blur(); scrollTo(0, 0)")
    ActionChains(browser).send_keys(Keys.TAB).perform()
    assert browser.switch_to.active_element.text == "Skip to the content"


def test_what_is_folded_unfolds_for_a_link_and_for_paper(browser: webdriver.Chrome, page: Path) -> None:
    look(browser, page, 1280)
    browser.get(page.as_uri())
    folded = count(browser, "details:not([open])")
    assert folded > 5
    goal = browser.execute_script("return document.querySelector('.run').id")
    browser.execute_script("location.hash = arguments[0]", goal)
    assert count(browser, f"details[open] > #{goal}[open]") == 1
    closed = "document.querySelectorAll('details:not([open])').length"
    browser.execute_script(f"addEventListener('beforeprint', () => {{ window.folded_on_paper = {closed} }})")
    browser.execute_cdp_cmd("Page.printToPDF", {})
    assert browser.execute_script("return window.folded_on_paper") == 0
    assert count(browser, "details:not([open])") == folded - 2


# ---- examinations: a function that makes the page, and how many images it has


def ran(folder: Path, study: Study) -> Record:
    """A study run in this process."""
    store = Store(folder, study.case)
    store.create(study)
    return Record(store, study, run_study(study, store, InProcess(), 1), earlier=False)


def spoilt(record: Record, spoil: Callable[[tuple[Check, ...]], tuple[Check, ...]]) -> Record:
    """The record with other checks in its one Examination."""
    found = record.analysis
    ((name, one),) = found.more.examinations.items()
    other = replace(one, checks=spoil(one.checks))
    more = replace(found.more, examinations={name: other})
    vars(record)["analysis"] = Analysis(found.findings, other.checks, more)
    return record


def closed_form(block: Block, tick: object) -> tuple[dict[str, Any], None]:
    """Stand-in for a run of the block: its closed form with a ripple."""
    t = np.linspace(0.02, 2, 100)
    angle = np.pi / 2 * np.maximum(0, t - 1)
    ripple = 1 + 0.02 * block.L * np.sin(20 * t)
    xx, yy, xy = rotated(-3 / 7 * np.minimum(t, 1), -np.minimum(t, 1), angle).T * ripple
    own = {"own_xx": -3 / 7 * ripple, "own_yy": -ripple, "own_xy": 1e-3 * ripple, "shear": 0.1 * ripple}
    X, Y = np.meshgrid(np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 5))
    mean = {"t": t, "angle": angle, "xx": xx, "yy": yy, "zz": xx, "xy": xy, **own}
    field = {"X": X.ravel(), "Y": Y.ravel(), **{name: np.ones(25) for name in ("own_xx", "own_yy", "own_xy")}}
    return {"mean": mean, "field": field}, None


def objectivity(folder: Path) -> Path:
    """The page of `verify objectivity`, with a check that failed and one without a number."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(objectivity_execute, "turn", closed_form)
        patch.setattr(objectivity_kinematic, "order_errors", lambda rate, counts=STEPS: 1 / np.array(counts) ** 2.0)
        patch.setattr(objectivity_kinematic, "simple_shear", lambda rate, gamma, steps: np.ones(2) * gamma / steps)
        study = build(Asked("objectivity", {}), "verify objectivity --cells 8 --out " + "/a/long/path" * 9)
        record = ran(folder, study)
    named = "a stress_" + "with_a_long_name_" * 5
    return page_of(spoilt(record, lambda c: (replace(c[0], found=np.nan), replace(c[1], name=named), *c[2:])))


def material(folder: Path) -> Path:
    """Three element tests of UBCSAND in few steps, with a check that misses."""
    tests = ["biaxial", "shear_volume", "cyclic_shear", "properties"]
    axes = {"material": ["ubcsand"], "test": tests, "steps": [12]}
    record = ran(folder, build(Asked("element", axes), "verify material ubcsand"))
    return page_of(spoilt(record, lambda checks: (*checks, replace(checks[0], found=9.0, way="at_most"))))


def column(folder: Path) -> Path:
    """Four small columns, one of them lost, in two families; animations too."""
    run = {"cells": 4, "duration": 0.4, "material": "drucker_prager"}
    axes = {"ppc": [1, 4, 9, 16], "limit": [0.5, 9.0]}
    content = {"title": "Columns", "words": ["What it is for."], "run": run, "sweep": axes}
    return page_of(ran(folder, study_of("columns", content, "verify sweep " + "/a/long/path" * 9)))


EXAMINED: dict[str, tuple[Callable[[Path], Path], int]] = {
    "objectivity": (objectivity, 8),
    "material": (material, 9),
    "column": (column, 11),
}


@pytest.fixture(scope="module", params=EXAMINED)
def examined(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, int]:
    """The page of an examination, and how many images it has."""
    make, images = EXAMINED[request.param]
    return make(tmp_path_factory.mktemp(request.param)), images


@pytest.mark.slow
@pytest.mark.parametrize("width", WIDTHS)
def test_examinations(browser: webdriver.Chrome, examined: tuple[Path, int], width: int) -> None:
    page, images = examined
    assert look(browser, page, width) == {}
    assert count(browser) == images
    assert "Checks that did not pass" in browser.page_source
    assert width > 700 or browser.execute_script(SMALLEST) > 0.8
    if width == WIDTHS[0]:
        assert look(browser, page, width, "dark") == look(browser, page, PAPER, media="print") == {}


FRAME = """
const box = document.querySelector(".film"), canvas = box.querySelector("canvas"), range = box.querySelector("input");
range.value = arguments[0]; range.dispatchEvent(new Event("input"));
const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
let drawn = 0, right = 0;
for (let k = 3; k < pixels.length; k += 4)
  if (pixels[k]) { drawn++; right = Math.max(right, (k - 3) / 4 % canvas.width); }
return [drawn, right / canvas.width, box.querySelector("output").textContent];
"""


@pytest.mark.slow  # ten seconds
def test_a_film_plays(browser: webdriver.Chrome, tmp_path: Path) -> None:
    """Frames are drawn, the sand moves to the right, and the button plays and pauses it."""
    look(browser, column(tmp_path), 1280)
    (drawn, first, told), (_, last, at) = (browser.execute_script(FRAME, frame) for frame in (0, 56))
    assert drawn > 500
    assert first < 0.5 < last
    assert (told, at) == ("0.00 s", "0.40 s")
    button = browser.find_element("css selector", ".film button")
    button.click()
    assert button.text == "Pause"
    time.sleep(0.3)
    button.click()
    assert button.text == "Play"
    assert 0 < float(browser.find_element("css selector", ".film output").text.removesuffix(" s")) < 0.4


WIDE = (
    "<table {}><caption>a</caption><thead><tr><th>b</th></tr></thead><tbody><tr>"
    "<td style='min-width: 99rem; {}'>far</td></tr></tbody></table>"
)


@pytest.mark.parametrize(
    ("body", "wrong"),
    [
        ('<img src="data:image/png;base64,AAAA" alt="broken">', "missing"),
        ('<div style="width: 2000px">too wide</div>', "overflow"),
        ("<script>console.error('a fault')</script>", "console"),
        ("<script>missing_function()</script>", "console"),
        (f"<div style='overflow: hidden'>{WIDE.format('', '')}</div>", "cut"),
        (f"<div style='overflow: hidden'>{WIDE.format('class=x', 'display: none')}</div>", "cut"),
        ('<svg role="img" width="100" aria-label="a"><text id="a-text_1" x="90" y="9">clipped</text></svg>', "clipped"),
    ],
)
@pytest.mark.parametrize("width", [1280, 390])
def test_the_checks_can_fail(
    browser: webdriver.Chrome, page: Path, tmp_path: Path, width: int, body: str, wrong: str
) -> None:
    spoilt = tmp_path / "report.html"
    spoilt.write_text(page.read_text().replace("</main>", f"{body}</main>"))
    assert list(look(browser, spoilt, width)) == [wrong]
