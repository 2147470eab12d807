"""A plant of a winch that holds a tension has its integral, against a model of seven states and against runs."""

import numpy as np
import pytest

import tautline
from tautline.kernels.groups import known_of

G, MASS, EA, DAMPING, INERTIA, RADIUS, RIM, WHEEL, PROPORTIONAL = 9.81, 1200.0, 4e6, 1e-3, 90.0, 0.4, 30.0, 0.3, 2.0
SUM = "w: integral of the missing tension"


def scene(integral, **drum):
    """A load on a rope over a wheel that turns, from a drum that holds its tension."""
    winch = {
        "name": "w", "center": [0, 0, 0], "radius": RADIUS, "axis": [0, 1, 0], "wrap": "over", "inertia": INERTIA,
        "tension": MASS * G, "gains": {"proportional": PROPORTIONAL, "integral": integral},
    }  # fmt: skip
    wheel = {
        "name": "s", "center": [10, 0, 18], "radius": WHEEL, "axis": [0, 1, 0], "wrap": "over", "inertia": RIM,
    }  # fmt: skip
    return {
        "rope": {"mass_per_length": 1e-3, "axial_stiffness": EA, "damping": DAMPING, "strain": "engineering"},
        "bodies": [{"name": "b", "mass": MASS, "position": [10.3, 0, 0]}],
        "path": [{"drum": winch | drum}, {"sheave": wheel}, {"end": {"name": "e", "body": "b"}}],
        "mesh": {"elements_per_span": 1},
        "solver": {"method": "generalized-alpha", "rho_inf": 0.9, "step": "2 ms", "end": 4},
        "output": {"interval": "20 ms"},
    }


def seven_states(integral, wrap):
    """Eigenvalues of drum, wheel and load on two massless springs, with the integral of the tension at the drum."""
    stretch = 1.0 + MASS * G / EA
    longs = np.array([np.sqrt(10.0**2 + 18.0**2 - (RADIUS - WHEEL) ** 2), 18.0]) + WHEEL * wrap / 2.0
    lengths = longs / stretch
    k1, k2 = EA * longs / lengths**2
    # Unknowns: rope paid out, rope over the wheel, way of the load down.
    first, second = np.array([-k1, k1, 0.0]), np.array([0.0, -k2, EA / lengths[1]])
    rows = [np.concatenate((one, DAMPING * one, [0.0])) for one in (first, second)]
    a, drum = np.zeros((7, 7)), INERTIA / RADIUS**2 * stretch
    a[:3, 3:6] = np.eye(3)
    a[3] = (1.0 + PROPORTIONAL) * rows[0] / drum
    a[3, 6] = integral / drum
    a[4], a[5], a[6] = (rows[1] - rows[0]) / (RIM / WHEEL**2), -rows[1] / MASS, rows[0]
    return np.linalg.eigvals(a)


def nearest(values, wanted):
    return values[np.abs(values - wanted).argmin()]


@pytest.mark.parametrize("integral", [0.3, 8.0])
def test_the_integral_of_a_winch_is_a_state_and_eigenvalues_are_those_of_a_model_of_seven(integral):
    sim = tautline.Simulation(scene(integral), keep=False)
    plant = sim.linearise(["w.tension"], ["b.position"])
    assert plant.states.count(SUM) == 1
    for wanted in seven_states(integral, float(sim["s.wrap_angle"])):
        if abs(wanted) > 0.01:  # the winch pays out and hauls in freely: two zeros
            got = nearest(plant.eigenvalues, wanted)
            assert got.real == pytest.approx(wanted.real, rel=0.01), wanted
            assert got.imag == pytest.approx(wanted.imag, rel=1e-3), wanted


def test_a_winch_without_an_integral_and_one_at_its_torque_limit_add_no_state():
    for one in (scene(0.0), scene(8.0, torque_limit=0.5 * RADIUS * MASS * G)):
        assert SUM not in tautline.Simulation(one, keep=False).linearise([], []).states


@pytest.mark.parametrize("on_vessel", [False, True], ids=["set value", "heave"])
def test_load_tension_and_torque_answer_inputs_as_in_a_run_where_the_winch_has_an_integral(on_vessel):
    from scipy.signal import lsim

    made = scene(8.0)
    name = "w.tension"
    if on_vessel:
        made["vessel"] = {"reference": [0, 0, 0], "motion": {"heave": {"constant": 0}}}
        name = "vessel.heave"
    sim = tautline.Simulation(made, inputs=[name], keep=False)
    outputs = ["b.position"] if on_vessel else ["b.position", "w.tension", "w.torque"]
    plant = sim.linearise([name], outputs)
    size, h = (1e-3 if on_vessel else 10.0), 0.01
    times = np.arange(0.0, 1.5 + 0.5 * h, h)
    x = np.minimum(times / 0.5, 1.0)
    given, rate = size * x**3 * (10 - 15 * x + 6 * x * x), size * 60.0 * (x * (1 - x)) ** 2
    found = []
    for value, slope in zip(given, rate, strict=True):
        if sim.time or found:
            sim.inputs[name] = value + (0.0 if on_vessel else MASS * G), slope
            sim.advance(h)
        found.append(np.concatenate([np.atleast_1d(sim[one]) for one in outputs]))
    found = np.array(found) - found[0]
    _, linear, _ = lsim(plant.to_scipy(), given, times)
    for k in range(2, found.shape[1]):
        assert np.abs(found[:, k] - linear[:, k]).max() < 0.01 * np.abs(found[:, k]).max(), plant.outputs[k]


def test_a_linear_model_leaves_the_integral_of_the_run_as_it_was():
    sim = tautline.Simulation(scene(8.0), keep=False)
    sim.advance(0.05)
    drums = next(g for g in sim.model.system.groups if known_of(g).integrals)
    before = sim.save().block
    assert drums.sum[0] != 0.0
    sim.linearise(["w.tension"], ["w.torque"])
    assert np.array_equal(sim.save().block, before)


@pytest.mark.parametrize("asked", [["w.tension"], ["d.pay_out_speed"]], ids=["set value", "speed of another winch"])
def test_the_integral_grows_by_what_the_tension_lacks_with_the_mass_of_the_rope_in_it(asked):
    """Of a rope of mass the tension at the drum feels accelerations: the plant's own output says how much."""
    made = scene(0.3, tension="20 kN")
    made["rope"]["mass_per_length"], made["mesh"]["elements_per_span"] = 5.0, 2
    other = {"name": "d", "center": [20, 0, 0], "radius": 0.4, "axis": [0, 1, 0], "wrap": "over", "pay_out": 0}
    made["path"][2] = {"drum": other}
    del made["bodies"]
    sim = tautline.Simulation(made, keep=False)
    sim.advance(1.0)
    plant = sim.linearise(asked, ["w.tension"])
    row = plant.states.index(SUM)
    assert np.allclose(plant.A[row], -plant.C[0], rtol=1e-5, atol=1e-7 * np.abs(plant.C).max())
    lacks = float(asked == ["w.tension"]) - plant.D[0, 0]
    assert plant.B[row, 0] == pytest.approx(lacks, abs=1e-6 * max(1.0, np.abs(plant.D).max()))
