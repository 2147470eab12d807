"""Ctrl-C is heard however much work a frame is, and nothing but the waiting depends on where a run pauses."""

import numpy as np
import pytest

from tautline import run as running
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.integrators.time_loop import new_frames
from tautline.results.result import Result
from tautline.run import Run
from tautline.simulation import simulate

SCENE = """
CableModelMaterial: {{Gravity: [0, 0, -9.81]}}
CableModel:
  - Node4Dof: {{id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}}
  - Node4Dof: {{id: 1, xyz: [1, 0, 0], BC: [0, 0, 0, 1]}}
  - CableALEelementLin: {{id: 0, nodes4: [0, 1], EA: 2.0e3, EJ: 0, rhoA: 1.0e-3, cDamp: 0, compression: false}}
  - PointMass: {{id: 0, nodes4: [1], mass: 1.0}}
GeneralizedAlpha: {{{method}, time_step: {step}, time_end: 1.0, plotpoints: {frames}}}
"""
METHODS = {
    "explicit": "type: RK4",
    "implicit": "type: G-alpha, rho_inf: 0.9, eps_energy: 1.0e-10",
    "divided": "type: G-alpha, rho_inf: 0.9, eps_energy: 1.0e-10, control: error, tolerance: 1.0e-9",
}


def model(method, step=2e-3, frames=10):
    return build(parse(SCENE.format(method=METHODS[method], step=step, frames=frames)))


def assert_equal(one, other):
    for variable in one.data.data_vars:
        np.testing.assert_array_equal(one[variable], other[variable], err_msg=variable)
    assert all(one.attributes[k] == other.attributes[k] for k in ("steps", "newton_iterations", "energy_error"))


def pausing(monkeypatch, work):
    """Let batches do so much work and no more."""
    monkeypatch.setattr(running, "FIRST_WORK", work)
    monkeypatch.setattr(Run, "_allow", lambda run, done, spent: None)


@pytest.mark.parametrize("method", METHODS)
def test_a_run_is_the_same_to_the_bit_wherever_it_pauses(monkeypatch, method):
    whole, paused, heard = simulate(model(method)), [], []
    if method == "divided":
        assert whole.attributes["halvings"] > 0
    for work in (1, 7, 200):
        pausing(monkeypatch, work)
        heard.append(0)
        paused.append(simulate(model(method), progress=lambda *_: heard.__setitem__(-1, heard[-1] + 1)))
    assert heard[0] > heard[1] > heard[2] and heard[0] >= whole.attributes["steps"]
    for result in paused:
        assert_equal(result, whole)


@pytest.mark.parametrize("work", [7, 130, 170], ids="pauses in {} steps' work".format)
@pytest.mark.parametrize("method", METHODS)
def test_ctrl_c_in_the_middle_of_a_frame_keeps_what_can_be_gone_on_with(monkeypatch, method, work):
    whole = simulate(model(method))
    pausing(monkeypatch, work)

    def pressed(simulated, wall):
        if simulated > 0.25 and simulated not in whole.time:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as stop:
        simulate(model(method), progress=pressed)
    kept = stop.value.result
    assert 1 < len(kept.time) < len(whole.time) and kept.time[-1] < stop.value.time
    np.testing.assert_array_equal(kept.time, whole.time[: len(kept.time)])
    assert_equal(simulate(model(method), resume=kept), whole)


@pytest.mark.parametrize("method", METHODS)
def test_a_run_that_failed_within_a_frame_is_gone_on_with_from_a_frame(monkeypatch, method):
    whole, real = simulate(model(method)), running.run_steps

    def run_steps(method, system, state, ends, steps, begin, frames, pause=None):
        status, filled, reached = real(method, system, state, ends, steps, begin, frames, pause)
        if filled == 0 or ends[filled - 1] < 0.45:
            return status, filled, reached
        t, h = ends[filled - 1], (ends[0] - begin) / steps[0]
        real(method, system, state, np.array([t + 3 * h]), np.array([3]), t, new_frames(1, system.q.size, 0))
        return Status.NOT_CONVERGED, filled, t + 3 * h

    monkeypatch.setattr(running, "run_steps", run_steps)
    with pytest.raises(StoppedEarly) as stop:
        simulate(model(method))
    failed = stop.value.result
    # How many frames a batch has depends on the method: the last one is that of the batch that reaches 0.45 s.
    assert failed.attributes["restart_time"] < failed.time[-1] and 0.45 < failed.time[-1] < 0.65
    monkeypatch.setattr(running, "run_steps", real)
    assert_equal(simulate(model(method), resume=failed), whole)


