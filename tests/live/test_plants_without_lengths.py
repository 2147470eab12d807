"""A linear model of bodies that turn has their motions alone: the length of a quaternion is none.

A body on a rope is a double pendulum. With the rope's angle t and the body's p, rope l, socket at a above the centre,

    [m l^2, m l a; m l a, m a^2 + J] (t.., p..) + g [m l, 0; 0, m a] (t, p) = 0.
"""

import numpy as np
import pytest

import tautline
from tautline.kernels.groups import KINDS

G, MASS, LONG, ABOVE, MOMENTS = 9.81, 2000.0, 10.0, 2.0, (2400.0, 1500.0, 1000.0)
OUTPUTS = ["load.position", "load.velocity", "load.turn"]


def scene(inertia=MOMENTS, **changed):
    rope = {"mass_per_length": 1e-3, "axial_stiffness": 8e8, "damping": 1e-3, "diameter": 0.036, "compression": "none"}
    body = {"name": "load", "mass": MASS, "position": [0, 0, -LONG - ABOVE], "inertia": list(inertia)}
    hook = {"name": "hook", "body": "load", "offset": [0, 0, ABOVE]}
    return {
        "rope": rope, "bodies": [body], "path": [{"anchor": {"name": "top", "position": [0, 0, 0]}}, {"end": hook}],
        "mesh": {"elements_per_span": 1}, "gravity": [0, 0, -G], "start": "static",
        "solver": {"method": "generalized-alpha", "rho_inf": 0.6, "step": "5 ms", "end": 4},
        "output": {"interval": "50 ms"},
    } | changed  # fmt: skip


def double_pendulum(moment):
    """Both frequencies, rad/s."""
    mass = MASS * np.array([[LONG**2, LONG * ABOVE], [LONG * ABOVE, ABOVE**2 + moment / MASS]])
    return np.sqrt(np.linalg.eigvals(np.linalg.solve(mass, MASS * G * np.diag([LONG, ABOVE]))))


@pytest.mark.parametrize("twist", [1000.0, 900.0])
def test_a_body_on_a_rope_has_the_modes_of_two_double_pendulums_and_a_bounce_and_none_of_the_program(twist):
    plant = tautline.Simulation(scene((*MOMENTS[:2], twist)), keep=False).linearise([], OUTPUTS)
    found = np.sort(plant.eigenvalues.imag[(plant.eigenvalues.imag > 0.01) & (plant.eigenvalues.imag < 1e4)])
    swings = np.concatenate([double_pendulum(moment) for moment in MOMENTS[:2]])
    wanted = np.sort([*swings, np.sqrt(8e8 / LONG / MASS)])
    assert found == pytest.approx(wanted, rel=0.01) and found[:4] == pytest.approx(np.sort(swings), rel=1e-3)


def test_states_have_names_of_their_own_and_a_quaternion_three_of_its_four_numbers():
    plant = tautline.Simulation(scene(), keep=False).linearise([], OUTPUTS)
    assert len(set(plant.states)) == len(plant.states) == len(plant.A) == plant.C.shape[1]
    turns = [name for name in plant.states if "orientation" in name and "d/dt" not in name]
    assert sorted(turns) == [f"load: orientation {k}" for k in (2, 3, 4)]  # as drawn the first is 1


def on_a_vessel():
    """A body that is turned, under a vessel that begins to move."""
    motion = {"surge": {"harmonic": {"amplitude": 1.0, "period": 3.0}}, "heave": {"constant": 0}}
    motion["sway"] = {"harmonic": {"amplitude": 1.0, "period": 2.5}}
    turned = scene(vessel={"reference": [0, 0, 0], "motion": motion})
    turned["path"][0]["anchor"]["frame"] = "vessel"
    turned["bodies"][0]["orientation"] = ["0 deg", "0 deg", "70 deg"]
    return tautline.Simulation(turned, inputs=["vessel.heave"], keep=False)


def test_of_a_body_at_rest_the_length_alone_is_left_out_and_outputs_answer_inputs_as_before(monkeypatch):
    still = scene(vessel={"reference": [0, 0, 0], "motion": {"heave": {"constant": 0}, "surge": {"constant": 0}}})
    still["path"][0]["anchor"]["frame"] = "vessel"
    still["bodies"][0]["orientation"] = ["0 deg", "0 deg", "70 deg"]
    inputs = ["vessel.heave", "vessel.surge"]
    sim = tautline.Simulation(still, inputs=inputs, keep=False)
    plant = sim.linearise(inputs, OUTPUTS)
    for kind, known in KINDS.items():
        monkeypatch.setitem(KINDS, kind, known._replace(lengths=None))
    whole = sim.linearise(inputs, OUTPUTS)
    assert len(whole.states) == len(plant.states) + 2
    assert np.abs(whole.eigenvalues - 50.0j).min() < 1e-6 and np.abs(plant.eigenvalues - 50.0j).min() > 1.0
    frequency = np.array([0.05, 0.3, 2.0, 9.0])
    was, now = whole.response(frequency), plant.response(frequency)
    assert np.abs(now - was).max() < 1e-6 * np.abs(was).max()


def test_where_a_body_turns_accelerations_are_those_of_the_equations_at_a_quaternion_of_unit_length():
    # the largest number of the changed quaternion follows from q.q = 1, and its rate from q.v = 0
    sim = on_a_vessel()
    sim.advance_to(1.7)
    plant, equations = sim.linearise([], []), sim.equations
    t, q, v = equations.state()
    turns = [k for k, name in enumerate(equations.names) if name == "load: orientation"]
    gone = turns[int(np.abs(q[turns]).argmax())]
    kept = [k for k in range(equations.size) if k != gone]
    others = [k for k in turns if k != gone]
    way = np.linalg.svd(q[None, turns])[2][1:][0]  # a turn, across q

    def accelerations(h):
        moved, rate = q.copy(), v.copy()
        moved[others] += h * np.array([way[turns.index(k)] for k in others])
        moved[gone] = np.sign(q[gone]) * np.sqrt(q[turns] @ q[turns] - moved[others] @ moved[others])
        rate[gone] = (q[turns] @ v[turns] - moved[others] @ rate[others]) / moved[gone]
        return equations.acceleration(t, moved, rate)[kept]

    x = np.zeros(len(plant.states))
    x[[kept.index(k) for k in others]] = [way[turns.index(k)] for k in others]
    found, h = (plant.A @ x)[len(kept) :], 1e-6
    wanted = (accelerations(h) - accelerations(-h)) / (2.0 * h)
    assert np.abs(v[turns]).max() > 0.01
    assert found == pytest.approx(wanted, rel=1e-5, abs=1e-6 * np.abs(wanted).max())
