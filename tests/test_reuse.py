"""A study is derived once: the same asked of the same code is read from its folder, anything else is built again."""

from pathlib import Path

import pytest

from mpm_verify.cases.harness import reuse
from mpm_verify.cases.harness.build import Asked
from mpm_verify.cases.harness.store import Store

ASKED = Asked("mms", {"method": ("cpdi",), "cells": (8, 16), "ppc": (4,)})
OTHERS = [
    Asked("mms", {**ASKED.values, "cells": (8, 32)}),
    Asked("mms", ASKED.values, 2),
    Asked("mms", {"method": ("cpdi",)}, 1, quick=True),
    Asked("wave_bar", {"method": ("cpdi",)}),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder that holds the study."""
    with Store(tmp_path, "mms").locked():
        Store(tmp_path, "mms").create(reuse.study(ASKED, "verify mms --first", tmp_path))
    return tmp_path


def test_the_same_is_read_and_not_built(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    built = reuse.build(ASKED, "verify mms --again")
    monkeypatch.setattr(reuse, "build", lambda *_: pytest.fail("built again"))
    read = reuse.study(ASKED, "verify mms --again", folder)
    assert (read.runs, read.plans, read.axes, read.command) == (built.runs, built.plans, built.axes, built.command)


@pytest.mark.parametrize("asked", OTHERS)
def test_anything_else_is_built(folder: Path, asked: Asked) -> None:
    assert reuse.named(asked) != reuse.named(ASKED)
    assert reuse.study(asked, "", folder).runs == reuse.build(asked, "").runs


def test_after_an_edit_it_is_built(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = reuse.named(ASKED)
    monkeypatch.setattr(reuse, "ROOMS", ("solver", "mms"))  # as many files and bytes less
    assert reuse.named(ASKED) != before
    monkeypatch.setattr(reuse, "build", lambda *_: (_ for _ in ()).throw(LookupError))
    with pytest.raises(LookupError):
        reuse.study(ASKED, "", folder)


def test_with_a_users_file_it_is_always_built(tmp_path: Path) -> None:
    for value in ("mine.py", "./mine.py:E=3", "/somewhere/mine.py"):
        assert reuse.named(Asked("mms", {"solution": (value,)})) == ""
