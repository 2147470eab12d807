"""Loads with a height that come into still water and out of it.

References: Archimedes' buoyancy of a prism, by hand; the period of a floating box, 2 pi sqrt(m H / (rho g V)); and
scipy's integration of m z.. = F of the law in docs/crane.md, written anew here.
"""

from __future__ import annotations

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, drum, end, ran
from scipy.integrate import solve_ivp

import tautline
from crane.application import Crane
from tautline.scene.errors import SceneError

DENSITY, VOLUME, HEIGHT, BOTTOM, MASS = 1025.0, 2.0, 2.5, 1.0, 5000.0
WATER = {"surface": 0.0, "density": DENSITY}
LIFT = DENSITY * GRAVITY * VOLUME
TALL = {"volume": VOLUME, "height": HEIGHT, "bottom": BOTTOM}
ADDED, DRAG = 1500.0, 4000.0


def sprung(z, velocity, end, stiffness=1.0e4, mass=MASS, step=2.0e-3, **more):
    """A load on a spring to the ground that is free in z alone, beside a rope that has nothing to do with it."""
    held = {"guide": ["x", "y"], "spring": {"stiffness": [0, 0, stiffness], "rest": [50.0, 0.0, 0.0]}}
    load = body("load", mass, (50.0, 0.0, z), velocity=(0.0, 0.0, velocity), **held, **(TALL | more))
    solver = {"step": step, "end": end, "rho_inf": 1.0}
    path = [anchor((0.0, 0.0, 10.0)), anchor((10.0, 0.0, 10.0), "other")]
    light = {"mass_per_length": 1.0e-3, "axial_stiffness": 1.0e6}
    return crane(path, [load], light, interval=0.02, solver=solver, water=WATER, start="as drawn")


def share(z):
    """Share of the height under water of a load whose position is at z."""
    return np.clip((BOTTOM - z) / HEIGHT, 0.0, 1.0)


def law(t, state, mass, stiffness, added, drag):
    """z.. of a load on a spring in water: weight, buoyancy, drag, added mass and what it takes up while it sinks."""
    z, v = state
    wet = share(z)
    force = -mass * GRAVITY + LIFT * wet - stiffness * z - drag * wet * abs(v) * v
    if v < 0.0 and 0.0 < wet < 1.0:
        force += added / HEIGHT * v * v
    return [v, force / (mass + added * wet)]


def test_a_box_that_floats_heaves_with_its_natural_period():
    mass, soft = 1025.0, 1.0e-3  # it floats half under water
    found = ran(sprung(BOTTOM - 0.5 * HEIGHT + 0.4, 0.0, 10.0, soft, mass))
    turn = np.sqrt(LIFT / HEIGHT / mass)
    rest = BOTTOM - 0.5 * HEIGHT
    expected = rest + 0.4 * np.cos(turn * found["time"])
    assert found["body_position"][:, 0, 2] == pytest.approx(expected, abs=2e-4)


@pytest.mark.parametrize(("z", "velocity"), [(2.0, 0.0), (2.0, -6.0), (-1.6, 14.0)], ids=["falls", "thrown", "bursts"])
def test_a_load_goes_through_the_surface_as_its_equation_says(z, velocity):
    more = {"added_mass": [0, 0, ADDED], "drag": {"quadratic": [0, 0, DRAG]}}
    found = ran(sprung(z, velocity, 6.0, 4.0e4, **more))
    given = (MASS, 4.0e4, ADDED, DRAG)
    exact = solve_ivp(law, (0.0, 6.0), (z, velocity), "DOP853", found["time"], args=given, rtol=1e-9, max_step=1e-2)
    wet = share(exact.y[0])
    assert wet.min() == 0.0 and wet.max() == 1.0
    # The law has its kinks where the surface is met; there s' grows within 2 % of the height here.
    assert found["body_position"][:, 0, 2] == pytest.approx(exact.y[0], abs=2e-3)
    assert found.attributes["energy_error"] < 1e-4


