"""Source hash: of the syntax trees of a file and of all that it imports; it names the kernel cache and the Results.

The import closure is found in the text, nothing is imported. An import inside a function counts, as what it brings can
compute; one below TYPE_CHECKING does not. Of `from package import module` the module counts, and the package's own
`__init__` only where the name is not a module. Of a package file only `mpm_verify` is followed; of a user's file also
what lies beside it, and what it finds elsewhere, an installed package by its version. A tree is taken without comments,
docstrings, annotations of functions, what a ValueError says and what reads as a sentence: none of them can change a
number. To parse all that a case imports takes 0.1 s, so the hashes of trees are kept on disk, by the contents of files.
"""

import ast
import hashlib
import json
import re
import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mpm_verify.solver.cache_folder import kept

TOP = Path(__file__).absolute().parent.parent  # the folder of the installed package; links stay as they are
PACKAGE = "mpm_verify"
OURS = {"numpy", "scipy", "sympy", "mpmath", "numba", "llvmlite", "pandas", "matplotlib"}  # of any version
INSTALLED = {"site-packages", "dist-packages"}
LITTLE = set(
    re.findall(
        r"\S+",
        """& an and are as at be by cannot for from has have if in is it its may must no not of
    on or so than that the this to what where which with""",
    )
)  # words that names and formats have not
MUTE = {"ctx", "kind", "type_comment", "returns"}  # fields of a node that cannot change a number


@dataclass(frozen=True)
class Tree:
    """SHA-256 of a file's syntax tree, and what the file imports: (level, module, name or None)."""

    digest: str
    imports: tuple[tuple[int, str, str | None], ...]


@cache
def source_hash(module: str) -> str:
    """SHA-256 of a module of mpm_verify and its import closure, read once a process."""
    return _digest(closure(module))


def file_hash(file: Path) -> str:
    """SHA-256 of a user's file and its import closure, read anew at each call."""
    return _digest(closure(file.stem, file.parent))


@cache
def package_hash() -> str:
    """SHA-256 of all that computes: the modules of solver, mms and cases."""
    files = [file for floor in ("solver", "mms", "cases") for file in (TOP / floor).rglob("*.py")]
    return _digest({str(file.relative_to(TOP)): _ours(file).digest for file in files})


def closure(module: str, folder: Path | None = None) -> dict[str, str]:
    """Hashes of the trees of all files in an import closure, by module; names beside `folder` are without package.

    A module that is not there has an empty closure.
    """
    found: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name in found:
            continue
        ours = name.partition(".")[0] == PACKAGE
        file = find(name, folder) or (None if ours or folder is None else elsewhere(name))
        if file is None:
            continue
        if not ours and (file.suffix != ".py" or INSTALLED & set(file.parts)):
            found[name] = installed(name, file)
            continue
        tree = _ours(file) if ours else parse(file.read_bytes())
        found[name] = tree.digest
        parent = name if file.name == "__init__.py" else name.rpartition(".")[0]
        waiting += [target for item in tree.imports for target in _targets(item, parent, None if ours else folder)]
    return found


def find(module: str, folder: Path | None = None) -> Path | None:
    """File of a module of mpm_verify, or of one beside a user's file; None for any other."""
    first, *rest = module.split(".")
    if first == PACKAGE:
        return _shipped(module)
    return _at(folder.joinpath(first, *rest), module) if folder is not None and first else None


@cache
def _shipped(module: str) -> Path | None:
    return _at(TOP.joinpath(*module.split(".")[1:]), module)


def _at(path: Path, module: str) -> Path | None:
    files = (path.with_name(f"{path.name}.py"), path / "__init__.py", path.parent / f"{module}.py")
    return next((file for file in files if file.is_file()), None)


def elsewhere(module: str) -> Path | None:
    """File of a module that is neither the package's nor beside a user's file; None of Python's and our libraries."""
    first, *rest = module.split(".")
    if not first or first in sys.stdlib_module_names or first in OURS:
        return None
    try:
        spec = find_spec(first)
    except (ImportError, ValueError):
        return None
    origin = Path(spec.origin) if spec and spec.origin else None
    if origin is None or not origin.is_file():
        return None
    top = origin.parent.parent if origin.name == "__init__.py" else origin.parent
    return _at(top.joinpath(first, *rest), module) or (origin if not rest else None)


