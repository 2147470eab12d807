"""Numbers below logarithmic axes stand apart, whatever the range."""

from itertools import pairwise

import numpy as np
import pytest
from of_the_suite import studies

from tautline.view.figures.figure import axes, save, styled


@styled
def spans(path, low, decades):
    """Where the numbers of the first of three plots stand in a figure of 12 inches, and what they say."""
    figure, plots = axes(1, 3, 12.0, 4.6)
    for plot in plots.flat:
        plot.loglog(low * np.array([1.0, 10.0**decades]), [1.0, 2.0])
    save(figure, path)
    plot = plots[0, 0]
    first, last = plot.get_xlim()
    texts = [*plot.xaxis.get_majorticklabels(), *plot.xaxis.get_minorticklabels()]
    shown = [text for text in texts if text.get_text() and first <= text.get_position()[0] <= last]
    return sorted((text.get_window_extent().x0, text.get_window_extent().x1) for text in shown)


SHORT, LONG = 4.0e3, 2.2e-5
"""Ends of axes whose numbers are short, and long."""
SEVERAL = [
    *((LONG, 0.9), (LONG, 1.6), (SHORT, 3.0)),
    *studies((LONG, 3.0), (SHORT, 0.9), (SHORT, 1.6), (1.0, 0.9), (1.0, 1.6), (1.0, 3.0)),
    *studies(*((low, decades) for low in (SHORT, LONG, 1.0) for decades in (1.2, 2.0))),
]


@pytest.mark.parametrize(("low", "decades"), SEVERAL)
def test_they_do_not_overlap_and_there_are_two_at_least(tmp_path, low, decades):
    found = spans(tmp_path / "plot.png", low, decades)
    assert len(found) > 1
    assert all(end < start for (_, end), (start, _) in pairwise(found))
