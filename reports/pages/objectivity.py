"""Page of `verify objectivity`: Figure 2, what it can and cannot show, orders, and rates in simple shear."""

from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.harness.checks import Curves, Examination
from mpm_verify.cases.objectivity.block import GROUP as RUN
from mpm_verify.cases.objectivity.block import PRINTED, REST, SMALL
from mpm_verify.cases.objectivity.findings import INERTIA
from mpm_verify.cases.objectivity.rates import CONTROLS, ORDERS, SHEAR
from mpm_verify.cases.objectivity.rates import FIGURE2 as KINEMATIC
from mpm_verify.reports.components.examined import Section, checks_table
from mpm_verify.reports.components.examined_study import page as examined_page
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.table import Table
from mpm_verify.reports.figures import objectivity as draw
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import notes
from mpm_verify.reports.words import sci

FAILING = (
    "Shear stress along the motion of Figure 2 by each negative control, kinematic, 200 steps; the broad line is "
    "right, and crosses are the controls that this figure cannot tell from it."
)
MISSES = "Largest miss of each negative control, as a fraction of the stress; ∞ where the run failed"


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    return examined_page(record, sections)


def sections(examination: Examination, add: Add) -> Sequence[Section]:
    """Sections, each with the figures that its curves are there for."""
    parts = [part(examination, add) for part in (figure2, inertia, controls, orders, rates)]
    return [part for part in parts if part.text or part.figures or part.tables]


def of(curves: Curves, start: str) -> Curves:
    """Curves whose names begin with `start/`, without it."""
    return {name[len(start) + 1 :]: curve for name, curve in curves.items() if name.startswith(start + "/")}


def _checks(examination: Examination, group: str) -> Table:
    return checks_table(group, [check for check in examination.checks if check.group == group])


def figure2(examination: Examination, add: Add) -> Section:
    """Section of the stresses of the turned block."""
    curves, runs = examination.curves, of(examination.curves, "run")
    exact = curves["exact"]
    images = [
        (add(f"figure2_{key}", draw.stresses(exact, {name: runs[name]}, curves["wave"] if key == "printed" else None),
             f"Mean stress of the {name} over time: lines of the closed form, marks of the CPDI run."),
         f"{name}: lines are the closed form, marks the mean over all particles of the CPDI run.")
        for key, name in (("printed", PRINTED), ("small", SMALL)) if name in runs
    ]  # fmt: skip
    return Section(
        "figure2", "Figure 2: a block is loaded by gravity and turned by 90°", notes(examination, RUN), images,
        [_checks(examination, RUN), _checks(examination, KINEMATIC)],
    )  # fmt: skip


def inertia(examination: Examination, add: Add) -> Section:
    """Section on what is inertia and what is not."""
    curves = of(examination.curves, "run")
    runs = {name: curves[name] for name in (PRINTED, REST, SMALL) if name in curves}
    images = []
    if len(runs) == 3:
        shear, away = draw.co_rotated({name: runs[name] for name in (PRINTED, SMALL)}), draw.inertia(runs)
        images = [
            (add("co_rotated", shear, "Co-rotated shear stress over time, two block sizes."),
             "Shear stress in the frame of the box: the mean over the block, and the largest of any particle."),
            (add("inertia", away, "Co-rotated vertical stress less its static value over time, three runs."),
             "What the block's mean vertical stress has beyond its static value. The run that is not turned feels the "
             "inertial forces of the turning box, in a box at rest."),
        ]  # fmt: skip
    heading = "What the turning box feels: co-rotated stresses and inertia"
    return Section("inertia", heading, notes(examination, INERTIA), images)


def controls(examination: Examination, add: Add) -> Section:
    """Section of the negative controls on the same figure."""
    curves = examination.curves
    found, images = of(curves, "figure2"), []
    if found:
        image = add("controls", draw.controls(curves["exact"], found),
                    "Shear stress of the turned block by each negative control.")  # fmt: skip
        images = [(image, FAILING)]
    rows = tuple(
        (name.replace("_", " "), *(sci(float(curve[key][0])) for key in ("kinematic", "run", "stretched")))
        for name, curve in of(curves, "control").items()
    )
    head = ("negative control", "Figure 2, kinematic", "Figure 2, the CPDI run", "stretched turn, 400 steps")
    return Section(
        "controls", "Negative controls", notes(examination, CONTROLS),
        images, [Table(MISSES, head, rows),
                 _checks(examination, CONTROLS)],
    )  # fmt: skip


def orders(examination: Examination, add: Add) -> Section:
    """Section of errors against the step."""
    errors = of(examination.curves, "errors")
    heading, known = "Orders in time: a turn with strain", _checks(examination, ORDERS)
    if not errors:
        return Section("orders", heading, notes(examination, ORDERS), (), [known])
    right = [name for name, curve in errors.items() if curve["right"][0]]
    steps = next(iter(errors.values()))["steps"]
    rows = tuple((name.replace("_", " "), *map(sci, map(float, curve["error"]))) for name, curve in errors.items())
    return Section(
        "orders", heading, notes(examination, ORDERS),
        [(add("orders", draw.orders(errors, right), "Error against the number of steps."),
          "Full lines: rates. Broken lines: negative controls; those that do not fall never converge.")],
        [Table("Relative error at the end", ("rate or control", *(f"{n:g} steps" for n in steps)), rows), known],
    )  # fmt: skip


def rates(examination: Examination, add: Add) -> Section:
    """Section of the rates in simple shear."""
    exact, computed = of(examination.curves, "shear"), of(examination.curves, "computed")
    images = [
        (add(f"shear_{key}", draw.shear(exact, computed, key), f"Component {key} of the stress in simple shear."), text)
        for key, text in (("s12", "Shear stress: lines are closed forms, marks what was computed."),
                          ("s11", "Normal stress along the shear; σ₂₂ = −σ₁₁, and 0 for Truesdell."))
        if exact
    ]  # fmt: skip
    return Section("rates", "Objective is not unique: four rates in simple shear to γ = 8", notes(examination, SHEAR),
                   images, [_checks(examination, SHEAR)])  # fmt: skip
