"""Rope and loads in a steady current.

References: scipy's integration of a hanging cable from its load up, by Morison's drag across it; of a load on a spring
that a current takes along; linear waves with a current added to them.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, ran
from physics.lifting.test_loads_in_waves import SIZE, TURN, in_waves, wave
from physics.lifting.test_loads_through_the_surface import BOTTOM, HEIGHT, MASS, lifted, sprung
from scipy.integrate import solve_ivp

import tautline
from tautline.scene.errors import SceneError

DENSITY, DIAMETER, DRAG = 1025.0, 0.04, 1.2
ROPE = {"mass_per_length": 8.0, "axial_stiffness": 4.0e9, "diameter": DIAMETER}
LOAD, VOLUME, PUSHED = 3.0e3, 1.0, 4000.0
PROFILE = {"depth": [0.0, 80.0, 250.0], "speed": [1.1, 0.6, 0.3], "direction": [0.0, 0.5, 2.0]}


def flow(z):
    """Velocity (2,) of the profile's water at a height."""
    speed, way = np.array(PROFILE["speed"]), np.array(PROFILE["direction"])
    return np.array([np.interp(-z, PROFILE["depth"], speed * part(way)) for part in (np.cos, np.sin)])


def hanging(current, elements=40, drawn=-300.0, **more):
    load = body("load", LOAD, (0.0, 0.0, drawn), volume=VOLUME, drag={"quadratic": [PUSHED] * 3})
    water = {"surface": 0.0, "density": DENSITY, "rope_drag": DRAG, "current": current}
    return crane(
        [anchor((0.0, 0.0, 0.0)), end("load")], [load], ROPE, water=water, mesh={"elements_per_span": elements},
        solver={"step": 0.05, "end": 1.0}, interval=0.5, **more,
    )  # fmt: skip


def from_the_load_up(place, length):
    """Where a rope of an unstretched length, m, ends whose lower end holds the load at a place: (3,) m, and its tension
    there, N."""
    weight = ROPE["mass_per_length"] * GRAVITY - DENSITY * 0.25 * np.pi * DIAMETER**2 * GRAVITY

    def rates(_, state):
        pull = state[3:]
        along = pull / np.linalg.norm(pull)
        past = np.array([*flow(state[2]), 0.0])
        across = past - (past @ along) * along
        drag = 0.5 * DENSITY * DRAG * DIAMETER * np.linalg.norm(across) * across
        stretched = 1.0 + np.linalg.norm(pull) / ROPE["axial_stiffness"]
        return np.concatenate([stretched * along, [-drag[0], -drag[1], weight - drag[2]]])

    here = flow(place[2])
    begin = [*place, *(-PUSHED * np.abs(here) * here), (LOAD - DENSITY * VOLUME) * GRAVITY]
    state = solve_ivp(rates, (0.0, length), begin, rtol=1e-10, atol=1e-9).y[:, -1]
    return state[:3], np.linalg.norm(state[3:])


def length_of(found):
    """Unstretched length of the rope between its ends, m."""
    return float(np.ptp(found["material_coordinate"][0]))


def test_a_load_hangs_in_a_current_that_turns_with_depth_as_a_cable_integrated_from_it_up():
    found = ran(hanging({"profile": PROFILE}))
    load = found["body_position"][0, 0]
    top, tension = from_the_load_up(load, length_of(found))
    assert load[0] > 0.5 and load[1] > 2.0
    assert top == pytest.approx(np.zeros(3), abs=5e-3)
    assert found["tension"][0, 0, 0] == pytest.approx(tension, rel=1e-4)
    # At rest, it stays there.
    assert found["body_position"][-1, 0] == pytest.approx(load, abs=1e-6)


def test_the_place_of_a_load_in_a_current_converges_with_the_square_of_the_mesh():
    errors = []
    for elements in (20, 40, 80):
        found = ran(hanging({"profile": PROFILE}, elements))
        errors.append(np.linalg.norm(from_the_load_up(found["body_position"][0, 0], length_of(found))[0]))
    assert errors[0] > 3.0 * errors[1] > 9.0 * errors[2]


@pytest.mark.parametrize(("pushed", "speeds"), [(6.0e4, [0.0, 0.5]), (2.0e4, [0.0, 1.0]), (4.0e3, [0.0, 2.0])])
def test_a_load_hangs_where_the_current_grows_with_depth(pushed, speeds, monkeypatch):
    """There the further down it hangs the harder it is pushed: without the change of the current no start was found."""
    profile = {"depth": [100.0, 110.0], "speed": speeds, "direction": [0.4, 0.4]}
    monkeypatch.setitem(globals(), "PROFILE", profile)
    monkeypatch.setitem(globals(), "PUSHED", pushed)
    found = ran(hanging({"profile": profile}, drawn=-105.0))
    load = found["body_position"][0, 0]
    top, tension = from_the_load_up(load, length_of(found))
    assert top == pytest.approx(np.zeros(3), abs=0.1) and np.hypot(*load[:2]) > 5.0
    assert found["tension"][0, 0, 0] == pytest.approx(tension, rel=1e-3)


@pytest.mark.parametrize("case", ["waves", "current"])
def test_first_order_equations_of_loads_in_moving_water_change_as_their_tangent_says(case):
    """Against differences of the equations: in waves the slow swing had the wrong sign."""
    if case == "waves":
        scene = in_waves(lifted({"ramp": {"to": -0.1, "over": 3.0}}, -1.2), wave())
    else:
        scene = hanging({"profile": PROFILE}, 4)
    sim = tautline.Simulation(scene)
    sim.advance(0.8)
    equations = sim.equations
    t, q, v = equations.state()
    y, h = np.concatenate([q, v]), 1e-6
    columns = [equations.first_order(t, y + h * e) - equations.first_order(t, y - h * e) for e in np.eye(y.size)]
    exact, found = np.stack(columns, axis=1) / (2.0 * h), np.asarray(equations.first_order_tangent(t, y))
    assert np.abs(found - exact).max() < 1e-5 * np.abs(exact).max()
    # What swings slowly is small beside how ropes stretch: the row of the load's own acceleration along x.
    row = q.size + int(np.argmax(np.abs(exact[q.size :, :]).max(axis=1) > 0.0))
    assert found[row] == pytest.approx(exact[row], abs=1e-5 * np.abs(exact[row]).max())


