"""A string that is pushed and buckles into a helix: its wall force, the drag that makes, and lock-up.

R. F. Mitchell, "Simple frictional analysis of helical buckling of tubing", SPE Drilling Engineering 1(6), 1986: with
the wall force r F^2/(4 EI) the compression F obeys, up the hole from the bit in a string that is pushed down,

    dF/ds = mu r F^2/(4 EI) - w cos i.

In a level hole F = F0/(1 - k F0 s) with k = mu r/(4 EI), endless at s = 1/(k F0); in a vertical one, with
A = sqrt(w/k), F = A (F0 - A tanh(k A s))/(A - F0 tanh(k A s)). Measured: the soft string is the closed form to 1e-8,
the statics of the lumped model within 6e-3 (30 links) and 3e-3 (100) in the level and 2e-4 (100) in the vertical hole.
"""

import numpy as np
import pytest
from physics.wells.strings import COLLAR, GRAVITY, E, mass_per_length, shipped, straight_hole

from drillstring.statics import enough_links
from drillstring.statics.helix import LockedUp, helix_force
from drillstring.statics.soft_string import soft_string
from drillstring.statics.statics import Statics
from drillstring.statics.torque_drag import torque_drag
from drillstring.view.torque_summary import sentences

DIAMETER, FRICTION = 0.3, 0.3
CLEARANCE = (DIAMETER - COLLAR[0]) / 2.0
RIGIDITY = E * np.pi / 64.0 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
W = mass_per_length() * GRAVITY
K = FRICTION * CLEARANCE / (4.0 * RIGIDITY)


def pushed(inclination, force, length, elements):
    """Statics of a straight hole with a force up the string at the bit."""
    scene = straight_hole(
        inclination, length=length, elements=elements, diameter=DIAMETER, friction=FRICTION, bit={"force": -force}
    )
    return Statics(scene, length, elements)


def soft(statics, force, motion="slack_off"):
    return soft_string(statics.well, statics.tubes, statics.weight, FRICTION, motion, -force, DIAMETER)


def level(force, length):
    """Compression at the top of a level hole."""
    return force / (1.0 - K * force * length)


def vertical(force, length):
    a = np.sqrt(W / K)
    t = np.tanh(K * a * length)
    return a * (force - a * t) / (a - force * t)


def test_helix_presses_twice_as_hard_at_its_limit_as_the_string_that_lies_in_the_hole():
    limit = pushed(0.5 * np.pi, 1e6, 100.0, 10).limits.helical[0]
    assert helix_force(limit, CLEARANCE, RIGIDITY) == pytest.approx(2.0 * W, rel=1e-9)


@pytest.mark.parametrize(
    ("inclination", "force", "length", "exact"),
    [(0.5 * np.pi, 1.2e6, 300.0, level(1.2e6, 300.0)), (0.0, 5e5, 200.0, vertical(5e5, 200.0))],
    ids=["level", "vertical"],
)
def test_force_that_pushes_a_helix_is_that_of_mitchells_closed_form(inclination, force, length, exact):
    statics = pushed(inclination, force, length, 100)
    assert -soft(statics, force).hook_load == pytest.approx(exact, rel=1e-7)
    found = statics.solve(FRICTION, "slack_off")
    assert -found.hook_load == pytest.approx(exact, rel=5e-3)
    # and not that of a string that only lies in the hole
    assert abs(force + (FRICTION * np.sin(inclination) - np.cos(inclination)) * W * length - exact) > 5e-3 * exact
    middle = helix_force(-found.tension[50], CLEARANCE, RIGIDITY)
    assert found.side_force[50] == pytest.approx(middle, rel=2e-2)


def test_links_that_nobody_gave_are_doubled_until_the_push_of_a_helix_is_that_of_the_closed_form(monkeypatch):
    monkeypatch.setattr(enough_links, "ELEMENTS", 20)
    force = 1.2e6
    length = 0.9 / (K * force)
    scene = straight_hole(
        0.5 * np.pi, length=length, elements=20, diameter=DIAMETER, friction=FRICTION, bit={"force": -force}
    )
    (few,), (own,) = torque_drag(scene, elements=100), torque_drag(scene)
    exact = level(force, length)
    off = [abs(-case.points[0].hook_load("slack_off") / exact - 1.0) for case in (few, own)]
    assert off[0] > 0.03 and off[1] < 0.015
    assert own.doubling.settles("slack_off") and own.doubling.links == own.points[0].link_depth.size > 100
    said = [text for text, _ in sentences([few], None)]
    # The soft string is the closed form here: nobody may be told to go by the links.
    assert any("slacking off is" in text and "more links may change it" in text for text in said)
    assert not any(text.endswith("go by its numbers") and "at most" in text for text in said)


def test_force_that_pulls_a_helix_is_less_by_its_friction():
    # picked up, friction takes compression off on the way up: F = F0/(1 + k F0 s) in a level hole while it is a helix
    force, length = 2.5e6, 300.0
    statics = pushed(0.5 * np.pi, force, length, 100)
    assert -soft(statics, force, "pick_up").hook_load == pytest.approx(force / (1.0 + K * force * length), rel=1e-7)


def test_string_in_a_level_hole_locks_up_at_the_distance_of_the_closed_form():
    force = 1.6e6
    endless = 1.0 / (K * force)
    short = pushed(0.5 * np.pi, force, 0.7 * endless, 100)
    assert -soft(short, force).hook_load == pytest.approx(level(force, 0.7 * endless), rel=1e-6)
    long = pushed(0.5 * np.pi, force, 1.5 * endless, 100)
    locked = soft(long, force).locked
    # at half a per cent of strain, which is a little below where the force is endless
    distance = (1.0 / force - 1.0 / (5e-3 * E * np.pi / 4.0 * (COLLAR[0] ** 2 - COLLAR[1] ** 2))) / K
    assert 1.5 * endless - locked == pytest.approx(distance, abs=6.0)
    with pytest.raises(LockedUp):
        long.solve(FRICTION, "slack_off")


def test_more_friction_takes_a_pushed_string_from_a_lying_one_to_a_helix_to_lock_up():
    scene = shipped("jwell", model__bending="soft", bit={"force": -200e3})
    cases = [*torque_drag(scene, [0.0], elements=12), *torque_drag(scene, [0.3, 0.4], elements=75)]
    points = [case.points[0] for case in cases]
    assert points[1].buckled("slack_off", "helical") and not points[1].locked
    assert points[2].locked and set(points[2].locks) == {"slack_off"} and np.isnan(points[2].hook_load("slack_off"))
    assert [point.failures for point in points] == [{}, {}, {}]
    ours, beside = points[1].hook_load("slack_off"), points[1].soft["slack_off"].hook_load
    assert ours == pytest.approx(beside, rel=3e-2)
    lying = soft_string(
        *(getattr(Statics(scene, points[1].depth, 50), name) for name in ("well", "tubes", "weight")),
        0.3, "slack_off", -200e3,
    )  # fmt: skip
    assert ours < lying.hook_load - 1e4, "the helix costs weight on the hook"


def test_string_that_does_not_buckle_has_no_part_of_it():
    statics = Statics(shipped("jwell"), 3770.0, 50)
    for motion in ("pick_up", "slack_off", "rotating"):
        with_hole = soft_string(statics.well, statics.tubes, statics.weight, 0.2, motion, 0.0, 0.2032)
        without = soft_string(statics.well, statics.tubes, statics.weight, 0.2, motion)
        assert with_hole.hook_load == without.hook_load and with_hole.locked is None
        statics.solve(0.2, motion)
        assert not statics.string.loads.value.any()
