"""Loads with a height in waves: on a spring or on a rope, below the surface and through it.

References: Morison's inertia of a body that is held fast, (rho V + m_a) a_w; water that moves in circles; a box that
rides on a long wave; scipy's integration of the law in docs/crane.md, written anew here for one wave.
"""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from physics.lifting.crane_scenes import GRAVITY, body, ran
from physics.lifting.test_loads_through_the_surface import (
    BOTTOM,
    DENSITY,
    HEIGHT,
    LIFT,
    MASS,
    TALL,
    VOLUME,
    amplification,
    lifted,
    sprung,
    warnings,
)  # fmt: skip
from scipy.integrate import solve_ivp, trapezoid
from scipy.optimize import brentq

import tautline
from crane.application import Crane
from crane.operability.conditions import Condition, sea_keys
from crane.scene.scene import json_schema
from crane.sea.waves import waves_of
from tautline.scene.errors import SceneError
from tautline.scene.functions import Spectrum
from tautline.system.time_functions import jonswap

PERIOD, SIZE = 7.0, 0.8
TURN = 2.0 * np.pi / PERIOD
DISPLACED = DENSITY * VOLUME


def wave(amplitude=SIZE, period=PERIOD, ramp=0.0, **more):
    return {"elevation": {"harmonic": {"amplitude": amplitude, "period": period, "ramp": ramp}}, **more}


def in_waves(scene, waves):
    return scene | {"water": scene["water"] | {"waves": waves}}


def settled(found, after):
    return found["time"] > after


def test_a_body_that_is_held_fast_below_the_waves_is_pushed_by_their_acceleration():
    stiff, deep = 5.0e7, 9.0
    rest = -deep + (MASS * GRAVITY - LIFT) / stiff
    scene = in_waves(sprung(-deep, 0.0, 21.0, stiff, added_mass=[700.0, 0.0, ADDED]), wave(ramp=10.0))
    scene["bodies"][0]["spring"]["rest"] = [50.0, 0.0, rest]
    found = ran(scene)
    # The middle of the body is HEIGHT / 2 - BOTTOM above its position; Wheeler counts from the surface as it is.
    k = TURN**2 / GRAVITY
    late = settled(found, 12.0)
    eta = SIZE * np.sin(TURN * found["time"] - k * 50.0)
    assert found["surface_elevation"][late, 0] == pytest.approx(eta[late], abs=1e-9)
    below = deep + BOTTOM - 0.5 * HEIGHT + eta
    up = -SIZE * TURN**2 * np.exp(-k * below) * np.sin(TURN * found["time"] - k * 50.0)
    force = stiff * (rest - found["body_position"][:, 0, 2])
    expected = MASS * GRAVITY - LIFT - (DISPLACED + ADDED) * up
    assert np.ptp(expected) > 2.0e3
    assert force[late] == pytest.approx(expected[late], abs=0.02 * np.ptp(expected))


ADDED, DRAG = 1500.0, 4000.0


def test_a_body_as_heavy_as_water_goes_round_in_circles_with_it():
    small, soft = 0.05, {"stiffness": [0.1, 0.0, 0.1], "rest": [50.0, 0.0, -6.0]}
    load = body("load", DISPLACED, (50.0, 0.0, -6.0), guide=["y"], spring=soft, **TALL, added_mass=[900.0, 0.0, 400.0])
    scene = in_waves(sprung(0.0, 0.0, 40.0), wave(small, ramp=14.0, direction=0.0)) | {"bodies": [load]}
    found = ran(scene)
    late = settled(found, 20.0)
    late &= found["time"] <= 20.0 + PERIOD
    radius = small * np.exp(-(TURN**2) / GRAVITY * (6.0 + BOTTOM - 0.5 * HEIGHT))
    # The growing sea has left a drift of a millimetre in each period.
    assert 0.5 * np.ptp(found["body_position"][late, 0], axis=0) == pytest.approx([radius, 0.0, radius], rel=0.02)
    # Forward under a crest.
    crest = found["surface_elevation"][late, 0].argmax()
    assert found["body_velocity"][late, 0, 0][crest] == pytest.approx(radius * TURN, rel=0.05)


