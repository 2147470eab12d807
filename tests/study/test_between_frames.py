"""What the stored frames of a run do not show is seen in a run with finer frames, and told."""

import json
import math

import pytest
from study.commands import command_of

import tautline
from crane.application import Crane
from tautline.results.result import Result
from tautline.study.trials.between_frames import BetweenFrames, Missed, frames_for_each
from tautline.study.trials.step_error import CUT_SHORT, LONGER, SHORTER, estimate, looked_at
from tautline.study.trials.trial import Setting, Subject

MASS, EA, LENGTH, V = 2000.0, 2e6, 20.0, 0.5
BOUNCE = f"""
title: A load that bounces on its rope below a drum at rest, V = {V} m/s at first
rope: {{mass_per_length: 0.001, axial_stiffness: {EA}, damping: 0, strain: engineering, diameter: 20 mm}}
bodies: [{{name: load, mass: {MASS}, position: [0.4, 0, -{LENGTH}], velocity: [0, 0, -{V}], guide: [x, y]}}]
path:
  - drum: {{name: w, center: [0, 0, 0], radius: 0.4, axis: [0, 1, 0], wrap: over, pay_out: 0}}
  - end:  {{name: hook, body: load}}
mesh: {{elements_per_span: 1}}
solver: {{method: generalized-alpha, step: 2 ms, end: 3 s}}
limits: [{{output: max_tension, above: 26 kN, name: load of the rope}}]
output: {{interval: 600 ms}}
"""
WEIGHT = MASS * 9.80665
SWING = V * math.sqrt(EA / LENGTH * MASS)
PEAK, LEAST = WEIGHT + SWING, WEIGHT - SWING
"""Largest and least tension by energy: the load swings by V sqrt(m / k) about rest, with k = EA / L."""


@pytest.fixture(scope="module")
def scene():
    return tautline.read(BOUNCE)


@pytest.fixture(scope="module")
def rough(scene):
    """With frames every 0.6 s of a period of 0.89 s."""
    return tautline.simulate(scene, verify=True)


def share(result, name):
    return next(one["share"] for one in result.between_frames["figures"] if one["name"] == name)


def test_extremes_between_frames_are_those_of_the_closed_form(rough):
    """The other run's frames at the same times show what those of the run do: both are right within its step."""
    shown = rough.headline["max_tension"]["value"], rough.headline["min_tension"]["value"]
    assert shown[0] < 0.99 * PEAK and shown[1] > 1.01 * LEAST
    assert share(rough, "max_tension") == pytest.approx(PEAK / shown[0] - 1.0, abs=3e-3)
    assert share(rough, "min_tension") == pytest.approx(1.0 - LEAST / shown[1], abs=3e-3)


def test_a_figure_that_frames_miss_is_warned_of_with_its_share_and_the_cure(rough):
    (told,) = [text for text in rough.warnings if text.startswith("the stored frames")]
    assert "600 ms apart" in told and "In frames every 60 ms" in told
    assert "the smallest tension is" in told and told.endswith(
        "Give a shorter output.interval and compare, such as 60 ms"
    )


def test_a_limit_that_is_kept_in_the_frames_alone_is_told(rough):
    assert rough.headline["max_tension"]["value"] < 26e3 < PEAK
    assert [one["passed"] for one in rough.limits if one["name"] == "load of the rope"] == [True]
    assert rough.between_frames["limits"] == ["load of the rope (max_tension)"]
    assert any("the limit 'load of the rope (max_tension)' is passed" in text for text in rough.warnings)


def test_of_a_run_whose_frames_show_its_extremes_nothing_is_told(scene):
    fine = tautline.simulate(scene.replace({"output.interval": "20 ms"}), verify=True)
    assert fine.between_frames["figures"] == [] and fine.between_frames["limits"] == []
    assert not any(text.startswith("the stored frames") for text in fine.warnings)
    assert fine.headline["max_tension"]["value"] == pytest.approx(PEAK, rel=5e-3)


@pytest.mark.parametrize("more", [{}, {"output.interval": "14 ms", "solver.end": "1.4 s"}])
@pytest.mark.parametrize("parts", [SHORTER, LONGER])
def test_finer_frames_do_not_change_the_estimated_error(scene, more, parts):
    """14 ms hold 7 steps of 2 ms, and 4 of a run with steps of 4 ms, which are then 3.5 ms."""
    subject = Subject(Crane(), scene.replace({"solver.control": "fixed", **more}))
    run = subject.run(Setting()).result
    alone = estimate(subject, run, parts=parts)
    beside, between = looked_at(subject, run, parts=parts, judged_by=Crane().build(subject.scene))
    assert beside.steps == pytest.approx(alone.steps, rel=1e-9)
    assert beside.distance == pytest.approx(alone.distance, rel=1e-6)
    assert between.interval == pytest.approx(14e-3 if more else 0.6)


