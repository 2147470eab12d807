"""Slack, snap, amplification, safety: read off histories that are written down."""

import numpy as np
import pytest

from crane.rope_life.events import amplification, largest, safety_factor, slack_events


def test_slack_begins_and_ends_between_frames():
    (event,) = slack_events([0, 1, 2, 3, 4], [40, 20, 0, 0, 40], ["fall"], threshold=10)
    assert (event.begin, event.end, event.duration) == (1.5, 3.25, 1.75)
    assert (event.span, event.from_start, event.to_end) == ("fall", False, False)


def test_a_rope_that_stays_taut_has_no_event():
    assert slack_events([0, 1, 2], [[5, 6], [5, 7], [4, 6]], ["a", "b"], threshold=1) == []


def test_slack_from_the_start_and_to_the_end_is_said_to_be_open():
    first, last = slack_events([0, 1, 2, 3], [0, 10, 10, 0], ["fall"], threshold=5)
    assert (first.begin, first.end, first.from_start, first.to_end) == (0.0, 0.5, True, False)
    assert (last.begin, last.end, last.from_start, last.to_end) == (2.5, 3.0, False, True)
    assert first.snap == 10.0 and last.snap is None and last.snap_time is None


def test_a_rope_slack_all_along_is_one_event_without_a_snap():
    for count in (1, 5):
        (event,) = slack_events(np.arange(float(count)), np.zeros(count), ["fall"])
        assert event.from_start and event.to_end and event.snap is None and event.duration == count - 1


def test_the_snap_is_the_largest_tension_of_two_seconds():
    time = np.linspace(0.0, 10.0, 1001)
    tension = 100.0 + 400.0 * np.exp(-(((time - 2.5) / 0.1) ** 2)) + 900.0 * np.exp(-(((time - 5.0) / 0.1) ** 2))
    tension[time < 1.0] = 0.0
    (event,) = slack_events(time, tension, ["fall"])
    assert event.snap == pytest.approx(500.0) and event.snap_time == pytest.approx(2.5)
    (event,) = slack_events(time, tension, ["fall"], window=5.0)
    assert event.snap == pytest.approx(1000.0) and event.snap_time == pytest.approx(5.0)


def test_the_snap_is_the_largest_tension_anywhere_in_the_span_that_was_slack():
    """A heavy rope is slack at its lower end; its own weight is in the snap at the upper one."""
    lower, upper = np.array([0.0, 0.0, 40.0, 30.0]), np.array([60.0, 90.0, 70.0, 80.0])
    (event,) = slack_events(np.arange(4.0), lower, ["fall"], most=upper)
    assert (event.begin, event.end) == (0.0, 1.0)
    assert event.snap == 80.0 and event.snap_time == 3.0
    with pytest.raises(ValueError, match="for 2 columns"):
        slack_events(np.arange(4.0), lower, ["fall"], most=np.column_stack([upper, upper]))


def test_the_snap_is_that_before_the_rope_is_slack_again():
    time = np.arange(6) * 0.1
    first, second = slack_events(time, [0, 30, 0, 0, 90, 20], ["fall"])
    assert (first.snap, second.snap) == (30.0, 90.0)
    assert second.snap_time == pytest.approx(0.4)


def test_a_window_between_frames_has_the_tension_at_its_end():
    (event,) = slack_events([0.0, 10.0], [0.0, 100.0], ["fall"], window=2.0)
    assert event.snap == pytest.approx(20.0) and event.snap_time == 2.0


def test_an_instant_of_slack_is_an_event_of_no_duration():
    (event,) = slack_events([0, 1, 2], [7, 0, 9], ["fall"])
    assert event.begin == event.end == 1.0 and event.snap == 9.0


def test_spans_are_told_apart_and_events_come_in_order_of_time():
    tension = np.array([[9, 9, 0], [9, 0, 9], [0, 9, 9], [9, 9, 9.0]])
    events = slack_events(np.arange(4.0), tension, ["drum", "hook", "dead end"])
    assert [event.span for event in events] == ["dead end", "hook", "drum"]
    assert [event.snap for event in events] == [9.0, 9.0, 9.0]


def test_the_largest_value_has_its_place_and_time():
    values = np.array([[1.0, 2.0], [5.0, 3.0], [4.0, 5.0]])
    assert largest([0, 1, 2], values, ["a", "b"]) == (5.0, "a", 1.0)
    assert largest([0, 1, 2], -values, ["a", "b"]) == (-1.0, "a", 0.0)
    assert largest([3.0], [7.0], ["a"]) == (7.0, "a", 3.0)


def test_the_amplification_is_of_the_span_with_the_largest_ratio():
    tension = np.array([[100.0, 10.0], [150.0, 18.0]])
    assert amplification([0, 1], tension, [100.0, 10.0], ["main", "tag"]) == (pytest.approx(1.8), "tag", 1.0)
    assert amplification([0, 1], tension, [100.0, 0.0], ["main", "tag"]) == (pytest.approx(1.5), "main", 1.0)
    assert amplification([0, 1], tension, 0.0, ["main", "tag"]) is None


def test_the_safety_factor_is_none_where_there_is_no_load_or_no_strength():
    assert safety_factor(1.1e6, np.array([[1e5, 2.2e5]])) == pytest.approx(5.0)
    assert safety_factor(None, np.array([1e5])) is None
    assert safety_factor(1.1e6, np.array([0.0, -3.0])) is None
    assert safety_factor(1.1e6, np.zeros(0)) is None
    with pytest.raises(ValueError, match="not finite"):
        safety_factor(1.1e6, np.array([1.0, np.nan]))


def test_what_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="not finite"):
        slack_events([0, 1], [1.0, np.nan], ["fall"])
    with pytest.raises(ValueError, match="2 columns"):
        slack_events([0, 1], np.ones((2, 2)), ["fall"])
    with pytest.raises(ValueError, match="one each"):
        largest([0, 1], np.ones((2, 2)), ["fall", "fall"])
    with pytest.raises(ValueError, match="for 2 frames"):
        largest([0, 1], np.ones(3), ["fall"])
    with pytest.raises(ValueError, match="hook has no finite"):
        amplification([0, 1], np.ones((2, 2)), [1.0, np.nan], ["drum", "hook"])