def test_a_box_that_floats_rides_on_a_wave():
    """With m = rho V / 2 the forces on it are those on the water in its place, and it moves as the surface does."""
    scene = in_waves(sprung(BOTTOM - 0.5 * HEIGHT, 0.0, 60.0, 1e-3, 0.5 * DISPLACED), wave(0.05, 11.0, ramp=40.0))
    found = ran(scene)
    late = settled(found, 45.0)
    moved = found["body_position"][late, 0, 2] - (BOTTOM - 0.5 * HEIGHT)
    k = (2.0 * np.pi / 11.0) ** 2 / GRAVITY
    # The water in the middle of what is wet is slower than the surface by exp(-k H / 4).
    turn, size = (2.0 * np.pi / 11.0) ** 2, LIFT / HEIGHT
    ratio = (size - 0.5 * DISPLACED * turn * np.exp(-0.25 * k * HEIGHT)) / (size - 0.5 * DISPLACED * turn)
    assert moved == pytest.approx(ratio * found["surface_elevation"][late, 0], abs=5e-4)


@pytest.mark.parametrize("depth", [None, 12.0], ids=["deep", "shallow"])
@pytest.mark.parametrize(("z", "velocity"), [(1.2, 0.0), (3.0, -4.0)], ids=["falls", "thrown"])
def test_a_load_goes_through_a_wave_as_its_equation_says(depth, z, velocity):
    stiffness, end = 4.0e4, 14.0
    more = {"added_mass": [0, 0, ADDED], "drag": {"quadratic": [0, 0, DRAG]}}
    scene = in_waves(sprung(z, velocity, end, stiffness, **more), wave(direction=np.pi / 3))
    if depth is not None:
        scene["ground"] = {"level": -depth, "stiffness": 1e7}
        k = brentq(lambda k: GRAVITY * k * np.tanh(k * depth) - TURN**2, 1e-3, 1.0)
    else:
        k = TURN**2 / GRAVITY
    found = ran(scene)

    def water(t, deep):
        theta = TURN * t - k * 50.0 * np.cos(np.pi / 3)
        eta = SIZE * np.sin(theta)
        if depth is None:
            decay = np.exp(-k * deep)
        else:
            decay = np.sinh(k * (depth - deep * depth / (depth + eta))) / np.sinh(k * depth)
        return (
            eta,
            SIZE * TURN * np.cos(theta),
            SIZE * TURN * decay * np.cos(theta),
            -SIZE * TURN**2 * decay * np.sin(theta),
        )

    def law(t, state):
        z, v = state
        eta, rises, _, _ = water(t, 0.0)
        wet = eta - z + BOTTOM
        share = np.clip(wet / HEIGHT, 0.0, 1.0)
        _, _, u, u_t = water(t, 0.5 * (max(wet, 0.0) + max(wet - HEIGHT, 0.0)))
        force = -MASS * GRAVITY + LIFT * share - stiffness * z + share * (DISPLACED + ADDED) * u_t
        force -= DRAG * share * abs(v - u) * (v - u)
        if 0.0 < share < 1.0 and rises > v:
            force -= ADDED / HEIGHT * (rises - v) * (v - u)
        return [v, force / (MASS + ADDED * share)]

    exact = solve_ivp(law, (0.0, end), (z, velocity), "DOP853", found["time"], rtol=1e-9, max_step=5e-3)
    moved = found["body_position"][:, 0, 2]
    assert np.ptp(moved) > 1.0 and moved == pytest.approx(exact.y[0], abs=4e-3)
    assert found.attributes["energy_error"] < 1e-4


def test_a_rope_bears_a_load_in_the_waves_and_what_they_do_is_booked():
    scene = in_waves(lifted({"ramp": {"to": 0.3, "over": 3.0}}, 3.0, added_mass=[800, 800, 1500]), wave(0.6, ramp=7.0))
    found = ran(scene)
    assert found.attributes["energy_error"] < 1e-3
    still = ran(lifted({"ramp": {"to": 0.3, "over": 3.0}}, 3.0, added_mass=[800, 800, 1500]))
    late = settled(found, 12.0)
    assert np.abs(found["tension"] - still["tension"])[late].max() > 1.0e3


