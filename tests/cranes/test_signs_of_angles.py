"""Signs of the angles that a rope makes with its wheels are those that docs/crane.md tells."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, drum, end, ran, sheave

from crane.results.angles import leads, out_of_plane

DOWN = (0.0, 0.0, -9.81)


@pytest.mark.parametrize(("side", "towards"), [(1.0, -1.0), (-1.0, 1.0)])
def test_offlead_is_positive_towards_axis_times_gravity_and_sidelead_along_the_axis(side, towards):
    axis = np.array([[0.0, side, 0.0]])
    offlead, sidelead = leads(np.array([[0.1 * towards, 0.0, -1.0]]), axis, DOWN)
    assert offlead == pytest.approx(np.arctan(0.1)) and sidelead == pytest.approx(0.0)
    offlead, sidelead = leads(np.array([[0.0, 0.1, -1.0]]), axis, DOWN)
    assert offlead == pytest.approx(0.0) and sidelead == pytest.approx(side * np.arctan(0.1))
    assert np.cross(axis[0], DOWN)[0] * towards > 0.0


def test_a_fleet_angle_is_positive_where_the_rope_goes_the_way_of_the_axis():
    along = np.array([np.cos(0.1), np.sin(0.1), 0.0])
    assert out_of_plane(along, np.array([0.0, 1.0, 0.0])) == pytest.approx(0.1)
    assert out_of_plane(along, np.array([0.0, -1.0, 0.0])) == pytest.approx(-0.1)


STILL = {"mesh": {"elements_per_span": 1}, "solver": {"end": 0.05}}
LIGHT = {"mass_per_length": 0.01}
WIND = 0.1
"""Force of wind on a load over its weight."""


def slung(force):
    """A load in a sling over a locked hook, whose legs are 13 deg from plumb."""
    load = body("load", 2000.0, (0.0, 0.0, 0.0), inertia=[900.0, 1700.0, 1500.0], force=[force, 0.0, 0.0])
    hook = sheave((0.0, 0.0, 6.0), 0.2, name="hook", law="capstan", friction=0.5, locked=True)
    legs = [end("load", name=name, offset=(side, 0.0, 0.5)) for name, side in (("left", -1.5), ("right", 1.5))]
    return crane([legs[0], hook, legs[1]], [load], LIGHT, **STILL)


def block(force):
    """A block on two falls that spread by 23 deg."""
    held = body("block", 2000.0, (1.2, 0.0, 0.0), force=[force, 0.0, 0.0])
    path = [drum((-10.0, 0.0, 10.0)), sheave((0.0, 0.0, 10.0)), sheave(name="block sheave", wrap="under", body="block"),
            anchor((4.0, 0.0, 10.0))]  # fmt: skip
    return crane(path, [held], LIGHT, **STILL)


@pytest.mark.parametrize("scene", [slung, block])
def test_a_load_on_two_legs_that_hangs_plumb_has_no_offlead(scene):
    assert np.abs(ran(scene(0.0))["offlead"]).max() < 1.0e-4


def test_a_block_in_wind_has_the_offlead_of_its_weight_and_the_wind_together():
    """Towards +x, which with this axis is negative."""
    offlead = ran(block(WIND * 2000.0 * GRAVITY))["offlead"]
    assert offlead == pytest.approx(np.full(offlead.size, -np.arctan(WIND)), abs=1.0e-4)
