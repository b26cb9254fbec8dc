"""sparkl2d from Python: the functions of src/lib.rs, with NumPy arrays."""

import ctypes

import numpy as np
from build import library

NUMBER, POINTER = ctypes.c_double, ctypes.c_void_p


def loaded(kind):
    """Library of a kind."""
    path = library(kind)
    assert path.is_file(), f"{path} is not there: run python examples/adapters/sparkl/build.py {kind}"
    return ctypes.CDLL(str(path))


def stress(kind, model, E, nu, F):
    """Kirchhoff stress (2,2) of F in a model, corotated or neo_hookean."""
    F, found = np.ascontiguousarray(F, float), np.empty((2, 2))
    function = loaded(kind).sparkl_stress
    function.argtypes, function.restype = [ctypes.c_int, NUMBER, NUMBER, POINTER, POINTER], None
    function(model == "neo_hookean", E, nu, F.ctypes.data, found.ctypes.data)
    return found


class World:
    """Particles on a grid whose nodes are at whole multiples of dx."""

    def __init__(self, kind, dx, E, nu, x, v, gradient, F, m, V):
        self.library, self.count = loaded(kind), len(x)
        self.library.sparkl_new.restype, self.library.sparkl_step.restype = POINTER, NUMBER
        self.library.sparkl_new.argtypes = [ctypes.c_size_t, NUMBER, NUMBER, NUMBER, POINTER]
        self.library.sparkl_wall.argtypes = [POINTER, NUMBER, NUMBER, NUMBER, NUMBER]
        self.library.sparkl_step.argtypes = [POINTER, NUMBER, POINTER]
        self.library.sparkl_read.argtypes = [POINTER, POINTER]
        parts = [x, v, gradient.reshape(-1, 4), F.reshape(-1, 4), m[:, None], V[:, None]]
        floats = np.ascontiguousarray(np.hstack(parts), float)
        self.world = self.library.sparkl_new(self.count, dx, E, nu, floats.ctypes.data)

    def wall(self, low, high):
        """Let the nodes in a box stick."""
        centre, half = (np.add(low, high) / 2, np.subtract(high, low) / 2)
        self.library.sparkl_wall(self.world, *centre.tolist(), *half.tolist())

    def step(self, dt, b):
        """Take a step, with body forces (P,2); gives the step that the program took."""
        b = np.ascontiguousarray(b, float)
        return self.library.sparkl_step(self.world, dt, b.ctypes.data)

    def read(self):
        """Positions, velocities and F, and which particles the program gave up."""
        floats = np.empty((self.count, 9))
        self.library.sparkl_read(self.world, floats.ctypes.data)
        return floats[:, :2], floats[:, 2:4], floats[:, 4:8].reshape(-1, 2, 2), floats[:, 8] > 0
