"""Stalls in words: where an order falls, and what was measured of each cause."""

from mpm_verify.cases.judging.records import Ended
from mpm_verify.cases.judging.stall import PART, Cause, CauseCode, Finding, Peer, Stall
from mpm_verify.reports import words
from mpm_verify.reports.sentences import verdicts

NAMES = {
    CauseCode.FAILED_RUN: "a failed run",
    CauseCode.CROSSINGS: "cell crossings",
    CauseCode.QUADRATURE: "quadrature with so few particles",
    CauseCode.GAPS: "gaps and overlaps between domains",
    CauseCode.TIME_STEP: "the time step",
    CauseCode.ROUND_OFF: "round-off",
    CauseCode.DAMPING: "damping that the problem does not have",
    CauseCode.LOCKING: "volumetric locking",
    CauseCode.OTHER_SOLID: "another solid",
    CauseCode.EDGE_NOISE: "noise beside a prescribed edge",
    CauseCode.SMALL_STRAIN: "strains too large for a material of small strains",
}
UNMEASURED = {
    CauseCode.QUADRATURE: "one particle count only; a list for --ppc adds others",
    CauseCode.GAPS: "this method knows points only",
    CauseCode.TIME_STEP: "no run with half of it; a list for --courant adds one",
    CauseCode.ROUND_OFF: "no round-off floor is known",
    CauseCode.DAMPING: "the run has none",
    CauseCode.LOCKING: "the material can be compressed",
    CauseCode.OTHER_SOLID: "the material is the one of the problem",
    CauseCode.EDGE_NOISE: "no edge is prescribed, or the step damps it",
    CauseCode.SMALL_STRAIN: "the material is one of finite strain, or strains are small",
}


def where(stall: Stall) -> str:
    """Phrase on where an order falls: `from 32 to 64 cells the order is 0.58; 2.00, 1.42 before`."""
    if stall.coarser is None or stall.order is None:
        return f"the finest run that finished has {stall.cells} cells"
    before = f"; {', '.join(words.order(p) for p in stall.before)} before" if stall.before else ""
    text = f"from {stall.coarser} to {stall.cells} cells the order is {words.order(stall.order)}{before}"
    return f"{text}; {_run_ended(stall.ended)}" if stall.ended else text


def name(cause: Cause) -> str:
    """Name of a cause."""
    return NAMES[cause.code]


def measured(cause: Cause) -> str:
    """Phrase on what was measured of a cause."""
    if cause.ended:
        return _run_ended(cause.ended)
    if not cause.numbers:
        return UNMEASURED[cause.code]
    return MEASURED[cause.code](cause.numbers, cause.peer)


def reasons(stall: Stall) -> list[str]:
    """Sentences on what explains the excess, or a part of it, or that no cause is named."""
    told = [words.sentence(f"{name(c)}: {measured(c)}") for c in stall.named] or ["The evidence does not name a cause."]
    return told + [f"In part {name(c)}: {measured(c)}." for c in stall.parts]


def why(stall: Stall) -> list[str]:
    """All causes in sentences: `reasons`, then those that are not it or not known in one sentence each."""
    told = list(reasons(stall))
    for label, finding in (("Not", Finding.EXCLUDED), ("Not measured", Finding.UNKNOWN)):
        some = [f"{name(c)} ({measured(c)})" for c in stall.causes if c.finding is finding]
        told += [f"{label}: {'; '.join(some)}."] if some else []
    small = [c for c in stall.causes if c.finding is Finding.PRESENT and c.weight < PART]
    return told + [f"Measured too: {name(c)} ({measured(c)})." for c in small]


def cause(stall: Stall) -> str:
    """Sentence on the causes that the numbers name."""
    named = [name(c) for c in stall.named]
    return f"By the numbers: {' and '.join(named)}." if named else "The numbers name no cause."


def _run_ended(end: Ended) -> str:
    return f"the run with {1 / end.h:.0f} cells ended: {verdicts.ended(end)}"


