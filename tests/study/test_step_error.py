"""The error that a run states of itself, against what the methods are known to do to an oscillation and to events."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from of_the_suite import studies
from references import planar_well_dynamics as planar
from study.commands import command_of
from study.oscillators import OMEGA, START, lag_constant, oscillator, rk4, run, subject
from test_study_verbs import only_object

import drillstring.application
import drillstring.model.build
import drillstring.scene.scene
import tautline
from tautline.cable.application import Cable
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.scene.model import validate
from tautline.simulation import simulate
from tautline.study.trials import trial as trial_module
from tautline.study.trials.step_error import (
    LONGER,
    SHORTER,
    StepError,
    estimate,
    from_longer,
    from_shorter,
    runs_for,
    step_error,
)
from tautline.study.trials.trial import Setting, Subject, Trial

JWELL = Path(__file__).parents[2] / "data" / "jwell.yaml"
REFERENCES = Path(__file__).parents[1] / "references"
TURNS = OMEGA * 5.0
"""Angle of the oscillator at its end, rad."""


def found(text, parts=SHORTER):
    return step_error(subject(text), run(text), parts=parts)


@pytest.mark.parametrize("frames", [1250, 2500], ids=["two steps a frame", "one step a frame"])
def test_shorter_steps_state_one_and_a_half_times_the_lag_of_an_implicit_method(frames):
    """The lag of generalized-alpha is lag_constant (omega h)^2 of the angle. From half the step it differs by three
    quarters of that, which first order doubles."""
    h = 0.002
    told = found(oscillator(time_step=h, plotpoints=frames / 5.0))
    lag = lag_constant(0.8) * (OMEGA * h) ** 2 * TURNS
    assert told.steps == pytest.approx((h / 2.0, h / 3.0)) and told.step == pytest.approx(h / 3.0)
    assert told.changes == pytest.approx((0.75 * lag * START, 8.0 / 9.0 * lag * START), rel=0.05)
    assert told.distance == pytest.approx(1.5 * lag * START, rel=0.05)
    assert told.position == pytest.approx(0.75 * lag, rel=0.05)


def test_python_states_the_error_of_a_run_where_it_is_asked_to_as_the_command_does():
    """See the tests beside this one for what the stated error of this oscillator is."""
    h, text = 0.002, oscillator(time_step=0.002, plotpoints=250.0)
    lag = lag_constant(0.8) * (OMEGA * h) ** 2 * TURNS
    assert tautline.simulate(text).step_error is None
    usual, asked = (tautline.simulate(text, verify=verify).step_error for verify in (None, True))
    assert usual["steps"] == pytest.approx((2.0 * h, 4.0 * h))
    assert asked["steps"] == pytest.approx((h / 2.0, h / 3.0))
    assert asked["position"] == pytest.approx(0.75 * lag, rel=0.05)


def test_longer_steps_state_one_and_a_quarter_of_the_lag_of_an_implicit_method():
    """The order of two is observed, and Roache's factor of safety is what is left."""
    h = 0.0005
    told = found(oscillator(time_step=h, plotpoints=50), LONGER)
    assert told.steps == pytest.approx((2.0 * h, 4.0 * h))
    assert told.distance == pytest.approx(1.25 * lag_constant(0.8) * (OMEGA * h) ** 2 * TURNS * START, rel=0.05)


def test_longer_steps_that_do_not_divide_a_frame_evenly_are_counted_as_they_are_taken():
    """Five steps a frame become three and two: the ratios are 5/3 and 3/2."""
    h = 0.0004
    told = found(oscillator(time_step=h, plotpoints=1.0 / (5.0 * h)), LONGER)
    assert told.steps == pytest.approx((5.0 / 3.0 * h, 2.5 * h))
    assert told.distance == pytest.approx(1.25 * lag_constant(0.8) * (OMEGA * h) ** 2 * TURNS * START, rel=0.05)


def test_an_explicit_method_is_compared_with_shorter_steps():
    """RK4 is behind by (omega h)^4 / 120 of the angle, and by a sixteenth of that with half the step."""
    h = 0.02
    told = found(oscillator(**rk4(time_step=h, plotpoints=50)))
    assert told.position == pytest.approx(2.0 * 0.5 * 15.0 / 16.0 * (OMEGA * h) ** 4 / 120.0 * TURNS, rel=0.1)


@pytest.mark.parametrize("parts", [SHORTER, LONGER])
def test_an_error_beyond_a_hundredth_is_warned_of_and_a_smaller_one_is_not(parts):
    assert found(oscillator(time_step=0.001), parts).warning is None
    warning = found(oscillator(time_step=0.02), parts).warning
    steps = "0.01 s and 0.00667 s" if parts == SHORTER else "0.04 s"
    assert steps in warning and "position of node 1" in warning and "% of its motion" in warning
    # An oscillator has none, and is not told of it.
    assert "friction" not in warning


