"""What every study command does: run what is not stored, judge, report, print, and say it in the exit code."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mpm_verify.cases.harness.study import Result, Study

if TYPE_CHECKING:
    from mpm_verify.cases.harness.store import Store

SMALL = 4e7  # cost below which worker processes take longer to start than they save


@dataclass(frozen=True)
class Settings:
    """Where and how a study is run and told."""

    folder: Path
    jobs: int | None = None
    threads: int = 1
    json_output: bool = False
    junit: Path | None = None
    compare: bool = False  # one table of methods and solutions in place of every error


@contextmanager
def usage() -> Iterator[None]:
    """What is wrong with the input or the store becomes one line and exit code 2."""
    from mpm_verify.cases.harness.runner import RunnerError
    from mpm_verify.cases.harness.store import StoreError

    try:
        yield
    except (ValueError, StoreError, RunnerError) as error:
        raise typer.TyperException(str(error)) from error
    except MemoryError as error:
        raise typer.TyperException("not enough memory; try fewer cells or --jobs 1; stored runs are kept") from error
    except OSError as error:
        raise typer.TyperException(f"{error.strerror or error}: {error.filename or ''}") from error


def conduct(study: Study, settings: Settings) -> int:
    """Run, judge, report; returns the exit code."""
    with usage():
        from mpm_verify.cases.harness.store import Store
        from mpm_verify.cases.harness.verdicts import exit_code
        from mpm_verify.reports.export.document import document
        from mpm_verify.reports.export.junit import check_junit, write_junit
        from mpm_verify.reports.frames import Record
        from mpm_verify.reports.pages.mms import render
        from mpm_verify.verify.terminal.output import printing
        from mpm_verify.verify.terminal.overview import show_overview
        from mpm_verify.verify.terminal.table import show

        check_junit(settings.junit)
        store = Store(settings.folder)
        with store.locked():  # before study.json is written: whoever is refused leaves the other's study as it is
            store.create(study)
            results = compute(study, store, settings)
            record = Record(store, study, results, earlier=False)
            found = record.findings
            page = render(settings.folder, record=record)
        if settings.junit:
            write_junit(settings.junit, study, found)
        with printing():
            if settings.json_output:
                typer.echo(document(study, found, results, page))
            elif settings.compare:
                show_overview(record, page)
            else:
                show(study, found, page)
    return exit_code(found)


def compute(study: Study, store: "Store", settings: Settings) -> dict[str, Result]:
    """The Results of the study; in this process if there is little to do or one job is asked for."""
    from mpm_verify.cases.harness.runner import InProcess, Ticker, cost, pending, process_pool, run_study
    from mpm_verify.verify.terminal.progress import progress

    waiting = pending(study, store)
    jobs = min(settings.jobs or max(1, (os.cpu_count() or 1) // settings.threads), max(1, len(waiting)))
    with progress(waiting, cost) as bar:
        if jobs > 1 and sum(map(cost, waiting)) > SMALL:
            with process_pool(jobs) as (executor, heard):

                def poll() -> None:
                    bar.hear(heard())
                    import_module("mpm_verify.reports.pages.mms")  # takes a second, now that the workers are busy

                return run_study(study, store, executor, settings.threads, bar.done, poll)
        Ticker.tell = staticmethod(lambda news: bar.hear([news]))
        return run_study(study, store, InProcess(), settings.threads, bar.done)