@pytest.mark.parametrize("method", METHODS)
def test_a_frame_of_a_hundred_thousand_steps_lets_ctrl_c_through(method):
    """Batches begin small and grow by what the last one took: no frame has to be full before Python is asked."""
    heard = []

    def pressed(simulated, wall):
        heard.append(simulated)
        if len(heard) == 3:
            raise KeyboardInterrupt

    with pytest.raises(Interrupted):
        simulate(model(method, 1e-5, 1), progress=pressed)
    assert 0.0 < heard[0] < heard[-1] < 0.1


@pytest.mark.parametrize("batches", [3, 4, 5])
@pytest.mark.parametrize("method", METHODS)
def test_ctrl_c_in_compiled_code_loses_none_of_the_frames_that_were_computed(monkeypatch, method, batches):
    """Python hears it as that code returns: steps, times and frames of a result are those of one state."""
    import signal

    whole, real, count = simulate(model(method, frames=100)), running.run_steps, []

    def pressed(*arguments):
        found = real(*arguments)
        count.append(found[2])
        if len(count) == batches:
            signal.raise_signal(signal.SIGINT)
        return found

    monkeypatch.setattr(running, "run_steps", pressed)
    with pytest.raises(Interrupted) as stop:
        simulate(model(method, frames=100))
    kept, reached = stop.value.result, count[-1]
    assert len(count) == batches and stop.value.time == reached
    # A frame each hundredth of a second, the state at the start too: none that the run has passed is missing.
    assert len(kept.time) == np.count_nonzero(whole.time <= reached * (1.0 + 1e-12)) and len(kept.time) > 1
    np.testing.assert_array_equal(kept["position"], whole["position"][: len(kept.time)])
    if method != "divided":
        assert kept.attributes["steps"] * 2e-3 == pytest.approx(reached, rel=1e-9)
    assert_equal(simulate(model(method, frames=100), resume=kept), whole)


def test_ctrl_c_that_python_drops_is_heard_after_the_batch(monkeypatch):
    """What is raised in a callback of the garbage collector is printed and forgotten."""
    import signal
    import sys

    from tautline import run as running

    monkeypatch.setattr(sys, "unraisablehook", lambda _: None)
    advance = running.Run.advance

    class Cleared:
        def __del__(self):
            signal.raise_signal(signal.SIGINT)

    def advancing(run, store):
        advance(run, store)
        Cleared()

    monkeypatch.setattr(running.Run, "advance", advancing)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(Interrupted) as stop:
        simulate(model("implicit"))
    assert stop.value.result.attributes["status"] == "interrupted"
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt, StopIteration])
def test_whatever_a_callback_raises_the_frames_until_then_are_stored(tmp_path, monkeypatch, error):
    """A run of hours was lost where the callback that showed its progress had a fault."""
    pausing(monkeypatch, 7)
    whole, path = simulate(model("explicit")), tmp_path / "kept.nc"

    def progress(simulated, wall):
        if simulated > 0.5:
            raise error("a fault of the callback's")

    with pytest.raises(Interrupted if error is KeyboardInterrupt else error):
        simulate(model("explicit"), path, progress)
    kept = Result.read(path)
    assert kept.attributes["status"] == "interrupted" and kept.time[-1] >= 0.5
    np.testing.assert_array_equal(kept["position"], whole["position"][: len(kept.time)])
    assert_equal(simulate(model("explicit"), resume=kept), whole)


@pytest.mark.parametrize("kind", [SystemExit, GeneratorExit, ValueError])
def test_whatever_progress_raises_the_frames_until_then_are_in_the_file(kind, tmp_path):
    def leave(reached, wall):
        if reached > 0.3:
            raise kind(3)

    with pytest.raises(kind):
        simulate(model("implicit"), tmp_path / "left.h5", leave)
    kept = Result.read(tmp_path / "left.h5")
    assert kept.attributes["status"] == "interrupted" and len(kept["time"]) > 1
