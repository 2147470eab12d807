"""Elevator of reference [11] of the thesis: two masses over one sheave that hangs on a roof spring.

Against tests/references/elevator.py. Figures in comments are what was measured; tolerances leave a factor of about two
to four above them.
"""

import numpy as np
import pytest
from physics.lifting.lifts import at_start, body, end, energy_missing, of, orders, run, scene, sheave
from references import crane, elevator
from references.elevator import Elevator

from tautline.integrators.vibration.modes import modes

LAW = {"law": "no_slip"}
NONE = (0.0, 0.0, 0.0)
UNLIKE = Elevator(inertia=60.0, roof=5.0e5)


def arc(lift):
    """Rope from the sheave's top to where it leaves it, m."""
    return 0.5 * np.pi * lift.radius


def elevator_scene(lift, offset=NONE, velocity=NONE, step=1e-3, end_at=1.0):
    """The elevator with its masses and its sheave set off downwards from rest, m and m/s; its rope does not slip."""
    depth, unstretched = lift.at_rest(), lift.length_1 + lift.length_2
    one, two, cage = np.array([depth[0] - arc(lift), depth[1] - arc(lift), depth[2]]) + offset
    down = [{"velocity": (0.0, 0.0, -v)} for v in velocity]
    spring = {"stiffness": (0.0, 0.0, lift.roof), "rest": NONE}
    bodies = [
        body("one", lift.mass_1, (-lift.radius, 0.0, -one), "xy", **down[0]),
        body("two", lift.mass_2, (lift.radius, 0.0, -two), "xy", **down[1]),
        body("cage", lift.sheave_mass, (0.0, 0.0, -cage), "xy", spring=spring, **down[2]),
    ]
    path = [end("one"), sheave("top", lift.radius, body="cage", inertia=lift.inertia, **LAW), end("two")]
    rope = {"mass_per_length": 1e-6, "axial_stiffness": lift.axial_stiffness, "damping": 0.0, "length": unstretched}
    solver = {"step": step, "end": end_at, "rho_inf": 1.0}
    return scene(path, bodies, rope, solver, 0.01, start="as drawn")


def frequencies(lift):
    """The three that are not 0, Hz; and that of the drift, which the roundings of the start make."""
    drift, *found = modes(*at_start(elevator_scene(lift))).frequency
    assert abs(drift) < 1e-3
    return found


@pytest.mark.parametrize("lift", [Elevator(), UNLIKE], ids=["as in the paper's kind", "heavy sheave on a soft roof"])
def test_elevator_has_the_frequencies_of_its_cubic(lift):
    # Measured 4e-9 to 5e-8: the rope's mass
    expected = elevator.spring_frequencies(
        lift.mass_1, lift.mass_2, *lift.stiffnesses, lift.sheave_mass, lift.inertia, lift.radius, lift.roof
    )  # fmt: skip
    assert frequencies(lift) == pytest.approx(expected, rel=2e-7)
    assert expected == pytest.approx(lift.frequencies()[1:], rel=1e-9)


def test_symmetric_elevator_has_the_frequencies_of_its_closed_form():
    lift = Elevator(length_1=15.0, length_2=15.0)
    args = (lift.mass_1, lift.stiffnesses[0], lift.sheave_mass, lift.inertia, lift.radius, lift.roof)
    assert frequencies(lift) == pytest.approx(np.sort(elevator.symmetric_frequencies(*args)), rel=2e-7)


def test_elevator_without_inertia_of_its_sheave_has_one_tension():
    lift = Elevator(inertia=1e-6)
    stiffness = crane.tangent_stiffness(lift.stretches[0], lift.axial_stiffness) / (lift.length_1 + lift.length_2)
    expected = elevator.frictionless_frequencies(lift.mass_1, lift.mass_2, stiffness, lift.sheave_mass, lift.roof)
    assert frequencies(lift)[:2] == pytest.approx(expected, rel=1e-6)


def test_elevator_on_a_stiff_rope_bounces_on_its_roof():
    lift = Elevator(axial_stiffness=1e10)
    masses = (lift.mass_1, lift.mass_2, lift.sheave_mass)
    expected = elevator.stiff_rope_frequency(*masses, lift.inertia, lift.radius, lift.roof)
    assert frequencies(lift)[0] == pytest.approx(expected, rel=2e-3)


def released(lift, offset, velocity, step, end_at=1.0):
    """The motion of masses, sheave and rim less rest (n, 4), m; what the reference starts from; and the result."""
    result = run(elevator_scene(lift, offset, velocity, step, end_at))
    depth, material = -of(result, "body_position")[:, :, 2], of(result, "material_coordinate")[:, 1]
    # As built the whole rope has one stretch, by which the rim counts it; what side 1 has less has passed the rim.
    sides = depth[0, :2] - depth[0, 2] + arc(lift)
    stretch = sides.sum() / (lift.length_1 + lift.length_2)
    begun = stretch * lift.length_1 - sides[0]
    rim = begun - stretch * (material - material[0])
    found = np.column_stack((depth[:, :2] + arc(lift), depth[:, 2], rim)) - lift.at_rest()
    return found, {"offset": (*offset, begun), "velocity": (*velocity, 0.0)}, stretch, result


@pytest.mark.parametrize(
    ("lift", "offset", "velocity"),
    [
        (Elevator(), (0.01, 0.0, 0.005), NONE),
        (Elevator(), (0.0, 0.0, 0.0), (1.0, -1.0, 0.0)),
        (UNLIKE, NONE, (0.3, -0.1, 0.1)),
    ],
    ids=["let go", "running", "heavy sheave pushed"],
)
def test_released_elevator_moves_as_its_equations_say(lift, offset, velocity):
    # Nothing is damped, and the misses are the step's: order two
    misses, drifts, expected = [], [], None
    for step in (1e-3, 5e-4, 2.5e-4):
        found, start, stretch, result = released(lift, offset, velocity, step)
        if expected is None:
            expected = lift.finite(of(result, "time"), **start, held=stretch).q
        assert of(result, "tension").min() > 0.0
        misses.append(np.abs(found - expected).max(axis=0))
        drifts.append(energy_missing(result))
    assert orders(misses) == pytest.approx(np.full((2, 4), 2.0), abs=0.15)
    assert orders(drifts) == pytest.approx([2.0, 2.0], abs=0.2)
    assert np.all(misses[-1][:3] < 1e-2 * np.abs(expected).max(axis=0)[:3]) and drifts[-1] < 2e-6


def test_a_small_release_is_that_of_the_linear_theory():
    # 0.1 mm for half a second: to 1.3e-8 m at 0.1 ms
    found, start, _, result = released(Elevator(), (1e-4, 0.0, 0.0), NONE, 1e-4, 0.5)
    linear = Elevator().released(of(result, "time"), **start)
    assert found == pytest.approx(linear, abs=1e-7)
