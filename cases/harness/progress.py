"""Progress of a run, told after each step."""

from collections.abc import Callable
from dataclasses import dataclass

from mpm_verify.solver.model import Model, Observer


@dataclass
class Progress(Observer):
    """Observer that calls `tick` with the fraction of `steps` that is done."""

    tick: Callable[[float], None]
    steps: int

    def after_step(self, model: Model) -> None:
        """Tell the fraction."""
        self.tick(model.steps / self.steps)
