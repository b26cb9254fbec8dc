"""A plug-in is a file: its name is the word on the command line, and the class in it has that name in CamelCase."""

from importlib import import_module
from pathlib import Path
from typing import Any


def available(package: str) -> list[str]:
    """Names of the plug-ins in a package such as `solver.basis`, found without importing anything."""
    folder = Path(__file__).resolve().parent.parent.joinpath(*package.split("."))
    return sorted(file.stem for file in folder.glob("*.py") if not file.stem.startswith("_"))


def load(package: str, name: str) -> Any:
    """The class of plug-in `name`. Raises ValueError that lists the choices where there is no such file."""
    if name not in available(package):
        raise ValueError(f"no {package.rpartition('.')[2]} named {name!r}; choose from {', '.join(available(package))}")
    return getattr(import_module(f"{package}.{name}"), camel(name))


def camel(name: str) -> str:
    """`neo_hookean` -> `NeoHookean`; all plug-in classes are named so, `cpdi` -> `Cpdi` among them."""
    return "".join(part.capitalize() for part in name.split("_"))


def create(package: str, specification: str) -> Any:
    """The plug-in with its parameters from `name` or `name:key=value,key=value`.

    Raises ValueError with one line that says what is allowed.
    """
    name, _, rest = specification.partition(":")
    plugin = load(package, name)
    allowed = list(plugin.__dataclass_fields__)
    parameters: dict[str, float] = {}
    for item in filter(None, rest.split(",")):
        key, _, value = item.partition("=")
        if key not in allowed:
            raise ValueError(f"{name} has no parameter {key!r}; it has {', '.join(allowed) or 'none'}")
        try:
            parameters[key] = float(value)
        except ValueError:
            raise ValueError(f"{name}: {key}={value!r} is no number") from None
    return plugin(**parameters)
