"""Faults planted in the text of the toy solver of `verify example python`, and its answers with them."""

import json
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.external.hints import hints
from mpm_verify.cases.solvers.answer import read
from mpm_verify.cases.solvers.callables import Case
from mpm_verify.cases.solvers.levels import levels
from mpm_verify.mms.export.case import Exported, Names, export
from mpm_verify.mms.export.record import CaseRecord
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create
from mpm_verify.solver.state import Floats

TOP = Path(__file__).parent.parent
TOY = (TOP / "cases" / "mms" / "external" / "examples" / "python" / "solver.py.in").read_text(encoding="utf-8")
LAW = "neo_hookean"
FORCE = "force = m[:, None] * exported.body_force(X, (step - 1) * dt)"
VELOCITY = 'v += dt * np.einsum("pk,pka->pa", N, acceleration[i])'
ADVANCE = 'F = F + dt * np.einsum("pka,pkb->pab", velocity[i], dN) @ F'
L = 'L = np.einsum("pka,pkb->pab", velocity[i], dN)\n    '
WALLS = "acceleration[held], velocity[held] = 0.0, 0.0"
FIRST = "s = (x - lower) / dx"
SIGMA = "        sigma, szz = stress(F)\n"
SAVE = '        np.savetxt(out / f"result_{step}.csv", rows,'
ROWS = 'table["id"], X, x, v, F.reshape(-1, 4)'
VOLUMES = "V = V0 * np.linalg.det(F)"

Force = Callable[[Floats, float], Floats]
Change = tuple[tuple[str, str], ...]


def before(line: str, *more: str) -> tuple[str, str]:
    """Lines before another one, with its indent."""
    indent = line[: len(line) - len(line.lstrip())]
    return line, "".join(f"{indent}{one}\n" for one in more) + line


def force(now: str) -> Change:
    """Another force."""
    return ((FORCE, FORCE.replace("m[", f"{now} * m[")),)


def also(*columns: tuple[str, str]) -> Change:
    """Columns more, by name and expression."""
    names, values = zip(*columns, strict=True)
    return before(SAVE, f"rows = np.column_stack([rows, {', '.join(values)}])"), (
        "szz,sxy",
        f"szz,sxy,{','.join(names)}",
    )


FAULTS: dict[str, Change] = {
    "none": (),
    "force never added": force("0"),
    "force of the other sign": force("-1"),
    "force a fifth too large": force("1.2"),
    "force at x": ((FORCE, FORCE.replace("(X,", "(x,")),),
    "force at (Y, X)": ((FORCE, FORCE.replace("(X,", "(X[:, ::-1],")),),
    "components of the force exchanged": ((FORCE, f"{FORCE}[:, ::-1]"),),
    "force one step late": ((FORCE, FORCE.replace("(step - 1)", "(step - 2)")),),
    "stress twice as large": ((VOLUMES, f"{VOLUMES} * 2"),),
    "FLIP ratio ignored (PIC)": ((VELOCITY, VELOCITY.replace("+= dt *", "=").replace("acceleration", "velocity")),),
    "symmetric part of L alone": ((ADVANCE, f"{L}F = F + dt / 2 * (L + L.transpose(0, 2, 1)) @ F"),),
    "F advanced by L transposed": ((ADVANCE, f"{L}F = F + dt * L.transpose(0, 2, 1) @ F"),),
    "factors of F in the other order": ((ADVANCE, f"{L}F = F + dt * F @ L"),),
    "F advanced twice": ((ADVANCE, f"{ADVANCE}\n    {ADVANCE}"),),
    "F written by columns": ((ROWS, ROWS.replace("F.", "F.transpose(0, 2, 1).")),),
    "increments keep what the wall took": ((WALLS, "velocity[held] = 0.0"),),
    "wall one node in": (("< 0.5 * dx", "< 1.5 * dx"),),
    "no half-step start": (("vx_half", "vx"), ("vy_half", "vy")),
    "dt one per cent too long": (('record["dt"],', '1.01 * record["dt"],'),),
    "sigma one step late": (("sigma, _ = stress(F)", "sigma, szz = stress(F)"), (SIGMA, "")),
    "sigma of the other sign": ((SIGMA, f"{SIGMA}        sigma, szz = -sigma, -szz\n"),),
    "sigma in other units": ((SIGMA, f"{SIGMA}        sigma, szz = 1e-6 * sigma, 1e-6 * szz\n"),),
    "plane stress": (("pressure = lam", "pressure = 2 * lam * mu / (lam + 2 * mu)"),),
    "V never updated": also(("V", "V0")),
    "V as it should be": also(("V", "V0 * np.linalg.det(F)")),
    "output one step old": (
        (FIRST, f"old = (x.copy(), v.copy(), F.copy())\n    {FIRST}"),
        (SIGMA, f"        x, v, F, now = *old, (x, v, F)\n{SIGMA}"),
        ('comments="")', 'comments="")\n        x, v, F = now'),
    ),
    "float32 output": (before(SAVE, "rows = rows.astype(np.float32)"),),
    "ids permuted": (
        before(SAVE, "rows[:, 0] = np.roll(rows[:, 0], 7)", "rows = np.delete(rows, [1, 2], axis=1)"),
        ("id,X,Y,x", "id,x"),
    ),
    "ids of other particles than X": (before(SAVE, "rows[:, 0] = np.roll(rows[:, 0], 7)"),),
    "half of the particles": (before(SAVE, "rows = rows[::2]"),),
    "NaN": (before(SAVE, "rows[5, 4] = np.nan"),),
    "an empty file": (before(SAVE, 'rows, head = np.zeros((0, 0)), ""'), ('comments="")', 'comments="", newline="")')),
    "crash": (before(SAVE, "raise SystemExit('the wall is missing')"),),
    "hang": (before(SAVE, "import time", "time.sleep(60)"),),
}  # fmt: skip


