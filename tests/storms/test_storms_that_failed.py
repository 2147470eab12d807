"""What fails is often what snaps: neither a life nor an extreme is told of the storms that are left."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
import xarray
from storms.test_operability import asked

from crane.operability.allowable import COMPUTED, FAILED, STOPPED, tabulate
from crane.operability.conditions import Condition
from crane.operability.criteria import read_criteria
from crane.operability.output import write_all
from crane.operability.scatter import Scatter, fatigue_over, not_covered, told
from crane.operability.storms import failed_notes
from crane.verbs.operability import _rows

HEIGHTS, PERIOD = (1.0, 3.0), 8.0
DIAGRAM = Scatter(np.array(HEIGHTS), np.array([PERIOD]), np.array([[0.75], [0.25]]))


def a_year_of(ranges):
    """Fatigue of storms of 100 s with 50 cycles each, of a rope of 1 kN and the S-N constant 2e6."""
    ranges = np.array(ranges)[None, None]
    cycles = np.where(np.isnan(ranges), np.nan, 50.0)
    return fatigue_over(DIAGRAM, DIAGRAM.heights, DIAGRAM.periods, ranges, cycles, 100.0, 1000.0, 2.0e6)


def test_a_storm_that_failed_is_time_that_was_not_run_and_the_others_do_not_stand_in_for_it():
    found = a_year_of([[10.0, 12.0, 11.0, 10.0], [20.0, math.nan, 21.0, math.nan]])
    # By hand: of the higher sea half of the time is lacking, which is an eighth of all.
    assert found.covered == pytest.approx(0.875, rel=1e-12)
    storms = 31557600.0 / 100.0 * 50.0 / 4.0
    damage = storms * (0.75 * sum(x**5 for x in (10.0, 12.0, 11.0, 10.0)) + 0.25 * (20.0**5 + 21.0**5))
    assert found.damage.sum() == pytest.approx(damage, rel=1e-12)
    assert found.run.tolist() == [[[1.0, 0.5]]] and found.share.tolist() == [[[0.75, 0.25]]]
    (warning,) = not_covered(found)
    assert warning.startswith("12.5 % of the time of the scatter diagram was not run") and "at most" in warning


def test_a_life_is_told_where_all_of_the_time_was_run_and_else_what_it_is_at_most():
    whole, part = a_year_of([[10.0], [20.0]]), a_year_of([[10.0, 10.0], [20.0, math.nan]])
    said = told(whole)
    assert said["life_years"] == whole.life and said["life_years_at_most"] is None
    said = told(part)
    assert said["life_years"] is None and said["life_years_at_most"] == part.life > whole.life
    for found, words in ((whole, f"{whole.life:.4g} years"), (part, f"not known, at most {part.life:.4g} years")):
        shown = SimpleNamespace(
            table=None, fatigue=found, criteria=[], failed=[], outcome=SimpleNamespace(done=4, wall_time=1.0)
        )
        rows = dict(_rows(shown, asked()))
        assert rows["fatigue life"] == words
        assert ("cycles in a year, of the time that was run" in rows) == (found is part)


def test_a_rope_that_no_cycle_wears_has_a_life_without_end_and_where_part_was_run_it_is_not_known():
    still, part = a_year_of([[0.0], [0.0]]), a_year_of([[0.0, 0.0], [0.0, math.nan]])
    for found, words in ((still, "without end: no damage"), (part, "not known: no damage, of the time that was run")):
        said = told(found)
        assert said["no_damage"] is True and said["life_years"] is said["life_years_at_most"] is None
        shown = SimpleNamespace(
            table=None, fatigue=found, criteria=[], failed=[], outcome=SimpleNamespace(done=4, wall_time=1.0)
        )
        assert dict(_rows(shown, asked()))["fatigue life"] == words
    assert told(a_year_of([[10.0], [20.0]]))["no_damage"] is False


@pytest.mark.parametrize("constant", [2.0e6, None])
def test_nothing_is_told_of_a_rope_of_which_no_storm_was_run(constant):
    ranges = np.full((1, 1, 2, 4), math.nan)
    found = fatigue_over(DIAGRAM, DIAGRAM.heights, DIAGRAM.periods, ranges, ranges, 100.0, 1000.0, constant)
    assert told(found) == {
        "equivalent_tension_range": None, "cycles_per_year": None, "slope": 5.0, "share_of_time": 0.0,
        "life_years": None, "life_years_at_most": None, "no_damage": False,
    }  # fmt: skip
    shown = SimpleNamespace(
        table=None, fatigue=found, criteria=[], failed=[], outcome=SimpleNamespace(done=0, wall_time=1.0)
    )
    rows = dict(_rows(shown, asked()))
    assert "fatigue life" not in rows and rows["cycles in a year, of the time that was run"] == "not known"
    (warning,) = not_covered(found)
    assert warning.startswith("100 % of the time") and "life" not in warning
    (text,) = failed_notes(made_of([*MILD, *MILD], ["done"] * 4 + ["inaccurate"] * 4)[0], 4)
    assert "(4 of 4)" in text and "others" not in text


def made_of(largest, status):
    """The table of two sea states of four storms each."""
    (one,) = read_criteria(["max_tension < 60 kN"], {"max_tension": "N"}, {})
    rows = xarray.Dataset({"status": ("case", status), "max_tension": ("case", largest)})
    conditions = [Condition(height, PERIOD, None) for height in HEIGHTS]
    return tabulate(rows, conditions, [one], range(1, 5), 1.0, 0.9, 0.9, "percentile"), one


MILD = [10.0e3, 11.0e3, 10.5e3, 12.0e3]


@pytest.mark.parametrize("unknown", [math.nan, math.inf])
@pytest.mark.parametrize("ended", ["inaccurate", "done"])
def test_a_sea_state_of_which_a_storm_failed_or_has_no_finite_value_has_no_extremes_and_is_not_allowed(
    unknown, ended, tmp_path
):
    table, one = made_of([*MILD, *MILD[:3], unknown], ["done"] * 7 + [ended])
    assert table.status[0, 0].tolist() == [COMPUTED, FAILED] and table.done[0, 0].tolist() == [4, 3]
    for name, values in table.extremes.items():
        assert np.isfinite(values[0, 0, 0]).tolist() == [True, False], name
    allowed = table.allowable[0, 0, 0]
    assert (allowed.height, allowed.bound) == (1.0, STOPPED)
    write_all(table, [one], {}, tmp_path)
    head, mild, wild = (line.split(",") for line in (tmp_path / "operability.csv").read_text().splitlines())
    at = head.index("percentile")
    assert mild[at] and wild[head.index("status") :] == [FAILED, "3", *[""] * (len(head) - head.index("location"))]


def test_sea_states_of_which_storms_failed_are_named_with_how_many_they_are():
    table, _ = made_of([*MILD, *MILD], ["done"] * 6 + ["inaccurate"] * 2)
    (text,) = failed_notes(table, 4)
    assert "in 1 of the sea states: Hs 3 m, Tp 8 s (2 of 4)" in text and "no extremes" in text
    assert failed_notes(made_of([*MILD, *MILD], ["done"] * 8)[0], 4) == []


def test_damage_csv_tells_how_much_of_each_sea_state_was_run(tmp_path):
    table, one = made_of([*MILD, *MILD], ["done"] * 6 + ["inaccurate"] * 2)
    fatigue = a_year_of([[10.0] * 4, [20.0, 20.0, math.nan, math.nan]])
    write_all(table, [one], {}, tmp_path, fatigue)
    head, *rows = (line.split(",") for line in (tmp_path / "damage.csv").read_text().splitlines())
    shares = [[float(row[head.index(name)]) for name in ("share of time", "share of it that was run")] for row in rows]
    assert shares == [[0.75, 1.0], [0.25, 0.5]]


def test_the_line_under_the_title_of_a_figure_of_limits_ends_inside_of_the_picture():
    from matplotlib import pyplot

    from crane.operability.output import _figure

    table, one = made_of([*MILD, *MILD], ["done"] * 8)
    said = ", ".join(f"largest {name} of each storm, P90 by the Gumbel fit" for name in ("max_tension", "min_tension"))
    figure = _figure(table, table.allowable[0], one.text, "An offshore hoist", said)
    figure.canvas.draw()
    title = figure.axes[0]._left_title
    assert "see allowable.csv" in " ".join(title.get_text().split())
    assert title.get_window_extent().x1 <= figure.bbox.x1
    pyplot.close(figure)
