"""State of a run as numbers and arrays: taken from a model and its observers, and written into fresh ones.

What changes while a run goes on is found, not listed: the attributes of the model, of dataclasses in it that are not
frozen, and of all that watches it. A strategy, a function and anything else is made by the run's parameters, and stays.
"""

from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from mpm_verify.solver.model import Model, Observer

CONSTANT = {"constant": True}  # for anything that is made anew
UNKNOWN = (set, deque, bytearray, np.random.Generator)  # they change, and are not written


def parts(model: Model) -> dict[str, Any]:
    """The model and what watches its steps, by name."""
    watching = (getattr(look, "__self__", None) for looks in model.hooks.values() for look in looks)
    found = {id(one): one for one in watching if one is not None}
    return {"model": model} | {f"{type(one).__name__} {k}": one for k, one in enumerate(found.values())}


class Taken:
    """State as a JSON document, with its arrays beside it as they are; what is met twice is taken once."""

    def __init__(self, value: Any) -> None:
        self.arrays: list[Any] = []
        self.known: dict[int, Any] = {}
        self.state = self.of(value)

    def of(self, value: Any) -> Any:
        """Value for the document. Raises TypeError for keys of a dictionary that are no texts, and for UNKNOWN."""
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, np.generic):
            return value.item()
        if isinstance(value, list | tuple):
            return {type(value).__name__: [self.of(item) for item in value]}
        if isinstance(value, dict):
            if not all(isinstance(key, str) for key in value):
                raise TypeError("keys of a dictionary in a checkpoint must be texts")
            return {"dict": {key: self.of(item) for key, item in value.items()}}
        if isinstance(value, np.ndarray) and not constant(value):
            if id(value) not in self.known:
                self.known[id(value)] = len(self.arrays)
                self.arrays.append(value)
            return {"array": self.known[id(value)]}
        if isinstance(value, UNKNOWN):
            raise TypeError(f"no checkpoint holds a {type(value).__name__}; keep numbers, texts, lists or arrays")
        if not changes(value) or id(value) in self.known:
            return CONSTANT
        self.known[id(value)] = value
        return {"object": {name: self.of(item) for name, item in attributes(value)}}


def fits(found: Any, value: Any) -> bool:
    """Whether there is an object now for each that was stored in `found`."""
    if not isinstance(found, dict):
        return True
    if "object" in found:
        there = all(fits(item, getattr(value, name, None)) for name, item in found["object"].items())
        return changes(value) and there
    if "dict" in found:
        now = value if isinstance(value, dict) else {}
        return all(fits(item, now.get(key)) for key, item in found["dict"].items())
    inner = found.get("list") or found.get("tuple") or []
    return all(fits(item, now) for item, now in zip(inner, items(value, len(inner)), strict=True))


def written(found: Any, value: Any, arrays: Sequence[Any]) -> Any:
    """Value of what was stored as `found`: objects that are there keep their identity, and so do arrays that can."""
    if not isinstance(found, dict):
        return found
    (kind, inner), *_ = found.items()
    if kind == "array":
        return into(value, arrays[inner])
    if kind == "object":
        for name, item in inner.items():
            setattr(value, name, written(item, getattr(value, name, None), arrays))
        return value
    if kind == "dict":
        return {key: written(item, value.get(key) if isinstance(value, dict) else None, arrays)
                for key, item in inner.items()}  # fmt: skip
    if kind in ("list", "tuple"):
        made = [written(item, now, arrays) for item, now in zip(inner, items(value, len(inner)), strict=True)]
        return tuple(made) if kind == "tuple" else made
    return value


def items(value: Any, count: int) -> list[Any]:
    """So many items of a list or tuple, None for those that are not there."""
    there = list(value) if isinstance(value, list | tuple) else []
    return [*there, *[None] * count][:count]


def into(value: Any, array: Any) -> Any:
    """The array, or the one that is there with its numbers, where it is as large: others may refer to that."""
    if not isinstance(value, np.ndarray) or (value.shape, value.dtype) != (array.shape, array.dtype):
        return array
    value[...] = array
    return value


def changes(value: Any) -> bool:
    """Whether an object has attributes that a run changes."""
    frozen = getattr(getattr(type(value), "__dataclass_params__", None), "frozen", True)
    return isinstance(value, Observer) or not frozen


def attributes(value: Any) -> Iterator[tuple[str, Any]]:
    """Attributes of an object; of a model all but its hooks, see `parts`."""
    return ((name, item) for name, item in vars(value).items() if name != "hooks" and not constant(item))


def constant(value: Any) -> bool:
    """Whether nobody writes to it: a table that is made when it is first asked for."""
    return isinstance(value, np.ndarray) and not value.flags.writeable
