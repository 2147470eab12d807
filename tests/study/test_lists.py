"""Lists in one word on the command line: read, or refused with the option, the word and what would do."""

import pytest

from tautline.cli.options.lists import number, numbers, one_of, words
from tautline.scene.errors import SceneError


@pytest.mark.parametrize(
    ("text", "values"),
    [("1ms,0.5ms", [1e-3, 5e-4]), ("0.01", [0.01]), (" 1e-3 , 2 ms ", [1e-3, 2e-3]), ("1ms,0.001", [1e-3])],
)
def test_numbers_are_read_with_units_or_in_si_each_once(text, values):
    assert numbers(text, "--steps", "s") == pytest.approx(values)


def test_what_is_not_given_is_empty():
    assert numbers(None, "--steps", "s") == [] and words(None, "--methods", str) == []


@pytest.mark.parametrize("text", ["soon", "0", "-1ms", "nan", "inf", "1 m", "1ms;2ms", "1e-3s2"])
def test_what_is_no_positive_number_of_the_unit_is_refused_by_name(text):
    with pytest.raises(SceneError) as error:
        numbers(f"2ms,{text}", "--steps", "s")
    message = str(error.value)
    assert "--steps" in message and text in message and "2ms," not in message and ";" in message


@pytest.mark.parametrize("text", ["", ",", "1ms,", "1ms,,2ms", " "])
def test_an_entry_that_is_empty_is_refused_with_an_example(text):
    with pytest.raises(SceneError, match=r"empty.*such as 1ms,0\.5ms"):
        numbers(text, "--steps", "s")


@pytest.mark.parametrize(("text", "value"), [("1 %", 0.01), ("0.5%", 0.005), ("0.02", 0.02), ("50 %", 0.5)])
def test_a_share_is_read_as_such_or_in_per_cent(text, value):
    assert number(text, "--tolerance", "", 0.5) == pytest.approx(value)


@pytest.mark.parametrize("text", ["1", "51 %", "1,5 %", "0", "-1 %", "nan", "1 s", ""])
def test_a_share_that_is_too_large_or_two_numbers_or_none_is_refused_by_name(text):
    with pytest.raises(SceneError) as error:
        number(text, "--tolerance", "", 0.5, "give a share such as 0.01, or 1 %")
    message = str(error.value)
    assert "--tolerance" in message and text in message and ";" in message


def test_words_are_known_by_their_aliases_and_no_others():
    read = one_of(("rk4", "newmark"), {"RK4": "rk4"})
    assert words("RK4,newmark,rk4", "--methods", read) == ["rk4", "newmark"]
    with pytest.raises(SceneError, match=r"euler.*rk4, newmark"):
        words("rk4,euler", "--methods", read)
