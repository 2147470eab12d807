"""A load that is too light lets the rope run back over its wheel: by the least tension of a catenary."""

from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import tautline
from crane.warnings import warnings
from crane.warnings.overhauling import least_tension

DATA = Path(__file__).parents[2] / "data"
HOIST = tautline.read(DATA / "hoist.yaml")


def _warned(scene):
    return [one.text for one in warnings(scene) if "too light" in one.text]


def test_the_least_tension_of_a_level_span_is_that_of_its_closed_form():
    """d/du (cosh u / u) = 0 is u tanh u = 1, with u half the span over a: T = w L cosh(u)/(2 u), 0.7544 w L."""
    u = brentq(lambda u: u * np.tanh(u) - 1.0, 1.0, 2.0)
    assert least_tension(40.0, 0.0, 65.0) == pytest.approx(65.0 * 40.0 * np.cosh(u) / (2.0 * u), rel=1e-6)


def test_a_span_that_hangs_plumb_needs_its_own_weight_at_its_upper_end_and_one_that_is_nearly_plumb_little_more():
    assert least_tension(0.0, 30.0, 65.0) == 65.0 * 30.0
    assert 1.0 < least_tension(1e-3, 30.0, 65.0) / (65.0 * 30.0) < 1.001


@pytest.mark.parametrize("mass, light", [("0 kg", True), ("50 kg", True), ("80 kg", False), ("5 t", False)])
def test_a_load_below_what_overhauls_the_rope_is_warned_of_with_the_mass_that_does(mass, light):
    """Rope of 12 m across and 30 m up needs 2161 N on top by the catenary, of which 1604 N hang there: 57 kg."""
    told = _warned(HOIST.replace({"bodies[0].mass": mass}))
    assert len(told) == light
    assert not told or "It needs 67.9 kg at least" in told[0]


@pytest.mark.parametrize("mass, found", [("50 kg", False), ("80 kg", True)])
def test_the_static_start_finds_rest_above_that_mass_and_none_below(mass, found):
    scene = HOIST.replace({"bodies[0].mass": mass, "output.interval": "10 ms"})
    if found:
        assert tautline.simulate(scene, end="10 ms", verify=False).attributes["status"] == "done"
        return
    with pytest.raises(tautline.StoppedEarly, match="no static equilibrium"):
        tautline.simulate(scene, end="10 ms", verify=False)


def test_a_light_load_deep_below_is_not_warned_of():
    """The rope that hangs with the load pulls, too: 3 km weigh forty times as much as the load."""
    deep = HOIST.replace({"bodies[0].position": [12.4, 0, -3000], "bodies[0].mass": "500 kg"})
    assert not _warned(deep)


def test_the_words_name_the_wheel_that_the_load_hangs_beyond_and_not_the_winch():
    """A winch above its sheave: nothing hangs on the other side of it."""
    text = HOIST.replace({"path[0].drum.center": [-60, 0, 35], "bodies[0].mass": "20 kg"})
    (told,) = _warned(text)
    assert "what hangs beyond boom tip:" in told and "`start: static` finds no rest" in told
    (drawn,) = _warned(text.replace({"start": "as drawn"}))
    assert "static" not in drawn
