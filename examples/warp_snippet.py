"""Exported functions in NVIDIA Warp: python examples/warp_snippet.py CASE [--precision single] [--ptx FOLDER] < rows.

A row is X, Y, t and a current position x, y. Printed are the force, the force at x, u, v, F and sigma, by a kernel on
the CPU. With --ptx the kernel is compiled for CUDA too, by the compiler that Warp brings, without a graphics card.
"""

import argparse
import importlib.util
import json
import sys
import tempfile
from pathlib import Path

import numpy as np
import warp as wp

# Warp has macros of the names float and int, so that MMS_REAL is a name of its own for the type.
FUNCTIONS = ("body_force", "body_force_at", "displacement", "velocity", "deformation", "stress")
SIZES = {2: (2, 2, 2, 2, 4, 4), 3: (3, 3, 3, 3, 9, 6)}
SNIPPET = """
#define MMS_INSIDE
#define MMS_REAL mms_real
typedef {real} mms_real;
struct mms {{
{source}
}};
#undef MMS_BODY_FORCE_CUH
{real} position[{d}], current[{d}];
for (int k = 0; k < {d}; ++k) {{
    position[k] = rows[{width} * row + k];
    current[k] = rows[{width} * row + {d} + 1 + k];
}}
const {real} t = rows[{width} * row + {d}];
{calls}
"""
MODULE = """
import warp as wp

SNIPPET = {snippet!r}


@wp.func_native(SNIPPET)
def values(rows: wp.array(dtype=wp.{kind}), found: wp.array(dtype=wp.{kind}), row: int): ...


@wp.kernel
def evaluate(rows: wp.array(dtype=wp.{kind}), found: wp.array(dtype=wp.{kind})):
    values(rows, found, wp.tid())
"""
words = argparse.ArgumentParser()
words.add_argument("case", type=Path)
words.add_argument("--precision", choices=("double", "single"), default="double")
words.add_argument("--ptx", type=Path, help="folder for what the compiler for CUDA makes")
told = words.parse_args()

# ---- the kernel: Warp reads the source of its kernels from a file
wp.config.log_level = wp.LOG_WARNING
wp.set_device("cpu")
d = json.loads((told.case / "case.json").read_text())["dimension"]
real, kind = {"double": ("double", "float64"), "single": ("float", "float32")}[told.precision]
count, starts = sum(SIZES[d]), np.cumsum((0, *SIZES[d]))
calls = "\n".join(
    f"mms::mms_{name}({'current' if name == 'body_force_at' else 'position'}, t, &found[{count} * row + {start}]);"
    for name, start in zip(FUNCTIONS, starts, strict=False)
)
source = (told.case / "body_force.cuh").read_text(encoding="utf-8")
snippet = SNIPPET.format(real=real, source=source, d=d, width=2 * d + 1, calls=calls)
folder = tempfile.TemporaryDirectory()
file = Path(folder.name) / "mms_kernels.py"
file.write_text(MODULE.format(snippet=snippet, kind=kind), encoding="utf-8")
spec = importlib.util.spec_from_file_location("mms_kernels", file)
kernels = importlib.util.module_from_spec(spec)
sys.modules["mms_kernels"] = kernels
spec.loader.exec_module(kernels)

# ---- its values
given = np.loadtxt(sys.stdin, ndmin=2)
rows = wp.array(given.ravel(), dtype=getattr(wp, kind))
found = wp.zeros(count * len(given), dtype=getattr(wp, kind))
wp.launch(kernels.evaluate, dim=len(given), inputs=[rows, found])
for row in found.numpy().reshape(len(given), -1).tolist():
    print(*map(repr, row))
if told.ptx:
    told.ptx.mkdir(exist_ok=True)
    wp.compile_aot_module(kernels, arch=75, module_dir=str(told.ptx), use_ptx=True)
folder.cleanup()
