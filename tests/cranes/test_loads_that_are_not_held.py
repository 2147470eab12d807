"""A brake or a motor that is too weak for its load is warned of, and a brake that slips is told of after the run."""

from __future__ import annotations

import re

import numpy as np
import pytest

import tautline
from crane.application import Crane
from crane.results.slipping_brakes import SLIPS, TURNS, closing, closures_of, slips_of
from tautline import SceneError, StoppedEarly
from tautline.live.errors import SimulationError

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
solver: {{step: 10 ms, end: {end} s}}
output: {{interval: 50 ms}}
"""
SUM = "{sum: [{constant: %s}, {harmonic: {amplitude: %s, period: 1 s}}, {harmonic: {amplitude: %s, period: 1 s}}]}"


def read(drive, law="", more="", end=2.0):
    values = {"mass": MASS, "radius": RADIUS, "inertia": INERTIA, "drive": drive, "law": law, "more": more, "end": end}
    return tautline.read(SCENE.format(**values))


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
        (f"tension: {1.2 * WEIGHT}, torque_limit: {0.9 * MOMENT}", "torque_limit"),
        (f"tension: {{ramp: {{to: {1.2 * WEIGHT}, over: 1 s}}}}, torque_limit: {0.9 * MOMENT}", "torque_limit"),
        (f"tension: {1.2 * WEIGHT}, torque_limit: {0.4 * MOMENT}, friction_torque: {0.5 * MOMENT}", "torque_limit"),
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
        f"tension: {{ramp: {{from: {0.5 * WEIGHT}, to: {WEIGHT}, over: 1 s}}}}",
        f"tension: {WEIGHT}, torque_limit: {1.02 * MOMENT}",
        f"tension: {0.5 * WEIGHT}, friction_torque: {0.55 * MOMENT}",
        f"tension: 0, brake: {{torque: {1.02 * MOMENT}}}",
        # A motor that seeks more than the brake lets it have pulls at its limit: the brake bears the rest.
        f"tension: {1.1 * WEIGHT}, gains: {{proportional: 5}}, torque_limit: {0.6 * MOMENT}, "
        f"brake: {{torque: {0.5 * MOMENT}}}",
    ],
)
def test_what_holds_and_what_is_let_go_on_purpose_is_not_warned_of(drive):
    assert told(read(drive)) == []


@pytest.mark.parametrize("held", [0.0, 0.5, 0.9])
def test_a_winch_that_is_to_hold_less_tension_than_the_load_pulls_with_is_warned_of(held):
    (one,) = told(read(f"tension: {held * WEIGHT}"))
    assert one.where == "path[0].drum.tension" and "falls from t = 0" in one.text
    assert 1e3 * float(re.search(r"a tension of ([0-9.]+) kN or more", one.text)[1]) == pytest.approx(WEIGHT, rel=2e-3)


def test_a_motor_that_pays_out_against_its_brake_adds_to_what_the_brake_has_to_hold():
    """At rest the rope pulls with the weight: the controller asks for R (T + P (T - m g)), 0.9 - 2 x 0.1 of it."""
    (one,) = told(read(f"tension: {0.9 * WEIGHT}, gains: {{proportional: 2}}, brake: {{torque: {0.2 * MOMENT}}}"))
    needed = 1e3 * float(re.search(r"it takes ([0-9.]+) kN m or more", one.text)[1])
    assert needed == pytest.approx(0.3 * MOMENT, rel=2e-3)


@pytest.mark.parametrize(("held", "gain"), [(0.9, 2.0), (0.9, 10.0), (0.95, 10.0), (0.5, 1.0)])
def test_a_gain_pays_out_against_the_friction_of_a_drum_with_what_the_tension_lacks(held, gain):
    """It holds where (1 + P) (m g - T) R is no more than the friction; else the load falls by the rest of that."""
    friction = 0.2
    more = f"gains: {{proportional: {gain}}}, friction_torque: {friction * MOMENT}"
    scene = read(f"tension: {held * WEIGHT}, {more}")
    (one,) = told(scene)
    needed = 1e3 * float(re.search(r"a tension of ([0-9.]+) kN or more", one.text)[1])
    assert needed == pytest.approx((1.0 - friction / (1.0 + gain)) * WEIGHT, rel=2e-3)
    a = ((1.0 + gain) * (1.0 - held) - friction) * WEIGHT / (INERTIA / RADIUS**2 + (1.0 + gain) * MASS)
    assert np.asarray(tautline.simulate(scene)["paid_out"])[-1, 0] == pytest.approx(0.5 * a * 2.0**2, rel=0.01)
    enough = read(f"tension: {1.002 * needed}, {more}")
    assert told(enough) == []
    assert abs(np.asarray(tautline.simulate(enough)["paid_out"])[-1, 0]) < 1e-3


@pytest.mark.parametrize(
    "tension", ["-5 kN", "{ramp: {to: -1 kN, over: 1 s}}", "{table: {time: [0, 1], value: [0, -1]}}"]
)
def test_a_tension_below_zero_is_refused_for_a_rope_only_pulls(tension):
    with pytest.raises(SceneError, match=r"path\[0\].drum.tension.*a rope only pulls"):
        read(f"tension: {tension}")


@pytest.mark.parametrize(
    ("tension", "least"),
    [
        ("{harmonic: {amplitude: 20 kN, period: 1 s}}", "-20000 N at t = 0.75 s"),
        (SUM % ("10 kN", "6 kN", "6 kN"), "-2000 N at t = 0.75 s"),
        ("{sum: [{ramp: {to: 50 kN, over: 1 s}}, {constant: -30 kN}]}", "-30000 N at t = 0 s"),
    ],
)
def test_a_tension_that_swings_below_zero_in_the_run_is_refused_with_its_least_and_when_it_is_held(tension, least):
    with pytest.raises(SceneError) as told:
        Crane().warnings(read(f"tension: {tension}"))
    assert f"path[0].drum.tension: is {least}, and a rope only pulls" in str(told.value)


@pytest.mark.parametrize("tension", [SUM % ("10 kN", "6 kN", "-6 kN"), SUM % ("0.3 N", "0.1 N", "0.2 N")])
def test_a_sum_that_stays_above_zero_or_comes_down_to_it_is_not_refused(tension):
    """Of the one both waves cancel; the other is 0 at its least, and 6e-17 below in binary numbers."""
    assert not [one for one in Crane().warnings(read(f"tension: {tension}")) if one.where == "path[0].drum.tension"]


@pytest.mark.parametrize(
    ("closed", "most"),
    [
        ("1.2", "1.2 at some time"),
        ("{sum: [{constant: 1}, {constant: 1}]}", "2 at t = 0 s"),
        ("{sum: [{ramp: {to: 1, over: 1}}, {ramp: {to: 1, over: 2}}]}", "2 at t = 2 s"),
        ("{harmonic: {amplitude: 0.6, period: 4 s, mean: 0.5}}", "1.1 at t = 1 s"),
        ("{harmonic: {amplitude: 0.5, period: 2 s}}", "-0.5 at t = 1.5 s"),
        ("{chirp: {amplitude: 0.9, period: 2 s, rate: 1.0e-9}}", "-0.9 at t = 1.5 s"),
    ],
)
def test_a_share_beyond_0_to_1_that_a_brake_is_closed_by_is_refused_however_it_is_written(closed, most):
    with pytest.raises(SceneError) as told:
        Crane().warnings(read(braked(2.0, f", closed: {closed}")))
    (problem,) = told.value.problems
    assert (problem.key, problem.cause) == ("path[0].drum.brake.closed", f"is {most}")
    assert problem.cure == "give a share from 0, open, to 1, closed"


@pytest.mark.parametrize(
    "closed",
    [
        "{harmonic: {amplitude: 0.5, period: 4 s, mean: 0.5}}",
        "{sum: [{harmonic: {amplitude: 0.1, period: 4 s, mean: 0.2}}, {constant: 0.7}]}",
        "{table: {time: [0, 1, 1.1, 2], value: [0, 0, 1, 1]}}",
        "{sum: [{table: {time: [0, 1, 1.1, 2], value: [0, 0, 1, 1]}}, {constant: 0}]}",
    ],
)
def test_a_share_of_0_to_1_is_taken_also_where_the_curve_of_a_table_swings_beyond_its_rows(closed):
    """The natural cubic of that table goes from -0.14 to 1.14."""
    Crane().warnings(read(braked(2.0, f", closed: {closed}")))


def test_a_simulation_takes_no_tension_below_zero():
    sim = tautline.Simulation(read(f"tension: {WEIGHT}"), inputs=["winch.tension"], keep=False)
    with pytest.raises(SimulationError, match=r"winch.tension = -5000 is not 0 or more"):
        sim.inputs["winch.tension"] = -5000.0
    sim.inputs["winch.tension"] = 0.0
    # What a load cell tells of a slack rope, with its rate, is held at 0 by what reads it.
    assert sim.inputs.within("winch.tension", [-3.0, -1.0, 2.0]) == (0.0, 0.0, 0.0)
    assert sim.inputs.within("winch.tension", [3.0, -1.0, 2.0]) == (3.0, -1.0, 2.0)


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


def sinking(torque, closed):
    """A load that sinks on its motor, 20 of 24.5 kN m, and a brake in kN m that closes as told."""
    text = f"torque: 20 kN m, brake: {{torque: {torque} kN m, closed: {{table: {closed}}}}}"
    return tautline.simulate(read(text, end=3.0))


CLOSES = "{time: [0, 1, 1.1, 10], value: [0, 0, 1, 1]}"


@pytest.mark.parametrize("torque", [12.0, 20.0, 30.0])
def test_a_brake_that_stops_a_load_that_moves_is_not_said_to_slip(torque):
    result = sinking(torque, CLOSES)
    speed, passed = np.asarray(result["pay_out_speed"])[:, 0], np.asarray(result["paid_out"])[:, 0]
    closed = np.asarray(result.time) > 1.1 - 1e-9
    # The drum turned as the brake closed, and by more than what counts as slip.
    assert speed[closed][0] > 0.1 * RADIUS and abs(speed[-1]) < 1e-3
    assert passed[-1] - passed[closed][0] > 0.01 * RADIUS
    assert not [text for text in result.warnings if "brake" in text]


def test_a_brake_that_is_too_weak_to_stop_the_load_is_said_not_to_have_stopped_it():
    result = sinking(3.0, CLOSES)
    (text,) = [text for text in result.warnings if "brake" in text]
    passed = np.asarray(result["paid_out"])[:, 0]
    rope = passed[-1] - passed[np.asarray(result.time) > 1.1 - 1e-9][0]
    assert "did not stop it" in text and "closed at t = 1.1 s" in text
    assert float(re.search(r"([0-9.]+) m of rope ran out", text)[1]) == pytest.approx(rope, rel=5e-3)


def test_a_brake_that_opens_before_the_load_has_stopped_is_said_not_to_have_stopped_it():
    result = sinking(30.0, "{time: [0, 1, 1.1, 1.2, 1.3, 10], value: [0, 0, 1, 1, 0, 0]}")
    (text,) = [text for text in result.warnings if "brake" in text]
    assert "on a drum that turned, and did not stop it" in text and "keep it closed for longer" in text


def test_a_brake_that_holds_a_load_and_then_slips_is_warned_of_with_the_rope_since_it_held():
    # The motor lets go at 2 s: what the brake had stopped slips from there.
    motor = "{table: {time: [0, 2, 2.1, 10], value: [20.0e3, 20.0e3, -20.0e3, -20.0e3]}}"
    text = f"torque: {motor}, brake: {{torque: 30 kN m, closed: {{table: {CLOSES}}}}}"
    result = tautline.simulate(read(text, end=3.0))
    (said,) = slips(result)
    time, passed = np.asarray(result.time), np.asarray(result["paid_out"])[:, 0]
    rope = passed[-1] - passed[np.searchsorted(time, 1.9)]
    assert 1.9 < float(re.search(r"from t = ([0-9.]+) s", said)[1]) < 2.3
    assert float(re.search(r"([0-9.]+) m of rope ran out", said)[1]) == pytest.approx(rope, rel=5e-3)


def test_rope_that_passes_an_open_brake_is_no_slip_and_each_closure_begins_anew():
    def spans(closed):
        return closures_of(time, lambda moments: closed[np.searchsorted(time, moments - 1e-9)], np.zeros(0))

    time = np.linspace(0.0, 1.0, 11)
    paid_out, speed = np.where(time < 0.45, time, 0.4), np.where(time < 0.45, 1.0, 0.0)
    assert slips_of(time, paid_out, speed, 0.1, spans(time > 0.45), 0.01) == []
    # It is stopped in the closure.
    assert slips_of(time, paid_out, speed, 0.1, spans(time > 0.15), 0.01) == []
    # It is let go before.
    (one,) = slips_of(time, paid_out, speed, 0.1, spans((time > 0.15) & (time < 0.35)), 0.01)
    assert one == (pytest.approx(0.2), pytest.approx(0.1), False, False)
    # It begins at rest.
    speed[0] = 0.0
    (one,) = slips_of(time, -paid_out, -speed, 0.1, spans(np.ones(11, bool)), 0.01)
    assert one == (0.0, pytest.approx(-0.4), True, False)
    # Held in two closures, and more in the second: its own begin stands beside its rope.
    paid_out, speed = np.array([0, 0, 2, 2, 9, 9, 9, 12, 12, 12, 12.0]), np.zeros(11)
    closed = np.array([1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1], bool)
    (one,) = slips_of(time, paid_out, speed, 0.1, spans(closed), 0.01)
    assert one == (pytest.approx(0.6), pytest.approx(3.0), True, False)


def test_a_result_of_statistics_says_nothing_of_a_brake_that_was_open_between_its_windows():
    # The load is lowered from 10 to 15 s with the brake open; the windows lie round the jerks at 3 s and 20 s.
    motor = (
        "{table: {time: [0, 3, 3.1, 3.5, 3.6, 10, 10.1, 12.5, 12.6, 15, 15.1, 20, 20.1, 20.3, 20.4, 40], value: "
        "[24525, 24525, 30525, 30525, 24525, 24525, 24125, 24125, "
        "24925, 24925, 24525, 24525, 2000, 2000, 24525, 24525]}}"
    )
    closed = (
        "{table: {time: [0, 3, 3.05, 3.5, 3.55, 10, 10.05, 15, 15.05, 20, 20.05, 20.3, 20.35, 40], "
        "value: [1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1]}}"
    )
    text = SCENE.format(
        mass=MASS, radius=RADIUS, inertia=INERTIA, law="", more="", end=25.0,
        drive=f"torque: {motor}, brake: {{torque: 60 kN m, closed: {closed}}}",
    )  # fmt: skip
    kept = "interval: 50 ms, keep: statistics, windows: 1 s, of: [tension]"
    result = tautline.simulate(tautline.read(text.replace("interval: 50 ms", kept)))
    time, passed = np.asarray(result.time), np.asarray(result["paid_out"])[:, 0]
    gap = int(np.argmax(np.diff(time)))
    assert time[gap] < 10.0 and time[gap + 1] > 15.0 and passed[gap + 1] - passed[gap] > 0.1
    assert not [text for text in result.warnings if "brake" in text]


def test_of_two_closures_that_do_not_stop_a_drum_the_one_with_the_most_rope_is_told_with_its_own_begin():
    result = sinking(3.0, "{time: [0, 0.5, 0.51, 0.7, 0.71, 1.5, 1.51, 10], value: [0, 0, 1, 1, 0, 0, 1, 1]}")
    (text,) = [text for text in result.warnings if "brake" in text]
    begin = float(re.search(r"closed at t = ([0-9.]+) s", text)[1])
    frame = float(re.search(r"from the frame at t = ([0-9.]+) s on", text)[1])
    assert begin == pytest.approx(1.51) and frame == pytest.approx(1.55)
    time, passed = np.asarray(result.time), np.asarray(result["paid_out"])[:, 0]
    rope = passed[-1] - passed[np.searchsorted(time, frame - 1e-9)]
    assert float(re.search(r"([0-9.]+) m of rope ran out", text)[1]) == pytest.approx(rope, rel=5e-3)


@pytest.mark.parametrize("interval", ["50 ms", "500 ms", "1 s"])
def test_a_brake_that_is_opened_between_two_frames_has_not_slipped(interval):
    closed = "{table: {time: [0, 2.1, 2.15, 2.85, 2.9, 10], value: [1, 1, 0, 0, 1, 1]}}"
    text = SCENE.format(
        mass=MASS, radius=RADIUS, inertia=INERTIA, law="", more="", end=5.0,
        drive=f"torque: 20 kN m, brake: {{torque: 60 kN m, closed: {closed}}}",
    )  # fmt: skip
    result = tautline.simulate(tautline.read(text.replace("interval: 50 ms", f"interval: {interval}")))
    passed = np.asarray(result["paid_out"])[:, 0]
    assert passed[-1] - passed[0] > 0.05
    assert not [text for text in result.warnings if "brake" in text]


def test_a_closure_ends_where_a_brake_opens_between_frames_be_it_only_at_a_corner_of_its_table():
    time = np.arange(6.0)
    corner = 2.0 + 1.0 / 64.0
    assert closures_of(time, lambda moments: moments != corner, np.array([corner])) == [(0, 3), (3, 6)]
    assert closures_of(time, lambda moments: np.abs(moments - 3.5) > 0.06, np.zeros(0)) == [(0, 4), (4, 6)]
    assert closures_of(time, lambda moments: moments < 2.5, np.array([-1.0, 2.5, 9.0])) == [(0, 3)]
    assert closures_of(time, lambda moments: moments < -1.0, np.array([2.5])) == []


@pytest.mark.parametrize("closed", [0.99, 0.5])
def test_a_brake_that_stays_partly_closed_holds_with_that_share_of_its_torque(closed):
    # Half the load's torque at 0.99, and at 0.5 a brake that would hold if it were closed.
    torque = {0.99: 0.5, 0.5: 1.5}[closed]
    scene = read(braked(torque, f", closed: {closed}"))
    (one,) = told(scene)
    assert f"closed to {closed:g}, that is" in one.text and "of brake.torque times brake.closed" in one.text
    acting = 1e3 * float(re.search(r"that is ([0-9.]+) kN m", one.text)[1])
    needed = 1e3 * float(re.search(r"it takes ([0-9.]+) kN m or more", one.text)[1])
    assert acting == pytest.approx(torque * closed * MOMENT, rel=2e-3) and needed == pytest.approx(MOMENT, rel=2e-3)
    # m g R - M c = (m R^2 + I) alpha
    a = (1.0 - torque * closed) * MOMENT * RADIUS / (MASS * RADIUS**2 + INERTIA)
    (text,) = slips(tautline.simulate(scene))
    assert float(re.search(r"([0-9.]+) m of rope ran out", text)[1]) == pytest.approx(0.5 * a * 2.0**2, rel=0.02)
    assert "give brake.torque times brake.closed more than" in text


def test_a_brake_that_stays_partly_closed_and_holds_is_not_warned_of():
    scene = read(braked(2.1, ", closed: 0.5"))
    assert told(scene) == [] and slips(tautline.simulate(scene)) == []


def test_a_brake_that_still_slows_the_drum_down_as_the_run_ends_is_not_said_to_be_too_weak():
    result = sinking(30.0, "{time: [0, 2.7, 2.8, 10], value: [0, 0, 1, 1]}")
    speed = np.asarray(result["pay_out_speed"])[:, 0]
    assert speed[-1] > 0.1 * RADIUS
    (text,) = [text for text in result.warnings if "brake" in text]
    assert "The run ended while it still turned" in text and "solver.end" in text
    assert "did not stop" not in text and "brake.torque" not in text
    # With more time it stops the drum.
    result = sinking(30.0, "{time: [0, 1.7, 1.8, 10], value: [0, 0, 1, 1]}")
    assert not [text for text in result.warnings if "brake" in text]


@pytest.mark.parametrize(
    ("speed", "unfinished"),
    [
        (lambda t: 1.0 - 0.5 * t, True),
        (lambda t: -1.0 + 0.5 * t, True),
        (lambda t: 1.0 + 0.0 * t, False),
        (lambda t: 1.0 + 0.5 * t, False),
        # It falls at the last, and grows on the whole.
        (lambda t: 1.0 + 0.5 * t + 0.1 * np.sin(22.0 * t), False),
    ],
)
def test_only_a_drum_whose_speed_falls_is_said_to_slow_down_as_the_run_ends(speed, unfinished):
    time = np.linspace(0.0, 1.0, 41)
    v = speed(time)
    (one,) = slips_of(time, np.cumsum(v) / 40.0, v, 0.01, [(0, 41)], 0.01)
    assert one.unfinished is unfinished and not one.held
    # The brake opens before the end: it did not stop the drum, whatever its speed did.
    (one,) = slips_of(time, np.cumsum(v) / 40.0, v, 0.01, [(0, 40)], 0.01)
    assert not one.unfinished


@pytest.mark.parametrize("share", [0.002, 0.0005])
def test_a_drum_that_creeps_to_a_stop_under_its_brake_has_not_slipped(share):
    # v = V - a t: from a hundredth of R per second on, more than the rope that counts as slip still passes.
    v, a = 0.02 * RADIUS, share * RADIUS
    time = np.linspace(0.0, 1.2 * v / a, 601)
    speed = np.maximum(v - a * time, 0.0)
    paid_out = v * np.minimum(time, v / a) - 0.5 * a * np.minimum(time, v / a) ** 2
    assert (0.01 * RADIUS) ** 2 / (2.0 * a) > 0.01 * RADIUS
    assert slips_of(time, paid_out, speed, TURNS * RADIUS, [(0, 601)], SLIPS * RADIUS) == []


def test_a_load_that_sinks_slowly_and_is_stopped_slowly_is_not_said_to_slip():
    closed = "{time: [0, 0.3, 0.31, 1000], value: [0, 0, 1, 1]}"
    text = f"torque: 20 kN m, brake: {{torque: 4.545 kN m, closed: {{table: {closed}}}}}"
    result = tautline.simulate(read(text, end=120.0))
    speed, passed = np.asarray(result["pay_out_speed"])[:, 0], np.asarray(result["paid_out"])[:, 0]
    slow = int(np.argmax((np.asarray(result.time) > 0.5) & (speed < 0.01 * RADIUS)))
    assert passed[-1] - passed[slow] > SLIPS * RADIUS and abs(speed[-1]) < 1e-6
    assert not [text for text in result.warnings if "brake" in text]


@pytest.mark.parametrize("interval", ["50 ms", "200 ms"])
def test_a_brake_that_stops_a_hoisted_load_and_lets_it_fall_again_has_slipped_whatever_the_interval(interval):
    motor = "{table: {time: [0, 1, 1.1, 10], value: [40e3, 40e3, 0, 0]}}"
    closed = "{table: {time: [0, 1, 1.1, 10], value: [0, 0, 1, 1]}}"
    text = SCENE.format(
        mass=MASS, radius=RADIUS, inertia=INERTIA, law="", more="", end=4.0,
        drive=f"torque: {motor}, brake: {{torque: 15 kN m, closed: {closed}}}",
    )  # fmt: skip
    result = tautline.simulate(tautline.read(text.replace("interval: 50 ms", f"interval: {interval}")))
    (said,) = [text for text in result.warnings if "brake" in text]
    passed = np.asarray(result["paid_out"])[:, 0]
    assert "slipped while it was closed" in said
    assert float(re.search(r"([0-9.]+) m of rope ran out", said)[1]) == pytest.approx(np.ptp(passed), rel=0.02)


def hoisted(end, step="50 ms", torque=1.0):
    """A load that is hoisted fast into its sheave at 4.76 s, and a brake in kN m that closes at 4.1 s."""
    after = "{table: {time: [0, 4, 4.1, 100], value: [%s]}}"
    drive = f"torque: {after % '60e3, 60e3, 0, 0'}, brake: {{torque: {torque} kN m, closed: {after % '0, 0, 1, 1'}}}"
    text = SCENE.format(mass=MASS, radius=RADIUS, inertia=INERTIA, law="", more="", end=end, drive=drive)
    return tautline.read(text.replace("interval: 50 ms", f"interval: {step}"))


def test_a_run_that_stopped_while_the_brake_slowed_the_drum_is_not_told_to_end_later():
    with pytest.raises(StoppedEarly) as caught:
        tautline.simulate(hoisted(end=30.0))
    result = caught.value.result
    (text,) = [text for text in result.warnings if "brake" in text]
    assert "It had not stopped the drum when the run stopped" in text and "The last frame is at t = 4.75 s" in text
    assert "solver.end" not in text and "The run ended" not in text and "did not stop it" not in text
    # One that comes to its end before it is stopped has more to show.
    (text,) = [text for text in tautline.simulate(hoisted(end=4.62)).warnings if "brake" in text]
    assert "The run ended while it still turned" in text and "give a later solver.end" in text


def test_a_simulation_that_is_looked_at_on_its_way_is_not_told_to_end_later():
    simulation = tautline.Simulation(hoisted(end=30.0), keep=True)
    simulation.advance(4.5)
    (text,) = [text for text in simulation.result.warnings if "brake" in text]
    assert "It had not stopped the drum" in text and "solver.end" not in text


@pytest.mark.parametrize(("interval", "frame"), [("50 ms", ""), ("1 s", "from the frame at t = 2 s on, 0.3")])
def test_a_brake_is_said_to_have_closed_when_its_table_closed_it_whatever_the_interval(interval, frame):
    text = f"torque: 20 kN m, brake: {{torque: 4.4 kN m, closed: {{table: {CLOSES}}}}}"
    scene = SCENE.format(mass=MASS, radius=RADIUS, inertia=INERTIA, law="", more="", end=3.0, drive=text)
    result = tautline.simulate(tautline.read(scene.replace("interval: 50 ms", f"interval: {interval}")))
    (said,) = [text for text in result.warnings if "brake" in text]
    assert "was closed at t = 1.1 s on a drum that turned" in said
    assert frame in said and ("from the frame" in said) == bool(frame)


def test_a_closing_is_found_between_frames_after_the_last_time_at_which_the_brake_was_open():
    time, none = np.arange(6.0), np.zeros(0)
    assert closing(time, 2.0, lambda moments: moments >= 1.337, none) == pytest.approx(1.337, abs=1e-9)
    # All but closed before the corner of a smooth table at which it has closed.
    assert closing(time, 2.0, lambda moments: moments >= 1.337, np.array([1.2, 1.34, 1.9])) == 1.34
    # Opened and closed again, be it only at a corner.
    assert closing(time, 3.0, lambda moments: np.abs(moments - 2.5) > 0.06, none) == pytest.approx(2.56, abs=1e-9)
    corner = 2.0 + 1.0 / 64.0
    assert closing(time, 3.0, lambda moments: moments != corner, np.array([corner])) == pytest.approx(corner, abs=1e-9)
    # Closed from the start.
    assert closing(time, 0.0, lambda moments: moments < 3.0, none) == 0.0
