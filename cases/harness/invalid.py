"""Plain line on what pydantic finds wrong with a value: what it must be, and not how it was tried."""

from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from mpm_verify.solver.own_file import shortened

KINDS = {
    "int_type": "a whole number", "int_parsing": "a whole number", "int_from_float": "a whole number",
    "int_parsing_size": "a smaller number", "float_type": "a number", "float_parsing": "a number",
    "finite_number": "a number that is finite", "bool_type": "true or false", "bool_parsing": "true or false",
    "string_type": "a text", "list_type": "a list", "tuple_type": "a list", "dict_type": "a table",
    "model_type": "a table", "dataclass_type": "a table", "path_type": "a path",
}  # fmt: skip
ABSENT = {"missing": "is missing", "missing_argument": "is missing"}
CHOICES = ("literal_error", "enum")
UNKNOWN = {"extra_forbidden": "is not known", "unexpected_keyword_argument": "is not known"}


def invalid(error: ValidationError) -> str:
    """First thing that is wrong with a record: `order = 'x' must be a number`."""
    first = error.errors()[0]
    where = ".".join(map(str, first["loc"]))
    if first["type"] in ABSENT and where:
        return f"{where} {ABSENT[first['type']]}"
    value = f"{where} = {shortened(repr(first['input']))}" if where else "its values"
    return value + wrong(first)


def wrong(first: Mapping[str, Any]) -> str:
    """Fault of a value, an entry of `ValidationError.errors`: ` must be a number`, or a colon and what is said."""
    kind = first["type"]
    if kind in KINDS or kind in CHOICES:
        return f" must be {first['ctx']['expected'] if kind in CHOICES else KINDS[kind]}"
    if kind in UNKNOWN:
        return f" {UNKNOWN[kind]}"
    message = first["msg"].removeprefix("Value error, ")
    return f": {message[:1].lower()}{message[1:]}"
