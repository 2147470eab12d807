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
