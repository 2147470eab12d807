"""A plant of a string in a hole names what is about to leave or meet the wall, and nothing of what rests there."""

import re
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tautline
from drillstring.groups.sticking import edge_of_the_wall
from tautline.live.plant.edges import is_near

DATA = Path(__file__).parents[2] / "data"
MASS, STIFFNESS, CLEARANCE, SMALL = 1000.0, 1.0e9, 0.05, 1.0e-5
WEIGHT = 9.81 * MASS
SLANT = float(np.sin(np.radians(3.0)))


def named(force, rate=0.0, down=SLANT):
    """Whether a lump is named that is pressed in by a force, N, or is clear by as much as its negative would press."""
    spring = SimpleNamespace(stiffness=STIFFNESS, damping=0.0, clearance=CLEARANCE)
    edge = edge_of_the_wall(0, spring, CLEARANCE + force / STIFFNESS, rate, down)
    return is_near(edge, lambda places: MASS, SMALL)


@pytest.mark.parametrize("share", [1.0e-4, 0.05, 1.0])
def test_a_lump_that_lies_still_on_the_wall_is_not_named_however_light(share):
    assert not named(share * SLANT * WEIGHT)


def test_a_lump_that_moves_across_the_hole_is_judged_by_its_weight_across_the_hole():
    assert named(0.05 * SLANT * WEIGHT, rate=-1.0e-3)
    assert not named(0.5 * SLANT * WEIGHT, rate=-1.0e-3)


@pytest.mark.parametrize(("rate", "down", "told"), [
    (0.0, SLANT, True), (0.0, -SLANT, False), (0.0, 1.0e-17, False), (1.0e-3, 0.0, True), (-1.0e-3, 0.0, False),
])  # fmt: skip
def test_a_lump_clear_of_the_wall_is_named_where_its_weight_or_its_motion_brings_it_there(rate, down, told):
    assert named(-1.0e-6 * STIFFNESS, rate, down) == told


def plant_of(sim):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return sim.linearise([], [])


def lying(model):
    """A string at rest in a hole of 3 deg, of which many contacts are light."""
    hole = [{"hold": "100 m"}, {"build": {"radius": "1000 m", "to": "3 deg", "azimuth": "0 deg"}}, {"hold": "2800 m"}]
    return tautline.Simulation(tautline.read(DATA / "tripping.yaml").replace({"well.sections": hole, "model": model}))


def test_a_string_at_rest_in_a_hole_that_leans_a_little_is_at_no_edge():
    assert plant_of(lying({"kind": "lumped", "elements": 40})).near == ()


def test_points_of_a_beam_that_stick_are_named_each_by_its_own_depth():
    sim = tautline.Simulation(
        tautline.read(DATA / "jwell.yaml").replace({"model": {"kind": "ale-ancf", "elements": 12}})
    )
    sim.advance(0.02)
    stuck = [one for one in plant_of(sim).stuck if "on the wall" in one]
    depths = [float(re.match(r"the string at ([\d.]+) m of the hole: ", one)[1]) for one in stuck]
    assert len(depths) > 5 and (np.diff(depths) > 1.0).all()
