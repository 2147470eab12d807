"""What a run with half the step tells of a run's own, against what the methods are known to do to an oscillation."""

import sys
from pathlib import Path

import pytest
from oscillators import OMEGA, START, lag_constant, oscillator, rk4, run, subject
from test_study_verbs import only_object

import drillstring.build
import drillstring.scene
from tautline.cable.application import Cable
from tautline.cli.main import make_app
from tautline.cli.run import run as command_line
from tautline.integrators.status import Interrupted, Status, StoppedEarly
from tautline.study import step_error as module
from tautline.study.step_error import step_error, tells_nothing_itself

JWELL = Path(__file__).parents[2] / "data" / "jwell.yaml"
TURNS = OMEGA * 5.0
"""Angle of the oscillator at its end, rad."""


def found(text):
    return step_error(subject(text), run(text))


@pytest.mark.parametrize("frames", [1250, 2500], ids=["two steps a frame", "one step a frame"])
def test_an_implicit_method_is_behind_its_half_step_by_three_quarters_of_its_lag(frames):
    """The lag of generalized-alpha is lag_constant (omega h)^2 of the angle: itself, less a quarter as much."""
    h = 0.002
    told = found(oscillator(time_step=h, plotpoints=frames / 5.0))
    lag = lag_constant(0.8) * (OMEGA * h) ** 2 * TURNS
    assert told.step == pytest.approx(0.5 * h)
    assert told.distance == pytest.approx(0.75 * lag * START, rel=0.05)
    assert told.position == pytest.approx(0.375 * lag, rel=0.05)


def test_an_explicit_method_is_compared_with_half_its_step():
    """RK4 is behind by (omega h)^4 / 120 of the angle, and by a sixteenth of that with half the step."""
    h = 0.02
    told = found(oscillator(**rk4(time_step=h, plotpoints=50)))
    assert told.step == pytest.approx(0.5 * h)
    assert told.position == pytest.approx(0.5 * 15.0 / 16.0 * (OMEGA * h) ** 4 / 120.0 * TURNS, rel=0.1)


def test_a_difference_beyond_a_hundredth_is_warned_of_and_a_smaller_one_is_not():
    assert found(oscillator(time_step=0.002)).warning is None
    warning = found(oscillator(time_step=0.02)).warning
    assert "steps of 0.01 s" in warning and "position of node 1" in warning and "% of its way" in warning


def test_only_friction_between_fixed_implicit_steps_is_looked_at_unasked():
    scene = drillstring.scene.read(JWELL)
    from drillstring.application import Drillstring

    def telling(**given):
        return tells_nothing_itself(drillstring.build.build(Drillstring().with_overrides(scene, **given)))

    assert telling() and not telling(method="rk4") and not telling(control="error", step_error=1e-5)
    assert not tells_nothing_itself(subject(oscillator()).model(module.Setting()))


def test_a_second_run_that_fails_or_cannot_be_leaves_nothing_to_tell(monkeypatch):
    text = oscillator()
    result = run(text)

    def stops(*_, **__):
        raise StoppedEarly(Status.NOT_FINITE, 1.0, "node 1")

    monkeypatch.setattr(module, "simulate", stops)
    assert step_error(subject(text), result) is None


# on the command line
@pytest.fixture
def cable(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("bar.yaml").write_text(oscillator(time_step=0.02), encoding="utf8")

    def command(*arguments):
        monkeypatch.setattr(sys, "argv", ["cable", *arguments])
        with pytest.raises(SystemExit) as left:
            command_line(make_app(Cable()))
        captured = capsys.readouterr()
        return left.value.code or 0, captured.out, captured.err

    return command


def test_simulate_tells_it_where_it_is_asked_to_and_the_result_keeps_it(cable):
    from tautline.results.result import Result

    code, out, err = cable("simulate", "bar.yaml", "--verify", "--json")
    report = only_object(out)
    assert code == 0 and report["step_error"]["step"] == pytest.approx(0.01)
    assert "change by steps of 0.01 s" in err and any("steps of 0.01 s" in warning for warning in report["warnings"])
    kept = Result.read("bar.nc")
    assert kept.step_error == report["step_error"] and kept.warnings == report["warnings"]
    code, out, err = cable("simulate", "bar.yaml", "--json")
    assert code == 0 and only_object(out)["step_error"] is None and "once more" not in err


def test_ctrl_c_in_the_second_run_keeps_the_first_and_says_what_is_not_known(cable, monkeypatch):
    def interrupted(*_, **__):
        raise Interrupted(1.0)

    monkeypatch.setattr(module, "simulate", interrupted)
    code, out, _ = cable("simulate", "bar.yaml", "--verify", "--json")
    report = only_object(out)
    assert code == 0 and report["status"] == "done" and report["simulated_time"] == pytest.approx(5.0)
    assert any("not known" in warning for warning in report["warnings"])
