"""The largest side force per length, against the soft string's closed form in a build of constant curvature.

A string without friction that hangs in a vertical hole, a build of radius R to the inclination a and a tangent of
length L has the tension w (L cos a + R (sin a - sin b)) at the inclination b of the build, with its buoyed weight w per
length. It presses on the upper side of the hole with T / R - w sin b, most where the build begins. Measured errors of
the mean over the first 10 m at 30, 60, 120, 240 lumps: -21, -6.8, -3.4, -2.1 %; of nodes of the beam: -13, -6.8, -3.8,
-1.2 %. The curvature begins in the middle of an element: that is first order.
"""

import math

import numpy as np
import pytest
from of_the_suite import studies

import tautline
from drillstring.results.side_force import JOINT, largest_side_force
from drillstring.string.lumps import Lumps
from tautline.scene.values.systems import in_system

RADIUS, TANGENT, INCLINATION = 400.0, 500.0, math.radians(60.0)
SCENE = """
well:
  sections: [{hold: 300 m}, {build: {to: 60 deg, radius: 400 m}}, {hold: 500 m}]
  diameter: 8.5 in
  wall: {stiffness: 1.0e10, damping: 1.0e6, lumps: 60, friction: 0}
string: [{name: drill pipe, length: rest, od: 5 in, id: 4.276 in}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {kind: lumped, elements: 60, bending: none}
solver: {method: generalized-alpha, step: 5 ms, end: 5 ms}
output: {interval: 5 ms}
"""
WEIGHT = 7850.0 * 9.81 * 0.25 * math.pi * 0.0254**2 * (5.0**2 - 4.276**2)
ARC = RADIUS * (1.0 - math.cos(JOINT / RADIUS))
"""Integral of sin b over the first 10 m of the build."""
EXACT = WEIGHT * (TANGENT * math.cos(INCLINATION) / RADIUS + math.sin(INCLINATION) - 2.0 * ARC / JOINT)


def figures(kind, elements):
    changed = SCENE.replace("lumped", kind).replace("elements: 60", f"elements: {elements}")
    return tautline.simulate(tautline.read(changed)).headline


@pytest.mark.parametrize("kind", ["lumped", *studies("ale-ancf")])
def test_the_largest_side_force_per_length_converges_to_that_of_the_soft_string_and_the_force_of_a_lump_to_none(kind):
    runs = {n: figures(kind, n) for n in (30, 60, 120)}
    error = {n: run["side_force_max"]["value"] / EXACT - 1.0 for n, run in runs.items()}
    assert abs(error[60]) < 0.6 * abs(error[30]) and abs(error[120]) < 0.6 * abs(error[60]) and abs(error[120]) < 0.04
    force = {n: run["contact_force_max"]["value"] for n, run in runs.items()}
    assert force[120] == pytest.approx(0.5 * force[60], rel=0.05), "in proportion to what belongs to the lump"
    assert "of 10.2 m of string (drill pipe at 315 m)" in runs[120]["contact_force_max"]["text"]
    assert "side force per length, over 10 m (drill pipe at 3" in runs[120]["side_force_max"]["text"]
    assert runs[120]["side_force_max"]["unit"] == "N/m"
    assert in_system(EXACT, "N/m", "field") == (pytest.approx(EXACT * 0.3048 / 4.4482216), "lbf/ft")


def mesh(lengths):
    """A string of elements of given lengths."""
    lengths = np.array(lengths, float)
    depth = np.append(0.0, np.cumsum(lengths))
    halves = 0.5 * (np.append(lengths, 0.0) + np.append(0.0, lengths))
    return Lumps((), np.zeros(len(lengths), int), lengths, depth, halves[:, None])


@pytest.mark.parametrize("lengths", [[30.0] * 20, [5.0] * 120, [1.0] * 600, [7.0, 93.0, 2.0, 498.0]])
def test_a_load_that_is_even_has_its_own_size_on_any_mesh(lengths):
    lumps = mesh(lengths)
    found = largest_side_force(np.array([0.0, 0.5, 0.3])[:, None] * lumps.tributary, lumps)
    assert found.value == pytest.approx(0.5, rel=1e-12) and found.length == JOINT


@pytest.mark.parametrize("length", [5.0, 2.0, 0.5])
def test_a_force_at_a_point_is_spread_over_ten_metres_however_short_the_elements_are(length):
    lumps = mesh([length] * round(600.0 / length))
    force = np.zeros((1, len(lumps.tributary)))
    k = round(300.0 / length)
    force[0, k] = 2.0e3
    found = largest_side_force(force, lumps)
    assert found.value == pytest.approx(200.0, rel=1e-12)
    assert abs(lumps.measured_depth[found.lump] - 300.0) <= 0.5 * JOINT


def test_a_load_that_grows_has_its_mean_over_the_last_ten_metres():
    lumps = mesh([0.1] * 6000)
    lower = np.append(lumps.measured_depth[:-1] + 0.05, 600.0)
    upper = np.append(0.0, lower[:-1])
    found = largest_side_force(0.5 * (lower**2 - upper**2)[None, :], lumps)
    # within the piece of a lump it is taken as even
    assert found.value == pytest.approx(595.0, abs=0.1**2 / (8.0 * JOINT) * 1.001)


def test_a_short_string_has_a_shorter_piece_and_one_that_touches_nothing_has_no_side_force():
    lumps = mesh([0.1] * 40)
    assert largest_side_force(np.zeros((2, 41)), lumps)[:2] == (0.0, pytest.approx(0.2))
