"""A user's file as a module: what it imports from beside it is its own, and is read again when it changes.

The file and the modules beside it live in a package of their own in sys.modules, named by the file's path, so two files
whose helpers have the same name do not share them. Nothing is read from or written to a __pycache__ there. The file is
executed as a program is: run none that you do not trust. From then on os._exit is an exception in this process, as
sys.exit is: a study must not end by it, least of all as if it had passed.
"""

import builtins
import hashlib
import os
import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from importlib.abc import MetaPathFinder
from importlib.machinery import FileFinder, ModuleSpec, SourceFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

from mpm_verify.solver.source_hash import PACKAGE, file_hash, find

PREFIX = "own_"  # the package of a user's file begins so


class OwnFileError(ValueError):
    """Error in a user's file, in one line that begins with the file's name, and its line where there is one."""


@dataclass(frozen=True)
class Held:
    """A module that was executed, the text of each file when it was, and the hash of what it derived from."""

    module: ModuleType
    files: dict[str, bytes]
    digest: str


def module_of(path: Path) -> ModuleType:
    """Module of a user's file, executed when the file or one that it has imported is another than before.

    Raises ValueError with one line, and the file's line if there is one.
    """
    file = path.resolve()
    held = _held.get(file)
    if held is None or any(_content(one) != content for one, content in held.files.items()):
        files: dict[str, bytes] = {}
        module = _executed(path, file, files)
        held = _held[file] = Held(module, files, digest(vars(module)))
    return held.module


def derived(path: Path) -> str:
    """SHA-256 of a user's file as it was when it was executed."""
    module_of(path)
    return _held[path.resolve()].digest


def digest(namespace: dict[str, Any]) -> str:
    """SHA-256 of a file by the names of its module: its import closure, and the plain data in the modules beside it.

    The data are what came from elsewhere: a file that was read, the environment, the clock.
    """
    modules = {m.__name__: vars(m) for m in _beside(namespace["__name__"])} | {namespace["__name__"]: namespace}
    family, seen = namespace["__name__"].partition(".")[0], set[int]()
    data = [(name, plain(names, family, seen)) for name, names in sorted(modules.items())]
    return hashlib.sha256(repr((file_hash(Path(namespace["__file__"])), data)).encode()).hexdigest()


def plain(value: Any, family: str, seen: set[int]) -> str:
    """Numbers, words, containers and arrays of them as text, and what the user's own classes hold; "" for the rest."""
    if value is None or isinstance(value, bool | int | float | complex | str | bytes):
        return repr(value)
    if id(value) in seen:
        return ""
    seen.add(id(value))
    if isinstance(value, list | tuple):
        return repr([plain(item, family, seen) for item in value])
    if isinstance(value, set | frozenset):
        return repr(sorted(plain(item, family, seen) for item in value))
    if (np := sys.modules.get("numpy")) and isinstance(value, np.ndarray | np.generic):
        return "" if value.dtype.hasobject else repr((str(value.dtype), value.shape, value.tobytes()))
    kind = value if isinstance(value, type) else type(value)
    if isinstance(value, dict):
        names = value
    elif kind.__module__.partition(".")[0] == family and hasattr(value, "__dict__"):
        names = vars(value)
    else:
        return ""
    held = ((str(key), plain(item, family, seen)) for key, item in names.items() if not str(key).startswith("__"))
    return repr(sorted((key, text) for key, text in held if text))


def without_exit() -> None:
    """Make os._exit an exception in this process; its forks, which end by it, keep it."""
    leave, owner = os._exit, os.getpid()

    def ended(status: int) -> None:
        if os.getpid() != owner:
            leave(status)
        raise SystemExit(status)

    if not hasattr(os._exit, "own_file"):
        vars(ended)["own_file"] = True
        vars(os)["_exit"] = ended


def guarded(path: Path, action: Callable[[], Any]) -> Any:
    """Do what runs a user's code; whatever that raises becomes an OwnFileError, with the line of the file.

    Want of memory is no fault of the file, and is left as it is.
    """
    try:
        return action()
    except SyntaxError as error:
        file = path.with_name(Path(error.filename).name) if error.filename else path
        where = f"{file}, line {error.lineno}" if error.lineno else str(file)
        raise OwnFileError(f"{where}: {error.msg}") from None
    except (OwnFileError, MemoryError):
        raise
    except (Exception, SystemExit) as error:
        told = blamed(error).replace(f"{path.resolve()}, line", f"{path}, line", 1)
        raise OwnFileError(told or f"{path}: {said(error)}") from error


