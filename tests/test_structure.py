"""The house as it is meant to be: imports point down, plug-ins hold what their names promise, help is light."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mpm_verify.solver.plugins import available, camel, load
from mpm_verify.solver.source_hash import TOP

FLOORS = ("solver", "mms", "cases", "reports", "verify")  # from the ground up
PLUGINS = {
    "mpm_verify.solver.basis": {"support", "order", "fill"},
    "mpm_verify.solver.material": {"start", "update", "wave_speed"},
    "mpm_verify.solver.rates": {"unrotate", "rotate", "order"},
    "mpm_verify.solver.negative_controls": {"unrotate", "rotate", "order"},
    "mpm_verify.solver.smoothing": {"of", "where", "stress", "strain", "check"},
    "mpm_verify.solver.transfers": {"flip_fraction", "start", "give", "filter", "take"},
    "mpm_verify.mms.solutions": {"displacement", "boundary", "lower", "upper", "duration"},
}
FILES = sorted(file for floor in FLOORS for file in (TOP / floor).rglob("*.py"))


def imported(source: str) -> Iterator[str]:
    """Modules a source imports, by statement (below TYPE_CHECKING too) or by import_module with a literal."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "relative imports hide the floor"
            yield node.module or ""
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Call) and "import_module" in ast.unparse(node.func):
            start = node.args[0].values[0] if isinstance(node.args[0], ast.JoinedStr) else node.args[0]
            if isinstance(start, ast.Constant):
                yield str(start.value)


def floor_of(module: str) -> str:
    """Package below mpm_verify that a module is in; of anything else its first name."""
    return module.removeprefix("mpm_verify.").partition(".")[0]


def upward(floor: str, source: str) -> list[str]:
    """Imports of floors above, and of the tests."""
    above = {*FLOORS[FLOORS.index(floor) + 1 :], "tests"}
    return [module for module in imported(source) if floor_of(module) in above]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(TOP).as_posix())
def test_imports_point_down(file: Path) -> None:
    wrong = upward(file.relative_to(TOP).parts[0], file.read_text())
    assert not wrong, f"{file.relative_to(TOP)} imports {', '.join(wrong)}: a floor above its own"


@pytest.mark.parametrize(
    "source",
    [
        "import mpm_verify.cases.harness.study",
        "from reports import render",
        "def f():\n    from mpm_verify.verify.main import main",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from mpm_verify.cases.harness.study import Run",
        "from importlib import import_module\nimport_module(f'mpm_verify.cases.{name}')",
    ],
)
def test_an_upward_import_is_seen(source: str) -> None:
    assert upward("mms", source)
    assert not upward("verify", source)


def test_every_floor_is_looked_at() -> None:
    folders = {file.relative_to(TOP).parts[0] for file in FILES}
    assert folders == set(FLOORS)
    packages = {path.parent.name for path in TOP.glob("*/__init__.py")}
    assert packages <= set(FLOORS), "a new package needs its floor here"


Graph = dict[str, set[str]]


def package() -> dict[str, str]:
    """Sources of all modules by their names."""
    names = (".".join(["mpm_verify", *file.relative_to(TOP).with_suffix("").parts]) for file in FILES)
    return {name.removesuffix(".__init__"): file.read_text() for name, file in zip(names, FILES, strict=True)}


def arrows(sources: dict[str, str]) -> Graph:
    """Which modules each one imports, for types alone and within functions too."""
    return {name: {other for other in imported(text) if other in sources} - {name} for name, text in sources.items()}


def room(module: str) -> str:
    """Floor and folder of a module, or floor and file where it lies in no folder."""
    return ".".join(module.split(".")[1:3])


def rooms(graph: Graph, floor: str) -> Graph:
    """Which rooms of a floor each of its rooms imports."""
    found: Graph = {}
    for one, others in graph.items():
        mine = found.setdefault(room(one), set()) if one.startswith(f"mpm_verify.{floor}.") else set()
        mine |= {room(other) for other in others if other.startswith(f"mpm_verify.{floor}.")} - {room(one)}
    return found