def _crossings(n: dict[str, float], peer: Peer | None) -> str:
    if "faces_first" not in n:
        at = f" at {n['cells']:.0f} cells" if "cells" in n else ""
        return f"a particle crosses {words.few(n['faces'])} faces{at}"
    text = f"a particle crosses {n['faces']:.1f} faces, {n['faces_first']:.1f} at {n['cells_first']:.0f} cells"
    if "ratio" in n:
        text += f"; from {n['cells_before']:.0f} to {n['cells']:.0f} cells they grow {n['ratio']:.1f}-fold and the "
        text += f"error beyond order {n['usual']:g} {n['excess_ratio']:.1f}-fold"
    if peer:
        text += f"; {words.method(peer.method)} crosses {peer.crossings:.1f} and has order {words.order(peer.order)}"
    return text


def _quadrature(n: dict[str, float], peer: Peer | None) -> str:
    word = "smaller" if n["change"] < 0 else "larger"
    text = f"with {n['other_ppc']:.0f} per cell instead of {n['ppc']:.0f} "
    text += f"the finest error is {words.percent(abs(n['change']), 0)} {word}"
    return text + (f" and its order {words.order(n['order'])}" if "order" in n else "")


def _gaps(n: dict[str, float], peer: Peer | None) -> str:
    text = f"corners are off by {words.percent(n['gap'], 1)} of the particle spacing, "
    text += f"{words.percent(n['gap_first'], 1)} at {n['cells_first']:.0f} cells"
    if peer is None or peer.gap is None:
        return text
    return f"{text}; {words.method(peer.method)} has {words.percent(peer.gap, 1)} and order {words.order(peer.order)}"


def _time_step(n: dict[str, float], peer: Peer | None) -> str:
    return f"half of it changes the finest error by {words.percent(n['change'], 1, '+')}"


def _round_off(n: dict[str, float], peer: Peer | None) -> str:
    return f"the finest error is {n['times']:.1g} times its floor"


def _damping(n: dict[str, float], peer: Peer | None) -> str:
    told = f"it takes {words.percent(n['alpha'], 2 if n['alpha'] < 0.01 else 0)} of the force"
    if "change" not in n:
        return f"{told}; a list for --damping adds a run without it"
    return f"{told}, and without it the finest error changes by {words.percent(n['change'], 1, '+')}"


def _locking(n: dict[str, float], peer: Peer | None) -> str:
    told = f"the bulk modulus is {n['ratio']:.3g} times the shear modulus, which {n['cells']:.0f} cells do not outgrow"
    if "change" not in n:
        return f"{told}; --smoothing none,fbar shows what a smoothed volume ratio does"
    return f"{told}, and with a smoothed volume ratio the finest error changes by {words.percent(n['change'], 1, '+')}"


def _other_solid(n: dict[str, float], peer: Peer | None) -> str:
    told = "with its rate the stress is no function of F, and the problem is that of an energy"
    return f"{told}; the finest error is {words.percent(n['error'] / n['size'], 1)} of u" if n["size"] else told


def _edge_noise(n: dict[str, float], peer: Peer | None) -> str:
    told = "FLIP keeps the part of the particles' velocities that the grid does not see, and the spring of the edge "
    told += "feeds it; "
    if "change" not in n:
        return f"{told}it was not measured here: --stress usl damps it, and --transfer apic has none"
    return f"{told}a run without it changes the finest error by {words.percent(n['change'], 1, '+')}"


def _small_strain(n: dict[str, float], peer: Peer | None) -> str:
    told = f"components of F − I reach {words.percent(n['strain'], 1)}, and the stress is that of the energy "
    told += f"to first order alone: up to {n['strain'] * n['size']:.1e} of u; the two finest errors leave a floor of "
    return f"{told}{n['floor']:.1e} where it adds in the square; a smaller amplitude or finite strain removes it"


MEASURED = {
    CauseCode.LOCKING: _locking,
    CauseCode.OTHER_SOLID: _other_solid,
    CauseCode.EDGE_NOISE: _edge_noise,
    CauseCode.SMALL_STRAIN: _small_strain,
    CauseCode.CROSSINGS: _crossings,
    CauseCode.QUADRATURE: _quadrature,
    CauseCode.GAPS: _gaps,
    CauseCode.TIME_STEP: _time_step,
    CauseCode.ROUND_OFF: _round_off,
    CauseCode.DAMPING: _damping,
}
