"""Domain that a user's file returns, checked: corners, duration, speed, and what it may name beside them.

What is wrong is a ValueError, one line that begins with the file.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.solver.own_file import shortened
from mpm_verify.solver.sides import SOLID_SIDES
from mpm_verify.solver.state import Floats

NEEDED, OPTIONAL = {"lower", "upper", "duration", "speed"}, {"material", "boundary", "order", "axisymmetric"}
KINDS = ("fixed", "roller", "free", "pulled", "prescribed")
COUNTS = {2: "two", 4: "four", 6: "six"}  # sides
HUGE = 1e30  # a larger number overflows on the way
NOT_NUMBERS = (str, bytes, bool, np.bool_, complex, np.complexfloating, np.ndarray)  # though float() takes some of them


def checked(path: Path, domain: Any) -> dict[str, Any]:
    """Domain with corners (d,), floats and the usual material.

    Raises ValueError for a key, a number or a word that is not one of a domain.
    """
    if not isinstance(domain, dict) or not NEEDED <= set(domain) <= NEEDED | OPTIONAL:
        raise ValueError(
            f"{path}: domain returns {shortened(domain)}; it must return a dictionary with lower, upper, duration and "
            "speed, and perhaps material, boundary, order, axisymmetric"
        )
    box = {name: corner(path, name, domain[name]) for name in ("lower", "upper")}
    if len(box["upper"]) != len(box["lower"]):
        raise ValueError(
            f"{path}: domain has lower = {domain['lower']} and upper = {domain['upper']}; write as many numbers for "
            "both"
        )
    if not (box["upper"] > box["lower"]).all():
        raise ValueError(f"{path}: domain has upper = {domain['upper']}, not above lower = {domain['lower']}")
    sizes = {name: number(path, name, domain[name]) for name in ("duration", "speed", "order") if name in domain}
    for name, value in sizes.items():
        if value <= 0:
            raise ValueError(f"{path}: domain has {name} = {value:g}, which must be above zero")
    material = domain.get("material", "neo_hookean")
    if not isinstance(material, str) or not material:
        raise ValueError(
            f"{path}: domain has material = {shortened(material)}; write a name with its parameters, such as "
            "'neo_hookean:E=1e4,nu=0.3'"
        )
    if not isinstance(domain.get("axisymmetric", False), bool | np.bool_):
        raise ValueError(f"{path}: domain has axisymmetric = {shortened(domain['axisymmetric'])}; write True or False")
    return {**domain, **box, **sizes, "material": material}


def boundary(path: Path, domain: Mapping[str, Any]) -> tuple[str, ...] | None:
    """Boundary that a domain names, one kind a side; None where it names none. Raises ValueError."""
    named = domain.get("boundary")
    if named is None:
        return None
    names = SOLID_SIDES[: 2 * len(domain["lower"])]
    kinds = [kind for kind in KINDS if kind != "roller" or len(names) > 2]  # along the end of a line nothing slips
    sides = tuple(named) if isinstance(named, tuple | list) else (named,) * len(names)
    if len(sides) != len(names) or not all(isinstance(kind, str) and kind in kinds for kind in sides):
        raise ValueError(
            f"{path}: domain has boundary = {shortened(named)}; write one of {', '.join(kinds)}, or "
            f"{COUNTS[len(names)]} of them for {', '.join(names)}"
        )
    return sides


def corner(path: Path, name: str, value: Any) -> Floats:
    """Corner (d,); on a line it may be a number alone. Raises ValueError."""
    several = isinstance(value, tuple | list) or (isinstance(value, np.ndarray) and value.ndim > 0)
    if several and len(value) not in (1, 2, 3):
        raise ValueError(
            f"{path}: domain has {name} = {shortened(value)}; write two numbers, one on a line, three in a box"
        )
    return np.array([number(path, name, one) for one in (value if several else (value,))])


def number(path: Path, name: str, value: Any) -> float:
    """Finite number; a word that looks like one is not taken. Raises ValueError."""
    try:
        found = np.nan if isinstance(value, NOT_NUMBERS) else float(value)
    except (TypeError, ValueError, OverflowError):
        found = np.nan
    if not abs(found) < HUGE:
        raise ValueError(f"{path}: domain has {name} = {shortened(repr(value))}, which is not a finite number")
    return found
