"""The plain C++ of plain.cpp, compiled for this processor and called on a model's own arrays."""

import shutil
import subprocess
from collections.abc import Callable
from ctypes import CDLL, Structure, byref, c_double, c_longlong, c_void_p
from pathlib import Path

from mpm_verify.solver.boundary import MASS_CUTOFF
from mpm_verify.solver.step import Model

COMPILER = shutil.which("g++") or shutil.which("clang++")
FLAGS = ("-O3", "-march=native", "-std=c++17", "-shared", "-fPIC")
ARRAYS = ("x", "v", "F", "sigma", "m", "V0", "b", "half")
NODES = ("mass", "given", "taken", "held")


class Body(Structure):
    """The struct Body of plain.cpp."""

    _fields_ = [
        *((name, c_longlong) for name in ("count", "nodes", "ny")),
        *((name, c_void_p) for name in ARRAYS),
        *((name, c_double) for name in ("x0", "y0", "inv_dx")),
        *((name, c_void_p) for name in NODES),
        *((name, c_double) for name in ("dt", "cutoff", "lam", "mu")),
    ]


def built(folder: Path) -> CDLL:
    """The library, compiled into `folder`."""
    made = folder / "plain.so"
    source = Path(__file__).parent / "plain.cpp"
    subprocess.run([str(COMPILER), *FLAGS, "-o", str(made), str(source)], check=True)
    return CDLL(str(made))


def stepped(library: CDLL, model: Model) -> Callable[[], None]:
    """One step of the C++ of the model's method on its own arrays, which have to stay alive."""
    p, g, law = model.particles, model.grid, model.material
    body = Body(
        len(p), len(g.mass), g.ny, *(array.ctypes.data for array in (p.x, p.v, p.F, p.sigma, p.m, p.V0, p.b, p.domain)),
        *g.origin, 1.0 / g.dx,
        *(array.ctypes.data for array in (g.mass, g.momentum_force, g.velocity_acceleration, model.walls.held)),
        model.dt, float(MASS_CUTOFF * p.m.max()), law.lam, law.mu,
    )  # fmt: skip
    kernel = getattr(library, type(model.basis).__name__.lower())
    kernel.restype = None
    return lambda: kernel(byref(body))
