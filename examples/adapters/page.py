"""Page docs/public-codes.md, made of what is stored: python examples/adapters/page.py writes it."""

import json
import shlex
from itertools import pairwise
from math import log, log10

from study import HERE, RESULTS, TOP, command, studies

PAGE = TOP / "docs" / "public-codes.md"
KEPT = 7  # significant digits of a stored error


def stored(name):
    """Content of measured/NAME.json."""
    return json.loads((RESULTS / f"{name}.json").read_text(encoding="utf-8"))


def short(value):
    """Error with four digits, as the terminal prints it: 7.253e-8."""
    mantissa, power = f"{value:.3e}".split("e")
    return f"{mantissa}e{int(power)}"


def orders(runs):
    """Orders between adjacent levels."""
    found = [log(a["u"] / b["u"]) / log(b["cells"] / a["cells"]) for a, b in pairwise(runs)]
    return " ".join(f"{order:.2f}" for order in found)


def digits(found):
    """Fewest digits in which errors agree with those of the solver here; nothing without a reference."""
    if "reference" not in found:
        return ""
    worst = max(abs(row["u"] / of - 1) for row, of in zip(found["runs"], found["reference"], strict=True))
    agreed = KEPT if worst < 10.0**-KEPT else -log10(worst)
    return f"{agreed:.1f}" if agreed < KEPT - 1 else f"all {KEPT}"


def row(number, study, found):
    """Row of the table of a study."""
    levels = ", ".join(f"{one['cells']}: {short(one['u'])}" for one in found["runs"])
    verdict = found["verdict"]["verdict"]
    cells = [str(number), found["version"], study["method"], f"`{study['solution']}`", levels, orders(found["runs"]),
             verdict, digits(found), study["found"]]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def table():
    """Table of all studies."""
    head = ["", "code", "method", "case", "cells: u in rms", "orders", "verdict", "digits", "found"]
    lines = ["| " + " | ".join(head) + " |", "| " + " | ".join(["---"] * len(head)) + " |"]
    rows = [row(k, study, stored(name)) for k, (name, study) in enumerate(studies().items(), 1)]
    return "\n".join([*lines, *rows])


def reasons():
    """Why a row is INCONCLUSIVE, a line each, without what to run next."""
    open_ = [(k, stored(name)["verdict"]) for k, name in enumerate(studies(), 1)]
    return "\n".join(
        f"- {number}: {verdict['reason'].partition(': run with')[0].partition(': undecided')[0]}"
        for number, verdict in open_
        if verdict["verdict"] == "INCONCLUSIVE"
    )


def stress(values, mark=" | "):
    """Three components of a stress, four digits each."""
    return mark.join(f"{value + 0.0:.4g}" for value in values)


def turned():
    """Table of the experiment on rotation."""
    found = stored("kratos_smallest")["stretched_then_turned"]
    rows = [("after the stretch", "stretched"), ("after the turn", "turned")]
    lines = [f"| {words} | {stress(found[key])} | {stress(found[key + '_expected'])} |" for words, key in rows]
    head = "| | xx | yy | xy | xx expected | yy | xy |\n| --- | --- | --- | --- | --- | --- | --- |"
    return "\n".join([head, *lines])


def faced():
    """Table of the experiment beside a face."""
    found = stored("kratos_smallest")["beside_a_face"]
    lines = [
        f"| {power(one['tolerance'])} | {power(one['beyond'])} | {one['cell']} | {stress(one['stress'])} |"
        for one in found["rows"]
    ]
    head = "| tolerance | beyond the face | cell | xx | yy | xy |\n| --- | --- | --- | --- | --- | --- |"
    return "\n".join([head, *lines, f"| expected | | | {stress(found['expected'])} |"])


def power(value):
    """Power of ten with its sign: -1e-6."""
    return f"{value:.0e}".replace("e-0", "e-")


def on_a_face():
    """Table of the experiment with air drag."""
    lines = [
        f"| {'on a face' if one['z'] else 'in the middle'} | {one['air_drag']:g} | {number(one['velocity'])} |"
        for one in stored("newton_smallest")["on_a_face"]
    ]
    return "\n".join(["| particle | `air_drag` | velocity after a step |", "| --- | --- | --- |", *lines])


def number(value):
    """Number with four digits, or what is none."""
    return "not a number" if value == "nan" else f"{value:.4g}"


def repeat():
    """Commands of all studies, in a block."""
    lines = []
    for number, study in enumerate(studies().values(), 1):
        lines += [f"    # {number}", f"    {shlex.join(command(study))}"]
    return "\n".join(lines)


def level(name, cells):
    """Error of a level of a study."""
    return short(next(one["u"] for one in stored(name)["runs"] if one["cells"] == cells))


def series(name, reference=False):
    """Errors of a study, or of its reference."""
    found = stored(name)
    values = found["reference"] if reference else [one["u"] for one in found["runs"]]
    return ", ".join(map(short, values))


def page():
    """Text of the page."""
    template = (HERE / "page.md.in").read_text(encoding="utf-8")
    same = {**stored("kratos_usl_large"), "reference": [one["u"] for one in stored("tiny_symmetric")["runs"]]}
    parts = {
        "SAME": digits(same), "TABLE": table(), "REASONS": reasons(), "TURNED": turned(), "FACED": faced(),
        "ON_A_FACE": on_a_face(),
        "REPEAT": repeat(),
        "LARGE": series("kratos_usl_large"), "LARGE_REFERENCE": series("kratos_usl_large", reference=True),
        "SYMMETRIC": series("tiny_symmetric"), "USUAL": level("kratos_usl_large_tolerance", 12),
        "EXACT": level("kratos_usl_large", 12),
        "FACE_EXPECTED": stress(stored("kratos_smallest")["beside_a_face"]["expected"], ", "),
        "FACE_FOUND": stress(stored("kratos_smallest")["beside_a_face"]["rows"][1]["stress"], ", "),
    }  # fmt: skip
    for name in ("kratos_usf", "kratos_central_difference", "kratos_central_difference_b_start", "mpm99",
                 "mpm99_F_at_0", "newton", "newton_dt_h"):  # fmt: skip
        parts[f"ORDERS({name})"] = orders(stored(name)["runs"])
    for key, text in parts.items():
        assert f"<{key}>" in template, key
        template = template.replace(f"<{key}>", text)
    return template


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