def test_a_load_on_a_spring_is_taken_along_by_a_current_as_scipy_integrates_it():
    stiffness, added, pushed, speed = 4.0e3, 800.0, 900.0, 1.4
    scene = sprung(-8.0, 0.0, 12.0, added_mass=[added, 0.0, 0.0], drag={"quadratic": [pushed, 0.0, 0.0]})
    scene["water"] = scene["water"] | {"current": {"speed": speed}}
    held = {"guide": ["y", "z"], "spring": {"stiffness": [stiffness, 0.0, 0.0], "rest": [50.0, 0.0, 0.0]}}
    scene["bodies"] = [scene["bodies"][0] | held]
    found = ran(scene, energy=1e-6)

    def rates(_, state):
        past = speed - state[1]
        return [state[1], (pushed * abs(past) * past - stiffness * state[0]) / (MASS + added)]

    exact = solve_ivp(rates, (0.0, 12.0), [0.0, 0.0], rtol=1e-10, atol=1e-10, t_eval=found["time"], method="DOP853")
    way = found["body_position"][:, 0, 0] - 50.0
    assert way == pytest.approx(exact.y[0], abs=2e-4) and way.max() > 0.5


def test_waves_and_a_current_move_the_water_together():
    stiff, deep, pushed, speed = 5.0e7, 9.0, 900.0, 0.7
    drag = {"quadratic": [pushed, 0.0, 0.0]}
    scene = in_waves(sprung(-deep, 0.0, 21.0, stiff, added_mass=[0.0] * 3, volume=0.0, drag=drag), wave(ramp=10.0))
    scene["water"]["current"] = {"speed": speed}
    # It begins in balance with the current alone: nothing rings.
    rest = 50.0 - pushed * speed**2 / stiff
    held = {"guide": ["y", "z"], "spring": {"stiffness": [stiff, 0.0, 0.0], "rest": [rest, 0.0, 0.0]}}
    scene["bodies"] = [scene["bodies"][0] | held]
    found = ran(scene)
    late, k = found["time"] > 12.0, TURN**2 / GRAVITY
    eta = SIZE * np.sin(TURN * found["time"] - k * 50.0)
    u = speed + SIZE * TURN * np.exp(-k * (deep + BOTTOM - 0.5 * HEIGHT + eta)) * np.sin(
        TURN * found["time"] - k * 50.0
    )
    force = stiff * (found["body_position"][:, 0, 0] - rest)
    assert force[late] == pytest.approx((pushed * np.abs(u) * u)[late], abs=0.02 * pushed * speed**2)


def test_water_that_flows_at_no_speed_is_still_water():
    still, flowing = hanging({"speed": 0.8}), hanging({"speed": 0.0})
    del still["water"]["current"]
    for name in ("position", "tension", "body_position"):
        assert ran(flowing)[name] == pytest.approx(ran(still)[name], rel=1e-12, abs=1e-9)


@pytest.mark.parametrize(("current", "told"), [
    ({}, "speed: is missing"),
    ({"speed": -0.5}, "must not be negative"),
    ({"speed": 0.5, "profile": PROFILE}, "keep one of them"),
    ({"profile": PROFILE, "direction": 1.0}, "profile.direction too"),
    ({"profile": PROFILE | {"speed": [1.0, 0.5]}}, "has 2 entries, and depth has 3"),
    ({"profile": PROFILE | {"depth": [0.0, 80.0, 80.0]}}, "must be deeper than the one before (80 m)"),
    ({"profile": PROFILE | {"depth": []}}, "is an empty list"),
])  # fmt: skip
def test_currents_that_are_none_are_refused(current, told):
    with pytest.raises(SceneError, match=re.escape(told)):
        tautline.read(hanging(current))


def test_a_load_that_the_current_carries_far_is_told_as_carried_by_it():
    found = ran(hanging({"speed": 2.0}, 10))
    told = [text for text in found.attributes["warnings"] if "far from the initial geometry" in text]
    assert len(told) == 1 and "Look at the first frame: the current may hold it there. If not, give" in told[0]


def test_an_amplification_of_a_scene_as_drawn_in_a_current_says_that_it_is_over_still_water():
    found = ran(hanging({"speed": 0.8}, 10, start="as drawn"))
    assert "tension at rest in still water estimated" in found.headline["dynamic_amplification"]["text"]


def test_a_current_that_takes_along_what_comes_in_acts():
    scene = lifted({"ramp": {"to": 0.5, "over": 3.0}}, 3.0, added_mass=[300.0, 300.0, 500.0])
    still = ran(scene)["body_position"][:, 0, 0]
    scene["water"] = scene["water"] | {"current": {"speed": 0.8}}
    swing = ran(scene)["body_position"][:, 0, 0] - still
    assert np.abs(swing).max() > 0.05 and swing[np.abs(swing) > 0.01][0] > 0.0


def test_a_current_that_acts_on_nothing_is_refused():
    scene = hanging({"speed": 0.8})
    scene["water"]["rope_drag"], scene["bodies"][0]["drag"] = 0.0, {}
    with pytest.raises(SceneError, match="acts on nothing"):
        tautline.read(scene)