def lifted(pay_out, z, end_at=20.0, step=5.0e-3, release=None, **more):
    load = body("load", MASS, (0.5, 0.0, z), **(TALL | more), **({} if release is None else {"release": release}))
    rope = {"mass_per_length": 1.0e-3, "axial_stiffness": 4.0e7, "damping": 5.0e-3}
    path = [drum((0.0, 0.0, 20.0), pay_out=pay_out), end("load")]
    solver = {"step": step, "end": end_at}
    return crane(path, [load], rope, water=WATER, mesh={"elements_per_span": 1}, solver=solver, interval=0.05)


def test_a_rope_bears_what_water_does_not_as_the_load_is_hoisted_out():
    found = ran(lifted({"ramp": {"to": -0.3, "over": 3.0}}, -3.0))
    z, tension = found["body_position"][:, 0, 2], found["tension"][:, 0, 1]
    steady = found["time"] > 4.0
    assert share(z[0]) == 1.0 and share(z[-1]) == 0.0
    assert tension[0] == pytest.approx(MASS * GRAVITY - LIFT, rel=1e-6)
    expected = MASS * GRAVITY - LIFT * share(z)
    assert tension[steady] == pytest.approx(expected[steady], abs=3e-3 * MASS * GRAVITY)
    assert tension[-1] == pytest.approx(MASS * GRAVITY, rel=1e-3)


def amplification(scene, **parameters):
    if not parameters:
        return ran(scene).headline["dynamic_amplification"]
    sim = tautline.Simulation(scene, parameters=parameters)
    sim.advance(scene["solver"]["end"])
    return sim.result.headline["dynamic_amplification"]


def test_the_amplification_of_a_lift_is_over_the_load_at_rest_where_the_winch_has_it():
    hoisting, lowering = ({"ramp": {"to": speed, "over": 3.0}} for speed in (-0.3, 0.3))
    for told in (amplification(lifted(hoisting, -3.0)), amplification(lifted(lowering, 3.0))):
        assert "where the load is" in told["text"] and told["value"] == pytest.approx(1.0, abs=0.04)
    # A mass that a run is given counts in both: twice the load is lifted as smoothly.
    doubled = amplification(lifted(hoisting, -3.0), **{"load.mass": 2.0 * MASS})
    assert doubled["value"] == pytest.approx(1.0, abs=0.04)


def test_the_amplification_of_a_lift_with_heave_compensation_is_too():
    vessel = {"reference": [0, 0, 0], "motion": {"heave": {"harmonic": {"amplitude": 0.3, "period": 8, "ramp": 4}}}}
    scene = lifted({"ramp": {"to": -0.3, "over": 3.0}}, -3.0)
    told = amplification(scene | {"vessel": vessel, "heave_compensation": {"gain": 0.95}})
    assert "where the load is" in told["text"] and 1.0 < told["value"] < 1.1


def test_while_a_load_nearly_floats_its_amplification_does_not_count():
    # It was 824: a rope at rest of 50 N. At the last time that counts the rope has 5 % of the load.
    told = amplification(lifted({"ramp": {"to": 0.3, "over": 3.0}}, 3.0, volume=0.999 * MASS / DENSITY))
    assert 1.0 < told["value"] < 1.2
    floats = lifted({"ramp": {"to": 0.3, "over": 3.0}}, 3.0, volume=1.1 * MASS / DENSITY)
    assert 1.0 < amplification(floats)["value"] < 1.2
    assert any("floats up as the winch lowers it" in one for one in warnings(floats))
    assert not any("floats" in one for one in warnings(lifted({"ramp": {"to": 0.3, "over": 3.0}}, 3.0)))


def test_the_amplification_of_a_load_that_a_boom_lifts_out_is_over_the_rest_where_the_load_is():
    boom = {"name": "boom", "pivot": [-10.0, 0.0, 20.0], "luff": {"ramp": {"to": -0.6, "over": 10.0}}}
    scene = lifted(0.0, -3.0, 12.0)
    scene["path"][0]["drum"] |= {"frame": "boom"}
    told = amplification(scene | {"frames": [boom]})
    assert "over that at rest where the load is" in told["text"] and told["value"] == pytest.approx(1.0, abs=0.08)


