"""Exact solution of two specifications, and its audit: derived once for what they stand for, and kept on disk."""

import json
from dataclasses import asdict
from functools import cache
from typing import Any

from mpm_verify.cases.harness.identity import identity
from mpm_verify.mms.blind_spots import BlindSpot, BlindSpotCode
from mpm_verify.mms.manufacture import Manufactured, manufacture
from mpm_verify.mms.printed import folder
from mpm_verify.solver.cache_folder import kept
from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create, is_file

Names = tuple[str, str]


def manufactured(solution: str, material: str) -> Manufactured:
    """Exact solution, made once in a process for what the specifications now stand for."""
    return _manufactured(solution, material, _now(solution, material))


def audited(solution: str, material: str) -> tuple[BlindSpot, ...]:
    """Findings of the audit, once in a process for what the specifications now stand for."""
    return _audited(solution, material, _now(solution, material))


def _now(solution: str, material: str) -> Names:
    return identity(SOLUTIONS, solution), identity(MATERIALS, material)


def _named(solution: str, material: str, now: Names) -> str:
    """Name of all that is derived: the specifications, with their parameters, and what they stand for.

    Empty where a user's file is among them: it may return something else when it is asked again.
    """
    return "" if is_file(solution) or is_file(material) else " ".join((solution, material, *now))


@cache
def _manufactured(solution: str, material: str, now: Names) -> Manufactured:
    model: Any = create(MATERIALS, material)
    return manufacture(create(SOLUTIONS, solution), model, model.rho0, _named(solution, material, now))


@cache
def _audited(solution: str, material: str, now: Names) -> tuple[BlindSpot, ...]:
    name = _named(solution, material, now)
    if not name:
        return _audit(solution, material)
    where = folder(name, "mpm_verify.mms.audit")
    text = kept(where, "blind_spots", lambda: json.dumps([asdict(spot) for spot in _audit(solution, material)]))
    return tuple(BlindSpot(BlindSpotCode(spot["code"]), spot["blind"], spot["numbers"]) for spot in json.loads(text))


def _audit(solution: str, material: str) -> tuple[BlindSpot, ...]:
    from mpm_verify.mms.audit import audit

    return audit(manufactured(solution, material), create(SOLUTIONS, solution), create(MATERIALS, material)).spots
