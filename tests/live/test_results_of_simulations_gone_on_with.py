"""`simulate` goes on from the result of a simulation as that itself does, or says why it cannot."""

import pickle
import signal
from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.live import simulation
from tautline.live.fmu.unit import from_bytes, to_bytes
from tautline.results.resumption import FORCES_ADDED, INPUTS_DRIVEN, PARAMETERS_CHANGED, PARAMETERS_GIVEN

DATA = Path(__file__).parents[2] / "data"
HOIST = DATA / "hoist.yaml"
BETWEEN = {"hoist": (2.545, 3.0), "slewing": (1.045, 1.5), "hose": (0.0545, 0.08), "jwell": (2.545, 3.0)}
"""Scenes, a time between two of their frames, and until when they are run, s."""


def assert_same(one, other, **tolerance):
    np.testing.assert_array_equal(one["time"], other["time"])
    for name in ("position", "velocity"):
        np.testing.assert_allclose(one[name], other[name], rtol=0.0, **tolerance)


@pytest.mark.parametrize("name", BETWEEN)
def test_a_result_between_two_frames_is_gone_on_with_from_its_own_time(name):
    """Bounds: what other steps make of the way to the next frame. It was 0.77 m with a clock shifted by 45 ms."""
    time, end = BETWEEN[name]
    sim = tautline.Simulation(DATA / f"{name}.yaml")
    sim.advance_to(time)
    resumed = tautline.simulate(DATA / f"{name}.yaml", end=end, resume=sim.result)
    for frame in resumed["time"][resumed["time"] > time]:
        sim.advance_to(float(frame))
    assert_same(resumed, sim.result, atol=1e-12)
    uninterrupted = tautline.simulate(DATA / f"{name}.yaml", end=end)
    scale = np.abs(uninterrupted["velocity"]).max() + 1.0
    np.testing.assert_allclose(resumed["position"], uninterrupted["position"], rtol=0.0, atol=2e-5 * scale)


def test_a_result_of_an_advance_that_was_interrupted_is_gone_on_with_from_where_it_was_left(monkeypatch):
    monkeypatch.setattr(simulation, "LONG", 3)
    sim = tautline.Simulation(HOIST)
    sim.advance_to(0.5)
    call, calls = sim._call, []

    def pressed(begin):
        calls.append(begin)
        if len(calls) == 5:
            signal.raise_signal(signal.SIGINT)
        return call(begin)

    sim._call = pressed
    with pytest.raises(tautline.Interrupted) as stop:
        sim.advance_to(1.0)
    sim._call = call
    kept = stop.value.result
    assert kept["time"][-1] < sim.time == kept.attributes["restart_time"] < 1.0
    sim.advance_to(1.5)
    assert_same(tautline.simulate(HOIST, end=1.5, resume=kept), sim.result, atol=1e-12)


def test_a_result_of_a_simulation_that_stopped_stops_again_where_it_did():
    sim = tautline.Simulation(HOIST)
    with pytest.raises(tautline.StoppedEarly) as stop:
        sim.advance_to(14.0)
    kept = stop.value.result
    assert kept["time"][-1] < sim.time
    with pytest.raises(tautline.StoppedEarly) as again:
        tautline.simulate(HOIST, end=14.0, resume=kept)
    assert again.value.status == stop.value.status
    assert again.value.time == pytest.approx(stop.value.time, abs=0.01)


@pytest.mark.parametrize("name", ["hoist", "jwell"])
def test_the_energy_of_a_result_that_keeps_its_last_frames_only_balances_when_it_is_gone_on_with(name):
    """Of the well 17 % were said to have been created numerically, and the run was failed for it."""
    sim = tautline.Simulation(DATA / f"{name}.yaml", keep=1.0)
    sim.advance_to(2.5)
    resumed = tautline.simulate(DATA / f"{name}.yaml", end=3.0, resume=sim.result)
    assert resumed["time"][0] == pytest.approx(1.5) and resumed.attributes["energy_error"] < 1e-4
    assert not any("unaccounted" in text for text in resumed.warnings)


@pytest.mark.parametrize("copied", [False, True])
@pytest.mark.parametrize("keep", [2.5, 1.3])
def test_figures_over_the_start_are_so_where_the_start_is_not_kept_any_more(keep, copied):
    """The amplification was said to be 1.0, and the rise of the load to be from the first frame that was left."""
    full = tautline.simulate(DATA / "hoist.yaml", end=3.0)
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=keep)
    sim.advance_to(2.9)
    sim = sim.copy() if copied else sim
    sim.advance_to(3.0)
    result = sim.result
    figures = {name: one["value"] for name, one in result.headline.items()}
    some = full.time >= result.time[0] - 1e-9
    tension, height = full["tension"], full["body_position"][:, 0, 2]
    assert result.time[0] == pytest.approx(3.0 - keep)
    assert figures["dynamic_amplification"] == pytest.approx((tension[some] / tension[0]).max(), rel=1e-6)
    assert figures["max_tension"] == pytest.approx(tension[some].max(), rel=1e-6)
    assert figures["rise"] == pytest.approx(height[-1] - height[0], rel=1e-6)
    away = np.linalg.norm(full["body_position"][some, 0] - full["body_position"][0, 0], axis=-1)
    assert figures["max_displacement"] == pytest.approx(away.max(), rel=1e-6)


