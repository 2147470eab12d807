"""What runs and studies say of the twist of a string that sticks and slips, beside integrations of one's own.

The string hangs in a vertical hole without friction, as two torsional springs with the inertia of half of both beside
them. Its bit rests until the spring brings the static torque, and then turns against one that falls with its speed.
"""

from functools import cache
from math import pi

import numpy as np
import pytest
from physics.wells.test_stick_slip import STATIC, STIFFNESS, lump
from scipy.integrate import solve_ivp

from drillstring.application import Drillstring
from drillstring.scene.scene import DrillstringScene
from tautline.cli.output.summary import table
from tautline.simulation import simulate
from tautline.study.accuracy.choice import run_to_accuracy
from tautline.study.accuracy.findings import good_enough
from tautline.study.accuracy.precision import Grid, study
from tautline.study.trials.step_error import estimate
from tautline.study.trials.trial import Subject

LENGTHS, RADII, G, DENSITY = (1650.0, 180.0), ((0.0635, 0.0543), (0.1016, 0.0381)), 79e9, 7850.0
DAMPING, SPEED, END, INTERVAL = 13.0, 2.0 * pi, 40.0, 0.02
"""N m s/rad of one of 12 lumps, speed of the drive rad/s, end and interval of the frames s."""
MOST, LEAST, DECAY = 8200.0, 3400.0, 3.0
"""Torque of the bit at rest and at high speed, N m, and the speed by which it falls, rad/s."""
SCENE = f"""
well: {{sections: [{{hold: {sum(LENGTHS)}}}], diameter: 0.311, wall: {{stiffness: 1.0e8, damping: 1.0e6, friction: 0}}}}
string:
  - {{name: pipe, od: {2.0 * RADII[0][0]}, id: {2.0 * RADII[0][1]}, length: rest, elements: 1}}
  - {{name: collar, od: {2.0 * RADII[1][0]}, id: {2.0 * RADII[1][1]}, length: {LENGTHS[1]}, elements: 1}}
material: {{youngs_modulus: 206e9, shear_modulus: {G}, density: {DENSITY}}}
damping: {{rotation: {DAMPING}}}
top: {{rotation: {SPEED}, weight: 270 kN}}
bit:
  on_bottom: true
  lateral: pinned
  weight: 90 kN
  torque: {{static: {MOST}, kinetic: {LEAST}, decay: {DECAY}}}
  penetration: {{rate: 0.003 m/h, speed: {SPEED}}}
model: {{kind: lumped, elements: 2}}
solver: {{method: generalized-alpha, rho_inf: 0.8, step: STEP, end: {END}}}
output: {{interval: {INTERVAL}}}
"""


def scene(step):
    return DrillstringScene.parse(SCENE.replace("STEP", repr(step)))


@cache
def exact():
    """Twist of the string at the times of the frames, rad, integrated between the bit's stops and starts."""
    polar = [pi / 2.0 * (out**4 - bore**4) for out, bore in RADII]
    stiffness = [G * i / length for i, length in zip(polar, LENGTHS, strict=True)]
    half = [0.5 * DENSITY * i * length for i, length in zip(polar, LENGTHS, strict=True)]
    damping = [12.0 * DAMPING * length / sum(LENGTHS) / 2.0 for length in LENGTHS]
    inertia, drag = (half[0] + half[1], half[1]), (damping[0] + damping[1], damping[1])

    def torque(speed):
        return LEAST + (MOST - LEAST) * np.exp(-max(speed, 0.0) / DECAY)

    def rates(t, y, turns):
        joint = (stiffness[0] * (SPEED * t - y[0]) - stiffness[1] * (y[0] - y[2]) - drag[0] * y[1]) / inertia[0]
        bit = (stiffness[1] * (y[0] - y[2]) - drag[1] * y[3] - torque(y[3])) / inertia[1]
        return [y[1], joint, y[3], bit] if turns else [y[1], joint, 0.0, 0.0]

    def stops(t, y, turns):
        return y[3] if turns else 1.0

    def starts(t, y, turns):
        return 1.0 if turns else abs(stiffness[1] * (y[0] - y[2])) - MOST

    stops.terminal = starts.terminal = True
    stops.direction, starts.direction = -1, 1
    # At the start all turns alike, wound up by the torque of the bit alone: the damping sets in then.
    first, second = (torque(SPEED) / k for k in stiffness)
    t, y, turns = 0.0, np.array([-first, SPEED, -first - second, SPEED]), True
    times = np.linspace(0.0, END, round(END / INTERVAL) + 1)
    bit = np.zeros(times.size)
    while t < END:
        part = solve_ivp(
            rates, (t, END), y, events=(stops, starts), args=(turns,), rtol=1e-9, atol=1e-9, max_step=0.02,
            dense_output=True,
        )  # fmt: skip
        there = (times >= t - 1e-9) & (times <= part.t[-1] + 1e-9)
        bit[there] = part.sol(times[there])[2] if there.any() else 0.0
        t, y = part.t[-1], part.y[:, -1].copy()
        turns, y[3] = not turns, 1e-9 if not turns else 0.0
    return bit - SPEED * times


