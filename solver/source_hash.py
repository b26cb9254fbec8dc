"""Source hash: of the syntax trees of a file and of all that it imports; it names the kernel cache and the Results.

The import closure is found in the text, nothing is imported. An import inside a function counts, as what it brings can
compute; one below TYPE_CHECKING does not. Of `from package import module` the module counts, and the package's own
`__init__` only where the name is not a module. Of a package file only `mpm_verify` is followed, of a user's file also
what lies beside it. A tree is taken without comments, docstrings, annotations of functions and what a ValueError says:
none of them can change a number. To parse all that a case imports takes 0.1 s, so the hashes of trees are kept on disk,
by the contents of the files.
"""

import ast
import hashlib
import json
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mpm_verify.solver.cache_folder import kept

TOP = Path(__file__).absolute().parent.parent  # the folder of the installed package; links stay as they are
PACKAGE = "mpm_verify"
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


def closure(module: str, folder: Path | None = None) -> dict[str, str]:
    """Hashes of the trees of all files in an import closure, by module; names beside `folder` are without package.

    A module that is not there has an empty closure.
    """
    found: dict[str, str] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        file = find(name, folder)
        if file is None or name in found:
            continue
        ours = name.partition(".")[0] == PACKAGE
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


def _targets(item: tuple[int, str, str | None], parent: str, folder: Path | None) -> Iterator[str]:
    """Modules that one import may name; of those that are not there nothing follows."""
    level, module, name = item
    if level:
        parts = parent.split(".") if parent else []
        module = ".".join([*parts[: len(parts) - level + 1], *filter(None, [module])])
    inner = f"{module}.{name}" if module else str(name)
    yield inner if name and find(inner, folder) else module


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
    if isinstance(node, ast.Import | ast.ImportFrom | ast.Call):
        imports += _imported(node)
    mute = MUTE | {"annotation"} if isinstance(node, ast.arg) else MUTE
    if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and _name(node.exc.func) == "ValueError":
        mute = mute | {"exc"}
    fields = ((name, value) for name, value in ast.iter_fields(node) if name not in mute)
    inner = ",".join(f"{name}={_spelled(value, imports)}" for name, value in fields if value not in (None, []))
    return f"{type(node).__name__}({inner})"


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
