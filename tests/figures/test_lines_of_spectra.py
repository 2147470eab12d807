"""A spectrum names a line that is there, and none where the run is too short to tell it from a drift.

The reference is a sine whose amplitude and frequency are chosen, on a drift that is no straight line.
"""

import numpy as np
import pytest

from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.view.figures.histories import spectrum_figure
from tautline.view.figures.spectrum import largest_line, late_spectrum

SWING, TURNS_A_SECOND = 0.4, 0.35


def run(end, interval=0.05):
    """A result of so many seconds with a swing on a load that is hoisted faster and faster."""
    time = np.arange(0.0, end + 0.5 * interval, interval)
    height = 0.3 * (time / end) ** 3 + SWING * np.sin(2 * np.pi * TURNS_A_SECOND * time)
    variables = [Variable("time", ("time",), "s", "time"), Variable("height", ("time",), "m", "height")]
    return Result(None, (variables, {"time": time, "height": height}, {}, {"title": "made up"}, {}))


def drawn(made):
    """The legend and the marks of a spectrum of the height."""
    figure = spectrum_figure([made], {("height", "m"): [("load", made["height"])]})
    curve, *marks = figure.axes[0].get_lines()
    return curve.get_label(), marks


def test_a_line_of_a_run_that_is_long_enough_has_the_amplitude_and_frequency_of_the_sine():
    words, marks = drawn(run(80.0))
    size, frequency = (float(word) for word in (words.split()[1], words.split()[-2]))
    assert size == pytest.approx(SWING, rel=0.02) and frequency == pytest.approx(TURNS_A_SECOND, abs=0.01)
    assert len(marks) == 1


def test_a_run_of_fewer_turns_than_the_window_needs_names_no_line():
    """Two turns and a half in the second half of it: what is highest beside them is the foot of their lobe."""
    words, marks = drawn(run(14.0))
    assert words == "load: slower than 0.57 Hz, the run is too short to tell it from drift"
    assert not marks


@pytest.mark.parametrize("end", np.linspace(4.0, 60.0, 29))
def test_whatever_the_length_of_a_run_a_named_line_is_the_sine(end):
    made = run(end)
    frequency, size = late_spectrum(made.time, made["height"], 0.5)
    place = largest_line(size)
    if place is not None:
        assert frequency[place] == pytest.approx(TURNS_A_SECOND, rel=0.1)
        assert size[place] == pytest.approx(SWING, rel=0.1)
    # Of more than five turns in the second half it is always found.
    assert place is not None or 0.5 * end * TURNS_A_SECOND < 5.0


def test_a_lower_line_beside_a_higher_one_is_not_the_largest():
    time = np.linspace(0.0, 60.0, 3001)
    two = 0.1 * np.sin(2 * np.pi * 2.0 * time) + 0.5 * np.sin(2 * np.pi * 1.0 * time)
    frequency, size = late_spectrum(time, two, 0.5)
    assert frequency[largest_line(size)] == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("fast", [0.9, 1.0, 1.2, 2.0])
def test_a_line_on_the_slope_of_something_slow_and_larger_is_named_before_a_smaller_one_further_off(fast):
    """As of a load that is landed: 10 s of a slow change of 10 kN, with a line of 0.55 kN and a faster one of 0.23."""
    time = np.arange(0.0, 20.0, 0.02)
    slow = 10.0 * np.sin(2 * np.pi * 0.25 * time) + 2e-4 * time**4
    lines = 0.55 * np.sin(2 * np.pi * fast * time) + 0.23 * np.sin(2 * np.pi * (fast + 0.8) * time)
    frequency, size = late_spectrum(time, slow + lines, 0.5)
    place = largest_line(size)
    assert place is not None and frequency[place] == pytest.approx(fast, abs=0.03)
    assert size[place] == pytest.approx(0.55, rel=0.05)


def test_a_legend_says_above_which_frequency_its_line_is_the_largest_where_something_slower_is_larger():
    made = run(20.0, 0.02)
    height = 3.0 * np.sin(2 * np.pi * 0.25 * made.time) + 0.5 * np.sin(2 * np.pi * 2.0 * made.time)
    curve, *marks = spectrum_figure([made], {("height", "m"): [("load", height)]}).axes[0].get_lines()
    words = curve.get_label()
    assert words == "load: 0.5 m at 2 Hz, largest above 0.4 Hz" and len(marks) == 1
    assert "above" not in drawn(run(80.0))[0]


def test_a_slow_change_alone_has_no_line_on_its_slope():
    time = np.arange(0.0, 20.0, 0.02)
    for turns in (0.15, 0.2, 0.25, 0.3):
        _, size = late_spectrum(time, 10.0 * np.sin(2 * np.pi * turns * time) + 2e-4 * time**4, 0.5)
        assert largest_line(size) is None


def test_what_stands_still_beside_what_swings_is_said_to_stand_still():
    made = run(80.0)
    panels = {("height", "m"): [("load", made["height"]), ("anchor", np.full(len(made.time), 3.0))]}
    figure = spectrum_figure([made, made], panels)
    assert figure.axes[0].get_lines()[-1].get_label().endswith("anchor: does not swing")


def test_a_spectrum_says_which_part_of_the_run_it_is_of():
    made, longer = run(12.0), run(80.0)
    figures = [spectrum_figure(runs, {("height", "m"): [("load", one["height"]) for one in runs]})
               for runs in ([made], [made, longer])]  # fmt: skip
    assert figures[0]._suptitle.get_text() == "made up: spectrum of the second half, 6 to 12 s"
    assert "spectrum of the second half of each" in figures[1]._suptitle.get_text()
