"""Studies of public codes: python examples/adapters/study.py [NAME ...] runs those of studies.toml, or some of them.

The adapters run with the interpreter that the environment variable ADAPTERS_PYTHON names, else with this one. What is
kept of a study is small: its errors over 16 frames with their round-off floors, also with half the time step on the
finest cells, and the errors of the solver here in the same frames. Verdicts are made of them, see verdicts.py.
"""

import json
import os
import shlex
import subprocess
import sys
import tempfile
import tomllib
from math import sqrt
from pathlib import Path

import numpy as np

from mpm_verify.cases.mms.exact import manufactured
from mpm_verify.cases.mms.execute import setup
from mpm_verify.cases.mms.run import Run
from mpm_verify.mms.discretisation import output_steps
from mpm_verify.solver.model import Model, Observer
from mpm_verify.solver.step import advance

HERE = Path(__file__).resolve().parent
TOP, RESULTS = HERE.parent.parent, HERE / "measured"
FRAMES, COURANT = 16, 0.4
COMPARED = {"kratos_compared": ("kratos_usl_large", 8)}  # studies that are held against the solver here on one grid


def studies():
    """Studies by their names."""
    return {one["name"]: one for one in tomllib.loads((HERE / "studies.toml").read_text(encoding="utf-8"))["study"]}


def solver_of(study, python="python"):
    """Command of the program of a study."""
    script = f"examples/adapters/{study['code']}/{study.get('script', 'adapter.py')}"
    return f"{python} {script} {{case}} {{out}} {study['arguments']}".strip()


def comparison(name, python="python"):
    """Command that holds the answer of a study, on one grid, against the solver here; a list of words."""
    study, cells = studies()[COMPARED[name][0]], str(COMPARED[name][1])
    return [
        "verify",
        "compare",
        "--solver",
        solver_of(study, python),
        "--solution",
        study["solution"],
        "--cells",
        cells,
    ]


def command(study, python="python"):
    """Command of a study, a list of words."""
    solver = solver_of(study, python)
    material = ["--material", study["material"]] if "material" in study else []
    cells = ["--cells", ",".join(map(str, study["cells"])), "--ppc", "4"]
    return ["verify", "mms", "--solver", solver, "--solution", study["solution"], *material, *cells, *study["expect"]]


def answered(words, out):
    """Stored results of a command, in a folder."""
    told([*words, "--jobs", "1", "--out", str(out)])
    return [json.loads(file.read_text(encoding="utf-8")) for file in sorted((out / "runs").glob("*.json"))]


def told(words):
    """Document of a command."""
    full = [sys.executable, "-m", "mpm_verify", *words[1:], "--json", "--no-page"]
    path = os.pathsep.join(filter(None, [str(TOP), os.environ.get("PYTHONPATH", "")]))
    done = subprocess.run(full, cwd=TOP, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": path})
    if done.returncode not in (0, 1, 3):
        raise SystemExit(done.stdout[-2000:] + done.stderr[-2000:])
    return json.loads(done.stdout)


def compared(name, python):
    """What a comparison says, as it is kept: in words, and the frame, step and particle at which quantities part."""
    document = told(comparison(name, python))
    parted = [{key: one[key] for key in ("quantity", "frame", "step", "particle")} for one in document["partings"]]
    return {"outcome": document["outcome"], "sentences": [document["sentence"], *document["more"]], "partings": parted}


def run(study, python):
    """Result of a study, as it is kept."""
    words = command(study, python)
    usual = float(dict(zip(words[2::2], words[3::2], strict=True)).get("--courant", COURANT))
    with tempfile.TemporaryDirectory() as folder:
        stored = answered(words, Path(folder))
    (version,) = {one["told"] for one in stored if one.get("told")}
    levels = sorted((one for one in stored if one["errors"]), key=lambda one: one["run"]["cells"])
    rows = [row(one) for one in levels if one["run"]["courant"] == usual]
    half = next((row(one) for one in levels if one["run"]["courant"] != usual), None)
    found = {"version": version, "runs": rows, "half": half}
    if "reference" in study:
        found["reference"] = [reference(study, row["cells"]) for row in rows]
    return found


def row(one):
    """Level of a stored result: cells, errors in rms, and their round-off floors."""
    errors = {name: kept(norms["rms"]) for name, norms in one["errors"].items()}
    return {"cells": one["run"]["cells"], **errors, "floor": {name: kept(one["floor"][name]) for name in errors}}


def kept(error):
    """Error with the digits that are stored."""
    return float(f"{error:.6e}")


class Kept(Observer):
    """Observer that sums squared errors of u in some frames."""

    def __init__(self, exact, steps):
        self.exact, self.steps, self.squares = exact, steps, []

    def after_step(self, model: Model) -> None:
        """Take the error of this step, if it is one of the frames."""
        if model.steps in self.steps:
            x, X = (model.particles.in_initial_order(name) for name in ("x", "X"))
            self.squares.append(((x - self.exact.x(X, model.time)) ** 2).sum(axis=1).mean())


def reference(study, cells):
    """Error of u, rms over the frames, of the solver here: hats, FLIP, and the stress update that the study names."""
    here = Run(method="mpm", solution=study["solution"], material="neo_hookean", cells=cells, ppc=4, courant=COURANT,
               stress=study["reference"])  # fmt: skip
    model, load, steps = setup(here)
    watched = Kept(manufactured(here.solution, here.material), output_steps(steps, FRAMES))
    model.watch(watched)
    for _ in range(steps):
        advance(model, load)
    return kept(sqrt(np.mean(watched.squares)))


def main(names):
    """Run some studies, or all, and keep what they gave."""
    known = studies()
    python = shlex.quote(os.environ.get("ADAPTERS_PYTHON", sys.executable))
    for name in names or [*known, *COMPARED]:
        found = compared(name, python) if name in COMPARED else run(known[name], python)
        RESULTS.mkdir(exist_ok=True)
        (RESULTS / f"{name}.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        print(name, json.dumps(found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
