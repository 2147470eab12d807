"""Numbers as a person reads them."""

from io import StringIO

import pytest
from rich.console import Console

from tautline.cli.output.console import console
from tautline.cli.output.summary import speed, two_columns
from tautline.scene.values.printed import in_percent, quantity, significant


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


@pytest.mark.parametrize("width", [40, 60, 80, 200])
def test_no_digit_of_a_value_is_lost_beside_a_long_description(width, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    console.cache_clear()
    what = "motion of the tip at the end (1 whole cycle: too few to tell a limit cycle)"
    printed = StringIO()
    Console(file=printed, width=width).print(two_columns([("step", "0.001 s"), (what, "0.00012345 m")]))
    console.cache_clear()
    assert max(map(len, printed.getvalue().splitlines())) <= width
    assert "…" not in printed.getvalue()
    assert {*what.split(), "0.001", "0.00012345"} <= set(printed.getvalue().split())


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (0.0, "0 %"),
        (0.0123, "1.2 %"),
        (1.5, "150 %"),
        (10.0, "1000 %"),
        (10.1, "more than 1000 %"),
        (9e5, "more than 1000 %"),
    ],
)
def test_a_share_of_what_hardly_is_there_is_told_as_large_and_not_by_its_number(share, text):
    assert in_percent(share) == text
