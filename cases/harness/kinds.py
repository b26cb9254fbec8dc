"""What the store writes for each case, its Study and its Result: RECORDS in the `run.py` of the case's folder."""

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

from pydantic import TypeAdapter

from mpm_verify.solver.plugins import CASES, available


@dataclass(frozen=True)
class Kind:
    """Readers of a case's study.json and of its Results."""

    study: TypeAdapter[Any]
    result: TypeAdapter[Any]


@cache
def kind(case: str) -> Kind:
    """The readers of a case, built once: it takes longer than to read a file. Raises KeyError for another."""
    if case not in available(CASES):
        raise KeyError(case)
    study, result = import_module(f"{CASES}.{case}.run").RECORDS
    return Kind(TypeAdapter(study), TypeAdapter(result))