def test_a_winch_that_pays_out_as_its_vessel_heaves_amplifies_nothing():
    # What it pays out is no hoisting: it was 1.26, and the load moved by 2 mm.
    heave = {"harmonic": {"amplitude": 1.0, "period": 12.0, "phase": -0.5 * np.pi, "mean": 1.0}}
    rate = {"harmonic": {"amplitude": 2.0 * np.pi / 12.0, "period": 12.0}}
    scene = lifted(rate, BOTTOM - 0.5 * HEIGHT, 40.0)
    told = amplification(scene | {"vessel": {"reference": [0, 0, 0], "motion": {"heave": heave}}})
    assert told["value"] == pytest.approx(1.0, abs=5e-3)


def test_the_amplification_of_a_slow_lift_from_depth_counts_the_stretch_of_the_rope():
    # 600 m of rope become shorter by 0.3 m as the load comes to weigh more: a thin load is out before the winch is.
    scene = lifted({"ramp": {"to": -1.0, "over": 5.0}}, -595.0, 610.0, step=0.05, height=0.5, bottom=0.2)
    found = ran(scene | {"output": {"interval": 0.2}, "solver": scene["solver"] | {"end": 605.0}})
    z = found["body_position"][:, 0, 2]
    rest = MASS * GRAVITY - LIFT * np.clip((0.2 - z) / 0.5, 0.0, 1.0)
    assert z.max() > 1.0
    told = found.headline["dynamic_amplification"]
    assert told["value"] == pytest.approx((found["tension"][:, 0, 1] / rest).max(), rel=2e-3) and told["value"] < 1.15


def test_the_amplification_of_two_loads_one_of_which_leaves_the_water_says_over_what_it_is():
    scene = lifted({"ramp": {"to": -0.3, "over": 3.0}}, -2.0, 15.0)
    wheel = {"name": "block", "body": "block", "radius": 0.2, "axis": [0, 1, 0], "wrap": "under", "law": "frictionless"}
    scene["bodies"].append(body("block", 3000.0, (1.0, 0.0, 8.0), guide=["x", "y"]))
    scene["path"] = [scene["path"][0], {"sheave": wheel}, anchor((1.5, 0.0, 20.0))]
    scene["bodies"][0] |= {"guide": ["x", "y"], "spring": {"stiffness": [0, 0, 1e4], "rest": [0.5, 0.0, -2.0]}}
    told = amplification(scene)
    assert "in the water as it was then" not in told["text"]


def test_a_winch_that_only_holds_its_load_is_not_taken_to_hoist_it_out():
    scene = lifted(0.0, -30.0)
    scene["rope"]["breaking_load"] = 60.0e3
    held = {key: x for key, x in scene["path"][0]["drum"].items() if key != "pay_out"} | {"inertia": 50.0}
    wet = MASS * GRAVITY - LIFT
    for drive, tells in (({"tension": wet}, "28.9 kN"), ({"tension": 60.0e3, "torque_limit": 1e6}, "49.1 kN")):
        scene["path"][0]["drum"] = held | drive | {"gains": {"proportional": 1.0, "integral": 0.0}}
        (told,) = [one for one in warnings(scene) if "the tension at rest" in one]
        assert tells in told and ("out of the water" in told) == (tells == "49.1 kN")


def test_the_amplification_of_a_load_that_stays_in_the_surface_is_over_the_rest_of_the_start():
    still = amplification(lifted(0.0, BOTTOM - 0.5 * HEIGHT, 1.0))
    assert "water" not in still["text"] and "winch" not in still["text"] and still["value"] == pytest.approx(1.0)
    shaken = lifted(0.0, BOTTOM - 0.5 * HEIGHT, 6.0, force=[0, 0, {"harmonic": {"amplitude": 5e3, "frequency": 0.5}}])
    found = ran(shaken)
    value = found["tension"][:, 0, 1].max() / (MASS * GRAVITY - 0.5 * LIFT)
    assert value > 1.1 and found.headline["dynamic_amplification"]["value"] == pytest.approx(value, rel=1e-3)


