"""Linearised simulations, against differences, other eigenvalues and runs."""

from pathlib import Path

import numpy as np
import pytest

import tautline
from tautline.integrators.vibration.modes import modes
from tautline.integrators.vibration.vibrations import vibrations
from tautline.live.errors import SimulationError, UnknownName

DATA = Path(__file__).parents[2] / "data"

ROPE = """
title: Load on a rope
rope: {mass_per_length: 2.0, axial_stiffness: 4.0e7, damping: 1.0e-3, diameter: 22 mm, breaking_load: 0.4 MN}
bodies: [{name: payload, mass: 2 t, position: [8.2, 0, -9]}]
path:
  - drum:   {name: winch, center: [0.5, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, frame: boom, pay_out: 0}
  - sheave: {name: tip, center: [8, 0, 6], radius: 0.2, axis: [0, 1, 0], wrap: over, frame: boom, inertia: 1.5,
             law: no_slip}
  - end:    {name: hook, body: payload}
frames: [{name: boom, pivot: [0, 0, 0], slew: {constant: 0}, luff: {constant: 0}}]
mesh: {elements_per_span: 3}
start: static
solver: {method: generalized-alpha, rho_inf: 1, step: 1 ms, end: 20 s}
output: {interval: 50 ms}
"""


def turning(values, tolerance=1e-6):
    """Imaginary parts above zero, sorted."""
    values = np.asarray(values)
    return np.sort(values.imag[values.imag > tolerance])


def test_a_is_what_differences_of_the_equations_give_of_a_moving_hose():
    sim = tautline.Simulation(DATA / "hose.yaml")
    sim.advance_to(0.05)
    plant = sim.linearise(["water.speed"], ["tip.position"])
    equations = sim.equations
    t, q, v = equations.state()
    y, n = np.concatenate((q, v)), equations.size
    differences = np.zeros((2 * n, 2 * n))
    for j in range(2 * n):
        d = np.zeros(2 * n)
        d[j] = 1e-6
        differences[:, j] = (equations.first_order(t, y + d) - equations.first_order(t, y - d)) / 2e-6
    a = plant.A[: 2 * n, : 2 * n]
    assert np.abs(a - differences).max() < 1e-6 * np.abs(differences).max()
    for rows in range(2 * n):  # and row by row, as accelerations of slopes are far larger than those of places
        assert np.abs(a[rows] - differences[rows]).max() < 1e-6 * np.abs(differences[rows]).max()


@pytest.mark.parametrize("name", ["winch.pay_out_speed", "boom.slew", "boom.luff", "payload.force[0]"])
def test_b_c_and_d_are_what_a_small_step_of_the_input_does_in_a_run(name):
    """The answer to a smooth small change, run and linear, at a hundred times."""
    from scipy.signal import lsim

    inputs = ["boom.slew", "boom.luff", "payload.force"]
    sim = tautline.Simulation(ROPE, inputs=inputs, keep=False)
    outputs = ["payload.position", "payload.velocity"] if "speed" in name or "force" in name else ["payload.position"]
    plant = sim.linearise([name], outputs)
    size = {"N": 10.0, "m": 1e-3, "rad": 1e-4, "m/s": 1e-3}[plant.units[name]]
    h, end = 0.01, 3.0
    times = np.arange(0.0, end + 0.5 * h, h)
    x = np.minimum(times / 2.0, 1.0)
    given, rate = size * x**3 * (10 - 15 * x + 6 * x * x), size * 15.0 * (x * (1 - x)) ** 2
    begin = np.concatenate([sim[one] for one in outputs])
    found = [np.zeros_like(begin)]
    for value, slope in zip(given[1:], rate[1:], strict=True):
        sim.inputs[name] = value, slope
        sim.advance(h)
        found.append(np.concatenate([sim[one] for one in outputs]) - begin)
    _, linear, _ = lsim(plant.to_scipy(), given, times)
    found = np.array(found)
    assert np.abs(found - linear).max() < 2e-3 * np.abs(found).max()


