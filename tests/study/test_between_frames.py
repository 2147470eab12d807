"""What the stored frames of a run do not show is seen in a run with finer frames, and told."""

import json
import math

import pytest
from study.commands import command_of

import tautline
from crane.application import Crane
from tautline.results.result import Result
from tautline.study.trials.between_frames import BetweenFrames, Missed, frames_for_each
from tautline.study.trials.step_error import SHORTER, estimate
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


def missed(result, name):
    return next(one for one in result.between_frames["figures"] if one["name"] == name)


def test_the_largest_and_least_tension_between_frames_are_those_of_the_closed_form(rough):
    assert rough.headline["max_tension"]["value"] < 0.99 * PEAK
    assert missed(rough, "max_tension")["finer"] == pytest.approx(PEAK, rel=2e-3)
    assert missed(rough, "min_tension")["finer"] == pytest.approx(LEAST, rel=5e-3)


def test_a_figure_that_frames_miss_is_warned_of_with_its_share_and_the_cure(rough):
    (told,) = [text for text in rough.warnings if text.startswith("the stored frames")]
    share = PEAK / rough.headline["max_tension"]["value"] - 1.0
    assert missed(rough, "max_tension")["share"] == pytest.approx(share, rel=0.05)
    assert "600 ms apart" in told or "0.6 s apart" in told
    assert "the largest tension is" in told and "Give a shorter output.interval" in told


def test_a_limit_that_is_kept_in_the_frames_alone_is_told(rough):
    assert rough.headline["max_tension"]["value"] < 26e3 < PEAK
    assert [one["passed"] for one in rough.limits if one["name"] == "load of the rope"] == [True]
    assert rough.between_frames["limits"] == ["load of the rope (max_tension)"]
    assert any("the limit of load of the rope (max_tension) is passed" in text for text in rough.warnings)


def test_of_a_run_whose_frames_show_its_extremes_nothing_is_told(scene):
    fine = tautline.simulate(scene.replace({"output.interval": "20 ms"}), verify=True)
    assert fine.between_frames["figures"] == [] and fine.between_frames["limits"] == []
    assert not any(text.startswith("the stored frames") for text in fine.warnings)
    assert fine.headline["max_tension"]["value"] == pytest.approx(PEAK, rel=5e-3)


def test_finer_frames_do_not_change_the_estimated_error(scene, rough):
    """It is that of the frames that both runs have."""
    subject = Subject(Crane(), scene)
    alone = estimate(subject, subject.run(Setting()).result, parts=SHORTER)
    assert alone.between is None
    assert alone.distance == pytest.approx(rough.step_error["distance"], rel=1e-6)


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
        (50e-3, 1e-3, 0.5e-3, 100, 10),  # 100 steps in a frame, of which 16 frames would not be even
        (50e-3, 1e-3, 2e-3, 100, 5),
        (1e-3, 1e-3, 0.5e-3, 100, 1),  # a frame of each step has nothing between two
        (7e-3, 1e-3, 0.5e-3, 100, 7),
        (13e-3, 1e-3, 2e-3, 100, 6),
        (50e-3, 1e-3, 0.5e-3, 100_000, 1),  # there is no room for more
        (50e-3, 50e-3, 100e-3, 100, 1),
    ],
)
def test_finer_frames_hold_whole_steps_and_none_is_shorter_than_a_step_of_the_run(interval, own, step, frames, count):
    assert frames_for_each(_Model(interval), own, step, frames) == count


def test_a_figure_that_reads_0_in_the_frames_is_told_by_its_value():
    missed = Missed("bit_speed_max", "largest bit speed", "m/s", 0.0, 0.25)
    told = BetweenFrames(0.05, 0.0071429, 0.0071429, (missed,)).warned()
    assert "the largest bit speed is 0.25 m/s in place of 0" in told and "such as 7.2 ms" in told
    assert BetweenFrames(0.05, 0.01, 0.01, (missed,)).record()["figures"][0]["share"] is None