def test_the_amplification_of_a_snatch_below_the_surface_is_not_over_the_load_in_air():
    jerk = [0, 0, {"table": {"time": [0.0, 1.0, 1.1, 1.2, 30.0], "value": [0.0, 0.0, -4e4, 0.0, 0.0]}}]
    found = ran(lifted({"ramp": {"to": -0.3, "over": 3.0}}, -3.0, force=jerk))
    peak = found["tension"][:, 0, 1].max()
    assert found["time"][found["tension"][:, 0, 1].argmax()] < 2.0
    assert found.headline["dynamic_amplification"]["value"] == pytest.approx(peak / (MASS * GRAVITY - LIFT), rel=0.01)


def test_a_load_starts_at_rest_half_in_the_water():
    found = ran(lifted(0.0, BOTTOM - 0.5 * HEIGHT, 1.0))
    assert found["tension"][:, 0, 1] == pytest.approx(MASS * GRAVITY - 0.5 * LIFT, rel=1e-6)


def test_what_drops_in_the_surface_takes_its_water_along():
    left = {"at": 1.0, "remaining": 2000.0, "volume": 0.5, "added_mass": [0, 0, 200.0], "height": 1.0, "bottom": 0.5}
    more = {"added_mass": [0, 0, ADDED], "drag": {"quadratic": [0, 0, DRAG], "linear": [0, 0, 2000.0]}}
    found = ran(lifted({"ramp": {"to": -0.3, "over": 0.5}}, 0.0, 8.0, 1e-3, release=left | {"drag": {}}, **more))
    assert found.attributes["energy_error"] < 1e-5
    rest = found["tension"][-1, 0, 1]
    assert rest == pytest.approx(2000.0 * GRAVITY, rel=2e-2)


def warnings(scene):
    return [one.text for one in Crane().warnings(tautline.read(scene))]


def test_check_has_nothing_to_say_of_a_load_with_a_height_that_leaves_the_water():
    scene = lifted({"ramp": {"to": -0.3, "over": 3.0}}, -3.0)
    assert not any("water" in one for one in warnings(scene))
    anywhere = scene | {"bodies": [{k: x for k, x in scene["bodies"][0].items() if k not in ("height", "bottom")}]}
    (told,) = [one for one in warnings(anywhere) if "water" in one]
    assert "Give load a `height`, with `bottom`" in told


def test_check_judges_the_rope_by_the_load_in_air_where_the_winch_hoists_it_out():
    weak = {"breaking_load": 60.0e3}
    hoisted, lowered = (lifted({"ramp": {"to": speed, "over": 3.0}}, -3.0) for speed in (-0.3, 0.3))
    told = [
        next((one for one in warnings(scene | {"rope": scene["rope"] | weak}) if "tension at rest" in one), None)
        for scene in (hoisted, lowered)
    ]
    assert "49.1 kN" in told[0] and "28.9 kN" in told[1]


def test_check_says_that_a_load_in_the_surface_of_a_sea_meets_no_waves():
    sea = {"heave": {"spectrum": {"significant_height": 1.0, "peak_period": 8.0, "rao": 0.5}}}
    vessel = {"reference": [0, 0, 0], "motion": sea}
    for z, tells in ((0.0, True), (-6.0, False)):
        told = [one for one in warnings(lifted(0.0, z) | {"vessel": vessel}) if "the sea moves the vessel only" in one]
        assert len(told) == tells


@pytest.mark.parametrize("end_at", [60.0, 3600.0])
@pytest.mark.parametrize("z", [3.0, 3.1, 3.2])
def test_check_sees_a_thin_load_pass_the_surface_however_long_the_run_is(end_at, z):
    thin = {"height": 0.2, "bottom": 0.1, "volume": 0.3}
    scene = lifted({"ramp": {"to": 0.5, "over": 1.0}}, z, end_at, 0.02, **thin)
    scene["solver"]["control"] = "fixed"
    assert len([one for one in warnings(scene) if "passes the surface with up to 0.5 m/s" in one]) == 1


