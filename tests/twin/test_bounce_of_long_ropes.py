"""How fast a load on a rope of kilometres bounces, before a row has shown it."""

import numpy as np
import pytest

from tautline.twin.twin import Twin

MASS, LENGTH, PER_LENGTH = 250e3, 3059.0, 33.0
DEEP = """
rope: {mass_per_length: 33, axial_stiffness: STIFFNESS, bending_stiffness: 0, damping: 0.01, diameter: 77 mm}
bodies:
  - {name: template, mass: 250 t, position: [60, 0, -2975]}
path:
  - drum:   {name: winch, center: [0, 0, 0], radius: 1.2, axis: [0, 1, 0], wrap: over,
             pay_out: {table: {time: [0, 10, 60, 70], value: [0, 0.5, 0.5, 0]}}}
  - sheave: {name: tip, center: [59.2, 0, 25], radius: 0.8, axis: [0, 1, 0], wrap: over, inertia: 300, law: no_slip}
  - end:    {name: hook, body: template}
mesh: {elements_per_span: 3}
gravity: [0, 0, -9.81]
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 20 ms, end: 80 s}
output: {interval: 200 ms}
"""
MAP = """
sensors:
  - {column: winch, unit: m, input: winch.pay_out}
  - {column: tension, unit: kN, output: winch.tension, sd: 5 kN}
estimate:
  - {parameter: template.mass, start: 250 t, sd: 20 t, range: [50 t, 400 t]}
"""


def bounce(stiffness):
    return Twin(DEEP.replace("STIFFNESS", f"{stiffness:.1e}"), MAP).estimate.bounce()


@pytest.mark.parametrize("stiffness", [3e8, 1e8])
def test_a_load_on_three_kilometres_of_rope_bounces_as_its_mass_and_a_third_of_the_ropes_do_on_a_spring(stiffness):
    moved = MASS + PER_LENGTH * LENGTH / 3.0
    # The ripple before the wave has come was counted: 3.0 s.
    assert bounce(stiffness) == pytest.approx(2.0 * np.pi * (moved * LENGTH / stiffness) ** 0.5, rel=0.05)


def test_a_load_that_does_not_turn_within_half_a_minute_has_no_bounce_to_wait_for():
    assert bounce(5e6) == 0.0
