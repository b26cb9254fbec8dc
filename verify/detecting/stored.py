"""Known answers of store, identity, judged studies and report numbers: what is put in has to come out."""

import json
from dataclasses import replace
from itertools import pairwise
from math import log
from pathlib import Path
from typing import Any

import numpy as np

from mpm_verify.cases.harness import identity
from mpm_verify.cases.harness.analysis import analyse
from mpm_verify.cases.harness.build import Asked, build
from mpm_verify.cases.harness.runner import to_be_done
from mpm_verify.cases.harness.store import Disk, Store, StoreError
from mpm_verify.cases.judging.records import Outcome, ReasonCode
from mpm_verify.cases.mms.recorded import TABLE
from mpm_verify.cases.mms.run import Result, Run

Answer = tuple[str, str]


def first(held: list[tuple[str, bool]]) -> Answer:
    """FAIL with the first that does not hold, or PASS."""
    wrong = next((name for name, holds in held if not holds), "")
    return (str(Outcome.FAIL), wrong) if wrong else (str(Outcome.PASS), "")


def refused(act: Any) -> bool:
    """Whether the store refuses."""
    try:
        act()
    except StoreError:
        return True
    return False


def made(run: Run, errors: dict[str, float], status: Any = "finished") -> Result:
    """Result with these errors in every norm."""
    held = {q: dict.fromkeys(("rms", "max", "final", "printed"), e) for q, e in errors.items()}
    return Result(run=run, digest=run.digest, status=status, errors=held, steps=5, particles=9, dt=0.1)


def store(work: Path) -> Answer:
    """A Result that is put, read, cut, of another format, locked; and names of runs."""
    run = Run(cells=8)
    order: list[str] = []

    class Watched(Disk):
        def write(self, path: Path, data: bytes) -> None:
            order.append(path.suffix)
            super().write(path, data)

    kept, result = Store(work / "kept", disk=Watched()), made(run, {"u": 1.5, "v": 2.0, "F": 3.0, "sigma": 4.0})
    kept.runs.mkdir(parents=True)
    kept.put(result, {"a": np.arange(3.0)})
    path = kept.runs / f"{run.digest}.json"
    same = kept.get(run.digest) == result and kept.arrays(run.digest)["a"].tolist() == [0, 1, 2]
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    cut = refused(lambda: kept.get(run.digest))
    path.write_bytes(whole.replace(b'"format": 2', b'"format": 1'))
    other = refused(lambda: kept.get(run.digest))
    path.unlink()
    with kept.locked():
        locked = refused(lambda: kept.locked().__enter__())
    failed = replace(result, status="failed", errors={})
    theirs = replace(run, solver="true {case} {out}", solver_version="1")
    sources = identity.sources(run, run.plugins)
    return first(
        [
            ("what is put comes out", same),
            ("arrays before the Result", order == [".npz", ".json"]),
            ("a cut Result is refused", cut),
            ("another format is refused", other),
            ("a missing one", kept.get("0") is None),
            ("a second process is refused", locked),
            ("a run without a Result is done", to_be_done(run, None)),
            ("one with a Result is not", not to_be_done(run, result)),
            ("one of ours that failed is not", not to_be_done(run, failed)),
            ("one of somebody else's is", to_be_done(theirs, failed)),
            ("plug-ins count", sources != identity.sources(run, {})),
            ("sources count", identity.digest(run, {}, "a") != identity.digest(run, {}, "b")),
            ("parameters count", run.digest != replace(run, cells=9).digest),
        ]
    )


def recorded(stress: str = "usl") -> dict[int, dict[str, float]]:
    """Recorded errors of CPDI with 4 particles per cell on axis_aligned, read by other means."""
    rows = [line.split(",") for line in TABLE.read_text().splitlines()]
    head = rows[0]
    mine = [dict(zip(head, row, strict=True)) for row in rows[1:] if row[:4] == ["axis_aligned", "cpdi", stress, "4"]]
    return {int(row["cells"]): {q: float(row[q]) for q in ("u", "v", "F", "sigma")} for row in mine}


