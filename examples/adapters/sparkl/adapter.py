"""Adapter of sparkl2d, a Rust crate: python adapter.py CASE OUT [--precision f64] [--C zero] [--hold 1]."""

import argparse
import json
import os
import sys
from pathlib import Path

os.environ.setdefault("RAYON_NUM_THREADS", "1")
import numpy as np
from world import World

words = argparse.ArgumentParser()
words.add_argument("case", type=Path)
words.add_argument("out", type=Path)
words.add_argument("--precision", choices=("f32", "f64"), default="f32", help="f32 is that of the crate")
words.add_argument("--C", choices=("exact", "zero"), default="exact", help="gradient of v at first")
words.add_argument("--beside", type=int, default=4, help="cells beside the body")
words.add_argument("--hold", type=int, default=0, help="nodes at rest begin so many nodes inside a fixed edge")
told = words.parse_args()

# ---- what the case says
sys.path.insert(0, str(told.case))
from body_force import body_force  # noqa: E402

case = json.loads((told.case / "case.json").read_text())
table = np.genfromtxt(told.case / "particles.csv", delimiter=",", names=True)
X, x, v = (np.stack([table[a], table[b]], axis=1) for a, b in (("X", "Y"), ("x", "y"), ("vx_half", "vy_half")))
F, before = (np.stack([table[f"F{c}{a}"] for c in ("xx", "xy", "yx", "yy")], axis=1).reshape(-1, 2, 2)
             for a in ("", "_before"))  # fmt: skip
dt, dx, constants, sides = case["dt"], case["dx"], case["material"]["constants"], case["edges"]
assert "fixed_corotated" in case["material"]["name"], "take --material examples/adapters/mpm99/fixed_corotated.py"
assert set(sides.values()) <= {"fixed", "free"}, "no edges that slip or are prescribed"
assert case["body"] == "rectangle", "rectangles only"

# ---- nodes are at whole multiples of dx, none below 0; a fixed edge is a box, and the nodes inside it stick
shift = told.beside * dx - np.array(case["lower"])
gradient = (F - before) / dt @ np.linalg.inv(before) * (told.C == "exact")
world = World(told.precision, dx, constants["E"], constants["nu"], x + shift, v, gradient, F, table["m"], table["V0"])
low, high = (np.array(case[name]) + shift for name in ("lower", "upper"))
far = told.beside * dx
near = (told.hold + 0.25) * dx  # of the edge: between the last node that sticks and the next one
outer, inner = (low - far, high + far), (low + near, high - near)
boxes = {
    "left": (outer[0], (inner[0][0], outer[1][1])), "right": ((inner[1][0], outer[0][1]), outer[1]),
    "bottom": (outer[0], (outer[1][0], inner[0][1])), "top": ((outer[0][0], inner[1][1]), outer[1]),
}  # fmt: skip
for side in (side for side, kind in sides.items() if kind == "fixed"):
    world.wall(*boxes[side])
precise = {"f32": np.float32, "f64": np.float64}[told.precision]
for step in range(1, case["steps"] + 1):
    taken = world.step(dt, body_force(X, (step - 1) * dt))
    assert taken == precise(dt), f"step {step} took {taken} and not {dt}"
    if step in case["frames"]:
        x, v, F, failed = world.read()
        assert not failed.any(), f"step {step}: {failed.sum()} particles were given up"
        found = {"x": (x - shift).astype(precise), "v": v.astype(precise), "F": F.astype(precise)}
        np.savez(told.out / f"result_{step}.npz", id=table["id"], **found)
levels = {"v_lag": 0.5, "b": "start", "version": f"sparkl2d 0.4.0, mended, {told.precision}"}
(told.out / "result.json").write_text(json.dumps(levels))
