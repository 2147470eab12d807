"""A run whose accuracy was asked for tells what its frames miss, and its error is that of the force it shows."""

import math

import numpy as np
import pytest
import yaml
from physics.pipes.hoses import scene
from study.test_between_frames import BOUNCE, PEAK

import tautline
from crane.application import Crane
from gardenhose.application import Gardenhose
from tautline.finer_frames import FinerFrames
from tautline.integrators.status import Interrupted
from tautline.results.result import Result
from tautline.simulation import simulate
from tautline.study.accuracy.choice import NOT_LOOKED
from tautline.study.trials.between_frames import FINER, at_times, divisor, well_divided
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


@pytest.mark.parametrize("method", ["generalized-alpha", "rk4"])
@pytest.mark.parametrize("end", [1.5, 1.35])
def test_frames_in_between_are_those_of_the_run_itself_and_only_its_own_are_stored(tmp_path, method, end):
    """Against a run that stores them all; the last interval may be shorter, of six steps."""
    subject = Subject(Crane(), tautline.read(BOUNCE), end=end, interval=0.3)
    plain = subject.model(Setting(method, 0.3 / 12))
    own = simulate(plain)
    every = simulate(Subject(Crane(), tautline.read(BOUNCE), end=end, interval=0.075).model(Setting(method, 0.3 / 12)))
    finer = FinerFrames(4)
    stored = simulate(subject.model(Setting(method, 0.3 / 12)), tmp_path / "run.nc", finer=finer)
    fine = finer.result(plain, stored.attributes)
    assert fine.time.size == (21 if end == 1.5 else 20) and Result.read(tmp_path / "run.nc").time == pytest.approx(
        own.time
    )
    for name in ("tension", "body_position", "strain_energy", "external_work"):
        assert stored[name] == pytest.approx(own[name], rel=1e-9, abs=1e-9)
        # The last interval holds three frames, and the other run stores two in it.
        assert at_times(fine, every.time)[name] == pytest.approx(at_times(every, fine.time)[name], rel=1e-9, abs=1e-9)


def test_a_run_with_frames_in_between_that_is_ended_is_gone_on_with_from_between_two_of_its_own(tmp_path):
    """The way in which a run of an accuracy is resumed: its state may stand behind the last frame that is stored."""
    model = Subject(Crane(), tautline.read(BOUNCE), end=3.0, interval=0.3).model(Setting("generalized-alpha", 0.025))
    whole = simulate(model)

    def ended(*_):
        raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stop:
        simulate(model, tmp_path / "part.nc", ended, finer=FinerFrames(4))
    part = Result.read(tmp_path / "part.nc")
    assert np.allclose(part.time, whole.time[: part.time.size]) and part.time[-1] < part.attributes["restart_time"]
    rest = simulate(model, tmp_path / "rest.nc", resume=part)
    assert rest["tension"] == pytest.approx(whole["tension"], rel=1e-9) and stop.value.result is not None


@pytest.mark.parametrize("last", [1, 2, 5, 44, 72, 257])
@pytest.mark.parametrize("steps", [1, 2, 3, 5, 7, 13, 97])
def test_frames_in_between_stand_after_whole_steps_in_the_last_interval_too(steps, last):
    ends, counts = np.array([0.7, 1.4, 1.4 + 0.7 * last / 400.0]), np.array([steps, steps, last])
    finer = FinerFrames(8)
    times, between = finer.divide(ends, counts)
    assert times[finer.own[1:]] == pytest.approx(ends) and between.sum() == counts.sum() and between.min() >= 1
    begins = np.append(0.0, times[:-1])
    lengths = {round(x, 12) for x in (times - begins) / between}
    assert lengths == {round(0.7 / steps, 12), round(0.7 / 400.0, 12)}
    for n, made in ((steps, finer.own[1:].argmax() + 1), (last, int((times > 1.4 + 1e-12).sum()))):
        assert made == min(n, 8, max(3, n // 2))


def test_what_happens_in_a_last_interval_of_a_prime_number_of_steps_is_seen():
    """A load half of which drops: the rope goes slack between the last two frames."""
    scene = yaml.safe_load(BOUNCE)
    scene["bodies"][0]["release"] = {"at": 0.79, "remaining": 0.45 * float(scene["bodies"][0]["mass"])}
    scene["output"], scene["solver"]["end"] = {"interval": 0.7}, 1.33
    told = tautline.simulate(tautline.read(scene), accuracy="1 %")
    every = tautline.simulate(tautline.read(scene | {"output": {"interval": 0.002}}))
    seen = {one["name"]: one["finer"] for one in told.between_frames["figures"]}
    assert seen["max_rise"] == pytest.approx(every.headline["max_rise"]["value"], rel=0.1)


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


def test_ctrl_c_as_a_run_is_compared_with_its_frames_in_between_leaves_it_done(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tautline.study.accuracy.choice.between_frames", interrupted)
    result = tautline.simulate(tautline.read(BOUNCE), accuracy="1 %")
    assert result.attributes["status"] == "done" and result.accuracy["met"]
    assert result.accuracy["between_frames"] is False and NOT_LOOKED in result.warnings


def test_what_fails_as_a_run_is_compared_with_its_frames_in_between_leaves_it_stored(monkeypatch, tmp_path):
    def raises(*_):
        raise RuntimeError("a figure of others")

    monkeypatch.setattr("tautline.study.accuracy.choice.between_frames", raises)
    with pytest.raises(RuntimeError, match="a figure of others"):
        tautline.simulate(tautline.read(BOUNCE), tmp_path / "run.nc", accuracy="1 %")
    assert Result.read(tmp_path / "run.nc").attributes["status"] == "done"
