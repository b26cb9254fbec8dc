"""Exact solution of two specifications, and its audit: derived once for what they stand for, and kept on disk."""

import json
from dataclasses import asdict
from functools import cache
from typing import Any

from mpm_verify.cases.harness.identity import identity
from mpm_verify.mms.blind_spots import BlindSpot, BlindSpotCode
from mpm_verify.mms.duration import lasting
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.mms.printed import folder
from mpm_verify.solver.cache_folder import kept
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create, is_file

Names = tuple[str, str]


def manufactured(solution: str, material: str, damping: float = 0.0) -> Manufactured:
    """Exact solution, made once in a process for what the specifications now stand for; see mms/damping.py."""
    return _manufactured(solution, material, _now(solution, material), damping)


def audited(solution: str, material: str, periods: float = 0.0) -> tuple[BlindSpot, ...]:
    """Findings of the audit, once in a process for what the specifications now stand for; see mms/duration.py."""
    return _audited(solution, material, _now(solution, material), periods)


def _now(solution: str, material: str) -> Names:
    return identity(SOLUTIONS, solution), identity(MATERIALS, material)


def _named(solution: str, material: str, now: Names) -> str:
    """Name of all that is derived: the specifications, with their parameters, and what they stand for.

    Empty where a user's file is among them: it may return something else when it is asked again.
    """
    return "" if is_file(solution) or is_file(material) else " ".join((solution, material, *now))


@cache
def _manufactured(solution: str, material: str, now: Names, damping: float) -> Manufactured:
    model: Any = create(MATERIALS, material)
    return manufacture(create(SOLUTIONS, solution), model, model.rho0, _named(solution, material, now), damping)


@cache
def _audited(solution: str, material: str, now: Names, periods: float) -> tuple[BlindSpot, ...]:
    name = _named(solution, material, now)
    if not name:
        return _audit(solution, material, periods)
    where = folder(name + f" periods {periods!r}" * bool(periods), "mpm_verify.mms.audit")
    text = kept(where, "blind_spots", lambda: json.dumps([asdict(one) for one in _audit(solution, material, periods)]))
    return tuple(BlindSpot(BlindSpotCode(spot["code"]), spot["blind"], spot["numbers"]) for spot in json.loads(text))


def _audit(solution: str, material: str, periods: float) -> tuple[BlindSpot, ...]:
    from mpm_verify.mms.audit import audit

    body = lasting(create(SOLUTIONS, solution), periods)
    return audit(manufactured(solution, material), body, create(MATERIALS, material)).spots
