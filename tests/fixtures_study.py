"""A synthetic stored study with the recorded numbers of docs/results.md: a report can be tested without a solver."""

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

from mpm_verify.cases.harness import identity
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.store import Arrays, Store
from mpm_verify.cases.harness.study import QuantityPlan, Study
from mpm_verify.cases.judging.order import Expectation
from mpm_verify.cases.judging.records import Recorded
from mpm_verify.cases.mms.run import NORMS, QUANTITIES, Result, Run
from mpm_verify.mms.blind_spots import ALWAYS, BlindSpot, BlindSpotCode
from mpm_verify.solver.failure import Failure, FailureKind

CELLS = (8, 16, 32, 64, 128)
U_RMS: dict[tuple[str, int], tuple[float, ...]] = {  # the runs behind the last number failed
    ("cpdi", 1): (2.884e-3, 1.029e-3, 2.892e-4, 7.684e-5, 1.930e-5),
    ("cpdi", 4): (3.043e-3, 7.122e-4, 1.800e-4, 4.498e-5, 1.127e-5),
    ("cpdi", 9): (2.590e-3, 7.502e-4, 1.706e-4, 4.275e-5, 1.066e-5),
    ("mpm", 1): (8.532e-3,),
    ("mpm", 4): (4.814e-3, 6.724e-3, 1.432e-2, 2.573e-2),
    ("mpm", 9): (3.781e-3, 4.280e-3, 9.485e-3, 1.618e-2),
}
SIZE = {"u": 1.0, "v": 320.0, "F": 11.0, "sigma": 9.0e4}  # errors of the others, in errors of u
SCALE = {"u": 0.025, "v": 7.9, "F": 1.02, "sigma": 1700.0}
AUDIT = (
    BlindSpot(BlindSpotCode.SHEAR, True, {"shear": 0.0}),
    BlindSpot(BlindSpotCode.VOLUME, False, {"J_min": 0.5, "J_max": 1.7}),
    *ALWAYS,
)
GAP: dict[str, float | None] = {"cpdi": 0.1, "mpm": None}  # at 8 cells
SECOND = Expectation(
    2.0, 0.2, 0.3, source="Sadeghirad et al. 2011", recorded=(Recorded(1 / 128, 1.127e-5, 1.127e-5),), within=0.01
)
NONE = Expectation(None, source="Steffen, Kirby & Berzins 2008")
ENVIRONMENT = {
    "commit": "0123456789abcdef",
    "processor": "example processor, 2 cores",
    "python": "3.11.9",
    "numpy": "2.4.6",
}
HALF_PPC = (4, 9)  # judged: their finest level is run with half the time step as well


def make(folder: Path, methods: tuple[str, ...] = ("cpdi", "mpm"), skip: int = 0, largest: int = 32) -> Path:
    """Store the study in `folder` and give it back; the last `skip` runs are left undone.

    Arrays are stored for grids up to `largest` cells. Digests do not depend on the sources of the solver.
    """
    with patch.object(identity, "sources", _no_sources):
        runs = [Run(m, "axis_aligned", "neo_hookean", n, p, 0.4) for m, p in U_RMS if m in methods for n in CELLS]
        runs += [Run(m, "axis_aligned", "neo_hookean", 128, p, 0.2) for m in methods for p in HALF_PPC if m == "cpdi"]
        command = "verify mms " + " ".join(f"--method {m}" for m in methods)
        study = Study(
            "mms", "Manufactured solution: axis_aligned", command, tuple(runs), _declared(methods), case="mms"
        )
        store = Store(folder)
        store.create(study)
        for run in runs[: len(runs) - skip]:
            store.put(_result(run), arrays(run) if run.cells <= largest else {})
    return folder


def sources() -> AbstractContextManager[object]:
    """A context in which digests are those of `make`: render inside it."""
    return patch.object(identity, "sources", _no_sources)


def _no_sources(*_: object) -> str:
    return "synthetic"


