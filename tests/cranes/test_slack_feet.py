"""A rope whose foot is slack: what the mesh hangs on the foot lacks at the top, and the user is told how much."""

import re

import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, fall, parsed, ran

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
    number, unit = re.search(r"about ([0-9.]+) (k?N) too low", text).groups()
    return float(number) * (1e3 if unit == "kN" else 1.0)


def test_what_lacks_at_the_top_over_a_landed_load_is_told_before_the_run_and_after_it():
    result = ran(landed(4))
    lacks = TOP - result["tension"][-1, 0, 0]
    assert lacks == pytest.approx(ROPE * GRAVITY * HEIGHT / 8.0, rel=2e-3)
    for (text,) in (foreseen(landed(4)), told(result)):
        assert newtons(text) == pytest.approx(lacks, rel=5e-3) and "12 % of it" in text
        assert "gives half of its weight to hook" in text and "hangs from top" in text


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
    assert newtons(text) == pytest.approx((ROPE - 8.050) * GRAVITY * HEIGHT / 8.0, rel=1e-3)


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
