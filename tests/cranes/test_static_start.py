"""Where a load is that starts at rest: as high as drawn, or refused with the cause."""

import math

import numpy as np
import pytest
from physics.lifting.crane_scenes import (
    GRAVITY,
    anchor,
    body,
    crane,
    drum,
    end,
    fall,
    hoist,
    parsed,
    ran,
    sheave,
    stopped,
)

from crane.assembly import static_start as reach
from crane.assembly.layout import lay_out
from crane.warnings import warnings
from tautline.integrators.status import Status
from tautline.scene.errors import SceneError

MASS, DENSITY = 5000.0, 1025.0
WATER = {"surface": 0.0, "density": DENSITY}
FLOATS = 6.0


def in_water(volume, **more):
    """5 t at 50 m below the surface, on a rope without a diameter, so that the rope has no buoyancy."""
    made = hoist(drive={"pay_out": 0.0}, load={"volume": volume}, water=WATER, solver={"end": 0.05}, **more)
    made["bodies"][0]["position"] = (12.4, 0.0, -50.0)
    return made


def floating(scene):
    return [warning.text for warning in warnings(parsed(scene)) if "floats" in warning.text]


def test_a_body_that_floats_is_refused_by_what_lifts_it():
    lift = (FLOATS * DENSITY - MASS) * GRAVITY
    with pytest.raises(SceneError, match="payload does not pull on its rope") as refused:
        lay_out(parsed(in_water(FLOATS)))
    (problem,) = refused.value.problems
    assert problem.key == "bodies[0]" and f"{lift:.4g} N more than it weighs" in problem.cause
    with pytest.raises(SceneError, match="does not pull"):
        lay_out(parsed(fall(MASS, load={"force": [0.0, 0.0, 1.1 * MASS * GRAVITY]})))


def on_a_floating_rope(mass, **more):
    """A load 500 m below the surface, and its anchor 10 m above: 1.8 kg/m of rope that takes the place of 2.013."""
    rope = {"mass_per_length": 1.8, "axial_stiffness": 2.0e7, "diameter": 0.05} | more.pop("rope", {})
    path, hung = [anchor((0.0, 0.0, 10.0)), end("load")], [body("load", mass, (0.0, 0.0, -500.0))]
    return crane(path, hung, rope, water=WATER, mesh={"elements_per_span": 16}, solver={"end": 0.05}, **more)


RISES = (0.25 * math.pi * 0.05**2 * DENSITY - 1.8) * GRAVITY * 500.0
"""What the water lifts that rope with more than it weighs, up to the surface, N."""


def test_a_rope_that_floats_and_lifts_its_load_is_refused_by_how_much():
    scene = on_a_floating_rope(80.0)
    with pytest.raises(SceneError, match="load does not keep its rope taut: its rope is lighter than water") as refused:
        lay_out(parsed(scene))
    (problem,) = refused.value.problems
    assert problem.key == "bodies[0]" and f"{RISES:.4g} N more than it weighs" in problem.cause
    assert f"{RISES - 80.0 * GRAVITY:.4g} N more than load pulls down with" in problem.cause
    (text,) = floating(scene | {"start": "as drawn"})
    assert text.startswith("load floats up with its rope") and f"{RISES:.4g} N" in text
    assert len(floating(on_a_floating_rope(80.0, rope={"length": 510.5}))) == 1


def test_a_load_that_keeps_a_floating_rope_taut_hangs_by_the_sum_of_their_weights():
    """The tension is least at the surface, 7 N, and larger at the top by what 10 m of rope weigh in air."""
    mass = (RISES + 7.0) / GRAVITY
    scene = on_a_floating_rope(mass)
    assert floating(scene) == []
    result = ran(scene)
    top, foot = result["tension"][0, 0]
    assert top == pytest.approx(7.0 + 10.0 * 1.8 * GRAVITY, rel=2e-3)
    assert foot == pytest.approx(mass * GRAVITY, rel=1e-4)


