"""Pages that figures are drawn onto in tests: with their pixels in a file, or laid out only.

To lay a figure out is to find its ticks, its texts and its margins, with every warning of too little room or of a
letter that the type has not. Drawing the lines takes twice as long again, and one kind of result is enough for it: with
few dots, for what is drawn is the same.
"""

from pathlib import Path
from unittest.mock import patch

from matplotlib.figure import Figure

from tautline.view.figures.figure import STYLE, save, styled

FEW_DOTS = patch.dict(STYLE, {"savefig.dpi": 50})


@styled
def lay_out(figure):
    figure.get_layout_engine().execute(figure)


def check(figures, folder, pixels):
    """Save figures by name into a folder and see that none is empty, or lay them out."""
    for name, figure in figures.items():
        if pixels:
            with FEW_DOTS:
                assert save(figure, folder / f"{name}.png").stat().st_size > 5000
        else:
            lay_out(figure)


def leave_out_pixels(monkeypatch):
    """Files are named and empty."""
    monkeypatch.setattr(Figure, "savefig", lambda figure, path: Path(path).touch())
