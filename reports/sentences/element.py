"""Sentences about element tests of a material: what came out, and what one should know of each test."""

from collections.abc import Mapping
from typing import Any

from mpm_verify.cases.element.element import ElementFailure
from mpm_verify.cases.element.exam import ElementRemark as Code
from mpm_verify.reports.sentences.numbers import span
from mpm_verify.reports.sentences.remarks import Words, unread
from mpm_verify.solver.material.ubcsand import Ubcsand

Numbers = Mapping[str, Any]


def count(n: Numbers) -> str:
    """Count such as `8 element tests`."""
    return f"{n['tests']:g} element test{'s' * (n['tests'] != 1)}"


def tests(n: Numbers) -> str:
    """Number of tests and checks, and how many missed."""
    missed = f"{n['missed']:g} did not pass" if n["missed"] else "all pass"
    checks = f"{n['checks']:g} check{'s' * (n['checks'] != 1)}: {missed}."
    return f"{count(n)}, {checks}" if n["tests"] else checks


def orders(n: Numbers) -> str:
    """The orders of all tests that have one."""
    several = span(n["least"], n["most"]) != span(n["least"], n["least"])
    return f"Errors in the strain step fall with {'orders of' if several else 'order'} {span(n['least'], n['most'])}."


def failed(n: Numbers) -> str:
    """Sentence on why and where a test ends early."""
    why = {
        ElementFailure.NOT_FINITE: "a stress is not finite",
        ElementFailure.NO_STRAIN: (
            f"no strain leads to what is asked, {n['left']:.1e} of the stress is left; a stress beyond the strength "
            "cannot be reached"
            if n.get("line")
            else f"no strain leads to what is asked, {n['left']:.1e} of the stress is left"
        ),
    }[n["cause"]]
    leg = f", on the way to line {n['line']:g} of the file" if n.get("line") else ""
    return f"It failed at step {n['step']:g} of {n['steps']:g}{leg}: {why}."


def outside(n: Numbers) -> str:
    """Sentence on the fraction of the steps in which zz is another principal stress than the middle one."""
    return (
        f"zz is outside the range of the principal stresses in the plane in {100 * n['fraction']:.3g} % of the steps: "
        "there the largest shear is on other planes, which this material does not look at."
    )


def path_read(n: Numbers) -> str:
    """Sentence on the columns that are read, and how far they go."""
    if n.get("motion") == "F":
        return f"{n['used']} are read of {n['file']}; the largest component of F is {n['largest']:.3g}."
    if not n["largest"]:
        return f"{n['used']} are read of {n['file']}."
    return (
        f"{n['used']} are read of {n['file']}; the largest strain is {n['largest']:.3g} ({100 * n['largest']:.3g} %)."
    )


REMARKS: dict[str, Words] = {
    Code.TESTS: tests,
    Code.UNJUDGED: lambda n: f"{count(n)}. Nothing is known of this path, so nothing is judged.",
    Code.EXACT: lambda n: f"{n['tests']:g} {'is' if n['tests'] == 1 else 'are'} exact in any number of steps.",
    Code.ORDERS: orders,
    Code.FIRST_ORDER: lambda n: (
        "First order is expected of this material: it returns along the stress at the end of a step, and loses an "
        "order where the direction of the stress turns."
    ),
    Code.RATE_IDLE: lambda n: (
        f"rate={n['rate']} changes nothing here: along a path of strains the material works in its own frame, and "
        "nothing turns; verify objectivity tells the rates apart."
    ),
    Code.RATE_ACTS: lambda n: (
        f"F turns the element: the stress is that of rate={n['rate']}, by {n['steps']:g} steps in the finest run. The "
        "error of a step grows with its rotation and stretch, so the number of steps matters."
    ),
    Code.PATH_READ: path_read,
    Code.PATH_END: lambda n: (
        f"Stress at the end of {n['path']}: xx {n['xx']:.5g}, yy {n['yy']:.5g}, zz {n['zz']:.5g}, xy {n['xy']:.5g}."
    ),
    Code.PATH_STOPPED: lambda n: f"{n['path']}: {failed(n)}",
    Code.PATH_STRESSES: lambda n: (
        f"{n['columns']} control the stress: strains are found by Newton's method, to 1e-10 of the stress or better."
    ),
    Code.PATH_MOTION: lambda n: (
        f"The strains of {n['file']} are read as a motion, F = [[1, gxy], [0, 1]] diag(exp exx, exp eyy), since a rate "
        "acts on what turns; --motion none keeps them in the material's own axes, where all rates are one."
    ),
    Code.PATH_DEFORMED: lambda n: (
        f"{n['path']} starts deformed, at Fxx {n['xx']:.5g}, Fxy {n['xy']:.5g}, Fyx {n['yx']:.5g}, Fyy {n['yy']:.5g}: "
        f"the stress there is that of {'its energy' if n['whose'] == 'energy' else '--start, or of the first row'}."
    ),
    Code.PLANE_YIELDS: lambda n: (
        "This material yields in the plane of xx and yy alone: the lateral strain of zz is elastic, and not that of xx."
    ),
    Code.PATH_ZERO: lambda n: f"{n['columns']}: zero in every row, as in plane strain, which is what is computed.",
    Code.PATH_UNUSED: lambda n: f"Not used of {n['file']}: {n['columns']}.",
    Code.UNREAD: unread,
    Code.FAILED: failed,
    Code.AGAINST: lambda n: f"The errors are against the exact curve: {n['source']}.",
    Code.AGAINST_OWN: lambda n: f"The errors are against its own curve with {n['times']:g} times the steps.",
    Code.ROUND_OFF: lambda n: (
        "The error is round-off at any number of steps: each step is exact here, and there is no order."
    ),
    Code.NO_ORDER: lambda n: "There is no order to see.",
    Code.ORDER: lambda n: f"The order is {n['order']:.2f}.",
    Code.ZZ_WITHIN: lambda n: "zz is within the range of the principal stresses in the plane in all steps.",
    Code.ZZ_OUTSIDE: outside,
    Code.UNDEFORMED: lambda n: "a material with a stress from F starts undeformed",
    Code.OR_MORE: lambda n: "or a few more",
    Code.NO_EFFECT: lambda n: "no effect",
    Code.NO_EFFECT_PRIMARY: lambda n: "no effect in primary loading",
    Code.AFTER_REVERSAL: lambda n: "in the stiffness after a reversal",
    Code.CORRELATION: lambda n: (
        f"not in the paper's Table 2; the default is the correlation 1.1 N^-0.15 at N = {Ubcsand.N:g}"
    ),
    Code.OUR_READING: lambda n: (
        "1 is how we read the cyclic model, whose rules are not public; 0 is primary loading alone"
    ),
}  # fmt: skip
