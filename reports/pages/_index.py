"""Page over a folder of studies: verdict, title with a link, what came out, date."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from mpm_verify.cases.harness.store import Store
from mpm_verify.reports.components.badges import Badge
from mpm_verify.reports.components.page import whole
from mpm_verify.reports.indexed import UNREADABLE, Entry

NAME = "index.html"
LOOKS = {UNREADABLE: "ERROR"}


def page(folder: Path, found: Sequence[Entry]) -> Path:
    """Write index.html into the folder; its path. Raises StoreError."""
    counts = Counter(one.outcome for one in found)
    badges = [Badge(LOOKS.get(name, name), str(count), name) for name, count in counts.most_common()]
    text = whole("index.html.j2", f"Studies in {folder.name or folder}", entries=found, found=badges, looks=LOOKS)
    Store.write(folder / NAME, text.encode())
    return folder / NAME
