"""A buoy on a rope of a given length is moored above its anchor, wherever it is drawn, and the user is told so."""

import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, parsed, ran

from crane.warnings import warnings

DENSITY, VOLUME, MASS, ROPE, DEPTH, LENGTH = 1025.0, 2.0, 500.0, 1.0, -100.0, 60.0


def drawn(start):
    """30 m below the anchor, and lifted by 1550 kg; 60 m of rope weigh 60 kg."""
    rope = {"mass_per_length": ROPE, "axial_stiffness": 1.0e8, "strain": "engineering", "length": LENGTH}
    buoy = body("buoy", MASS, (0.0, 0.0, DEPTH - 30.0), volume=VOLUME)
    return crane(
        [anchor((0.0, 0.0, DEPTH)), end("buoy")], [buoy], rope, water={"surface": 0.0, "density": DENSITY}, start=start,
        mesh={"elements_per_span": 4}, solver={"end": 0.1},
    )  # fmt: skip


def told(scene):
    return [one.text for one in warnings(parsed(scene)) if "buoy floats" in one.text]


def test_a_buoy_drawn_below_its_anchor_is_said_to_begin_above_it_and_does_so_on_a_taut_rope():
    (text,) = told(drawn("static"))
    assert "slack" not in text and "begins above that" in text
    result = ran(drawn("static"))
    lift = (DENSITY * VOLUME - MASS) * GRAVITY
    assert result["body_position"][0, 0, 2] == pytest.approx(DEPTH + LENGTH * (1.0 + lift / 1.0e8), abs=1e-2)
    assert result["tension"][0, 0] == pytest.approx([lift - ROPE * LENGTH * GRAVITY, lift], rel=1e-3)


def test_of_one_that_begins_as_drawn_the_rope_goes_slack():
    (text,) = told(drawn("as drawn"))
    assert "Its rope goes slack" in text