@pytest.mark.parametrize("volume", [0.0, 3.0, 4.85])
def test_a_body_that_only_just_sinks_hangs_where_it_is_drawn(volume):
    result = ran(in_water(volume))
    assert result["body_position"][0, 0, 2] == pytest.approx(-50.0, abs=1e-6)
    assert result["tension"][0, -1, 1] == pytest.approx((MASS - DENSITY * volume) * GRAVITY, rel=1e-6)


STRETCHED = {"engineering": lambda e: e - 1.0, "green": lambda e: 0.5 * (e**2 - 1.0) * e}
"""Force over EA of a rope stretched to e times its length."""


@pytest.mark.parametrize("strain", STRETCHED)
@pytest.mark.parametrize("given", [True, False], ids=["length given", "length found"])
def test_a_rope_hangs_as_long_as_its_strain_says(strain, given):
    """A rope that weighs next to nothing, stretched by 3 %: its length is given, or found from where the load is."""
    mass, drawn, stiffness = 5000.0, 25.0, 5000.0 * GRAVITY / 0.03
    rope = {"strain": strain, "axial_stiffness": stiffness, "mass_per_length": 1.0e-6}
    if given:
        rope["length"] = drawn
    result = ran(fall(mass, drawn, rope=rope, solver={"end": 0.1}))
    long = -result["body_position"][-1, 0, 2] / result["material_coordinate"][-1, -1]
    assert STRETCHED[strain](long) == pytest.approx(0.03, rel=1.0e-6)
    if given:
        assert result["material_coordinate"][-1, -1] == pytest.approx(drawn, rel=1.0e-9)
    else:
        assert result["body_position"][-1, 0, 2] == pytest.approx(-drawn, rel=1.0e-6)


def test_a_search_for_the_length_that_does_not_end_is_no_start(monkeypatch):
    monkeypatch.setattr(reach, "ITERATIONS", 1)
    stop = stopped(in_water(3.0, rope={"axial_stiffness": 1.0e5}), Status.NO_EQUILIBRIUM)
    assert "m higher than it is drawn" in stop.sentence and stop.part == "payload: z"


def test_a_body_that_floats_is_told_where_it_is_let_go():
    assert len(floating(in_water(FLOATS, start="as drawn"))) == 1
    assert len(floating(in_water(FLOATS, rope={"length": 110.0}))) == 1
    assert floating(in_water(4.85)) == []


def test_a_body_that_floats_and_is_held_down_is_not_told():
    path = [anchor((-0.4, 0.0, 0.0)), sheave((0.0, 0.0, 30.0)), end("payload")]
    held = body("payload", MASS, (0.4, 0.0, -50.0), volume=FLOATS, spring={"stiffness": [0, 0, 1e5]})
    assert floating(crane(path, [held], water=WATER)) == []
    guided = body("payload", MASS, (0.4, 0.0, -50.0), volume=FLOATS, guide=["z"])
    assert floating(crane(path, [guided], water=WATER)) == []
    below = crane([anchor((0.0, 0.0, -80.0)), end("payload")], [held | {"spring": None}], water=WATER, start="as drawn")
    assert floating(below) == []


BUOY, VOLUME, LENGTH = 500.0, 3.0, 60.0
LIFT = (DENSITY * VOLUME - BUOY) * GRAVITY


def moored(height=-50.0, load=None, **rope):
    """A buoy drawn above its anchor, which is at z = -100 m, on a rope of 5 kg/m that takes the place of 2.013."""
    heavy = {"mass_per_length": 5.0, "axial_stiffness": 1.0e8, "diameter": 0.05, "strain": "engineering"} | rope
    hung = body("buoy", BUOY, (0.0, 0.0, height), **({"volume": VOLUME} | (load or {})))
    path = [anchor((0.0, 0.0, -100.0), "bed"), end("buoy")]
    return crane(path, [hung], heavy, water=WATER, mesh={"elements_per_span": 8}, solver={"end": 0.1}, interval=0.05)


