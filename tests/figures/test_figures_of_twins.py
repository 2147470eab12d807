"""Figures of what a twin has found: the band is that of the stored deviations, in the units of the scene."""

from datetime import UTC, datetime

import numpy as np
import pytest

from tautline.application.twins import TwinResults
from tautline.results.errors import ResultError
from tautline.results.result import Result
from tautline.results.variable import Variable

TIME = np.array([0.0, 1.0, 2.0, 3.0])
FOUND = {
    "estimate payload.mass": ("kg", [5.0e3, 5.1e3, 5.2e3, 5.2e3]),
    "deviation payload.mass": ("kg", [400.0, 200.0, 100.0, 50.0]),
    "residual winch.tension": ("N", [np.nan, 2.0e3, -1.0e3, 0.5e3]),
    "alarms": ("", [0.0, 0.0, 2.0, 1.0]),
    "health": ("", [1.0, 0.0, 0.0, 2.0]),
}


def found(names=tuple(FOUND), time=TIME, units="si"):
    variables = [Variable("time", ("time",), "s", "time")]
    variables += [Variable(name, ("time",), FOUND[name][0], name) for name in names]
    arrays = {"time": time} | {name: np.array(FOUND[name][1])[: len(time)] for name in names}
    return Result(None, (variables, arrays, {}, {"application": "twin", "units": units}, {}))


def test_an_estimate_has_a_band_of_two_standard_deviations_in_the_units_of_the_scene():
    (plot,) = found().plot.estimates().axes
    assert plot.get_ylabel() == "payload.mass [kg]"
    (line,) = plot.lines
    assert np.array_equal(line.get_ydata(), FOUND["estimate payload.mass"][1])
    corners = plot.collections[0].get_paths()[0].vertices
    for time, value, sd in zip(
        TIME, FOUND["estimate payload.mass"][1], FOUND["deviation payload.mass"][1], strict=True
    ):
        at = corners[corners[:, 0] == time, 1]
        assert (at.min(), at.max()) == (value - 2.0 * sd, value + 2.0 * sd)
    (plot,) = found(units="field").plot.estimates().axes
    assert plot.get_ylabel() == "payload.mass [lbm]"


def test_a_residual_is_drawn_about_zero_and_a_gap_stays_a_gap():
    (plot,) = found().plot.residuals().axes
    zero, line = plot.lines
    assert plot.get_ylabel() == "residual of winch.tension [kN]" and set(zero.get_ydata()) == {0.0}
    assert np.array_equal(line.get_ydata(), [np.nan, 2.0, -1.0, 0.5], equal_nan=True)


def test_alarms_are_counted_and_the_health_of_the_data_is_named():
    upper, lower = found().plot.alarms().axes
    assert list(upper.lines[0].get_ydata()) == FOUND["alarms"][1]
    assert list(lower.lines[0].get_ydata()) == FOUND["health"][1]
    assert [text.get_text() for text in lower.get_yticklabels()] == ["good", "degraded", "lost"]


def test_times_that_are_dates_are_counted_from_the_first():
    begin = datetime(2026, 11, 27, 20, 15, 3, tzinfo=UTC).timestamp()
    figure = found(time=begin + TIME).plot.alarms()
    assert figure.axes[-1].get_xlabel() == "time since 2026-11-27 20:15:03 UTC [s]"
    assert np.allclose(figure.axes[0].lines[0].get_xdata(), TIME)


def test_where_nothing_is_estimated_the_other_figures_are_drawn_and_what_lacks_is_refused_by_name():
    assert list(TwinResults().pictures([found(("residual winch.tension", "alarms", "health"))])) == [
        "residuals", "alarms",
    ]  # fmt: skip
    with pytest.raises(ResultError, match="no estimate"):
        found(("alarms", "health")).plot.estimates()
    assert TwinResults().pictures([found(time=TIME[:0])]) == {}


def test_two_twins_are_drawn_each_by_itself():
    assert len(TwinResults().pictures([found(), found()])) == 6


# -- alarms by their names, residuals of a start that was far off ------------------------------------------------------


