"""Solution of a user's own: a file with two functions, made into a class like those of the library.

    displacement(X, t)   u as a SymPy Matrix of two components; X = (X, Y), reference position and time as symbols
    domain()             {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100}: a rectangle, the time
                         that a study covers, and the reference speed C in dt = courant dx / C

With one number in lower and upper it is a solution on a line, with three one in a box; with "axisymmetric": True the
coordinates are the radius and the axis. These are for other solvers: the reference solver is in plane strain.

`domain` may also name a "material" (neo_hookean if not), a "boundary": fixed, roller, free, pulled, prescribed, or one
for each of left, right, bottom, top, back, front (without it the boundary is found, see mms/edges.py), and the "order"
that is expected of u.
Arguments with a number as default, in either function, are parameters, whatever their names: path/to/own.py:A=0.02.
A file without these functions may hold a class instead, as those of the library. The file is executed as a program is:
run none that you do not trust.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, make_dataclass
from functools import cache, cached_property
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mpm_verify.mms.components import AXES
from mpm_verify.mms.discretisation import axisymmetric, boundary_kinds, dimension
from mpm_verify.mms.own_domain import HUGE, boundary, checked
from mpm_verify.mms.square import per_radian
from mpm_verify.solver.layout import CENTRED, Layout, Offset, rectangle
from mpm_verify.solver.own_file import derived as file_derived
from mpm_verify.solver.own_file import guarded, module_of, shortened
from mpm_verify.solver.plugins import SOLUTIONS, own_class, parameters_of

if TYPE_CHECKING:
    import sympy as sp

ARGUMENTS = {"displacement": ["X", "t"], "domain": []}
HELD = ("fixed", "roller")  # at a wall that does not move
ROOM = 0.25  # fraction of the largest displacement by which an edge may move further than the exact one


def edges(solution: Any) -> Any:
    """Edges of the body, of the solution's own material."""
    from mpm_verify.mms.edges import examine
    from mpm_verify.mms.manufacture import manufacture
    from mpm_verify.solver.plugins import MATERIALS, create

    material = create(MATERIALS, solution.material)
    return examine(solution, manufacture(solution, material, material.rho0), material)


