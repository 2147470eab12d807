"""Where the pictures of docs/validation.md are kept."""

from __future__ import annotations

from benchmarks import ROOT
from tautline.view.figures.figure import Figure, save

DOCS = ROOT / "docs"
IMAGES = DOCS / "images" / "thesis"


def picture(figure: Figure, name: str, text: str, quick: bool) -> str:
    """Keep a figure, but not in a quick run, and link it; the text stands for it where it is not shown."""
    if not quick:
        IMAGES.mkdir(parents=True, exist_ok=True)
        save(figure, IMAGES / f"{name}.png")
    return f"\n![{text}](images/thesis/{name}.png)\n"
