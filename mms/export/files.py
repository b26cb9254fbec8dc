"""Files of an exported case as texts: what a solver reads, and values to check its sources with."""

import json
from collections.abc import Mapping

import numpy as np

from mpm_verify.mms.export.case import Exported
from mpm_verify.mms.export.record import content, flat
from mpm_verify.solver.state import Floats

CASE, FLAT, PARTICLES = "case.json", "case.txt", "particles.csv"
FORCE, FIELDS = "selfcheck.csv", "selfcheck_fields.csv"


def files(case: Exported) -> dict[str, str]:
    """Texts of a case by the names of their files."""
    return {
        FLAT: "".join(f"{name} {value}\n" for name, value in flat(case.record)),
        PARTICLES: csv(case.particles), **case.sources,
        **{name: csv(columns) for name, columns in ((FORCE, case.force), (FIELDS, case.fields)) if columns},
        CASE: json.dumps(content(case.record), indent=1) + "\n",
    }  # fmt: skip


def csv(columns: Mapping[str, Floats]) -> str:
    """Text of a table: a header line, then numbers in 17 digits, which are read as the same doubles."""
    rows = np.column_stack(list(columns.values()))
    lines = [",".join(columns), *(",".join(f"{value:.17g}" for value in row) for row in rows)]
    return "\n".join(lines) + "\n"
