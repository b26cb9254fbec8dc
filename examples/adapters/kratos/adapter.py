"""Adapter of KratosMPMApplication: python adapter.py CASE OUT [--scheme usl|musl|usf|central_difference|newmark]."""

import argparse
import json
import sys
from importlib.metadata import version
from pathlib import Path

import KratosMultiphysics as Kratos
import numpy as np
from KratosMultiphysics import MPMApplication as Mpm
from KratosMultiphysics.MPMApplication.python_solvers_wrapper_mpm import CreateSolver

SCHEMES = {name: {"scheme_type": "forward_euler", "stress_update": name} for name in ("usl", "musl", "usf")}
SCHEMES |= {"central_difference": {"scheme_type": "central_difference"}, "newmark": {"scheme_type": "newmark"}}
NEWTON = {"convergence_criterion": "residual_criterion", "residual_relative_tolerance": 1e-10,
          "residual_absolute_tolerance": 1e-18, "max_iteration": 30,
          "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"}}  # fmt: skip
words = argparse.ArgumentParser()
words.add_argument("case", type=Path)
words.add_argument("out", type=Path)
words.add_argument("--scheme", choices=SCHEMES, default="usl")
words.add_argument("--tolerance", type=float, default=1e-9, help="of the search for a point's cell; Kratos' usual 1e-5")
words.add_argument("--b", choices=("start", "end"), help="time of a step's body force; usual: what the scheme needs")
told = words.parse_args()
implicit, staggered = told.scheme == "newmark", told.scheme in ("usl", "musl", "usf")  # staggered: v from −dt/2
later = (told.b or ("start" if staggered else "end")) == "end"

# ---- what the case says
sys.path.insert(0, str(told.case))
from body_force import body_force  # noqa: E402

case = json.loads((told.case / "case.json").read_text())
table = np.genfromtxt(told.case / "particles.csv", delimiter=",", names=True)
v_now = ("vx_half", "vy_half") if staggered else ("vx", "vy")
X, x, v = (np.stack([table[name] for name in names], axis=1) for names in (("X", "Y"), ("x", "y"), v_now))
F = np.stack([table["Fxx"], table["Fxy"], table["Fyx"], table["Fyy"]], axis=1)
dt, dx, constants, sides = case["dt"], case["dx"], case["material"]["constants"], case["edges"]
lower, upper = np.array(case["grid_lower"]), np.array(case["grid_upper"])
assert case["body"] == "rectangle", "rectangles only"
assert case["material"]["name"].startswith("neo_hookean"), "neo-Hookean solids only"
assert (np.hstack([F, x]) == np.hstack([np.tile([1, 0, 0, 1], (len(X), 1)), X])).all(), "Kratos starts undeformed"
assert set(sides.values()) <= {"fixed", "roller", "free"}, "no prescribed edges"

# ---- solver, grid, and body: a mesh in the centre of whose squares Kratos puts its material points
Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)
Kratos.ParallelUtilities.SetNumThreads(1)
settings = {"solver_type": "dynamic", "domain_size": 2, "time_stepping": {"time_step": dt},
            "time_integration_method": "implicit" if implicit else "explicit",
            "analysis_type": "non_linear" if implicit else "linear",
            "element_search_settings": {"search_algorithm_type": "bin_based", "max_number_of_results": 1000,
                                        "searching_tolerance": told.tolerance, "remove_entities_not_found": True},
            "grid_model_import_settings": {"input_type": "use_input_model_part"},
            "model_import_settings": {"input_type": "use_input_model_part"}}  # fmt: skip
settings |= SCHEMES[told.scheme] | (NEWTON if implicit else {})
model = Kratos.Model()
given = {"solver_settings": settings, "problem_data": {"parallel_type": "OpenMP"}}
solver = CreateSolver(model, Kratos.Parameters(json.dumps(given)))
solver.AddVariables()


