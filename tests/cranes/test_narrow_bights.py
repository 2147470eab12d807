"""Slack rope between fixed places that stand nearly above one another, and rope that is taut without gravity."""

import re

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, crane, parsed, ran

from crane.warnings import warnings
from tautline.scene.errors import SceneError

ROPE, RISE, STIFFNESS = 2.0, 5.0, 1.0e7


def hung(across, length, elements):
    """A rope from an anchor A to one 5 m above, some way aside."""
    rope = {"mass_per_length": ROPE, "axial_stiffness": STIFFNESS, "strain": "engineering", "length": length}
    ends = [anchor((0.0, 0.0, 0.0), name="A"), anchor((across, 0.0, RISE), name="B")]
    return crane(ends, [], rope, interval=0.05, mesh={"elements_per_span": elements}, solver={"end": 0.1})


def off(scene):
    """By how much the tensions at A and B are off by what is told, N; none where nothing is."""
    told = [one.text for one in warnings(parsed(scene)) if "narrower than its elements" in one.text]
    parts = [re.findall(r"tension at (A|B) is ([0-9.]+) N too (high|low)", text) for text in told]
    return [{name: float(by) * (1 if side == "high" else -1) for name, by, side in part} for part in parts]


@pytest.mark.parametrize(("length", "elements"), [(10.0, 20), (10.2, 20), (10.2, 7)])
@pytest.mark.parametrize("across", [0.0, 1.0e-3])
def test_a_plumb_bight_comes_to_rest_and_is_told_how_far_its_mesh_is_off_a_real_rope(across, length, elements):
    """Each leg of a narrow bight carries itself: w (L - h) / 2 and w (L + h) / 2 at the ends."""
    scene = hung(across, length, elements)
    tension = np.asarray(ran(scene)["tension"])[-1, 0]
    true = 0.5 * ROPE * GRAVITY * (length + np.array([-RISE, RISE]))
    (told,) = off(scene)
    assert [told["A"], told["B"]] == pytest.approx(list(tension - true), abs=5e-3 * ROPE * GRAVITY)
    assert abs(told["A"]) > 0.02 * true[0]


@pytest.mark.parametrize(("across", "elements"), [(0.0, 100), (0.5, 20)])
def test_nothing_is_told_of_a_bight_that_is_right_to_two_percent(across, elements):
    assert off(hung(across, 10.0, elements)) == []


def weightless(length):
    scene = hung(3.0, length, 4)
    return scene | {"gravity": [0.0, 0.0, 0.0]}


def test_a_taut_rope_is_at_rest_without_gravity():
    way = float(np.hypot(3.0, RISE))
    tension = np.asarray(ran(weightless(0.999 * way))["tension"])
    assert tension == pytest.approx(STIFFNESS * (1.0 / 0.999 - 1.0), rel=1e-9)


def test_a_slack_rope_without_gravity_has_no_rest_and_is_refused():
    with pytest.raises(SceneError, match="without gravity slack rope has no rest"):
        ran(weightless(6.0))
