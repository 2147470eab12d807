"""Percentiles of cases of which some have no end or no number: ranks count what has no end, and leave out the rest."""

import numpy as np
import pytest

from tautline.sweeps.plans import COUNTED, PERCENTILES
from tautline.sweeps.table import RANKS, _percentiles


def _of(values):
    found = _percentiles({"safety": (("case",), np.array(values), {"units": "", "long_name": "safety"})})
    return dict(zip(RANKS, found["safety" + PERCENTILES][1], strict=True)), found["safety" + COUNTED][1]


def test_cases_without_a_number_are_left_out():
    ranked, count = _of([3.0, np.nan, 1.0, 2.0, 5.0, 4.0, np.nan])
    assert list(ranked.values()) == pytest.approx(np.percentile([1.0, 2.0, 3.0, 4.0, 5.0], RANKS)) and count == 5.0


def test_cases_without_end_are_the_last_and_change_no_rank_below_them():
    """A rope that never has tension has a safety factor without end: it is above all others."""
    ranked, count = _of([*np.arange(1.0, 100.0), np.inf])
    assert ranked[90.0] == pytest.approx(np.percentile(np.arange(1.0, 101.0), 90.0)) and count == 100.0


@pytest.mark.parametrize("end", [np.inf, -np.inf])
def test_where_most_cases_have_no_end_the_percentiles_have_none_and_are_never_nan(end):
    ranked, _ = _of([1.0, 2.0, 3.0, *[end] * 97])
    assert ranked[50.0] == end and not np.isnan(list(ranked.values())).any()
