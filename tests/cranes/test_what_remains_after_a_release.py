"""What is left on a hook after its load has dropped: its weight, less the buoyancy of what remains, and its wind."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, parsed, ran

from crane.warnings import warnings
from tautline.scene.errors import SceneError

MASS, REMAINING, DENSITY = 20.0e3, 500.0, 1025.0
WATER = {"surface": 0.0, "density": DENSITY}
HEAVY = {"linear": [4.0e4, 4.0e4, 4.0e4]}
NOTHING = {"volume": 0.0, "added_mass": [0.0, 0.0, 0.0], "drag": {}, "force": [0.0, 0.0, 0.0]}


def dropped(load=None, damping=2.0e-2, end_at=4.0, left=None, **more):
    """A load that drops to its hook at 0.1 s, on 20 m of rope that weighs next to nothing."""
    release = {"at": 0.1, "remaining": REMAINING} | (left or {})
    rope = {"mass_per_length": 0.01, "axial_stiffness": 1.0e7, "damping": damping}
    hung = body("load", MASS, (0.0, 0.0, -30.0), release=release, **(load or {}))
    return crane(
        [anchor((0.0, 0.0, -10.0)), end("load")], [hung], rope, mesh={"elements_per_span": 1}, interval=0.05,
        solver={"end": end_at}, **more,
    )  # fmt: skip


def told(scene):
    return [w.text for w in warnings(parsed(scene)) if w.where.endswith("release")]


@pytest.mark.parametrize("volume", [0.0, 0.1, 0.4])
def test_the_rope_carries_the_weight_less_the_buoyancy_of_what_remains(volume):
    """500 kg of hook, of 20 t with 5 m^3."""
    load = {"volume": 5.0, "drag": HEAVY, "added_mass": [2.0e4] * 3}
    left = {"volume": volume, "drag": {"linear": [0.0, 0.0, 2.0e4]}, "added_mass": [0.0] * 3}
    result = ran(dropped(load, water=WATER, left=left))
    expected = (REMAINING - DENSITY * volume) * GRAVITY
    assert result["tension"][-1, 0, 1] == pytest.approx(expected, rel=1.0e-3)


def test_a_hook_without_its_load_is_out_of_the_wind():
    """With 30 kN of wind 20 t hang 8.7 deg from plumb, and a hook that the wind does not find hangs plumb."""
    load = {"force": [30.0e3, 0.0, 0.0], "drag": HEAVY}
    result = ran(dropped(load, end_at=40.0, water=WATER, left={"force": [0.0] * 3, "drag": {"linear": [500.0] * 3}}))
    across = result["body_position"][:, 0, 0]
    assert across[0] == pytest.approx(20.0 * 30.0e3 / (MASS * GRAVITY), rel=1.0e-4)
    assert abs(across[-1]) < 1.0e-2


def test_an_empty_hook_stands_on_the_deck_by_its_own_bottom():
    """A load 3 m high that stands on the deck drops its weight there: the hook comes down to 0.2 m above the deck."""
    ground = {"level": -33.0, "stiffness": 1.0e6, "damping": 5.0e4}
    made = dropped({"bottom": 3.0}, end_at=6.0, ground=ground, start="as drawn", left={"bottom": 0.2})
    made["rope"]["length"] = 23.5
    result = ran(made)
    assert result["body_position"][-1, 0, 2] == pytest.approx(-33.0 + 0.2 - REMAINING * GRAVITY / 1.0e6, abs=1.0e-3)


def test_what_a_release_does_not_give_stays_and_is_warned_of():
    load = {"volume": 5.0, "added_mass": [1.0e4] * 3, "drag": HEAVY, "force": [1.0, 0.0, 0.0]}
    keys, floats = told(dropped(load, water=WATER))
    assert all(f"`{key}`" in keys for key in load) and "bottom" not in keys
    assert "floats up" in floats and "5125 kg of water" in floats
    assert not told(dropped(load, water=WATER, left=NOTHING))
    (one,) = told(dropped(load, water=WATER, left=NOTHING | {"volume": 0.6}))
    assert "floats up" in one


def test_a_bodys_own_numbers_in_a_release_change_nothing():
    """Given as the body has them, what remains is as without them."""
    load = {"volume": 0.3, "added_mass": [1.0e3] * 3, "drag": HEAVY, "force": [1.0e3, 0.0, 0.0]}
    runs = [ran(dropped(load, water=WATER, end_at=0.5, left=left)) for left in (None, dict(load))]
    for name in ("body_position", "tension", "kinetic_energy"):
        assert np.array_equal(runs[0][name], runs[1][name])


@pytest.mark.parametrize("key, value, lacks", [("volume", 1.0, "water"), ("bottom", 0.5, "ground")])
def test_water_and_ground_of_what_remains_are_refused_where_the_scene_has_none(key, value, lacks):
    with pytest.raises(SceneError, match=f"release.{key}.*the scene has no {lacks}"):
        parsed(dropped(left={key: value}))


@pytest.mark.parametrize(
    "given", [{"volume": 0.5}, {"added_mass": [0.0, 0.0, 10.0]}, {"drag": {"quadratic": [1.0, 0.0, 0.0]}}]
)
def test_a_body_without_a_release_has_one_fault_where_there_is_no_water(given):
    scene = crane([anchor((0.0, 0.0, 0.0)), end("load")], [body("load", MASS, (0.0, 0.0, -20.0), **given)])
    with pytest.raises(SceneError) as refused:
        parsed(scene)
    assert [one.key for one in refused.value.problems] == [f"bodies[0].{next(iter(given))}"]
