"""The public Python API, as `mpm_verify` gives it: derive, run, judge, and load what is stored as pandas frames.

import mpm_verify as mv

exact = mv.manufacture("clamped_shear")                    # fields and body force as NumPy functions
done = mv.study("mms", method=["mpm", "cpdi"], cells=[8, 16, 32, 64], ppc=4, out="results/mine")
done.outcome, done.verdicts                                # "PASS", ...
done.frames()["errors"]                                    # a pandas.DataFrame
mv.judge(cells=[8, 16, 32, 64], errors=[4e-3, 1e-3, 2.5e-4, 6.2e-5], order=2).reason
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd

    from mpm_verify.cases.harness.study import Study
    from mpm_verify.mms.manufacture import Manufactured
    from mpm_verify.reports.frames import Record
    from mpm_verify.verify.comparing import Comparison


def manufacture(solution: str, material: str = "", rho0: float | None = None) -> "Manufactured":
    """Exact fields and body force of a manufactured solution.

    Parameters
    ----------
    solution
        Name of a solution with parameters, `axis_aligned:A=0.01`, or the path of a file of your own.
    material
        Name of a constitutive model that has an energy, with parameters; usual is the solution's own.
    rho0
        Density at reference; usual is that of the material.

    Returns
    -------
    Manufactured
        Functions of reference positions X (P,2) and a time: u, x, v, b (P,2), F, P (P,2,2), sigma (P,4) as xx, yy, zz,
        xy. Of a solution in three dimensions (P,3), (P,3,3), and (P,6), with yz and xz last; in one (P,1), (P,1,1) and
        (P,1); around an axis F and P are (P,5): xx, xy, yx, yy, and zz around.

    Raises
    ------
    ValueError
        With one line for a name, parameter or file that cannot be used.
    """
    from mpm_verify.mms.manufacture import manufacture as derive
    from mpm_verify.solver.plugins import MATERIALS, SOLUTIONS, create

    fields = create(SOLUTIONS, solution)
    model = create(MATERIALS, material or fields.material)
    return derive(fields, model, model.rho0 if rho0 is None else rho0)


def study(
    case: str = "mms",
    *,
    out: Path | str | None = None,
    jobs: int | None = 1,
    threads: int = 1,
    replicates: int = 1,
    quick: bool = False,
    dask: str | None = None,
    checkpoint: float = 10.0,
    **axes: Any,
) -> "StoredStudy":
    """Run a study: what its folder holds is not run again.

    Parameters
    ----------
    case
        Name of a case: mms, column, ... (`verify list`).
    out
        Folder of the study; usual is results/NAME-OF-THE-STUDY.
    jobs, threads
        Runs at a time (processes; None: as many as processors), and threads of each.
    replicates
        Runs of each point of a refinement, with the particles elsewhere in their cells.
    quick
        Whether axes that are not given have the values of `--quick`.
    dask
        Address of a Dask scheduler, or its scheduler file, whose workers do the runs; `jobs` is then not looked at.
    checkpoint
        Minutes between two checkpoints of a run that can go on from one; inf for none.
    **axes
        Fields of the case's Run, one value or a list each, whose product is run. A `solver` may be a Python function
        of a case, see docs/own-solver.md.

    Returns
    -------
    StoredStudy
        The study with its verdicts, as `load` gives it.

    Raises
    ------
    ValueError
        With one line for what cannot be run.
    StoreError
        Where the folder cannot be read or written.
    """
    from mpm_verify.cases.harness.build import Asked, build

    if callable(axes.get("solver")) and dask:
        raise ValueError("a Python function as solver runs in this process; leave dask out, or give a command")
    if callable(axes.get("solver")):
        from mpm_verify.cases.solvers.callables import register

        axes, jobs = {**axes, "solver": register(axes["solver"])}, 1
    values = {key: list(value) if isinstance(value, list | tuple) else [value] for key, value in axes.items()}
    words = [f"{key}={value!r}" for key, value in axes.items()]
    command = f"mpm_verify.study({', '.join([repr(case), *words])})"
    more = {"dask": dask, "checkpoint": checkpoint}
    asked = build(Asked(case, values, replicates, quick), command)
    return conducted(asked, out, jobs=None if dask else jobs, threads=threads, **more)


def conducted(asked: "Study[Any]", out: Path | str | None, **how: Any) -> "StoredStudy":
    """Stored study of one that is asked for: what its folder does not hold is run, as Settings say."""
    from mpm_verify.verify.run import Settings, check_minutes, computing, named

    settings = Settings(named(asked, Path(out) if out else None), yes=True, **{"jobs": 1, **how})
    check_minutes(settings.checkpoint)
    with computing(asked, settings):
        pass
    return load(settings.folder)


def compare(
    solver: "str | Callable[[Any], Any]",
    solution: str = "clamped_shear",
    *,
    material: str = "",
    cells: int = 16,
    ppc: int = 4,
    courant: float = 0.4,
    method: Sequence[str] = (),
    stress: Sequence[str] = (),
    transfer: Sequence[str] = (),
    stored: bool = False,
    threads: int = 1,
    time_limit: float = 600.0,
) -> "Comparison":
    """Hold a solver of your own against runs of the reference, digit by digit, as `verify compare` does.

    Parameters
    ----------
    solver
        Command such as './mine {case} {out}', or a Python function of a case, see docs/own-solver.md.
    solution, material, cells, ppc, courant
        Case that both run.
    method, stress, transfer
        References: every combination of these bases, stress updates and transfers; empty: the usual ones.
    stored
        Whether stored rms values are enough, and no reference is run.
    threads
        Threads of a run of the reference.
    time_limit
        Seconds that the solver may take.

    Returns
    -------
    Comparison
        The nearest reference, digits that agree by quantity, where the two part, and the page.

    Raises
    ------
    ValueError
        With one line for what cannot be run.
    """
    from mpm_verify.verify.comparing import Comparison, examined_of, run_of, schemes_of

    run = run_of(solver, solution, material, cells=cells, ppc=ppc, courant=courant, time_limit=time_limit)
    found = examined_of(run, schemes_of(method, stress, transfer), stored, threads)
    name = getattr(solver, "__qualname__", repr(solver))
    return Comparison(found, f"mpm_verify.compare({name}, {solution!r}, cells={cells})")


def load(folder: Path | str) -> "StoredStudy":
    """Read a stored study, whoever ran it.

    Parameters
    ----------
    folder
        Folder of a study: `--out` of a command, or `out` of `study`.

    Returns
    -------
    StoredStudy
        The study with its verdicts, checks and tables.

    Raises
    ------
    StoreError
        For a folder that does not hold a study, or a broken one.
    """
    from mpm_verify.reports.frames import read

    return StoredStudy(read(Path(folder)))


@dataclass(frozen=True)
class StoredStudy:
    """Study with its results, as they are stored.

    Parameters
    ----------
    record
        What the folder holds.
    """

    record: "Record"

    @property
    def outcome(self) -> str:
        """PASS, FAIL, INCONCLUSIVE or ERROR: the worst of all that is judged."""
        return str(self.record.analysis.outcome)

    @property
    def exit_code(self) -> int:
        """Exit code of the command that runs the same."""
        return self.record.analysis.exit_code

    def check(self) -> None:
        """Raise AssertionError with the sentences of what is not a PASS, for a test of your own."""
        if self.outcome == "PASS":
            return
        from mpm_verify.verify.terminal import checks, table

        said = [table.sentence(self.record, f).plain.strip() for f in self.record.findings if f.counts]
        said += [checks.sentence(one) for one in self.record.analysis.checks if one.outcome != "PASS"]
        raise AssertionError("\n".join([f"{self.record.study.title}: {self.outcome}", *said]))

    @property
    def verdicts(self) -> list[dict[str, Any]]:
        """Rows of the judged quantities, as in the JSON document."""
        from mpm_verify.reports.export.document import verdict

        return [verdict(self.record, found) for found in self.record.findings if found.counts]

    @property
    def checks(self) -> list[dict[str, Any]]:
        """Rows of the checks, as in the JSON document."""
        from dataclasses import asdict

        from mpm_verify.reports.export.document import check_row

        return [asdict(check_row(check)) for check in self.record.analysis.checks]

    def frames(self) -> "dict[str, pd.DataFrame]":
        """Make the tables of the study.

        Returns
        -------
        dict of str to pandas.DataFrame
            By name: runs, and of refinements errors, orders, verdicts and more, with full digits.
        """
        from mpm_verify.reports.tables import plain
        from mpm_verify.verify.run import of_case

        tables = of_case("reports.tables", self.record) or plain
        made: dict[str, pd.DataFrame] = tables.frames(self.record)
        return made

    def page(self) -> Path:
        """Draw the HTML page.

        Returns
        -------
        Path
            The page, report.html in the folder of the study.

        Raises
        ------
        StoreError
            Where the page cannot be written.
        """
        from mpm_verify.verify.run import page_of

        return page_of(self.record)

    def __repr__(self) -> str:
        runs = f"{len(self.record.results)} runs in {self.record.store.folder}"
        return f"<{self.record.study.title}: {self.outcome}, {runs}>"


@dataclass(frozen=True)
class Judgement:
    """Verdict of the order rule on a list of errors.

    Parameters
    ----------
    outcome
        PASS, FAIL, INCONCLUSIVE or ERROR.
    reason
        Sentence that says what decided, and which run would decide where nothing does.
    order, interval
        Fitted order and its 95 % interval; None with fewer than three levels.
    local_orders
        Orders between consecutive levels, coarse to fine.
    """

    outcome: str
    reason: str
    order: float | None
    interval: tuple[float, float] | None
    local_orders: tuple[float, ...]

    @property
    def passed(self) -> bool:
        """Whether the evidence shows the expected order."""
        return self.outcome == "PASS"


def judge(
    cells: Sequence[int],
    errors: Sequence[float],
    order: float = 2.0,
    *,
    below: float = 0.2,
    above: float = 0.3,
    floor: float = 0.0,
    dt_halved: float | None = None,
) -> Judgement:
    """Judge errors of a refinement by the order rule.

    Parameters
    ----------
    cells
        Cells along a side, one number a level, in any order; the cell size is one over it.
    errors
        The error of each level in one norm, not negative.
    order, below, above
        Expected order, and how far below and above it the whole interval may lie.
    floor
        Round-off floor of the quantity.
    dt_halved
        Error of the finest level with half the time step; None if there is no such run, which leaves PASS open.

    Returns
    -------
    Judgement
        Its `reason` is a sentence.

    Raises
    ------
    ValueError
        For lists of different lengths, two levels of the same size, or a band without width.
    """
    from mpm_verify.cases.judging.order import Expectation, Level
    from mpm_verify.cases.judging.order import judge as rule
    from mpm_verify.reports.sentences.verdicts import reason

    if len(cells) != len(errors):
        raise ValueError(f"{len(cells)} cells and {len(errors)} errors; give one error for each level")
    levels = [Level(1 / n, (float(error),)) for n, error in zip(cells, errors, strict=True)]
    found = rule(levels, Expectation(order, below, above), floor=floor, dt_halved=dt_halved)
    return Judgement(str(found.outcome), reason(found.reason), found.observed, found.interval, found.local_orders)


def judge_table(
    file: Path | str,
    order: float | None = None,
    *,
    below: float = 0.2,
    above: float = 0.3,
    floor: float = 0.0,
    exact: bool = True,
    steady: bool = False,
    out: Path | str | None = None,
) -> "StoredStudy":
    """Judge a table of any code by the order rule, as `verify judge` does.

    Parameters
    ----------
    file
        CSV, TSV or JSON file with the columns cells or h, and error; method, quantity, replicate and half_dt_error if
        it has them.
    order, below, above
        Expected order, and how far below and above it the whole interval may lie; without an order nothing is judged.
    floor
        Round-off floor of the numbers, in their unit.
    exact
        Whether the numbers are errors; otherwise they are values of a quantity, and their errors are estimated.
    steady
        Whether there is no time step.
    out
        Folder of the study; usual is results/judge-NAME.

    Returns
    -------
    StoredStudy
        Its verdicts, tables and page.

    Raises
    ------
    ValueError
        With one line for a file that cannot be read, with the number of the row.
    StoreError
        Where the folder cannot be read or written.

    References
    ----------
    Celik, Ghia, Roache, Freitas, Coleman & Raad (2008), J. Fluids Eng. 130, 078001, doi:10.1115/1.2960953
    """
    from mpm_verify.cases.any_code.table import Expected
    from mpm_verify.verify.commands.any_code import study_of

    expected = Expected(order, below, above, floor, exact, steady)
    return conducted(study_of(Path(file), expected, f"mpm_verify.judge_table({str(file)!r}, {order!r})"), out)