def test_the_waves_of_a_vessel_are_those_that_it_answers():
    sea = {"significant_height": 1.2, "peak_period": 8.0, "ramp": 10.0, "seed": 4}
    vessel = {"reference": [0.5, 0.0, 0.0], "motion": {"heave": {"spectrum": sea | {"rao": 0.4}}}}
    scene = in_waves(lifted(0.0, -1.0, 20.0), {"elevation": "vessel", "direction": np.pi}) | {"vessel": vessel}
    scene["path"][0]["drum"]["frame"] = "vessel"
    scene["bodies"][0]["guide"] = ["x", "y"]
    found = ran(scene)
    heave = found["position"][:, 0, 2] - found["position"][0, 0, 2]
    assert heave == pytest.approx(0.4 * found["surface_elevation"][:, 0], abs=1e-9) and np.ptp(heave) > 0.2


def test_the_force_of_a_sea_on_a_load_below_it_has_the_spectrum_of_linear_theory():
    sea = {"significant_height": 0.4, "peak_period": 7.0, "ramp": 20.0, "seed": 2, "components": 100}
    scene = in_waves(lifted(0.0, -6.0, 320.0, 0.02, added_mass=[0, 0, ADDED]), {"elevation": {"spectrum": sea}})
    scene["bodies"][0]["guide"] = ["x", "y"]
    found = ran(scene)
    late = settled(found, 20.0)
    amplitude, frequency, _ = jonswap(Spectrum(**sea))
    assert found["surface_elevation"][late].std() == pytest.approx(0.1, rel=0.05)
    decay = np.exp(-(frequency**2) / GRAVITY * (6.0 + BOTTOM - 0.5 * HEIGHT))
    deviation = (DISPLACED + ADDED) * np.sqrt(0.5 * ((amplitude * frequency**2 * decay) ** 2).sum())
    assert found["tension"][late, 0, 1].std() == pytest.approx(deviation, rel=0.05)


def test_water_of_waves_of_no_height_is_still():
    scene = sprung(2.0, -6.0, 4.0, 4.0e4, added_mass=[0, 0, ADDED], drag={"quadratic": [0, 0, DRAG]})
    still, flat = ran(scene), ran(in_waves(scene, wave(0.0)))
    assert flat["body_position"] == pytest.approx(still["body_position"], abs=1e-9)
    assert not flat["surface_elevation"].any() and "surface_elevation" not in still


def test_explicit_steps_find_the_waves_where_implicit_ones_do():
    scene = in_waves(sprung(0.5, 0.0, 6.0, 4.0e4, added_mass=[0, 0, ADDED]), wave())
    one = ran(scene)["body_position"]
    two = ran(scene | {"solver": {"method": "rk4", "step": "auto", "end": 6.0}})["body_position"]
    assert two[:, 0] == pytest.approx(one[:, 0], abs=2e-3)


def test_a_run_that_is_saved_goes_on_in_the_same_waves():
    scene = in_waves(sprung(0.5, 0.0, 6.0, 4.0e4, added_mass=[0, 0, ADDED]), wave(ramp=4.0))
    whole = tautline.Simulation(scene)
    whole.advance(3.0)
    kept = whole.save()
    whole.advance(3.0)
    again = tautline.Simulation(scene)
    again.restore(kept)
    again.advance(3.0)
    assert again.outputs["load.position"] == pytest.approx(whole.outputs["load.position"], abs=0.0)


def test_the_mass_matrix_of_equations_has_the_added_mass_of_the_time_that_is_asked():
    scene = in_waves(sprung(BOTTOM - 0.5 * HEIGHT, 0.0, 6.0, 4.0e4, added_mass=[0, 0, ADDED]), wave())
    equations = tautline.Simulation(scene).equations
    _, q, _ = equations.state()
    k, made = TURN**2 / GRAVITY, []
    for t in (0.4, 2.6):
        share = 0.5 + SIZE * np.sin(TURN * t - k * 50.0) / HEIGHT
        made.append(equations.mass(q, t).toarray().max() - MASS - ADDED * share)
    assert made == pytest.approx([0.0, 0.0], abs=1e-6)


