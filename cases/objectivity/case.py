"""Frame indifference: the paper's rotated block against its closed form, objective rates, and negative controls.

The contract of a case is told in cases/harness/contract.py.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from mpm_verify.cases.harness.build import axes
from mpm_verify.cases.harness.checks import Check, Curves, Examination, gathered
from mpm_verify.cases.harness.store import Store, StoreError
from mpm_verify.cases.harness.study import Study
from mpm_verify.cases.objectivity.axes import BLOCK, KINEMATIC, Block
from mpm_verify.cases.objectivity.block import blocks
from mpm_verify.cases.objectivity.exam import examination
from mpm_verify.cases.objectivity.result import ObjectivityResult

__all__ = ["Result", "Run", "companions", "examine", "title"]

Run, Result = Block, ObjectivityResult


@dataclass(frozen=True)
class ObjectivityAnalysis:
    """Analysis: an Examination of each block that all parts are stored of."""

    examinations: Mapping[str, Examination]

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of all blocks."""
        return gathered(self.examinations)


def title(runs: Sequence[Block]) -> str:
    """Title of a study."""
    return "Frame indifference of the paper's rotated block"


def companions(runs: Sequence[Block]) -> list[Block]:
    """Runs with a smaller block, the box at rest, every negative control, and the kinematic part."""
    return [one for run in runs for one in (*blocks(run).values(), replace(run, part=KINEMATIC))]


def examine(study: Study[Block], results: Mapping[str, ObjectivityResult], store: Store) -> ObjectivityAnalysis:
    """Judge each block of which all parts are stored."""
    found: dict[str, Examination] = {}
    bases = [replace(run, part=BLOCK) for run in study.runs if run.part == KINEMATIC]
    for base in bases:
        named = {**blocks(base), KINEMATIC: replace(base, part=KINEMATIC)}
        stored = {name: results[run.digest] for name, run in named.items() if run.digest in results}
        arrays = {name: curves(store, result) for name, result in stored.items()}
        if len(stored) == len(named):
            name = ", ".join(f"{axis} {getattr(base, axis)}" for axis in axes(bases))
            found[name] = examination(study, base, stored, arrays)
    return ObjectivityAnalysis(found)


def curves(store: Store, result: ObjectivityResult) -> Curves:
    """Stored curves by name; none where they cannot be read."""
    try:
        arrays: dict[str, Any] = store.arrays(result.digest)
    except StoreError:
        return {}
    found: Curves = {}
    for key, values in arrays.items():
        name, _, column = key.rpartition("/")
        found.setdefault(name, {})[column] = values
    return found