def with_states(states, names, time=TIME):
    variables = [Variable("time", ("time",), "s", "time")]
    variables += [Variable(name, ("time",), "", name) for name in ("alarms", "health")]
    variables += [Variable("alarm", ("alarm",), "", "alarm"), Variable("alarm_state", ("time", "alarm"), "", "state")]
    arrays = {"time": time, "alarms": (np.array(states) > 0).sum(axis=1).astype(float), "health": np.zeros(len(time)),
              "alarm_state": np.array(states, np.int8), "alarm": np.array(names)}  # fmt: skip
    return Result(None, (variables, arrays, {}, {"application": "twin"}, {}))


def test_each_alarm_has_a_bar_by_its_name_for_as_long_as_it_stood_and_one_in_doubt_is_hollow():
    result = with_states([[0, 0, 0], [2, 0, 0], [2, 0, 1], [0, 0, 2]], ["overload", "irregular", "slack rope ahead"])
    upper, lower = result.plot.alarms().axes
    assert [text.get_text() for text in upper.get_yticklabels()] == ["overload", "slack rope ahead"]
    bars = {}
    for one in upper.collections:
        for path in one.get_paths():
            (left, bottom), (right, top) = path.vertices.min(axis=0), path.vertices.max(axis=0)
            filled = bool(one.get_facecolor().size and one.get_facecolor()[0][3] > 0.0)
            bars.setdefault((round(0.5 * (bottom + top)), filled), []).append((left, right))
    # The last row has no length: nothing is known of what came after it.
    assert bars == {(0, True): [(1.0, 3.0)], (1, False): [(2.0, 3.0)], (1, True): [(3.0, 3.0)]}
    assert [text.get_text() for text in lower.get_yticklabels()] == ["good", "degraded", "lost"]


def test_an_alarm_that_was_not_watched_at_first_is_blank_there_and_all_keep_their_names():
    upper, _ = with_states([[0, -1], [2, -1], [0, 2], [0, 2]], ["overload", "added"]).plot.alarms().axes
    assert [text.get_text() for text in upper.get_yticklabels()] == ["overload", "added"]
    spans = sorted(
        (path.vertices[:, 0].min(), path.vertices[:, 0].max()) for one in upper.collections for path in one.get_paths()
    )
    assert spans == [(1.0, 2.0), (2.0, 3.0)]


def test_alarms_that_changed_places_in_the_map_keep_their_names():
    """No row is unknown as a whole, though each alarm was not watched at some."""
    upper, _ = with_states([[2, -1], [2, -1], [-1, 0], [-1, 2]], ["before", "after"]).plot.alarms().axes
    assert [text.get_text() for text in upper.get_yticklabels()] == ["before", "after"]


def test_with_rows_of_which_no_alarm_is_known_the_figure_counts():
    result = with_states([[-1, -1], [-1, -1], [0, 2], [1, 2]], ["overload", "slack"])
    upper, _ = result.plot.alarms().axes
    assert upper.get_ylabel() == "alarms [–]"
    assert list(upper.lines[0].get_ydata()) == [0.0, 0.0, 1.0, 2.0]


def test_where_no_alarm_came_the_figure_says_so():
    upper, _ = with_states([[0], [0], [0], [0]], ["overload"]).plot.alarms().axes
    assert [text.get_text() for text in upper.texts] == ["no alarm"]


def test_a_residual_of_the_first_row_does_not_flatten_all_others():
    time = np.arange(200.0)
    value = 100.0 * np.sin(time)
    value[0] = 40.0e3
    variables = [Variable("time", ("time",), "s", "time"), Variable("residual a", ("time",), "N", "a")]
    result = Result(None, (variables, {"time": time, "residual a": value}, {}, {"application": "twin"}, {}))
    (plot,) = result.plot.residuals().axes
    low, high = plot.get_ylim()
    assert plot.get_ylabel() == "residual of a [N]"
    assert low < -100.0 < 100.0 < high and high - low < 500.0
    assert [text.get_text() for text in plot.texts] == ["1 row is beyond, the farthest with 4e+04 N at 0 s"]
