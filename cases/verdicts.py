"""From Results to verdicts: which levels belong to which declared quantity, and what the order rule says of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cases.order import Expectation, Level, Outcome, Quantity, Verdict, judge, judge_family
from cases.study import Declared, Result, Run, Study

EXIT = {Outcome.PASS: 0, Outcome.FAIL: 1, Outcome.ERROR: 2, Outcome.INCONCLUSIVE: 3}
NOTHING_EXPECTED = Expectation(order=None)  # only its slope is used


@dataclass(frozen=True)
class Finding:
    """A declared quantity with its verdict. Where it is only shown, the verdict is shown too and decides nothing."""

    declared: Declared
    verdict: Verdict
    levels: tuple[Level, ...]  # coarse to fine
    finest: Result | None


def findings(study: Study, results: Mapping[str, Result]) -> list[Finding]:
    """Findings in the order of the declarations; `results` by digest, those not there are runs not done."""
    quantities = [_quantity(d, study.runs, results) for d in study.declared]
    judged = [i for i, d in enumerate(study.declared) if d.judged]
    verdicts = dict(zip(judged, judge_family([quantities[i] for i in judged]), strict=True))
    found = []
    for i, (declared, quantity) in enumerate(zip(study.declared, quantities, strict=True)):
        verdict = verdicts.get(i) or judge(
            quantity.levels, quantity.expectation, floor=quantity.floor, dt_halved=quantity.dt_halved
        )
        finest = [results[r.digest] for r in refinement(declared, study.runs)[-1:] if r.digest in results]
        found.append(Finding(declared, verdict, tuple(quantity.ordered), finest[0] if finest else None))
    return found


def exit_code(found: Sequence[Finding]) -> int:
    """0 all pass, 1 a fail, 2 an error, 3 inconclusive or nothing judged; the worst decides (fail before error)."""
    codes = {EXIT[f.verdict.outcome] for f in found if f.declared.judged}
    return next((code for code in (1, 2, 3) if code in codes), 0 if codes else 3)


def refinement(declared: Declared, runs: Sequence[Run]) -> list[Run]:
    """The runs of a declared quantity at the Courant number of the study, coarse to fine."""
    mine = [r for r in runs if (r.method, r.solution, r.ppc) == (declared.method, declared.solution, declared.ppc)]
    courant = max((r.courant for r in mine), default=0.0)
    return sorted((r for r in mine if r.courant == courant), key=lambda r: r.cells)


def _quantity(declared: Declared, runs: Sequence[Run], results: Mapping[str, Result]) -> Quantity:
    """The levels of one declared quantity, and its error with half the time step on the finest level."""
    series = refinement(declared, runs)
    levels = [Level(1 / run.cells, *_error(declared, results.get(run.digest))) for run in series]
    floors = [r.floor.get(declared.quantity, 0.0) for run in series if (r := results.get(run.digest))]
    half = [
        results[r.digest].errors[declared.quantity][declared.norm]
        for r in runs
        if series
        and (r.method, r.solution, r.ppc, r.cells)
        == (declared.method, declared.solution, declared.ppc, series[-1].cells)
        and r.courant < series[-1].courant
        and r.digest in results
        and results[r.digest].status == "finished"
    ]
    return Quantity(
        levels, declared.expectation or NOTHING_EXPECTED, max(floors, default=0.0), half[0] if half else None
    )


def _error(declared: Declared, result: Result | None) -> tuple[tuple[float, ...], str]:
    """Errors and failure text of a level."""
    if result is None:
        return (), "not run yet"
    if result.status == "failed":
        return (), str(result.failure)
    return (result.errors[declared.quantity][declared.norm],), ""
