"""Smallest experiment on the implicit MPM of NVIDIA Newton: python smallest.py.

One elastic particle, one step without forces: in the middle of a cell, or on a face between two, with and without the
drag of air, which adds to the mass of every node. What is printed is one JSON document.
"""

import json
from importlib.metadata import version

import newton
import numpy as np
import warp as wp
from newton.solvers import SolverImplicitMPM

wp.config.log_level = wp.LOG_WARNING
wp.set_device("cpu")


def velocity(z, drag):
    """Velocity along x after a step of 0.001 of a particle that had 1, at (0, 0, z); cells have the side 1."""
    builder = newton.ModelBuilder()
    SolverImplicitMPM.register_custom_attributes(builder)
    builder.add_particles([(0.0, 0.0, z)], [(1.0, 0.0, 0.0)], [1.0], [0.5])
    model = builder.finalize()
    model.set_gravity((0.0, 0.0, 0.0))
    model.mpm.young_modulus.fill_(1e4)
    model.mpm.tensile_yield_ratio.fill_(1.0)
    solver, state = SolverImplicitMPM(model, SolverImplicitMPM.Config(voxel_size=1.0, air_drag=drag)), model.state()
    solver.step(state, state, None, None, 1e-3)
    found = float(state.particle_qd.numpy()[0, 0])
    return found if np.isfinite(found) else str(found)


if __name__ == "__main__":
    rows = [{"z": z, "air_drag": drag, "velocity": velocity(z, drag)} for z in (0.0, 0.5) for drag in (0.0, 1.0)]
    print(json.dumps({"version": f"newton {version('newton')}", "on_a_face": rows}, indent=1))
