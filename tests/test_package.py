"""What is installed: one importable name, that works beside a user's own folders of the same names as ours."""

import json
import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
TAKEN = ("solver", "mms", "cases", "reports", "verify", "tests")
STRANGER = 'raise ImportError("this is the user\'s own {}, and nobody else may import it")\n'


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of a copy of the tracked files, so that nothing of a build stays in the checkout."""
    copy, out = tmp_path_factory.mktemp("copy"), tmp_path_factory.mktemp("wheel")
    files = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout.split(b"\0")
    tar = ["tar", "-cf", copy / "all.tar", "--null", "-T", "-"]
    subprocess.run(tar, cwd=ROOT, input=b"\0".join(filter(None, files)), check=True)
    subprocess.run(["tar", "-xf", "all.tar"], cwd=copy, check=True)
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation", "-w", str(out), "."]
    subprocess.run(build, cwd=copy, check=True, capture_output=True)
    return next(out.glob("*.whl"))


@pytest.fixture(scope="module")
def python(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of a fresh environment with the wheel; other packages are those of this one."""
    folder = tmp_path_factory.mktemp("fresh")
    venv.create(folder, with_pip=False, symlinks=True)
    site = next((folder / "lib").glob("python*/site-packages"))
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    (site / "others.pth").write_text(sysconfig.get_path("purelib") + "\n")  # a path alone: no editable install
    return folder / "bin" / "python"


def test_the_wheel_holds_files_under_one_name(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {name.partition("/")[0].partition("-")[0] for name in names} == {"mpm_verify"}
    for file in (
        "py.typed",
        "solver/step.py",
        "reports/templates/report.css",
        "mms/export/templates/drivers/driver.c.in",
        "cases/column/studies/figure5.toml",
        "cases/mms/digits/digits.csv",
        "reports/paper/claims.toml",
        "reports/paper/registered/quick.json",
    ):
        assert f"mpm_verify/{file}" in names


@pytest.mark.slow
@pytest.mark.parametrize("how", ["module", "script path"])
def test_it_works_beside_a_users_own_folders(python: Path, tmp_path: Path, how: str) -> None:
    for name in TAKEN:
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").write_text(STRANGER.format(name))
    words = ["mms", "--quick", "--json", "--page", "--out", "study"]
    start = ["-m", "mpm_verify"] if how == "module" else ["-c", "from mpm_verify.verify.main import run; run()"]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    run = subprocess.run([python, *start, *words], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    document = json.loads(run.stdout)
    assert document["outcome"] == "PASS"
    assert (tmp_path / document["report"]).exists()
    where = [python, "-c", "import mpm_verify; print(mpm_verify.__file__)"]
    found = subprocess.run(where, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True).stdout
    assert str(python.parent.parent) in found  # the wheel's, not this checkout's