@pytest.mark.parametrize(("water", "bodies", "told"), [
    (wave() | {"elevation": {"constant": 1.0}}, {}, "unknown key 'constant'; known: harmonic, spectrum, sum"),
    (wave() | {"elevation": {"sum": [{"constant": 1.0}]}}, {}, "holds a function that is no wave"),
    (wave() | {"elevation": {"harmonic": {"amplitude": 1, "period": 8, "mean": 1}}}, {}, "has a mean"),
    ({"elevation": {"spectrum": {"significant_height": 1, "peak_period": 8, "rao": 0.4}}}, {}, "has a response"),
    ({"elevation": {"sum": [{"harmonic": {"amplitude": 1, "period": 8}},
                            {"harmonic": {"amplitude": 1, "period": 9, "ramp": 3}}]}}, {}, "several ramps"),
    ({"elevation": "vessel"}, {}, "the scene has no vessel"),
    ({"elevation": "ship"}, {}, "must be vessel, {spectrum: ...}, {harmonic: ...} or {sum: ...}"),
    ({"elevation": 0.5}, {}, "must be a word or a mapping; give vessel, {spectrum: ...}, {harmonic: ...} or {sum"),
    ({"elevation": {"sum": [{"sum": [{"constant": 1.0}]}]}}, {}, "holds a function that is no wave"),
    (wave(), {"height": None}, "no body has a `height`"),
])  # fmt: skip
def test_waves_that_are_none_are_refused(water, bodies, told):
    scene = in_waves(lifted(0.0, -1.0), water)
    if bodies:
        scene["bodies"] = [{k: x for k, x in scene["bodies"][0].items() if k not in ("height", "bottom")}]
    with pytest.raises(SceneError, match=re.escape(told)):
        tautline.read(scene)


def test_a_vessel_whose_responses_know_no_direction_asks_for_that_of_the_waves():
    sea = {"significant_height": 1.0, "peak_period": 8.0}
    vessel = {"reference": [0, 0, 0], "motion": {"heave": {"spectrum": sea}}}
    scene = in_waves(lifted(0.0, -1.0) | {"vessel": vessel}, {"elevation": "vessel"})
    with pytest.raises(SceneError, match="in which direction the waves run"):
        tautline.read(scene)


def test_a_vessel_whose_sea_acts_on_the_load_is_not_driven_from_outside():
    sea = {"significant_height": 1.0, "peak_period": 8.0, "ramp": 10.0}
    vessel = {"reference": [0, 0, 0], "motion": {"heave": {"spectrum": sea}}}
    scene = in_waves(lifted(0.0, -1.0) | {"vessel": vessel}, {"elevation": "vessel", "direction": 0.0})
    assert not [name for name in tautline.Simulation(scene).inputs if name.startswith("vessel.")]
    with pytest.raises(SceneError, match="is driven from outside"):
        tautline.Simulation(scene, inputs=["vessel.heave"])


def at_sea(waves):
    motion = {"heave": {"spectrum": {"significant_height": 1.0, "peak_period": 8.0, "rao": 0.4}}}
    vessel = {"reference": [0, 0, 0], "motion": motion}
    return tautline.read(in_waves(lifted(0.0, -1.0) | {"vessel": vessel}, waves))


def test_the_waves_on_a_load_follow_the_sea_states_of_operability():
    scene = at_sea({"elevation": "vessel", "direction": 0.0})
    changes = sea_keys(scene, headings=False).changes(Condition(2.4, 11.0, None), 7)
    storm = waves_of(scene.replace(changes))
    assert np.sqrt(0.5 * (storm.amplitude**2).sum()) == pytest.approx(0.6, rel=1e-9)
    peak = storm.frequency[storm.amplitude.argmax()]
    assert peak == pytest.approx(2.0 * np.pi / 11.0, rel=0.05)


def test_waves_of_their_own_are_no_sea_state_of_operability():
    with pytest.raises(SceneError, match="operability varies the sea of the vessel"):
        sea_keys(at_sea(wave(ramp=8.0)), headings=False)


@pytest.mark.parametrize("level", [0.0, 0.4])
def test_waves_without_water_between_surface_and_ground_are_refused(level):
    scene = in_waves(lifted(0.0, 6.0), wave(ramp=8.0)) | {"ground": {"level": level, "stiffness": 1e7}}
    with pytest.raises(SceneError, match=re.escape("is not below water.surface = 0 m")) as told:
        tautline.read(scene)
    assert [one.key for one in told.value.problems] == ["ground.level"]
    # Still water below the ground is no fault: it is that beside a quay.
    del scene["water"]["waves"]
    assert tautline.read(scene).ground.level == level