def true_error(result):
    twist = result["rotation"][:, -1] - result["rotation"][:, 0]
    return float(np.abs(twist - exact()).max() / np.ptp(exact()))


@cache
def run(step):
    return simulate(Drillstring().build(scene(step)))


@pytest.mark.parametrize("step", [0.01, 0.005, 0.002])
def test_a_run_states_the_error_of_the_twist_that_an_integration_of_its_own_finds(step):
    told = estimate(Subject(Drillstring(), scene(step)), run(step))
    true = true_error(run(step))
    assert told.position < 0.01 < true
    assert 0.7 * true < told.twist < 10.0 * true
    assert told.twist_angle == pytest.approx(told.twist * np.ptp(exact()), rel=0.1)
    assert told.twist_place == "twist of the string"
    assert told.warning.startswith("the twist of the string may be off by")


def test_a_string_whose_bit_turns_in_place_is_not_still():
    """Until the bit lets go for the first time the drive has wound the string up by the static torque: the frames show
    it, and the bit's position never changes."""
    turned = lump(2.0, step=0.04)
    result = simulate(Drillstring().build(turned))
    assert np.ptp(result["rotation"][:, 0] - result["rotation"][:, -1]) > 0.9 * STATIC / STIFFNESS
    told = estimate(Subject(Drillstring(), turned), result)
    # The period of stick and slip is 1.5417 s by closed form, and no multiple of the step: phase errors add up.
    assert told.twist > 0.1 and told.position == 0.0 and "twist of the string" in told.warning


def test_a_study_advises_no_step_with_which_the_twist_is_wrong():
    """The position is right to 1 % with each of these steps."""
    grid = Grid(["generalized-alpha"], [0.01, 0.005, 5e-4])
    found = study(Subject(Drillstring(), scene(0.002)), grid, repetitions=1, budget=1.0)
    errors = {round(row.trial.attribute("step"), 6): row.errors for row in found.rows}
    for step in (0.01, 0.005):
        assert errors[step].twist == pytest.approx(true_error(run(step)), rel=0.05)
        assert errors[step].position < 0.01 < errors[step].twist
    chosen = good_enough(found)
    assert chosen and all(true_error(row.trial.result) < 0.01 for row in chosen)
    assert "of the twist" in found.advice
    assert found.watched.twist_said == "twist of the string"


def test_an_accuracy_that_is_asked_for_states_the_twist_as_other_runs_do():
    result = run_to_accuracy(Drillstring(), scene(0.002), 0.05)
    told = result.step_error
    assert told["twist"] == result.accuracy["twist"] >= 0.5 * true_error(result)
    assert told["twist_angle"] == pytest.approx(told["twist"] * np.ptp(exact()), rel=0.1)


def printed(told):
    report = {
        "method": "a", "step": 0.1, "steps": 1, "newton_iterations": 0, "simulated_time": 1.0, "wall_time": 1.0,
        "total_time": 1.0, "real_time_factor": 1.0, "energy_error": None, "step_error": told,
    }  # fmt: skip
    return [str(cell) for column in table(report, {}, {}).columns for cell in column.cells]


def test_the_twist_is_printed_and_results_without_it_are_printed_as_they_were():
    told = estimate(Subject(Drillstring(), scene(0.01)), run(0.01))._asdict()
    (line,) = [cell for cell in printed(told) if "twist" in cell]
    assert f"({100.0 * told['twist']:.2g} %), twist of the string" in line and "deg" in line
    older = {key: value for key, value in told.items() if not key.startswith("twist")}
    assert not [cell for cell in printed(older) if "twist" in cell]
    assert set(printed(older)) == set(printed(told)) - {line}
