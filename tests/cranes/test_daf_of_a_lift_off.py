"""A load that is lifted off the ground is amplified over what it hangs with, not over the slack rope it began with."""

from __future__ import annotations

import math

import pytest

import tautline

MASS, GRAVITY, STIFFNESS, SPEED = 5000.0, 9.81, 4.0e6, 0.2
WEIGHT = MASS * GRAVITY
DROP = 10.0
"""From the sheave to the load, m; as far again to the drum."""
LENGTH = 10.0 + 0.1 * math.pi + DROP
"""Of the rope as drawn: level from the drum, over the sheave by a quarter turn, and plumb down."""
SCENE = f"""
title: Lift off
rope: {{{{mass_per_length: 0.01, axial_stiffness: {STIFFNESS}, damping: 0, length: {{length}}, breaking_load: 400 kN}}}}
bodies:
  - {{{{name: load, mass: {MASS}, position: [10.2, 0, 1], bottom: 1 m}}}}
path:
  - drum: {{{{name: winch, center: [0, 0, 11], radius: 0.2, axis: [0, 1, 0], wrap: over,
             pay_out: {{{{ramp: {{{{to: -{SPEED}, over: 0.1 s}}}}}}}}}}}}
  - sheave: {{{{name: tip, center: [10, 0, 11], radius: 0.2, axis: [0, 1, 0], wrap: over}}}}
  - end: {{{{name: hook, body: load}}}}
mesh: {{{{elements_per_span: 1}}}}
ground: {{{{level: {{level}}, stiffness: 1.0e9, damping: 1.0e6}}}}
solver: {{{{step: 2 ms, end: 4 s}}}}
output: {{{{interval: 2 ms}}}}
"""


def run(share, level=0.0, more=""):
    """A run that begins with a share of the load's weight in the rope."""
    length = LENGTH / (1.0 + share * WEIGHT / STIFFNESS)
    return tautline.simulate(tautline.read(SCENE.format(length=f"{length:.9f}", level=level) + more))


def daf(result):
    return result.headline["dynamic_amplification"]


@pytest.mark.parametrize("share", [0.01, 0.3, 0.8])
def test_the_daf_of_a_lift_off_is_that_of_its_closed_form_whatever_the_rope_began_with(share):
    result = run(share)
    # The load leaves the ground when the rope bears it, at rest, and the rope comes in with v: T = W + v sqrt(k m).
    stiffness = STIFFNESS / LENGTH
    expected = 1.0 + SPEED * math.sqrt(stiffness * MASS) / WEIGHT
    found = daf(result)
    assert found["value"] == pytest.approx(expected, rel=0.02)
    assert "over the load hanging free, estimated" in found["text"]
    first = float(result["tension"][0].max())
    assert first == pytest.approx(share * WEIGHT, rel=0.05, abs=0.005 * WEIGHT)


def test_a_limit_on_the_daf_of_a_lift_off_is_judged_by_it():
    result = run(0.01, more="limits: [{output: dynamic_amplification, at_most: 1.5}]\n")
    (one,) = (record for record in result.limits if record.get("output") == "dynamic_amplification")
    assert one["passed"] is True and one["value"] == pytest.approx(daf(result)["value"])


def test_a_load_that_hangs_above_the_ground_keeps_the_tension_of_the_first_frame():
    result = run(1.0, level=-3.0)
    found = daf(result)
    assert "hanging free" not in found["text"]
    assert found["value"] == pytest.approx(float(result["tension"].max() / result["tension"][0].max()), rel=0.01)


def test_rope_that_hardly_carries_its_load_at_the_start_is_known_without_the_bodies_places():
    from crane.results.summary import headline

    result = run(0.01)

    class Without(dict):
        time, attributes = result.time, result.attributes

    part = Without({name: result[name] for name in ("tension", "position")})
    scene = tautline.read(SCENE.format(length=f"{LENGTH / (1.0 + 0.01 * WEIGHT / STIFFNESS):.9f}", level=0.0))
    found = headline(part, scene, names=["dynamic_amplification"])["dynamic_amplification"]
    assert found["value"] == pytest.approx(daf(result)["value"])