def test_a_sum_in_a_sum_of_waves_is_the_sum_of_all():
    one, two, three = (wave(size, period)["elevation"] for size, period in ((0.3, 6.0), (0.2, 9.0), (0.1, 11.0)))
    made = waves_of(tautline.read(in_waves(lifted(0.0, -1.0), {"elevation": {"sum": [one, {"sum": [two, three]}]}})))
    times = np.linspace(0.0, 30.0, 7)
    wanted = sum(a * np.sin(2.0 * np.pi * times / p) for a, p in ((0.3, 6.0), (0.2, 9.0), (0.1, 11.0)))
    assert made.elevation(0.0, 0.0, times) == pytest.approx(wanted, abs=1e-12)


def fixed_crane(waves):
    """A winch on the ground beside a vessel that answers a sea and does not move: it brings the sea alone."""
    scene = in_waves(lifted(0.0, -1.0, 25.0), waves)
    scene["path"][0]["drum"]["frame"] = "ground"
    heave = {"spectrum": {"significant_height": 1.0, "peak_period": 8.0, "ramp": 8.0, "rao": 0.0}}
    return scene | {"vessel": {"reference": [0, 0, 0], "motion": {"heave": heave}}}


def test_operability_of_a_fixed_crane_with_its_load_in_the_sea_has_forces_that_grow_with_the_sea():
    scene = tautline.read(fixed_crane({"elevation": "vessel", "direction": 0.0}))
    assert not [one for one in Crane().warnings(scene) if "rides on the vessel" in one.text]
    keys = sea_keys(scene, headings=False)
    ranges = []
    for height in (0.3, 0.9):
        run = tautline.simulate(scene.replace(keys.changes(Condition(height, 8.0, None), 7)))
        ranges.append(np.ptp(run["tension"][run["time"] > 8.0, 0, 1]))
    assert ranges[1] > 2.0 * ranges[0] > 0.0


def test_a_vessel_that_brings_no_sea_to_the_load_and_carries_no_rope_is_told_as_before():
    scene = fixed_crane(None)
    scene["vessel"]["motion"]["heave"]["spectrum"]["rao"] = 0.5
    scene = tautline.read(scene)
    assert [one for one in Crane().warnings(scene) if "rides on the vessel" in one.text]
    with pytest.raises(SceneError, match="the sea moves nothing"):
        sea_keys(scene, headings=False)


def swell(height, period, **more):
    return {"spectrum": {"significant_height": height, "peak_period": period, "ramp": 20.0, **more}}


@pytest.mark.parametrize(("terms", "told"), [
    # Two of 1.5 m in phase are one of 3 m: 6 m from trough to crest, and 0.142 of 24.98 m are 3.55 m.
    ([wave(1.5, 4.0, 8.0), wave(1.5, 4.0, 8.0)], "3.55 m high at most.*are one wave, 6 m high"),
    # In opposite phases nothing is left of them; of two periods neither is too high.
    ([wave(1.5, 4.0, 8.0), wave(-1.5, 4.0, 8.0)], None),
    ([wave(1.5, 4.0, 8.0), wave(1.5, 5.0, 8.0)], None),
    # 3 m and 3 m of independent seas are 4.24 m, and 6 m where they are the same waves; g 6^2 / (2 pi 15) is 3.75 m.
    ([swell(3.0, 6.0, seed=1), swell(3.0, 6.0, seed=2)], "together have a significant height of 4.24 m.*3.75 m high"),
    ([swell(3.0, 6.0, seed=1), swell(3.0, 6.0, seed=1)], "together have a significant height of 6 m"),
    # A wind sea on a swell: 3.6 m at 7.9 s.
    ([swell(2.0, 5.0, seed=1), swell(3.0, 14.0, seed=2)], None),
    # One that breaks alone is told alone.
    ([swell(4.0, 6.0, seed=1), swell(1.0, 6.0, seed=2)], "These are 4 m"),
])  # fmt: skip
def test_check_judges_the_waves_of_a_sum_together(terms, told):
    terms = [term.get("elevation", term) for term in terms]
    found = [one for one in warnings(in_waves(lifted(0.0, -1.0), {"elevation": {"sum": terms}})) if "break" in one]
    assert len(found) == (told is not None)
    assert told is None or re.search(told, found[0])


def test_check_tells_of_waves_that_break_and_of_a_sudden_sea():
    told = warnings(in_waves(lifted(0.0, -1.0), wave(2.0, 4.0, ramp=8.0)))
    # 0.142 of a length of 25 m.
    assert sum("3.55 m high at most" in one for one in told) == 1
    assert any("full height at t = 0" in one for one in warnings(in_waves(lifted(0.0, -1.0), wave(0.2))))
    assert not any("full height" in one for one in warnings(in_waves(lifted(0.0, -1.0), wave(0.2, ramp=8.0))))


