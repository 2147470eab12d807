"""Lumps that are pushed beyond buckling are braced: they have an equilibrium with any number of links, soon.

Seen on the J-well with 200 kN on the bit, friction 0.3, lowered: 149.01, 147.68, 148.77 and 147.88 kN with 50, 75, 100
and 300 links. Without braces 50 had none, 75 and 100 had 147.68 and 148.74 kN, and 300 ran for minutes.
"""

import numpy as np
import pytest
from physics.wells.strings import shipped

from drillstring.scene.scene import BEAM, LUMPED
from drillstring.statics import statics
from drillstring.statics.statics import Statics
from drillstring.statics.torque_drag import own_depth, torque_drag
from tautline.integrators.statics.equilibrium import TOO_FAR
from tautline.integrators.status import Status, StoppedEarly

SEEN = {50: 149.01e3, 75: 147.68e3, 100: 148.77e3, 300: 147.88e3}


def jwell(elements, push=-200e3):
    scene = shipped("jwell", model__bending="soft", bit={"force": push})
    return Statics(scene, own_depth(scene), elements)


@pytest.mark.parametrize("elements", [50, 100, 300])
def test_a_string_that_is_pushed_into_a_helix_has_an_equilibrium_with_any_number_of_links(elements):
    found = jwell(elements).solve(0.3, "slack_off")
    assert found.hook_load == pytest.approx(SEEN[elements], rel=1e-3)
    assert np.isfinite(found.side_force).all()


def test_braces_do_not_change_the_hook_load_that_lumps_had_without_them():
    # 147 675.1 N with 75 links and 148 740.8 N with 100, both found without braces
    for elements, alone in ((75, 147675.1), (100, 148740.8)):
        assert jwell(elements).solve(0.3, "slack_off").hook_load == pytest.approx(alone, rel=3e-4)


def test_a_string_that_is_not_pushed_beyond_its_limit_has_no_braces():
    one = jwell(50, 0.0)
    one.solve(0.3, "slack_off")
    assert one.string.braces is None


def test_a_short_vertical_string_that_is_pushed_below_buckling_balances_on_the_axis_as_the_soft_string_does():
    # Begun a millimetre off the axis it did not come into balance in 2000 iterations: nearly nothing resists there.
    scene = shipped("whirl")
    (case,) = torque_drag(scene, [0.2])
    for way in ("pick_up", "slack_off", "rotating"):
        assert case.hook_loads(way) == pytest.approx(case.soft_hook_loads(way), rel=1e-4)


@pytest.mark.parametrize("elements", [18, 100])
@pytest.mark.parametrize("push", [45e3, 55e3, 60e3, 80e3, 100e3])
def test_a_vertical_string_with_tight_stabilisers_that_is_pushed_beyond_buckling_hangs_by_its_weight_less_the_push(
    push, elements
):
    # The stabilisers have a clearance of 0.127 mm. Begun a millimetre off the axis, which is beyond the wall there, or
    # a tenth of that, rotating had no equilibrium from 55 kN on with 50 or 100 links, and at 100 kN with 18.
    scene = shipped("whirl", bit={"lateral": "pinned", "force": -push})
    steel = np.pi / 4.0 * ((6.5 * 0.0254) ** 2 - (2.8125 * 0.0254) ** 2)
    weight = steel * 23.0 * (7850.0 - 1200.0) * 9.81
    one = Statics(scene, own_depth(scene), elements)
    for way in ("rotating", "slack_off", "pick_up"):
        assert one.solve(0.2, way).hook_load == pytest.approx(weight - push, abs=0.1)


@pytest.mark.parametrize(
    ("kind", "cure"),
    [(LUMPED, "take fewer elements (--elements), or less force on the bit"), (BEAM, "take less force on the bit")],
)
def test_where_no_balance_is_found_the_cure_is_one_that_torque_and_drag_can_follow(kind, cure, monkeypatch):
    # as of collars of 1000 links of 3 m that are pushed by 100 kN in a vertical hole, which take a minute to fail
    def fails(*_):
        raise StoppedEarly(Status.NO_EQUILIBRIUM, 0.0, "lump 986", f"0.1 % is out of balance; {TOO_FAR}")

    monkeypatch.setattr(statics, "find_equilibrium", fails)
    scene = shipped("jwell", model__kind=kind, bit={"force": -200e3})
    (case,) = torque_drag(scene, [0.3], elements=20, kinds=[kind])
    assert len(case.failures) == 3
    for text in case.failures:
        assert cure in text and "closer to those at rest" not in text
