"""Comparison with references in words: the nearest, what parts, where, and what is not told apart."""

from collections.abc import Iterable

from mpm_verify.cases.mms.digits.records import AGREES, Agreement, Alike, Compared, Parting
from mpm_verify.cases.mms.digits.reference import Scheme
from mpm_verify.reports import words
from mpm_verify.reports.sentences import failures
from mpm_verify.reports.sentences.numbers import percent
from mpm_verify.solver.plugins import label

STRESS = {"usl": "update-stress-last", "musl": "modified update-stress-last", "usf": "update-stress-first"}
OUTCOMES = {
    Agreement.AGREES: "AGREES",
    Agreement.PARTS: "PARTS",
    Agreement.FEW_DIGITS: "INCONCLUSIVE",
    Agreement.FAILED: "ERROR",
    Agreement.NO_REFERENCE: "ERROR",
}


def scheme(of: Scheme) -> str:
    """Reference in short: `MPM, usl, flip`."""
    return f"{words.method(of.method)}, {of.stress}, {label(of.transfer)}"


def digits(value: float | None) -> str:
    """Digits that agree, with one decimal, rounded down: 2.9 and not 3.0; a dash for nothing."""
    return words.DASH if value is None else f"{int(10 * value + 1e-9) / 10:.1f}"


def listed(names: Iterable[str]) -> str:
    """Names as `u, v and F`."""
    *first, last = map(words.quantity, names)
    return f"{', '.join(first)} and {last}" if first else last


def outcome(found: Compared) -> str:
    """Sentence on what came out."""
    if found.failure:
        return f"There is no answer to compare: {failures.failure(found.failure)}."
    if not found.against:
        return f"No run of the reference came to its end: {failed(found)}."
    if found.still:
        return (
            "Nothing moves: no particle leaves its start in the digits of the files, so no reference is near. "
            "If the body does move, write 17 digits."
        )
    near, of = found.nearest, "particles" if found.framed else "rms values"
    name, least = scheme(near.scheme), min(near.agreement.values())
    if not found.parts:
        agree = f"{of} agree to {digits(least)} digits or more in {listed(near.agreement)}"
        return f"The nearest reference is {name}: {agree}."
    kinds = [("rms values", near.digits)] + [("particles", near.particles)] * found.framed
    agree = "; ".join(f"digits of {kind} are {each(values)}" for kind, values in kinds)
    nobody = [q for q in found.parts if all(one.agreement.get(q, 0.0) < AGREES for one in found.against)]
    most = max((one.agreement.get(q, 0.0) for q in nobody for one in found.against), default=0.0)
    none = f"In {listed(nobody)} no reference agrees to more than {digits(most)} digits" if nobody else (
        f"No reference agrees to {AGREES:g} digits in all quantities"
    )  # fmt: skip
    return f"{none}. The nearest is {name}: {agree}."


def each(found: dict[str, float]) -> str:
    """Digits of each quantity: `1.7 in u, 0.4 in F`."""
    return ", ".join(f"{digits(value)} in {words.quantity(q)}" for q, value in found.items())


def parting(one: Parting, first: bool = True) -> str:
    """Sentence on where a quantity parts from the nearest reference."""
    x, y = one.X
    part = f", {percent(one.difference / one.size)} of the reference's rms error there" if one.size > 0 else ""
    most = f"particle {one.particle}, X = ({x:g}, {y:g}), is off by {words.sci(one.difference)}{part}"
    return f"{words.quantity(one.quantity)} parts{' first,' * first} at frame {one.frame} (step {one.step}): {most}."


def alike(found: tuple[Alike, ...]) -> list[str]:
    """Sentences on references that are not told apart here, those with one case that tells them apart in one."""
    cases: dict[str, list[str]] = {}
    for one in found:
        told = f"{one.solution} on {one.cells} cells" if one.cells else ""
        cases.setdefault(told, []).append(scheme(one.scheme))
    said = []
    for told, names in cases.items():
        then = f"; {told} tells {'them' if len(names) > 1 else 'it'} apart" if told else ""
        have = "have" if len(names) > 1 else "has"
        said.append(f"Not told apart here: {'; '.join(names)} {have} all digits shown of the nearest{then}.")
    return said


def limited(found: Compared) -> str:
    """Sentence on what the files cannot show; empty where they have digits enough."""
    if not found.limited:
        return ""
    allowed = each({q: found.limit[q] for q in found.limited})
    return f"The numbers in the files allow no more than {allowed}: write 17 digits."


def failed(found: Compared) -> str:
    """References that did not come to their end, with the reason of the first."""
    names = [scheme(one) for one in found.failed]
    why = failures.failure(next(iter(found.failed.values())))
    return f"{names[0]} ({why})" + (f" and {words.count(len(names) - 1, 'other')}" if len(names) > 1 else "")


def sentences(found: Compared) -> list[str]:
    """All that is said below the table."""
    if found.still:
        return []
    said = [parting(one, number == 0) for number, one in enumerate(found.partings)]
    said += [limited(found)] if found.limited else []
    said += alike(found.alike)
    if found.against and found.failed:
        said.append(f"Not compared, as they did not come to their end: {failed(found)}.")
    if found.farther:
        said.append(f"{words.count(found.farther, 'other reference')} are farther by their stored rms values.")
    if found.against and not found.framed:
        said.append(
            "Held against stored rms values alone; without --stored the reference is run, and it is said where."
        )
    return said
