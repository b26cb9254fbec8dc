"""Observers: they are called where they say, in their order, and change nothing; without them nothing is called."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from mpm_verify.cases.column.execute import gravity, setup
from mpm_verify.cases.column.run import ColumnRun
from mpm_verify.solver.model import HOOKS, Model, Observer
from mpm_verify.solver.step import advance

RUN = ColumnRun(cells=4, ppc=4, duration=0.05, damping=0.05)


class All(Observer):
    """Writes down the hooks, and what it sees there."""

    def __init__(self) -> None:
        self.seen: list[tuple[str, int]] = []
        self.v: dict[str, Any] = {}

    def note(self, hook: str, model: Model) -> None:
        self.seen.append((hook, model.steps))
        self.v[hook] = model.particles.v.copy(), model.grid.velocity.copy()

    def before_forces(self, model: Model) -> None:
        self.note("before_forces", model)

    def after_motion(self, model: Model) -> None:
        self.note("after_motion", model)

    def after_particles(self, model: Model) -> None:
        self.note("after_particles", model)

    def after_step(self, model: Model) -> None:
        self.note("after_step", model)


class Late(Observer):
    """Has one hook."""

    def __init__(self, times: list[int]) -> None:
        self.times = times

    def after_step(self, model: Model) -> None:
        self.times.append(model.steps)


def went(*observers: Observer, stress: str = "usl") -> Model:
    model, _ = setup(RUN)
    model.scheme = replace(model.scheme, stress=stress)
    model.watch(*observers)
    for _ in range(5):
        advance(model, gravity)
    return model


@pytest.mark.parametrize("stress", ["usl", "musl", "usf"])
def test_hooks_are_called_once_a_step_in_their_order(stress: str) -> None:
    watch = All()
    went(watch, stress=stress)
    assert [hook for hook, _ in watch.seen] == list(HOOKS) * 5
    assert [step for hook, step in watch.seen if hook == "after_step"] == [1, 2, 3, 4, 5]
    assert [step for hook, step in watch.seen if hook != "after_step"] == [k for k in range(5) for _ in range(3)]


def test_each_hook_sees_its_part_of_the_step() -> None:
    """The grid moves between the first two, the particles between the next."""
    watch = All()
    went(watch)
    (v0, grid0), (v1, grid1), (v2, _), (v3, _) = (watch.v[hook] for hook in HOOKS)
    np.testing.assert_array_equal(v0, v1)
    assert np.abs(grid1 - grid0).max() > 1e-4
    assert np.abs(v2 - v1).max() > 1e-4
    np.testing.assert_array_equal(v2, v3)


def test_only_what_is_overridden_is_called() -> None:
    times: list[int] = []
    model = went(Late(times), Observer())
    assert [len(model.hooks[hook]) for hook in HOOKS] == [0, 0, 0, 1]
    assert times == [1, 2, 3, 4, 5]


def test_who_comes_first_is_called_first() -> None:
    order: list[str] = []

    class One(Late):
        def after_step(self, model: Model) -> None:
            order.append("one")

    class Two(Late):
        def after_step(self, model: Model) -> None:
            order.append("two")

    model = went(One([]), Two([]))
    assert order == ["one", "two"] * 5
    assert model.steps == 5


def test_watching_changes_no_bit() -> None:
    from mpm_verify.cases.column.measure import Measure

    alone, (watched, _) = went(), setup(RUN)
    assert not any(alone.hooks.values())
    watched.watch(Measure(RUN, watched), All())
    for _ in range(5):
        advance(watched, gravity)
    for name in ("x", "v", "F", "sigma"):
        np.testing.assert_array_equal(getattr(alone.particles, name), getattr(watched.particles, name))
