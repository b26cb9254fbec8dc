"""All exact tests of a method and a material; `run` is what a campaign calls."""

from collections.abc import Callable
from functools import cache
from importlib import import_module

from mpm_verify.cases.exact.body import Subject
from mpm_verify.cases.exact.tested import Tested
from mpm_verify.solver.plugins import TRANSFERS, available

GROUPS = ("weights", "motion", "walls", "step", "symmetry")


def run(method: str = "cpdi", material: str = "neo_hookean") -> tuple[Tested, ...]:
    """Test a method with a material.

    Parameters
    ----------
    method, material
        Specifications, `name` or `name:key=value`, or a user's file.

    Returns
    -------
    tuple of Tested
        One for each test and each transfer and stress update; those that are not promised have a `reason`.

    Raises
    ------
    ValueError
        For a method or material that is not there.
    """
    subject = Subject(method, material)
    return tuple(one for group in GROUPS for one in tests_of(group)(subject))


def tests_of(group: str) -> Callable[[Subject], list[Tested]]:
    """Tests of a group: a file of this folder."""
    found: Callable[[Subject], list[Tested]] = import_module(f"mpm_verify.cases.exact.{group}").tests
    return found
