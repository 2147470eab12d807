"""``FROM:TO:STEP`` on the command line: both ends, either direction, and how many there may be."""

import pytest

from tautline.cli.options.lists import numbers, stepped, three_of
from tautline.scene.errors import SceneError


@pytest.mark.parametrize(
    ("bounds", "values"),
    [((0.0, 0.3, 0.1), [0.0, 0.1, 0.2, 0.3]), ((4.0, 0.0, -2.0), [4.0, 2.0, 0.0]), ((0.0, 5.0, 2.0), [0.0, 2.0, 4.0])],
)
def test_a_range_has_both_ends_where_its_step_meets_them(bounds, values):
    assert stepped(bounds, "", "--speed", 10, "speeds") == pytest.approx(values)


def test_a_range_of_too_many_values_is_refused_by_its_option():
    with pytest.raises(SceneError, match="makes 11 speeds, more than 10") as refusal:
        stepped((0.0, 10.0, 1.0), "0:10:1", "--speed", 10, "speeds")
    assert "--speed" in str(refusal.value)


def test_a_range_needs_three_numbers():
    with pytest.raises(SceneError, match="needs three numbers: from, to and step"):
        three_of("1:2", "--speed", "write 0:12:3")


@pytest.mark.parametrize("text", ["0.5-4", "0.5 m - 4 m", "0.5..4", "0.5 to 4"])
def test_a_range_with_a_dash_is_answered_with_how_ranges_are_written(text):
    with pytest.raises(SceneError, match="a range is written with colons and a step; write 0"):
        numbers(text, "--hs", "m", example="write 0.5:4:0.5, or values between commas")
