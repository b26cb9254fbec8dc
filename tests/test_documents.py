"""Documents hold: links lead somewhere, commands parse, blocks run, tables have every code, words are those of the
glossary."""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from mpm_verify.cases.harness.shipped import shipped
from mpm_verify.cases.harness.study_file import read
from mpm_verify.cases.judging.records import ReasonCode
from mpm_verify.cases.mms.deviations import SHOWN
from mpm_verify.cases.mms.execute import execute
from mpm_verify.cases.mms.run import Run
from mpm_verify.solver.failure import FailureKind
from mpm_verify.solver.plugins import (
    LAYOUTS,
    MATERIALS,
    METHODS,
    PROBLEMS,
    SMOOTHINGS,
    SOLUTIONS,
    TRANSFERS,
    available,
    create,
    is_file,
)
from mpm_verify.verify.main import application, files
from mpm_verify.verify.options import split

TOP = Path(__file__).resolve().parent.parent
DOCS = TOP / "docs"
DOCUMENTS = [TOP / "README.md", TOP / "ARCHITECTURE.md", *sorted(DOCS.glob("*.md"))]
PLUGINS = {
    "method": METHODS, "solution": SOLUTIONS, "material": MATERIALS, "transfer": TRANSFERS, "smoothing": SMOOTHINGS,
    "layout": LAYOUTS, "name": MATERIALS, "problems": PROBLEMS,
}  # fmt: skip
FENCED = re.compile(r"^```(\w*)\n(.*?)^```", re.DOTALL | re.MULTILINE)
each = pytest.mark.parametrize("file", DOCUMENTS, ids=lambda file: file.name)


def blocks(file: Path, language: str) -> list[str]:
    """Fenced blocks of a language."""
    return [text for name, text in FENCED.findall(file.read_text()) if name == language]


def environment() -> dict[str, str]:
    """That of a command that runs in another folder."""
    return {name: value for name, value in os.environ.items() if name != "GITHUB_STEP_SUMMARY"} | {
        "PYTHONPATH": str(TOP)
    }


# ---- links


def prose(text: str) -> str:
    """A document without its blocks of code."""
    return re.sub(r"^    .*$", "", FENCED.sub("", text), flags=re.MULTILINE)