def squares(part, kind, low, high, side, properties, first):
    """Mesh of squares over a box, its nodes and elements numbered from `first`."""
    nx, ny = (round((b - a) / side) for a, b in zip(low, high, strict=True))
    for i, j in np.ndindex(nx + 1, ny + 1):
        part.CreateNewNode(first + i * (ny + 1) + j, low[0] + i * side, low[1] + j * side, 0.0)
    for e, (i, j) in enumerate(np.ndindex(nx, ny)):
        a = first + i * (ny + 1) + j
        part.CreateNewElement(kind, first + e, [a, a + ny + 1, a + ny + 2, a + 1], properties)


grid, body = model["Background_Grid"], model["Initial_MPM_Material"].CreateSubModelPart("body")
material = model["Initial_MPM_Material"].CreateNewProperties(1)
for name, value in (("YOUNG_MODULUS", "E"), ("POISSON_RATIO", "nu"), ("DENSITY", "rho0")):
    material.SetValue(getattr(Kratos, name), constants[value])
material.SetValue(Kratos.THICKNESS, 1.0)
material.SetValue(Mpm.MATERIAL_POINTS_PER_ELEMENT, 1)
material.SetValue(Kratos.CONSTITUTIVE_LAW, Mpm.HyperElasticNeoHookeanPlaneStrain2DLaw())
squares(grid, "Element2D4N", lower, upper, dx, grid.CreateNewProperties(0), 1)
squares(body, "MPMUpdatedLagrangian2D4N", case["lower"], case["upper"], dx / case["ppc"] ** 0.5, material, 10**6)
for prepare in (solver.ImportModelPart, solver.PrepareModelPart, solver.AddDofs):
    prepare()
for node in grid.Nodes:
    at = {"left": node.X - lower[0], "right": upper[0] - node.X, "bottom": node.Y - lower[1], "top": upper[1] - node.Y}
    for side in (side for side, distance in at.items() if distance < dx / 2 and sides[side] != "free"):
        if sides[side] == "fixed" or side in ("left", "right"):
            node.Fix(Kratos.DISPLACEMENT_X)
        if sides[side] == "fixed" or side in ("bottom", "top"):
            node.Fix(Kratos.DISPLACEMENT_Y)
solver.Initialize()
points, info = list(model["MPM_Material"].Elements), grid.ProcessInfo


def read(variable):
    """Values (P,2) of the material points."""
    return np.array([point.CalculateOnIntegrationPoints(variable, info)[0] for point in points])[:, :2]


def write(variable, values):
    """Give the material points values (P,2), in the order of the case."""
    for point, (a, b) in zip(points, values[order].tolist(), strict=True):
        point.SetValuesOnIntegrationPoints(variable, [Kratos.Array3([a, b, 0.0])], info)


# ---- material points are found by their positions; then the steps
at = read(Mpm.MP_COORD)
mine, theirs = (np.lexsort(np.rint(values / dx * 1e6).T) for values in (X, at))
assert len(at) == len(X), f"Kratos has {len(at)} points, the case {len(X)}"
assert np.abs(at[theirs] - X[mine]).max() < 1e-9 * dx, "Kratos has points at other positions"
order = np.empty(len(X), int)
order[theirs] = mine  # particle of the case that a material point is
write(Mpm.MP_VELOCITY, v)
write(Mpm.MP_ACCELERATION, body_force(X, 0.0))  # exact where the stress is 0
time = 0.0
for step in range(1, case["steps"] + 1):
    time = solver.AdvanceInTime(time)
    write(Mpm.MP_VOLUME_ACCELERATION, body_force(X, (step if later else step - 1) * dt))
    solver.Predict()
    solver.InitializeSolutionStep()
    assert solver.SolveSolutionStep() or not implicit, f"step {step} has not converged"
    solver.FinalizeSolutionStep()
    if step in case["frames"]:
        np.savez(told.out / f"result_{step}.npz", id=order, x=read(Mpm.MP_COORD), v=read(Mpm.MP_VELOCITY))
levels = {"v_lag": 0.5 if staggered else 0.0, "b": "end" if later else "start",
          "version": f"KratosMPMApplication {version('KratosMPMApplication')}"}  # fmt: skip
(told.out / "result.json").write_text(json.dumps(levels))
