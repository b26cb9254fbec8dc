"""How far a run has come, told after each step."""

from collections.abc import Callable
from dataclasses import dataclass

from mpm_verify.solver.model import Model, Observer


@dataclass
class Progress(Observer):
    """Calls `tick` with the fraction of `steps` that is done."""

    tick: Callable[[float], None]
    steps: int

    def after_step(self, model: Model) -> None:
        """Tell it."""
        self.tick(model.steps / self.steps)
