"""A solution of a user's own: a file with two functions, made into a class like those of the library.

    displacement(X, t)   u as a SymPy Matrix of two components; X = (X, Y), reference place and time as symbols
    domain()             {"lower": (0, 0), "upper": (1, 1), "duration": 0.02, "speed": 100}: a rectangle, the time
                         that a study covers, and the reference speed C in dt = courant dx / C

`domain` may also name a "material" (neo_hookean if not), a "boundary": fixed, roller, free, or four of them for left,
right, bottom, top (without it the boundary is found, see mms/edges.py), and the "order" that is expected of u.
Arguments with a number as default, in either function, are parameters, whatever their names: path/to/own.py:A=0.02.
The file is executed as a program is: run none that you do not trust.
"""

import inspect
import traceback
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, make_dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from mpm_verify.solver.layout import CENTRED, Layout, Offset, rectangle
from mpm_verify.solver.plugins import parameters_of, source
from mpm_verify.solver.state import Floats

if TYPE_CHECKING:
    import sympy as sp

ARGUMENTS = {"displacement": ["X", "t"], "domain": []}
NEEDED, OPTIONAL = {"lower", "upper", "duration", "speed"}, {"material", "boundary", "order"}
KINDS = ("fixed", "roller", "free")
HUGE = 1e30  # a larger number of domain() overflows on the way
NO_NUMBERS = (str, bytes, bool, np.bool_, complex, np.complexfloating, np.ndarray)  # though float() takes some of them
ROOM = 0.25  # of the largest displacement: how much further than the exact one a free edge may move


class Own:
    """The contract of a solution, from the two functions of a file; subclasses have its parameters as fields.

    Raises ValueError with one line that begins with the file's name.
    """

    path: ClassVar[Path]
    functions: ClassVar[Mapping[str, Callable[..., Any]]]

    def __post_init__(self) -> None:
        self.named()

    def displacement(self, X: Sequence["sp.Symbol"], t: "sp.Symbol") -> "sp.Matrix":
        """u of the reference place X and the time t; two expressions in X, Y and t."""
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
        """What domain() returns, checked."""
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
        """The boundary that domain() names, one a side; None where it names none."""
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
        """A corner (2,) of domain()."""
        several = isinstance(value, tuple | list) or (isinstance(value, np.ndarray) and value.ndim > 0)
        if not several or len(value) != 2:
            raise ValueError(f"{self.path}: domain has {name} = {shortened(value)}; write two numbers")
        return np.array([self.number(name, one) for one in value])

    def number(self, name: str, value: Any) -> float:
        """A finite number of domain(); a word that looks like one is none."""
        try:
            number = np.nan if isinstance(value, NO_NUMBERS) else float(value)
        except (TypeError, ValueError, OverflowError):
            number = np.nan
        if not abs(number) < HUGE:
            raise ValueError(f"{self.path}: domain has {name} = {shortened(repr(value))}, which is no finite number")
        return number

    lower = property(lambda self: self.domain["lower"])
    upper = property(lambda self: self.domain["upper"])
    duration = property(lambda self: self.domain["duration"])
    C = property(lambda self: self.domain["speed"])
    material = property(lambda self: self.domain["material"])
    order = property(lambda self: self.domain.get("order"))

    @property
    def boundary(self) -> str | tuple[str, ...]:
        """One kind where all four sides have it, otherwise those of left, right, bottom, top.

        Raises ValueError where an edge does what no wall imposes.
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
        free = np.array([kind == "free" for kind in self.sides]).reshape(2, 2).T
        if not free.any():
            return 0.0
        room = (1 + ROOM) * self.edges.reach
        return room if free.all() else room * free

    @cached_property
    def edges(self) -> Any:
        """What the boundary does, in a body of the file's own material."""
        from mpm_verify.mms.edges import examine
        from mpm_verify.mms.manufacture import manufacture
        from mpm_verify.solver.plugins import MATERIALS, create

        law = create(MATERIALS, self.material)
        return examine(self, manufacture(self, law, law.rho0), law)

    def layout(self, dx: float, ppc: int, offset: Offset = CENTRED) -> Layout:
        """Square domains, `ppc` in a cell of side dx."""
        return rectangle(self.lower, self.upper, dx, ppc, offset)

    def call(self, name: str, *arguments: Any) -> Any:
        """A function of the file, with those parameters that it has."""
        function = self.functions[name]
        typed = parameters_of(type(self))
        mine = {key: getattr(self, typed[key].name) for key in parameters(self.path, name, function)}
        return guarded(self.path, lambda: function(*arguments, **mine))


@cache
def load(path: Path) -> type[Own]:
    """The class that a file makes; executed once a process. Raises ValueError with one line and the file's line."""
    text = source(path)
    namespace: dict[str, Any] = {"__name__": path.stem, "__file__": str(path)}
    guarded(path, lambda: exec(compile(text, str(path), "exec"), namespace))
    functions = {name: namespace.get(name) for name in ARGUMENTS}
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


def guarded(path: Path, action: Callable[[], Any]) -> Any:
    """Whatever the user's code raises becomes one line with the line of the file."""
    try:
        return action()
    except SyntaxError as error:
        raise ValueError(f"{path}, line {error.lineno}: {error.msg}") from None
    except (Exception, SystemExit) as error:
        frames = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
        where = f"{path}, line {frames[-1]}" if frames else str(path)
        raise ValueError(f"{where}: {type(error).__name__}: {shortened(str(error))}") from error


def shortened(value: Any) -> str:
    """One line of at most 100 characters."""
    text = " ".join((value if isinstance(value, str) else repr(value)).split())
    return text if len(text) <= 100 else f"{text[:97]}..."
