"""Running of the studies behind the paper: each into its own folder below one, what any of them holds is not run."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mpm_verify.verify.run import HOUR, Settings, conduct, duration, estimate

if TYPE_CHECKING:
    from mpm_verify.cases.harness.study import Study


def run(made: "Sequence[Study[Any]]", settings: Settings) -> list[int]:
    """Run studies below the folder of the settings, and give their exit codes; their own verdicts decide nothing.

    Raises ValueError for what takes more than an hour, unless it is agreed to.
    """
    from mpm_verify.cases.harness.store import Store
    from mpm_verify.verify.terminal.progress import say

    for study in made:
        shared(study, settings.folder)
    stores = [Store(settings.folder / study.name, study.case) for study in made]
    needed = [estimate(study, store, settings) for study, store in zip(made, stores, strict=True)]
    seconds = sum(each.seconds for each in needed)
    if seconds > HOUR and not (settings.yes or settings.dry_run):
        raise ValueError(
            f"the studies take about {duration(seconds)}; add --yes to run them, or --quick, or --only 4,5"
        )
    codes, left = [], seconds
    for number, (study, each) in enumerate(zip(made, needed, strict=True), 1):
        done = f"{100 * (1 - left / seconds):.0f} % done" if seconds else "all stored"
        say(f"{number} of {len(made)}, {done}: {study.name}, {each.runs} to run, {each.stored} stored")
        shared(study, settings.folder)
        codes.append(conduct(study, replace(settings, folder=settings.folder / study.name, show=silent, yes=True)))
        left -= each.seconds
    return codes


def silent(record: Any, page: Path | None) -> None:
    """Print nothing of a study: the ledger does."""


def shared(study: "Study[Any]", folder: Path) -> None:
    """Take runs of the study that another one below the folder holds."""
    from mpm_verify.cases.harness.store import Store

    mine = Store(folder / study.name, study.case)
    for run in study.runs:
        if (mine.runs / f"{run.digest}.json").exists():
            continue
        for found in folder.glob(f"*/runs/{run.digest}.json"):
            mine.disk.make(mine.runs)
            mine.take(Store(found.parent.parent, study.case), run.digest)
            break