def circle(graph: Graph) -> list[str]:
    """A circle of imports, or nothing."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_import_goes_in_a_circle() -> None:
    graph = arrows(package())
    assert len(graph) > 150
    assert sum(map(len, graph.values())) > 600
    assert not circle(graph)


@pytest.mark.parametrize("floor", ["cases", "reports", "verify"])
def test_rooms_import_each_other_in_one_direction(floor: str) -> None:
    graph = rooms(arrows(package()), floor)
    assert len(graph) > 4
    assert not circle(graph)


def test_the_rooms_of_the_cases() -> None:
    """Judging is below the harness, own solvers above it, all are below the cases, and no other room is there.

    No case knows another.
    """
    graph = rooms(arrows(package()), "cases")
    assert {"cases.judging", "cases.harness", "cases.mms", "cases.column"} <= set(graph)
    assert {name for name in graph if not list((TOP / name.replace(".", "/")).glob("case.py"))} == {
        "cases.judging", "cases.harness", "cases.solvers",
    }  # fmt: skip
    rooms_below = {"cases.judging", "cases.harness", "cases.solvers"}
    below = {"cases.judging": set(), "cases.harness": {"cases.judging"}, "cases.solvers": {"cases.harness"}}
    assert {name: others - below.get(name, rooms_below) for name, others in graph.items()} == {
        name: set() for name in graph
    }


@pytest.mark.parametrize("back", ["if TYPE_CHECKING:\n    {}", "def f():\n    {}", "{}"])
def test_a_circle_is_seen(back: str) -> None:
    one, other = "mpm_verify.cases.mms.case", "mpm_verify.cases.harness.study"
    sources = {one: f"from {other} import Run", other: back.format("from mpm_verify.cases.mms import case")}
    assert set(circle(arrows(sources))) == {one, other}
    assert set(circle(rooms(arrows(sources), "cases"))) == {"cases.mms", "cases.harness"}
    sources[other] = ""
    assert not circle(arrows(sources))


NAMES = [(plugins, name) for plugins in PLUGINS for name in available(plugins)]


@pytest.mark.parametrize(("package", "name"), NAMES)
def test_a_plugin_holds_what_its_name_promises(package: str, name: str) -> None:
    """The CamelCase class, defined in that file, with what the contract asks for and a problem statement."""
    plugin: Any = load(package, name)
    assert plugin.__name__ == camel(name)
    assert plugin.__module__ == f"{package}.{name}"
    missing = [item for item in PLUGINS[package] if not hasattr(plugin, item)]
    assert not missing, f"{package}.{name} lacks {missing}"
    assert len(sys.modules[plugin.__module__].__doc__ or "") > 80
    plugin()  # every parameter has a default


@pytest.mark.parametrize("name", available("mpm_verify.solver.basis"))
def test_a_basis_has_the_one_signature(name: str) -> None:
    from mpm_verify.solver.weights import FILL

    basis: Any = load("mpm_verify.solver.basis", name)
    assert basis.fill.signatures == [FILL.args]
    assert basis.fill.nopython_signatures[0].return_type == FILL.return_type
    assert isinstance(basis.support, int)
    assert 0 < basis.order < 10
    assert basis.promises(crossing=False).order == basis.order
    assert basis.promises(crossing=True).order in (None, basis.order)


def one_signature(kernel: Any, signature: Any) -> None:
    assert kernel.signatures == [signature.args]
    assert kernel.nopython_signatures[0].return_type == signature.return_type


FRAMES = [
    (package, name)
    for package in ("mpm_verify.solver.rates", "mpm_verify.solver.negative_controls")
    for name in available(package)
]


@pytest.mark.parametrize(("package", "name"), FRAMES)
def test_a_rate_has_the_two_signatures(package: str, name: str) -> None:
    from mpm_verify.solver.objective import ROTATE, UNROTATE, Rate

    rate: Any = load(package, name)
    assert issubclass(rate, Rate)
    one_signature(rate.unrotate, UNROTATE)
    one_signature(rate.rotate, ROTATE)
    assert rate.order == 2.0 if package == "mpm_verify.solver.rates" else rate.order in (0.0, 1.0)


@pytest.mark.parametrize("name", available("mpm_verify.solver.material"))
def test_a_law_is_of_one_of_two_forms(name: str) -> None:
    """A function of F with its energy, or in rate form with a rate and one kernel of the one signature."""
    from mpm_verify.solver.material_model import Material
    from mpm_verify.solver.objective import RESPOND

    law: Any = load("mpm_verify.solver.material", name)
    assert issubclass(law, Material)
    assert law().name == name
    assert (law.respond is None) == (law.rate is None)
    assert law.respond is not None or law.energy is not None
    assert (law().friction_angle is None) == (law().cohesion is None)
    assert law.friction_angle.fget(law()) or not law.yields_in_plane
    assert law().wave_speed() > 0
    assert (law().wave_speed(1e3) != law().wave_speed()) == (law.moduli is not None)
    if law.respond is not None:
        one_signature(law.respond, RESPOND)
        assert law().initial(np.zeros((3, 4))).shape == (3, len(law.memory))
        assert law().rate in available("mpm_verify.solver.rates")  # no negative control by default


@pytest.mark.parametrize("name", available("mpm_verify.cases"))
def test_a_case_can_be_executed(name: str) -> None:
    from mpm_verify.cases.harness.contract import case_named

    assert callable(case_named(name).execute)


def test_names_of_plugins() -> None:
    assert camel("neo_hookean") == "NeoHookean"
    assert {"mpm", "cpdi"} <= set(available("mpm_verify.solver.basis"))
    assert not set(available("mpm_verify.solver.rates")) & set(available("mpm_verify.solver.negative_controls")), (
        "RateLaw looks for both"
    )
    assert not [name for package in PLUGINS for name in available(package) if name.startswith("_")]
    with pytest.raises(ValueError, match=r"no method 'fem'; choose from .*cpdi, .*mpm"):
        load("mpm_verify.solver.basis", "fem")


HEAVY = ("numba", "sympy", "numpy", "scipy", "pandas", "matplotlib", "llvmlite")
PROBE = f"""
import sys
from mpm_verify.verify.main import main
try:
    main()
