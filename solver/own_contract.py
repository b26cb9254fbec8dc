"""Checks of a plug-in from a user's file against the contract of its kind, before anything runs with it.

Each raises OwnFileError with one line. A package asks them in its module `_own`, see solver/plugins.py.
"""

import inspect
from collections.abc import Callable
from numbers import Integral, Real
from pathlib import Path
from typing import Any

from mpm_verify.solver.own_file import OwnFileError, guarded, shortened


def below(plugin: Any, base: type, path: Path) -> None:
    """Check that a plug-in is below the class of its kind."""
    name = type(plugin).__name__
    if not isinstance(plugin, base):
        raise OwnFileError(
            f"{path}: write class {name}({base.__name__}), with {base.__name__} from {base.__module__}: it has what "
            "the class does not define"
        )


def arguments(plugin: Any, base: type, path: Path) -> None:
    """Check that the methods of a plug-in take the arguments that those of `base` take."""
    for name, asked in vars(base).items():
        own = getattr(type(plugin), name, None)
        hidden = name.startswith("_") and name != "__call__"
        if own is asked or hidden or not (isinstance(asked, staticmethod | classmethod) or inspect.isfunction(asked)):
            continue
        wanted = list(inspect.signature(getattr(base, name)).parameters.values())[inspect.isfunction(asked) :]
        given = ", ".join(["self", *(str(item.replace(annotation=item.empty)) for item in wanted)])
        least = [None for item in wanted if item.default is item.empty]
        called(plugin, name, path, given, (len(least), len(wanted)))


def called(plugin: Any, name: str, path: Path, arguments: str, counts: tuple[int, ...]) -> None:
    """Check that a plug-in has a method that can be called with so many arguments; `arguments` as they are written."""
    method = getattr(plugin, name)
    if not callable(method):
        raise OwnFileError(f"{path}: {name} = {shown(method)} must be a method, {name}({arguments})")
    if not all(takes(method, count) for count in counts):
        raise OwnFileError(f"{line(path, method)}: {name} must take what is asked of it: {name}({arguments})")


def takes(method: Callable[..., Any], count: int) -> bool:
    """Whether a method can be called with so many arguments; so it is taken of one that does not say."""
    try:
        inspect.signature(method).bind(*[None] * count)
    except TypeError:
        return False
    except ValueError:
        return True
    return True


def shown(value: Any) -> str:
    """Value as it is written in a file, in one line."""
    return shortened(repr(value))


def line(path: Path, function: Any) -> str:
    """File of a function, with its line where it stands in that file."""
    code = getattr(inspect.unwrap(getattr(function, "__func__", function)), "__code__", None)
    if code is None or code.co_filename != str(path.resolve()):
        return str(path)
    return f"{path}, line {code.co_firstlineno}"


def real(plugin: Any, name: str, path: Path, least: float, most: float, what: str) -> float:
    """Number that a plug-in has as `name`, checked to lie within bounds; `what` says what it must be."""
    value: Any = guarded(path, lambda: getattr(plugin, name))
    if isinstance(value, bool) or not isinstance(value, Real) or not least <= float(value) <= most:
        raise OwnFileError(f"{path}: {name} = {shown(value)} must be {what}")
    return float(value)


def whole(plugin: Any, name: str, path: Path, least: int, most: int, what: str) -> int:
    """Whole number that a plug-in has as `name`, checked to lie within bounds; `what` says what it counts."""
    value: Any = guarded(path, lambda: getattr(plugin, name))
    if isinstance(value, bool) or not isinstance(value, Integral) or not least <= int(value) <= most:
        raise OwnFileError(f"{path}: {name} = {shown(value)} must be a whole number from {least} to {most}, {what}")
    return int(value)


def kernel(plugin: Any, name: str, path: Path, signature: Any, called: str) -> None:
    """Check that a plug-in has as `name` a compiled kernel of one signature; `called` is what a user writes for it."""
    value = getattr(plugin, name)
    if inspect.ismethod(value):  # without staticmethod() the object is its first argument
        value = value.__func__
    overloads = getattr(value, "nopython_signatures", ())
    if [(one.args, one.return_type) for one in overloads] != [(signature.args, signature.return_type)]:
        mark = f"kernel({called})"
        raise OwnFileError(
            f"{line(path, value)}: {name} must be a kernel of the signature {called}: write @{mark} before it, and "
            f"{name} = staticmethod({name}) in the class"
        )
