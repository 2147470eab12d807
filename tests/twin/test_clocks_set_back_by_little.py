"""A clock that is set back by less than a second is told as that, and two machines in the data as two machines."""

import pytest

from tautline.twin.signals.rows import Rows

BEGIN = 1e9


def notes_of(stamps):
    rows = Rows(["a"])
    for k, stamp in enumerate(stamps):
        rows.add(BEGIN + stamp, {"a": float(k)})
        while rows.ready() is not None:
            pass
    while rows.ready(end=True) is not None:
        pass
    return rows.notes


@pytest.mark.parametrize("back", [0.2, 0.3, 0.4, 0.5, 0.7, 1.0])
@pytest.mark.parametrize("behind", [100, 30, 8])
def test_a_clock_that_is_set_back_by_some_rows_is_told_with_by_how_much_and_nothing_else(back, behind):
    before, step = [0.05 * k for k in range(100)], 0.05
    (note,) = notes_of(before + [before[-1] + step - back + step * k for k in range(behind)])
    assert note.startswith(f"the source's clock was set back by {back:g} s")


def test_stamps_with_too_few_digits_are_told_as_that():
    (note,) = notes_of([0.1 * (k // 2) for k in range(200)])
    assert note.startswith("rows with the same stamp have different readings")


@pytest.mark.parametrize("burst", [1, 2, 4])
def test_two_machines_in_the_data_are_told_as_that(burst):
    one = [0.05 * k for k in range(200)]
    stamps = [stamp for k in range(0, 200, burst) for stamp in one[k : k + burst] * 2]
    (note,) = [text for text in notes_of(stamps) if "two machines" in text]
    assert note.startswith("rows with the same stamp have different readings")
