"""Parts that every page is made of: its frame with the contents, and figures that stand inside it as SVG."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup
from matplotlib.figure import Figure

from mpm_verify.reports.components.take import File, beside
from mpm_verify.reports.figures import drawn, style
from mpm_verify.reports.sentences.detect import quoted

TEMPLATES = Path(__file__).absolute().parent.parent / "templates"
HERE = "<!--contents-->"  # in a template: what is before it stands above the contents
Add = Callable[[str, Figure, str], "Image"]
ALL = ("svg", "pdf", "png")
LARGE = 8_000_000  # characters of a page
COLOURS = {  # of figures, by the variable of report.css that they follow in the dark
    style.INK: "ink", style.GREY: "soft", style.LIGHT: "grid", "#ffffff": "paper", "#f4f1ee": "strip",
    "#e8d5a3": "sand",
    **dict(zip((c.lower() for c in style.COLOURS),
               ("blue", "orange", "green", "pink", "amber", "black", "sky", "brown"), strict=True)),
}  # fmt: skip


@dataclass(frozen=True)
class Spot:
    """Point of a figure that opens the card of its run; `left`, `top` in per cent."""

    left: float
    top: float
    series: int
    run: str
    text: str


@dataclass(frozen=True)
class Image:
    """Figure inside the page: its SVG, what it shows in words, its series, points that have a card, and its files."""

    name: str
    svg: Markup
    alt: str
    series: tuple[str, ...] = ()
    points: tuple[Spot, ...] = ()
    files: tuple[File, ...] = ()


def template(name: str, light: bool = False) -> Template:
    """Template of this package; a name that is not defined is an error. A `light` page links to files beside it."""
    environment = Environment(loader=FileSystemLoader(TEMPLATES), undefined=StrictUndefined, autoescape=True)
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.globals["detected"], environment.globals["light"] = quoted(), light
    return environment.get_template(name)


def whole(name: str, title: str, **values: Any) -> str:
    """Page from a template of its content; one that would be too large links to the files of its figures."""
    text = framed(name, title, light=False, **values)
    return text if len(text) < LARGE else framed(name, title, light=True, **values)


def framed(name: str, title: str, light: bool, **values: Any) -> str:
    """Page within the frame of all pages, with a table of contents."""
    top, _, rest = template(name, light).render(title=title, **values).partition(HERE)
    found = re.findall(r'<h2 id="([^"]+)">(.*?)</h2>', rest, re.DOTALL)
    contents = [(key, Markup(heading)) for key, heading in found]
    return template("page.html.j2").render(title=title, top=Markup(top), rest=Markup(rest), contents=contents)


def adder(folder: Path, end: str = "", kinds: Sequence[str] = ALL, told: Mapping[str, str] | None = None) -> Add:
    """Function that saves a figure under a name and gives it as an Image; its halves are saved as SVG alone.

    Parameters
    ----------
    folder
        Where its files go: SVG, PDF, PNG, and CSV of its named lines.
    end
        End of each name.
    kinds
        Formats.
    told
        Text of each run that has a card, by the name of its Result.
    """

    def add(name: str, figure: Figure, alt: str) -> Image:
        name = re.sub(r"[^A-Za-z0-9_.=-]+", "_", name)
        mine = [kind for kind in kinds if kind != "png"] if name.startswith("figure1_") else kinds
        name, series = name + end, drawn.tagged(figure)
        svg = style.save(figure, folder, name, mine)
        data = drawn.table(figure)
        if len(data):
            data.to_csv(folder / f"{name}.csv", index=False, lineterminator="\n")
        points = tuple(
            Spot(p.left, p.top, p.series, p.run, f"{(told or {})[p.run]}")
            for p in drawn.points(figure) if p.run in (told or {})
        )  # fmt: skip
        files = tuple(beside(path) for kind in ("svg", "pdf", "csv") if (path := folder / f"{name}.{kind}").exists())
        return Image(name, inside(svg.decode(), name, alt), alt, series, points, files)

    return add


def inside(svg: str, name: str, alt: str) -> Markup:
    """Text of an SVG for a page: its names begin with that of the figure, its colours follow the page's."""
    text = svg[svg.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<defs>\s*</defs>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r' xmlns(:xlink)?="[^"]*"', "", text)
    text = re.sub(r'\b(id=")|((?:href="|url\()#)', lambda m: f"{m[0]}{name}-", text)
    text = re.sub(r"#[0-9a-f]{6}\b(?=[;\"])", lambda m: coloured(m[0]), text)
    head = Markup('<svg role="img" aria-label="{}"').format(alt)
    return Markup(str(head) + text[len("<svg") :])


def coloured(colour: str) -> str:
    """Colour of a figure as the variable that the page has for it."""
    return f"var(--{COLOURS[colour]}, {colour})" if colour in COLOURS else colour
