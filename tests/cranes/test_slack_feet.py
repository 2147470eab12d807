"""A rope whose foot is slack: what the mesh hangs on the foot lacks at the top, and the user is told how much."""

import math
import re

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, fall, parsed, ran
from references import cables

from crane.warnings import warnings

ROPE, HEIGHT, LENGTH, STIFFNESS, MASS = 20.0, 100.0, 100.05, 1.0e8, 5000.0
TOP = ROPE * GRAVITY * (HEIGHT + LENGTH) / 2.0
"""Tension of a rope that hangs from its top in a narrow bight: half of what is too long of it hangs there too, N."""


def landed(elements, load=None, **rope):
    """5 t on the ground, 100 m below the anchor of a rope that is 5 cm too long."""
    heavy = {"mass_per_length": ROPE, "axial_stiffness": STIFFNESS, "strain": "engineering", "length": LENGTH} | rope
    ground = {"level": -HEIGHT, "stiffness": 1.0e7, "damping": 1.0e4, "friction": 0.3}
    hung = body("load", MASS, (0.0, 0.0, -HEIGHT), **(load or {}))
    return crane(
        [anchor((0.0, 0.0, 0.0)), end("load")], [hung], heavy, ground=ground, interval=0.05,
        mesh={"elements_per_span": elements}, solver={"end": 0.2},
    )  # fmt: skip


def foreseen(scene):
    return [one.text for one in warnings(parsed(scene)) if "the rope begins slack" in one.text]


def told(result):
    return [text for text in result.warnings if "the rope hangs slack" in text]


def newtons(text):
    number, unit = re.search(r"(?:about|at least) ([0-9.]+) (k?N) too low", text).groups()
    return float(number) * (1e3 if unit == "kN" else 1.0)


def test_what_lacks_at_the_top_over_a_landed_load_is_told_before_the_run_and_after_it():
    result = ran(landed(4))
    lacks = TOP - result["tension"][-1, 0, 0]
    assert lacks == pytest.approx(ROPE * GRAVITY * HEIGHT / 8.0, rel=2e-3)
    for (text,) in (foreseen(landed(4)), told(result)):
        assert newtons(text) == pytest.approx(lacks, rel=5e-3) and "12 % of it" in text
        assert "gives half of its weight to hook" in text and "hangs from top" in text


@pytest.mark.parametrize(("length", "elements"), [(105.0, 8), (110.0, 4), (125.0, 4)])
def test_half_of_what_is_too_long_hangs_at_the_foot_of_a_real_rope_and_does_not_lack(length, elements):
    """It lies in the lowest element: w/2 (l - (L - H)) lacks of the tension of a plumb bight, w/2 (L + H)."""
    result, scene = ran(landed(elements, length=length)), landed(elements, length=length)
    lacks = ROPE * GRAVITY * (length / elements - (length - HEIGHT)) / 2.0
    assert result["tension"][-1, 0, 0] == pytest.approx(ROPE * GRAVITY * (HEIGHT + length) / 2.0 - lacks, rel=1e-4)
    for (text,) in (foreseen(scene), told(result)):
        assert newtons(text) == pytest.approx(lacks, rel=2e-3)
        enough = int(re.search(r"Take (\d+) elements or more", text)[1])
    fewer, taken = ((length / n - (length - HEIGHT)) / (length + HEIGHT) for n in (enough - 1, enough))
    assert fewer > 0.0199 and taken < 0.0201


@pytest.mark.parametrize(("length", "elements"), [(105.0, 16), (110.0, 8), (125.0, 8), (125.0, 16)])
def test_a_rope_too_long_for_its_lowest_element_to_lack_anything_that_matters_is_not_warned_of(length, elements):
    scene = landed(elements, length=length)
    assert foreseen(scene) == [] and told(ran(scene)) == []


