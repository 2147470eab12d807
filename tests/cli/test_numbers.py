"""Numbers as a person reads them."""

import pytest

from tautline.cli.summary import quantity, significant, speed


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (1234567.0, "N", "1.235 MN"),
        (-98765.0, "N m", "-98.77 kN m"),
        (0.376529, "m", "0.3765 m"),
        (3770.796, "m", "3771 m"),
        (0.0, "N", "0 N"),
        (1e-9, "", "1.000e-09"),
        (200, "", "200"),
        (100.0, "s", "100 s"),
        (None, "N", "–"),
        ("right", "", "right"),
        ([1.0, 2e6], "N", "1 N, 2 MN"),
    ],
)
def test_a_quantity_is_written_with_prefix_and_significant_digits(value, unit, text):
    assert quantity(value, unit) == text


def test_significant_digits_do_not_touch_whole_numbers():
    assert [significant(value) for value in (10.0, 1200.0, 123456.0, 0.00012345)] == [
        "10",
        "1200",
        "123456",
        "0.0001234",
    ]


def test_speed_says_how_many_times_faster_or_slower():
    assert speed(0.018) == "0.018 (56 x faster than real time)"
    assert speed(2.29) == "2.29 (2.3 x slower than real time)"
    assert speed(None) == speed(float("inf")) == "–"
