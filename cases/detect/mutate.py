"""Mutants of a file by generic operators on its syntax tree: each is a Defect, found again by its number.

    sign        a + b -> a - b, and back; -a -> a
    factor      a * b -> a / b, and back
    index       x[i] with a whole number i -> x[i + 1], or x[0] where i is the last of the row
    arguments   two neighbouring arguments that are names are swapped
    term        a + b -> a
    bound       range(a, b) one shorter; < -> <=, and so on
    constant    a number times 1.02, a whole number above 1 plus 1

What stands in docstrings, annotations, raised errors, decorators and default values of fields is left alone.
"""

import ast
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

from mpm_verify.cases.detect.defect import Defect
from mpm_verify.solver.source_hash import TOP

SWAPPED: dict[type[ast.operator], str] = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*"}
TURNED: dict[type[ast.cmpop], str] = {
    ast.Lt: "<=",
    ast.LtE: "<",
    ast.Gt: ">=",
    ast.GtE: ">",
    ast.Eq: "!=",
    ast.NotEq: "==",
}
ROOMS = ("solver", "cases/judging", "cases/mms", "cases/harness")
PLAIN = ("__init__", "_own", "own_", "plugins", "forked", "promise", "external", "digits", "negative_controls")
OWN = {
    "mpm": "mpm",
    "cpdi": "cpdi",
    "_parallelogram": "cpdi",
    "cpdi2": "cpdi2",
    "bspline2": "bspline2",
    "tensor": "bspline2",
}  # file: method


def mutants(file: str) -> tuple[Defect, ...]:
    """All mutants of a file below the package, in the order of their positions."""
    return _mutants(file, (TOP / file).read_text(encoding="utf-8"))


def mutant(name: str) -> Defect:
    """Mutant `mutant:FILE:NUMBER`. Raises ValueError where there is none."""
    _, file, number = (*name.split(":"), "", "")[:3]
    if not (TOP / file).is_file() or not number.isdigit() or not int(number) < len(found := mutants(file)):
        raise ValueError(f"no mutant {name!r}; write mutant:FILE:NUMBER, such as mutant:solver/step.py:0")
    return found[int(number)]


def sampled(count: int, seed: int) -> list[str]:
    """Names of mutants of all files, drawn without repetition."""
    import random

    every = [one.name for file in files() for one in mutants(file)]
    return sorted(random.Random(seed).sample(every, min(count, len(every))))


def files() -> list[str]:
    """Files that mutants are made of: those that compute and those that judge."""
    found = (file.relative_to(TOP) for room in ROOMS for file in (TOP / room).rglob("*.py"))
    return sorted(str(file) for file in found if not any(word in str(file) for word in PLAIN))


@cache
def _mutants(file: str, text: str) -> tuple[Defect, ...]:
    lines = [0]
    for line in text.splitlines(keepends=True):
        lines.append(lines[-1] + len(line))
    content = text.encode()

    def at(line: int, column: int) -> int:
        start = lines[line - 1]
        return start + len(content.splitlines(keepends=True)[line - 1][:column].decode())

    method = OWN.get(Path(file).stem, "") if "basis" in file or "tensor" in file else ""
    made = []
    for node, new, operator in _changes(ast.parse(text)):
        start, end = at(node.lineno, node.col_offset), at(node.end_lineno or 0, node.end_col_offset or 0)
        old = text[start:end]
        if new == old:
            continue
        before = len(re.findall(f"(?={re.escape(old)})", text[: start + len(old) - 1]))
        kind = "judge" if file.startswith(("cases/judging", "cases/harness", "cases/mms/norms")) else "order"
        made.append((start, Defect("", file, old, new, kind, operator, methods=(method,) if method else (), at=before)))
    made.sort(key=lambda pair: pair[0])
    return tuple(replace(one, name=f"mutant:{file}:{number}") for number, (_, one) in enumerate(made))


def _changes(tree: ast.AST) -> Iterator[tuple[ast.expr, str, str]]:
    """Nodes with their new text and the operator."""
    for node in _computing(tree):
        if (
            isinstance(node, ast.BinOp)
            and type(node.op) in SWAPPED
            and not isinstance(node.left, ast.Constant | ast.JoinedStr)
        ):
            left, right = ast.unparse(node.left), ast.unparse(node.right)
            word = "sign" if isinstance(node.op, ast.Add | ast.Sub) else "factor"
            yield node, f"(({left}) {SWAPPED[type(node.op)]} ({right}))", word
            if isinstance(node.op, ast.Add):
                yield node, f"({left})", "term"
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield node, f"({ast.unparse(node.operand)})", "sign"
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in TURNED:
            turned = f"{ast.unparse(node.left)} {TURNED[type(node.ops[0])]} {ast.unparse(node.comparators[0])}"
            yield node, f"({turned})", "bound"
        elif (
            isinstance(node, ast.Subscript)
            and isinstance(node.slice, ast.Constant)
            and isinstance(node.slice.value, int)
        ):
            yield node, f"{ast.unparse(node.value)}[{max(0, node.slice.value - 1) if node.slice.value else 1}]", "index"
        elif isinstance(node, ast.Call):
            yield from _calls(node)
        elif isinstance(node, ast.Constant) and isinstance(node.value, float):
            yield node, repr(node.value * 1.02), "constant"


def _calls(node: ast.Call) -> Iterator[tuple[ast.expr, str, str]]:
    """Changes of a call: two arguments swapped, a range one shorter."""
    names = [isinstance(argument, ast.Name) for argument in node.args]
    first = next((k for k in range(len(names) - 1) if names[k] and names[k + 1]), None)
    if first is not None:
        arguments = list(node.args)
        arguments[first], arguments[first + 1] = arguments[first + 1], arguments[first]
        yield node, ast.unparse(ast.Call(node.func, arguments, node.keywords)), "arguments"
    if isinstance(node.func, ast.Name) and node.func.id in ("range", "prange") and node.args and not node.keywords:
        last = ast.unparse(node.args[min(1, len(node.args) - 1)])
        kept = [ast.unparse(argument) for argument in node.args]
        kept[min(1, len(kept) - 1)] = f"({last}) - 1"
        yield node, f"{node.func.id}({', '.join(kept)})", "bound"


def _computing(tree: ast.AST) -> Iterator[ast.AST]:
    """Expressions inside functions that compute."""
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef) and not function.name.startswith(("__", "check")):
            waiting: list[ast.AST] = list(function.body)
            while waiting:
                node = waiting.pop()
                if isinstance(node, ast.Raise | ast.FunctionDef | ast.JoinedStr | ast.Assert):
                    continue
                if isinstance(node, ast.AnnAssign):
                    waiting += [node.value] if node.value else []
                    continue
                yield node
                waiting += list(ast.iter_child_nodes(node))