def anchors(text: str) -> set[str]:
    """Anchors of the headings, as GitHub makes them."""
    heads = re.findall(r"^#+ (.*)$", FENCED.sub("", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def dead(file: Path, text: str) -> list[str]:
    """Links of a document that lead nowhere."""
    found = re.findall(r"\]\(([^)\s]+)\)|<img src=\"([^\"]+)\"", text)
    wrong = []
    for link in (one or other for one, other in found):
        path, _, anchor = link.partition("#")
        goal = (file.parent / path) if path else file
        if not goal.exists() or (anchor and anchor not in anchors(goal.read_text())):
            wrong.append(link)
    return wrong


@each
def test_links_lead_somewhere(file: Path) -> None:
    assert not dead(file, file.read_text())


def test_a_dead_link_is_seen() -> None:
    text = "[a](docs/nowhere.md) [b](docs/verdicts.md#no-such-heading) [c](docs/verdicts.md#exit-codes) ![d](no.png)"
    assert dead(TOP / "README.md", text) == ["docs/nowhere.md", "docs/verdicts.md#no-such-heading", "no.png"]


def gone(text: str) -> list[str]:
    """Files of the project that are named in code, with their folder, and are not there."""
    found = re.findall(r"`((?:solver|mms|cases|reports|verify|tests|docs)/[\w/.]+\.\w+)[`:]", text)
    return sorted({path for path in found if "NAME" not in path and not (TOP / path).exists()})


@each
def test_files_that_are_named_are_there(file: Path) -> None:
    assert not gone(file.read_text())


def test_a_file_that_is_gone_is_seen() -> None:
    assert gone("`cases/sweep.py`, `cases/harness/store.py`, `verify/run.py: conduct`") == ["cases/sweep.py"]


def test_readme_leads_to_every_page() -> None:
    text = (TOP / "README.md").read_text()
    pages = {f"docs/{file.name}" for file in DOCS.glob("*.md")}
    assert len(pages) > 10
    assert not {page for page in pages if f"({page})" not in text}


# ---- length, words


def test_readme_is_short_and_architecture_too() -> None:
    assert len((TOP / "README.md").read_text().split()) < 1000
    assert len((TOP / "ARCHITECTURE.md").read_bytes()) < 8_000


def glossary() -> tuple[list[str], list[str]]:
    """What is said, and what is not: the first two columns of the first table; code in backticks is left out."""
    table = (DOCS / "glossary.md").read_text().partition("\n## ")[2].partition("\n## ")[0]
    rows = [re.split(r"(?<!\\)\|", line)[1:3] for line in table.splitlines() if line.startswith("|")][2:]
    say, instead = ([re.sub(r"`[^`]*`", "", row[k]) for row in rows] for k in (0, 1))
    return (
        [word.strip() for cell in say for word in re.split("[,;]", cell) if word.strip()],
        [word.strip() for cell in instead for word in cell.split(",") if word.strip()],
    )


def not_said(text: str) -> list[str]:
    """Words of the right column in a text, code left out."""
    say, instead = glossary()
    text = re.sub(r"`[^`]*`", "", prose(text)).lower()
    for word in say:
        text = text.replace(word.lower(), "")
    patterns = {word: r"\s+".join(map(re.escape, word.lower().split())) for word in instead}
    return [word for word, pattern in patterns.items() if re.search(rf"\b{pattern}\b", text)]


@pytest.mark.parametrize(
    "file", [f for f in [*DOCUMENTS, TOP / "CHANGELOG.md"] if f.name != "glossary.md"], ids=lambda file: file.name
)
def test_words_are_those_of_the_glossary(file: Path) -> None:
    assert not not_said(file.read_text())


def test_words_that_are_not_said_are_seen() -> None:
    text = "A law of its own, a share\nof it, all neighbours, `law`, a blind spot, a spot; half a\nstep behind."
    assert set(not_said(text)) == {"law", "share", "neighbours", "spot", "half a step behind"}
    assert len(glossary()[0]) > 15


# ---- tables of codes


def codes(heading: str) -> list[str]:
    """First column of the table below a heading of the page on verdicts."""
    text = (DOCS / "verdicts.md").read_text().partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    return re.findall(r"^\| `(\w+)` \|", text, re.MULTILINE)


def test_every_reason_and_failure_is_told() -> None:
    assert codes("Reasons") == [str(code) for code in ReasonCode]
    assert codes("Why a run failed") == [str(kind) for kind in FailureKind]


# ---- commands


def commands(text: str) -> Iterator[list[str]]:
    """Arguments of each `verify ...` in code: a line of a block, a step of a workflow, or between backticks."""
    lines = re.findall(r"^(?:    |\$ |.*- run: |)(verify .*)$", text, re.MULTILINE)
    spans = re.findall(r"`(verify [^`]+)`", FENCED.sub("", text))
    for line in [*lines, *spans]:
        words = shlex.split(line.split("||")[0], comments=True)[1:]
        if words != ["..."] and words != ["COMMAND"]:
            yield words


def parsed(words: list[str]) -> dict[str, Any]:
    """Parameters of a command as it reads them, nothing run. Raises what it says of a mistake."""
    import typer

    if words[0].startswith("-"):
        assert words[0] in ("--help", "--version")
        return {}
    assert words[0] in files(), words[0]
    group: Any = typer.main.get_command(application())  # type: ignore[arg-type]
    context = group.commands[words[0]].make_context(words[0], [*words[1:]])
    return dict(context.params)


def check(words: list[str]) -> None:
    """Read a command, and make each plug-in that it names. Raises ValueError or AssertionError."""
    if is_file(words[0]):  # a case of the reader's own, see tests/test_own_case.py
        return
    if len(words) == 1 and words[0] in files():
        return  # a command is named, not typed
    given = parsed(words)
    for key, package in PLUGINS.items():
        texts = given.get(key) or []
        for text in [texts] if isinstance(texts, str) else texts:
            for one in split(text):
                if not (is_file(one) or one.isupper() or ".py" in one):
                    benchmark = words[0] == "export" and one.partition(":")[0] in available(PROBLEMS)
                    create(PROBLEMS if benchmark else package, one)
    if words[0] == "sweep":
        assert given["study"] in shipped() or given["study"].endswith(".toml")


WORKFLOW = DOCS / "ci" / "verify.yml"
WRITTEN = sorted({shlex.join(words) for file in [*DOCUMENTS, WORKFLOW] for words in commands(file.read_text())})


@pytest.mark.parametrize("line", WRITTEN)
def test_commands_parse(line: str) -> None:
    check(shlex.split(line))


def test_enough_commands_are_looked_at() -> None:
    assert len(WRITTEN) > 40
    assert {line.split()[0] for line in WRITTEN} >= {"mms", "methods", "column", "sweep", "material", "diff", "schema"}


@pytest.mark.parametrize("line", ["mms --nonsense 3", "nowhere", "mms --method fem", "audit --json", "sweep figure99"])
def test_a_wrong_command_is_seen(line: str) -> None:
    with pytest.raises(Exception, match=r"nonsense|nowhere|fem|solution|figure99"):
        check(line.split())


def test_targets_of_make_are_there() -> None:
    named = {word for file in DOCUMENTS for word in re.findall(r"(?:`|    )make (\w+)", file.read_text())}
    there = set(re.findall(r"^(\w+):", (TOP / "Makefile").read_text(), re.MULTILINE))
    assert {"mms", "test", "slow", "bench"} <= named <= there


# ---- what is printed


def lines(text: str) -> list[str]:
    """Printed lines, without spaces at their ends."""
    return [line.rstrip() for line in text.strip().splitlines()]


def test_the_transcript_is_what_is_printed(tmp_path: Path) -> None:
    (shown,) = blocks(TOP / "README.md", "text")
    prompt, _, rest = shown.partition("\n")
    assert prompt == "$ verify mms --quick"
    done = subprocess.run(
        [sys.executable, "-m", "mpm_verify", "mms", "--quick"],
        cwd=tmp_path, env=environment() | {"COLUMNS": "100"}, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert lines(done.stdout) == lines(rest)
    assert not list(tmp_path.rglob("report.html"))  # as README says


# ---- blocks


@pytest.mark.slow
def test_python_blocks_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Those of the page on Python one after another, as in a notebook; that of README is the first of them."""
    import matplotlib

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    written = [text for text in blocks(DOCS / "api.md", "python") if "def test_" not in text]
    assert blocks(TOP / "README.md", "python") == written[:1]
    assert len(written) == 4
    names: dict[str, Any] = {}
    for text in written:
        exec(compile(text, "docs/api.md", "exec"), names)
    said = capsys.readouterr().out
    assert said.startswith("PASS 0\n")
    assert "mpm PASS does not converge, as expected" in said
    assert "\nFAIL order 1.00" in said
    assert (tmp_path / "results/mine/report.html").is_file()


@pytest.mark.slow  # ten seconds: it runs twice
def test_the_example_of_a_test_is_one_that_can_fail(tmp_path: Path) -> None:
    file = DOCS / "examples" / "test_convergence.py"
    assert file.read_text() in blocks(DOCS / "api.md", "python")
    wrong = tmp_path / "test_wrong.py"
    wrong.write_text(file.read_text().replace("4.498e-5]", "9e-5]").replace("quick=True", 'transfer="pic", quick=True'))

    def ended(test: Path) -> str:
        command = [sys.executable, "-m", "pytest", "-o", "addopts=", "-p", "no:cacheprovider", "-q", str(test)]
        done = subprocess.run(command, cwd=tmp_path, env=environment(), capture_output=True, text=True)
        return done.stdout.splitlines()[-1]

    assert ended(file).startswith("2 passed")
    assert ended(wrong).startswith("2 failed")


def test_studies_on_the_page_are_studies(tmp_path: Path) -> None:
    texts = blocks(DOCS / "studies.md", "toml")
    assert len(texts) == 2
    studies = []
    for text in texts:
        (tmp_path / "own.toml").write_text(text)
        studies.append(read(str(tmp_path / "own.toml"), ""))
    column, mms = studies
    assert len(column.runs) == 6
    assert {run.material for run in column.runs} == {"mohr_coulomb:phi=33"}
    assert {(run.method, run.solution, run.cells) for run in mms.runs} == {
        (method, solution, n) for method in ("gimp", "cpdi") for solution in ("bar", "swirl") for n in (8, 16, 32, 64)
    }


def test_the_solutions_on_the_page_are_the_tested_ones() -> None:
    files = ("own_solution.py", "own_can.py")
    assert blocks(DOCS / "own-solution.md", "python") == [(TOP / "tests" / file).read_text() for file in files]


def test_the_transfer_on_the_page_is_pic(tmp_path: Path) -> None:
    (text,) = [text for text in blocks(DOCS / "own-plugin.md", "python") if text.startswith("# own_pic.py\n")]
    (tmp_path / "own_pic.py").write_text(text)
    run = replace(Run(), method="mpm", solution="bar", material="linear_elastic", cells=8, ppc=4, transfer="pic")
    (own, _), (pic, _), (flip, _) = (
        execute(replace(run, transfer=name)) for name in (str(tmp_path / "own_pic.py"), "pic", "flip")
    )
    assert own.errors == pic.errors
    assert own.errors["u"]["rms"] > 1.3 * flip.errors["u"]["rms"]


def test_the_workflow_in_readme_is_that_of_the_file() -> None:
    (shown,) = blocks(TOP / "README.md", "yaml")
    assert shown in WORKFLOW.read_text()
    assert all(f"`{name}" in (DOCS / "glossary.md").read_text() for name in SHOWN)
