"""What all limits allow together is no more, and no surer, than what each of them allows."""

from __future__ import annotations

import csv
import math
from types import SimpleNamespace

import numpy as np
import pytest

from crane.operability.allowable import ABOVE, BELOW, BREAKS, INSIDE, STOPPED, UNKNOWN, Allowable, governing, of_all
from crane.operability.output import ALL, _write_heights, draw


def table(*limits):
    """Of limits at one heading; each a list over the periods."""
    found = np.empty((len(limits), 1, len(limits[0])), object)
    for k, one in enumerate(limits):
        for j, allowed in enumerate(one):
            found[k, 0, j] = allowed
    periods = np.arange(6.0, 6.0 + len(limits[0]))
    return SimpleNamespace(
        allowable=found, headings=[None], periods=periods, heights=np.array([1.0, 2.0, 4.0]), gravity=9.81
    )


def test_each_end_of_all_limits_is_the_least_of_the_limits_with_its_own_bound():
    # The first has the least height, and is the surer of the two: the second may be kept in no more than 1.2 m.
    sure, unsure = Allowable(2.0, 1.9, 2.1, INSIDE), Allowable(2.05, 1.2, 2.9, INSIDE)
    found = table([sure], [unsure])
    assert of_all(found)[0, 0] == Allowable(2.0, 1.2, 2.1, INSIDE)
    assert governing(found).tolist() == [[0]]
    low = table([Allowable(2.0, 0.0, 4.0, INSIDE, BELOW, ABOVE)], [Allowable(2.5, 1.0, 3.5, INSIDE, STOPPED, INSIDE)])
    assert of_all(low)[0, 0] == Allowable(2.0, 0.0, 3.5, INSIDE, BELOW, INSIDE)


@pytest.mark.parametrize("turned", [False, True])
def test_of_equal_heights_the_limit_with_the_least_low_end_governs(turned):
    # As the docs' load at 6 s: both are kept at all heights, and of one it is known from 1.27 m on only.
    kept, doubtful = Allowable(2.0, 2.0, 2.0, BREAKS, BREAKS, BREAKS), Allowable(2.0, 1.268, 2.0, BREAKS, "", BREAKS)
    found = table(*([doubtful], [kept])[:: -1 if turned else 1])
    assert governing(found).tolist() == [[int(turned)]]
    assert of_all(found)[0, 0] == Allowable(2.0, 1.268, 2.0, BREAKS, INSIDE, BREAKS)


@pytest.mark.parametrize("turned", [False, True])
def test_a_height_that_was_found_bounds_before_one_that_is_at_least_as_high(turned):
    found_, least = Allowable(2.0, 1.5, 2.0, INSIDE, INSIDE, INSIDE), Allowable(2.0, 1.4, 2.0, ABOVE, INSIDE, ABOVE)
    found = table(*([found_], [least])[:: -1 if turned else 1])
    assert governing(found).tolist() == [[int(turned)]]
    assert of_all(found)[0, 0] == Allowable(2.0, 1.4, 2.0, INSIDE, INSIDE, INSIDE)


def test_what_one_limit_leaves_unknown_is_unknown_of_all():
    nothing = Allowable(math.nan, math.nan, math.nan, UNKNOWN)
    found = of_all(table([nothing], [Allowable(2.0, 1.0, 3.0, INSIDE)]))[0, 0]
    assert math.isnan(found.height) and math.isnan(found.low) and found.bound == UNKNOWN


def test_the_table_of_allowable_heights_and_the_figure_have_the_least_ends(tmp_path, monkeypatch):
    drawn = {}

    def figure(_table, allowable, text, *_):
        drawn[text] = allowable

    monkeypatch.setattr("crane.operability.output._figure", figure)
    monkeypatch.setattr("crane.operability.output.save", lambda made, path: path)
    found = table([Allowable(2.0, 1.9, 2.1, INSIDE)], [Allowable(2.05, 1.2, 2.9, INSIDE)])
    criteria = [SimpleNamespace(text="max_tension < 60 kN"), SimpleNamespace(text="min_tension > 5 kN")]
    with _write_heights(found, criteria, tmp_path / "allowable.csv").open() as file:
        row = list(csv.reader(file))[-1]
    assert row[0] == ALL and [float(cell) for cell in row[3:6]] == [2.0, 1.2, 2.1]
    assert row[-1] == "max_tension < 60 kN"
    draw(found, criteria, "", ["P90", "P90"], tmp_path)
    assert drawn[ALL][0, 0] == of_all(found)[0, 0]