def test_only_a_scene_with_dry_friction_is_told_what_friction_does_to_shorter_steps():
    scene = validate(
        drillstring.scene.scene.DrillstringScene,
        drillstring.scene.scene.DrillstringScene.read(JWELL).document.replaced({("solver", "end"): (1.0, "end")}),
    )
    told = step_error(
        Subject(drillstring.application.Drillstring(), scene), simulate(drillstring.model.build.build(scene))
    )
    assert "what slips first" in told._replace(position=0.5).warning
    assert "what slips first" not in found(oscillator(time_step=0.02))._replace(position=0.5).warning


def test_a_force_that_hardly_varies_is_told_in_newtons_beside_what_it_varies_about():
    told = StepError(0.01, "tip", 1e-3, 0.02, "tension", 0.21 / 50.62, amplitude=0.45, largest=5062.0)
    assert "by 0.21 N (it varies by 0.9 N in 5.06 kN)" in told.warning
    assert "by 30 N, 15 %" in told._replace(force=0.15, amplitude=200.0, largest=5062.0).warning


@given(p=st.floats(0.5, 2.0), r1=st.floats(1.2, 3.0), r2=st.floats(1.2, 3.0))
def test_an_error_of_any_order_within_the_bounds_is_found_from_longer_steps_of_any_ratio(p, r1, r2):
    changes = r1**p - 1.0, (r1 * r2) ** p - r1**p
    assert from_longer(changes, (r1, r2)) == pytest.approx(1.25, rel=1e-6)


@given(p=st.floats(1.0, 4.0), share=st.floats(0.1, 0.6), other=st.floats(0.1, 0.6))
def test_what_shorter_steps_state_is_at_least_an_error_of_first_order_or_more(p, share, other):
    stated = from_shorter((1.0 - share**p, 1.0 - other**p), (share, other))
    assert 1.0 - 1e-12 <= stated <= 1.0 / (1.0 - max(share, other)) + 1e-12


def test_differences_that_do_not_fall_state_a_large_error_and_none_state_none():
    assert from_longer((1.0, 1.0), (2.0, 2.0)) == pytest.approx(1.25 / (2.0**0.5 - 1.0))
    assert from_longer((0.0, 1.0), (2.0, 2.0)) == pytest.approx(1.25 / 12.0)  # crossed by chance: not without error
    assert from_longer((0.0, 0.0), (2.0, 2.0)) == 0.0 and from_shorter((0.0, 0.0), (0.5, 1.0 / 3.0)) == 0.0


# events that are missed
class Jumping(Subject):
    """A point that jumps at an event which only steps below a threshold see."""

    threshold = 0.0

    def run(self, setting, *_, **__):
        return Trial(setting, "done", "", jump(setting.step, self.threshold))


def jump(step, threshold):
    time = np.linspace(0.0, 1.0, 11)
    position = np.zeros((11, 2, 3))
    position[:, 1, 0] = time * (1.0 + 0.01 * step) + JUMP * (time > 0.5) * (step < threshold)
    what = [Variable("position", ("time", "node", "axis"), "m", "")]
    attributes = {"step": step, "cpu_time": 0.0}
    return Result(None, (what, {"time": time, "position": position}, {}, attributes, {}))


JUMP = 0.02


@pytest.mark.parametrize("threshold", [0.9, 0.45], ids=["seen by the half", "seen by the third alone"])
def test_an_event_that_a_step_and_its_half_both_miss_is_in_the_stated_error(threshold):
    h = 0.01
    jumping = Jumping(*vars(subject(oscillator(time_step=h))).values())
    jumping.threshold = threshold * h
    told = step_error(jumping, jump(h, jumping.threshold))
    assert JUMP <= told.distance <= 2.01 * JUMP
    jumping.threshold = 0.0
    assert step_error(jumping, jump(h, 0.0)).distance < 0.01 * JUMP


@pytest.mark.parametrize(("static", "least"), [(0.3, 0.007), *studies((0.25, 0.015))])
def test_the_j_well_with_two_factors_of_friction_states_at_least_its_error(static, least):
    """Errors of 0.83 and 1.7 % at 1 ms, against the event-located run of other code."""
    from drillstring.application import Drillstring

    scene = drillstring.scene.scene.read(JWELL)
    keys = {("well", "wall", "friction", "static"): (static, "static")}
    scene = validate(type(scene), scene.document.replaced(keys))
    result = simulate(drillstring.model.build.build(scene))
    exact = planar.history(planar.TWO_FACTORS)[f"static_{static:g}"]
    off = np.abs(result["bit_depth"] - result["bit_depth"][0] - exact).max()
    way = np.abs(exact).max()
    told = step_error(Subject(Drillstring(), scene), result)
    assert off / way > least and told.position >= off / way and told.distance >= off
    assert told.position < 4.0 * off / way and "position of the bit" in told.warning


