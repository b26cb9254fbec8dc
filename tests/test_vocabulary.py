"""One language: docstrings, comments, literals and names use the words of the glossary, in the sense it gives them."""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

from mpm_verify.solver.source_hash import TOP

FOLDERS = ("solver", "mms", "cases", "reports", "verify")

WORDS = {  # what to say: what not, in the sense that is meant
    "position, reference position": r"\bplaces\b|(?<!\bin )(?<!\btake )(?<!\btakes )\bplace\b",
    "support nodes; adjacent": r"\bneighbou?rs?\b",
    "material, constitutive model": r"(?<!\bscaling )(?<!\bpower )\blaws?\b",
    "failed, inverted, left the grid": (
        r"\blos(?:t|es?|ing) (?:its |their |the )?det\b|\blost (?:particle|state|run)s?\b"
        r"|\b(?:particles?|states?|runs?) (?:is|are|was|were|gets?|stays?) lost\b"
    ),
    "fraction": (
        r"\b(?:a|an|the|this|its|their|each|no|as|by|in|largest|smallest|elastic|plastic) shares?\b|\bshares? of\b"
    ),
    "not a number": r"(?<!\bthere )\b(?:is|are) no numbers?\b|\bno (?:finite|round|square|whole) numbers?\b",
    "time level, update-stress-last": r"\bhalf a step behind\b",
    "normal, tangential": (
        r"\b(?:displacement|velocity|traction|force|component)s? (?:across|along)\b"
        r"|\bacross and along\b|\balong and across\b"
    ),
    "blind spot": r"(?<!\bblind )\bspots?\b",
    "negative control": r"\bmis-?readings?\b",
    "energy budget": r"\bdiagnostics?\b",
    "stress update": r"\b(?:stress|step) orders?\b",
    "sigma_smoothed": r"\bfelt\b",
}
RULES = {say: re.compile(pattern, re.IGNORECASE) for say, pattern in WORDS.items()}
NAMES = {"place", "places", "neighbour", "neighbours", "law", "laws", "share", "shares", "felt", "misreading"}
START = re.compile(r"(?:What|How|Why|Of|By|To|Their|Its|It|In|From|For|With|On|At)\b")
ALLOWED: dict[tuple[str, str], str] = {}  # (file, what is found): why; none yet

Found = Iterator[tuple[int, str]]


def docstrings(tree: ast.AST) -> Iterator[ast.Constant]:
    """The literals that document a module, class, function or field."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            yield node.value


def literals(tree: ast.AST, documented: bool) -> Found:
    """Texts in a tree with their lines, those that document it or the others."""
    documents = {id(node) for node in docstrings(tree)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and (id(node) in documents) == documented:
            yield node.lineno, node.value


def comments(source: str) -> Found:
    """Comments with their lines; those of adjacent lines are one text."""
    last, text = 0, ""
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT:
            if token.start[0] != last + 1 and text:
                yield last, text
                text = ""
            last, text = token.start[0], f"{text} {token.string.lstrip('# ')}"
    if text:
        yield last, text


def names(tree: ast.AST) -> Found:
    """Names that a file gives: of functions, classes, arguments, variables and attributes."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            yield node.lineno, node.name
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.attr


def parts(name: str) -> set[str]:
    """Words of a name: `of_law` -> of, law; `OfLaw` too."""
    return {part.lower() for part in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", name)}


def said(texts: Found) -> Iterator[str]:
    """What breaks a rule in texts, as `line: word (say ...)`."""
    for line, text in texts:
        for say, rule in RULES.items():
            for match in rule.finditer(" ".join(text.split())):
                yield f"{line}: {match[0]} (say {say})"


def broken(source: str) -> list[str]:
    """All that a file of FOLDERS says and should not."""
    tree = ast.parse(source)
    documents = list(literals(tree, documented=True))
    found = [*said(iter(documents)), *said(comments(source)), *said(literals(tree, documented=False))]
    found += [f"{line}: {name} (a name)" for line, name in names(tree) if parts(name) & NAMES and name != "in_place"]
    return found + [f"{line}: {text[:30]} (a docstring's start)" for line, text in documents if START.match(text)]


def kept(file: str, found: list[str]) -> list[str]:
    """What is found without what is allowed in that file."""
    words = {word for name, word in ALLOWED if name == file}
    return [item for item in found if item.partition(": ")[2].partition(" (")[0] not in words]


FILES = [file for folder in FOLDERS for file in sorted((TOP / folder).rglob("*.py"))]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(TOP).as_posix())
def test_the_words_of_the_product(file: Path) -> None:
    found = kept(file.relative_to(TOP).as_posix(), broken(file.read_text()))
    assert not found, "\n".join(found)


@pytest.mark.parametrize(("file", "word"), ALLOWED)
def test_an_exception_is_needed(file: str, word: str) -> None:
    assert any(f": {word} (" in item for item in broken((TOP / file).read_text()))


def test_many_files_are_read() -> None:
    assert len(FILES) > 200
    assert sum(len(list(docstrings(ast.parse(file.read_text())))) for file in FILES) > 1500


@pytest.mark.parametrize(
    ("say", "wrong", "right"),
    [
        ("position, reference position", "The place of a node.", "A change takes place in place, in place of a copy."),
        ("support nodes; adjacent", "Sixteen neighbours.", "Sixteen support nodes."),
        ("material, constitutive model", "A law in rate form.", "The scaling law of the run-out; a lawn."),
        ("failed, inverted, left the grid", "A particle that lost its det F.", "Energy is lost, and digits."),
        ("fraction", "A share of the spacing.", "Results that share their material."),
        ("not a number", "x is no finite number.", "A value is not a finite number; there is no number."),
        ("time level, update-stress-last", "v is half a step behind x.", "v has the level half a step before x."),
        ("normal, tangential", "The velocity along the wall.", "Points along a side, across the body."),
        ("blind spot", "One spot of many.", "A blind spot, spotted."),
        ("negative control", "Known misreadings.", "Negative controls; the reading."),
        ("energy budget", "Diagnostics of a step.", "The energy budget."),
        ("stress update", "The stress order musl.", "The order of the stress."),
        ("sigma_smoothed", "The stress that is felt.", "Fields."),
    ],
)
def test_a_wrong_word_is_seen(say: str, wrong: str, right: str) -> None:
    for source in (f'"""{wrong}"""', f"x = 1  # {wrong}", f'x = "{wrong}"', f'raise ValueError(f"{{x}}: {wrong}")'):
        assert [item for item in broken(source) if f"(say {say})" in item], source
    assert not broken(f'"""{right}"""\nx = 1  # {right}')


@pytest.mark.parametrize("word", ["Of", "By", "To", "Their", "Its", "It", "In", "From", "For", "With", "On", "At"])
def test_a_preposition_at_the_start_is_seen(word: str) -> None:
    assert broken(f'def f():\n    """{word} the grid."""')
    assert not broken(f'def f():\n    """Mass {word.lower()} the grid. {word}."""')
    assert not broken(f'def f():\n    """{word}ward."""')


@pytest.mark.parametrize(
    "source", ["def of_law(): ...", "class OfLaw: ...", "def f(law): ...", "places = 1", "x.share = 1", "law: int"]
)
def test_a_wrong_name_is_seen(source: str) -> None:
    assert broken(source)


def test_right_names_pass() -> None:
    assert not broken("def lawn(shared, placed): in_place = replace = x.flip_fraction = law")


def test_a_word_across_lines_is_seen() -> None:
    assert broken('"""v is half a\nstep behind x."""')
    assert broken("# v is half a\n# step behind x")
