"""A rope without tension has a safety factor without end: never a NaN, and no infinity in a file."""

import csv
import math

import numpy as np
import pytest
import xarray

from crane.operability.allowable import COMPUTED, FAILED, tabulate
from crane.operability.conditions import Condition
from crane.operability.criteria import read_criteria
from crane.operability.output import dataset, write_all
from crane.operability.storms import endless_notes
from tautline.statistics.gumbel import fit_gumbel

HEIGHTS, PERIOD = (1.0, 3.0), 8.0
MILD = [5.0, 4.8, 5.2, 5.1]


def made_of(text, factors):
    """The table of two sea states of four storms each."""
    (one,) = read_criteria([text], {"safety_factor": ""}, {})
    rows = xarray.Dataset({"status": ("case", ["done"] * 8), "safety_factor": ("case", factors)})
    conditions = [Condition(height, PERIOD, None) for height in HEIGHTS]
    return tabulate(rows, conditions, [one], range(1, 5), 1.0, 0.9, 0.9, "percentile"), one


def test_storms_whose_safety_factor_has_no_end_are_fitted_as_the_tension_that_it_is_of():
    table, one = made_of("safety_factor > 3", [*MILD, 4.0, math.inf, 3.5, 5.0])
    assert table.status[0, 0].tolist() == [COMPUTED, COMPUTED] and table.done[0, 0].tolist() == [4, 4]
    fit = fit_gumbel(np.array([1 / 4.0, 0.0, 1 / 3.5, 1 / 5.0]))
    assert table.extremes["percentile"][0, 0, 0, 1] == pytest.approx(1.0 / fit.percentile(0.9).value)
    for name, values in table.extremes.items():
        assert not np.isnan(values).any(), name
    (text,) = endless_notes(table, [one])
    assert "in 1 of the 2 sea states" in text and "left out of the tables" in text


def test_an_unknown_safety_factor_is_still_no_value_of_a_storm():
    table, _ = made_of("safety_factor > 3", [*MILD, 4.0, math.nan, 3.5, 5.0])
    assert table.status[0, 0].tolist() == [COMPUTED, FAILED]


def test_an_end_of_an_interval_that_is_a_rope_without_tension_is_left_out_of_files_and_told(tmp_path):
    """Of a limit `safety_factor < N` the bad side is little tension: that of a fit reaches none at all."""
    table, one = made_of("safety_factor < 8", [*MILD, 4.0, 40.0, 3.5, 5.0])
    assert np.isinf(table.extremes["percentile_high"][0, 0, 0, 1])
    (text,) = endless_notes(table, [one])
    assert text.startswith("safety_factor < 8: in 1 of the 2 sea states") and "has no end" in text
    written = dataset(table, [one], {})
    assert not any(np.isinf(values.values).any() for values in written.data_vars.values() if values.is_number)
    write_all(table, [one], {}, tmp_path)
    head, mild, wild = csv.reader((tmp_path / "operability.csv").open())
    at = head.index("percentile_high")
    assert float(mild[at]) > 5.0 and wild[at] == ""
    assert all(math.isfinite(height) for height in table.allowable[0, 0, 0][:3])
    assert endless_notes(made_of("safety_factor > 3", [*MILD, *MILD])[0], [one]) == []