def installed(module: str, file: Path) -> str:
    """Digest of an installed package, by its version, or of a compiled module, by its content."""
    with suppress(PackageNotFoundError, ValueError):
        if INSTALLED & set(file.parts):
            return f"{module} {version(module.partition('.')[0])}"
    return hashlib.sha256(file.read_bytes()).hexdigest()


def _targets(item: tuple[int, str, str | None], parent: str, folder: Path | None) -> Iterator[str]:
    """Modules that one import may name; of those that are not there nothing follows."""
    level, module, name = item
    if level:
        parts = parent.split(".") if parent else []
        module = ".".join([*parts[: len(parts) - level + 1], *filter(None, [module])])
    inner = f"{module}.{name}" if module else str(name)
    known = name and (find(inner, folder) or (folder is not None and elsewhere(inner)))
    yield inner if known else module


def _digest(trees: dict[str, str]) -> str:
    return hashlib.sha256(repr(sorted(trees.items())).encode()).hexdigest()


@cache
def _ours(file: Path) -> Tree:
    return parse(file.read_bytes())


# ---- one file


def parse(content: bytes) -> Tree:
    """Tree of a source text, known by its content or parsed. Raises SyntaxError."""
    digest, imports = json.loads(kept(_folder(), hashlib.sha256(content).hexdigest(), lambda: _parsed(content)))
    return Tree(digest, tuple((level, module, name) for level, module, name in imports))


@cache
def _folder() -> str:
    made_by = Path(__file__).read_bytes() + repr(sys.version_info[:2]).encode()
    return f"trees-{hashlib.sha256(made_by).hexdigest()[:24]}"


def _parsed(content: bytes) -> str:
    imports: list[tuple[int, str, str | None]] = []
    text = _spelled(ast.parse(content), imports)
    return json.dumps([hashlib.sha256(text.encode()).hexdigest(), list(dict.fromkeys(imports))])


def _spelled(node: Any, imports: list[tuple[int, str, str | None]]) -> str:
    """Syntax tree as text, the same for every version of Python that has the same nodes; what is imported is noted."""
    if isinstance(node, list):
        return f"[{','.join(_spelled(item, imports) for item in _speaking(node))}]"
    if not isinstance(node, ast.AST):
        return repr(node)
    if _said(node):
        return "''"
    if isinstance(node, ast.Import | ast.ImportFrom | ast.Call):
        imports += _imported(node)
    if isinstance(node, ast.Call) and _name(node.func) == "axis":  # the help text of a field
        node = ast.Call(node.func, [*node.args[:1], *node.args[2:]], node.keywords)
    mute = MUTE | {"annotation"} if isinstance(node, ast.arg) else MUTE
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and _name(node.exc.func) == "ValueError":
        mute = mute | {"exc"}
    fields = ((name, value) for name, value in ast.iter_fields(node) if name not in mute)
    inner = ",".join(f"{name}={_spelled(value, imports)}" for name, value in fields if value not in (None, []))
    return f"{type(node).__name__}({inner})"


def _said(node: ast.AST) -> bool:
    """Whether this is a text that reads as a sentence: words for people, such as a help text or a source."""
    if isinstance(node, ast.JoinedStr):
        text = "".join(str(part.value) if isinstance(part, ast.Constant) else "_" for part in node.values)
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        text = node.value
    else:
        return False
    words = [word.strip(".,;:!?()'\"").lower() for word in text.split()]
    return "\n" not in text and any(len(word) > 2 and word.isalpha() for word in words) and not LITTLE.isdisjoint(words)


def _speaking(nodes: list[Any]) -> Iterator[Any]:
    """Statements without bare strings and without what only type checkers see."""
    for node in nodes:
        if isinstance(node, ast.If) and _name(node.test) == "TYPE_CHECKING":
            yield from node.orelse
        elif not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)):
            yield node


def _imported(node: ast.Import | ast.ImportFrom | ast.Call) -> list[tuple[int, str, str | None]]:
    if isinstance(node, ast.Import):
        return [(0, alias.name, None) for alias in node.names]
    if isinstance(node, ast.ImportFrom):
        return [(node.level, node.module or "", alias.name) for alias in node.names]
    first = node.args[0] if node.args else None
    known = _name(node.func) == "import_module" and isinstance(first, ast.Constant)
    return [(0, str(first.value), None)] if known and isinstance(first, ast.Constant) else []


def _name(node: ast.AST) -> str:
    return node.id if isinstance(node, ast.Name) else node.attr if isinstance(node, ast.Attribute) else ""
