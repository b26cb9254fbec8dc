"""`verify detect`: plant mistakes in a copy of the package, one at a time, and see which checks notice."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mpm_verify.cases.detect.run import Run
from mpm_verify.verify.options import study_command, values

Quick = Annotated[bool, typer.Option("--quick", help="A seventh of the defects, and the checks of a quick study.")]
Mutants = Annotated[int, typer.Option(help="Mutants by generic operators instead of the tables, drawn by --seed.")]
Seed = Annotated[int, typer.Option(help="Seed of --mutants and --blind.")]
Blind = Annotated[bool, typer.Option("--blind", help="Plant one that is not told, and print what the checks answer.")]
Key = Annotated[Path | None, typer.Option(help="File for what --blind has planted, which must not be there.")]
Listed = Annotated[bool, typer.Option("--list", help="Print the defects, and plant none.")]
Certify = Annotated[Path | None, typer.Option(help="Write the certificate of the campaign to this file.")]


def detect(
    asked: dict[str, list[str]],
    quick: bool,
    mutants: int,
    seed: int,
    blind: bool,
    key: Path | None,
    listed: bool,
    certify: Path | None,
    out: Path | None,
    **more: Any,
) -> int:
    """Plant defects and placebos one at a time in a copy of the package, and see which checks notice.

    Neither the installed package nor the user's kernel cache is touched.
    """
    from mpm_verify.verify.run import Settings, conduct, study_of, usage

    if listed:
        return told_list(bool(more.get("json_output")))
    with usage():
        from mpm_verify.cases.harness.build import Asked

        chosen = values(Run, asked)
        if (blind or key) and (mutants or more.get("dry_run")):
            raise ValueError("--blind plants one defect and runs it; leave --mutants and --dry-run out")
        if blind or key:
            return blindly(chosen, seed, blind, key)
        if mutants:
            from mpm_verify.cases.detect.mutate import sampled

            if "defect" in chosen or mutants < 1:
                raise ValueError(f"--mutants {mutants} has to be above 0, and goes without --defect")
            chosen["defect"] = sampled(mutants, seed)
        if certify and quick:
            raise ValueError("--certify is for the full campaign; leave --quick out")
        study, folder = study_of(Asked("detect", chosen, 1, quick), out or named(mutants, seed))
    code = conduct(study, Settings(folder, quick=quick, **{**more, "yes": True}))
    if certify:
        with usage():
            certified(folder, certify)
    return code


def named(mutants: int, seed: int) -> Path | None:
    """Folder of mutants, whose names are many."""
    return Path("results") / f"detect-mutants-{mutants}-{seed}" if mutants else None


def told_list(json_output: bool) -> int:
    """Print the defects of the tables, in lines or as JSON."""
    import json
    from dataclasses import asdict

    from mpm_verify.cases.detect.defect import defects

    if json_output:
        typer.echo(json.dumps([asdict(one) for one in defects().values()], indent=1))
        return 0
    for one in defects().values():
        typer.echo(f"{one.name:28} {one.kind:11} {one.by:12} {one.file}")
    return 0


def blindly(chosen: dict[str, list[Any]], seed: int, blind: bool, key: Path | None) -> int:
    """Plant one defect, placebo or nothing by the seed; print outcomes alone. Exit code 1 where a check noticed."""
    import json
    import random

    from mpm_verify.cases.detect.defect import defects
    from mpm_verify.cases.detect.run import one
    from mpm_verify.cases.harness.build import make
    from mpm_verify.cases.harness.contract import case_named

    if not (blind and key):
        raise ValueError("--blind and --key FILE belong together: what was planted is written there; give both")
    if key.exists():
        raise ValueError(f"--key {key} is there already; give a file that is not")
    if "defect" in chosen:
        raise ValueError("--blind chooses the defect itself; leave --defect out")
    case = case_named("detect")
    name = random.Random(seed).choice(sorted(defects()))
    run = make(case, {"defect": name, **{field: some[0] for field, some in chosen.items()}})
    result, _ = case.execute(run)
    key.write_text(json.dumps({"seed": seed, "method": run.method, **vars(one(name))}, indent=1) + "\n")  # type: ignore[attr-defined]
    for check, outcome in result.outcomes.items():
        typer.echo(f"{outcome:13} {check}")
    noticed = any(outcome not in ("PASS", "NOT_RUN") for outcome in result.outcomes.values())
    typer.echo(f"{'noticed' if noticed else 'nothing noticed'}; what was planted stands in {key}")
    return int(noticed)


def certified(folder: Path, file: Path) -> None:
    """Write the certificate of a study."""
    from datetime import UTC, datetime

    from mpm_verify.cases.detect import certificate
    from mpm_verify.cases.detect.plant import examined
    from mpm_verify.cases.harness.environment import environment
    from mpm_verify.reports.frames import read

    record = read(folder)
    made = certificate.of(
        list(record.results.values()),
        len(record.study.runs),
        datetime.now(UTC).date().isoformat(),
        examined(),
        environment().get("processor", ""),
    )
    certificate.write(made, file)


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    own = {
        "quick": (Quick, False),
        "mutants": (Mutants, 0),
        "seed": (Seed, 1),
        "blind": (Blind, False),
        "key": (Key, None),
        "listed": (Listed, False),
        "certify": (Certify, None),
    }
    study_command(app, "detect", Run, detect, {"defect": ("all",)}, own)
