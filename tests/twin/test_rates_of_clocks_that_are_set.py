"""How fast the clock of a source runs is found between two settings of it: a setting is no rate."""

import numpy as np
import pytest

from tautline.twin.signals.rows import Rows


def heard(set_by, rate, hertz=2.0):
    """Rows of 150 s, so many a second, of a clock that runs `rate` fast and is set by so many s behind 60 s."""
    rows = Rows(["a"], live=True)
    for k in range(int(150.0 * hertz)):
        now = k / hertz
        rows.add(7200.0 + now * (1.0 + rate) + (set_by if now >= 60.0 else 0.0), {"a": float(k)}, now)
        while rows.ready() is not None:
            pass
    return rows


@pytest.mark.parametrize("set_by", [-3600.0, -60.0, 60.0, 3600.0])
@pytest.mark.parametrize("rate", [0.0, 0.02])
def test_a_clock_that_is_set_is_not_told_to_run_at_another_rate_than_it_does(set_by, rate):
    rows = heard(set_by, rate)
    assert rows.counts["clock set back" if set_by < 0.0 else "gaps"] == 1
    assert rows.arrivals.clock_rate == pytest.approx(rate, abs=1e-6)
    assert sum("beside ours" in note for note in rows.notes) == (rate > 0.0)


@pytest.mark.parametrize("set_by, hertz", [(1.0, 1.0), (0.3, 10.0), (1.5, 2.0), (-1.5, 2.0), (-0.3, 10.0)])
@pytest.mark.parametrize("rate", [0.0, 0.02])
def test_a_clock_that_is_set_by_less_than_some_rows_are_apart_is_not_told_to_run_at_another_rate(set_by, hertz, rate):
    """By so little as servers of time set clocks: no gap shows it, and a line through all rows has a step."""
    rows = heard(set_by, rate, hertz)
    assert rows.arrivals.clock_rate == pytest.approx(rate, abs=1e-6)
    assert sum("beside ours" in note for note in rows.notes) == (rate > 0.0)


def test_the_rate_of_a_clock_is_found_beside_the_jitter_of_a_network_as_a_line_finds_it():
    rows, late = Rows(["a"], live=True), np.random.default_rng(1).exponential(0.05, 300)
    for k in range(300):
        rows.add(7200.0 + 0.5 * k * 1.02, {"a": float(k)}, 0.5 * k + late[k])
        while rows.ready() is not None:
            pass
    assert rows.arrivals.clock_rate == pytest.approx(0.02, abs=3e-4)
