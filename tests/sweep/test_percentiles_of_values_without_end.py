"""Percentiles of cases of which some have no finite number: those of the others, and how many they are."""

import numpy as np
import pytest

from tautline.sweeps.plans import COUNTED, PERCENTILES
from tautline.sweeps.table import RANKS, _percentiles


@pytest.mark.parametrize("wrong", [np.inf, -np.inf, np.nan])
def test_percentiles_of_cases_are_those_of_finite_numbers_and_never_nan_for_an_infinite_one(wrong):
    finite = np.array([3.0, 1.0, 2.0, 5.0, 4.0])
    entries = {"safety": (("case",), np.append(finite, [wrong, wrong]), {"units": "", "long_name": "safety"})}
    found = _percentiles(entries)
    assert found["safety" + PERCENTILES][1] == pytest.approx(np.percentile(finite, RANKS))
    assert found["safety" + COUNTED][1] == 5.0