def _declared(methods: tuple[str, ...]) -> tuple[QuantityPlan[Run], ...]:
    found = []
    for method, ppc in U_RMS:
        for quantity in QUANTITIES if method in methods else ():
            for norm in NORMS:
                judged = quantity == "u" and norm == "rms" and ppc in HALF_PPC
                expected = {"cpdi": SECOND if ppc == 4 else Expectation(2.0, source=SECOND.source), "mpm": NONE}[method]
                known = quantity == "u" and norm == "rms"
                of = expected if known else None
                found.append(plan(method, "axis_aligned", ppc, quantity, norm, judged, of))
    return tuple(found)


def plan(
    method: str, solution: str, ppc: int, quantity: str, norm: str, judged: bool, expectation: Expectation | None
) -> QuantityPlan[Run]:
    """What is declared of a quantity of a refinement from 8 cells, with the material of this module."""
    run = Run(method, solution, "neo_hookean", CELLS[0], ppc, 0.4)
    return QuantityPlan(run, quantity, norm, judged, expectation)


def built(replicates: int = 1, **axes: Any) -> Study[Run]:
    """The study of `verify mms` with these values of its axes, a sequence each."""
    return build(Asked("mms", axes, replicates), "verify mms", "t")


def _result(run: Run) -> Result:
    known = U_RMS[run.method, run.ppc]
    level = CELLS.index(run.cells)
    particles, steps = run.ppc * run.cells**2, round(2 * run.cells / run.courant)
    lost = level >= len(known)
    failure = (
        Failure(FailureKind.INVERTED, steps // 3, 7 * run.cells, (run.cells // 4, run.cells // 2)) if lost else None
    )
    rms = 0.0 if lost else known[level] * (1.004 if run.courant < 0.4 else 1.0)
    errors = {} if lost else {q: _norms(rms * SIZE[q], steps * particles) for q in QUANTITIES}
    return Result(
        run=run,
        digest=run.digest,
        status="failed" if lost else "finished",
        errors=errors,
        steps=failure.step if failure else steps,
        particles=particles,
        crossings=round(particles * run.cells / 4 * (failure.step / steps if failure else 1)),
        gap=GAP[run.method] and GAP[run.method] * 8 / run.cells,
        dt=run.courant / run.cells / 100,
        wall_s=1e-6 * particles * steps,
        peak_memory_mb=90 + 4e-4 * particles,
        scale=SCALE,
        floor=dict.fromkeys(QUANTITIES, 1e-14),
        failure=failure,
        environment=ENVIRONMENT,
        audit=AUDIT,
    )


def _norms(rms: float, samples: int) -> dict[str, float]:
    return {"rms": rms, "max": 3.1 * rms, "final": 0.83 * rms, "printed": rms / samples**0.5}


def arrays(run: Run) -> Arrays:
    """Particles of a plausible last step: the axis-aligned field at half its amplitude, an error that waves over it."""
    side = round(run.ppc**0.5)
    n = run.cells * side
    axis = (np.arange(n) + 0.5) / n
    X = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    u = 0.025 * np.sin(2 * np.pi * X) * [1, -1]
    F = np.zeros((len(X), 2, 2))
    F[:, [0, 1], [0, 1]] = 1 + 0.025 * 2 * np.pi * np.cos(2 * np.pi * X) * [1, -1]
    known = U_RMS[run.method, run.ppc]
    rms = known[min(CELLS.index(run.cells), len(known) - 1)]
    wave = np.abs(np.sin(2 * np.pi * X[:, 0]) * np.cos(3 * np.pi * X[:, 1])) + 0.1
    r0 = np.broadcast_to(np.eye(2) / (2 * n), (len(X), 2, 2))
    stored = {"X": X, "x": X + u, "F": F, "r0": r0, "error_u": rms * wave}
    return {name: np.ascontiguousarray(a, dtype=np.float32) for name, a in stored.items()}