except SystemExit as end:
    code = end.code
print("HEAVY", code, *sorted(set(sys.modules) & {set(HEAVY)!r}), file=sys.stderr)
"""


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["mms", "--help"],
        ["report", "--help"],
        ["list"],
        ["--version"],
        ["mms", "--nonsense"],
        ["export", "--help"],
        ["check-force", "--help"],
        ["schema", "--help"],
    ],
)
def test_help_is_light(words: list[str]) -> None:
    """No subcommand's help or list imports what computes."""
    command = [sys.executable, "-c", PROBE, *words]
    done = subprocess.run(command, capture_output=True, text=True, cwd=TOP, check=True, timeout=60)
    last = done.stderr.splitlines()[-1].split()
    assert last == ["HEAVY", "2" if "--nonsense" in words else "0"]
    if words[0] == "list":
        assert all(name in done.stdout for _, name in NAMES)
    if words == ["mms", "--help"]:
        assert all(name in done.stdout for name in available("mpm_verify.solver.basis"))


def test_the_probe_sees_what_is_imported() -> None:
    """The check above can fail."""
    probe = "import numpy\n" + PROBE
    done = subprocess.run(
        [sys.executable, "-c", probe, "--version"], capture_output=True, text=True, cwd=TOP, check=True
    )
    assert "numpy" in done.stderr.splitlines()[-1]
