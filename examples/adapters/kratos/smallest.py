"""Smallest experiments on the explicit stress update of KratosMPMApplication: python smallest.py.

One material point in two square cells of side 1; nodal velocities are set by hand, and Kratos updates the stress of the
point from them. Neo-Hookean, E = 1e4, nu = 0.3. What is printed is one JSON document.
"""

import json
from importlib.metadata import version

import KratosMultiphysics as Kratos
import numpy as np
from KratosMultiphysics import MPMApplication as Mpm
from KratosMultiphysics.MPMApplication.python_solvers_wrapper_mpm import CreateSolver

LAM, MU, DT = 5769.230769230769, 3846.153846153846, 1e-3
Kratos.Logger.GetDefaultOutput().SetSeverity(Kratos.Logger.Severity.WARNING)


class Point:
    """One material point in the middle of the left of two cells, [0,1] x [0,1] and [1,2] x [0,1]."""

    def __init__(self):
        self.model = Kratos.Model()
        read = {"input_type": "use_input_model_part"}
        settings = {"solver_type": "dynamic", "time_integration_method": "explicit", "domain_size": 2,
                    "scheme_type": "forward_euler", "stress_update": "usl", "analysis_type": "linear",
                    "time_stepping": {"time_step": DT}, "grid_model_import_settings": read,
                    "model_import_settings": read}  # fmt: skip
        given = {"solver_settings": settings, "problem_data": {"parallel_type": "OpenMP"}}
        solver = CreateSolver(self.model, Kratos.Parameters(json.dumps(given)))
        solver.AddVariables()
        self.grid, body = self.model["Background_Grid"], self.model["Initial_MPM_Material"].CreateSubModelPart("body")
        material = self.model["Initial_MPM_Material"].CreateNewProperties(1)
        for name, value in (("YOUNG_MODULUS", 1e4), ("POISSON_RATIO", 0.3), ("DENSITY", 1.0), ("THICKNESS", 1.0)):
            material.SetValue(getattr(Kratos, name), value)
        material.SetValue(Mpm.MATERIAL_POINTS_PER_ELEMENT, 1)
        material.SetValue(Kratos.CONSTITUTIVE_LAW, Mpm.HyperElasticNeoHookeanPlaneStrain2DLaw())
        corners = ((0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1))
        for k, (x, y) in enumerate(corners):
            self.grid.CreateNewNode(k + 1, x, y, 0.0)
        for k, (x, y) in enumerate(corners[:4]):
            body.CreateNewNode(k + 11, x, y, 0.0)
        for k, nodes in enumerate(([1, 2, 3, 4], [2, 5, 6, 3])):
            self.grid.CreateNewElement("Element2D4N", k + 1, nodes, self.grid.CreateNewProperties(k + 2))
        body.CreateNewElement("MPMUpdatedLagrangian2D4N", 11, [11, 12, 13, 14], material)
        for prepare in (solver.ImportModelPart, solver.PrepareModelPart, solver.AddDofs, solver.Initialize):
            prepare()
        self.grid.ProcessInfo[Kratos.DELTA_TIME] = DT
        (self.element,) = self.model["MPM_Material"].Elements

    def put(self, x, tolerance):
        """Move the point to x, where Kratos looks for its cell again."""
        self.element.SetValuesOnIntegrationPoints(Mpm.MP_COORD, [Kratos.Array3([*x, 0.0])], self.grid.ProcessInfo)
        Mpm.SearchElement(self.grid, self.model["MPM_Material"], 1000, tolerance)

    def step(self, L):
        """Velocities L x at the nodes, and a stress update."""
        for node in self.grid.Nodes:
            node.SetSolutionStepValue(Kratos.VELOCITY, [*(L @ [node.X, node.Y]), 0.0])
        self.element.CalculateOnIntegrationPoints(Mpm.CALCULATE_EXPLICIT_MP_STRESS, self.grid.ProcessInfo)

    def stress(self):
        """Cauchy stress xx, yy, xy."""
        return [*self.element.CalculateOnIntegrationPoints(Mpm.MP_CAUCHY_STRESS_VECTOR, self.grid.ProcessInfo)[0]]


def neo_hookean(F):
    """Cauchy stress xx, yy, xy of F (2 x 2)."""
    J = np.linalg.det(F)
    sigma = (MU * (F @ F.T - np.eye(2)) + LAM * np.log(J) * np.eye(2)) / J
    return [sigma[0, 0], sigma[1, 1], sigma[0, 1]]


def stretched_then_turned():
    """Stretch of 10 % along x in 100 steps, then a quarter of a turn in 1000 steps, which turns the stress."""
    point, F, W = Point(), np.eye(2), np.array([[0.0, -1.0], [1.0, 0.0]]) * np.pi / 2
    stretch = np.diag([1.0, 0.0])
    for _ in range(100):
        point.step(stretch)
        F = (np.eye(2) + DT * stretch) @ F
    found = {"stretched": point.stress(), "stretched_expected": neo_hookean(F)}
    for _ in range(1000):
        point.step(W)
    turned = np.array([[0.0, -1.0], [1.0, 0.0]]) @ F
    return found | {"turned": point.stress(), "turned_expected": neo_hookean(turned)}


def beside_a_face():
    """One step of a stretch with L = diag(1, 0) at a point that has passed the face x = 1 by a distance."""
    rows = []
    for tolerance in (1e-5, 1e-9):
        for beyond in (-1e-6, 1e-6, 1e-4):
            point = Point()
            point.put((0.9, 0.5), tolerance)
            point.put((1.0 + beyond, 0.5), tolerance)
            point.step(np.diag([1.0, 0.0]))
            cell = "left" if {node.Id for node in point.element.GetGeometry()} == {1, 2, 3, 4} else "right"
            rows.append({"tolerance": tolerance, "beyond": beyond, "cell": cell, "stress": point.stress()})
    return {"rows": rows, "expected": neo_hookean(np.diag([1.0 + DT, 1.0]))}


if __name__ == "__main__":
    found = {"version": f"KratosMPMApplication {version('KratosMPMApplication')}",
             "stretched_then_turned": stretched_then_turned(), "beside_a_face": beside_a_face()}  # fmt: skip
    print(json.dumps(found, indent=1))
