"""Build sparkl2d for the adapter: python build.py [f32|f64|published ...]; usual is f32 and f64. Needs cargo.

The crate is fetched by cargo, and a copy of it in the folder `built` is changed; each text that is replaced has to be
there as often as is said. f32 has one line mended, without which nothing moves; f64 is turned to double precision too;
`published` is unchanged, for smallest.py.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BUILT = HERE / "built"
MENDED = [("sparkl2d", "src/geometry/sp_grid.rs", "map_anon(2 ^ 30)", "map_anon(1 << 30)", 1)]
# A node of the grid may have 64 bytes: in double precision, two numbers of the damage model stay single.
DOUBLE = [
    ("sparkl2d", "Cargo.toml", "[dependencies.parry2d]", "[dependencies.parry2d-f64]", 1),
    ("sparkl2d", "Cargo.toml", "[dependencies.rapier2d]", "[dependencies.rapier2d-f64]", 1),
    ("sparkl2d", "Cargo.toml", '"parry2d/serde', '"parry2d-f64/serde', 1),
    ("sparkl2d", "Cargo.toml", '"rapier2d/serde', '"rapier2d-f64/serde', 1),
    ("sparkl2d", "Cargo.toml", '"f32"', '"f64"', 2),
    ("sparkl2d", "Cargo.toml", "f32 = []", "f64 = []", 1),
    ("sparkl2d-core", "Cargo.toml", '"f32"', '"f64"', 2),
    ("sparkl2d-core", "Cargo.toml", "f32 = []", "f64 = []", 1),
    ("sparkl2d", "src/dynamics/grid_node.rs", "psi_momentum: Real", "psi_momentum: f32", 1),
    ("sparkl2d", "src/dynamics/grid_node.rs", "psi_mass: Real", "psi_mass: f32", 1),
    ("sparkl2d", "src/dynamics/solver/grid_to_particle.rs", "cell.psi_momentum", "cell.psi_momentum as Real", 1),
    ("sparkl2d", "src/dynamics/solver/grid_to_particle.rs", "(cell.psi_mass)", "(cell.psi_mass as Real)", 1),
    ("sparkl2d", "src/dynamics/solver/particle_to_grid.rs", "+= weight * psi_pos_momentum;",
     "+= (weight * psi_pos_momentum) as f32;", 1),
    ("sparkl2d", "src/dynamics/solver/particle_to_grid.rs", "+= weight * psi_mass;",
     "+= (weight * psi_mass) as f32;", 1),
]  # fmt: skip
CHANGES = {"published": [], "f32": MENDED, "f64": [*MENDED, *DOUBLE]}


def library(kind):
    """Path of the library of a kind."""
    return BUILT / f"sparkl_{kind}.so"


def fetched():
    """Folders of the crates as cargo has fetched them, by name."""
    words = ["cargo", "metadata", "--format-version", "1", "--manifest-path", str(HERE / "Cargo.toml")]
    told = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    (HERE / "Cargo.lock").unlink(missing_ok=True)
    paths = {one["name"]: Path(one["manifest_path"]).parent for one in told["packages"]}
    return {name: paths[name] for name in ("sparkl2d", "sparkl2d-core")}


def build(kind):
    """Copy the crates, change them, and build the library of a kind."""
    folder = BUILT / kind
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(HERE / "src", folder / "src")
    manifest = (HERE / "Cargo.toml").read_text(encoding="utf-8")
    for name, path in fetched().items():
        shutil.copytree(path, folder / name)
        manifest += f'\n[patch.crates-io.{name}]\npath = "{name}"\n'
    (folder / "Cargo.toml").write_text(manifest, encoding="utf-8")
    for name, file, old, new, times in CHANGES[kind]:
        path = folder / name / file
        text = path.read_text(encoding="utf-8")
        assert text.count(old) == times, f"{name}/{file} has not {times} times {old!r}: another version?"
        path.write_text(text.replace(old, new), encoding="utf-8")
    target = BUILT / f"target_{kind}"
    words = ["cargo", "build", "--release", "--quiet", "--target-dir", str(target)]
    subprocess.run(words, cwd=folder, check=True)
    shutil.copy(target / "release" / "libsparkl_adapter.so", library(kind))


if __name__ == "__main__":
    for kind in sys.argv[1:] or ("f32", "f64"):
        build(kind)
        print(library(kind))
