"""Numbers below logarithmic axes stand apart, whatever the range; a power of ten stands in the label of its axis."""

from itertools import pairwise

import matplotlib
import numpy as np
import pytest
from of_the_suite import studies

from tautline.results.errors import ResultError
from tautline.view.figures.figure import STYLE, axes, legend_above, powers_in_labels, save, styled


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


@styled
def test_a_power_of_ten_stands_in_the_label_of_its_own_axis_and_numbers_times_it_are_the_values(tmp_path):
    figure, plots = axes(1, 1)
    plot = plots[0, 0]
    plot.plot([0.0, 3.0e-6], [4.0e5, 8.2e5], label="line")
    plot.set_xlabel("strain [–]")
    plot.set_ylabel("path[0].stiffness\nof the rope [kN m]")
    legend_above(plot)
    with powers_in_labels(figure):
        figure.draw_without_rendering()
        assert plot.get_ylabel() == "path[0].stiffness\nof the rope [10⁵ kN m]" and plot.get_xlabel() == "strain [10⁻⁶]"
        for axis, power in ((plot.yaxis, 1e5), (plot.xaxis, 1e-6)):
            assert not axis.get_offset_text().get_visible()
            for text, place in zip(axis.get_ticklabels(), axis.get_majorticklocs(), strict=True):
                assert float(text.get_text().replace("−", "-")) * power == pytest.approx(place, abs=1e-3 * power)
    # Saved once more nothing is added.
    for _ in range(2):
        assert save(figure, tmp_path / "plot.svg").read_text(encoding="utf-8").count("10⁵") == 1


def seen(plot):
    """What stands at the vertical axis of a plot: its label, its numbers, and the power of ten beside it."""
    plot.figure.draw_without_rendering()
    power = plot.yaxis.get_offset_text()
    return (
        plot.get_ylabel(),
        [text.get_text() for text in plot.get_yticklabels()],
        power.get_text(),
        power.get_visible(),
    )


@pytest.mark.parametrize("shown", [lambda figure, path: save(figure, path), lambda figure, _: figure._repr_png_()])
def test_a_figure_that_was_saved_or_shown_is_as_it_was_and_keeps_its_power_with_a_label_of_the_users_own(
    tmp_path, shown
):
    with matplotlib.rc_context(STYLE):
        figure, plots = axes(2, 1, sharey=True)
        plot = plots[0, 0]
        plot.plot([0.0, 1.0], [-6.0e-4, 6.0e-4])
        for each in plots.flat:
            each.set_ylabel("bit speed [m/s]")
        before = seen(plot)
        assert before[0] == "bit speed [m/s]" and before[2:] == ("1e−4", True)
        shown(figure, tmp_path / "plot.png")
        assert seen(plot) == before
        plot.set_ylabel("mine")
        assert seen(plot) == ("mine", *before[1:])
        # Zoomed out, the power is another.
        plot.set_ylim(-6.0e6, 6.0e6)
        assert seen(plot)[2] == "1e6"


def test_a_figure_that_cannot_be_saved_is_as_it_was(tmp_path):
    with matplotlib.rc_context(STYLE):
        figure, plots = axes(1, 1)
        plots[0, 0].plot([0.0, 1.0], [0.0, 8.0e5])
        plots[0, 0].set_ylabel("force [kN]")
        before = seen(plots[0, 0])
        with pytest.raises(ResultError):
            save(figure, tmp_path / "plot.words")
        assert seen(plots[0, 0]) == before


@styled
def test_the_power_of_ten_of_an_axis_without_a_unit_stands_at_its_end_and_short_numbers_have_none(tmp_path):
    figure, plots = axes(1, 2)
    for plot, largest in zip(plots[0], (8.0e5, 80.0), strict=True):
        plot.plot([0.0, 1.0], [0.0, largest])
        plot.set_ylabel("bodies[0]" if largest > 1e5 else "force [kN]")
    save(figure, tmp_path / "plot.png")
    assert plots[0, 0].yaxis.get_offset_text().get_text() == "1e5" and plots[0, 0].get_ylabel() == "bodies[0]"
    assert plots[0, 1].get_ylabel() == "force [kN]"
