"""No sentence in the numeric layer: solver, mms and cases hold codes, numbers and labels."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from mpm_verify.solver.source_hash import TOP

LONG = 60
ALLOWED = {  # file: why
    "mms/edges.py": "the line of the ValueError for a user's own solution",
    "cases/mms/stability.py": "the line of the ValueError for a time step that is too long",
}
FILES = sorted(file for floor in ("solver", "mms", "cases") for file in (TOP / floor).rglob("*.py"))


def sentences(source: str) -> Iterator[str]:
    """Literals that read as sentences: from a capital letter to a full stop, or long with a colon.

    Docstrings are none, and neither is what is raised: one line that says what is wrong with the input. The help of an
    option stands with its field, in axis().
    """
    tree = ast.parse(source)
    passed = {id(node) for part in ast.walk(tree) for node in skipped(part)}
    for node in ast.walk(tree):
        if id(node) not in passed and isinstance(node, ast.Constant | ast.JoinedStr):
            text = words_of(node).strip()
            closed = text[:1].isupper() and text.endswith(".") and " " in text
            if closed or (": " in text and len(text) > LONG):
                yield text


def skipped(node: ast.AST) -> Iterator[ast.AST]:
    """Nodes below this one that are no words of the program: docstrings, what is raised, parts of an f-string."""
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        yield node.value
    elif isinstance(node, ast.Raise) or (isinstance(node, ast.Call) and said_elsewhere(node.func)):
        yield from ast.walk(node)
    elif isinstance(node, ast.JoinedStr):
        yield from (part for part in node.values if isinstance(part, ast.Constant))


def said_elsewhere(function: ast.expr) -> bool:
    """Whether this makes an error, or a field with its help."""
    return isinstance(function, ast.Name) and (function.id == "axis" or function.id.endswith("Error"))


def words_of(node: ast.AST) -> str:
    """The text of a literal, with {} for what is put in."""
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(TOP).as_posix())
def test_no_sentence_in_the_numeric_layer(file: Path) -> None:
    name = file.relative_to(TOP).as_posix()
    found = list(sentences(file.read_text()))
    if name in ALLOWED:
        assert found, f"{name} needs no exception"
    else:
        assert not found


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ('x = "The stress turns with the block."', 1),
        ('x = f"The front comes to {front:.3f} m."', 1),
        ('x = ("The front comes " "to rest.")', 1),
        ('x = "nothing shows that the order has settled: " f"add a level that is finer than {finest} cells"', 1),
        ('"""A docstring is none."""\ndef f():\n    """Neither is this."""', 0),
        ('raise ValueError(f"{name} is no file: give one with a header and rows of strains below it.")', 0),
        ('x: int = axis(8, "Cells along the bar.")', 0),
        ('return RunnerError(f"what computes {run} is not what it was: make it return the same and start again.")', 0),
        ('x: int = other(8, "Cells along the bar.")', 1),
        ('x = "largest distance from the closed form"', 0),
        ('x = {"U.S."}', 0),
    ],
)
def test_a_sentence_is_seen(source: str, count: int) -> None:
    assert len(list(sentences(source))) == count
