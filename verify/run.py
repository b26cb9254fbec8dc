"""Way from a study to an exit code, the only one: run what is not stored, judge, draw, export, print."""

import os
import shlex
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import KW_ONLY, dataclass, fields, replace
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from mpm_verify.verify.exits import DEFECT, USAGE

if TYPE_CHECKING:
    from mpm_verify.cases.harness.build import Asked
    from mpm_verify.cases.harness.cluster import Cluster
    from mpm_verify.cases.harness.study import Study
    from mpm_verify.reports.frames import Record

SMALL = 4e7  # cost below which worker processes take longer to start than they save
HOUR = 3600.0
CHECKPOINT = 10.0  # minutes between two checkpoints of a run that can go on from one
UPDATES = 3e6  # particle updates a second of one process, on the slow side
PARTICLE, NODE, PROCESS = 500.0, 200.0, 3e8  # bytes: of a particle, of a node, of a process
NOT_REPEATED = ("--out", "--junit", "--json", "--jobs", "--threads", "--summary", "--page", "--no-page", "--yes",
                "--dry-run", "--vtk", "--no-vtk", "--checkpoint",
                "--dask")  # fmt: skip
NO_WORKERS = "no worker is there yet; the runs wait for one, Ctrl-C stops"
VALUED = ("--dask", "--out", "--junit", "--jobs", "--threads", "--summary", "--checkpoint")  # of them


@dataclass(frozen=True)
class Settings:
    """Settings of where and how a study is run and told. `show` prints it; the usual is that of the case."""

    folder: Path
    _: KW_ONLY
    jobs: int | None = None
    threads: int = 1
    checkpoint: float = CHECKPOINT  # minutes
    dask: str | None = None  # address of a scheduler, or its file
    json_output: bool = False
    junit: Path | None = None
    summary: Path | None = None
    page: bool | None = None  # None: unless JSON or JUnit are asked for alone, or the study is a quick one
    quick: bool = False
    vtk: bool = False
    dry_run: bool = False
    yes: bool = False
    show: "Callable[[Record, Path | None], None] | None" = None


@contextmanager
def usage() -> Iterator[None]:
    """Turn what is wrong with the input or the store into one line and exit code 2.

    What a user's file prints inside goes to standard error.
    """
    from mpm_verify.cases.harness.runner import RunnerError
    from mpm_verify.cases.harness.store import StoreError
    from mpm_verify.verify.terminal.output import aside

    try:
        with aside():
            yield
    except SystemExit as error:
        raise typer.TyperException(
            f"a file of yours ended the program, with {error.code!r}; a study ends with its own exit code; stored runs "
            "are kept"
        ) from error
    except RunnerError as error:
        raise Ended(str(error), DEFECT if error.defect else USAGE) from error
    except (ValueError, StoreError) as error:
        raise typer.TyperException(str(error)) from error
    except MemoryError as error:
        raise typer.TyperException(
            "not enough memory; try fewer cells or runs at once; stored runs are kept"
        ) from error
    except OSError as error:
        raise typer.TyperException(f"{error.strerror or error}: {error.filename or ''}") from error


class Ended(typer.TyperException):
    """Error of one line on standard error, with an exit code of its own."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.exit_code = code


def conduct(study: "Study[Any]", settings: Settings) -> int:
    """Run, judge, draw, export, print; returns the exit code."""
    with usage():
        from mpm_verify.cases.harness.store import Store
        from mpm_verify.reports.export.junit import writable
        from mpm_verify.reports.frames import Record

        check_count(settings.jobs, "--jobs")
        check_count(settings.threads, "--threads")
        check_minutes(settings.checkpoint)
        if settings.dry_run:
            return told_plan(study, Store(settings.folder, study.case), settings)
        writable(settings.junit, "--junit")
        writable(settings.summary, "--summary")
        with computing(study, settings) as (store, results):
            record = Record(store, study, results, earlier=False)
            page = draw(record, settings)
        export(record, settings, page)
    code: int = record.analysis.exit_code
    return code


@contextmanager
def computing(study: "Study[Any]", settings: Settings) -> Iterator[tuple[Any, dict[str, Any]]]:
    """Store of a study, held for this process, and its Results: what the folder does not hold is run."""
    from mpm_verify.cases.harness.store import Store

    with cluster(settings) as away:
        store = Store(settings.folder, study.case, away.disk if away else None)
        affordable(study, store, replace(settings, jobs=max(1, away.check())) if away else settings)
        with store.locked():  # before study.json is written: whoever has to wait leaves the other's study as it is
            store.create(study)
            yield store, compute(study, store, settings, away)


@contextmanager
def cluster(settings: Settings) -> "Iterator[Cluster | None]":
    """Cluster that is asked for, None where none is. Raises ValueError where it cannot be reached."""
    if not settings.dask:
        yield None
        return
    if settings.jobs is not None:
        raise ValueError("--jobs is for this machine; leave it out, as with --dask each worker does a run at a time")
    from mpm_verify.cases.harness.cluster import connected

    with connected(settings.dask) as away:
        yield away


def draw(record: "Record", settings: Settings) -> Path | None:
    """Draw the page of the study; None where none is asked for."""
    wanted = settings.page
    if wanted is None:
        wanted = settings.vtk or not (settings.json_output or settings.junit or settings.quick)
    return page_of(record, settings.vtk) if wanted else None


def page_of(record: "Record", vtk: bool = False, **chosen: Any) -> Path:
    """Draw the page of the case: `page` of reports/pages/<case>.py, or what every case can have."""
    module = of_case("reports.pages", record) or import_module("mpm_verify.reports.pages._plain")
    path: Path = module.page(record, vtk=vtk, **chosen)
    return path


def of_case(room: str, record: "Record") -> Any | None:
    """The module of a room that has the name of the record's case, if there is one."""
    name = f"mpm_verify.{room}.{record.study.case}"
    return import_module(name) if record.study.case.isidentifier() and find_spec(name) else None


