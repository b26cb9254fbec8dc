"""JSON document of a comparison with references: numbers, codes and sentences.

CI jobs read it: its shape changes only with VERSION. `schema` derives its JSON schema from the records below.
"""

from dataclasses import asdict, dataclass
from typing import Any

from pydantic import TypeAdapter

from mpm_verify.cases.mms.digits.records import AGREES, Against, Agreement, Alike, Compared, Parting
from mpm_verify.cases.mms.digits.reference import Scheme
from mpm_verify.cases.mms.run import QUANTITIES, Run
from mpm_verify.reports.export.document import FailureRow, failure, finite
from mpm_verify.reports.sentences import digits as words
from mpm_verify.solver.failure import Failure

VERSION = 1
EXIT_CODES = {
    Agreement.AGREES: 0,
    Agreement.PARTS: 1,
    Agreement.FEW_DIGITS: 3,
    Agreement.FAILED: 4,
    Agreement.NO_REFERENCE: 4,
}
TOLD = ("solver", "solver_version", "solution", "material", "cells", "ppc", "courant")  # fields of the Run
Numbers = dict[str, float]


@dataclass(frozen=True)
class ReferenceRow:
    """Reference, its rms errors, and the digits in which rms values and particles agree; null without frames."""

    method: str
    stress: str
    transfer: str
    rms: Numbers
    digits: Numbers
    digits_of_particles: Numbers | None


@dataclass(frozen=True)
class FailedRow:
    """Reference that did not come to its end."""

    method: str
    stress: str
    transfer: str
    failure: FailureRow


@dataclass(frozen=True)
class PartingRow:
    """First frame and particle where a quantity parts from the nearest reference."""

    quantity: str
    frame: int
    step: int
    particle: int
    X: list[float]
    difference: float | None
    size: float | None


@dataclass(frozen=True)
class AlikeRow:
    """Reference that agrees in all digits shown, and the stored case that tells the two apart."""

    method: str
    stress: str
    transfer: str
    solution: str
    cells: int
    digits: float


@dataclass(frozen=True)
class Document:
    """Document of a comparison: references, the nearest first; `digits_of_files` are what the files allow."""

    version: int
    solver: str
    solver_version: str
    solution: str
    material: str
    cells: int
    ppc: int
    courant: float
    outcome: Agreement
    exit_code: int
    digits_asked: float
    sentence: str
    more: list[str]
    by_frames: bool
    rms: Numbers
    digits_of_files: Numbers
    references: list[ReferenceRow]
    farther: int
    failed: list[FailedRow]
    partings: list[PartingRow]
    alike: list[AlikeRow]
    failure: FailureRow | None
    log: list[str]
    report: str | None


def document(run: Run, found: Compared, report: str | None = None) -> dict[str, Any]:
    """Content of --json."""
    whole = Document(
        version=VERSION,
        **{name: getattr(run, name) for name in TOLD},
        outcome=found.outcome,
        exit_code=EXIT_CODES[found.outcome],
        digits_asked=AGREES,
        sentence=words.outcome(found),
        more=words.sentences(found),
        by_frames=found.framed,
        rms=found.rms,
        digits_of_files=found.limit,
        references=[reference(one) for one in found.against],
        farther=found.farther,
        failed=[failed(scheme, why) for scheme, why in found.failed.items()],
        partings=[parting(one) for one in found.partings],
        alike=[alike(one) for one in found.alike],
        failure=failure(found.failure) if found.failure else None,
        log=list(found.log.lines),
        report=report,
    )
    row: dict[str, Any] = finite(asdict(whole))
    return row | {"outcome": str(found.outcome)}


def reference(one: Against) -> ReferenceRow:
    """Row of a reference."""
    return ReferenceRow(**asdict(one.scheme), rms=one.rms, digits=one.digits, digits_of_particles=one.particles or None)


def failed(scheme: Scheme, why: Failure) -> FailedRow:
    """Row of a reference that did not come to its end."""
    return FailedRow(**asdict(scheme), failure=failure(why))


def parting(one: Parting) -> PartingRow:
    """Row of a quantity that parts."""
    return PartingRow(**{**asdict(one), "X": list(one.X)})


def alike(one: Alike) -> AlikeRow:
    """Row of a reference that agrees in all digits shown."""
    return AlikeRow(**asdict(one.scheme), solution=one.solution, cells=one.cells, digits=one.digits)


def schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) of the document."""
    whole: dict[str, Any] = TypeAdapter(Document).json_schema(mode="serialization")
    numbers = {
        "type": "object", "additionalProperties": False,
        "properties": {quantity: {"anyOf": [{"type": "number"}, {"type": "null"}]} for quantity in QUANTITIES},
    }  # fmt: skip
    whole["$defs"]["Numbers"] = numbers
    named: dict[str, Any] = {"$ref": "#/$defs/Numbers"}
    rows = whole["$defs"]
    for record, names in ((whole, ("rms", "digits_of_files")), (rows["ReferenceRow"], ("rms", "digits"))):
        record["properties"] |= dict.fromkeys(names, named)
    rows["ReferenceRow"]["properties"]["digits_of_particles"] = {"anyOf": [named, {"type": "null"}]}
    for record in (whole, *(rows[name] for name in rows if "properties" in rows[name])):
        record["additionalProperties"] = False
    whole["properties"] |= {"version": {"const": VERSION}, "exit_code": {"enum": sorted(set(EXIT_CODES.values()))}}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema"} | whole | {"title": "verify compare --json"}
