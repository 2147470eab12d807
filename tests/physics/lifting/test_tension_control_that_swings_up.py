"""A winch that holds a tension by an integral swings up where the rope damps too little: told, and by how much.

The reference is the run itself, which knows nothing of the formula: two tensions half a period apart from what is held,
many periods later, have grown as is told.
"""

import math

import numpy as np
import pytest
from physics.lifting.crane_scenes import anchor, body, crane, drum, end, parsed, ran, sheave

from crane.assembly.estimates import estimate
from crane.warnings import warnings
from crane.warnings.tension_control import loop_of

MASS, STIFFNESS, LENGTH, DAMPING = 2000.0, 1.0e6, 20.0, 2.0e-3
ROPE = {"mass_per_length": 1.0e-3, "axial_stiffness": STIFFNESS, "damping": DAMPING, "strain": "engineering"}
G = 9.81


def held(fixed, gains, load=800.0, falls=1, damping=DAMPING, other=None):
    """A winch that hauls at an anchor, at a load that rises along z, or at one on two falls; with its tension, N."""
    tension = 8.0e3 if fixed else load * G / falls
    asked = {"table": {"time": [0.0, 0.1, 200.0], "value": [0.999 * tension, tension, tension]}}
    winch = drum((0.0, 0.0, LENGTH), 0.2, tension=asked, inertia=0.04 * MASS, gains=gains)
    bodies = []
    if fixed:
        path = [winch, anchor((0.2, 0.0, 0.0), "wall")]
        if other is not None:
            path[1] = drum((0.4, 0.0, 0.0), 0.2, wrap="under", name="other", inertia=0.04 * MASS, **other)
    elif falls == 1:
        bodies = [body("load", load, (0.2, 0.0, 0.0), guide=["x", "y"])]
        path = [winch, end("load")]
    else:
        bodies = [body("load", load, (0.3, 0.0, 0.0), guide=["x", "y"])]
        path = [winch, sheave(radius=0.1, wrap="under", body="load", law="frictionless")]
        path += [anchor((0.4, 0.0, LENGTH), "beam")]
    rope = ROPE | {"damping": damping} | ({"length": LENGTH / (1.0 + tension / STIFFNESS)} if fixed else {})
    solver = {"step": 4.0e-3, "rho_inf": 1.0, "end": 9.0, "control": "fixed"}
    scene = crane(path, bodies, rope=rope, solver=solver, mesh={"elements_per_span": 1}, interval=4.0e-3)
    return scene, tension


CASES = {
    "an anchor": (True, {"integral": 1.0}, {}),
    "an anchor, and a proportional gain": (True, {"integral": 2.0, "proportional": 0.3}, {}),
    "a load": (False, {"integral": 2.0}, {}),
    "a load on two falls": (False, {"integral": 8.0}, {"falls": 2}),
    "a drum that a motor turns": (True, {"integral": 1.0}, {"other": {"torque": 1600.0}}),
    "a drum that a brake holds": (True, {"integral": 1.0}, {"other": {"torque": 1600.0, "brake": {"torque": 9000.0}}}),
    "a drum that holds the tension too": (
        True,
        {"integral": 1.0},
        {"other": {"tension": 8.0e3, "gains": {"integral": 1.0}}},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_tension_grows_as_the_warning_says(case):
    fixed, gains, more = CASES[case]
    scene, tension = held(fixed, gains, **more)
    made = parsed(scene)
    told = loop_of(estimate(made), made.drums[0]).growth(gains.get("proportional", 0.0), gains["integral"])
    assert told > 0.05
    result = ran(scene)
    off = np.abs(result["drum_tension"][:, 0] - tension)
    time = np.asarray(result["time"])
    early, late = (off[(time > at) & (time < at + 1.0)].max() for at in (2.0, 8.0))
    assert math.log(late / early) / 6.0 == pytest.approx(told, rel=0.06)


@pytest.mark.parametrize("case", CASES)
def test_beyond_the_gains_that_the_warning_gives_nothing_grows(case):
    fixed, gains, more = CASES[case]
    made = parsed(held(fixed, gains, **more)[0])
    loop = loop_of(estimate(made), made.drums[0])
    least, most = loop.least_proportional(gains["integral"]), loop.largest_integral(gains.get("proportional", 0.0))
    for part, grows in ((0.99, True), (1.01, False)):
        proportional = (1.0 + least) * part - 1.0
        assert (loop.growth(proportional, gains["integral"]) > 0.0) == grows
        if most > 0.0:
            assert (loop.growth(gains.get("proportional", 0.0), most / part) > 0.0) == grows


def test_what_swings_up_is_told_with_its_key_and_what_does_not_is_not():
    def told(gains, **more):
        return [
            str(one) for one in warnings(parsed(held(True, gains, **more)[0])) if "swings more and more" in str(one)
        ]

    (line,) = told({"integral": 1.0})
    assert "path[0].drum.gains.integral" in line
    assert "Give `proportional: 3.5` or more, or `integral: 0.05` or less" in line
    assert not told({"integral": 1.0, "proportional": 3.6})
    assert not told({"integral": 0.049})
    assert not told({"proportional": 2.0})
    (line,) = told({"integral": 1.0}, damping=0.0)
    assert "Give the rope a `damping:`" in line
    # a gain of the other drum stills both; a brake that is closed all the time leaves nothing to swing
    stiff = {"tension": 8.0e3, "gains": {"proportional": 20.0}}
    assert not told({"integral": 1.0}, other=stiff)
    scene, _ = held(True, {"integral": 1.0})
    scene["path"][0]["drum"]["brake"] = {"torque": 5000.0}
    assert not [one for one in warnings(parsed(scene)) if "swings more and more" in str(one)]


def test_a_drum_of_hardly_any_inertia_is_told_without_a_number_that_overflows():
    scene, _ = held(True, {"integral": 3000.0}, damping=0.0)
    scene["path"][0]["drum"]["inertia"] = 1.0e-6
    assert any("twice as much every" in str(one) for one in warnings(parsed(scene)))


def test_a_drum_with_friction_is_told_from_which_tension_on_it_swings_up():
    scene, _ = held(True, {"integral": 1.0})
    scene["path"][0]["drum"]["friction_torque"] = 20.0
    assert any("more and more once it is 100 N off" in str(one) for one in warnings(parsed(scene)))