def studied(study: Any, keep: Store, change: Any = lambda run, errors: errors) -> Any:
    """Analysis of the quick study with recorded errors, changed."""
    table = recorded()
    results = {run.digest: made(run, change(run, dict(table[run.cells]))) for run in study.runs}
    return analyse(study, results, keep)


def judged(work: Path) -> list[tuple[str, bool]]:
    """Whether a study of recorded errors passes, and one of others does not."""
    study, keep = (
        build(Asked("mms", {"method": ("cpdi",), "solution": ("axis_aligned",)}, 1, True), ""),
        Store(work / "judged"),
    )

    def times(quantity: str, factor: float, half: bool | None = None) -> Any:
        def change(run: Run, errors: dict[str, float]) -> dict[str, float]:
            if half is None or half == (run.courant < 0.4):
                errors[quantity] *= factor
            return errors

        return studied(study, keep, change)

    coupled = next(f for f in times("u", 1.5, half=True).findings if f.plan.judged).verdict.reason.code
    return [
        ("recorded errors pass", studied(study, keep).outcome is Outcome.PASS),
        ("the finest cells have half the time step", [run.cells for run in study.runs if run.courant == 0.2] == [32]),
        ("u 2 % high", times("u", 1.02).exit_code == 1),
        ("u 2 % low", times("u", 0.98).exit_code == 1),
        ("v a half high", times("v", 1.5).exit_code == 1),
        ("sigma a half low", times("sigma", 0.5).exit_code == 1),
        ("F 2 % high", times("F", 1.02).exit_code == 1),
        ("an error that depends on the time step", coupled is ReasonCode.TIME_STEP_COUPLED),
    ]


def numbers(work: Path) -> Answer:
    """Numbers of a page and of documents, for a table with known orders."""
    from mpm_verify.reports.export.document import document
    from mpm_verify.reports.export.junit import write_junit
    from mpm_verify.reports.tables import plain
    from mpm_verify.verify.api import judge_table

    cells, errors = (8, 16, 32, 64, 128), (4.4e-2, 1.02e-2, 2.5e-3, 6.25e-4, 1.5625e-4)
    work.mkdir(exist_ok=True)
    file = work / "errors.csv"
    rows = [f"{n},{e!r},{e if n == 128 else ''}" for n, e in zip(cells, errors, strict=True)]
    file.write_text("cells,error,half_dt_error\n" + "\n".join(rows) + "\n")
    done = judge_table(file, 1.0, out=work / "table")
    record = done.record
    row = (told := json.loads(document(record, None, {})))["verdicts"][0]
    orders = [log(a / b, 2) for a, b in pairwise(errors)]
    levels = plain.levels(record, record.findings[0])
    write_junit(work / "junit.xml", record)
    junit = (work / "junit.xml").read_text()
    fine = judge_table(file, 2.0, out=work / "fine")
    return first(
        [
            *judged(work),
            ("outcome", done.outcome == told["outcome"] == row["verdict"] != "PASS"),
            ("exit code", told["exit_code"] == done.exit_code != 0),
            ("expected", row["expected"] == 1.0),
            ("observed", min(orders) < row["observed"] < max(orders)),
            ("local orders", np.allclose(row["local_orders"], orders, atol=1e-9)),
            ("errors of the table", [one["error"] for one in levels] == list(errors)),
            ("orders of the table", np.allclose([one["order"] for one in levels[1:]], orders, atol=1e-9)),
            ("runs", [run["errors"]["error"]["error"] for run in told["runs"]][:4] == list(errors)[:4]),
            ("JUnit", "<failure" in junit or "<skipped" in junit),
            ("a second expectation passes", fine.outcome == "PASS" and fine.exit_code == 0),
        ]
    )
