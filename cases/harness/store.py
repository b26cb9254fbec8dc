"""The run store: one folder a study, one Result a run, written atomically; what is stored is not run again.

DIR/study.json           the Study
DIR/runs/<digest>.json   a Result
DIR/runs/<digest>.npz    its arrays, see the case
DIR/runs/<digest>.log    what a solver of somebody else printed
DIR/runs/<digest>.checkpoint   state of a run that is under way, see checkpoint.py
"""

import fcntl
import io
import json
import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from pydantic import TypeAdapter, ValidationError

from mpm_verify.cases.harness.contract import adapters
from mpm_verify.cases.harness.files import replacing
from mpm_verify.cases.harness.invalid import invalid
from mpm_verify.cases.harness.study import FORMAT, Arrays
from mpm_verify.solver.plugins import CASES, available, is_file

HOUR = 3600.0
OTHER = f"{{}} has format {{}}, this version reads {FORMAT}; use another --out folder"
BROKEN = "{} is broken and was left as it is; move it away, and what it held is made again"


class StoreError(Exception):
    """Error of a folder that cannot be read or written; the message is one line that says what to do."""


def make(folder: Path) -> None:
    """Make the folder, if it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"cannot make the study folder {folder}: {error.strerror}; give a writable one with --out"
        ) from error


def case_of(folder: Path) -> str:
    """Case of the study that a folder holds. Raises StoreError where nothing says which."""
    path = folder / "study.json"
    if folder.is_file():
        raise StoreError(f"{folder} is a file; give the folder of a study, such as {folder.parent}")
    try:
        data = json.loads(path.read_bytes())
        case, found = (data.get("case"), data.get("format")) if isinstance(data, dict) else (None, FORMAT)
    except FileNotFoundError as error:
        raise StoreError(f"{folder} is not a study folder: it has no study.json; give the folder of a study") from error
    except (OSError, ValueError, RecursionError) as error:
        raise StoreError(BROKEN.format(path)) from error
    if found != FORMAT:
        raise StoreError(OTHER.format(path, found))
    if is_file(str(case)) and not Path(str(case)).exists():
        raise StoreError(
            f"{path} is of the case in {case}, which is not there any more; put the file back there, or run it where "
            "it is now with another --out"
        )
    if case not in available(CASES) and not is_file(str(case)):
        known = ", ".join(available(CASES))
        raise StoreError(f"{path} is of the case {case}, and this version has {known}; use another --out folder")
    return str(case)


class Disk:
    """Writes of a store, by this process."""

    def make(self, folder: Path) -> None:
        """Make a folder. Raises StoreError."""
        make(folder)

    def write(self, path: Path, data: bytes) -> None:
        """Write a file atomically. Raises StoreError."""
        Store.write(path, data)


class Store:
    """Results of a case on disk below `folder`. Raises StoreError where it cannot be made, read or written."""

    def __init__(self, folder: Path, case: str = "mms", disk: Disk | None = None) -> None:
        self.folder, self.case, self.disk = folder, case, disk or Disk()
        self.runs = folder / "runs"

    def create(self, study: Any) -> None:
        """Make the folder and write study.json; Results already there stay, a broken study.json is not written over."""
        self.disk.make(self.runs)
        for leftover in self.runs.glob(".*"):  # of a process that was killed while it wrote
            with suppress(OSError):
                if time.time() - leftover.stat().st_mtime > HOUR:
                    leftover.unlink()
        if (self.folder / "study.json").exists():
            self.study()
        elif (self.folder / "report.html").exists():
            raise StoreError(f"{self.folder} holds a page of something else; give another --out folder")
        self.disk.write(self.folder / "study.json", self._text(study, adapters(self.case)[0]))

    def study(self) -> Any:
        """Study of this folder."""
        return self._read(self.folder / "study.json", adapters(self.case)[0])

    def put(self, result: Any, arrays: Arrays) -> None:
        """Write arrays, then the Result: the JSON file is what makes a run stored.

        A text among the arrays is a file of its own, with its name as the ending.

        Raises ValueError, and writes nothing, for what could not be read again.
        """
        self.put_files(result.digest, self.files(result, arrays))

    def files(self, result: Any, arrays: Arrays) -> dict[str, bytes]:
        """Contents of the files of a run by their endings, the Result last. Raises ValueError as `put` does."""
        text = self._text(result, adapters(self.case)[1])
        texts = {name: found for name, found in arrays.items() if isinstance(found, str)}
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **{name: found for name, found in arrays.items() if name not in texts})
        more = {f".{name}": found.encode(errors="replace") for name, found in texts.items()}
        return {".npz": buffer.getvalue(), **more, ".json": text}

    def put_files(self, digest: str, files: Mapping[str, bytes]) -> None:
        """Write the files of a run, in their order."""
        path = self.runs / digest
        for ending, content in files.items():
            self.disk.write(path.with_suffix(ending), content)
            if ending == ".npz" and ".log" not in files:
                with suppress(OSError):  # of the run before, where it failed; another machine may write here
                    path.with_suffix(".log").unlink(missing_ok=True)

    def take(self, other: "Store", digest: str) -> None:
        """Write the files of a run that another store of the same case holds."""
        found = {ending: (other.runs / digest).with_suffix(ending) for ending in (".npz", ".log", ".json")}
        self.put_files(digest, {ending: path.read_bytes() for ending, path in found.items() if path.exists()})

    def _text(self, record: Any, adapter: TypeAdapter[Any]) -> bytes:
        """A record as it is stored, with the case that it is of. Raises ValueError for one that cannot be read."""
        try:
            text = json.dumps({"case": self.case} | asdict(record), indent=1).encode()
            adapter.validate_python(json.loads(text))
        except TypeError as error:
            raise ValueError(f"{type(record).__name__} cannot be stored: {error}; write numbers and words") from error
        except ValidationError as error:
            raise ValueError(f"{type(record).__name__} cannot be stored: {invalid(error)}") from None
        return text

    def abandoned(self, study: Any) -> list[str]:
        """Names of the checkpoints that are of no run of the study."""
        known = {run.digest for run in study.runs}
        return sorted(file.name for file in self.runs.glob("[!.]*.checkpoint") if file.stem not in known)

    def log(self, digest: str) -> Path | None:
        """File of what a solver of somebody else printed in that run, if it printed anything."""
        path = self.runs / f"{digest}.log"
        return path if path.is_file() else None

    def get(self, digest: str) -> Any:
        """Stored Result of that digest, None if the run is still to be done."""
        path = self.runs / f"{digest}.json"
        return self._read(path, adapters(self.case)[1]) if path.exists() else None

    def arrays(self, digest: str) -> Arrays:
        """Arrays of that run by name."""
        path = self.runs / f"{digest}.npz"
        try:
            with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
                return {name: stored[name] for name in stored.files}
        except (OSError, ValueError, EOFError, BadZipFile) as error:
            raise StoreError(
                f"cannot read {path}: {error}; delete it and its .json file to run that run again"
            ) from error

    def _read(self, path: Path, adapter: TypeAdapter[Any]) -> Any:
        try:
            data = json.loads(path.read_bytes())
            if data.get("format") != FORMAT:
                raise StoreError(OTHER.format(path, data.get("format")))
            if data.get("case", self.case) != self.case:
                raise StoreError(
                    f"{self.folder} holds the case {data['case']}, not {self.case}; use another --out folder"
                )
            return adapter.validate_python(data)
        except FileNotFoundError as error:
            raise StoreError(
                f"{path.parent} is not a study folder: it has no {path.name}; give the folder of a study"
            ) from error
        except (OSError, ValueError, AttributeError, RecursionError, ValidationError) as error:
            raise StoreError(BROKEN.format(path)) from error

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Hold the folder for this process; another that asks meanwhile gets a StoreError, and not the same runs."""
        self.disk.make(self.runs)
        handle = os.open(self.folder, os.O_RDONLY)  # the folder itself: a file for it would be one more in the study
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            os.close(handle)
            raise StoreError(f"another verify works in {self.folder}; wait for it or give another --out") from error
        except OSError:
            pass  # a file system without locks on folders, such as NFS
        try:
            yield
        finally:
            os.close(handle)

    @staticmethod
    def write(path: Path, data: bytes) -> None:
        """Write a file atomically: a reader sees the old file or the whole new one, whenever the power goes."""
        try:
            with replacing(path) as file:
                file.write(data)
        except OSError as error:
            raise StoreError(f"cannot write {path}: {error.strerror}; results stored before are kept") from error
