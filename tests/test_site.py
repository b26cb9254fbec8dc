"""The documentation as a site: built without a warning, every document and command in it, nothing from elsewhere."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from fixtures_command import TOP

import mpm_verify
from mpm_verify.verify.main import files

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the site."""
    folder = tmp_path_factory.mktemp("site")
    done = build(TOP / "mkdocs.yml", folder)
    assert done.returncode == 0, done.stderr
    assert "WARNING" not in done.stderr
    return folder


def build(settings: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """Build the site of a file of settings."""
    asked = [sys.executable, "-m", "mkdocs", "build", "-f", str(settings), "-d", str(folder)]
    return subprocess.run(asked, capture_output=True, text=True, cwd=TOP)


def test_every_document_is_a_page(site: Path) -> None:
    pages = {file.stem for file in site.glob("*.html")}
    wanted = {file.stem for file in (TOP / "docs").glob("*.md")}
    assert wanted | {"index", "architecture", "changelog", "commands", "python"} <= pages


def test_every_page_is_led_to(site: Path) -> None:
    """Each page stands in the menu of the first."""
    text = (site / "index.html").read_text(encoding="utf-8")
    assert (
        not {file.name for file in site.glob("*.html")}
        - {"404.html", "index.html"}
        - set(re.findall(r'href="([\w-]+\.html)"', text))
    )


def test_tables_are_tables(site: Path) -> None:
    """No line stands so near to one that the site takes it for text: floors and cases of ARCHITECTURE.md."""
    text = (site / "architecture.html").read_text(encoding="utf-8")
    assert text.count("<table>") == 2  # beside that of the keys, which has a class
    for file in site.glob("*.html"):
        assert "| --- |" not in file.read_text(encoding="utf-8"), file.name


def test_every_command_has_its_help(site: Path) -> None:
    text = (site / "commands.html").read_text(encoding="utf-8")
    for name in files():
        assert f"Usage: verify {name} " in text


def test_public_names_have_their_docstrings(site: Path) -> None:
    text = (site / "python.html").read_text(encoding="utf-8")
    for name in mpm_verify.__all__:
        if not name.startswith("_"):
            assert f'id="mpm_verify.verify.api.{name}"' in text
    assert "Raises:" in text


def test_nothing_is_taken_from_elsewhere(site: Path) -> None:
    """No script, style or picture of another host: it opens without a network."""
    for file in site.glob("*.html"):
        text = file.read_text(encoding="utf-8")
        assert not re.findall(r'(?:src|<link[^>]*href)="(?:https?:)?//[^"]*"', text), file.name


def test_a_dead_link_is_refused(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("[gone](nowhere.md)\n")
    (tmp_path / "mkdocs.yml").write_text("site_name: x\nstrict: true\n")
    done = build(tmp_path / "mkdocs.yml", tmp_path / "site")
    assert done.returncode != 0
    assert "nowhere.md" in done.stderr
