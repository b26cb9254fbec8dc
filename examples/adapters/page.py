"""Page docs/public-codes.md, made of what is stored: python examples/adapters/page.py writes it.

Verdicts are those of the rule as it is now, on the stored errors.
"""

import json
import shlex
from itertools import pairwise
from math import log, log10

from study import HERE, RESULTS, TOP, command, comparison, studies
from verdicts import verdicts

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
    judged = verdicts(study, found)
    failed = [f"{name} FAIL" for name, (outcome, _) in judged.items() if name != "u" and outcome == "FAIL"]
    verdict = ", ".join([judged["u"][0], *failed])
    cells = [str(number), found["version"], study["method"], f"`{study['solution']}`", levels, orders(found["runs"]),
             verdict, digits(found), study["found"]]  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def table():
    """Table of all studies."""
    head = ["", "code", "method", "case", "cells: u in rms", "orders", "verdict", "digits", "found"]
    lines = ["| " + " | ".join(head) + " |", "| " + " | ".join(["---"] * len(head)) + " |"]
    rows = [row(k, study, stored(name)) for k, (name, study) in enumerate(studies().items(), 1)]
    return "\n".join([*lines, *rows])


def reasons(outcome, *names):
    """Why quantities of a row have an outcome, a line each, without what to run next."""
    judged = [(k, verdicts(study, stored(one))) for k, (one, study) in enumerate(studies().items(), 1)]
    return listed([(k, name, found[name][1]) for k, found in judged for name in names
                   if name in found and found[name][0] == outcome])  # fmt: skip


def listed(rows):
    """Lines of rows, quantities and reasons."""
    lines = [f"- {k}, {name}: {why.partition(': run with')[0].partition(': undecided')[0]}" for k, name, why in rows]
    return "\n".join(lines) or "- none"


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


def still():
    """Table of the experiment on the memory of the grid."""
    found = stored("sparkl_smallest")
    names = {"published": "as published", "f32": "mended"}
    lines = [f"| {names[one['kind']]} | {one['count']} | {one['way']:g} | {'yes' if one['failed'] else 'no'} |"
             for one in found["moved"]]  # fmt: skip
    ends = [f"| {names[one['kind']]} | {one['count']} | the process ends | |" for one in found["ended"] if one["ended"]]
    head = "| sparkl2d 0.4.0 | particles | way in x | failed |\n| --- | --- | --- | --- |"
    return "\n".join([head, *lines, *ends])


def near_a_wall():
    """Table of the experiment beside a wall."""
    found = stored("sparkl_smallest")["beside_a_wall"]
    rows = [["cells from the wall", *(f"{one['beside']:g}" for one in found)], ["---"] * (len(found) + 1),
            ["velocity", *(f"{one['velocity']:g}" for one in found)]]  # fmt: skip
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def stretches():
    """Table of the experiment on moduli."""
    found = stored("sparkl_smallest")["stretched"]
    names = {"corotated": "`CorotatedLinearElasticity`", "neo_hookean": "`NeoHookeanElasticity`",
             "plane_strain": "plane strain: lam + 2 mu, lam"}  # fmt: skip
    lines = [f"| {names[key]} | {found[key][0]:g} | {found[key][1]:g} |" for key in names]
    return "\n".join(["| model | xx | yy |", "| --- | --- | --- |", *lines])


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
        "SAME": digits(same), "TABLE": table(), "OPEN": reasons("INCONCLUSIVE", "u"),
        "FAILED": reasons("FAIL", "u"), "REFUTED": reasons("FAIL", "v", "F", "sigma"),
        "STILL": still(), "NEAR_A_WALL": near_a_wall(), "STRETCHED": stretches(),
        "TWO_OF_A_KIND": digits({**stored("sparkl"), "reference": [one["u"] for one in stored("mpm99")["runs"]]}),
        "TURNED": turned(), "FACED": faced(), "COMPARISON": shlex.join(comparison("kratos_compared")),
        "COMPARED": "\n".join(f"- {line}" for line in stored("kratos_compared")["sentences"]),
        "ON_A_FACE": on_a_face(),
        "REPEAT": repeat(),
        "LARGE": series("kratos_usl_large"), "LARGE_REFERENCE": series("kratos_usl_large", reference=True),
        "SYMMETRIC": series("tiny_symmetric"), "USUAL": level("kratos_usl_large_tolerance", 12),
        "EXACT": level("kratos_usl_large", 12),
        "FACE_EXPECTED": stress(stored("kratos_smallest")["beside_a_face"]["expected"], ", "),
        "FACE_FOUND": stress(stored("kratos_smallest")["beside_a_face"]["rows"][1]["stress"], ", "),
    }  # fmt: skip
    for name in ("kratos_usf", "kratos_central_difference", "kratos_central_difference_b_start", "mpm99",
                 "mpm99_F_at_0", "newton", "newton_dt_h", "sparkl", "sparkl_walls"):  # fmt: skip
        parts[f"ORDERS({name})"] = orders(stored(name)["runs"])
    for key, text in parts.items():
        assert f"<{key}>" in template, key
        template = template.replace(f"<{key}>", text)
    return template


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
