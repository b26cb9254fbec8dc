"""Sentences of the ledger of the paper: what a claim comes to, by what parts and numbers, and under what readings."""

from collections.abc import Mapping, Sequence

from mpm_verify.reports.paper.records import Entry, Status
from mpm_verify.reports.paper.registered import Change

TITLE = "Moormann, Giridharan & Stolle 2022, claim by claim"
ANSWERS: Mapping[bool | None, str] = {True: "yes", False: "no", None: "open"}
MEANING = {
    Status.HOLDS: "every part of it holds in our runs",
    Status.IN_PART: "some parts of it hold",
    Status.NO: "no part of it holds",
    Status.OPEN: "cannot be tested here",
    Status.NOT_RUN: "a Result that its rule reads is not stored",
}
CAPTIONS = {
    "1": "Error of u against cell size over one period, in rms and in the norm as printed.",
    "2": "Mean stress of the turning block against time: lines are the closed form, marks the CPDI run.",
    "3": "The column before it is released, and its foot with cells, particles and domains.",
    "4": "Front and toe against time for each number of particles per cell.",
    "5": "Front and toe against time for each damping.",
    "6": "Potential and kinetic energy against time for each damping.",
    "7": "Front and toe against time for each smoothing.",
    "8": "Front and toe against time for both materials.",
}
MODES = {"full": "in full", "quick": "quick, on coarse meshes"}


def lead(mode: str, entries: Sequence[Entry]) -> str:
    """Counts of statuses, and what a status is about."""
    each = [one.status for one in entries]
    said = ", ".join(f"{each.count(status)} {status}" for status in Status if status in each)
    return (f"{len(each)} claims, {MODES[mode]}: {said}. A status is about our runs under our readings, "
            "never about the authors' code.")  # fmt: skip


def told(entry: Entry) -> list[str]:
    """Lines of a claim: status and parts, numbers, warning, other readings, reason, what would close it."""
    found = [f"**{entry.status}**{of_parts(entry.parts)}"]
    if entry.missing:
        found[0] += f": {missing(entry)}"
    if entry.numbers:
        found.append("; ".join(f"{name} {number(value)}" for name, value in entry.numbers.items()))
    if entry.crowded:
        found.append(f"Warning. {crowded(entry)}")
    if entry.under:
        found.append(f"Under other readings: {'; '.join(under(entry))}.")
    found += [text for text in (entry.claim.reason,) if text]
    if entry.claim.closes:
        found.append(f"Would be closed by: {entry.claim.closes}")
    return found


def missing(entry: Entry) -> str:
    """Lack of a rule: Results, or runs that came to their end."""
    lacks = "is not stored" if entry.status is Status.NOT_RUN else "has no runs that came to their end"
    return f"the study {entry.missing} {lacks}"


def crowded(entry: Entry) -> str:
    """Warning of runs that are crowded."""
    each = ", ".join(f"{number(value)} times with {name}" for name, value in entry.crowded.items())
    return f"Grains stand for more than the space that they fill, {each}: those runs are weak."


def part(name: str) -> str:
    """Heading of a part of the paper."""
    return f"Figure {name}" if name.isdigit() else f"{name[0].upper()}{name[1:]}"


def of_parts(parts: Mapping[str, bool | None]) -> str:
    """Parts with their answers, where there are some."""
    return f" ({'; '.join(f'{name}: {ANSWERS[answer]}' for name, answer in parts.items())})" if parts else ""


def under(entry: Entry) -> list[str]:
    """Statuses under other readings; the parts too where they are others and the status is not."""
    found = []
    for one in entry.under:
        other = one.parts != entry.parts and one.status == entry.status
        found.append(f"{one.reading}, {one.name}, {one.value}: {one.status}{of_parts(one.parts) if other else ''}")
    return found


def change(one: Change) -> str:
    """Change in a line."""
    return f"{one.claim}, {one.what}: registered {value_of(one.registered)}, found {value_of(one.found)}"


def value_of(value: object) -> str:
    """Value of a change: all digits of a number, as those that changed may be the last."""
    return "nothing" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)


def number(value: float) -> str:
    """Number with four digits, as long as that is not too long."""
    return f"{value:.4g}"


def registered(entries: Sequence[Entry], changes: Sequence[Change], known: set[str]) -> str:
    """Line on what is registered: how many claims have changed, and how many have no row."""
    ran = {one.claim.id for one in entries if one.status is not Status.NOT_RUN}
    if not ran & known:
        return "Nothing is registered of these; --register does."
    changed = len({one.claim for one in changes})
    said = f"Of {len(ran & known)} claims that are registered, {changed or 'none'} changed"
    return f"{said}; {len(ran - known)} are not registered." if ran - known else f"{said}."
