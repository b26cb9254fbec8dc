"""Parts that every page is made of: templates, and figures that stand inside it as SVG data."""

import base64
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from matplotlib.figure import Figure

from mpm_verify.reports.figures import style
from mpm_verify.reports.sentences.detect import quoted

TEMPLATES = Path(__file__).absolute().parent.parent / "templates"
Add = Callable[[str, Figure, str], "Image"]


@dataclass(frozen=True)
class Image:
    """Figure inside the page: its SVG as data, and what it shows in words."""

    name: str
    data: str
    alt: str
    width: int
    height: int


def template(name: str) -> Template:
    """Template of this package; a name that is not defined is an error."""
    environment = Environment(loader=FileSystemLoader(TEMPLATES), undefined=StrictUndefined, autoescape=True)
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.globals["detected"] = quoted()
    return environment.get_template(name)


def adder(folder: Path, end: str = "", kinds: Sequence[str] = ("svg", "pdf", "png")) -> Add:
    """Function that saves a figure under a name and gives it as an Image; its halves are saved as SVG alone."""

    def add(name: str, figure: Figure, alt: str) -> Image:
        name = re.sub(r"[^A-Za-z0-9_.=-]+", "_", name)
        svg = style.save(figure, folder, name + end, ("svg",) if name.startswith("figure1_") else kinds)
        width, height = (round(96 * inches) for inches in figure.get_size_inches())
        return Image(name + end, "data:image/svg+xml;base64," + base64.b64encode(svg).decode(), alt, width, height)

    return add