@pytest.mark.parametrize("height", [-40.0, -60.0])
@pytest.mark.parametrize("aside", [0.0, 3.0e3], ids=["upright", "in a current"])
def test_a_buoy_stands_above_its_anchor_at_the_length_of_its_rope(height, aside):
    """Drawn with its rope straight or slack: the force on it bears its rope, whose weight is that in water."""
    result = ran(moored(height, {"force": [aside, 0.0, 0.0]}, length=LENGTH))
    top = math.hypot(LIFT, aside)
    hung = (5.0 - 0.25 * math.pi * 0.05**2 * DENSITY) * GRAVITY
    foot = math.hypot(LIFT - hung * LENGTH, aside)
    bottom, end_of_rope = result["tension"][0, 0]
    assert end_of_rope == pytest.approx(top, rel=1e-5) and bottom == pytest.approx(foot, rel=1e-4)
    # A catenary: the difference of the tensions is the weight of as much rope as the buoy is high, less its stretch.
    rise = (top - foot) / hung + 0.5 * (top**2 - foot**2) / (1.0e8 * hung)
    assert result["body_position"][0, 0, 2] == pytest.approx(-100.0 + rise, abs=2e-3)


def test_a_buoy_that_turns_stands_with_the_end_of_its_rope_below_its_centre():
    load = {"inertia": [100.0, 100.0, 80.0]}
    scene = moored(-40.0, load, length=LENGTH)
    scene["path"][1]["end"]["offset"] = [0.3, 0.0, 1.0]
    (text,) = [one.text for one in warnings(parsed(scene)) if "start: static turns buoy" in one.text]
    assert "holds it above its centre of mass" in text and "offset below the centre" in text
    height = ran(scene)["body_position"][0, 0, 2]
    stretched = LENGTH * (1.0 + (LIFT - 0.5 * (5.0 - 2.0126) * GRAVITY * LENGTH) / 1.0e8)
    assert height == pytest.approx(-100.0 + stretched + math.hypot(0.3, 1.0), abs=2e-3)


def test_a_buoy_without_a_length_of_rope_is_refused_in_words_that_are_true_of_it():
    with pytest.raises(SceneError, match=r"above bed, which holds it down.*give rope\.length"):
        lay_out(parsed(moored()))
    with pytest.raises(SceneError, match="no taut rope holds it up there"):
        lay_out(parsed(moored(load={"volume": 0.0}, length=LENGTH)))


@pytest.mark.parametrize("mass", [0.0, 1.0e-3, 0.1])
@pytest.mark.parametrize("elements", [2, 3])
def test_an_empty_hook_on_few_elements_rests_where_it_is_drawn(mass, elements):
    """The tension on the hook's side of the tip is the weight below it, by hand: rope as long as it hangs, and hook.

    On two elements the search folded the rope, and ended with nothing that is held.
    """
    path = [
        drum((0.0, 0.0, 10.0), 0.4, pay_out=0.0),
        sheave((10.0, 0.0, 20.0), 0.2, name="tip"),
        end("load"),
    ]
    rope = {"mass_per_length": 1.0, "axial_stiffness": 2.0e7, "strain": "engineering"}
    hook = body("load", mass, (10.2, 0.0, 0.0))
    result = ran(crane(path, [hook], rope, mesh={"elements_per_span": elements}, solver={"end": 0.05}))
    assert result["body_position"][0, 0, 2] == pytest.approx(0.0, abs=1.0e-6)
    assert result["tension"][0, 1, 1] == pytest.approx(mass * GRAVITY, abs=1.0e-3)
    # the arc on the sheave that the rope leaves at its own height hangs on it too
    assert result["tension"][0, 1, 0] == pytest.approx((20.0 + mass) * GRAVITY, abs=0.25 * GRAVITY)
    assert np.ptp(result["body_position"], axis=0).max() < 1.0e-4
