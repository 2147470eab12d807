"""How long a beam's elements may be: what `check` tells is where side forces begin to depend on them.

There is no closed form of what a mesh does wrong: the reference are the statics of the same string on 96 elements,
which on these wells differ from those on 160 by 0.24 % at most, and from the soft string by less than 1e-3 in hook load
(test_torque_drag_beam.py).
"""

import functools
import re

import numpy as np
import pytest
from physics.wells.strings import shipped

from drillstring.model.prepared import well_of
from drillstring.scene.scene import BEAM
from drillstring.statics.statics import Statics
from drillstring.warnings import warnings

PIPE = [{"name": "drill pipe", "length": "rest", "od": 0.127, "id": 0.1086}]
WELLS = ("bend", "tripping")


def scene(well, elements):
    if well == "tripping":
        return shipped("tripping", model__kind=BEAM, model__elements=elements)
    sections = [{"hold": 500.0}, {"build": {"radius": 300.0, "to": "90 deg"}}, {"hold": 500.0}]
    return shipped("jwell", well__sections=sections, string=PIPE, model__kind=BEAM, model__elements=elements)


@functools.cache
def loads(well, elements):
    """Hook load and side force in all, picking up with friction 0.2, N."""
    given = scene(well, elements)
    statics = Statics(given, well_of(given).length, elements)
    found = statics.solve(0.2, "pick_up")
    return np.array([found.hook_load, found.side_force @ statics.string.tributary])


def told(well, elements):
    return [c.text for c in warnings(scene(well, elements)) if c.where == "model.elements"]


@pytest.mark.parametrize(("well", "elements"), [("bend", 32), ("tripping", 48)])
def test_elements_that_are_not_warned_of_are_within_1_percent_of_short_ones(well, elements):
    assert told(well, elements) == []
    assert loads(well, elements) == pytest.approx(loads(well, 96), rel=1e-2)


@pytest.mark.parametrize(("well", "elements"), [("bend", 8), ("tripping", 16)])
def test_elements_that_are_warned_of_are_off_in_side_force(well, elements):
    (text,) = told(well, elements)
    assert "side force" in text and "kind: lumped" in text
    assert abs(loads(well, elements)[1] / loads(well, 96)[1] - 1.0) > 0.02


@pytest.mark.parametrize("well", WELLS)
def test_the_cure_is_a_mesh_that_is_not_warned_of(well):
    (text,) = told(well, 6)
    wanted = int(re.search(r"take (\d+) elements", text)[1])
    assert told(well, wanted) == [] and told(well, wanted - 2) != []


def test_a_warning_of_very_long_elements_says_that_there_may_be_no_equilibrium():
    (text,) = told("bend", 3)
    assert "no equilibrium" in text


def test_a_straight_hole_and_free_space_want_no_more_elements():
    straight = shipped("drilling", model__kind=BEAM, model__elements=12)
    assert not [c for c in warnings(straight) if c.where == "model.elements"]
    free = shipped("configuration_b", model__kind=BEAM, model__elements=8)
    assert not [c for c in warnings(free) if c.where == "model.elements"]
