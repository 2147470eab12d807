"""The race with another program: its scenes and tables, which need neither a compiler nor that program."""

from __future__ import annotations

import json
import sys
from types import ModuleType

import numpy as np
import pytest


@pytest.fixture(scope="module")
def race() -> ModuleType:
    from benchmarks.race import race

    return race


@pytest.fixture
def rows(race):
    case = race.scenes.cases(True)[0]
    ours = race.Row(case, race.OURS, "ALE-ANCF", "banded", [0.001] * 3, [0.002] * 3, 0.0, 1000, 1, 1e-5, 1e-8)
    theirs = race.Row(case, "Exudyn", "Cable2D", "EigenDense", [0.003] * 3, [0.004] * 3, 0.001, 500, 1, 2e-5, 1e-9)
    return [ours, theirs]


def test_the_time_of_a_step_leaves_out_what_setting_up_takes(rows):
    steps = rows[0].case.steps
    assert rows[0].per_step == pytest.approx(1e6 * 0.001 / steps)
    assert rows[1].per_step == pytest.approx(1e6 * 0.002 / (steps - 1))


def test_all_rows_of_a_table_have_the_cells_of_its_header(race, rows):
    rows[1].failure = "SolverError: it gave up"
    lines = [line for line in race.full(rows, {}).splitlines() if line.startswith("|")]
    assert len(lines) == 4
    assert len({line.count("|") for line in lines}) == 1
    assert "it gave up" in lines[-1]


def test_readers_see_both_times_their_ratio_and_both_errors(race, rows):
    cells = race.brief(rows).splitlines()[2].strip("| ").split(" | ")
    assert cells == ["bar, 4 elements, 1 ms", "2", "4.01", "2", "1.0e-05", "2.0e-05"]


def test_a_program_that_fails_is_shown_by_how_it_failed(race, rows):
    rows[0].failure = "NOT_CONVERGED at 1.7 s"
    assert "| NOT_CONVERGED at 1.7 s | 4.01 | – |" in race.brief(rows)


def test_without_the_peer_only_tautline_is_in_the_tables(race, rows):
    assert "Exudyn |" not in race.full(rows[:1], {})
    assert race.brief(rows[:1]).count("\n") == 2


def test_what_is_kept_as_json_holds_every_time(race, rows):
    kept = json.loads(race.as_json(rows, "here"))
    assert [row["solve"] for row in kept["rows"]] == [row.solve for row in rows]
    assert kept["rows"][0]["name"] == "bar, 4 elements, 1 ms"
    assert race.from_json(race.as_json(rows, "here")) == (rows, "here")


def test_every_scene_is_one_that_tautline_reads(race):
    for case in race.scenes.cases(True):
        model = race.scenes.build(case, race.scenes.text(case, case.end, case.every))
        assert model.solver.end == pytest.approx(case.end)
        assert model.solver.step == pytest.approx(case.step)


def test_the_rope_begins_where_its_ends_are_held(race):
    for speed in (0.0, 5.0):
        place, slope, p = race.scenes.rope_start(10, speed)
        assert np.allclose([place[0], place[-1]], [[0.0, 0.0], [100.0, 0.0]], atol=1e-9)
        assert p[-1] == 110.0
        assert np.all(np.linalg.norm(slope, axis=1) > 1.0)


def test_the_exact_bar_swings_about_its_static_stretch(race):
    # Over many periods of the first mode, 4 L/c, the mean of F L/EA (1 - cos ..) is the static stretch.
    times = np.linspace(0.0, 40.0, 40001)[1:]
    end = race.scenes.bar_exact(4, times)[:, 0, 0] - 1.0
    assert end.mean() == pytest.approx(1e-3, rel=1e-2)
    assert end.max() == pytest.approx(2e-3, rel=5e-2)


def test_the_load_over_the_sheave_keeps_its_energy(race):
    scenes = race.scenes
    found = scenes.sheave_exact(np.linspace(0.0, 2.0, 2001), "engineering")[:, 0]
    speed = np.gradient(found, 1e-3, axis=0)[5:-5]
    stretch = np.array([scenes.path_over_sheave(place)[0] for place in found[5:-5]]) - scenes.rope_length()
    spring = scenes.SHEAVE["EA"] / scenes.rope_length()
    energy = 500.0 * (speed**2).sum(1) + 0.5 * spring * stretch**2 + 1000.0 * 9.81 * found[5:-5, 1]
    assert np.ptp(energy) < 1e-3 * np.ptp(1000.0 * 9.81 * found[:, 1])


def test_a_race_replaces_its_part_of_a_page_and_nothing_else(race):
    part = f"{race.BEGIN}\nnew\n{race.END}"
    old = f"above\n{race.BEGIN}\nold\n{race.END}\nbelow\n"
    assert race.between(old, part, race.BEGIN, race.END) == f"above\n{part}\nbelow\n"


def test_a_reduced_race_prints_both_tables_and_writes_none(race, rows, monkeypatch, capsys):
    monkeypatch.setattr(race, "race", lambda case, with_peer: rows if case == rows[0].case else [])
    monkeypatch.setattr(race, "write", lambda rows, measured: pytest.fail("a reduced race wrote its tables"))
    monkeypatch.setattr(sys, "argv", ["race.py", "--quick"])
    race.main()
    printed = capsys.readouterr().out
    assert race.brief(rows) in printed and "Measured: " in printed


def measured(race):
    """The rows of which the tables were written, but for those without an error."""
    kept = json.loads((race.scenes.ROOT / "benchmarks" / "race" / "results.json").read_text())
    return [row for row in kept["rows"] if row["error"] is not None]


@pytest.mark.parametrize("program", ["Tautline", "Exudyn"])
def test_a_tenth_of_a_tolerance_moves_a_run_by_less_than_a_tenth_of_its_error(race, program):
    rows = [row for row in measured(race) if row["program"] == program]
    assert len(rows) >= 17
    assert all(row["tolerance_leaves"] < 0.1 * row["error"] for row in rows)


def test_both_programs_err_by_about_as_much_where_they_compute_the_same(race):
    rows = measured(race)
    assert rows
    for case in [row["case"] for row in rows]:
        same = [one for one in rows if one["case"] == case]
        assert {one["program"] for one in same} == {"Tautline", "Exudyn"}, case
        both = [one["error"] for one in same]
        assert max(both) < (3.0 if case["scene"] == "hose" else 1.2) * min(both)
