"""Adapter of KratosMPMApplication: python adapter.py CASE OUT [--scheme usl|musl|usf|central_difference|newmark]"""

import argparse
import json
import sys
from importlib.metadata import version
from pathlib import Path

import KratosMultiphysics as Kratos
import numpy as np
from KratosMultiphysics import MPMApplication as Mpm
from KratosMultiphysics.MPMApplication.python_solvers_wrapper_mpm import CreateSolver

NEWTON = {"convergence_criterion": "residual_criterion", "residual_relative_tolerance": 1e-10,
          "residual_absolute_tolerance": 1e-18, "max_iteration": 30,
          "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"}}  # fmt: skip
SCHEMES = {
    "usl": {"scheme_type": "forward_euler", "stress_update": "usl"},
    "musl": {"scheme_type": "forward_euler", "stress_update": "musl"},
    "usf": {"scheme_type": "forward_euler", "stress_update": "usf"},
    "central_difference": {"scheme_type": "central_difference"},
    "newmark": {"scheme_type": "newmark", "newmark_beta": 0.25, **NEWTON},
}
words = argparse.ArgumentParser()
words.add_argument("case", type=Path)
words.add_argument("out", type=Path)
words.add_argument("--scheme", choices=SCHEMES, default="usl")
words.add_argument("--tolerance", type=float, default=1e-9, help="of the search for a point's cell; Kratos' usual 1e-5")
words.add_argument("--b", choices=("start", "end"), help="time of a step's body force; usual: what the scheme needs")
told = words.parse_args()
staggered = told.scheme in ("usl", "musl", "usf")  # v half a step before x
later = (told.b or ("start" if staggered else "end")) == "end"

# ---- what the case says
sys.path.insert(0, str(told.case))
from body_force import body_force  # noqa: E402

case = json.loads((told.case / "case.json").read_text())
table = np.genfromtxt(told.case / "particles.csv", delimiter=",", names=True)
X, x = (np.stack([table[a], table[b]], axis=1) for a, b in (("X", "Y"), ("x", "y")))
v = np.stack([table["vx_half" if staggered else "vx"], table["vy_half" if staggered else "vy"]], axis=1)
dt, dx, constants, sides = case["dt"], case["dx"], case["material"]["constants"], case["edges"]
lower, upper = np.array(case["grid_lower"]), np.array(case["grid_upper"])
F = np.stack([table["Fxx"], table["Fxy"], table["Fyx"], table["Fyy"]], axis=1)
assert case["body"] == "rectangle" and case["material"]["name"].startswith("neo_hookean"), "neo-Hookean rectangles only"
assert (F == [1, 0, 0, 1]).all() and (X == x).all(), "Kratos starts undeformed"
assert set(sides.values()) <= {"fixed", "roller", "free"}, "no prescribed edges"

# ---- solver, grid, and body: a mesh in the centre of whose squares Kratos puts its material points
Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
Kratos.ParallelUtilities.SetNumThreads(1)
settings = {"solver_type": "dynamic", "domain_size": 2, "time_stepping": {"time_step": dt},
            "time_integration_method": "explicit" if told.scheme != "newmark" else "implicit",
            "analysis_type": "linear" if told.scheme != "newmark" else "non_linear",
            "element_search_settings": {"search_algorithm_type": "bin_based", "max_number_of_results": 1000,
                                        "searching_tolerance": told.tolerance, "remove_entities_not_found": True},
            "grid_model_import_settings": {"input_type": "use_input_model_part"},
            "model_import_settings": {"input_type": "use_input_model_part"}, **SCHEMES[told.scheme]}  # fmt: skip
model = Kratos.Model()
given = {"solver_settings": settings, "problem_data": {"parallel_type": "OpenMP"}}
solver = CreateSolver(model, Kratos.Parameters(json.dumps(given)))
solver.AddVariables()


