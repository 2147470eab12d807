"""A picture of allowable seas says when there is none, and names what can be seen in it."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest

from crane.operability.allowable import ABOVE, BELOW, UNKNOWN, Allowable, Table, fitted
from crane.operability.criteria import AT_LEAST, AT_MOST, Criterion
from crane.operability.output import _figure, draw
from crane.verbs.operability import _compared_said, _rows

NONE = Allowable(0.0, 0.0, 0.0, BELOW, BELOW, BELOW)
NOT_KNOWN = Allowable(math.nan, math.nan, math.nan, UNKNOWN)
SOME = Allowable(1.6, 1.3, 1.8, "")
ALL = Allowable(3.0, 3.0, 3.0, ABOVE, ABOVE, ABOVE)
FULL, PERIODS = 2.0 * math.pi, np.array([8.0, 10.0])


def drawn(*found, heights=(0.5, 1.0, 3.0), periods=PERIODS):
    """The plot of heights found for two headings, and the texts in it and in its legend."""
    cells = np.empty((2, len(periods)), object)
    for k, one in enumerate(found[: cells.size]):
        cells[k // len(periods), k % len(periods)] = one
    empty = np.array([])
    table = Table(np.array(heights), np.array(periods), [0.0, FULL / 4], empty, empty, empty, {}, cells[None], empty)
    figure = _figure(table, cells, "max_tension < 60 kN", "Load", "P90 of the largest in 3 h")
    figure.draw_without_rendering()
    (plot,) = figure.axes
    legend = plot.get_legend()
    return plot, [text.get_text() for text in plot.texts], [text.get_text() for text in legend.texts] if legend else []


@pytest.mark.parametrize("periods", [PERIODS, PERIODS[:1]])
def test_where_no_sea_is_allowable_the_picture_says_so_and_names_no_curves(periods):
    plot, texts, legend = drawn(*[NONE] * 4, periods=periods)
    assert texts == ["No sea is allowable, and not even the lowest\nthat was computed, Hs = 0.5 m."]
    assert plot.get_xlim()[0] < 8.0 < plot.get_xlim()[1] < 8.0 + 1.1 * len(periods)
    assert legend == [] and plot.get_lines()[:] == [] and plot.get_title(loc="left") == "P90 of the largest in 3 h"


def test_where_what_is_allowable_is_not_known_the_picture_does_not_say_that_none_is():
    _, texts, legend = drawn(NONE, NOT_KNOWN, NONE, NONE)
    assert texts == ["No sea is known to be allowable: see allowable.csv"] and legend == []


def test_seas_of_one_heading_that_are_refused_stand_as_whole_circles_on_the_axis():
    plot, texts, legend = drawn(NONE, NONE, SOME, SOME)
    assert texts == [] and legend == ["0 deg", "90 deg"]
    at_zero = [line for line in plot.get_lines() if (np.asarray(line.get_ydata()) == 0.0).any()]
    assert at_zero and not any(line.get_clip_on() for line in at_zero)


@pytest.mark.parametrize(("high", "bound", "reach"), [(0.8, "", "0.8 m"), (3.0, ABOVE, "3 m or more")])
def test_an_interval_above_zero_is_shown_and_the_words_say_how_far_it_reaches_and_not_that_no_sea_is_allowable(
    high, bound, reach
):
    plot, texts, legend = drawn(NONE, *[Allowable(0.0, 0.0, high, BELOW, BELOW, bound)] * 3)
    assert texts == [
        "By the estimate not even the lowest sea\nthat was computed, Hs = 0.5 m, is allowable.\n"
        f"The confidence interval reaches up to Hs = {reach}."
    ]
    assert legend == ["0 deg", "90 deg"] and len(plot.collections) == 2


def test_the_steepest_waves_are_named_where_they_are_in_view_alone():
    # Of 8 s they are 6.7 m high (2 pi Hs / (g Tp^2) = 1/15).
    plot, _, legend = drawn(*[ALL] * 4)
    assert "steepest waves" not in legend and plot.get_ylim()[1] < 6.0
    plot, _, legend = drawn(*[ALL] * 4, heights=(1.0, 8.0))
    assert "steepest waves" in legend and plot.get_ylim()[1] > 6.7


LARGEST = Criterion("max_tension < 60 kN", "max_tension", AT_MOST, 6.0e4, "N", False)
SMALLEST = Criterion("min_tension > 46 kN", "min_tension", AT_LEAST, 4.6e4, "N", False)
ASKED = SimpleNamespace(compared="percentile", share=0.9, duration=10800.0)


@pytest.mark.parametrize(
    ("asked", "largest", "smallest"),
    [
        (ASKED, "P90 of the largest in 3 h", "P10 of the smallest in 3 h"),
        (SimpleNamespace(compared="most_probable"), "most probable largest", "most probable smallest"),
    ],
)
def test_figures_and_table_call_the_smallest_of_a_storm_the_smallest(asked, largest, smallest, tmp_path, monkeypatch):
    titles = []
    monkeypatch.setattr("crane.operability.output.save", lambda made, path: titles.append(made.axes[0]) or path)
    cells = np.full((2, 1, 1), None, object)
    cells[:] = [[[SOME]], [[SOME]]]
    empty = np.array([])
    table = Table(np.array([0.5, 1.0, 3.0]), np.array([8.0]), [None], empty, empty, empty, {}, cells, empty)
    criteria = [LARGEST, SMALLEST]
    draw(table, criteria, "", [_compared_said(asked, one) for one in criteria], tmp_path)
    said = [plot.get_title(loc="left").split(";")[0] for plot in titles]
    assert said == [largest, smallest, f"{largest}, {smallest}"]
    outcome = SimpleNamespace(done=4, wall_time=1.0)
    found = SimpleNamespace(criteria=criteria[1:], table=None, fatigue=None, outcome=outcome)
    assert dict(_rows(found, asked))["compared with limits"] == smallest


@pytest.mark.parametrize(
    ("name", "sense", "output", "said"),
    [
        ("min_tension", AT_MOST, False, "P90 of the smallest in 3 h"),
        ("max_tension", AT_LEAST, False, "P10 of the largest in 3 h"),
        ("hook.tension", AT_MOST, True, "P90 of the largest in 3 h"),
        ("hook.tension", AT_LEAST, True, "P10 of the smallest in 3 h"),
        ("slack_events", AT_MOST, False, "P90 of slack_events in 3 h"),
    ],
)
def test_the_percentile_is_called_that_of_what_storms_have_whichever_way_it_is_limited(name, sense, output, said):
    # min_tension < 60 kN was said to compare the largest
    assert _compared_said(ASKED, Criterion(f"{name} ? 1", name, sense, 1.0, "N", output)) == said


def test_what_is_compared_with_a_limit_on_the_smallest_is_its_tenth_percentile():
    # Of so many storms the fit is sharp; the quantile of the sample knows nothing of it.
    storms = 5.0e4 - 1.0e3 * np.random.default_rng(5).gumbel(size=20000)
    compared = fitted(storms, SMALLEST, 1.0, 0.9, 0.9)["percentile"]
    assert compared == pytest.approx(np.quantile(storms, 0.1), abs=100.0) and np.quantile(storms, 0.9) > compared + 2e3
