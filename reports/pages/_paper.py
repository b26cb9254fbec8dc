"""Page of the ledger of the paper: statuses at a glance, a card a claim with parts, numbers and readings, and these."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from mpm_verify.cases.harness.store import Store
from mpm_verify.reports.components.badges import Badge
from mpm_verify.reports.components.page import Image, inside, whole
from mpm_verify.reports.components.take import beside
from mpm_verify.reports.figures.paper import FIGURES, NARROW
from mpm_verify.reports.paper.ledger import counts, readings
from mpm_verify.reports.paper.records import Entry, Status
from mpm_verify.reports.paper.registered import Change
from mpm_verify.reports.sentences import paper as words

NAME = "index.html"
LOOKS = {Status.HOLDS: "PASS", Status.IN_PART: "MET", Status.NO: "FAIL", Status.OPEN: "INCONCLUSIVE",
         Status.NOT_RUN: "ERROR"}  # fmt: skip


def page(
    folder: Path, mode: str, entries: Sequence[Entry], changes: Sequence[Change],
    figures: Mapping[int, Sequence[Path]] | None = None,
) -> Path:  # fmt: skip
    """Write index.html into the folder; its path. `figures`: files by number. Raises StoreError."""
    images = {f"{number}": image(number, paths) for number, paths in (figures or {}).items()}
    parts = dict.fromkeys(one.claim.part for one in entries)
    text = whole(
        "paper.html.j2",
        words.TITLE,
        lead=words.lead(mode, entries),
        found=[Badge(LOOKS[status], str(count), str(status)) for status, count in counts(entries).items()],
        changes=[words.change(one) for one in changes],
        entries=entries,
        groups=[(name, words.part(name), [one for one in entries if one.claim.part == name]) for name in parts],
        images=images,
        captions=words.CAPTIONS,
        narrow=[f"{one.number}" for one in FIGURES if one.width == NARROW],
        looks=LOOKS,
        meaning=words.MEANING,
        answers=words.ANSWERS,
        missing=words.missing,
        crowded=words.crowded,
        number=words.number,
        under=words.under,
        readings=readings(),
        pages=[one.parent.name for one in folder.glob("*/report.html")],
    )
    Store.write(folder / NAME, text.encode())
    return folder / NAME


def image(number: int, paths: Sequence[Path]) -> Image:
    """Figure from its files, the SVG among them."""
    name, alt = f"figure{number}", words.CAPTIONS[f"{number}"]
    svg = next(path for path in paths if path.suffix == ".svg").read_text(encoding="utf-8")
    return Image(
        name, inside(svg, name, alt), alt, files=tuple(beside(path) for path in paths if path.suffix != ".png")
    )
