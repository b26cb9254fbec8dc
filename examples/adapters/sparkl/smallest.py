"""Smallest experiments with sparkl2d: python smallest.py prints them as JSON. Build first: build.py published f32."""

import json
import subprocess
import sys

import numpy as np
from world import World, stress

CONSTANTS = {"E": 1e4, "nu": 0.3}
STRAIN = 1e-3
FEW, FIVE = (1, 4), 5


def world(kind, x, v):
    """Unit particles of unit volume in cells of unit width."""
    one = np.ones(len(x))
    F = np.tile(np.eye(2), (len(x), 1, 1))
    return World(kind, 1.0, **CONSTANTS, x=np.array(x, float), v=np.array(v, float), gradient=0 * F, F=F, m=one, V=one)


def moved(kind, count):
    """Way in x of the first of a few particles with velocity 1, after a step of 0.001, and whether it was given up."""
    here = world(kind, [(8.5 + 0.1 * k, 8.5) for k in range(count)], [(1.0, 0.0)] * count)
    here.step(1e-3, np.zeros((count, 2)))
    x, _, _, failed = here.read()
    return {"kind": kind, "count": count, "way": float(f"{x[0, 0] - 8.5:.3g}"), "failed": bool(failed[0])}


def ended(kind, count):
    """Whether a process ends in the middle of such a step."""
    words = [sys.executable, __file__, "--moved", kind, str(count)]
    return {"kind": kind, "count": count, "ended": subprocess.run(words, capture_output=True).returncode != 0}


def beside_a_wall():
    """Velocities after a step near a wall whose last node that sticks is at x = 8; before it they are (0, 1)."""
    at = [8.0, 8.25, 8.5, 8.75, 9.0]
    x = [(a + b, 8.0 + c) for a in (0.0, 1.0) for b in at for c in np.arange(-2, 2.25, 0.25)]
    here = world("f32", x, [(0.0, 1.0)] * len(x))
    here.wall((4.0, 4.0), (8.25, 12.0))
    here.step(1e-6, np.zeros((len(x), 2)))
    _, v, _, _ = here.read()
    middle = [k for k, (_, y) in enumerate(x) if y == 8.0][: len(at)]
    return [{"beside": a - 8.0, "velocity": float(f"{v[k, 1]:.4g}")} for a, k in zip(at, middle, strict=True)]


def stretched():
    """Kirchhoff stress of a small stretch along x in each model, over the strain, and that of plane strain."""
    lam = CONSTANTS["E"] * CONSTANTS["nu"] / (1 + CONSTANTS["nu"]) / (1 - 2 * CONSTANTS["nu"])
    mu = CONSTANTS["E"] / 2 / (1 + CONSTANTS["nu"])
    F = np.diag([1 + STRAIN, 1.0])
    rows = {name: stress("f32", name, **CONSTANTS, F=F) for name in ("corotated", "neo_hookean")}
    found = {name: [float(f"{one / STRAIN:.3g}") for one in (row[0, 0], row[1, 1])] for name, row in rows.items()}
    return found | {"plane_strain": [float(f"{one:.3g}") for one in (lam + 2 * mu, lam)]}


if __name__ == "__main__":
    if sys.argv[1:2] == ["--moved"]:
        moved(sys.argv[2], int(sys.argv[3]))
        sys.exit()
    print(json.dumps({
        "moved": [*(moved("published", count) for count in FEW), *(moved("f32", count) for count in (*FEW, FIVE))],
        "ended": [ended(kind, FIVE) for kind in ("published", "f32")],
        "beside_a_wall": beside_a_wall(),
        "stretched": stretched(),
    }, indent=1))  # fmt: skip
