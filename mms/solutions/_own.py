"""Solution of a user's own: a file with two functions, made into a class like those of the library.

    displacement(X, t)   u as a SymPy Matrix of two components; X = (X, Y), reference position and time as symbols
    domain()             {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100}: a rectangle, the time
                         that a study covers, and the reference speed C in dt = courant dx / C

`domain` may also name a "material" (neo_hookean if not), a "boundary": fixed, roller, free, pulled, prescribed, or four
of them for left, right, bottom, top (without it the boundary is found, see mms/edges.py), and the "order" that is
expected of u.
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

from mpm_verify.mms.discretisation import boundary_kinds
from mpm_verify.solver.layout import CENTRED, Layout, Offset, rectangle
from mpm_verify.solver.own_file import derived as file_derived
from mpm_verify.solver.own_file import guarded, module_of, shortened
from mpm_verify.solver.plugins import SOLUTIONS, own_class, parameters_of
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    import sympy as sp

ARGUMENTS = {"displacement": ["X", "t"], "domain": []}
NEEDED, OPTIONAL = {"lower", "upper", "duration", "speed"}, {"material", "boundary", "order"}
KINDS = ("fixed", "roller", "free", "pulled", "prescribed")
HELD = ("fixed", "roller")  # at a wall that does not move
HUGE = 1e30  # a larger number of domain() overflows on the way
NOT_NUMBERS = (str, bytes, bool, np.bool_, complex, np.complexfloating, np.ndarray)  # though float() takes some of them
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
        """Displacement u (2,) of the reference position X and the time t, expressions in X, Y and t."""
        import sympy as sp

        value = self.call("displacement", tuple(X), t)
        u = list(value) if isinstance(value, sp.MatrixBase | list | tuple) else None
        kinds = [isinstance(e, sp.Expr | int | float) and not isinstance(e, bool) for e in u or ()]
        if u is None or len(u) != 2 or not all(kinds):
            raise ValueError(f"{self.path}: displacement must return sp.Matrix([u_x, u_y]), not {shortened(value)}")
        u = [sp.sympify(e) for e in u]
        unknown = set().union(*(e.free_symbols for e in u)) - {*X, t}
        if unknown:
            names = ", ".join(sorted(map(str, unknown)))
            raise ValueError(f"{self.path}: displacement has the unknown symbols {names}; use the X and t it is given")
        return sp.Matrix(u)

    @cached_property
    def domain(self) -> dict[str, Any]:
        """Dictionary that domain() returns, checked."""
        domain = self.call("domain")
        words = (
            "it must return a dictionary with lower, upper, duration and speed, and perhaps material, boundary, order"
        )
        if not isinstance(domain, dict) or not NEEDED <= set(domain) <= NEEDED | OPTIONAL:
            raise ValueError(f"{self.path}: domain returns {shortened(domain)}; {words}")
        box = {name: self.corner(name, domain[name]) for name in ("lower", "upper")}
        if not (box["upper"] > box["lower"]).all():
            raise ValueError(f"{self.path}: domain has upper = {domain['upper']}, not above lower = {domain['lower']}")
        sizes = {n: self.number(n, domain[n]) for n in ("duration", "speed", "order") if n in domain}
        for name, value in sizes.items():
            if value <= 0:
                raise ValueError(f"{self.path}: domain has {name} = {value:g}, which must be above zero")
        material = domain.get("material", "neo_hookean")
        if not isinstance(material, str) or not material:
            raise ValueError(
                f"{self.path}: domain has material = {shortened(material)}; write a name with its parameters, such as "
                "'neo_hookean:E=1e4,nu=0.3'"
            )
        return {**domain, **box, **sizes, "material": material}

    def named(self) -> tuple[str, ...] | None:
        """Boundary that domain() names, one a side; None where it names none."""
        named = self.domain.get("boundary")
        if named is None:
            return None
        sides = tuple(named) if isinstance(named, tuple | list) else (named,) * 4
        if len(sides) != 4 or not all(isinstance(kind, str) and kind in KINDS for kind in sides):
            choices = ", ".join(KINDS)
            raise ValueError(
                f"{self.path}: domain has boundary = {shortened(named)}; write one of {choices}, or four of them for "
                "left, right, bottom, top"
            )
        return sides

    def corner(self, name: str, value: Any) -> Floats:
        """Corner (2,) of domain()."""
        several = isinstance(value, tuple | list) or (isinstance(value, np.ndarray) and value.ndim > 0)
        if not several or len(value) != 2:
            raise ValueError(f"{self.path}: domain has {name} = {shortened(value)}; write two numbers")
        return np.array([self.number(name, one) for one in value])

    def number(self, name: str, value: Any) -> float:
        """Finite number of domain(); a word that looks like one is not taken."""
        try:
            number = np.nan if isinstance(value, NOT_NUMBERS) else float(value)
        except (TypeError, ValueError, OverflowError):
            number = np.nan
        if not abs(number) < HUGE:
            raise ValueError(f"{self.path}: domain has {name} = {shortened(repr(value))}, which is not a finite number")
        return number

    lower = property(lambda self: self.domain["lower"])
    upper = property(lambda self: self.domain["upper"])
    duration = property(lambda self: self.domain["duration"])
    C = property(lambda self: self.domain["speed"])
    material = property(lambda self: self.domain["material"])
    order = property(lambda self: self.domain.get("order"))
    edges = cached_property(edges)

    @property
    def boundary(self) -> str | tuple[str, ...]:
        """Kind that all four sides have, otherwise those of left, right, bottom, top.

        Raises ValueError where an edge misses a wall by what a rounded constant makes.
        """
        if "" in self.sides:
            raise ValueError(f"{self.path}: {self.edges.wrong(self.sides)}")
        return self.sides[0] if len(set(self.sides)) == 1 else self.sides

    @property
    def sides(self) -> tuple[str, ...]:
        """Kinds of left, right, bottom, top: as domain() names them or as they are found."""
        return self.named() or self.edges.kinds

    @property
    def margin(self) -> Any:
        """Room beyond the rectangle, none where a wall stands: a number, or (2,2) for lower and upper corner."""
        moves = np.array([kind not in HELD for kind in self.sides]).reshape(2, 2).T
        if not moves.any():
            return 0.0
        room = (1 + ROOM) * self.edges.reach
        return room if moves.all() else room * moves

    def layout(self, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
        """Layout of square domains, `ppc` in a cell of side dx."""
        return rectangle(self.lower, self.upper, dx, ppc, offset)

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
    """Kinds of left, right, bottom, top of a solution of either form."""
    if isinstance(solution, Own):
        return solution.sides
    return boundary_kinds(solution)


def derived(solution: Any) -> str:
    """Text of what a user's solution returns: u in X, Y and t, and all numbers and words that a run takes from it.

    The file of a class counts too: it may compute what it likes.
    """
    import sympy as sp

    u = solution.displacement(sp.symbols("X Y", real=True), sp.Symbol("t", real=True))
    names = ("lower", "upper", "duration", "C", "material")
    values = [np.asarray(getattr(solution, name)).tolist() for name in names]
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
