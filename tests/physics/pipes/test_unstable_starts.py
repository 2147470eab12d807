"""Hoses with flow that begin at rest where they cannot stay are told; references are Greenhill and Gregory-Paidoussis.

A. G. Greenhill, Proc. Camb. Phil. Soc. 4, 1881: an upright clamped column buckles at q L^3 / EJ = 7.837.
"""

import math

import numpy as np
import pytest
from physics.pipes.hoses import UNIFORM, WATER, scene

from gardenhose.build import build
from gardenhose.flutter import on_the_start, stability
from gardenhose.warnings import warnings
from tautline.simulation import simulate

GREENHILL = 7.837
TRICKLE = 1.0e-4


def upright(share, start="static", speed=TRICKLE):
    """A hose whose weight is a share of what makes it buckle, with next to no flow unless a speed is given."""
    load = 9.81 * (UNIFORM["mass_per_length"] + WATER)
    hose = {"direction": [0, 0, 1], "axial_stiffness": 1e2, "bending_stiffness": load * 0.5**3 / (share * GREENHILL)}
    return scene(
        hose,
        {"speed": speed},
        {"end": 0.05, "step": 2e-4},
        start=start,
        gravity=[0, 0, -9.81],
        disturbance=[0.1, 0, 0],
    )


@pytest.mark.parametrize(("share", "unstable"), [(0.97, False), (1.03, True)])
def test_an_upright_hose_with_flow_that_begins_at_rest_is_told_to_fall_from_greenhills_weight_on(share, unstable):
    assert bool(on_the_start(upright(share), TRICKLE)) == unstable


@pytest.mark.parametrize(("share", "falls"), [(0.97, False), (1.03, True)])
def test_an_upright_hose_without_flow_begins_in_the_shape_it_falls_to_from_greenhills_weight_on(share, falls):
    start = simulate(build(upright(share, speed=0.0))).attributes["start"]
    assert start["stable"] and (start["moved"] > 0.05) == falls


def test_check_does_not_judge_an_upright_hose_by_its_weight_alone_for_flow_holds_it_up():
    """It was said to fall. By Galerkin one of weight 8 EJ / L^2 stands from u = 0.9 at most, and flutters at 5.01."""
    hose = {"length": 1.0, "elements": 8, "axial_stiffness": 1e6, "bending_stiffness": 1.0, "damping": 0.0,
            "mass_per_length": 0.8, "direction": [0, 0, 1]}  # fmt: skip
    water = {"mass_per_length": 0.2, "speed": 2.0 / 0.2**0.5}
    made = scene(hose, water, gravity=[0, 0, -8.0], start="static", disturbance=[0.01, 0, 0])
    begins = on_the_start(made, water["speed"])
    assert not begins and not [one for one in warnings(made) if "fall" in one.text or "balance" in one.text]


def test_the_run_of_a_hose_that_falls_from_its_start_says_so():
    result = simulate(build(upright(2.0)))
    assert any("starts from an unstable equilibrium" in text for text in result.attributes["warnings"])


def test_a_hose_that_begins_as_drawn_or_relaxed_is_not_said_to_begin_at_rest():
    assert not build(upright(2.0, "straight")).remarks(None) and not build(upright(2.0, "relaxed")).remarks(None)


@pytest.mark.parametrize("start", ["static", "relaxed"])
def test_a_straight_pipe_that_the_flow_bends_is_not_said_to_stay_straight_where_it_begins_at_rest(start):
    """Clamped at both ends beyond u = 2 pi: EA (pi a / 2 L)^2 = M U^2 - (2 pi)^2 EJ / L^2 gives its sag a."""
    made = scene(
        {"length": 1.0, "elements": 8, "axial_stiffness": 1e6, "bending_stiffness": 1.0, "damping": 0.0,
         "mass_per_length": 0.5, "root_support": "clamped", "end": "clamped"},
        {"mass_per_length": 0.5, "speed": 10.0}, gravity=[0, 0, 0], start=start,
    )  # fmt: skip
    exact = 2.0 / math.pi * math.sqrt((0.5 * 10.0**2 - 4.0 * math.pi**2) / 1e6)
    model = made.replace({"solver.end": 0.01, "output.interval": 0.01, "solver.step": 1e-3})
    first = np.asarray(simulate(build(model))["position"])[0]
    assert np.hypot(first[:, 1], first[:, 2]).max() == pytest.approx(exact, rel=0.01)
    (text,) = (one.text for one in warnings(made) if one.where == "gravity")
    assert f"`start: {start}` begins in a bent shape where the straight one does not stand" in text
    drawn = made.replace({"start": "straight"})
    assert any("Nothing starts it moving sideways" in one.text for one in warnings(drawn)) and "Nothing" not in text


def test_a_pipe_that_flutters_about_its_shape_at_rest_is_not_said_to_leave_it():
    # Gregory and Paidoussis: with beta = 0.2 a cantilever flutters from u = 5.6 on.
    speed = 7.0 / 0.2**0.5
    made = scene(
        {"length": 1.0, "elements": 8, "axial_stiffness": 1e7, "bending_stiffness": 1.0, "damping": 0.0,
         "mass_per_length": 0.8},
        {"mass_per_length": 0.2, "speed": speed}, gravity=[0, 0, 0], start="static",
    )  # fmt: skip
    assert stability(made, [speed]).unstable_at == "all" and not on_the_start(made, speed)