def test_only_friction_between_fixed_implicit_steps_takes_shorter_steps_unasked():
    scene = drillstring.scene.scene.read(JWELL)
    from drillstring.application import Drillstring

    def runs(**given):
        return runs_for(drillstring.model.build.build(Drillstring().with_overrides(scene, **given)))

    assert runs() == SHORTER
    assert SHORTER not in (runs(method="rk4"), runs(control="error", step_error=1e-5))
    assert runs_for(subject(oscillator()).model(Setting())) != SHORTER


def test_which_runs_are_made_unasked():
    """Friction takes shorter steps, explicit methods half the step, all else longer ones; controlled steps none."""
    model, explicit = (subject(text).model(Setting()) for text in (oscillator(), oscillator(**rk4())))
    assert runs_for(drillstring.model.build.build(drillstring.scene.scene.read(JWELL))) == SHORTER
    assert runs_for(model) == LONGER and runs_for(model, True) == SHORTER and runs_for(model, False) == ()
    assert runs_for(explicit) == (0.5,) and runs_for(explicit, True) == SHORTER


def test_runs_with_other_steps_cost_no_more_than_twice_what_a_run_with_half_the_step_did():
    assert 1.0 + sum(1.0 / part for part in SHORTER) <= 2.0 * (1.0 + 2.0)
    assert 1.0 + sum(1.0 / part for part in LONGER) <= 2.0


@pytest.mark.parametrize(("parts", "after"), [(SHORTER, 0), (SHORTER, 1), (LONGER, 0)])
def test_an_error_is_not_known_where_another_run_stops(monkeypatch, parts, after):
    text, calls, real = oscillator(), [], trial_module.simulate
    result = run(text)

    def stops(*given, **further):
        calls.append(given)
        if len(calls) > after:
            raise StoppedEarly(Status.NOT_FINITE, 1.0, "node 1")
        return real(*given, **further)

    monkeypatch.setattr(trial_module, "simulate", stops)
    why = estimate(subject(text), result, parts=parts)
    assert isinstance(why, str) and f"{result.attributes['step'] * parts[after]:.3g} s stopped" in why
    calls.clear()
    assert step_error(subject(text), result, parts=parts) is None


def test_another_run_that_takes_too_long_is_given_up_and_the_error_is_not_known(monkeypatch):
    text = oscillator()
    result = run(text)
    monkeypatch.setattr("tautline.study.trials.step_error.AT_LEAST", -1.0)
    monkeypatch.setattr("tautline.study.trials.step_error.ALLOWED", 0.0)
    assert "given up" in estimate(subject(text), result)


def test_where_nothing_moves_nothing_is_stated():
    text = oscillator(start=0.0)
    assert estimate(subject(text), run(text)) == "" and found(text) is None


def test_progress_goes_on_from_one_run_to_the_next():
    text, reached = oscillator(), []
    estimate(subject(text), run(text), progress=lambda *times: reached.append(times))
    simulated, wall = zip(*reached, strict=True)
    assert list(simulated) == sorted(simulated) and list(wall) == sorted(wall) and simulated[-1] == pytest.approx(10.0)


# on the command line
@pytest.fixture
def cable(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("bar.yaml").write_text(oscillator(time_step=0.02), encoding="utf8")
    return command_of(Cable(), monkeypatch, capsys)


def test_simulate_states_the_error_and_the_result_keeps_it(cable):
    code, out, err = cable("simulate", "bar.yaml", "--verify", "--json")
    report = only_object(out)
    assert code == 0 and report["step_error"]["steps"] == pytest.approx([0.01, 0.02 / 3.0])
    assert "estimated error due to the step" in err and "a half and a third of the step" in err
    kept = Result.read("bar.nc")
    assert kept.step_error == report["step_error"] and kept.warnings == report["warnings"]


def test_without_friction_longer_steps_are_taken_unasked_and_no_verify_leaves_them_out(cable):
    code, out, err = cable("simulate", "bar.yaml", "--json")
    report = only_object(out)
    assert (
        code == 0
        and report["step_error"]["steps"] == pytest.approx([0.04, 0.08])
        and "from two runs with longer steps" in err
    )
    assert any("--verify" in warning for warning in report["warnings"])
    code, out, err = cable("simulate", "bar.yaml", "--json", "--no-verify")
    assert code == 0 and only_object(out)["step_error"] is None and "estimat" not in err


def test_ctrl_c_in_another_run_keeps_the_first_and_says_what_is_not_known(cable, monkeypatch):
    def interrupted(*_, **__):
        raise Interrupted(1.0)

    monkeypatch.setattr(trial_module, "simulate", interrupted)
    code, out, _ = cable("simulate", "bar.yaml", "--verify", "--json")
    report = only_object(out)
    assert code == 0 and report["status"] == "done" and report["simulated_time"] == pytest.approx(5.0)
    assert report["step_error"] is None and any("not known" in warning for warning in report["warnings"])
