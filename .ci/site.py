"""Pages of the documentation that no file in docs holds: README, ARCHITECTURE, CHANGELOG, commands, and the Python API.

MkDocs calls these hooks, see mkdocs.yml.
"""

import re
from pathlib import Path
from typing import Any

import typer
from mkdocs.structure.files import File, Files

import mpm_verify
from mpm_verify.verify.main import application, files

TOP = Path(__file__).resolve().parent.parent
TAKEN = {"index.md": "README.md", "architecture.md": "ARCHITECTURE.md", "changelog.md": "CHANGELOG.md"}
CONTRACTS = {  # what a plug-in subclasses, and what it may use
    "Bases": "mpm_verify.solver.weights",
    "Materials": "mpm_verify.solver.material_model",
    "Materials in rate form": "mpm_verify.solver.rate_material",
    "Transfers": "mpm_verify.solver.transfers._base",
    "Smoothing": "mpm_verify.solver.smoothing._base",
    "A model and its step": "mpm_verify.solver.model",
    "Cases": "mpm_verify.cases.harness.study",
}


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that are made here."""
    made = {page: (TOP / name).read_text(encoding="utf-8") for page, name in TAKEN.items()}
    made |= {"commands.md": commands(), "python.md": api()}
    for page, text in made.items():
        files.append(File.generated(config, page, content=within(text) if page in TAKEN else text))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Lead links of a page of docs to files beside docs to their pages here."""
    return within(markdown, "../")


def within(text: str, up: str = "") -> str:
    """Text of a file at the top, its links as a page of the site has them; what is no page is named only."""
    for page, name in TAKEN.items():
        text = text.replace(f"]({up}{name}", f"]({page}")
    text = re.sub(r"\[([^\]]+)\]\(LICENSE\)", r"\1", text)
    return text if up else text.replace("](docs/", "](").replace('src="docs/', 'src="')


def commands() -> str:
    """Page of all commands: what their help prints."""
    group: Any = typer.main.get_command(application())  # type: ignore[arg-type]
    parts = ["# Commands\n\nWhat `verify COMMAND --help` prints.\n"]
    for name in files():
        command = group.commands[name]
        told = command.get_help(command.context_class(command, info_name=f"verify {name}", terminal_width=100))
        parts.append(f"## verify {name}\n\n```text\n{told}\n```\n")
    return "\n".join(parts)


def api() -> str:
    """Page of the public API and of the contracts of plug-ins, from their docstrings."""
    parts = ["# Python\n\nHow it is used stands in [Python, notebooks, pytest](api.md).\n"]
    parts += [f"::: mpm_verify.verify.api.{name}\n" for name in mpm_verify.__all__ if not name.startswith("_")]
    parts.append("# Contracts of plug-ins\n\nHow they are written stands in [your own plug-in](own-plugin.md).\n")
    parts += [f"## {title}\n\n::: {module}\n    options:\n      heading_level: 3\n"
              for title, module in CONTRACTS.items()]  # fmt: skip
    return "\n".join(parts)