def test_a_load_that_is_slow_at_the_surface_may_be_fast_below_it():
    slow_then_fast = {"table": {"time": [0.0, 40.0, 41.0, 60.0], "value": [0.0, 4.0, 5.0, 45.0]}}
    scene = lifted(slow_then_fast, 1.5, 60.0, 0.02)
    scene["solver"]["control"] = "fixed"
    assert not any("passes the surface" in one for one in warnings(scene))


def test_the_step_that_is_asked_for_is_no_longer_than_what_is_enough():
    scene = lifted({"ramp": {"to": 3.0, "over": 1.0}}, 1.0, 3.0, 0.02)
    scene["solver"]["control"] = "fixed"
    (told,) = [one for one in warnings(scene) if "passes the surface" in one]
    # 2 % of 2.5 m at 3 m/s are 16.7 ms.
    assert "Take 0.01 s or less" in told


def test_what_is_let_go_high_above_the_water_is_not_said_to_float():
    left = {"at": 1.0, "remaining": 100.0, "volume": 0.2, "height": 1.0, "bottom": 0.5}
    for z, floats in ((8.0, False), (-3.0, True)):
        told = [one for one in warnings(lifted(0.0, z, release=left)) if "floats up when its load has dropped" in one]
        assert len(told) == floats


def test_a_light_load_with_a_height_is_said_to_float_in_the_surface():
    (told,) = [one for one in warnings(lifted(0.0, -2.0, volume=6.0) | {"start": "as drawn"}) if "floats" in one]
    assert "floats in the surface, and its rope goes slack" in told and "any height" not in told


def test_check_asks_for_steps_that_follow_how_water_takes_hold():
    fast = {"ramp": {"to": -4.0, "over": 1.0}}
    told = []
    for step in (0.02, 0.01):
        scene = lifted(fast, -5.0, 3.0, step)
        scene["solver"]["control"] = "fixed"
        told.append([one for one in warnings(scene) if "passes the surface" in one])
    assert len(told[0]) == 1 and "Take 0.01 s or less" in told[0][0] and told[1] == []


def test_a_height_that_stays_after_a_release_is_warned_of():
    told = warnings(lifted(0.0, -3.0, release={"at": 1.0, "remaining": 1000.0, "volume": 0.1, "bottom": 0.2}))
    assert any("keeps all its `height`" in one for one in told)


def test_a_load_that_floats_where_it_is_drawn_may_be_drawn_higher():
    light = lifted(0.0, -3.0)
    light["bodies"][0]["mass"] = 1500.0
    with pytest.raises(SceneError, match="or draw it higher"):
        ran(light)
    light["bodies"][0]["position"] = [0.5, 0.0, 1.0]
    assert ran(light)["tension"][0, 0, 1] > 0.0


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        ({"bottom": None}, "nothing says how far its lowest point is below"),
        ({"height": 0.0}, "greater than zero"),
        ({"height": None, "bottom": None, "release": {"at": 1, "remaining": 1000, "height": 1}}, "has none before"),
    ],
)
def test_a_height_that_says_nothing_is_refused(change, cause):
    scene = lifted(0.0, -3.0)
    load = scene["bodies"][0] | change
    scene["bodies"] = [{key: x for key, x in load.items() if x is not None}]
    with pytest.raises(SceneError, match=cause):
        tautline.read(scene)


def test_a_height_without_water_is_refused():
    scene = {key: x for key, x in lifted(0.0, -3.0, volume=0.0).items() if key != "water"}
    with pytest.raises(SceneError, match=r"height = 2.5: is given, and the scene has no water"):
        tautline.read(scene)


def test_added_mass_of_such_a_load_is_a_parameter_of_a_simulation():
    speeds = []
    for added in (0.0, MASS):
        sim = tautline.Simulation(
            sprung(-4.0, 0.0, 1.0, added_mass=[0, 0, ADDED]), parameters={"load.added_mass[2]": added}
        )
        sim.advance(0.02)
        speeds.append(sim.outputs["load.velocity[2]"])
    push = LIFT + 4.0e4 - MASS * GRAVITY
    assert speeds == pytest.approx([push / MASS * 0.02, push / MASS * 0.01], rel=1e-3)
