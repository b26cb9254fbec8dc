"""Exported Julia without Julia: python julia_tree.py FILE ... says where the grammar of tree-sitter finds an error.

With --values FILE and rows on standard input it walks the syntax tree of the functions without a loop, and prints the
force, u, v, F and sigma of each row: the order of operations is that of the grammar, the arithmetic that of Python.
"""

import math
import operator
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import tree_sitter_julia
from tree_sitter import Language, Parser

FUNCTIONS = ("body_force", "displacement", "velocity", "deformation", "stress")
OPERATORS: dict[bytes, Callable[[Any, Any], Any]] = {
    b"+": operator.add, b"-": operator.sub, b"*": operator.mul, b"/": operator.truediv, b"^": operator.pow,
}  # fmt: skip


def tree(text: bytes) -> Any:
    return Parser(Language(tree_sitter_julia.language())).parse(text).root_node


def spaced(text: bytes) -> bytes:
    """Text with blanks in `2.0*(`, where that grammar sees a number beside a call of `*`; Julia sees a product."""
    return re.sub(rb"(?<=[\d.])([*/^])\(", rb" \1 (", text)


def broken(node: Any) -> Iterator[Any]:
    """Nodes that are an error, or that the grammar had to add."""
    if node.is_error or node.is_missing:
        yield node
    for child in node.children:
        yield from broken(child)


def functions(node: Any) -> Iterator[tuple[str, Any]]:
    """Definitions of functions below a node, by their names."""
    if node.type == "function_definition":
        yield node.named_children[0].named_children[0].named_children[0].text.decode(), node
    for child in node.children:
        yield from functions(child)


def call(function: Any, values: list[Any]) -> Any:
    """What a function without a loop returns."""
    signature, *statements = function.named_children
    arguments = signature.named_children[0].named_children[1].named_children
    known = dict(zip((one.text for one in arguments), values, strict=True))
    for statement in statements:
        if statement.type == "assignment":
            name, *_, given = statement.named_children
            known[name.text] = value(given, known)
        elif statement.type == "return_statement":
            return value(statement.named_children[0], known)
        elif statement.type != "line_comment":
            raise ValueError(f"{statement.type} in a function without a loop")
    raise ValueError("no return")


def value(node: Any, known: dict[bytes, Any]) -> Any:
    """Value of an expression; a name that has none yet is a KeyError."""
    parts = node.named_children
    match node.type:
        case "identifier":
            return known[node.text]
        case "integer_literal" | "float_literal":
            return float(node.text)
        case "parenthesized_expression":
            return value(parts[0], known)
        case "unary_expression" if parts[0].text == b"-":
            return -value(parts[1], known)
        case "binary_expression":
            return OPERATORS[parts[1].text](value(parts[0], known), value(parts[2], known))
        case "call_expression":
            return getattr(math, parts[0].text.decode())(*(value(one, known) for one in parts[1].named_children))
        case "index_expression":
            return value(parts[0], known)[int(parts[1].named_children[0].text) - 1]
        case "tuple_expression":
            return tuple(value(one, known) for one in parts)
    raise ValueError(f"{node.type} in an expression: {node.text.decode()}")


def print_values(file: str) -> None:
    defined = dict(functions(tree(spaced(Path(file).read_bytes()))))
    for line in sys.stdin:
        row = [float(word) for word in line.split()]
        d = len(row) // 2
        found = [one for name in FUNCTIONS for one in call(defined[name], [row[:d], row[d]])]
        print(*map(repr, found))


if __name__ == "__main__":
    if sys.argv[1] == "--values":
        print_values(sys.argv[2])
    else:
        errors = [(file, node.start_point) for file in sys.argv[1:] for node in broken(tree(Path(file).read_bytes()))]
        for file, (row, column) in errors:
            print(f"{file}:{row + 1}:{column + 1}")
        sys.exit(bool(errors))
