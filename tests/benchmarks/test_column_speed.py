"""Speed of the column: updates a second while it moves, what each extra costs, and how time grows with particles."""

from dataclasses import replace
from time import perf_counter

import pytest
from test_speed import paired, report, updates_a_second

from mpm_verify.cases.column.execute import gravity, setup
from mpm_verify.cases.column.measure import Measure
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver._jit import use_threads
from mpm_verify.solver.step import Model, advance

USUAL = ColumnRun()
SETTLED = 400  # steps after which it shears and slips
SIZES = {4: "1 thousand", 14: "12 thousand", 42: "111 thousand", 135: "1.1 million"}  # cells of the width, 9 per cell
EXTRAS = {
    "damping": {"damping": 0.05},
    "deviatoric smoothing": {"smoothing": "deviatoric"},
    "UBCSAND": {"material": "ubcsand"},
    "void memory off": {"void": False},
    "classical MPM": {"method": "mpm"},
    "GIMP": {"method": "gimp"},
}


def moving(run: ColumnRun, steps: int) -> Model:
    model, _ = setup(run)
    Measure(run, model)  # its energy budget watches the steps, as in every run of the case
    for _ in range(steps):
        advance(model, gravity)
    return model


def per_update(model: Model, updates: float = 1e7) -> float:
    """Nanoseconds an update, over so many updates."""
    steps = max(4, round(updates / len(model.particles)))
    started = perf_counter()
    for _ in range(steps):
        advance(model, gravity)
    return (perf_counter() - started) / steps / len(model.particles) * 1e9


@pytest.mark.parametrize("threads", [1, 2])
def test_updates_of_the_column(benchmark, threads: int) -> None:
    """The usual column: CPDI, Mohr-Coulomb, 14 cells of the width, 9 per cell."""
    use_threads(threads)
    model = moving(USUAL, SETTLED)
    benchmark.pedantic(advance, (model, gravity), rounds=400, warmup_rounds=20)
    updates_a_second(benchmark, model)


@pytest.mark.slow
def test_growth(benchmark) -> None:
    """Time an update over that of a thousand particles, up to a million: it must not grow by more than a half.

    Of a thousand, a third is what a step costs beside its particles; so the others are below it.
    """
    use_threads(1)
    few = moving(replace(USUAL, cells=min(SIZES)), 50)
    per_update(few)
    for cells, name in SIZES.items():
        model = moving(replace(USUAL, cells=cells), 5 if cells > 42 else 50)
        ratio = sorted(per_update(model) / per_update(few) for _ in range(3))[1]
        benchmark.extra_info[f"{name} particles: time an update over that of a thousand"] = ratio
        print(f"\n{name} particles: {ratio:.2f} of the time an update that a thousand take")
        assert ratio < 1.5, name
    benchmark.pedantic(lambda: None)


@pytest.mark.parametrize("extra", EXTRAS)
def test_what_an_extra_costs(benchmark, extra: str) -> None:
    """Time of a step over that of the usual column."""
    use_threads(1)
    usual, other = (moving(replace(USUAL, **change), SETTLED) for change in ({}, EXTRAS[extra]))
    ratio, _ = paired(lambda: advance(usual, gravity), lambda: advance(other, gravity), 200)
    report(benchmark, f"{extra}: time of a step over the usual column's", ratio)
