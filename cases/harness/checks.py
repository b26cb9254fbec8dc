"""An examination: curves that were computed of one thing, and numbers of them that are held against what is known.

DIR/examination.json   the Examination without its curves
DIR/curves.npz         each column of each curve as `curve/column`
"""

import io
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from math import isfinite
from pathlib import Path
from typing import Any, Literal
from zipfile import BadZipFile

import numpy as np
from pydantic import TypeAdapter, ValidationError

from mpm_verify.cases.harness.store import Store, StoreError, make
from mpm_verify.cases.judging.records import Outcome
from mpm_verify.solver.failure import Failure
from mpm_verify.solver.state import Floats

FORMAT = 2
Way = Literal["relative", "absolute", "at least", "at most"]
Curves = dict[str, dict[str, Floats]]
BROKEN = (
    OSError,
    EOFError,
    ValueError,
    AttributeError,
    RecursionError,
    NotImplementedError,
    ValidationError,
    BadZipFile,
)


@dataclass(frozen=True)
class Check:
    """A number `found` and what it is held against.

    `way`: found within `within` of `expected`, as a share of it or absolutely, or a bound that `expected` is. A number
    that is not finite is an ERROR. `source` says where the expectation comes from, `group` which part it belongs to.
    """

    group: str
    name: str
    found: float
    expected: float
    way: Way
    source: str
    within: float = 0.0
    failure: Failure | None = None  # what ended the run that has no number to hold

    @property
    def miss(self) -> float:
        """Distance of found from expected, as a share of it where that is how it is held."""
        distance = abs(self.found - self.expected)
        return distance / abs(self.expected) if self.way == "relative" else distance

    @property
    def outcome(self) -> Outcome:
        """PASS, FAIL, or ERROR where there is no number."""
        if not isfinite(self.found):
            return Outcome.ERROR
        if self.way == "at least":
            return Outcome.PASS if self.found >= self.expected else Outcome.FAIL
        if self.way == "at most":
            return Outcome.PASS if self.found <= self.expected else Outcome.FAIL
        return Outcome.PASS if self.miss <= self.within else Outcome.FAIL


@dataclass(frozen=True)
class Remark:
    """A finding without words: its code, `case.what`, its numbers and names, and the group of checks that it is of.

    Without a group it is of the whole. reports/sentences makes the words.
    """

    code: str
    numbers: Mapping[str, float | str] = field(default_factory=dict)
    group: str = ""


@dataclass(frozen=True)
class Examination:
    """What one command examined: checks, and as `findings` what came out and what one should know of each group.

    `origins`: by parameter, a code for where its value comes from or what it does, `case.what` too.
    """

    name: str
    title: str
    command: str
    findings: tuple[Remark, ...]
    checks: tuple[Check, ...]
    parameters: dict[str, float | str] = field(default_factory=dict)
    origins: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str] = field(default_factory=dict)
    curves: dict[str, Any] = field(default_factory=dict, compare=False)  # Curves; pydantic knows no arrays
    remarks: tuple[str, ...] = ()
    format: int = FORMAT

    @property
    def outcome(self) -> Outcome:
        """The worst of its checks; INCONCLUSIVE where there are none."""
        found = {check.outcome for check in self.checks}
        worst = (Outcome.ERROR, Outcome.FAIL, Outcome.PASS)
        return next((outcome for outcome in worst if outcome in found), Outcome.INCONCLUSIVE)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the parts, in their order."""
        noted = [finding.group for finding in self.findings if finding.group]
        return tuple(dict.fromkeys([*(check.group for check in self.checks), *noted]))


ADAPTER: TypeAdapter[Examination] = TypeAdapter(Examination)


def save(folder: Path, examination: Examination) -> None:
    """Write both files, curves first, each atomically. Raises StoreError."""
    columns = {f"{name}/{key}": values for name, curve in examination.curves.items() for key, values in curve.items()}
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **columns)
    text = json.dumps(asdict(replace(examination, curves={})), indent=1)
    make(folder)
    Store.write(folder / "curves.npz", buffer.getvalue())
    Store.write(folder / "examination.json", text.encode())


def load(folder: Path) -> Examination:
    """The examination that a folder holds. Raises StoreError."""
    path = folder / "examination.json"
    try:
        data: Any = json.loads(path.read_bytes())
        if data.get("format") != FORMAT:
            raise StoreError(f"{path} has format {data.get('format')}, this version reads {FORMAT}")
        with (folder / "curves.npz").open("rb") as file, np.load(file, allow_pickle=False) as stored:
            curves: Curves = {}
            for key in stored.files:
                name, _, column = key.rpartition("/")
                curves.setdefault(name, {})[column] = stored[key]
        return replace(ADAPTER.validate_python(data), curves=curves)
    except FileNotFoundError as error:
        raise StoreError(f"{folder} holds no examination: {Path(error.filename).name} is missing") from error
    except BROKEN as error:
        raise StoreError(f"{path} or its curves are broken and were left as they are; run it again") from error