def export(record: "Record", settings: Settings, page: Path | None) -> None:
    """Write what is asked for, and print."""
    from mpm_verify.verify.terminal.output import aside, printing

    if settings.junit:
        from mpm_verify.reports.export.junit import write_junit

        write_junit(settings.junit, record)
    if settings.summary:
        from mpm_verify.reports.export.summary import markdown

        with settings.summary.open("a", encoding="utf-8") as file:
            file.write(markdown(record))
    text = ""
    if settings.json_output:
        from mpm_verify.reports.export.document import document

        with aside():
            text = document(record, page, more_of(record))
    with printing():
        if text:
            typer.echo(text)
        elif settings.show:
            settings.show(record, page)
        else:
            shown(record, page)


def more_of(record: "Record") -> dict[str, Any]:
    """Additions of a case to its JSON document: `more` of reports/export/<case>.py, if it is there."""
    module = of_case("reports.export", record)
    found: dict[str, Any] = module.more(record) if module else {}
    return found


def shown(record: "Record", page: Path | None) -> None:
    """Print: `show` of verify/terminal/<case>.py, or verdicts and checks as every case has them."""
    if module := of_case("verify.terminal", record):
        module.show(record, page)
        return
    from mpm_verify.verify.terminal import checks, table

    if record.study.plans:
        table.show(record, page)
    if record.analysis.checks:
        checks.show(record, page)


def compute(study: "Study[Any]", store: Any, settings: Settings, away: "Cluster | None" = None) -> dict[str, Any]:
    """Run the study, and give its Results; in this process if there is little to do or one job is asked for."""
    from mpm_verify.cases.harness.runner import InProcess, Ticker, cost, interruptible, pending, process_pool, run_study
    from mpm_verify.reports.sentences.checkpoints import abandoned
    from mpm_verify.verify.terminal.progress import progress, say

    waiting, every = pending(study, store), 60 * settings.checkpoint
    jobs = min(jobs_of(settings), max(1, len(waiting)))
    say(abandoned(store.abandoned(study)) if waiting else "")
    if away and waiting and not away.check():
        say(NO_WORKERS)
    with interruptible(), progress(waiting, cost) as bar:
        if away:
            return run_study(study, store, away.executor, settings.threads, bar.done, lambda: bar.hear(away.heard()),
                             every, away)  # fmt: skip
        if jobs > 1 and sum(map(cost, waiting)) > SMALL:
            with process_pool(jobs, study.case) as (executor, heard):
                done = run_study(
                    study, store, executor, settings.threads, bar.done, lambda: bar.hear(heard()), every=every
                )
                bar.hear(heard())
                return done
        Ticker.tell = staticmethod(lambda news: bar.hear([news]))
        return run_study(study, store, InProcess(), settings.threads, bar.done, every=every)