def test_eigenvalues_about_rest_are_those_of_the_modes_and_vibrations():
    sim = tautline.Simulation(ROPE)
    plant = sim.linearise(["winch.pay_out_speed"], ["payload.position"])
    system, state = sim.copy().model.system, sim.copy()._state
    other = turning(vibrations(system, state).value)
    assert np.allclose(turning(plant.eigenvalues), other, rtol=1e-6)
    undamped = modes(system, state).omega
    pendulum = turning(plant.eigenvalues)[0]
    assert pendulum == pytest.approx(undamped[undamped > 1e-3].min(), rel=1e-5)


def test_eigenvalues_of_a_scene_with_multipliers_are_those_within_its_constraints():
    sim = tautline.Simulation(DATA / "reeled_span.yaml")
    assert sim.model.system.algebraic.size > 0
    plant = sim.linearise([], [])
    # What flows at a steady speed counts in both.
    other = sim.copy()
    found = vibrations(other.model.system, other._state)
    assert np.allclose(turning(plant.eigenvalues, 1.0)[:6], turning(found.value, 1.0)[:6], rtol=1e-6)


def test_torsion_of_a_string_has_the_frequencies_that_campbell_finds():
    """The string of the drilling scene off bottom, held by its prescribed rotation at the top."""
    from drillstring.modes.campbell import campbell

    scene = tautline.read(DATA / "drilling.yaml").replace(
        {
            "bit": {"on_bottom": False},
            "top": {"block": {"constant": 0}, "rotation": {"constant": 0}},
            "damping": {"rotation": 0, "translation": 100},
        }
    )
    found = campbell(scene, (1.0, 12.0), kinds=("torsional",), up_to=2.0)
    wanted = sorted(mode.frequency for mode in found.modes)[:3]
    plant = tautline.Simulation(scene.replace({"model.elements": 50})).linearise([], [])
    turns = [k for k, name in enumerate(plant.states[: len(plant.A) // 2]) if name.endswith("rotation")]
    n = len(plant.A) // 2
    a = np.block(
        [
            [np.zeros((len(turns),) * 2), np.eye(len(turns))],
            [plant.A[np.ix_([n + k for k in turns], turns + [n + k for k in turns])]],
        ]
    )
    got = turning(np.linalg.eigvals(a), 0.1)[:3] / (2.0 * np.pi)
    assert np.allclose(got, wanted, rtol=1e-3)


def test_the_frequency_response_is_that_of_a_run():
    sim = tautline.Simulation(ROPE, keep=False)
    frequency, size, h = 0.7, 1e-3, 0.01
    outputs = ["payload.position", "winch.tension", "payload.velocity"]
    wanted = sim.linearise(["winch.pay_out_speed"], outputs).response(frequency)[0, :, 0]
    begin = np.concatenate([np.atleast_1d(sim[one]) for one in outputs])
    w, times, found = 2.0 * np.pi * frequency, [], []
    while sim.time < 20.0 - 1e-9:
        t = sim.time + h
        grown = min(t / 10.0, 1.0)
        rate = size * (grown * w * np.cos(w * t) + (0.1 * np.sin(w * t) if t < 10.0 else 0.0))
        sim.inputs["winch.pay_out_speed"] = grown * size * np.sin(w * t), rate
        sim.advance(h)
        if sim.time > 20.0 - 7.0 / frequency:
            times.append(sim.time)
            found.append(np.concatenate([np.atleast_1d(sim[one]) for one in outputs]) - begin)
    t = np.array(times)
    parts = np.linalg.lstsq(np.column_stack((np.sin(w * t), np.cos(w * t), np.ones_like(t), t)), np.array(found))[0]
    got = (parts[0] + 1j * parts[1]) / size
    for k in (2, 3, 6):  # height, tension, speed upwards
        assert abs(got[k] - wanted[k]) < 1e-3 * abs(wanted[k]), k


def test_about_a_moving_state_a_small_disturbance_runs_as_the_linear_system_says():
    """Two runs from a fluttering hose that differ by a little, and what A makes of their difference."""
    from scipy.linalg import expm

    sim = tautline.Simulation(DATA / "hose.yaml", keep=False)
    sim.advance_to(0.6)
    other = sim.copy()
    plant = sim.linearise([], [])
    n = sim.model.system.size
    change = 1e-7 * np.sin(np.arange(n))
    other._state.v[:] += change
    other._state.full_v[other.model.system.dofs.free] += change
    ahead = 2e-4
    for one in (sim, other):
        one._checked.step = 1e-5
        one.advance(ahead)
    got = other._state.q - sim._state.q
    wanted = (expm(plant.A * ahead) @ np.concatenate((np.zeros(n), change)))[:n]
    assert np.linalg.norm(got - wanted) < 0.05 * np.linalg.norm(wanted)


STICKS = pytest.mark.filterwarnings("ignore:what sticks never moves")


@STICKS
def test_a_stuck_sheave_holds_and_a_slack_rope_pulls_nothing_as_they_are():
    hoist = tautline.Simulation(DATA / "hoist.yaml")
    stuck = hoist.linearise(["winch.pay_out_speed"], ["payload.velocity"]).response(0.05)[0, 2, 0]
    free = tautline.Simulation(tautline.read(DATA / "hoist.yaml").replace({"path[1].sheave.bearing": None}))
    assert (
        abs(stuck)
        < 0.1
        < 0.9
        < abs(free.linearise(["winch.pay_out_speed"], ["payload.velocity"]).response(0.05)[0, 2, 0])
    )


def test_an_output_that_follows_the_rate_of_an_input_is_refused_with_the_input_to_take():
    sim = tautline.Simulation(ROPE)
    with pytest.raises(SimulationError, match=r"take winch[.]pay_out_speed"):
        sim.linearise(["winch.pay_out"], ["winch.tension"])
    with pytest.raises(UnknownName, match=r"winch[.]tension"):
        sim.linearise(["winch.pay_out_speed"], ["winch.tensio"])


def test_linearising_leaves_the_simulation_where_it_was():
    sim = tautline.Simulation(ROPE)
    sim.advance(0.5)
    before = sim.save()
    sim.linearise(["winch.pay_out_speed"], ["winch.tension"])
    assert np.array_equal(before.block, sim.save().block)


DRIVEN = """
title: a string in free space turned by a drive
well: {sections: [{hold: 1200 m}], diameter: 0.3, wall: none}
string: [{name: pipe, length: rest, od: 0.127, id: 0.1086}]
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
damping: {structural: 3 ms, rotation: 20}
top: {rotation: {controller: {kind: pi, speed: 60 rpm, proportional: 300, integral: 200, inertia: 2000}}}
model: {kind: lumped, elements: 6}
solver: {method: generalized-alpha, rho_inf: 0.8, step: 2 ms, end: 60 s}
output: {interval: 50 ms}
"""

REAMED = """
title: a string that reams in a slant hole, its beam pressed into a stiff wall by a hundredth of a millimetre
well: {inclination: 60 deg, sections: [{hold: 600 m}], diameter: 0.2159 m,
       wall: {stiffness: 1.0e9, damping: 1.0e6, friction: 0.2}}
string: [{name: pipe, length: rest, od: 0.127, id: 0.1086, tool_joint_od: 0.165}]
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
damping: {structural: 20 ms, translation: 50, rotation: 5}
top: {block: {velocity: -0.3 m/s}, rotation: 30 rpm}
model: {kind: ale-ancf, elements: 4}
solver: {method: generalized-alpha, rho_inf: 0.5, step: 2 ms, end: 30 s}
output: {interval: 50 ms}
"""


def test_what_a_drive_notes_at_the_end_of_a_step_answers_as_its_equation_says():
    """T = P (Omega - phi.) + I int(Omega - phi.) dt, and what turns the string is T less the drive's own inertia."""
    sim = tautline.Simulation(tautline.read(DRIVEN), inputs=["top.rotary_speed"])
    sim.advance(20.0)
    frequency = np.array([0.02, 0.1, 0.3, 1.0])
    s = 2j * np.pi * frequency
    plant = sim.linearise(["top.rotary_speed"], ["drive_torque", "surface_torque", "top.rotary_speed"])
    drive, surface, speed = plant.response(frequency)[:, :, 0].T
    torque = (300.0 + 200.0 / s) * (1.0 - speed)
    assert np.abs(drive / torque - 1.0).max() < 1e-6
    assert np.abs(surface / (torque - 2000.0 * s * speed) - 1.0).max() < 1e-6


def test_outputs_of_a_beam_that_lies_on_a_stiff_wall_answer_as_those_of_a_run():
    """A step of 1e-5 of a slope would lift the middle of the beam off its wall."""
    sim = tautline.Simulation(tautline.read(REAMED), inputs=["top.block_speed", "top.rotary_speed"])
    for name, value in (("top.block_speed", -0.3), ("top.rotary_speed", np.pi)):
        sim.inputs[name] = (value, 0.0)
    sim.advance(30.0)
    outputs = ["top.hook_load", "surface_torque"]
    slow = sim.linearise(["top.block_speed"], outputs).response(1e-4)[0, :, 0].real
    seen = []
    for change in (0.001, -0.001):
        other = sim.copy()
        other.inputs["top.block_speed"] = (-0.3 + change, 0.0)
        other.advance(30.0)
        seen.append([float(other[name]) for name in outputs])
    run = (np.array(seen[0]) - np.array(seen[1])) / 0.002
    assert np.abs(slow / run - 1.0).max() < 1e-3


def test_a_bit_on_bottom_answers_with_its_torque_and_the_bottom_is_said_to_be_held():
    """The torque on rock is the weight's times a factor that the speed of turning alone decides."""
    sim = tautline.Simulation(DATA / "drilling.yaml")
    sim.advance(20.0)
    weight, torque = float(sim["bit.weight"]), float(sim["bit.torque"])
    assert weight > 0.0
    with pytest.warns(UserWarning, match="the bottom of the hole is constant in the linear model"):
        plant = sim.linearise([], ["bit.weight", "bit.torque"])
    assert plant.held == ("the bottom of the hole",)
    presses = np.flatnonzero(np.abs(plant.C[0]) > 1e-6 * np.abs(plant.C[0]).max())
    assert presses.size and np.abs(plant.C[1, presses] / plant.C[0, presses] / (torque / weight) - 1.0).max() < 1e-5


def test_a_bit_off_bottom_holds_nothing_and_sums_over_time_are_refused():
    sim = tautline.Simulation(tautline.read(DRIVEN))
    assert sim.linearise([], []).held == ()
    for name in ("external_work", "dissipated_energy"):
        with pytest.raises(SimulationError, match=f"{name} is a sum over time"):
            sim.linearise([], [name])


def test_a_vector_input_is_its_three_components():
    text = ROPE.replace(
        "position: [8.2, 0, -9]", "position: [8.2, 0, -9], force: [{constant: 0}, {constant: 0}, {constant: 0}]"
    )
    sim = tautline.Simulation(text)
    whole = sim.linearise(["payload.force"], ["payload.position"])
    parts = sim.linearise([f"payload.force[{c}]" for c in range(3)], ["payload.position"])
    assert whole.inputs == parts.inputs == ("payload.force[0]", "payload.force[1]", "payload.force[2]")
    assert np.array_equal(whole.B, parts.B)
    with pytest.raises(UnknownName, match=r"payload\.force"):
        sim.linearise(["payload.forze"], ["payload.position"])


@STICKS
@pytest.mark.parametrize(
    "wrong", [float("nan"), float("inf"), "1 Hz", [[0.1, 0.2]], None, True, 1.0j, [[1.0], [1.0, 2.0]]]
)
def test_a_response_refuses_what_is_no_frequency(wrong):
    plant = tautline.Simulation(DATA / "hoist.yaml", keep=False).linearise(
        ["winch.pay_out_speed"], ["payload.position[2]"]
    )
    with pytest.raises(tautline.TautlineError, match="frequenc"):
        plant.response(wrong)


@STICKS
def test_the_response_at_no_frequency_to_a_speed_is_refused_in_words_as_infinite():
    plant = tautline.Simulation(DATA / "hoist.yaml", keep=False).linearise(
        ["winch.pay_out_speed"], ["payload.position[2]"]
    )
    with pytest.raises(tautline.TautlineError, match="0 Hz is infinite"):
        plant.response(0.0)
    assert plant.response([0.1, 0.2]).shape == (2, 1, 1) and plant.response([]).shape == (0, 1, 1)
