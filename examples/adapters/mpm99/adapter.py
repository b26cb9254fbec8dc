"""Adapter of mpm99, an example that taichi ships: python adapter.py CASE OUT [--F now] [--C zero] [--precision f32]."""

import argparse
import importlib.util
import json
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

words = argparse.ArgumentParser()
words.add_argument("case", type=Path)
words.add_argument("out", type=Path)
words.add_argument("--F", choices=("before", "now"), default="before", help="level of F that is started from: -dt or 0")
words.add_argument("--C", choices=("exact", "zero"), default="exact", help="gradient of v at first; zero: F at 0")
words.add_argument("--beside", type=int, default=4, help="cells beside the body; mpm99 holds three")
words.add_argument("--precision", choices=("f64", "f32"), default="f64")
told = words.parse_args()
after = "_before" if told.F == "before" and told.C == "exact" else ""

# ---- what the case says
sys.path.insert(0, str(told.case))
from body_force import body_force  # noqa: E402

case = json.loads((told.case / "case.json").read_text())
table = np.genfromtxt(told.case / "particles.csv", delimiter=",", names=True)
X, x, v = (np.stack([table[a], table[b]], axis=1) for a, b in (("X", "Y"), ("x", "y"), ("vx_half", "vy_half")))
F, start = (np.stack([table[f"F{c}{a}"] for c in ("xx", "xy", "yx", "yy")], axis=1).reshape(-1, 2, 2)
            for a in ("", after))  # fmt: skip
before = np.stack([table[f"F{c}_before"] for c in ("xx", "xy", "yx", "yy")], axis=1).reshape(-1, 2, 2)
dt, dx, constants = case["dt"], case["dx"], case["material"]["constants"]
assert "fixed_corotated" in case["material"]["name"], "take --material examples/adapters/mpm99/fixed_corotated.py"
assert set(case["edges"].values()) == {"free"}, "the band of three cells is no wall at a position: take bump"
assert case["ppc"] == 4, "mpm99 has four particles in a cell"

# ---- the shipped text, patched: each line has to be there once
example = Path(importlib.util.find_spec("taichi").submodule_search_locations[0]) / "examples/simulation/mpm99.py"
text = example.read_text(encoding="utf-8")
side = case["cells"] + 2 * told.beside  # cells of the grid
for line, instead in (
    ("ti.init(arch=ti.gpu)", f"ti.init(arch=ti.cpu, default_fp=ti.{told.precision}, cpu_max_num_threads=1)"),
    ("n_particles, n_grid = 9000 * quality**2, 128 * quality", f"n_particles, n_grid = {len(X)}, {side}"),
    ("dx, inv_dx = 1 / n_grid, float(n_grid)", f"dx, inv_dx = {dx!r}, {1 / dx!r}"),
    ("dt = 1e-4 / quality", f"dt = {dt!r}"),
    ("p_vol, p_rho = (dx * 0.5) ** 2, 1", f"p_vol, p_rho = (dx * 0.5) ** 2, {constants['rho0']!r}"),
    ("E, nu = 0.1e4, 0.2", f"E, nu = {constants['E']!r}, {constants['nu']!r}"),
    ("            h = 0.3\n", "            h = 1.0\n"),
    ("material = ti.field(", "force = ti.Vector.field(2, dtype=float, shape=n_particles)\nmaterial = ti.field("),
    ("weight * (p_mass * v[p] + affine @ dpos)", "weight * (p_mass * (v[p] + dt * force[p]) + affine @ dpos)"),
    ("            grid_v[i, j][1] -= dt * 50  # gravity\n", ""),
):
    assert text.count(line) == 1, f"{example} has not exactly one {line!r}: another version of taichi?"
    text = text.replace(line, instead)
(told.out / "mpm99_patched.py").write_text(text, encoding="utf-8")  # Taichi reads the source of its kernels
sys.path.insert(0, str(told.out))
import mpm99_patched as mpm99  # noqa: E402

# ---- particles, and steps: F is advanced first in a step, by the gradient of the last one
shift = told.beside * dx - np.array(case["lower"])
mpm99.x.from_numpy(x + shift)
mpm99.v.from_numpy(v)
mpm99.F.from_numpy(start)
mpm99.C.from_numpy((F - before) / dt @ np.linalg.inv(before) * (told.C == "exact"))
mpm99.Jp.fill(1.0)
mpm99.material.fill(1)
for step in range(1, case["steps"] + 1):
    mpm99.force.from_numpy(body_force(X, (step - 1) * dt))
    mpm99.substep()
    if step in case["frames"]:
        found = {"x": mpm99.x.to_numpy() - shift, "v": mpm99.v.to_numpy(), "F": mpm99.F.to_numpy()}
        np.savez(told.out / f"result_{step}.npz", id=table["id"], **found)
late = 0.0 if told.F == "now" and told.C == "exact" else 1.0
levels = {"v_lag": 0.5, "F_lag": late, "b": "start", "version": f"taichi {version('taichi')}"}
(told.out / "result.json").write_text(json.dumps(levels))
