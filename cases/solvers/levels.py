"""Time levels of an answer, as its result.json states them."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mpm_verify.cases.solvers.readers import why
from mpm_verify.solver.failure import FailureKind, RunFailed

LAGS = ("v_lag", "F_lag")
FARTHEST = 2.0  # steps that a field may be behind or before x
FORCES = ("start", "end")  # of a step, whose body force it takes


@dataclass(frozen=True)
class Levels:
    """Time levels of an answer: steps that v, and F with sigma, are behind x; and what it calls its version.

    `b` is the end of a step whose body force it takes, start or end; empty where it does not say.
    """

    v_lag: float = 0.5
    F_lag: float = 0.0
    version: str = ""
    b: str = ""

    @property
    def numbers(self) -> dict[str, float]:
        """Steps that v, F and b are behind the end of a step, by name; b only where it is said."""
        b = {"level_b": float(self.b == "start")} if self.b else {}
        return {"level_v": self.v_lag, "level_F": self.F_lag, **b}


USUAL = Levels()  # where nobody says anything


def levels(out: Path, usual: Levels = USUAL) -> Levels:
    """Time levels that result.json tells; the usual ones where it does not, or is not there. Raises RunFailed."""
    path = out / "result.json"
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return usual
    except (OSError, ValueError, RecursionError) as error:
        told = why(path, error) or ({} if isinstance(error, OSError) else {"why": "json"})
        line = {"line": float(getattr(error, "lineno", 1))}
        raise RunFailed(FailureKind.UNREADABLE, -1, numbers=line, names={"file": path.name} | told) from None
    return stated(data, path.name, usual)


def stated(data: Any, file: str, usual: Levels = USUAL) -> Levels:
    """Time levels of a mapping. Raises RunFailed for what is none."""

    def unread(why: str, key: str = "") -> RunFailed:
        numbers = {"farthest": FARTHEST}
        return RunFailed(FailureKind.UNREADABLE, -1, numbers=numbers, names={"file": file, "why": why, "column": key})

    if not isinstance(data, Mapping):
        raise unread("no_object")
    told = {}
    for key in filter(data.__contains__, LAGS):
        try:
            told[key] = float(data[key])
        except (ValueError, TypeError, OverflowError):
            raise unread("lag", key) from None
        if not abs(told[key]) <= FARTHEST:
            raise unread("lag", key)
    b = data.get("b", usual.b)
    if b not in ("", *FORCES):
        raise unread("b")
    return replace(usual, **told, version=str(data.get("version", ""))[:80], b=b)
