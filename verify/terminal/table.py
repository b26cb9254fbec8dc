"""Refinement study on a terminal: errors and local orders, the verdicts with their reasons, the path of the report."""

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from math import log
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from rich.text import Text

from mpm_verify.cases.harness.axes import middle
from mpm_verify.cases.harness.study import QuantityPlan
from mpm_verify.cases.harness.verdicts import Finding
from mpm_verify.cases.judging.fit import local
from mpm_verify.cases.judging.stall import Stall
from mpm_verify.reports import words
from mpm_verify.reports.components.audited import edges, unseen
from mpm_verify.reports.components.logs import failed
from mpm_verify.reports.frames import Record
from mpm_verify.reports.sentences import commands, controls, own_solver, stalls, verdicts
from mpm_verify.reports.sentences.headline import badge, headline
from mpm_verify.solver.plugins import label
from mpm_verify.verify.terminal import logs

STYLES = {"PASS": "bold green", "FAIL": "bold red", "INCONCLUSIVE": "bold yellow", "ERROR": "bold magenta"}
MET = "bold blue"  # a registered non-convergence that was seen
ALWAYS = ("u", "rms")
SAME = "the same"  # as the level above, that failed


class Listened(Console):
    """Console that leaves a closed pipe to verify.output: Rich would end the program with the exit code of a FAIL."""

    def on_broken_pipe(self) -> None:
        """Tell the caller."""
        raise BrokenPipeError


def listened(width: int = 100) -> Listened:
    """Console of standard output, as wide as the terminal is, and at least `width` columns where there is none."""
    out = Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, width)
    return out


def bare() -> Table:
    """Table without lines, its heads dim."""
    return Table(box=None, pad_edge=False, header_style="dim")


def show(record: Record, page: Path | None, console: Console | None = None) -> None:
    """Print to standard output, as wide as the terminal is and 100 columns where there is none."""
    study, found = record.study, record.findings
    out = console or Listened(highlight=False, soft_wrap=False)
    if not out.is_terminal:
        out.width = max(out.width, 100)
    out.print(f"\n[bold]{study.title}[/bold]")
    if told := headline(record):
        out.print(told)
    shown = [f for f in found if f.counts or f.plan.run.given or (f.plan.quantity, f.plan.norm) == ALWAYS]
    out.print(errors_table(record, shown))
    if (most := max((len(level.errors) for f in found for level in f.levels), default=1) - 1) > 0:
        given = any(f.plan.run.given for f in found)
        how = "" if given else ", each with other positions of the particles"
        out.print(f"errors are geometric means of up to {most + 1} runs{how}")
    for finding in found:
        if finding.counts:
            verdict(out, record, finding)
    logs.show(out, failed(record))
    if beside := verdicts.beside(found):
        out.print(f"\n{beside}", style="dim")
    if spoilt := record.analysis.controls:
        loose = not all(one.refused for one in spoilt)
        out.print(f"\n{controls.sentence(spoilt)}", style=STYLES["INCONCLUSIVE"] if loose else "dim")
    if moving := edges(record, record.solutions):
        out.print(f"\nEdges: {moving}", style="dim", markup=False)
    finished = any(result.status == "finished" for result in record.results.values())
    if finished and (blind := unseen(record)):
        out.print(f"\nNot seen here: {blind}", style="dim", markup=False)
    for finding in found:
        if finding.stall:
            out.print(stall(record, finding, finding.stall))
    lines = own_solver.hints(record.results.values())
    for line in [*lines, *filter(None, [own_solver.starts(by_start(record)), own_solver.walls(by_walls(record))])]:
        out.print(f"HINT  {line}", markup=False)
    if levels := commands.levels(study, found, record.store.folder):
        out.print(f"  this would tell which time levels it needs: {levels}", soft_wrap=True, markup=False)
    if free := commands.walls(study, found, record.store.folder):
        out.print(f"  this would tell whether its walls are why: {free}", soft_wrap=True, markup=False)
    if not any(f.counts for f in found):
        hint = commands.unregistered(study)
        out.print(f"INCONCLUSIVE: nothing here has a registered expectation, so nothing is judged{hint}.")
    where(out, page, "\nMore quantities and norms, figures, and how it was made:")


def by_start(record: Record) -> dict[str, float]:
    """Last local order of u by start, of a solver of somebody else that was given time levels by force."""
    found: dict[str, float] = {}
    for series in (one for one in record.series if getattr(one.first, "start", "")):
        errors = record.errors(series, "u", "rms")
        if len(errors) > 1:
            (coarse, e), (fine, f) = errors[-2:]
            found[series.first.start] = log(e / f) / log(fine.cells / coarse.cells)
    return found


