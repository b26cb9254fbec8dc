"""`verify objectivity`: the paper's Figure 2, objective rates against closed forms, and negative controls."""

from pathlib import Path
from typing import Any

import typer

from mpm_verify.cases.objectivity.axes import Block
from mpm_verify.verify.options import study_command, values


def objectivity(asked: dict[str, list[str]], out: Path | None, **more: Any) -> int:
    """Turn a block under gravity by 90 degrees, and follow objective rates and negative controls."""
    from mpm_verify.verify.run import Settings, command, conduct, named, usage

    with usage():
        from mpm_verify.cases.harness.build import Asked, build

        study = build(Asked("objectivity", values(Block, asked)), command())
    return conduct(study, Settings(named(study, out), **more))


def add(app: typer.Typer) -> None:
    """Add the command, with an option for each field of a run."""
    study_command(app, "objectivity", Block, objectivity, {}, leave_out=("part", "frame", "rate"))
