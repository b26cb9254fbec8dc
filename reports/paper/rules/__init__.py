"""Rules of the ledger, by the claims' names: each computes a claim's parts and numbers from stored Results."""

from collections.abc import Callable, Mapping
from typing import Any

from mpm_verify.reports.paper.evidence import Evidence
from mpm_verify.reports.paper.records import Answer
from mpm_verify.reports.paper.rules import block, column, manufactured, runout, sand

Rule = Callable[[Evidence, Mapping[str, Any]], Answer]
RULES: dict[str, Rule] = {**manufactured.RULES, **block.RULES, **column.RULES, **runout.RULES, **sand.RULES}
