"""Tension, torque and contact forces that pictures and files show of a string: at its ends, where sections meet."""

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, GRAVITY, shipped, straight_hole
from test_string_appearance import PIPES, parts, ran, straight, without

from drillstring.model.build import build
from drillstring.view.appearance import VIEWS, appearance
from tautline.simulation import simulate
from tautline.view.space.appearance import Look

TRUE = Look("true", 1.0)


def at_nodes(result, name="tension", view="true", frame=-1):
    string = parts(appearance(result, Look(view, 1.0)))["string"]
    (found,) = (one for one in string.quantities if one.name == name)
    values = found.values(frame)
    assert found.low - 1e-9 <= values.min() and values.max() <= found.high + 1e-9
    return values[string.nodes]


@pytest.mark.parametrize("view", VIEWS)
def test_a_hanging_string_has_at_every_node_the_weight_of_all_below_it(view):
    # Table 2.3 of the thesis, dry: 880 m of pipe and 120 m of collar, whose links weigh four times as much.
    _, result = ran("hanging")
    area = {name: 0.25 * np.pi * (od**2 - bore**2) for name, (od, bore) in PIPES.items()}
    depth = result["unstretched_depth"]
    below = (
        np.clip(1000.0 - depth, 0.0, 120.0) * area["collar"] + np.clip(880.0 - depth, 0.0, 880.0) * area["drill pipe"]
    )
    weight = DENSITY * GRAVITY * below
    assert at_nodes(result, view=view) == pytest.approx(weight, rel=1e-6, abs=1e-6 * weight[0])


def test_a_string_in_a_hole_has_its_hook_load_at_the_top_and_nothing_at_a_free_bit_with_friction_and_in_motion():
    _, result = ran("jwell")
    for frame in (0, -1):
        found = at_nodes(result, frame=frame)
        assert found[0] == result["hook_load"][frame] and found[-1] == 0.0
        # The middle of the first element has half of its weight in the mud less, but for 0.06 % of drag.
        half = 0.5 * (result["buoyed_weight"][0] + result["buoyed_weight"][1] / 2.0)
        assert result["tension"][frame, 0] + 2.0 * half / 2.0 == pytest.approx(found[0], rel=6e-4)


@pytest.mark.parametrize(("force", "weight"), [(-20e3, None), (0.0, 15e3), (5e3, 15e3)])
def test_the_last_node_has_the_force_that_the_bit_puts_on_the_string(force, weight):
    bit = {"bit__force": force} | ({} if weight is None else {"bit__on_bottom": True, "bit__weight": weight})
    scene = straight_hole(0.0, elements=4, solver__end=0.01, start="static", **bit)
    result = simulate(build(scene))
    area = 0.25 * np.pi * (COLLAR[0] ** 2 - COLLAR[1] ** 2)
    found = at_nodes(result, frame=0)
    end = force - (weight or 0.0)
    assert found[-1] == pytest.approx(end, rel=1e-6)
    # At rest in a vertical hole: what is below, and the force of the bit.
    assert found == pytest.approx(end + DENSITY * GRAVITY * area * np.linspace(100.0, 0.0, 5), rel=1e-5, abs=1.0)


def test_torque_is_that_of_the_drive_at_the_top_and_of_the_bit_at_the_end():
    result = simulate(build(shipped("drilling", solver__end=0.3)))
    found = at_nodes(result, "torque")
    assert result["surface_torque"][-1] != 0.0
    assert found[[0, -1]].tolist() == [result["surface_torque"][-1], result["torque_on_bit"][-1]]
    assert at_nodes(result)[[0, -1]].tolist() == [result["hook_load"][-1], -result["weight_on_bit"][-1]]


def test_a_string_that_leaves_its_pins_at_an_angle_has_half_an_elements_weight_more_there():
    # The force along the hole is zero, and what pulls at the ends is across it. At rest the tension of a string that
    # hangs changes by its weight per length for every metre of height, whatever its shape.
    _, result = ran("configuration_b")
    assert abs(result["hook_load"][0]) < 1e-3
    weight, length = result["buoyed_weight"], result["link_length"]
    height, tension, found = -result["position"][0, :, 2], result["tension"][0], at_nodes(result, frame=0)
    for end, other, link in ((0, 1, 0), (-1, -2, -1)):
        rise = 0.5 * (height[end] - height[other])
        assert rise > 5.0
        assert found[end] - tension[link] == pytest.approx(2.0 * weight[end] / length[link] * rise, rel=1e-3)


def test_what_nothing_tells_of_the_ends_leaves_a_string_of_one_link_its_middle():
    result = straight(np.zeros((1, 2, 2)), np.array([[0.0, 100.0]]), tension=np.array([[7.0]]))
    assert at_nodes(result).tolist() == [7.0, 7.0]


def test_the_top_of_a_string_is_told_without_a_scene():
    _, known = ran("hanging")
    assert at_nodes(without(known, (), scene="")) == pytest.approx(at_nodes(known), rel=1e-9, abs=1e-3)


@pytest.mark.parametrize("name", ["jwell", "iscwsa"])
def test_contact_forces_act_where_the_pipe_touches_the_wall(name):
    _, result = ran(name)
    (push,) = appearance(result, TRUE).arrows
    force, position = result["contact_force"][-1], result["position"][-1]
    there = force > 0.0
    # A pipe of at least 5 in lies on the wall of the 8 in hole: its axis is as far from it as it is thick.
    place = np.stack([position[:, 1], position[:, 0], -position[:, 2]], axis=-1)
    off = np.linalg.norm(push.points(-1) - place, axis=1)[there]
    assert (
        np.abs(off - 0.5 * np.append(result["outer_diameter"], 0.165)[: there.size][there]).max() < 0.03
        and off.min() > 0.06
    )


def test_a_picture_holds_the_tails_of_what_pushes():
    _, result = ran("jwell")
    picture = appearance(result, TRUE)
    (push,) = picture.arrows
    points, vectors, extent = push.points(-1), push.vectors(-1), picture.extent([len(picture.time) - 1])
    size = np.ptp(extent, axis=0).max()
    strongest = int(np.argmax(np.linalg.norm(vectors, axis=1)))
    tail = points[strongest] - 0.08 * size * vectors[strongest] / push.longest
    assert np.all(extent.min(axis=0) <= tail) and np.all(tail <= extent.max(axis=0))


def test_a_string_says_what_its_axes_are():
    _, result = ran("jwell")
    true, unrolled = (appearance(result, Look(view)).axes for view in VIEWS)
    assert "x is east, y is north, z is up" in true and "north, east, down" in true and "measured depth" in unrolled
