"""Spelling of names, numbers and outcomes, so that every table, figure and sentence says it alike."""

import math
from typing import Any

from mpm_verify.cases.mms.run import Run
from mpm_verify.solver.plugins import label

METHODS = {
    "mpm": "MPM",
    "gimp": "GIMP",
    "cpgimp": "cpGIMP",
    "cpdi": "CPDI",
    "cpdi2": "CPDI2",
    "bspline2": "quadratic B-spline",
    "bspline3": "cubic B-spline",
    "tlmpm": "TLMPM",
}
QUANTITIES = {"u": "u", "v": "v", "F": "F", "sigma": "\N{GREEK SMALL LETTER SIGMA}"}
MEANING = {
    "PASS": "the evidence shows what was registered",
    "FAIL": "the evidence is against what was registered",
    "INCONCLUSIVE": "the evidence does not decide; the reason names the run that would",
    "ERROR": "there is nothing to judge",
}
BOUNDS = {"at_least": "at least", "at_most": "at most"}  # ways of a check that are bounds
DASH, MINUS, TIMES = "\N{EN DASH}", "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"


def method(name: str) -> str:
    """Name of a method as people write it; the command's word where nothing else is known."""
    return METHODS.get(name, label(name))


def way(name: str) -> str:
    """Way in which a check holds a number against another."""
    return BOUNDS.get(name, name)


def quantity(name: str) -> str:
    """Symbol of a quantity."""
    return QUANTITIES.get(name, name)


def series(of: Any) -> str:
    """Method and particle count: `CPDI, 4 per cell`; the method alone where there are no particles."""
    return f"{method(of.method)}, {of.ppc} per cell" if hasattr(of, "ppc") else method(of.method)


def measured(plan: Any, between: str = " in ") -> str:
    """Quantity and norm of a plan: `u in rms`; the quantity alone where nobody says the norm."""
    return str(plan.quantity) if plan.run.given else f"{plan.quantity}{between}{plan.norm}"


def sci(value: float | None) -> str:
    """Number with four digits: 1.127e-5; a dash for nothing."""
    if value is None or math.isnan(value):
        return DASH
    if math.isinf(value) or value == 0:
        return "0" if value == 0 else "∞"
    digits, exponent = f"{value:.3e}".split("e")
    return f"{digits}e{int(exponent)}".replace("-", MINUS if value < 0 else "-", 1)


def value(number: Any) -> str:
    """Value of a run: a number with six digits, a dash where it is none; what is no float as it is."""
    if isinstance(number, float):
        return DASH if math.isnan(number) else f"{number:.6g}"
    return str(number)


def order(value: float | None) -> str:
    """Order with two decimals with a true minus sign; a dash for nothing."""
    if value is None or math.isnan(value):
        return DASH
    return "∞" if math.isinf(value) else f"{value:.2f}".replace("-0.00", "0.00").replace("-", MINUS)


def percent(part: float, digits: int = 1, sign: str = "") -> str:
    """Fraction as per cent: 0.034 as 3.4 %."""
    return f"{100 * part:{sign}.{digits}f} %".replace("-", MINUS)


def interval(ends: tuple[float, float] | None) -> str:
    """Interval such as `1.98 to 2.03`; a dash where two levels or fewer leave none."""
    return DASH if ends is None else f"{order(ends[0])} to {order(ends[1])}"


def few(value: float | None) -> str:
    """Count with one decimal, 16.3, two digits below one, 0.012; a dash for nothing."""
    if value is None or math.isnan(value):
        return DASH
    return f"{value:.1f}" if value >= 1 else f"{value:.2g}"


def shift(run: Run) -> str:
    """Shift of the particles of a replicate, in fractions of their spacing; a dash at their usual positions."""
    return DASH if not any(run.offset) else ", ".join(order(part) for part in run.offset)


def cell_size(cells: int) -> str:
    """Cell size such as 1/64: people count cells."""
    return f"1/{cells}"


def size(h: float) -> str:
    """Cell size as 1/64 for 0.015625; the number itself where it is not one over a whole number."""
    cells = round(1 / h)
    return cell_size(cells) if cells > 1 and abs(cells * h - 1) < 1e-5 else f"{h:.4g}"


def short(error: float) -> str:
    """Number with two digits: 4.8e-3."""
    return f"{error:.1e}".replace("e-0", "e-").replace("e+0", "e+")


def sentence(text: str) -> str:
    """Sentence: a capital letter in front, a full stop at the end."""
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def count(number: int, noun: str) -> str:
    """Count with its noun: `1 run`, `2 runs`."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def paragraphs(document: str) -> list[str]:
    """Paragraphs of a docstring, each in one line; lines that are set in, as formulas are, stay apart."""
    texts: list[str] = []
    for block in document.split("\n\n"):
        formula = all(line.startswith("    ") for line in block.splitlines())
        texts += [line.strip() for line in block.splitlines()] if formula else [" ".join(block.split())]
    return texts
