"""A plant of what only just touches, or is about to, says so: a small motion the other way finds another stiffness."""

import warnings

import numpy as np
import pytest

import tautline
from tautline.elements.slackening import edges_of_slack
from tautline.elements.tension import TENSION
from tautline.kernels.hermite import lobatto, table

MASS, LEVEL, EA, MATERIAL, G = 2000.0, -9.0, 4.0e7, 2.2, 9.81
SCENE = """
title: A load at the ground
rope: {mass_per_length: 2.2, axial_stiffness: 4.0e7, damping: 2.0e-3, diameter: 22 mm, breaking_load: 0.4 MN,
       compression: none}
bodies: [{name: payload, mass: 2 t, position: [8.0, 0, -9.0]}]
path:
  - drum:   {name: winch, center: [0.5, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [7.8, 0, 6], radius: 0.2, axis: [0, 1, 0], wrap: over, law: no_slip}
  - end:    {name: hook, body: payload}
mesh: {elements_per_span: 2}
ground: {level: BELOW, stiffness: STIFF, damping: 0}
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 1 ms, end: 12 s}
output: {interval: 50 ms}
"""


def near(level=-20.0, stiffness=1.0e7, up=0.0):
    """What a plant says to be near, and what is warned of, behind a displacement up, m."""
    sim = tautline.Simulation(SCENE.replace("BELOW", str(level)).replace("STIFF", str(stiffness)), keep=False)
    if up:
        sim.displace("payload.position", [0.0, 0.0, up])
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        plant = sim.linearise([], ["payload.position"])
    return plant, [str(one.message) for one in said]


def test_a_load_that_hangs_a_micrometre_above_the_ground_is_told_with_the_stiffness_below_it():
    plant, (said,) = near(LEVEL, up=1.0e-6)
    (told,) = plant.near
    assert told in said and told.startswith("payload is clear of the ground by 1e-06 m")
    assert "has it free" in told and "1e+07 N/m" in told


def test_a_load_that_the_ground_carries_by_a_thousandth_is_told_to_be_held():
    plant, (said,) = near(LEVEL, up=-2.0e-6)
    (told,) = plant.near
    assert told in said and told.startswith("payload is pressed into the ground by 2e-06 m, with 20 N")
    assert "has it held with 1e+07 N/m" in told


@pytest.mark.parametrize(
    ("level", "stiffness", "up"), [(LEVEL, 1.0e10, -2.0e-6), (LEVEL - 0.1, 1.0e7, 0.0), (LEVEL + 0.0, 1.0e7, 1.0e-3)]
)
def test_a_load_that_rests_on_stiff_ground_or_is_far_from_it_is_not_warned_of(level, stiffness, up):
    plant, said = near(level, stiffness, up)
    assert plant.near == () and not said


@pytest.mark.parametrize(("beyond", "word"), [(5.0e-6, "is slack by"), (-5.0e-6, "is stretched by")])
def test_a_rope_that_is_a_few_micrometres_from_slack_is_told(beyond, word):
    """The last element of a rope that hangs: N = EA eps lambda in its middle carries the load and half of its own."""
    length = 15.0 / 2.0
    pull = (MASS + 0.5 * MATERIAL * length) * G
    strain = pull / EA
    plant, (said,) = near(up=strain * (1.0 - 2.5 * strain) * length + beyond)
    (told,) = plant.near
    assert word in told and told in said
    assert float(told.partition(word)[2].split()[0]) == pytest.approx(5.0e-6, abs=1.0e-6)


@pytest.mark.parametrize("engineering", [0, 1])
def test_cubic_elements_are_as_far_from_slack_as_their_chord_is_longer_than_their_material(engineering):
    rows = np.recarray(2, TENSION)
    rows.a, rows.b, rows.stiffness, rows.damping, rows.engineering = 0, 7, 1.0e6, 0.0, engineering
    rows.slack = [1, 0]
    strain, length = 1.0e-6, 2.0
    slope = 1.0 + strain
    q = np.array([0.0, 0, 0, slope, 0, 0, 1.0, length * slope, 0, 0, slope, 0, 0, 1.0 + length])
    (one,) = edges_of_slack(rows, table(*lobatto()), 6, q)
    assert one.acts and one.gap == pytest.approx(strain * length, rel=1e-5) and one.stiffness == 1.0e6 / length
    (straight,) = edges_of_slack(rows, np.zeros((0, 0)), 6, q)
    assert straight.gap == pytest.approx(one.gap, rel=1e-6)