def faulty(name: str) -> str:
    """Text of the toy with a fault; each replacement has to be found."""
    text = TOY
    for old, new in FAULTS[name]:
        assert old in text, (name, old)
        text = text.replace(old, new)
    return text


@cache
def case_of(solution: str, cells: int) -> Exported:
    """Case with 16 frames, 4 particles in a cell."""
    made = create(SOLUTIONS, solution), create(MATERIALS, LAW)
    return export(Names(solution, LAW), *made, cells, 4, checked=False)


def answer(fault: str, record: CaseRecord, particles: Mapping[str, Floats], force: Force, out: Path) -> None:
    """Files of the toy with a fault: its text is executed here, on a folder that is written for it."""
    folder = out.with_name("case")
    folder.mkdir()
    (folder / "case.json").write_text(json.dumps(asdict(record)), encoding="utf-8")
    np.savetxt(folder / "particles.csv", np.column_stack(list(particles.values())), "%.17g", ",",
               header=",".join(particles), comments="")  # fmt: skip
    (folder / "body_force.py").write_text("body_force = None\n", encoding="utf-8")
    text = faulty(fault).replace("spec.loader.exec_module(exported)", "exported.body_force = force")
    words = sys.argv
    try:
        sys.argv = ["solver.py", str(folder), str(out)]
        exec(compile(text, "solver.py", "exec"), {"force": force, "__name__": "toy"})
    finally:
        sys.argv = words


def toy(fault: str) -> Callable[[Case], Any]:
    """The toy with a fault as a Python function."""

    def solve(case: Case) -> Any:
        X, found = case.array("X"), {}
        with TemporaryDirectory() as top:
            out = Path(top) / "out"
            out.mkdir()
            answer(fault, case.record, case.particles, case.body_force, out)
            for step in case.record.frames:
                found[step] = read(out, step, X, case.record.dx / 2).fields
        return found, {"v_lag": 0.5, "F_lag": 0, "version": fault}

    return solve


@cache
def hinted(fault: str, solution: str, cells: int) -> dict[str, float]:
    """Hints on one run of the toy with a fault."""
    case = case_of(solution, cells)
    exact, X = manufactured(solution, LAW), np.stack([case.particles["X"], case.particles["Y"]], axis=-1)
    with TemporaryDirectory() as top:
        out = Path(top) / "out"
        out.mkdir()
        answer(fault, case.record, case.particles, exact.b, out)
        frames = {step: read(out, step, X, case.record.dx / 2) for step in case.record.frames}
        return hints(exact, case, frames, levels(out))