def test_of_a_run_that_was_gone_on_with_the_frames_of_the_scene_are_looked_between(scene, tmp_path):
    begun = tautline.simulate(scene.replace({"output.interval": "10 ms"}), tmp_path / "begun.nc", end=0.6)
    whole = tautline.simulate(scene, resume=begun, verify=True)
    assert (whole.between_frames["interval"], whole.between_frames["finer"]) == pytest.approx((0.6, 0.06))


def test_what_the_first_run_showed_is_told_where_the_second_does_not_end(scene, monkeypatch):
    from tautline.study.trials import step_error

    runs, other = [], step_error._other

    def cut_short(*given):
        runs.append(given)
        return other(*given) if len(runs) == 1 else CUT_SHORT

    monkeypatch.setattr(step_error, "_other", cut_short)
    result = tautline.simulate(scene, verify=True)
    assert result.step_error is None and share(result, "max_tension") > 0.05


def test_the_command_prints_stores_and_reports_what_frames_miss(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bounce.yaml").write_text(BOUNCE)
    simulate = command_of(Crane(), monkeypatch, capsys)
    code, out, _ = simulate("simulate", "bounce.yaml", "-o", "bounce.nc", "--json")
    report = json.loads(out)
    assert code == 0 and report["between_frames"] == Result.read(tmp_path / "bounce.nc").between_frames
    assert report["between_frames"]["limits"] == ["load of the rope (max_tension)"]
    assert any(text.startswith("the stored frames") for text in report["warnings"])


class _Model:
    def __init__(self, interval, unknowns=100):
        self.solver = type("Solver", (), {"interval": interval})
        self.system = type("System", (), {"q": type("Q", (), {"size": unknowns})})
        self.own = 0


@pytest.mark.parametrize(
    ("interval", "own", "step", "frames", "count"),
    [
        (50e-3, 1e-3, 0.5e-3, 100, 10),
        (50e-3, 1e-3, 2e-3, 100, 5),
        (1e-3, 1e-3, 0.5e-3, 100, 1),  # a frame of each step has nothing between two
        (7e-3, 1e-3, 0.5e-3, 100, 7),
        (13e-3, 1e-3, 2e-3, 100, 7),  # its steps are 13 / 7 ms: none is longer than was asked for
        (5e-3, 1e-3, 2e-3, 100, 3),
        (11e-3, 1e-3, 1e-3, 100, 1),
        (50e-3, 1e-3, 0.5e-3, 100_000, 1),  # there is no room for more
        (50e-3, 50e-3, 100e-3, 100, 1),
    ],
)
def test_finer_frames_hold_whole_steps_and_none_is_shorter_than_a_step_of_the_run(interval, own, step, frames, count):
    assert frames_for_each(_Model(interval), own, step, frames) == count


TENSION, SHEAVE, SPEED = (
    Missed("max_tension", "largest tension at boom tip, side of winch, at 1.4 s", "N", 1e3, 1.35e3, 1.0, 0.35),
    Missed("max_sheave_load", "largest force on a sheave (tip)", "N", 2e3, 2.69e3, 1.0, 0.345),
    Missed("bit_speed_min", "least bit speed (bit)", "m/s", 1.0, 0.95, -1.0, 0.05),
)
RISE = Missed("rise", "rise", "m", 0.0, 0.25, 1.0, math.inf)
PRESSED = Missed("axial_force_min", "smallest axial force", "N", 2e-3, -0.271, -1.0, 136.5)


def test_one_figure_of_each_cause_is_named_and_the_others_are_counted():
    told = BetweenFrames(0.05, 0.0071429, (TENSION, SHEAVE, SPEED)).warned()
    assert "the largest tension at boom tip is about 35 % larger; the least bit speed is about 5 % smaller" in told
    assert "1 more figure differs by as much or less" in told and told.endswith("such as 7.15 ms")


def test_a_figure_that_is_far_off_or_of_another_sign_is_told_by_its_values():
    told = BetweenFrames(2.0, 0.2, (RISE, PRESSED))
    assert "the rise is about 0.25 m, and 0 m in the run" in told.warned()
    assert "the smallest axial force is about -0.271 N, and 0.002 N in the run" in told.warned()
    assert [one["share"] for one in told.record()["figures"]] == [None, 136.5]
    assert "2 s apart" in told.warned() and "every 0.2 s" in told.warned()


def test_of_a_cable_the_cure_names_what_its_file_has_for_frames():
    told = BetweenFrames(5.0, 0.5, (SPEED,)).warned("GeneralizedAlpha.plotpoints")
    assert told.endswith("Store more frames (GeneralizedAlpha.plotpoints), such as one every 0.5 s, and compare")
