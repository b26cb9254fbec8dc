"""What the store writes for each case: its Study and its Result. A new case with records of its own is a line here."""

from dataclasses import dataclass
from functools import cache
from typing import Any

from pydantic import TypeAdapter


@dataclass(frozen=True)
class Kind:
    """Readers of a case's study.json and of its Results."""

    study: TypeAdapter[Any]
    result: TypeAdapter[Any]


@cache
def kind(case: str) -> Kind:
    """The readers of a case, built once: it takes longer than to read a file. Raises KeyError for another."""
    from mpm_verify.cases.column.run import ColumnResult, ColumnStudy
    from mpm_verify.cases.harness.study import Result, Study

    study, result = {"mms": (Study, Result), "column": (ColumnStudy, ColumnResult)}[case]
    return Kind(TypeAdapter(study), TypeAdapter(result))