def jobs_of(settings: Settings) -> int:
    """Number of runs at a time."""
    return settings.jobs or max(1, (os.cpu_count() or 1) // settings.threads)


@dataclass(frozen=True)
class Estimate:
    """Estimate of what a study takes: runs to be done and stored, the largest run, memory in bytes, time in seconds."""

    runs: int
    stored: int
    particles: int
    memory: float
    seconds: float

    def __str__(self) -> str:
        """Estimate in one line."""
        runs = f"{self.runs} run{'s' * (self.runs != 1)} to be done, {self.stored} stored"
        sized = f", up to {self.particles:,} particles" * (self.particles > 1)  # 1: of what has none, or is not known
        return f"{runs}{sized}, about {self.memory / 2**30:.1f} GB of memory and {duration(self.seconds)}"


def estimate(study: "Study[Any]", store: Any, settings: Settings) -> Estimate:
    """Estimate what a study takes before anything runs; times are those of a slow processor."""
    from mpm_verify.cases.harness.runner import pending

    waiting = pending(study, store)
    every = {run.digest for run in study.runs}
    jobs = min(jobs_of(settings), max(1, len(waiting)))
    sizes = sorted((PROCESS + PARTICLE * run.particles + NODE * run.nodes for run in waiting), reverse=True)
    seconds = sum(run.updates for run in waiting) / UPDATES / jobs
    longest = max((run.updates for run in waiting), default=0.0) / UPDATES
    most = max((run.particles for run in waiting), default=0)
    return Estimate(len(waiting), len(every) - len(waiting), most, sum(sizes[:jobs]), max(seconds, longest))


def affordable(study: "Study[Any]", store: Any, settings: Settings) -> None:
    """Raise ValueError for a study that cannot be run, or that takes hours and has no --yes."""
    needed = estimate(study, store, settings)
    if refused := refusal(needed, settings):
        raise ValueError(f"{needed}: {refused}")


def refusal(needed: Estimate, settings: Settings) -> str:
    """Reason why a study is not run, and what to type; empty where it is."""
    there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed.memory > there and not settings.dask:
        return f"this machine has {there / 2**30:.1f} GB; take fewer cells or particles per cell, or --jobs 1"
    if needed.seconds > HOUR and not settings.yes:
        return "add --yes to run it, or --dry-run to see its runs"
    return ""


def told_plan(study: "Study[Any]", store: Any, settings: Settings) -> int:
    """Print the runs of the study and what they take; nothing is run or written."""
    from mpm_verify.verify.terminal.output import printing

    needed = estimate(study, store, settings)
    with printing():
        for run, text in zip(study.runs, told_apart(study.runs), strict=True):
            typer.echo(f"{'stored ' if store.get(run.digest) else 'to do  '} {run.digest}  {text}")
        typer.echo(f"{study.name}: {needed}")
        if refused := refusal(needed, settings):
            typer.echo(f"it would not be run: {refused}")
    return 0


def told_apart(runs: Sequence[Any]) -> list[str]:
    """Texts of runs; where two are the same, each has the values of all fields that vary."""
    texts = [str(run) for run in runs]
    if len(set(texts)) == len(texts):
        return texts
    names = [item.name for item in fields(runs[0]) if len({getattr(run, item.name) for run in runs}) > 1]
    return [", ".join([str(run), *(f"{name}={getattr(run, name)}" for name in names)]) for run in runs]


def duration(seconds: float) -> str:
    """Duration in the unit that people use."""
    for unit, size in (("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{max(1, round(seconds))} s"


def check_count(count: int | None, option: str) -> None:
    """Raise ValueError unless the count is left out or 1 and more."""
    if count is not None and count < 1:
        raise ValueError(f"{option} takes whole numbers from 1 on")


def check_minutes(minutes: float) -> None:
    """Raise ValueError unless it is a time."""
    if not minutes >= 0:
        raise ValueError("--checkpoint takes minutes from 0 on, such as 10, or inf for no checkpoints")


def command() -> str:
    """Command that repeats this one, without what says only where the result goes."""
    kept, skip = [], False
    for argument in sys.argv[1:]:
        name, _, value = argument.partition("=")
        if skip and not argument.startswith("--"):
            skip = False
        elif name in NOT_REPEATED:
            skip = not value and name in VALUED
        else:
            kept.append(argument)
            skip = False
    return "verify " + shlex.join(kept)


def study_of(asked: "Asked", out: Path | None) -> "tuple[Study[Any], Path]":
    """The study that is asked for, and its folder."""
    from mpm_verify.cases.harness.build import named
    from mpm_verify.cases.harness.reuse import study

    folder = folder_of(named(asked), out)
    return study(asked, command(), folder), folder


def named(study: "Study[Any]", out: Path | None) -> Path:
    """Folder of a study: the one asked for, or the usual."""
    return folder_of(study.name, out)


def folder_of(name: str, out: Path | None) -> Path:
    """Folder asked for, or the usual one of that name."""
    return out or Path("results") / name
