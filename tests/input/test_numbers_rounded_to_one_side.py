"""Numbers that are advised are rounded to the side on which they still do, and no further."""

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tautline.scene.values.printed import digits_apart, rounded, significant


@pytest.mark.parametrize("up", [False, True])
@pytest.mark.parametrize(("value", "digits"), [(0.58, 2), (0.0029, 2), (0.00289, 3), (29.0, 2), (1e-5, 2), (7e8, 3)])
def test_a_number_that_has_the_digits_stays_what_it_is(value, digits, up):
    assert rounded(value, digits, up=up) == value


def test_all_numbers_of_two_digits_stay_what_they_are():
    for power in range(-9, 10):
        for count in range(10, 100):
            value = float(f"{count}e{power}")
            assert rounded(value, 2) == value == rounded(value, 2, up=True)


def test_lengths_are_rounded_up_never_down():
    assert [rounded(x, 2, up=True) for x in (96.27, 97.0, 101.0, 4.81)] == [97.0, 97.0, 110.0, 4.9]


@given(value=st.floats(1e-12, 1e12) | st.floats(-1e12, -1e-12), digits=st.integers(1, 6), up=st.booleans())
def test_a_number_is_rounded_as_decimal_arithmetic_does_it(value, digits, up):
    """Of the number as it reads in fourteen digits: what is behind them is rounding."""
    side = Context(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR)
    read = Decimal(f"{value:.13e}")
    wanted = float(side.create_decimal(read))
    near = float(Context(prec=digits).create_decimal(read))
    beside = abs(value - near) / abs(value)
    assume(not 5e-13 < beside < 2e-12)
    assert rounded(value, digits, up=up) == (near if beside < 1e-12 else wanted)


def test_a_number_that_is_beside_its_digits_by_what_it_is_known_to_is_not_rounded_away():
    assert rounded(0.0999999, 2) == 0.099
    assert rounded(0.0999999, 2, within=1e-5) == 0.1


@pytest.mark.parametrize("value", [0.0, math.inf, -math.inf])
def test_what_has_no_digits_stays_what_it_is(value):
    assert rounded(value, 2) == value == rounded(value, 2, up=True)


@pytest.mark.parametrize("up", [False, True])
@pytest.mark.parametrize("value", [1e-320, -3e-322, 1.234e-300, 2.3e-308, 1.5e308])
def test_the_least_and_the_largest_numbers_are_rounded_to_one_side_too(value, up):
    found, least = rounded(value, 3, up=up), 5e-324
    assert math.isfinite(found) and abs(found - value) <= max(2.0 * least, 0.01 * abs(value))
    assert found >= value - least if up else found <= value + least


@pytest.mark.parametrize(("one", "other", "wanted"), [
    (1e6, 1e6 + 1e-10, 15), (1e6, 1e6, 4), (1.0, math.nextafter(1.0, 2.0), 15), (0.0, 5e-324, 4),
    (8.6, 8.6004, 6), (8.6, 9.7, 4), (1e9, 1e9 + 1e-4, 15),
])  # fmt: skip
def test_digits_that_show_a_difference_are_no_more_than_numbers_have(one, other, wanted):
    assert digits_apart(one, other) == wanted
    assert float(significant(other, wanted)) == pytest.approx(other, rel=1e-3)