@pytest.mark.parametrize("aside", [1.0, 5.0])
def test_a_steep_slack_rope_between_anchors_is_told_no_more_than_it_lacks_and_elements_that_are_enough(aside):
    length = math.hypot(aside, HEIGHT) + 1.0
    rope = {"mass_per_length": 5.0, "axial_stiffness": 1.0e6, "strain": "engineering", "length": length}
    path = [anchor((0.0, 0.0, 0.0), "upper"), anchor((aside, 0.0, -HEIGHT), "lower")]

    def scene(elements):
        return crane(path, [], rope, mesh={"elements_per_span": elements}, solver={"end": 0.1})

    exact = cables.catenary(aside, -HEIGHT, length, 1.0e6, 5.0 * GRAVITY, "engineering")
    top = np.linalg.norm(exact.end_forces, axis=1).max()
    lacks = top - ran(scene(4))["tension"][-1, 0, 0]
    (text,) = foreseen(scene(4))
    assert newtons(text) == pytest.approx(lacks, rel=0.06) and newtons(text) < lacks
    enough = int(re.search(r"Take (\d+) elements or more", text)[1])
    assert foreseen(scene(11)) and foreseen(scene(enough)) == []
    result = ran(scene(enough))
    assert result["tension"][-1, 0, 0] == pytest.approx(top, rel=0.0205) and told(result) == []


def test_the_elements_that_are_asked_for_bring_the_tension_at_the_top_within_two_percent():
    (text,) = foreseen(landed(4))
    enough = int(re.search(r"Take (\d+) elements or more", text)[1])
    result = ran(landed(enough))
    assert foreseen(landed(enough)) == [] and told(result) == []
    assert result["tension"][-1, 0, 0] == pytest.approx(TOP, rel=0.0205)
    assert len(foreseen(landed(enough - 1))) == 1


@pytest.mark.parametrize("rope", [{"length": None}, {"length": 99.9}, {"mass_per_length": 0.5}])
def test_a_taut_rope_and_one_that_weighs_little_beside_its_load_are_not_warned_of(rope):
    assert foreseen(landed(4, **rope)) == []


def test_a_rope_lighter_in_water_lacks_less():
    """7854 mm2 of rope take the place of 8.05 kg/m of water."""
    scene = landed(4, diameter=0.1) | {"water": {"surface": 0.0, "density": 1025.0}}
    (text,) = foreseen(scene)
    # A quarter of the rope in the lowest element, less the 5 cm of it that are too long.
    assert newtons(text) == pytest.approx((ROPE - 8.050) * GRAVITY * (LENGTH / 4.0 - 0.05) / 2.0, rel=1e-3)


@pytest.mark.parametrize("aside, warned", [(0.0, True), (100.0, False)], ids=["plumb", "far aside"])
def test_a_slack_rope_between_anchors_is_warned_of_where_it_hangs_plumb(aside, warned):
    length = 100.05 if not aside else 141.6
    rope = {"mass_per_length": 5.0, "axial_stiffness": 1.0e6, "strain": "engineering", "length": length}
    path = [anchor((0.0, 0.0, 0.0), "upper"), anchor((aside, 0.0, -HEIGHT), "lower")]
    scene = crane(path, [], rope, mesh={"elements_per_span": 4}, solver={"end": 0.1})
    texts = foreseen(scene)
    assert bool(texts) == warned and all("slack at lower" in text for text in texts)


def test_a_rope_that_is_slack_for_moments_before_a_snap_is_not_told():
    assert told(ran(fall(solver={"end": 1.5}, rope={"length": 25.5}, start="as drawn"))) == []


@pytest.mark.parametrize("size", [1e-300, 1e-160])
def test_a_slack_rope_in_next_to_no_gravity_is_checked_and_not_divided_by_nothing(size):
    rope = {"mass_per_length": 2.0, "axial_stiffness": 1.0e6, "length": 12.0}
    path = [anchor((0.0, 0.0, 0.0), "lower"), anchor((0.0, 0.0, 10.0), "upper")]
    scene = crane(path, [], rope, mesh={"elements_per_span": 20}, solver={"end": 0.1}) | {"gravity": [0.0, 0.0, -size]}
    with np.errstate(all="raise", under="ignore"):
        assert foreseen(scene) == []
