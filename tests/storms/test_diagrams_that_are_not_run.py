"""What of a scatter diagram is not run is known before the first storm, and what nobody asked for is not told."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from cli.in_process import commands_of, only_object
from storms.test_operability import ALONE, PERIOD, SCENE, asked

import tautline
from crane.application import Crane
from crane.operability.criteria import read_criteria
from crane.operability.scatter import Scatter, fatigue_over, told
from crane.operability.storms import occurring, operability, outside_notes
from crane.verbs.operability import _rows
from tautline.scene.errors import SceneError

# A quarter of the time is at 0.3 m.
DIAGRAM = Scatter(np.array([0.3, 2.0]), np.array([PERIOD]), np.array([[0.25], [0.75]]))


def test_a_diagram_that_shares_no_sea_state_with_those_asked_for_is_refused_where_no_limit_is_given(tmp_path, capsys):
    (tmp_path / "sea.yaml").write_text(SCENE)
    (tmp_path / "scatter.csv").write_text("Hs [m],6,8\n0.5,1,1\n1,1,1\n")
    options = ("--scatter", tmp_path / "scatter.csv", "--tp", "9", "--seeds", "3", "-o", tmp_path / "storms")
    code, _, said = commands_of(Crane(), capsys)("operability", tmp_path / "sea.yaml", "--hs", "3,3.5", *options)
    assert code == 2 and "none of the sea states of --hs and --tp occurs" in said
    assert "0.5, 1 m" in said and "6, 8 s" in said
    assert not (tmp_path / "storms").exists()
    scene = tautline.read(SCENE)
    # A limit is a question of its own.
    limited = asked((3.0,), scatter=DIAGRAM, limits=["max_tension < 60 kN"])
    assert occurring(limited, scene) is limited
    with pytest.raises(SceneError, match="none of the sea states"):
        occurring(asked((3.0,), scatter=DIAGRAM), scene)


def test_the_share_of_time_that_is_not_run_is_told_before_the_first_storm():
    said, progress = [], []
    execution = replace(ALONE, say=said.append, progress=lambda done, total: progress.append((done, list(said))))
    found = operability(Crane(), tautline.read(SCENE), asked((0.3,), 1, 40.0, 10.0, scatter=DIAGRAM), execution)
    done, before = progress[0]
    assert done == 0
    assert [text for text in before if "75 % of the time of the scatter diagram will not be run" in text]
    # No extreme is asked for: none is scaled.
    assert not [text for text in said if "scaled" in text or "Gumbel" in text]
    assert found.fatigue.covered == pytest.approx(0.25)
    assert outside_notes(asked((0.3, 2.0), scatter=DIAGRAM)) == outside_notes(asked((0.3,))) == []


def test_without_a_limit_no_table_of_heights_is_written_and_sea_states_are_listed(tmp_path, capsys):
    (tmp_path / "sea.yaml").write_text(SCENE)
    (tmp_path / "scatter.csv").write_text("Hs [m],8\n0.3,1\n")
    folder = tmp_path / "storms"
    options = ("--scatter", tmp_path / "scatter.csv", "--seeds", "1", "--duration", "20 s", "--simulate", "10 s")
    code, out, said = commands_of(Crane(), capsys)(
        "operability", tmp_path / "sea.yaml", *options, "--lead-in", "10 s", "-j", "1", "--json", "-o", folder
    )
    assert code == 0 and "extremes" not in said
    assert "allowable" not in only_object(out) and not (folder / "allowable.csv").exists()
    head, row = (line.split(",") for line in (folder / "operability.csv").read_text().splitlines())
    shown = dict(zip(head, row, strict=True))
    assert (shown["limit"], shown["significant_height [m]"], shown["storms_done"]) == ("", "0.3", "1")


def a_year(constant):
    """Of storms of 100 s with 50 cycles of 10 N, of a rope of 1 kN."""
    ranges = np.full((1, 1, 2, 1), 10.0)
    cycles = np.full(ranges.shape, 50.0)
    return fatigue_over(DIAGRAM, DIAGRAM.heights, DIAGRAM.periods, ranges, cycles, 100.0, 1000.0, constant)


def rows_of(fatigue, system="si"):
    outcome = SimpleNamespace(done=4, wall_time=1.0)
    shown = SimpleNamespace(table=None, fatigue=fatigue, criteria=[], failed=[], outcome=outcome)
    return dict(_rows(shown, asked(), system))


def test_a_constant_as_large_as_numbers_go_gives_a_life_and_beyond_that_one_without_end():
    # By hand: 31557600 / 100 * 50 cycles a year of (10 / 1000)^5 = 1e-10 each.
    yearly = 31557600.0 / 100.0 * 50.0 * 1e-10
    found = a_year(1e300)
    assert found.life == pytest.approx(1e300 / yearly, rel=1e-12)
    endless = found._replace(life=math.inf)
    said = told(endless)
    assert said["no_damage"] is True and said["life_years"] is said["life_years_at_most"] is None
    assert rows_of(endless)["fatigue life"] == "without end: no damage"


def test_the_summary_prints_the_units_of_the_scene():
    # 10 N are 2.248 lbf.
    (ranged,) = (text for name, text in rows_of(a_year(None), "field").items() if name.startswith("equivalent"))
    assert ranged == "2.248 lbf"


def test_limits_that_are_the_same_by_value_are_one():
    texts = ["max_tension < 60 kN", "max_tension<60 kN", "max_tension < 60000 N", "max_tension <= 60 kN"]
    found = read_criteria([*texts, "min_tension < 60 kN"], {"max_tension": "N", "min_tension": "N"}, {})
    assert [one.text for one in found] == [texts[0], texts[3], "min_tension < 60 kN"]
