"""Time levels of an answer, as its result.json states them."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mpm_verify.solver.failure import FailureKind, RunFailed

LEVELS = {"v_lag": 0.5, "F_lag": 0.0}  # steps that v and F with sigma are behind x, where result.json does not say


@dataclass(frozen=True)
class Levels:
    """Time levels of an answer: steps that v, and F with sigma, are behind x; and what it calls its version."""

    v_lag: float = LEVELS["v_lag"]
    F_lag: float = LEVELS["F_lag"]
    version: str = ""


def levels(out: Path) -> Levels:
    """Time levels that result.json tells; the usual ones where there is no such file. Raises RunFailed."""
    path = out / "result.json"
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return Levels()
    except (OSError, ValueError, RecursionError):
        raise RunFailed(FailureKind.UNREADABLE, -1, names={"file": path.name}) from None
    return stated(data, path.name)


def stated(data: Any, file: str) -> Levels:
    """Time levels of a mapping. Raises RunFailed for what is none."""
    try:
        told = {key: float(data[key]) for key in LEVELS if key in data}
        if not all(abs(lag) <= 2 for lag in told.values()):
            raise ValueError
        return Levels(**told, version=str(data.get("version", ""))[:80])
    except (ValueError, TypeError, AttributeError):
        raise RunFailed(FailureKind.UNREADABLE, -1, names={"file": file}) from None
