"""Plants of bits whose blades cut what the last one left: slopes of steady drilling, and runs beside them.

A blade cuts from the depth u of the bit down to what the one before it left, which steady drilling with a cut d a turn
slopes by d / 2 pi: of n blades the cut is n (u - left(angle - 2 pi / n)), the rate Omega / 2 pi times that.
"""

import warnings
from math import pi

import numpy as np
import pytest
from physics.wells.strings import straight_hole
from scipy.linalg import expm

import tautline

RADIUS, ZETA, EPS, BLADES, WEIGHT, SPIN = 0.108, 0.6, 150e6, 5, 5e4, 4.0 * pi
WORN = 0.108 * 1.2e-3 * 100e6
FLATS = {"sharp": 0.0, "worn": WORN}
OUTPUTS = ["rate_of_penetration", "bit.weight", "bit.torque"]
DELAY = 2.0 * pi / (BLADES * SPIN)


def drilling(flats, time=0.0):
    """A simulation that drills steadily, and its cut in a turn, m."""
    cutting = {"specific_energy": EPS, "inclination": ZETA, "radius": RADIUS, "blades": BLADES}
    if flats:
        cutting |= {"wear_flat": "1.2 mm", "contact_strength": "100 MPa", "friction": 0.7, "bit_constant": 0.9}
    cut = (WEIGHT - flats) / (RADIUS * ZETA * EPS)
    scene = straight_hole(
        0.0, 400.0, bit={"on_bottom": True, "weight": WEIGHT, "cutting": cutting}, top__rotation=SPIN,
        top__block={"velocity": cut * SPIN / (2.0 * pi)}, well__wall="none", solver__end=10.0,
    )  # fmt: skip
    sim = tautline.Simulation(scene, inputs=["top.block_speed", "top.rotary_speed"], keep=False)
    if time:
        sim.advance_to(time)
    return sim, cut


def plant_of(sim):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # the bottom is constant in a plant
        return sim.linearise(["top.block_speed", "top.rotary_speed"], OUTPUTS)


def place(plant, motion, rate=""):
    """Where the bit's motion, or its rate, stands among the states."""
    return next(i for i, name in enumerate(plant.states) if name.startswith(rate) and name.endswith(motion))


@pytest.mark.parametrize("time", [0.0, 0.037])
@pytest.mark.parametrize("flats", FLATS.values(), ids=list(FLATS))
def test_the_rate_weight_and_torque_of_a_bit_that_drills_follow_its_angle_by_the_slope_of_the_bottom(flats, time):
    sim, cut = drilling(flats, time)
    plant = plant_of(sim)
    deeper, slope = BLADES * np.array([SPIN / (2.0 * pi), RADIUS * ZETA * EPS, 0.5 * RADIUS**2 * EPS]), cut / (2.0 * pi)
    assert plant.C[:, place(plant, ": along the hole")] == pytest.approx(deeper, rel=1e-5)
    assert plant.C[:, place(plant, ": rotation")] == pytest.approx(-slope * deeper, rel=1e-4)
    assert plant.C[0, place(plant, ": rotation", "d/dt")] == pytest.approx(slope, rel=1e-4)


@pytest.mark.parametrize("flats", FLATS.values(), ids=list(FLATS))
def test_a_plant_of_a_bit_with_blades_does_what_its_run_does_until_the_next_blade_comes(flats):
    sim, _ = drilling(flats, 0.02)
    plant, first = plant_of(sim), sim.time + 1e-3
    n, times = len(plant.A), sim.time + np.array([0.3, 0.6, 0.9]) * DELAY
    for i, (name, change) in enumerate([("top.block_speed", 1e-6), ("top.rotary_speed", 1e-4)]):
        pair = [sim.copy(), sim.copy()]
        for one, sign in zip(pair, (-1.0, 1.0), strict=True):
            one.inputs[name] += sign * change
            one.advance_to(first)  # an input goes on to its new value within a step
        for time in times:
            for one in pair:
                one.advance_to(time)
            moved = [0.5 * (float(pair[1].outputs[o]) - float(pair[0].outputs[o])) for o in OUTPUTS]
            whole = np.zeros((n + 1, n + 1))
            whole[:n] = np.column_stack((plant.A, plant.B[:, i]))
            x = expm(whole * (time - 0.5 * (first + sim.time)))[:n, n]
            told = (plant.C @ x + plant.D[:, i]) * change
            assert moved == pytest.approx(told, rel=0.02), (name, time)
