"""Files to take from a page, inside it as data: a page that is sent alone has all that it offers."""

import base64
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

TYPES = {".svg": "image/svg+xml", ".pdf": "application/pdf", ".csv": "text/csv;charset=utf-8",
         ".tex": "text/x-tex;charset=utf-8", ".bib": "text/x-bibtex;charset=utf-8", ".png": "image/png"}  # fmt: skip
MOST = 400_000  # bytes of a file; a larger one is a link to the file beside the page


@dataclass(frozen=True)
class File:
    """File to take: its name, what it is called, the link to it, and that to the same file beside the page."""

    name: str
    kind: str
    link: str
    beside: str = ""


def encoded(name: str, kind: str, content: bytes) -> File:
    """File inside the page."""
    return File(name, kind, f"data:{TYPES[Path(name).suffix]};base64,{base64.b64encode(content).decode()}")


def beside(path: Path) -> File:
    """File of a figure: inside the page, or where it is large the file beside it."""
    kind, content, link = path.suffix[1:].upper(), path.read_bytes(), quote(f"{path.parent.name}/{path.name}")
    return File(path.name, kind, link if len(content) > MOST else encoded(path.name, kind, content).link, link)