@pytest.mark.parametrize("path", [None, "on.nc"])
def test_the_start_stays_that_of_the_run_where_the_last_frames_are_gone_on_with(path, tmp_path):
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=1.0)
    sim.advance_to(2.5)
    resumed = tautline.simulate(
        DATA / "hoist.yaml", end=3.0, resume=sim.result, path=None if path is None else tmp_path / path
    )
    full = tautline.simulate(DATA / "hoist.yaml", end=3.0)
    tension, height = full["tension"], full["body_position"][:, 0, 2]
    figures = {name: one["value"] for name, one in resumed.headline.items()}
    some = full.time >= resumed.time[0] - 1e-9
    assert resumed.time[0] == pytest.approx(1.5)
    assert figures["rise"] == pytest.approx(height[-1] - height[0], rel=1e-6)
    assert figures["dynamic_amplification"] == pytest.approx((tension[some] / tension[0]).max(), rel=1e-6)


@pytest.mark.parametrize("begin", [0.0, 2.7])
def test_statistics_that_go_on_from_the_last_frames_measure_from_the_start(begin):
    kept = {"interval": 0.05, "keep": "statistics", "windows": 0.2, "begin": begin}
    sim = tautline.Simulation(DATA / "hoist.yaml", keep=1.0)
    sim.advance_to(2.5)
    resumed = tautline.simulate(
        tautline.read(DATA / "hoist.yaml").replace({"output": kept}), end=3.0, resume=sim.result
    )
    full = tautline.simulate(DATA / "hoist.yaml", end=3.0)
    tension, height = full["tension"], full["body_position"][:, 0, 2]
    some = full.time >= max(begin, 1.5) - 1e-9
    figures = {name: one["value"] for name, one in resumed.headline.items()}
    assert figures["rise"] == pytest.approx(height[-1] - height[0], rel=1e-6)
    assert figures["dynamic_amplification"] == pytest.approx((tension[some] / tension[0]).max(), rel=1e-6)


@pytest.mark.parametrize("how", ["given", "initial", "named"])
def test_a_result_of_a_driven_simulation_says_so_and_is_not_gone_on_with(how):
    name = "vessel.surge" if how == "named" else "winch.pay_out_speed"
    inputs, initial = [name] if how == "named" else None, {name: -0.2} if how == "initial" else None
    sim = tautline.Simulation(HOIST, inputs=inputs, initial=initial)
    sim.advance(0.5)
    if how != "initial":
        assert INPUTS_DRIVEN not in sim.result.attributes
        sim.inputs[name] = -0.1
        sim.advance(0.5)
    assert sim.result.attributes[INPUTS_DRIVEN] == name
    assert sim.copy().result.attributes[INPUTS_DRIVEN] == name
    with pytest.raises(tautline.ResultError, match=f"inputs were given: {name}.*save"):
        tautline.simulate(HOIST, end=3.0, resume=sim.result)


def test_an_input_that_drives_the_same_as_one_that_was_given_is_not_said_to_have_been_given():
    sim = tautline.Simulation(HOIST)
    sim.inputs["winch.pay_out_speed"] = -0.1
    sim.advance(0.5)
    assert sim.inputs.driven == ["winch.pay_out_speed"]
    sim.inputs["winch.pay_out"] = -0.2
    sim.advance(0.5)
    assert set(sim.inputs.driven) == {"winch.pay_out", "winch.pay_out_speed"}


def test_inputs_that_were_named_and_not_given_leave_a_result_that_can_be_gone_on_with():
    sim = tautline.Simulation(HOIST, inputs=["vessel.surge"])
    sim.advance(1.0)
    whole = tautline.simulate(HOIST, end=1.5)
    assert_same(tautline.simulate(HOIST, end=1.5, resume=sim.result), whole, atol=1e-12)


def test_a_result_of_a_simulation_with_a_force_of_its_own_says_so_and_is_not_gone_on_with():
    def wind(t, q, v):
        return [500.0, 0.0, 0.0]

    sim = tautline.Simulation(HOIST)
    sim.add_force(wind, on="payload.position")
    sim.advance(0.5)
    assert sim.result.attributes[FORCES_ADDED] == "wind"
    with pytest.raises(tautline.ResultError, match="forces were added: wind") as refused:
        tautline.simulate(HOIST, end=1.0, resume=sim.result)
    assert "build" not in str(refused.value)


def test_a_run_that_goes_on_with_other_parameters_says_which_and_what_its_figures_are_by():
    sim = tautline.Simulation(HOIST, parameters={"payload.mass": 5500.0})
    sim.advance(0.5)
    sim.parameters["payload.mass"] = 8000.0
    sim.advance(0.5)
    resumed = tautline.simulate(HOIST, end=1.5, resume=sim.result)
    assert resumed.attributes[PARAMETERS_GIVEN] == resumed.attributes[PARAMETERS_CHANGED] == "payload.mass"
    assert "by the load at the start" in resumed.headline["dynamic_amplification"]["text"]
    sim.advance(0.5)
    assert_same(resumed, sim.result, atol=1e-12)


