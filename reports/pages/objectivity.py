"""Page of `verify objectivity`: Figure 2, what it can and cannot show, orders, and rates in simple shear."""

from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.harness.checks import Curves, Examination
from mpm_verify.cases.objectivity.block import GROUP as RUN
from mpm_verify.cases.objectivity.block import PRINTED, REST, SMALL
from mpm_verify.cases.objectivity.findings import CONTROLS, INERTIA
from mpm_verify.cases.objectivity.rates import FIGURE2 as KINEMATIC
from mpm_verify.cases.objectivity.rates import ORDERS, SHEAR
from mpm_verify.reports.components.examined import Section, checks_table
from mpm_verify.reports.components.examined_study import page as examined_page
from mpm_verify.reports.components.page import Add
from mpm_verify.reports.components.show import Table
from mpm_verify.reports.figures import objectivity as draw
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences.remarks import notes
from mpm_verify.reports.words import sci

MISSES = "Largest miss of each negative control, as a fraction of the stress; ∞ where the run failed"


def page(record: Record, vtk: bool = False) -> Path:
    """Write the page; its path. There are no snapshots, whatever `vtk` says. Raises StoreError."""
    return examined_page(record, sections)


def sections(examination: Examination, add: Add) -> Sequence[Section]:
    """Sections; those of the CPDI runs only where all three have something to draw."""
    whole = all(f"run/{name}" in examination.curves for name in (PRINTED, SMALL, REST))
    runs = [figure2(examination, add), inertia(examination, add)] if whole else []
    return [*runs, controls(examination, add), orders(examination, add), rates(examination, add)]


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
        for key, name in (("printed", PRINTED), ("small", SMALL))
    ]  # fmt: skip
    return Section(
        "figure2", "Figure 2: a block is loaded by gravity and turned by 90°", notes(examination, RUN), images,
        [_checks(examination, RUN), _checks(examination, KINEMATIC)],
    )  # fmt: skip


def inertia(examination: Examination, add: Add) -> Section:
    """Section on what is inertia and what is not."""
    runs = of(examination.curves, "run")
    shear = draw.co_rotated({name: runs[name] for name in (PRINTED, SMALL)})
    away = draw.inertia({name: runs[name] for name in (PRINTED, REST, SMALL)})
    return Section(
        "inertia", "What the turning box feels: co-rotated stresses and inertia", notes(examination, INERTIA),
        [(add("co_rotated", shear, "Co-rotated shear stress over time, two block sizes."),
          "Shear stress in the frame of the box: the mean over the block, and the largest of any particle."),
         (add("inertia", away, "Co-rotated vertical stress less its static value over time, three runs."),
          "What the block's mean vertical stress has beyond its static value. The run that is not turned feels the "
          "inertial forces of the turning box, in a box at rest.")],
    )  # fmt: skip


def controls(examination: Examination, add: Add) -> Section:
    """Section of the negative controls on the same figure."""
    curves = examination.curves
    drawn = draw.controls(curves["exact"], of(curves, "figure2"))
    rows = tuple(
        (name.replace("_", " "), *(sci(float(curve[key][0])) for key in ("kinematic", "run", "stretched")))
        for name, curve in of(curves, "control").items()
    )
    head = ("negative control", "Figure 2, kinematic", "Figure 2, the CPDI run", "stretched turn, 400 steps")
    return Section(
        "controls", "Negative controls", notes(examination, CONTROLS),
        [(add("controls", drawn, "Shear stress of the turned block by each negative control."),
          "Shear stress along the motion of Figure 2 by each negative control, kinematic, 200 steps; the broad line is "
          "right, and crosses are the controls that this figure cannot tell from it.")],
        [Table(MISSES, head, rows),
         _checks(examination, CONTROLS)],
    )  # fmt: skip


def orders(examination: Examination, add: Add) -> Section:
    """Section of errors against the step."""
    errors = of(examination.curves, "errors")
    right = [name for name, curve in errors.items() if curve["right"][0]]
    steps = next(iter(errors.values()))["steps"]
    rows = tuple((name.replace("_", " "), *map(sci, map(float, curve["error"]))) for name, curve in errors.items())
    return Section(
        "orders", "Orders in time: a turn with strain", notes(examination, ORDERS),
        [(add("orders", draw.orders(errors, right), "Error against the number of steps."),
          "Full lines: rates. Broken lines: negative controls; those that do not fall never converge.")],
        [Table("Relative error at the end", ("rate or control", *(f"{n:g} steps" for n in steps)), rows),
         _checks(examination, ORDERS)],
    )  # fmt: skip


def rates(examination: Examination, add: Add) -> Section:
    """Section of the rates in simple shear."""
    exact, computed = of(examination.curves, "shear"), of(examination.curves, "computed")
    images = [
        (add(f"shear_{key}", draw.shear(exact, computed, key), f"Component {key} of the stress in simple shear."), text)
        for key, text in (("s12", "Shear stress: lines are closed forms, marks what was computed."),
                          ("s11", "Normal stress along the shear; σ₂₂ = −σ₁₁, and 0 for Truesdell."))
    ]  # fmt: skip
    return Section("rates", "Objective is not unique: four rates in simple shear to γ = 8", notes(examination, SHEAR),
                   images, [_checks(examination, SHEAR)])  # fmt: skip
