"""Plants of inputs at their bounds and of laws at their kinks, against closed forms and runs."""

import re
import warnings

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import tautline
from tautline.live.errors import SimulationError
from tautline.live.plant.differences import Room, slopes

BRAKE, MOTOR, RADIUS = 3000.0, 1000.0, 0.3
SCENE = """
title: A load on a winch
rope: {mass_per_length: 2.2, axial_stiffness: 4.0e7, damping: 2.0e-3, diameter: 22 mm, breaking_load: 0.4 MN}
bodies: [{name: payload, mass: 2 t, position: [8.0, 0, -9.0]}]
path:
  - drum:   {name: winch, center: [0.5, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, inertia: 50, WINCH}
  - sheave: {name: tip, center: [7.8, 0, 6], radius: 0.2, axis: [0, 1, 0], wrap: over, inertia: 1.5, law: no_slip}
  - end:    {name: hook, body: payload}
mesh: {elements_per_span: 2}
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 0.5 ms, end: 12 s}
output: {interval: 50 ms}
"""
HOLDS = "tension: 20 kN, gains: {proportional: 0, integral: 0}, torque_limit: LIMIT"
SLIPS = f"torque: {MOTOR}, friction_torque: 100, brake: {{torque: {BRAKE}, closed: SHARE}}"
STICKS = "torque: 6 kN m, friction_torque: 100"


def of(winch):
    return tautline.Simulation(SCENE.replace("WINCH", winch), keep=False)


def plant_of(sim, inputs, outputs):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        plant = sim.linearise(inputs, outputs)
    return plant, [str(one.message) for one in said]


@pytest.mark.parametrize("share", [0.0, 0.0015, 0.3, 1.0])
def test_a_brake_at_its_bounds_acts_as_its_torque_on_the_drum_and_as_in_a_run(share):
    sim = of(SLIPS.replace("SHARE", str(share)))
    sim.advance(0.1)
    plant, said = plant_of(sim, ["winch.brake", "winch.torque"], ["winch.pay_out_speed", "winch.tension"])
    assert not said
    assert np.allclose(plant.B[:, 0], BRAKE * plant.B[:, 1], rtol=1e-6, atol=1e-9 * np.abs(plant.B[:, 0]).max())
    assert np.allclose(plant.D[:, 0], BRAKE * plant.D[:, 1], rtol=1e-5, atol=1e-6)
    as_it_is, moved = sim.copy(), sim.copy()
    change, end = (-0.01 if share == 1.0 else 0.01), 0.02
    moved.inputs["winch.brake"] = share + change, 0.0, 0.0
    for one in (as_it_is, moved):
        one.advance(end)
    run = (float(moved["winch.pay_out_speed"]) - float(as_it_is["winch.pay_out_speed"])) / change

    def rate(t, x):
        part = t / end
        return plant.A @ x + plant.B[:, 0] * part**3 * (10.0 - 15.0 * part + 6.0 * part**2)

    found = solve_ivp(rate, (0.0, end), np.zeros(len(plant.A)), method="Radau", rtol=1e-7, atol=1e-11, jac=plant.A)
    assert (plant.C @ found.y[:, -1])[0] == pytest.approx(run, rel=2e-3)


def test_a_winch_that_stands_exactly_at_its_torque_limit_is_warned_of_with_both_sides():
    sim = of(HOLDS.replace("LIMIT", "6 kN m"))
    sim.advance(0.1)
    plant, said = plant_of(sim, ["winch.tension"], ["winch.torque"])
    (text,) = said
    assert "winch.tension stands at a limit" in text and "that it rises a force changes by nothing" in text
    falls = float(re.search(r"falls by ([-+]\d(?:\.\d+)?)", text)[1])
    assert abs(falls) == pytest.approx(1.0, rel=2e-3)  # but for the stretch of the rope
    assert np.abs(plant.B).max() == 0.0 and np.abs(plant.D).max() == 0.0


@pytest.mark.parametrize("limit, acts", [("6.0003 kN m", 1.0), ("5.9997 kN m", 0.0)])
def test_a_torque_limit_close_by_does_not_mix_with_the_slope(limit, acts):
    """A step of a thousandth of the tension would reach beyond it."""
    sim, free = of(HOLDS.replace("LIMIT", limit)), of(HOLDS.replace("LIMIT", "60 kN m"))
    for one in (sim, free):
        one.advance(0.1)
    (plant, said), (wanted, _) = (plant_of(one, ["winch.tension"], []) for one in (sim, free))
    assert not said
    assert np.allclose(plant.B, acts * wanted.B, rtol=1e-4, atol=1e-9)