def test_a_simulation_that_stopped_stays_so_in_its_copies_and_saved_states():
    sim = tautline.Simulation(HOIST, parameters={"payload.mass": 5500.0})
    sim.advance_to(12.0)
    before = sim.save()
    with pytest.raises(tautline.StoppedEarly):
        sim.advance_to(14.0)
    state = sim.save()
    beside = {"begin": 0.0, "timed": True, "initialised": True, "running": True}
    unit = beside | {"state": state, "sent": {}, "given": {}, "held": {}, "changed": {}}
    sent, told = pickle.loads(pickle.dumps(state)), from_bytes(to_bytes(unit))["state"]
    assert sent.given == told.given == ("payload.mass",)
    others = [sim.copy(), *(tautline.Simulation(HOIST) for _ in range(3))]
    for other, saved in zip(others[1:], (state, sent, told), strict=True):
        other.restore(saved)
    for other in others:
        assert other.stopped == sim.stopped != ""
        with pytest.raises(tautline.SimulationError, match="has stopped: TWO_BLOCKED"):
            other.advance(0.5)
    assert others[0].result.attributes["status"] == sim.result.attributes["status"]
    sim.restore(before)
    assert not sim.stopped


def test_the_stiffness_of_a_rope_as_a_parameter_says_what_keeps_that_of_the_scene():
    """0.15 N and 0.15 um from a scene with that stiffness after 1 s: the springs of friction on wheels."""
    sim = tautline.Simulation(HOIST, parameters={"rope.axial_stiffness": 5.0e7})
    other = tautline.Simulation(tautline.read(HOIST).replace({"rope.axial_stiffness": 5.0e7}))
    for one in (sim, other):
        one.advance(1.0)
    assert "on wheels and drums" in sim.parameters.handle("rope.axial_stiffness").text
    assert sim["winch.tension"] == pytest.approx(other["winch.tension"], rel=1e-5)
    assert sim["payload.position"] == pytest.approx(other["payload.position"], abs=1e-6)


# -- what a result says of where it begins -----------------------------------------------------------------------------


def joined(time, keep=True, **changed):
    """A simulation that goes on from the state of another at a time, s."""
    one = tautline.Simulation(HOIST, **changed)
    one.advance_to(time)
    other = tautline.Simulation(HOIST, keep=keep)
    other.restore(one.save())
    return other


@pytest.mark.parametrize("path", [None, "on.nc"])
def test_that_frames_of_another_run_are_missing_is_said_of_what_goes_on_from_a_result_too(tmp_path, path):
    sim = joined(1.0)
    sim.advance(0.5)
    (told,) = [text for text in sim.result.warnings if "another run saved" in text]
    first = tautline.simulate(HOIST, end=2.0, resume=sim.result, path=None if path is None else tmp_path / path)
    again = tautline.simulate(HOIST, end=2.5, resume=first)
    for resumed in (first, again):
        assert [text for text in resumed.warnings if "another run saved" in text] == [told]
        assert resumed.attributes["frames_missing_until"] == 1.0
    whole = tautline.simulate(HOIST, end=2.0)
    assert "frames_missing_until" not in whole.attributes and not whole.warnings


def test_figures_over_the_start_of_a_result_that_begins_late_say_from_when_on():
    sim = joined(1.0, keep=1.0, parameters={"payload.mass": 5500.0})
    sim.advance_to(3.0)
    result = sim.result
    height = result["body_position"][:, 0, 2]
    assert result.time[0] == pytest.approx(2.0) and not result.start
    assert result.headline["rise"]["value"] == pytest.approx(height[-1] - height[0], abs=1e-12)
    for name in ("rise", "max_rise", "max_displacement"):
        assert "since 2 s, where the result begins" in result.headline[name]["text"]
    assert "over the tension at 2 s, where the result begins" in result.headline["dynamic_amplification"]["text"]


def test_figures_over_a_start_that_is_known_do_not_say_that_they_are_over_a_later_time():
    sim = tautline.Simulation(HOIST, keep=1.0)
    sim.advance_to(3.0)
    result = sim.result
    assert result.time[0] == pytest.approx(2.0)
    assert not any("where the result begins" in one["text"] for one in result.headline.values())


@pytest.mark.parametrize("keep", [True, 1.0, False])
@pytest.mark.parametrize("back", [2.7, 1.0])
def test_a_state_counts_the_frames_that_were_kept_until_then_also_after_a_way_back(keep, back):
    sim = tautline.Simulation(HOIST, keep=keep)
    sim.advance_to(back)
    early = sim.save()
    assert early.frames == 1 + round(back / 0.05)
    sim.advance_to(3.0)
    late = sim.save()
    sim.restore(early)
    assert sim.save().frames == early.frames
    sim.advance_to(3.0)
    assert sim.save().frames == late.frames == 61
    other = tautline.Simulation(HOIST, keep=keep)
    other.restore(early)
    assert other.save().frames == early.frames
    other.advance_to(3.0)
    assert other.save().frames == late.frames
