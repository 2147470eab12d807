"""A brake or a motor that is too weak for its load is warned of, and a brake that slips is told of after the run."""

from __future__ import annotations

import re

import numpy as np
import pytest

import tautline
from crane.application import Crane
from crane.results.slipping_brakes import slip_of

MASS, GRAVITY, RADIUS, INERTIA = 5000.0, 9.81, 0.5, 5000.0
WEIGHT = MASS * GRAVITY
MOMENT = WEIGHT * RADIUS
"""What the load turns the drum with, N m; the rope weighs next to nothing."""
SCENE = """
title: Load on a drum
rope: {{mass_per_length: 0.001, axial_stiffness: 40 MN, damping: 5 ms}}
bodies:
  - {{name: load, mass: {mass}, position: [10.2, 0, -1]}}
path:
  - drum: {{name: winch, center: [0, 0, 6], radius: {radius}, axis: [0, 1, 0], wrap: over, inertia: {inertia}, {drive}}}
  - sheave: {{name: tip, center: [10, 0, 30], radius: 0.2, axis: [0, 1, 0], wrap: over{law}}}
  - end: {{name: hook, body: load}}
mesh: {{elements_per_span: 1}}
{more}
solver: {{step: 10 ms, end: 2 s}}
output: {{interval: 50 ms}}
"""


def read(drive, law="", more=""):
    return tautline.read(SCENE.format(mass=MASS, radius=RADIUS, inertia=INERTIA, drive=drive, law=law, more=more))


def told(scene):
    return [one for one in Crane().warnings(scene) if "does not hold the load" in one.text]


def braked(share, more=""):
    return f"torque: 0, brake: {{torque: {share * MOMENT}{more}}}"


@pytest.mark.parametrize(
    ("drive", "key"),
    [
        (braked(0.9), "brake.torque"),
        (braked(0.9, ", closed: 1"), "brake.torque"),
        (braked(0.9, ", until: 1 s"), "brake.torque"),
        (f"torque: {0.5 * MOMENT}, brake: {{torque: {0.4 * MOMENT}}}", "brake.torque"),
        (f"torque: -{0.2 * MOMENT}, brake: {{torque: {1.1 * MOMENT}}}", "brake.torque"),
        (f"torque: {0.9 * MOMENT}", "torque"),
        (f"torque: {0.5 * MOMENT}, friction_torque: {0.4 * MOMENT}", "torque"),
    ],
)
def test_what_cannot_hold_the_weight_times_the_radius_is_warned_of_with_the_torque_that_is_needed(drive, key):
    (one,) = told(read(drive))
    assert one.where == f"path[0].drum.{key}" and "falls from t = 0" in one.text
    needed = 1e3 * float(re.search(r"it takes ([0-9.]+) kN m or more", one.text)[1])
    motor = float(re.search(r"torque: (-?[0-9.]+)", drive)[1]) if key == "brake.torque" else 0.0
    friction = float((re.search(r"friction_torque: ([0-9.]+)", drive) or [0, 0])[1])
    assert needed == pytest.approx(MOMENT - motor - friction, rel=2e-3)


@pytest.mark.parametrize(
    "drive",
    [
        braked(1.02),
        f"torque: {MOMENT:.4g}",
        f"torque: {1.2 * MOMENT}",
        f"torque: {0.6 * MOMENT}, brake: {{torque: {0.5 * MOMENT}}}",
        f"torque: 0, friction_torque: {1.1 * MOMENT}",
        # Left to the operator: an open brake, a motor that follows a function, a winch that holds a tension or a speed.
        braked(0.5, ", closed: 0"),
        braked(0.5, ", closed: {ramp: {to: 1, over: 1 s}}"),
        "torque: {ramp: {to: 30 kN m, over: 1 s}}",
        f"tension: {0.5 * WEIGHT}",
    ],
)
def test_what_holds_and_what_is_let_go_on_purpose_is_not_warned_of(drive):
    assert told(read(drive)) == []


def test_a_sheave_that_takes_a_share_of_the_tension_helps_the_brake():
    assert told(read(braked(0.92), ", law: {efficiency: 0.9}")) == []
    (one,) = told(read(braked(0.88), ", law: {efficiency: 0.9}"))
    assert "with the friction of the sheaves on its side" in one.text


def test_a_load_that_stands_on_the_ground_is_not_said_to_fall():
    assert told(read(braked(0.5), more="ground: {level: -1, stiffness: 1.0e7, damping: 1.0e5}")) == []
    assert told(read(braked(0.5), more="ground: {level: -2, stiffness: 1.0e7, damping: 1.0e5}"))


def slips(result):
    return [text for text in result.warnings if "slipped while it was closed" in text]


def test_a_brake_that_is_too_weak_lets_the_load_fall_as_its_closed_form_and_the_run_says_so():
    share = 0.8
    result = tautline.simulate(read(braked(share)))
    # m g R - M = (m R^2 + I) alpha
    a = (1.0 - share) * MOMENT * RADIUS / (MASS * RADIUS**2 + INERTIA)
    fallen = 0.5 * a * 2.0**2
    assert -result.headline["rise"]["value"] == pytest.approx(fallen, rel=0.02)
    (text,) = slips(result)
    assert "the brake of winch" in text and "ran out" in text
    rope = float(re.search(r"([0-9.]+) m of rope", text)[1])
    assert rope == pytest.approx(fallen, rel=0.02)
    assert float(re.search(r"from t = ([0-9.]+) s", text)[1]) <= 0.15


def test_the_torque_that_is_asked_for_holds_the_load_and_nothing_is_said():
    (one,) = told(read(braked(0.8)))
    needed = 1e3 * float(re.search(r"it takes ([0-9.]+) kN m or more", one.text)[1])
    result = tautline.simulate(read(f"torque: 0, brake: {{torque: {1.002 * needed}}}"))
    assert slips(result) == [] and abs(result.headline["rise"]["value"]) < 1e-3


def test_a_brake_that_opens_and_lets_the_load_go_has_not_slipped():
    result = tautline.simulate(read(braked(2.0, ", until: 1 s")))
    assert result.headline["rise"]["value"] < -0.5 and slips(result) == []


def test_rope_that_passes_an_open_brake_is_no_slip_and_each_closure_begins_anew():
    time = np.linspace(0.0, 1.0, 11)
    paid_out = np.where(time < 0.45, time, 0.4)
    assert slip_of(time, paid_out, time > 0.45, 0.01) is None
    begin, passed = slip_of(time, paid_out, time > 0.15, 0.01)
    assert (begin, passed) == (pytest.approx(0.2), pytest.approx(0.2))
    begin, passed = slip_of(time, -paid_out, np.ones(11, bool), 0.01)
    assert (begin, passed) == (0.0, pytest.approx(-0.4))