def blamed(error: BaseException) -> str:
    """Line that names the file and line of a user's in which an error was raised; empty where none was executed.

    The traceback says so, and is not there any more in another process: ask where the error was raised.
    """
    if isinstance(error, OwnFileError):
        return str(error)
    if isinstance(error, SystemError) and error.__cause__:  # of a kernel that another has called by its address
        return blamed(error.__cause__)
    mine = {file for name, module in list(sys.modules.items()) if _is_family(name) for file in vars(module)["files"]}
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename in mine]
    return f"{frames[-1].filename}, line {frames[-1].lineno}: {said(error)}" if frames else ""


def said(error: BaseException) -> str:
    """Kind and message of an error in one line."""
    return ": ".join(filter(None, [type(error).__name__, shortened(str(error))]))


def shortened(value: Any) -> str:
    """Text of a value in one line of at most 100 characters."""
    text = " ".join((value if isinstance(value, str) else repr(value)).split())
    return text if len(text) <= 100 else f"{text[:97]}..."


# ---- how it is imported

_held: dict[Path, Held] = {}


def _beside(name: str) -> list[ModuleType]:
    """Modules that were executed beside that of a user's file, itself among them."""
    family = name.partition(".")[0]
    if not family.startswith(PREFIX):
        return []
    return [m for key, m in list(sys.modules.items()) if key.startswith(f"{family}.") and getattr(m, "__file__", None)]


def _is_family(name: str) -> bool:
    """Whether a module is the package of a user's file."""
    return name.startswith(PREFIX) and hasattr(sys.modules.get(name), "files") and "." not in name


def _content(file: str) -> bytes:
    try:
        return Path(file).read_bytes()
    except OSError:
        return b""


def _executed(path: Path, file: Path, files: dict[str, bytes]) -> ModuleType:
    """Module of a file; it and those that it imports from beside it, now or later, write their texts to `files`."""
    try:
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise OwnFileError(f"{path}: {(error.strerror or str(error)).lower()}") from None
    except UnicodeDecodeError:
        raise OwnFileError(f"{path} is not a text") from None
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise OwnFileError(f"{path}, line {line}: a byte that is zero, which no text has; save the file as UTF-8")
    family = f"{PREFIX}{hashlib.sha256(str(file).encode()).hexdigest()[:16]}"
    for name in [name for name in sys.modules if name == family or name.startswith(f"{family}.")]:
        del sys.modules[name]
    package = sys.modules[family] = ModuleType(family)
    package.__path__ = [str(file.parent)]
    vars(package)["files"] = files
    name = f"{family}.{file.stem.replace('.', '_')}"
    spec = spec_from_loader(name, Loader(name, str(file)))
    assert spec is not None
    module = sys.modules[name] = module_from_spec(spec)
    without_exit()
    guarded(path, lambda: Loader(name, str(file)).exec_module(module))
    return module


class Loader(SourceFileLoader):
    """Loader that executes a file from its text, in a module whose imports look beside the user's file first."""

    def get_code(self, fullname: str) -> CodeType:
        """The compiled text, from no __pycache__."""
        text = self.get_data(self.path)
        vars(sys.modules[fullname.partition(".")[0]])["files"][self.path] = text
        code: CodeType = self.source_to_code(text, self.path)
        return code

    def exec_module(self, module: ModuleType) -> None:
        """Execute the text."""
        family = module.__name__.partition(".")[0]
        imported = _importer(family, Path(sys.modules[family].__path__[0]))
        vars(module)["__builtins__"] = vars(builtins) | {"__import__": imported}
        super().exec_module(module)


class Beside(MetaPathFinder):
    """Finder of the modules beside a user's file, below the package of that file."""

    def find_spec(self, fullname: str, path: Any, target: ModuleType | None = None) -> ModuleSpec | None:
        """Look into the folder anew."""
        if path is None or not fullname.startswith(PREFIX):
            return None
        specs = (FileFinder(folder, (Loader, [".py"])).find_spec(fullname) for folder in path)
        return next((spec for spec in specs if spec is not None), None)


sys.meta_path.insert(0, Beside())


def _importer(family: str, folder: Path) -> Callable[..., Any]:
    def imported(name: str, globals: Any = None, locals: Any = None, names: Any = (), level: int = 0) -> Any:
        first = name.partition(".")[0]
        if level or first == PACKAGE or not (find(name, folder) or find(first, folder)):
            return builtins.__import__(name, globals, locals, names, level)
        found = builtins.__import__(f"{family}.{name}", globals, locals, names, 0)
        return found if names else getattr(found, first)

    return imported
