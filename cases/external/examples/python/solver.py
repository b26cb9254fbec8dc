"""A whole material point method: hats, FLIP, stress updated last, neo-Hookean. Usage: python solver.py CASE OUT"""

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np

case, out = Path(sys.argv[1]), Path(sys.argv[2])

# ---- what the case says
record = json.loads((case / "case.json").read_text())
table = np.genfromtxt(case / "particles.csv", delimiter=",", names=True)
spec = importlib.util.spec_from_file_location("body_force", case / "body_force.py")
exported = importlib.util.module_from_spec(spec)
spec.loader.exec_module(exported)
dx, dt, lam, mu = record["dx"], record["dt"], record["material"]["constants"]["lam"], record["material"]["constants"]["mu"]
lower, upper = np.array(record["grid_lower"]), np.array(record["grid_upper"])
X = np.stack([table["X"], table["Y"]], axis=1)
x = np.stack([table["x"], table["y"]], axis=1)
v = np.stack([table["vx_half"], table["vy_half"]], axis=1)  # half a step before x
F = np.stack([table[f"F{c}"] for c in ("xx", "xy", "yx", "yy")], axis=1).reshape(-1, 2, 2)
m, V0 = table["m"], table["V0"]
n = np.rint((upper - lower) / dx).astype(int) + 1
node = lower + dx * np.stack(np.meshgrid(np.arange(n[0]), np.arange(n[1]), indexing="ij"), axis=-1).reshape(-1, 2)
held = np.zeros((len(node), 2), bool)
for side, axis, at in (("left", 0, lower), ("right", 0, upper), ("bottom", 1, lower), ("top", 1, upper)):
    on = np.abs(node[:, axis] - at[axis]) < 0.5 * dx
    if record["edges"][side] in ("fixed", "roller"):
        held[on, axis] = True
    if record["edges"][side] == "fixed":
        held[on] = True


def stress(F):
    """Cauchy stress (P,2,2) of F, and sigma_zz (P,)."""
    J = np.linalg.det(F)
    pressure = lam * np.log(J) / J
    inside = mu / J[:, None, None] * (F @ F.transpose(0, 2, 1) - np.eye(2)) + pressure[:, None, None] * np.eye(2)
    return inside, pressure


# ---- time steps
for step in range(1, record["steps"] + 1):
    s = (x - lower) / dx
    base = np.floor(s).astype(int)
    s = s - base
    i = np.stack([(base[:, 0] + a) * n[1] + base[:, 1] + b for a in (0, 1) for b in (0, 1)], axis=1)
    hat = np.stack([1 - s, s], axis=1)  # (P, node, axis)
    N = np.stack([hat[:, a, 0] * hat[:, b, 1] for a in (0, 1) for b in (0, 1)], axis=1)
    dN = np.stack([np.stack([(2 * a - 1) * hat[:, b, 1], (2 * b - 1) * hat[:, a, 0]], axis=1)
                   for a in (0, 1) for b in (0, 1)], axis=1) / dx
    sigma, _ = stress(F)
    V = V0 * np.linalg.det(F)
    force = m[:, None] * exported.body_force(X, (step - 1) * dt)  # at the start of the step
    mass, momentum, total = np.zeros(len(node)), np.zeros((len(node), 2)), np.zeros((len(node), 2))
    np.add.at(mass, i, N * m[:, None])
    np.add.at(momentum, i, N[:, :, None] * (m[:, None] * v)[:, None])
    np.add.at(total, i, N[:, :, None] * force[:, None] - np.einsum("p,pab,pkb->pka", V, sigma, dN))
    full = mass > 1e-12 * m.mean()
    acceleration = np.where(full[:, None], total / np.where(full, mass, 1)[:, None], 0.0)
    velocity = np.where(full[:, None], momentum / np.where(full, mass, 1)[:, None], 0.0) + dt * acceleration
    acceleration[held], velocity[held] = 0.0, 0.0  # walls at rest
    v += dt * np.einsum("pk,pka->pa", N, acceleration[i])
    x += dt * np.einsum("pk,pka->pa", N, velocity[i])
    F = F + dt * np.einsum("pka,pkb->pab", velocity[i], dN) @ F
    if step in record["frames"]:
        sigma, szz = stress(F)
        rows = np.column_stack([table["id"], X, x, v, F.reshape(-1, 4), sigma[:, 0, 0], sigma[:, 1, 1], szz, sigma[:, 0, 1]])
        head = "id,X,Y,x,y,vx,vy,Fxx,Fxy,Fyx,Fyy,sxx,syy,szz,sxy"
        np.savetxt(out / f"result_{step}.csv", rows, fmt="%.17g", delimiter=",", header=head, comments="")

(out / "result.json").write_text(json.dumps({"v_lag": 0.5, "F_lag": 0, "b": "start", "version": "toy in NumPy"}))
