"""Records of the ledger: claims and readings as written, answers of rules, entries as told.

A claim has named parts, each of which holds, does not, or is open. `direction` and `nearness` are two of them: what
moves the right way may end far off.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

DIRECTION, NEARNESS = "direction", "nearness"


class Status(StrEnum):
    """Status of a claim, of our runs under our readings."""

    HOLDS = "holds"
    IN_PART = "in part"
    NO = "no"
    OPEN = "open"  # cannot be tested here
    NOT_RUN = "not run"  # a Result that its rule reads is not stored


@dataclass(frozen=True)
class Claim:
    """Claim of the paper: where it stands, in our words, and what of it cannot be computed.

    `part`: figure or table; `axis` that it is about; `studies` that its rule reads; `readings` that it hangs on, by
    their names; `reason` and `closes`, which datum would close it if it is open, in words;
    `timed`: its numbers are those of a machine.
    """

    id: str
    where: str
    part: str
    claim: str
    studies: tuple[str, ...] = ()
    axis: str = ""
    readings: tuple[str, ...] = ()
    reason: str = ""
    closes: str = ""
    timed: bool = False


@dataclass(frozen=True)
class Reading:
    """Reading of what the paper leaves open: `key` of a rule's input with its usual value and the others, if any."""

    id: str
    name: str
    paper: str
    ours: str
    changes: str
    key: str = ""
    usual: Any = None
    others: tuple[Any, ...] = ()


class NotStoredError(Exception):
    """Error of a rule that reads a Result which is not there; names the study."""

    status = Status.NOT_RUN


class NotFinishedError(NotStoredError):
    """Error of a rule that reads a number of runs which failed; names the study."""

    status = Status.OPEN


@dataclass(frozen=True)
class Answer:
    """Answer of a rule: its parts, numbers from Results, and crowding of runs whose heaps are too small."""

    parts: Mapping[str, bool | None]
    numbers: Mapping[str, float] = field(default_factory=dict)
    crowded: Mapping[str, float] = field(default_factory=dict)

    @property
    def status(self) -> Status:
        """Status by the parts; those that are open leave a claim in part at best, unless none is decided."""
        found = set(self.parts.values())
        if found <= {None}:
            return Status.OPEN
        if found == {True}:
            return Status.HOLDS
        return Status.IN_PART if True in found else Status.NO


class Chosen(Mapping[str, Any]):
    """Values of the readings by their keys; `asked` has those that somebody looked at."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self.values_, self.asked = dict(values), set[str]()

    def __getitem__(self, key: str) -> Any:
        self.asked.add(key)
        return self.values_[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.values_)

    def __len__(self) -> int:
        return len(self.values_)


@dataclass(frozen=True)
class Under:
    """Status of a claim under another value of a reading, `name` in words."""

    reading: str
    name: str
    value: str
    status: Status
    parts: Mapping[str, bool | None]


@dataclass(frozen=True)
class Entry:
    """Entry of the ledger: a claim, what it comes to, and under which other readings it would come to something else.

    `missing` names the study of a Result that is not there, or has failed; `asked` the readings that its rule looked
    at.
    """

    claim: Claim
    status: Status
    parts: Mapping[str, bool | None] = field(default_factory=dict)
    numbers: Mapping[str, float] = field(default_factory=dict)
    crowded: Mapping[str, float] = field(default_factory=dict)
    under: tuple[Under, ...] = ()
    asked: tuple[str, ...] = ()
    missing: str = ""

    @property
    def hangs(self) -> tuple[str, ...]:
        """Names of the readings under which the status, or a part, is another."""
        found = (one.reading for one in self.under if (one.status, one.parts) != (self.status, self.parts))
        return tuple(dict.fromkeys(found))
