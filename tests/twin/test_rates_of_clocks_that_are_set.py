"""How fast the clock of a source runs is found between two settings of it: a setting is no rate."""

import pytest

from tautline.twin.signals.rows import Rows


def heard(set_by, rate):
    """Rows of 150 s, two a second, of a clock that runs `rate` fast and is set by so many s behind 60 s."""
    rows = Rows(["a"], live=True)
    for k in range(300):
        rows.add(7200.0 + 0.5 * k * (1.0 + rate) + (set_by if k >= 120 else 0.0), {"a": float(k)}, 0.5 * k)
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