def by_walls(record: Record) -> dict[bool, float]:
    """Least of the last local orders of u of a solver of somebody else, on solutions with walls and without."""
    found: dict[bool, float] = {}
    for finding in record.findings:
        run, orders = finding.plan.run, finding.verdict.local_orders
        if getattr(run, "solver", "") and (finding.plan.quantity, finding.plan.norm) == ALWAYS and orders:
            held = commands.has_walls(run.solution)
            found[held] = min(orders[-1], found.get(held, orders[-1]))
    return found


def where(out: Console, page: Path | None, words: str = "") -> None:
    """Say where the page is, or how to draw it."""
    if page:
        out.print(words)
        out.print(f"report: {page}", soft_wrap=True)


def errors_table(record: Record, found: Sequence[Finding]) -> Table:
    """Table of error, local order and crossings at each cell count; a failed run by its reason."""
    table = bare()
    names = {"ppc": "per cell"} | {"quantity": "quantity", "cells": "cells"}
    heads = [*columns(record, found[0].plan), "quantity", record.by] if found else ["quantity", "cells"]
    for name in heads:
        table.add_column(names.get(name, name), justify="right" if name in ("ppc", "cells", "h") else "left")
    given = any(finding.plan.run.given for finding in found)  # nothing moves through a grid of ours
    for name in ("error", "order", *(() if given else ("crossings",))):
        table.add_column(name, justify="right")
    table.add_column("")
    for finding in found:
        for *cells, faces, why in rows(record, finding):
            table.add_row(*cells, *(() if given else (faces,)), why)
    return table


def columns(record: Record, plan: QuantityPlan[Any]) -> dict[str, str]:
    """Names of a refinement by column, the solution only where there are several."""
    found = {name: label(str(value)) for name, value in record.columns(plan.run).items()}
    return found if len(record.solutions) > 1 else {name: text for name, text in found.items() if name != "solution"}


def rows(record: Record, finding: Finding) -> Iterator[tuple[str, ...]]:
    """Rows, one for each level; names once a block."""
    plan = finding.plan
    last: tuple[float, float] | None = None
    first: tuple[str, ...] = (*columns(record, plan).values(), words.measured(plan, " "))
    above = ""
    for level, passed in zip_longest(finding.levels, finding.crossings):
        cells, faces = record.named(level.h), "" if passed is None else f"{passed:.1f}"
        if level.ended:
            why = verdicts.ended(level.ended)
            yield (*first, cells, "-", "", faces, SAME if why == above else why)
            above = why
        else:
            here = (level.h, middle(level.errors))
            yield (*first, cells, f"{here[1]:.3e}", order(local([last, here])[0] if last else None), faces, "")
            last = here
        first = ("",) * len(first)


def order(slope: float | None) -> str:
    """Local order in words; empty where an error is zero."""
    return "" if slope is None else f"{slope:.2f}"


def verdict(out: Console, record: Record, finding: Finding) -> None:
    """Print the verdict in words, and the command that would decide on a line of its own, to be copied whole."""
    out.print(sentence(record, finding))
    if deciding := commands.decides(record.study, finding, record.store.folder):
        out.print(f"  this would decide: {deciding}", soft_wrap=True, markup=False)


def sentence(record: Record, finding: Finding) -> Text:
    """Verdict in words."""
    plan, v = finding.plan, finding.verdict
    said = badge(finding)
    expected = f", {verdicts.expected(plan.expectation)} expected" if plan.expectation and said == v.outcome else ""
    text = Text(f"\n{said}", STYLES[v.outcome] if said == v.outcome else MET)
    text.append(f"  {named(record, plan)}{expected}: {verdicts.said(v.reason)}.", "not bold default")
    return text


def named(record: Record, plan: QuantityPlan[Any]) -> str:
    """Subject of a sentence: the method, what else names its refinement, and the quantity."""
    names = columns(record, plan)
    method, solution, ppc = (names.pop(key, "") for key in ("method", "solution", "ppc"))
    rest = [f"{name} {value}" for name, value in names.items()] + [f"{ppc} per cell"] * bool(ppc)
    return ", ".join([f"{method}{f' on {solution}' if solution else ''}", *rest, words.measured(plan)])


def stall(record: Record, finding: Finding, found: Stall) -> Text:
    """Stall in words: where the order falls and what explains it; what does not is in the report."""
    text = Text("\nSTALL", "bold")
    text.append(f"  {named(record, finding.plan)}: {stalls.where(found)}. ", "not bold default")
    text.append(" ".join(stalls.reasons(found)), "not bold default")
    return text