def squares(part, kind, low, high, side, properties, first):
    """Mesh of squares over a box, its nodes and elements numbered from `first`."""
    nx, ny = np.rint((np.array(high) - low) / side).astype(int)
    for i, j in np.ndindex(nx + 1, ny + 1):
        part.CreateNewNode(int(first + i * (ny + 1) + j), low[0] + i * side, low[1] + j * side, 0.0)
    for e, (i, j) in enumerate(np.ndindex(nx, ny)):
        a = int(first + i * (ny + 1) + j)
        part.CreateNewElement(kind, first + e, [a, a + int(ny) + 1, a + int(ny) + 2, a + 1], properties)


grid, body = model["Background_Grid"], model["Initial_MPM_Material"].CreateSubModelPart("body")
material = model["Initial_MPM_Material"].CreateNewProperties(1)
for name, value in (("YOUNG_MODULUS", "E"), ("POISSON_RATIO", "nu"), ("DENSITY", "rho0")):
    material.SetValue(getattr(Kratos, name), constants[value])
material.SetValue(Kratos.THICKNESS, 1.0)
material.SetValue(Mpm.MATERIAL_POINTS_PER_ELEMENT, 1)
material.SetValue(Kratos.CONSTITUTIVE_LAW, Mpm.HyperElasticNeoHookeanPlaneStrain2DLaw())
squares(grid, "Element2D4N", lower, upper, dx, grid.CreateNewProperties(0), 1)
squares(body, "MPMUpdatedLagrangian2D4N", case["lower"], case["upper"], dx / case["ppc"] ** 0.5, material, 10**6)
solver.ImportModelPart()
solver.PrepareModelPart()
solver.AddDofs()
for node in grid.Nodes:
    at = {"left": node.X - lower[0], "right": upper[0] - node.X, "bottom": node.Y - lower[1], "top": upper[1] - node.Y}
    for side in (side for side, distance in at.items() if distance < dx / 2 and sides[side] != "free"):
        if sides[side] == "fixed" or side in ("left", "right"):
            node.Fix(Kratos.DISPLACEMENT_X)
        if sides[side] == "fixed" or side in ("bottom", "top"):
            node.Fix(Kratos.DISPLACEMENT_Y)
solver.Initialize()

# ---- material points: they are found by their positions
points, info = list(model["MPM_Material"].Elements), grid.ProcessInfo


def read(variable):
    """Values (P,2) of the material points."""
    return np.array([point.CalculateOnIntegrationPoints(variable, info)[0] for point in points])[:, :2]


def write(variable, values):
    """Give the material points values (P,2)."""
    for point, (a, b) in zip(points, values.tolist(), strict=True):
        point.SetValuesOnIntegrationPoints(variable, [Kratos.Array3([a, b, 0.0])], info)


def key(values):
    """Order of positions (P,2)."""
    return np.lexsort(np.rint(values / dx * 1e6).T)


mine, theirs = key(X), key(read(Mpm.MP_COORD))
assert len(points) == len(X) and np.abs(read(Mpm.MP_COORD)[theirs] - X[mine]).max() < 1e-9 * dx, "other positions"
order = np.empty(len(X), int)
order[theirs] = mine  # particle of the case that a material point is
write(Mpm.MP_VELOCITY, v[order])
write(Mpm.MP_ACCELERATION, body_force(X, dt * 0)[order])  # exact where the stress is 0
time = 0.0
for step in range(1, case["steps"] + 1):
    time = solver.AdvanceInTime(time)
    write(Mpm.MP_VOLUME_ACCELERATION, body_force(X, (step if later else step - 1) * dt)[order])
    solver.Predict()
    solver.InitializeSolutionStep()
    assert solver.SolveSolutionStep() or staggered, f"step {step} has not converged"
    solver.FinalizeSolutionStep()
    if step in case["frames"]:
        np.savez(told.out / f"result_{step}.npz", id=order, x=read(Mpm.MP_COORD), v=read(Mpm.MP_VELOCITY))
levels = {"v_lag": 0.5 if staggered else 0.0, "version": f"KratosMPMApplication {version('KratosMPMApplication')}"}
(told.out / "result.json").write_text(json.dumps(levels))
