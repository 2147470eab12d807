"""A run whose accuracy was asked for tells what its frames miss, and its error is that of the force it shows."""

import math

import pytest
from physics.pipes.hoses import scene
from study.test_between_frames import BOUNCE, PEAK

import tautline
from gardenhose.application import Gardenhose
from tautline.results.result import Result
from tautline.study.accuracy.finer_frames import steps_in_a_frame
from tautline.study.trials.between_frames import FINER, divisor, well_divided
from tautline.study.trials.history import ENDS, watch
from tautline.study.trials.trial import Setting, Subject


def test_a_run_of_an_accuracy_tells_the_extremes_of_the_closed_form_that_its_frames_miss():
    """A load that bounces on its rope, by energy; frames every 0.6 s of a period of 0.89 s."""
    result = tautline.simulate(tautline.read(BOUNCE), accuracy="1 %")
    told = {one["name"]: one["share"] for one in result.between_frames["figures"]}
    assert result.accuracy["met"] and result.accuracy["between_frames"]
    assert told["max_tension"] == pytest.approx(PEAK / result.headline["max_tension"]["value"] - 1.0, abs=1e-2)
    assert result.between_frames["limits"] == ["load of the rope (max_tension)"]
    assert any(text.startswith("the stored frames") for text in result.warnings)


@pytest.mark.parametrize(("last", "before"), [(12, 3), (8, 1), (96, 24), (3, 1), (50, 33)])
def test_the_further_run_takes_no_more_steps_than_the_last_and_stores_frames_between(last, before):
    count = steps_in_a_frame(last, before, False)
    assert max(before, last / 3) <= count <= last and divisor(count) >= min(5, last)


def test_whether_anyone_looks_between_frames_does_not_hang_on_the_number_of_steps():
    for steps in range(1, 400):
        assert divisor(well_divided(steps)) >= min(steps, 5) and abs(well_divided(steps) - steps) <= 3
    assert well_divided(13) == 12 and FINER == 10


def test_the_force_that_is_looked_at_is_the_largest_that_is_shown_where_flow_stops_at_once():
    """Water that stops throws the hose forward: its root is pulled at once, the middles of elements later and less."""
    speed = {"table": {"time": [0, 0.01, 0.0101, 3], "value": [3, 3, 0, 0]}}
    stops = scene(water={"speed": speed}, gravity=[0, 0, 0])
    result = Subject(Gardenhose(), stops, end=0.03, interval=5e-4).run(Setting(step=5e-4)).result
    looked = watch(result)
    assert looked.force.variable == ENDS and "at the start of element 1" in looked.force_said
    assert looked.of(result).force.max() == result[ENDS].max() and math.isfinite(looked.extent)


@pytest.mark.parametrize("where", ["frames_for_each", "between_frames"])
def test_ctrl_c_beside_the_loop_of_the_look_leaves_the_run_done_and_what_is_known_of_it(monkeypatch, where):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"tautline.study.accuracy.finer_frames.{where}", interrupted)
    result = tautline.simulate(tautline.read(BOUNCE), accuracy="1 %")
    assert (
        result.attributes["status"] == "done" and result.accuracy["met"] and result.accuracy["between_frames"] is False
    )
    assert any("what happens between the stored frames is not known" in one for one in result.warnings)


def test_what_progress_raises_in_the_look_leaves_the_run_stored_as_it_ended(monkeypatch, tmp_path):
    def raises(*_):
        raise RuntimeError("shown no more")

    monkeypatch.setattr("tautline.study.accuracy.choice.look_between", raises)
    with pytest.raises(RuntimeError, match="shown no more"):
        tautline.simulate(tautline.read(BOUNCE), tmp_path / "run.nc", accuracy="1 %")
    assert Result.read(tmp_path / "run.nc").attributes["status"] == "done"
