"""Time levels that a step needs: a toy with central differences, whose step wants the body force of its end."""

import sys
from itertools import pairwise
from math import log
from pathlib import Path
from typing import Any

import pytest
from fixtures_faults import TOY

import mpm_verify as mv
from mpm_verify.cases.mms.run import STARTS
from mpm_verify.reports.sentences import own_solver
from mpm_verify.verify.terminal.table import by_start

SHEAR = "clamped_shear:G=1e-6"
HALF_STEP = 'v = np.stack([table["vx_half"], table["vy_half"]], axis=1)  # half a step before x'
AT_ZERO = 'v = np.stack([table["vx"], table["vy"]], axis=1)\na = exported.body_force(X, 0.0)  # the stress is 0'
STEP = """    mass, middle, total = np.zeros(len(node)), np.zeros((len(node), 2)), np.zeros((len(node), 2))
    np.add.at(mass, i, N * m[:, None])
    np.add.at(middle, i, N[:, :, None] * (m[:, None] * (v + dt / 2 * a))[:, None])
    full = mass > 1e-12 * m.mean()
    middle = np.where(full[:, None], middle / np.where(full, mass, 1)[:, None], 0.0)
    middle[held] = 0.0
    F = F + dt * np.einsum("pka,pkb->pab", middle[i], dN) @ F
    sigma, _ = stress(F)
    V = V0 * np.linalg.det(F)
    force = m[:, None] * exported.body_force(X, (step - 1) * dt)
    np.add.at(total, i, N[:, :, None] * force[:, None] - np.einsum("p,pab,pkb->pka", V, sigma, dN))
    acceleration = np.where(full[:, None], total / np.where(full, mass, 1)[:, None], 0.0)
    acceleration[held] = 0.0
    x += dt * np.einsum("pk,pka->pa", N, middle[i])
    before, a = a, np.einsum("pk,pka->pa", N, acceleration[i])
    v += dt / 2 * (before + a)
"""


def central_difference(b: str = "start") -> str:
    """The toy with central differences: v and a of a particle at the times of x, F advanced with v of the middle.

    The acceleration of the start is b, as F is I there.
    """
    begins, ends = TOY.index("    sigma, _ = stress(F)\n"), TOY.index('    if step in record["frames"]')
    text = TOY[:begins].replace(HALF_STEP, AT_ZERO) + STEP + TOY[ends:].replace('"v_lag": 0.5', '"v_lag": 0')
    assert AT_ZERO in text
    return text if b == "start" else text.replace("(step - 1) * dt)", "step * dt)")


# errors of u that KratosMPMApplication has with central differences, see docs/public-codes.md: all digits
KNOWN = {
    "start": ((1.097e-7, 6.210e-8, 4.337e-8, 2.723e-8), (1.40, 1.25, 1.15)),
    "end": ((7.431e-8, 3.206e-8, 1.776e-8, 7.811e-9), (2.07, 2.05, 2.03)),
}


def studied(b: str, folder: Path, cells: list[int], **more: Any) -> mv.StoredStudy:
    """Study of the toy, nothing of which is judged."""
    (folder / "central.py").write_text(central_difference(b))
    typed = f"{sys.executable} {folder / 'central.py'} {{case}} {{out}}"
    axes = {"cells": cells, "ppc": 4, "courant": [0.4], **more}
    return mv.study("mms", solver=typed, solution=SHEAR, out=folder / "study", **axes)


@pytest.mark.slow
@pytest.mark.parametrize("b", KNOWN)
def test_errors_and_orders_are_those_of_a_public_code(b: str, tmp_path: Path) -> None:
    """With b of the start they are of order 1: a fault of what the step is given, and not of the step."""
    cells, (known, orders) = [8, 12, 16, 24], KNOWN[b]
    done = studied(b, tmp_path, cells)
    errors = {r.run.cells: r.errors["u"]["rms"] for r in done.record.results.values() if r.run.courant == 0.4}
    assert [float(f"{errors[n]:.3e}") for n in cells] == list(known)
    found = [log(errors[n] / errors[m]) / log(m / n) for n, m in pairwise(cells)]
    assert [round(order, 2) for order in found] == list(orders)


@pytest.mark.slow
def test_the_scan_of_time_levels_finds_b_at_the_end(tmp_path: Path) -> None:
    """The same program on all combinations of --start: one alone has order 2, and is named."""
    done = studied("start", tmp_path, [12, 16], start=list(STARTS))
    orders = by_start(done.record)
    assert set(orders) == set(STARTS)
    assert orders["zero.now.start"] == pytest.approx(1.25, abs=0.005)
    assert orders["zero.now.end"] == pytest.approx(2.06, abs=0.005)  # 2.05 where a at 0 is exact, and not that of dt
    assert max(order for name, order in orders.items() if name != "zero.now.end") < 1.75
    said = "Order 2.06 with v at 0, F and sigma at 0, b at its end; with the others 1.25 to 1.71."
    assert own_solver.starts(orders) == said