def test_the_amplification_in_waves_is_over_the_rest_in_still_water():
    told = amplification(in_waves(lifted(0.0, -3.0, 30.0, added_mass=[0, 0, ADDED]), wave(0.6, ramp=10.0)))
    # Under a trough the surface is nearer by 0.6 m, and the water accelerates upwards.
    push = (DISPLACED + ADDED) * 0.6 * TURN**2 * np.exp(-(TURN**2) / GRAVITY * (3.0 + BOTTOM - 0.5 * HEIGHT - 0.6))
    assert told["value"] == pytest.approx(1.0 + push / (MASS * GRAVITY - LIFT), abs=0.01)


def test_check_tells_of_a_sea_that_breaks_over_its_bed():
    sea = {"spectrum": {"significant_height": 6.0, "peak_period": 12.0, "ramp": 20.0}}
    for depth, tells in ((8.0, 1), (12.0, 0)):
        scene = in_waves(lifted(0.0, -1.0), {"elevation": sea}) | {"ground": {"level": -depth, "stiffness": 1e7}}
        assert sum("break (Thornton" in one for one in warnings(scene)) == tells


def test_check_tells_of_a_load_in_another_sea_than_its_vessel():
    told = [one.text for one in Crane().warnings(at_sea(wave(ramp=8.0)))]
    assert sum("the vessel moves in another sea" in one for one in told) == 1


def test_motions_of_several_seas_give_no_waves():
    sea = {"significant_height": 1.0, "peak_period": 8.0}
    motion = {"heave": {"spectrum": sea}, "pitch": {"spectrum": sea | {"seed": 3, "rao": 0.01}}}
    scene = in_waves(lifted(0.0, -1.0), {"elevation": "vessel", "direction": 0.0})
    with pytest.raises(SceneError, match="several seas: seed of heave and pitch"):
        tautline.read(scene | {"vessel": {"reference": [0, 0, 0], "motion": motion}})


def test_a_body_that_meets_water_once_it_is_released_needs_a_height_too():
    left = {"at": 1.0, "remaining": 500.0, "volume": 0.3}
    scene = in_waves(lifted(0.0, -1.0), wave(ramp=8.0))
    scene["bodies"].append(body("other", 900.0, (30.0, 0.0, 5.0), spring={"stiffness": [1e4] * 3, "rest": [30, 0, 5]}))
    scene["bodies"][1]["release"] = left
    with pytest.raises(SceneError, match="is missing: waves move"):
        tautline.read(scene)


def test_the_schema_takes_each_way_to_write_waves_and_no_other():
    validator = Draft202012Validator(json_schema())
    for elevation, fits in (
        ("vessel", True), (wave()["elevation"], True), ("ship", False), ({"constant": 1.0}, False),
        ({"sum": [wave()["elevation"]]}, True),
    ):  # fmt: skip
        scene = in_waves(lifted(0.0, -1.0), {"elevation": elevation, "direction": 0.0})
        assert validator.is_valid(json.loads(json.dumps(scene))) == fits


@pytest.mark.parametrize("key", ["waves.direction", "waves.elevation.harmonic.amplitude"])
def test_each_case_of_a_sweep_has_the_waves_of_its_own(key):
    scene = tautline.read(in_waves(lifted(0.0, -1.0, 3.0), wave(ramp=1.0)))
    values = [0.0, 1.2] if key == "waves.direction" else [0.3, 0.7]
    runs = [tautline.simulate(scene.replace({f"water.{key}": value})) for value in values]
    alone = [trapezoid(run["surface_elevation"][:, 0], run["time"]) / 3.0 for run in runs]
    collect = [{"output": "surface_elevation[0]", "statistic": "mean", "name": "mean"}]
    data = tautline.sweep(scene, {f"water.{key}": values}, collect=collect, jobs=1)
    assert data["mean"].values == pytest.approx(alone, abs=1e-12) and abs(np.diff(alone)) > 1e-4


def test_a_catalogue_of_what_a_scene_has_knows_the_elevation():
    scene = in_waves(lifted(0.0, -1.0, 1.0), wave(0.2, ramp=1.0))
    assert "surface_elevation" in ran(scene) and Crane().warnings(tautline.read(scene)) is not None
