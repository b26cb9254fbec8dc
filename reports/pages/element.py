"""Page of `verify material`: each element test with its curves, then the errors, then the material's own checks."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from mpm_verify.cases.harness.checks import Curves, Examination
from mpm_verify.reports.components.examined import Section, checks_table
from mpm_verify.reports.components.examined_study import page as examined_page
from mpm_verify.reports.components.page import Add, Image
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures import element as draw
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import notes
from mpm_verify.reports.words import order, sci
from mpm_verify.solver.state import Floats

SHEAR = "finite_shear"


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    kinds = ("svg", "pdf")  # some two dozen figures: PNG takes half the time
    return examined_page(record, sections, kinds, sheared)


def sheared(found: Mapping[str, Examination], add: Add) -> Sequence[Section]:
    """Section of simple shear of F by several rates, each over its closed form; none where there is one at most."""
    rates = {str(one.parameters["rate"]): one for one in found.values() if f"exact/{SHEAR}" in one.curves}
    if len(rates) < 2:
        return []
    own = {rate: rates_of(one, f"test/{SHEAR}") for rate, one in rates.items()}
    exact = {rate: rates_of(one, f"exact/{SHEAR}") for rate, one in rates.items()}
    words = [
        "The shear γ is that of F = [[1, γ], [0, 1]], from zero stress, and G the shear modulus: the objective rate of "
        "the stress is 2 G D. All rates agree in small strain; at γ = 5 they do not: the rate is part of the model. "
        "The number of steps decides how well a rate is integrated, with order 2; Truesdell's is exact in any number."
    ]
    alt = "Shear and normal stress over G against the shear, four rates, over their closed forms."
    image = add("rates", draw.rates(own, exact), alt)
    caption = "Lines: computed, the finest run; broad: closed forms. Left the shear stress, right the normal stress xx."
    return [Section("rates", "Objective rates in simple shear", words, [(image, caption)],
                    [shear_table(own, exact), error_table(rates)], wide=True)]  # fmt: skip


def rates_of(one: Examination, name: str) -> dict[str, Floats]:
    """Columns gamma, and xy and xx over G less what they begin with."""
    curve, G = one.curves[name], float(one.parameters["E"]) / (2 * (1 + float(one.parameters["nu"])))
    return {
        "gamma": curve["gamma"],
        "xy": (curve["tau"] - curve["tau"][0]) / G,
        "xx": (curve["sx"][0] - curve["sx"]) / G,
    }


def shear_table(own: Mapping[str, dict[str, Floats]], exact: Mapping[str, dict[str, Floats]]) -> Table:
    """Table of stresses over G at whole shears: computed, and by the closed form."""
    rows: list[tuple[str, ...]] = []
    for rate, curve in own.items():
        for gamma in range(1, int(curve["gamma"].max()) + 1):
            at = [float(np.interp(gamma, c["gamma"], c[of])) for of in ("xy", "xx") for c in (curve, exact[rate])]
            rows.append((rate.replace("_", " "), str(gamma), *(f"{value:.6f}" for value in at)))
    head = ("rate", "γ", "σxy/G", "closed form", "σxx/G", "closed form")
    return Table("Stresses at whole shears, finest run", head, tuple(rows))


def error_table(rates: Mapping[str, Examination]) -> Table:
    """Table of errors by number of steps, and orders."""
    errors = {rate: one.curves[f"errors/{SHEAR}"] for rate, one in rates.items()}
    counts = next(iter(errors.values()))["steps"]
    rows = tuple(
        (rate.replace("_", " "), *map(sci, map(float, curve["error"])), order(float(curve["order"][0])))
        for rate, curve in errors.items()
    )
    head = ("rate", *(f"{n:g} steps" for n in counts), "order")
    return Table("Error at the end, over the largest stress", head, rows)


def sections(examination: Examination, add: Add) -> Sequence[Section]:
    """Sections: one for each test, one for the errors, one for what is known of the material."""
    names = [name.partition("/")[2] for name in examination.curves if name.startswith("errors/")]
    noted = dict.fromkeys(finding.group for finding in examination.findings if finding.group)
    titles = dict(zip(names, noted, strict=True))
    tests = [test(examination, name, titles[name], add) for name in names]
    rest = [group for group in examination.groups if group not in titles.values()]
    known = [checks_table(group, [c for c in examination.checks if c.group == group]) for group in rest]
    own = [
        Section(
            "known",
            "What is known of the material",
            ["Tables, limits and invariants, in runs of 100 steps unless said."],
            (),
            known,
        )
    ]
    return [*tests, *([steps(examination, titles, add)] if titles else []), *(own if known else [])]


def test(examination: Examination, name: str, title: str, add: Add) -> Section:
    """Section of a test: stress path, stress and volume against strain, over the closed form where there is one."""
    curves = examination.curves
    checks = [check for check in examination.checks if check.group == title]
    tables, words = [checks_table("Checks", checks)] if checks else [], [" ".join(notes(examination, title))]
    if f"test/{name}" not in curves:
        return Section(name, title, words, (), tables)
    curve, exact = curves[f"test/{name}"], curves.get(f"exact/{name}")
    shear, strength = bool(curves[f"kind/{name}"]["shear"][0]), curves.get("strength")
    line = (float(strength["a"][0]), float(strength["b"][0])) if strength else None
    axial = "q" in curve and not shear
    x = "gamma" if shear or np.ptp(curve["gamma"]) > 0.5 * np.ptp(curve["ey"]) else "ey"
    y = "tau" if shear else "t" if x == "gamma" else "sy"
    if axial:
        x, y = "ey", "q"
    marks: Curves = {key: curves[f"{key}/{name}"] for key in ("marks",) if f"{key}/{name}" in curves}
    points = (
        {key: list(zip(marks["marks"]["gamma"], marks["marks"][key], strict=True)) for key in ("t", "ev")}
        if marks
        else {}
    )
    limit = float(curves[f"limit/{name}"]["tau"][0]) if f"limit/{name}" in curves else None
    against = draw.stress(curve, exact, x, y, points.get("t", ()) if y == "t" else (), limit)
    images: list[tuple[Image, str]] = [
        (add(f"{name}_path", draw.path(curve, exact, line), f"{title}: stress path."), "Stress path."),
        (add(f"{name}_stress", against, f"{title}: stress against strain."), "Stress against strain."),
    ]
    if np.abs(curve["ev"]).max() > 1e-9:
        volume = draw.volume(curve, exact, x, shear, points.get("ev", ()))
        images.append((add(f"{name}_volume", volume, f"{title}: volume strain."), "Volume strain."))
    return Section(name, title, words, images, tables)


def steps(examination: Examination, titles: dict[str, str], add: Add) -> Section:
    """Section of errors and orders in the strain step."""
    errors = {name: examination.curves[f"errors/{name}"] for name in titles}
    rows = tuple(
        (titles[name], *map(sci, map(float, curve["error"])), order(float(curve["order"][0])))
        for name, curve in errors.items()
    )
    counts = next(iter(errors.values()))["error"]
    head = ("test", *(f"{2**n} times" for n in range(len(counts))), "order")
    words = [
        "Errors at the end of each test, of the stress over the largest stress and of the volume over the largest "
        "strain: against the exact curve, or the test's own with 64 times the steps. Where each step is exact they "
        "are round-off, and there is no order.",
    ]
    image = add("errors", draw.errors(errors, titles), "Error at the end against the number of steps.")
    table = Table("Error at the end by number of steps", head, rows)
    caption = "Error at the end against the number of steps."
    return Section("steps", "Errors in the strain step", words, [(image, caption)], [table])