def test_slopes_at_bounds_are_of_fourth_order():
    for room in (Room(), Room(below=0.0), Room(above=0.0), Room(0.0, 0.2)):
        found = slopes(lambda h: {"x": np.array([(1.0 + h) ** 4, 7.0])}, 0.1, room)["x"]
        assert np.allclose(found.value, [4.0, 0.0], rtol=1e-12, atol=0.0)


def test_what_may_not_change_either_way_has_no_slope_and_is_at_no_limit():
    seen = []
    found = slopes(lambda h: (seen.append(h), {"x": np.array([3.0 + h, h])})[1], 0.1, Room(0.0, 0.0))["x"]
    assert not np.any([found.value, found.below, found.above]) and found.value.shape == (2,) and not found.limited
    assert set(seen) == {0.0}


def test_a_step_never_leaves_its_room():
    seen = []
    slopes(lambda h: (seen.append(h), {"x": np.array(abs(h) ** 1.5)})[1], 0.1, Room(0.01, 0.15))
    assert min(seen) >= -0.01 and max(seen) <= 0.15


def test_at_a_kink_the_smaller_slope_counts_and_that_of_a_size_at_nothing_is_nothing():
    clamp = slopes(lambda h: {"x": np.array([min(h, 0.0), 3.0 * h]), "size": np.array(abs(h))}, 0.1)
    assert clamp["x"].limited and np.allclose(clamp["x"].value, [0.0, 3.0])
    assert not clamp["size"].limited and clamp["size"].value == pytest.approx(0.0, abs=1e-12)


def test_right_at_a_jump_the_slope_is_that_of_the_side_that_goes_on_from_what_is_now():
    """Beside a jump of 5 behind and one of -4 ahead stands a clamp, which keeps its smaller slope."""
    laws = {
        "behind": (lambda h: [3.0 + 2.0 * h if h >= 0.0 else -2.0, min(h, 0.0), 7.0 * h], [2.0, 0.0, 7.0]),
        "ahead": (lambda h: [3.0 + 2.0 * h if h <= 0.0 else -1.0, max(0.5 * h, h), 7.0 * h], [2.0, 0.5, 7.0]),
        "alone": (lambda h: 3.0 + 2.0 * h if h >= 0.0 else 0.0, 2.0),
    }
    for law, wanted in laws.values():
        found = slopes(lambda h, law=law: {"x": np.array(law(h))}, 1e-5)["x"]
        assert found.limited and found.value == pytest.approx(np.array(wanted), rel=1e-8, abs=1e-9)


def test_rounding_is_no_kink():
    noise = np.random.default_rng(1)
    for _ in range(100):
        found = slopes(lambda h: {"x": 2.0e4 + h + 1.0e-6 * noise.standard_normal(5)}, 1e-5)["x"]
        assert not found.limited


def test_a_drum_that_sticks_is_told_with_the_difference_of_pulls_at_which_a_run_lets_it_go():
    sim = of(STICKS)
    sim.advance(0.05)
    plant, said = plant_of(sim, [], [])
    (told,) = plant.stuck
    most, now = (float(x) for x in re.search(r"differ by more than ([\d.]+) N, now ([\d.]+) N", told).groups())
    pull = float(sim["winch.tension"])
    assert most == pytest.approx(100.0 / RADIUS, rel=1e-3)
    assert now == pytest.approx(abs(6000.0 / RADIUS - pull), abs=1e-3 * pull / 4.0)
    assert "brake" not in told and "open its brake" not in said[0] and "let its motor pull" in said[0]
    for share, slips in ((0.9, False), (1.1, True)):
        one = sim.copy()
        one.inputs["winch.torque"] = RADIUS * (pull - share * most), 0.0, 0.0
        one.advance(0.1)
        one.advance(0.2)
        assert (abs(float(one["winch.pay_out_speed"])) > 1e-5) == slips


def test_a_drum_that_brake_and_friction_hold_is_told_so_with_both_together():
    sim = of("torque: 6 kN m, friction_torque: 100, brake: {torque: 500}")
    plant, said = plant_of(sim, [], [])
    assert (
        plant.stuck[0].startswith("winch: its brake and its friction hold it until") and "than 2000 N" in plant.stuck[0]
    )
    assert "open its brake and set its friction_torque in the scene to 0" in said[0]


@pytest.mark.parametrize("name", ["tip.slipping", "slipping"])
def test_an_output_that_says_which_state_something_is_in_is_refused(name):
    with pytest.raises(SimulationError, match=f"{name} jumps"):
        of(STICKS).linearise(["winch.torque"], [name])


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_response_that_is_no_finite_number_is_refused_in_words():
    plant, _ = plant_of(of(STICKS), ["winch.torque"], ["winch.tension"])
    with pytest.raises(SimulationError, match=r"at 1e\+308 Hz is no finite number"):
        plant.response(1e308)
