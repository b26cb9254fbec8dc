"""JSON document of a comparison with references: numbers, codes and sentences."""

from dataclasses import asdict
from typing import Any

from mpm_verify.cases.mms.digits.records import AGREES, Against, Agreement, Compared
from mpm_verify.cases.mms.run import Run
from mpm_verify.reports.export.document import failure, finite
from mpm_verify.reports.sentences import digits as words

VERSION = 1
EXIT_CODES = {
    Agreement.AGREES: 0,
    Agreement.PARTS: 1,
    Agreement.FEW_DIGITS: 3,
    Agreement.FAILED: 4,
    Agreement.NO_REFERENCE: 4,
}
TOLD = ("solver", "solver_version", "solution", "material", "cells", "ppc", "courant")  # fields of the Run


def document(run: Run, found: Compared, report: str | None = None) -> dict[str, Any]:
    """Content of --json."""
    row: dict[str, Any] = {
        "version": VERSION,
        **{name: getattr(run, name) for name in TOLD},
        "outcome": str(found.outcome),
        "exit_code": EXIT_CODES[found.outcome],
        "digits_asked": AGREES,
        "sentence": words.outcome(found),
        "more": words.sentences(found),
        "by_frames": found.framed,
        "rms": found.rms,
        "digits_of_files": found.limit,
        "references": [reference(one) for one in found.against],
        "farther": found.farther,
        "failed": [{**asdict(scheme), "failure": asdict(failure(why))} for scheme, why in found.failed.items()],
        "partings": [asdict(one) for one in found.partings],
        "alike": [{**asdict(one.scheme), **{key: value for key, value in asdict(one).items() if key != "scheme"}}
                  for one in found.alike],
        "failure": asdict(failure(found.failure)) if found.failure else None,
        "report": report,
    }  # fmt: skip
    whole: dict[str, Any] = finite(row)
    return whole


def reference(one: Against) -> dict[str, Any]:
    """Row of a reference."""
    return {**asdict(one.scheme), "rms": one.rms, "digits": one.digits, "digits_of_particles": one.particles or None}