class Own:
    """Solution from the two functions of a file; subclasses have its parameters as fields.

    Raises
    ------
    ValueError
        One line that begins with the file's name.
    """

    path: ClassVar[Path]
    functions: ClassVar[Mapping[str, Callable[..., Any]]]

    def __post_init__(self) -> None:
        self.named()

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """Displacement u (d,) of the reference position X and the time t, expressions in the coordinates and t."""
        import sympy as sp

        value, axes = self.call("displacement", tuple(X), t), AXES[: len(self.lower)]
        u = list(value) if isinstance(value, sp.MatrixBase | list | tuple) else None
        kinds = [isinstance(e, sp.Expr | int | float) and not isinstance(e, bool) for e in u or ()]
        if u is None or len(u) != len(axes) or not all(kinds):
            listed = ", ".join(f"u_{axis}" for axis in axes)
            raise ValueError(f"{self.path}: displacement must return sp.Matrix([{listed}]), not {shortened(value)}")
        u = [sp.sympify(e) for e in u]
        unknown = set().union(*(e.free_symbols for e in u)) - {*X, t}
        if unknown:
            names = ", ".join(sorted(map(str, unknown)))
            raise ValueError(f"{self.path}: displacement has the unknown symbols {names}; use the X and t it is given")
        return sp.Matrix(u)

    @cached_property
    def domain(self) -> dict[str, Any]:
        """Dictionary that domain() returns, checked."""
        return checked(self.path, self.call("domain"))

    def named(self) -> tuple[str, ...] | None:
        """Boundary that domain() names, one a side; None where it names none."""
        return boundary(self.path, self.domain)

    lower = property(lambda self: self.domain["lower"])
    upper = property(lambda self: self.domain["upper"])
    duration = property(lambda self: self.domain["duration"])
    C = property(lambda self: self.domain["speed"])
    material = property(lambda self: self.domain["material"])
    order = property(lambda self: self.domain.get("order"))
    axisymmetric = property(lambda self: bool(self.domain.get("axisymmetric")))
    edges = cached_property(edges)

    @property
    def boundary(self) -> str | tuple[str, ...]:
        """Kind that all sides have, otherwise those of left, right, bottom, top, back, front.

        Raises ValueError where an edge misses a wall by what a rounded constant makes.
        """
        if "" in self.sides:
            raise ValueError(f"{self.path}: {self.edges.wrong(self.sides)}")
        return self.sides[0] if len(set(self.sides)) == 1 else self.sides

    @property
    def sides(self) -> tuple[str, ...]:
        """Kinds of left, right, bottom, top, back, front: as domain() names them or as they are found."""
        return self.named() or self.edges.kinds

    @property
    def margin(self) -> Any:
        """Room beyond the body, none where a wall stands: a number, or (2,d) for lower and upper corner."""
        moves = np.array([kind not in HELD for kind in self.sides]).reshape(-1, 2).T
        if not moves.any():
            return 0.0
        room = (1 + ROOM) * self.edges.reach
        return room if moves.all() else room * moves

    def layout(self, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
        """Layout of square or cubic domains, `ppc` in a cell of side dx; around an axis with volumes per radian."""
        flat = rectangle(self.lower, self.upper, dx, ppc, offset)
        return per_radian(flat) if self.axisymmetric else flat

    def call(self, name: str, *arguments: Any) -> Any:
        """Value of a function of the file with those parameters that it has; asked for once a process."""
        return called(self, name, arguments)


@cache
def called(solution: Own, name: str, arguments: tuple[Any, ...]) -> Any:
    """Value of a function of a solution's file."""
    function = solution.functions[name]
    typed = parameters_of(type(solution))
    mine = {key: getattr(solution, typed[key].name) for key in parameters(solution.path, name, function)}
    return guarded(solution.path, lambda: function(*arguments, **mine))


def load(path: Path) -> type:
    """Class that a file makes. Raises ValueError with one line and the file's line."""
    return made(path, module_of(path))


@cache
def made(path: Path, module: ModuleType) -> type:
    """Class of a module: made of its two functions, or that which it holds. Raises ValueError."""
    functions = {name: vars(module).get(name) for name in ARGUMENTS}
    if not any(functions.values()) and any(isinstance(c, type) for c in vars(module).values()):
        return completed(path, own_class(SOLUTIONS, path))
    for name, function in functions.items():
        if not inspect.isfunction(function):
            raise ValueError(f"{path} has no function {name}({', '.join(ARGUMENTS[name])})")
    found: dict[str, float] = {}
    for name, function in functions.items():
        for key, value in parameters(path, name, function).items():
            if found.setdefault(key, value) != value:
                raise ValueError(f"{path}: {key} is {found[key]:g} in displacement and {value:g} in {name}")
    items = [(spared(key), float, field(default=v, metadata={"typed": key})) for key, v in sorted(found.items())]
    return make_dataclass("Own", items, bases=(Own,), frozen=True, namespace={"path": path, "functions": functions})


def completed(path: Path, plugin: Any) -> type:
    """Complete a class of a user's file with what checks ask for; its displacement is asked for once a process."""
    plugin.path = path
    plugin.order = getattr(plugin, "order", None)
    plugin.edges = cached_property(edges)
    plugin.edges.__set_name__(plugin, "edges")
    if plugin.__hash__:
        plugin.displacement = cache(plugin.displacement)
    chosen: type = plugin
    return chosen


def sides(solution: Any) -> tuple[str, ...]:
    """Kinds of the sides of a solution of either form."""
    if isinstance(solution, Own):
        return solution.sides
    return boundary_kinds(solution)


def symbols(solution: Any) -> tuple[tuple["sp.Symbol", ...], "sp.Symbol"]:
    """Coordinates and time that a displacement is asked for with, as mms/derive.py does."""
    import sympy as sp

    return tuple(sp.symbols([*AXES[: dimension(solution)].upper()], real=True)), sp.Symbol("t", real=True)


def derived(solution: Any) -> str:
    """Text of what a user's solution returns: u in coordinates and t, and all that a run takes from it.

    The file of a class counts too: it may compute what it likes.
    """
    import sympy as sp

    u = solution.displacement(*symbols(solution))
    names = ("lower", "upper", "duration", "C", "material")
    values = [np.asarray(getattr(solution, name)).tolist() for name in names] + ["around"] * axisymmetric(solution)
    if isinstance(solution, Own):
        return repr((sp.srepr(sp.Matrix(u)), values, solution.named()))
    return repr((sp.srepr(sp.Matrix(u)), values, solution.boundary, file_derived(solution.path)))


def parameters(path: Path, name: str, function: Any) -> dict[str, float]:
    """Arguments of a function beyond those of the contract, with their defaults, which must be numbers."""
    signature = list(inspect.signature(function).parameters.values())
    count = len(ARGUMENTS[name])
    fixed, rest = signature[:count], signature[count:]
    if len(fixed) < count or any(p.default is not p.empty for p in fixed):
        raise ValueError(f"{path}: {name} must take ({', '.join(ARGUMENTS[name])}) and parameters with defaults")
    for p in rest:
        if isinstance(p.default, bool) or not isinstance(p.default, int | float) or not abs(p.default) < HUGE:
            raise ValueError(
                f"{path}: {name} has the parameter {p.name}, which needs a number as default, such as {p.name}=1.0"
            )
    return {p.name: float(p.default) for p in rest}


def spared(parameter: str) -> str:
    """Name of the field of a parameter: its own, unless a solution has an attribute of that name, such as C."""
    taken = hasattr(Own, parameter) or parameter in Own.__annotations__
    return f"parameter_{parameter}" if taken else parameter
