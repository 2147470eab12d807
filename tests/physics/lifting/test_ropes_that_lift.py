"""A rope that runs too fast for its tension would leave its sheave, and a run says so.

Reference: a heavy rope of length L that falls over a frictionless sheave, both ends free. With x half the difference of
its falls x = x0 cosh(sqrt(2 g / L) t) and, by d'Alembert, the tension at the sheave is 2 rho g (L^2/4 - x^2) / L. It is
rho x.^2, with x.^2 = 2 g (x^2 - x0^2) / L, where x^2 = (L^2/4 + x0^2) / 2.
"""

import re

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, body, crane, end, hoist, ran, sheave, solved

RADIUS, FALLS = 0.4, (20.0, 40.0)
LENGTH = sum(FALLS) + np.pi * RADIUS


def falling(mass=0.01, falls=FALLS, time=3.0, **more):
    """A rope over a sheave, with a body at each end."""
    ends = [end("a", "one"), end("b", "other")]
    bodies = [
        body(name, mass, (x, 0.0, -fall), guide=["x", "y"])
        for name, x, fall in zip("ab", (-RADIUS, RADIUS), falls, strict=True)
    ]
    rope = {"mass_per_length": 10.0, "axial_stiffness": 1.0e8, "damping": 1.0e-4}
    path = [ends[0], sheave((0.0, 0.0, 0.0), RADIUS, law="frictionless"), ends[1]]
    scene = crane(path, bodies, rope, mesh={"elements_per_span": 8}, start="as drawn", interval=0.01, **more)
    return solved(scene, step=2.0e-3, end=time)


def said(result):
    return [text for text in result.warnings if "too fast to stay on" in text]


def test_a_rope_that_falls_over_a_sheave_is_told_to_lift_off_when_its_closed_form_does():
    (text,) = said(ran(falling()))
    half = 0.5 * (FALLS[1] - FALLS[0])
    lifts = np.sqrt(0.5 * (0.25 * LENGTH**2 + half**2))
    begin = np.arccosh(lifts / half) / np.sqrt(2.0 * GRAVITY / LENGTH)
    # The wave of the start, which is let go as drawn, swings about it.
    told = float(re.search(r"first at t = (\S+) s", text).group(1))
    assert told == pytest.approx(begin, abs=0.1) and "boom tip" in text


@pytest.mark.parametrize("scene", [falling(time=2.3), falling(mass=2000.0)], ids=["before that", "with loads"])
def test_a_rope_that_its_tension_presses_on_the_sheave_is_not_told_to_lift_off(scene):
    assert said(ran(scene)) == []


def test_rope_that_is_paid_out_faster_than_its_load_falls_is_slack_and_is_not_told_to_lift_off():
    result = ran(hoist(mass=200.0, drive={"pay_out": {"ramp": {"to": 12.0, "over": 0.3}}}))
    assert result.headline["slack_events"]["value"] > 0
    assert said(result) == []
