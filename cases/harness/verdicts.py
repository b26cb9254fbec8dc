"""Verdicts from Results: which levels belong to which planned quantity, and what the order rule says of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mpm_verify.cases.harness.axes import cell_crossings, error, level, middle, replicated
from mpm_verify.cases.harness.refinement import Series, collect
from mpm_verify.cases.harness.study import Head, QuantityPlan, ResultRecord, Study, without
from mpm_verify.cases.judging.fit import local
from mpm_verify.cases.judging.order import Expectation, Level, Outcome, Quantity, Verdict, judge, judge_family
from mpm_verify.cases.judging.records import Ended
from mpm_verify.cases.judging.stall import BELOW, USUAL, Measured, Peer, Stall, explain

NOTHING_EXPECTED = Expectation(order=None)  # only its slope is used
STALLS = ("u", "rms")  # other quantities have orders of their own, which nobody has registered
DOUBLE = 1.8
Run = Any  # of any case with refinements
Result = ResultRecord[Any]
Results = Mapping[str, Result]


@dataclass(frozen=True)
class Finding:
    """Planned quantity with its verdict. Where it is only shown, the verdict is shown too and decides nothing.

    `results` are those of the levels with the particles at their usual positions, None for runs not done.
    """

    plan: QuantityPlan[Any]
    verdict: Verdict
    levels: tuple[Level, ...]  # coarse to fine
    finest: Result | None
    results: tuple[Result | None, ...] = ()
    stall: Stall | None = None

    @property
    def counts(self) -> bool:
        """Whether the verdict decides: that of a judged quantity, or a FAIL of one that can refute."""
        return self.plan.judged or (self.plan.refutes and self.verdict.outcome is Outcome.FAIL)

    @property
    def crossings(self) -> tuple[float | None, ...]:
        """Mean number of cell faces that a particle crossed, for the run of each level."""
        return tuple(cell_crossings(result) for result in self.results)


def findings(study: Study[Any], results: Results) -> list[Finding]:
    """Findings in the order of the plans; `results` by digest, those not there are runs not done."""
    known = {series.head: series for series in collect(study.runs)}
    quantities = [_quantity(plan, known.get(plan.head), results) for plan in study.plans]
    judged = [i for i, plan in enumerate(study.plans) if plan.judged]
    verdicts = dict(zip(judged, judge_family([quantities[i] for i in judged]), strict=True))
    found = []
    for i, (plan, quantity) in enumerate(zip(study.plans, quantities, strict=True)):
        verdict = verdicts.get(i) or judge(
            quantity.levels,
            quantity.expectation,
            floor=quantity.floor,
            dt_halved=quantity.dt_halved,
            multiple=quantity.multiple,
        )
        series = known.get(plan.head)
        done = tuple(results.get(run.digest) for run in series.runs) if series else ()
        found.append(Finding(plan, verdict, tuple(quantity.ordered), done[-1] if done else None, done))
    return _with_stalls(found, known, results)


def refinement(plan: QuantityPlan[Any], runs: Sequence[Run]) -> list[Run]:
    """Runs of a planned quantity at the Courant number of the study, coarse to fine, at the usual positions."""
    return next((list(series.runs) for series in collect(runs) if series.head == plan.head), [])


def _quantity(plan: QuantityPlan[Any], series: Series | None, results: Results) -> Quantity:
    """Levels of one planned quantity, and its error with half the time step on the finest level."""
    expectation = plan.expectation or NOTHING_EXPECTED
    if series is None:
        return Quantity([], expectation, 0.0, None)
    levels = [Level(1 / runs[0].cells, *level(runs, results, plan.quantity, plan.norm)) for runs in series.replicates]
    half = error(series.halved, results, plan.quantity, plan.norm) if series.halved else None
    still = plan.quantity == "u" and any(r.still for run in series.runs if (r := results.get(run.digest)))
    return Quantity(levels, expectation, _floor(plan.quantity, series, results), half, plan.multiple, still)


def _floor(quantity: str, series: Series, results: Results) -> float:
    """Round-off floor of the finest cells that have one, where errors are least and steps most."""
    floors = [(run.cells, r.floor[quantity]) for run in series.runs
              if (r := results.get(run.digest)) and quantity in r.floor]  # fmt: skip
    finest = max((cells for cells, _ in floors), default=0)
    return max((floor for cells, floor in floors if cells == finest), default=0.0)


def _with_stalls(found: Sequence[Finding], known: Mapping[Head, Series], results: Results) -> list[Finding]:
    """Findings, those of the displacement with the stall of their refinement."""
    displacements = [f for f in found if (f.plan.quantity, f.plan.norm) == STALLS and f.levels]
    peers = {f.plan.head: peer for f in displacements if (peer := _peer(f))}
    stalls = {f.plan.head: explain(_measured(f, known, results, peers)) for f in displacements}
    return [replace(f, stall=stalls.get(f.plan.head)) if f in displacements else f for f in found]


def _peer(found: Finding) -> Peer | None:
    """Numbers of this method for the stalls of others; None if a level has no error."""
    if any(each.ended for each in found.levels):
        return None
    done = doublings(found)
    order = local([(each.h, middle(each.errors)) for each, _ in done])[-1:]
    finest = done[-1][1] if done else None
    if finest is None or not order or order[0] is None:
        return None
    return Peer(found.plan.run.method, order[0], cell_crossings(finest) or 0.0, finest.gap)


def _measured(found: Finding, known: Mapping[Head, Series], results: Results, peers: Mapping[Head, Peer]) -> Measured:
    """Numbers that can tell why a refinement stalls."""
    plan, series = found.plan, known[found.plan.head]
    done = doublings(found)
    cells = tuple(result.run.cells for _, result in done)
    ended = [
        Ended(1 / result.run.cells, result.failure)
        for result in found.results
        if result and result.failure and cells and result.run.cells > cells[-1]
    ]
    order = plan.expectation.order if plan.expectation and plan.expectation.order is not None else USUAL
    mine = without("method", plan.head)
    others = [peer for key, peer in peers.items() if key != plan.head and without("method", key) == mine]
    finest = bool(done) and done[-1][1].run == series.runs[-1]  # else the run with half the time step is of other cells
    return Measured(
        cells,
        tuple(middle(each.errors) for each, _ in done),
        tuple(cell_crossings(result) or 0.0 for _, result in done),
        tuple(result.gap for _, result in done),
        plan.run.ppc,
        max((result.floor.get(plan.quantity, 0.0) for _, result in done), default=0.0),
        error(series.halved, results, *STALLS) if series.halved and finest else None,
        _other(series, known, results, cells),
        tuple(others),
        ended[0] if ended else None,
        order,
        plan.expectation.below if plan.expectation and plan.expectation.order is not None else BELOW,
        plan.run.damping_outside,
        max((result.scale.get(plan.quantity, 0.0) for _, result in done), default=0.0),
        _twin(series, known, results, cells, "damping", lambda run: run.damping_outside),
        series.first.stiffness,
        _twin(series, known, results, cells, "smoothing", lambda run: run.stiffness),
        series.first.strays,
        series.first.edge_noise,
        _quiet(series, known, results, cells),
        max((result.strain for _, result in done), default=0.0),
    )


def _quiet(series: Series, known: Mapping[Head, Series], results: Results, cells: Sequence[int]) -> float | None:
    """Least error of the refinements that damp the noise beside an edge, by another transfer or stress update."""
    twins = (_twin(series, known, results, cells, name, lambda run: run.edge_noise) for name in ("transfer", "stress"))
    return min((found for found in twins if found is not None), default=None)


def _twin(
    series: Series, known: Mapping[Head, Series], results: Results, cells: Sequence[int], name: str,
    has: Callable[[Run], float],
) -> float | None:  # fmt: skip
    """Error of the finest of `cells` in the refinement that differs in one field alone, and `has` not what this has."""
    if not (has(series.first) and cells):
        return None
    mine = without(name, series.head)
    twins = [s for key, s in known.items() if without(name, key) == mine and not has(s.first)]
    found = [error(run, results, *STALLS) for twin in twins for run in twin.runs if run.cells == cells[-1]]
    return found[0] if found else None


def doublings(found: Finding) -> list[tuple[Level, Result]]:
    """Finest finished level and those with about half the cells of the next: over less, orders scatter too much."""
    kept: list[tuple[Level, Result]] = []
    for each, result in reversed(list(zip(found.levels, found.results, strict=True))):
        if result and not each.ended and (not kept or each.h >= DOUBLE * kept[0][0].h):
            kept.insert(0, (each, result))
    return kept


def _other(
    series: Series, known: Mapping[Head, Series], results: Results, cells: Sequence[int]
) -> tuple[int, tuple[float, ...]] | None:
    """Errors of the two finest of `cells` with the next larger particle count, or else the next smaller one."""
    ppc, mine = series.first.ppc, without("ppc", series.head)
    counts = {s.first.ppc: s for key, s in known.items() if key != series.head and without("ppc", key) == mine}
    for count in sorted(counts, key=lambda count: (count < ppc, abs(count - ppc))):
        other = counts[count]
        levels = dict(zip((run.cells for run in other.runs), replicated(other, results, *STALLS), strict=True))
        if cells and levels.get(cells[-1]):
            return count, tuple(middle(levels[n]) for n in cells[-2:] if levels.get(n))
    return None
