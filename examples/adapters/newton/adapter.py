"""Adapter of the implicit MPM of NVIDIA Newton: python adapter.py CASE OUT [--v half|zero] [--b start|end]."""

import argparse
import json
import sys
from importlib.metadata import version
from pathlib import Path

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverImplicitMPM

words = argparse.ArgumentParser()
words.add_argument("case", type=Path)
words.add_argument("out", type=Path)
words.add_argument("--v", choices=("half", "zero"), default="zero", help="level of v that is started from: -dt/2 or 0")
words.add_argument("--b", choices=("start", "end"), default="end", help="time of a step's body force")
told = words.parse_args()

# ---- what the case says
sys.path.insert(0, str(told.case))
from body_force import body_force  # noqa: E402

case = json.loads((told.case / "case.json").read_text())
table = np.genfromtxt(told.case / "particles.csv", delimiter=",", names=True)
X, dt, dx, constants = np.stack([table["X"], table["Y"]], axis=1), case["dt"], case["dx"], case["material"]["constants"]
v = np.stack([table["vx_half"], table["vy_half"]] if told.v == "half" else [table["vx"], table["vy"]], axis=1)
F = np.stack([table["Fxx"], table["Fxy"], table["Fyx"], table["Fyy"]], axis=1)
assert (F == [1, 0, 0, 1]).all(), "start undeformed"
assert set(case["edges"].values()) == {"free"}, "no walls: take bump"
assert constants["nu"] == 0, "strain along z is free: take --material neo_hookean:nu=0"

# ---- one layer of particles in z, elastic without end
wp.config.log_level = wp.LOG_WARNING
wp.set_device("cpu")


def layer(values):
    """Vectors (P,3) of (P,2)."""
    return np.column_stack([values, np.zeros(len(values))])


builder = newton.ModelBuilder()
SolverImplicitMPM.register_custom_attributes(builder)
m = table["m"] * dx
radius = 0.5 * np.cbrt(table["V0"] * dx)
shift = dx / 2 - np.array(case["grid_lower"])  # nodes are at odd multiples of dx/2
builder.add_particles(layer(X + shift).tolist(), layer(v).tolist(), m.tolist(), radius.tolist())
model = builder.finalize()
model.set_gravity((0.0, 0.0, 0.0))
for name, value in {"young_modulus": constants["E"], "poisson_ratio": 0.0, "friction": 0.0, "yield_stress": 1e15,
                    "yield_pressure": 1e15, "tensile_yield_ratio": 1.0}.items():  # fmt: skip
    getattr(model.mpm, name).fill_(value)
settings = SolverImplicitMPM.Config(voxel_size=dx, air_drag=0.0, tolerance=1e-7, max_iterations=250, solver="gs")
solver, state = SolverImplicitMPM(model, settings), model.state()
for step in range(1, case["steps"] + 1):
    b = body_force(X, (step - (told.b == "start")) * dt)
    state.particle_f.assign(layer(m[:, None] * b).astype(np.float32))
    solver.step(state, state, None, None, dt)
    if step in case["frames"]:
        q, v, F = (a.numpy() for a in (state.particle_q, state.particle_qd, state.mpm.particle_elastic_strain))
        x = (q[:, :2] - shift).astype(np.float32)  # its digits are those of single precision
        np.savez(told.out / f"result_{step}.npz", id=table["id"], x=x, v=v, F=F)
levels = {"v_lag": 0.5 if told.v == "half" else 0.0, "b": told.b,
          "version": f"newton {version('newton')}"}  # fmt: skip
(told.out / "result.json").write_text(json.dumps(levels))
