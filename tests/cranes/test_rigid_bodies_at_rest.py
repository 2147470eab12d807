"""Rigid bodies that start at rest: their moments vanish, they stand as drawn on the ground, and none is turned over."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import GRAVITY, anchor, body, crane, end, model_of, parsed, ran, sheave
from scipy.spatial.transform import Rotation

from crane.assembly.layout import lay_out
from crane.results.set_down import set_down_askew
from crane.warnings import warnings
from tautline.integrators.state import new_state
from tautline.integrators.statics.stability import count_negative
from tautline.integrators.status import StoppedEarly
from tautline.scene.errors import SceneError

MASS, INERTIA = 2000.0, [900.0, 1700.0, 1500.0]
LIGHT = {"mass_per_length": 0.01, "axial_stiffness": 2.0e7}
TOP = anchor((0.0, 0.0, 10.0))
GROUND = {"level": -0.5, "stiffness": 1.0e7, "damping": 5.0e4, "friction": 0.5}


def load(**more):
    return body("load", MASS, (0.0, 0.0, 0.0), **{"inertia": INERTIA} | more)


def hung(offset, top=TOP, rope=None, **more):
    """A load on one rope, by a point off its centre."""
    ground = {key: more.pop(key) for key in ("ground", "solver") if key in more}
    path = [top, end("load", offset=offset)]
    return crane(path, [load(**more)], LIGHT | (rope or {}), mesh={"elements_per_span": 2}, start="static", **ground)


def slung(one, other, radius=0.01, **more):
    """A load in a sling that runs over a hook 6 m above."""
    hook = sheave((0.0, 0.0, 6.0), radius, name="hook", **more)
    path = [end("load", name="left", offset=one), hook, end("load", name="right", offset=other)]
    return crane(path, [load()], LIGHT, mesh={"elements_per_span": 1}, start="static")


def at_rest(scene):
    """Position of the load, and its axes in space as a rotation, in the static start."""
    model = model_of(scene)
    state = new_state(model.system)
    model.settle(state)
    layout = lay_out(parsed(scene))
    turn, place = layout.turn["load"], layout.body["load"]
    return state.full_q[place : place + 3], Rotation.from_quat(np.roll(state.full_q[turn : turn + 4], -1)), state


def tilt(turned):
    """Angle of the load's own z to plumb, in the plane of x and z, rad."""
    x, _, z = turned.as_matrix()[:, 2]
    return np.arctan2(x, z)


@pytest.mark.parametrize("arm", [0.3, 3.0])
@pytest.mark.parametrize("wind", [5.0e3, 12.0e3])
def test_a_load_in_wind_hangs_in_line_with_its_rope(arm, wind):
    _, turned, _ = at_rest(hung((0.0, 0.0, arm), force=[wind, 0.0, 0.0]))
    # The rope weighs 1e-5 of the load, and bends by about as much.
    assert tilt(turned) == pytest.approx(-np.arctan(wind / (MASS * GRAVITY)), abs=1.0e-5)


def test_nothing_moves_from_a_static_start_in_wind():
    result = ran(hung((0.0, 0.0, 3.0), force=[5.0e3, 0.0, 0.0], solver={"end": 0.2}))
    assert result["kinetic_energy"].max() < 1.0e-9
    assert result.attributes["headline"]["dynamic_amplification"]["value"] == pytest.approx(1.0, abs=1.0e-6)


def test_a_load_in_a_running_sling_tilts_as_far_as_the_ellipse_of_its_pad_eyes():
    """The hook is on the ellipse about both pad eyes, and the load hangs lowest where the hook is farthest from it."""
    left, right, height = 1.4, 1.5, 0.5
    scene = slung((-left, 0.0, height), (right, 0.0, height))
    _, turned, state = at_rest(scene)
    spots = [turned.apply((x, 0.0, height)) for x in (-left, right)]
    rope = sum(np.linalg.norm(np.array([0.0, 0.0, 6.0]) - state.full_q[place(scene)] - spot) for spot in spots)
    half, focus = 0.5 * rope, 0.5 * (left + right)
    angle = np.linspace(0.0, np.pi, 200_001)
    across, up = 0.5 * (right - left) + half * np.cos(angle), height + np.sqrt(half**2 - focus**2) * np.sin(angle)
    far = np.hypot(across, up)
    inner = np.flatnonzero((far[1:-1] >= far[:-2]) & (far[1:-1] > far[2:])) + 1
    expected = [np.arctan2(across[k], up[k]) for k in inner]
    assert min(abs(tilt(turned) + one) for one in expected) < np.radians(0.3)


def place(scene):
    start = lay_out(parsed(scene)).body["load"]
    return slice(start, start + 3)


def test_about_its_rope_a_load_stays_as_it_is_drawn():
    _, turned, _ = at_rest(hung((0.0, 0.0, 1.0), orientation=[0.0, 0.0, 1.2]))
    assert (turned.inv() * Rotation.from_euler("z", 1.2)).magnitude() < 1.0e-9


def test_an_orientation_that_is_given_is_where_the_search_begins():
    """Drawn at rest in the wind, the load stays as it is; a roll of 0.4 rad of one that hangs plumb is taken back."""
    lean = float(np.arctan(5.0e3 / (MASS * GRAVITY)))
    _, turned, _ = at_rest(hung((0.0, 0.0, 3.0), force=[5.0e3, 0.0, 0.0], orientation=[0.0, -lean, 0.0]))
    assert tilt(turned) == pytest.approx(-lean, abs=1.0e-5)
    _, turned, _ = at_rest(hung((0.0, 0.0, 3.0), orientation=[0.4, 0.0, 0.0]))
    assert turned.magnitude() < 1.0e-6


@pytest.mark.parametrize(
    "scene",
    [
        slung((-1.5, 0.0, -0.5), (1.5, 0.0, -0.5), 0.2, law="capstan", friction=0.5, locked=True),
        hung((0.0, 0.0, -1.0), orientation=[0.0, 0.0, 0.0]),
    ],
    ids=["slung below its centre", "on its head"],
)
def test_a_load_that_would_turn_over_is_refused(scene):
    """A sling under the centre is a hinge that the load falls about, like an inverted pendulum."""
    with pytest.raises(StoppedEarly, match="upper side would turn by 180 deg") as stop:
        at_rest(scene)
    assert stop.value.part == "load"


def test_a_load_that_the_drawing_turns_over_is_warned_of():
    (text,) = [w.text for w in warnings(parsed(hung((0.0, 0.0, -1.0)))) if "turn" in w.text]
    assert "180 deg" in text and "orientation" in text
    assert not [w for w in warnings(parsed(hung((0.0, 0.0, 1.0)))) if "turn" in w.text]


def standing(**more):
    """A crate on the deck under a slack rope."""
    rope = {"length": 11.6}
    return hung((0.5, 0.0, 1.0), anchor((0.0, 0.0, 12.0)), rope, ground=GROUND, bottom=0.5, **more)


@pytest.mark.parametrize("wind, stays", [(0.0, True), (9.0e3, True), (11.0e3, False)])
def test_a_load_stands_where_and_as_it_is_drawn_as_long_as_friction_holds_it(wind, stays):
    """Friction of 0.5 holds 9.8 kN."""
    where, turned, _ = at_rest(standing(force=[wind, 0.0, 0.0], orientation=[0.3, 0.0, 0.0]))
    assert (abs(where[0]) < 1.0e-12) == stays
    if stays:
        assert turned.as_rotvec() == pytest.approx([0.3, 0.0, 0.0], abs=1.0e-12)


@pytest.mark.parametrize("shorter, stays", [(0.0003, True), (0.004, False)])
def test_a_rope_that_pulls_more_than_friction_drags_its_load_on_the_deck(shorter, stays):
    """A rope 45 deg from plumb: 0.5 (m g - T cos 45) = T sin 45 is T = 9.25 kN, a strain of 4.6e-4 of 10 m.

    The load sinks into the deck by 1.4 mm, which strains the rope by 1e-4.
    """
    side = float(10.0 / np.sqrt(2.0))
    path = [anchor((side, 0.0, side)), end("load")]
    rope = LIGHT | {"length": 10.0 - 10.0 * shorter}
    made = crane(
        path, [body("load", MASS, (0.0, 0.0, 0.0), bottom=0.5)], rope, mesh={"elements_per_span": 1}, start="static",
        ground=GROUND,
    )  # fmt: skip
    model = model_of(made)
    state = new_state(model.system)
    model.settle(state)
    assert (abs(state.full_q[lay_out(parsed(made)).body["load"]]) < 1.0e-12) == stays


@pytest.mark.parametrize("height", [2.0e-6, 1.0e-4, 5.0e-3, 0.05])
@pytest.mark.parametrize("offset", [(0.0, 0.0, 1.0), (0.5, 0.0, 1.0), (2.0, 0.0, -0.3)])
def test_a_load_that_a_slack_rope_sets_down_stands_as_it_is_drawn(offset, height):
    """It sinks into the deck by m g over its stiffness. The end of the slack rope, of 2 kg, would topple it."""
    rope = {"length": 11.0, "mass_per_length": 0.5}
    scene = hung(offset, anchor((0.0, 0.0, 10.0 + height)), rope, ground=GROUND, bottom=0.5)
    scene["bodies"][0]["position"] = (0.0, 0.0, height)
    where, turned, _ = at_rest(scene)
    assert where == pytest.approx([0.0, 0.0, -MASS * GRAVITY / GROUND["stiffness"]], abs=1.0e-5)
    assert turned.magnitude() < 1.0e-9


def test_a_point_load_drawn_just_above_the_deck_is_held_there_by_friction():
    """2 kN of wind against 0.5 m g = 9.8 kN; on a rope that is 0.4 m longer than its path it could be 2.9 m away."""
    path = [anchor((0.0, 0.0, 10.0)), end("load")]
    drawn = body("load", MASS, (0.0, 0.0, 0.005), bottom=0.5, force=[2.0e3, 0.0, 0.0])
    rope = LIGHT | {"length": 10.4}
    made = crane(path, [drawn], rope, mesh={"elements_per_span": 1}, start="static", ground=GROUND)
    model = model_of(made)
    state = new_state(model.system)
    model.settle(state)
    assert abs(state.full_q[lay_out(parsed(made)).body["load"]]) < 1.0e-12


@pytest.mark.parametrize("height", [0.01, 0.1, 0.3])
def test_a_locked_hook_holds_a_symmetric_sling_by_friction(height):
    """Upright both legs pull alike. If the sling could slip, that would be stable only for h > 1.5^2 / (6 - h)."""
    pads = (-1.5, 0.0, height), (1.5, 0.0, height)
    held = slung(*pads, 0.2, law="capstan", friction=0.5, locked=True)
    where, turned, _ = at_rest(held)
    assert turned.magnitude() < 1.0e-6 and abs(where[0]) < 1.0e-6
    _, free, _ = at_rest(slung(*pads, 0.2))
    assert height * (6.0 - height) < 1.5**2 and free.magnitude() > np.radians(20.0)


def test_a_sling_that_slips_over_a_locked_hook_in_the_search_is_refused():
    with pytest.raises(
        StoppedEarly, match=r"slips over the locked sheave hook.*askew.*start: as drawn.*frictionless"
    ) as stop:
        at_rest(slung((-1.4, 0.0, 0.2), (1.5, 0.0, 0.2), 0.2, law="capstan", friction=0.5, locked=True))
    assert stop.value.part == "load"


LOCKED = {"law": "capstan", "friction": 0.3, "locked": True}


@pytest.mark.parametrize(
    "side, height, top, radius, wind",
    [(0.6, 0.3, 2.0, 0.2, 0.12), (0.5, 0.3, 1.5, 0.15, 0.1), (1.5, 1.5, 6.0, 0.2, 0.31)],
)
def test_a_load_on_a_locked_hook_may_lean_as_far_as_the_wind_blows(side, height, top, radius, wind):
    """In line with weight and wind both legs pull alike, which any friction holds. It is not askew there."""
    scene = slung((-side, 0.0, height), (side, 0.0, height), radius, **LOCKED)
    scene["path"][1]["sheave"]["center"] = (0.0, 0.0, top)
    scene["bodies"][0]["force"] = [wind * MASS * GRAVITY, 0.0, 0.0]
    _, turned, _ = at_rest(scene)
    assert tilt(turned) == pytest.approx(-np.arctan(wind), abs=1.0e-3)


@pytest.mark.parametrize("wind", [-0.1, 0.1])
def test_a_sling_that_slips_over_a_locked_hook_is_refused_in_wind_from_either_side(wind):
    scene = slung((-1.4, 0.0, 0.2), (1.5, 0.0, 0.2), 0.2, **LOCKED)
    scene["bodies"][0]["force"] = [wind * MASS * GRAVITY, 0.0, 0.0]
    with pytest.raises(StoppedEarly, match="slips over the locked sheave hook"):
        at_rest(scene)


def test_wind_along_the_axis_of_a_locked_hook_swings_the_load_without_slip():
    wind = 4.0e3
    scene = slung((-1.5, 0.0, 0.5), (1.5, 0.0, 0.5), 0.2, law="capstan", friction=0.5, locked=True)
    scene["bodies"][0]["force"] = [0.0, wind, 0.0]
    _, turned, _ = at_rest(scene)
    up = turned.as_matrix()[:, 2]
    # The wind pulls at the centre: sling and load are in one plane.
    assert np.arctan2(up[1], up[2]) == pytest.approx(-np.arctan(wind / (MASS * GRAVITY)), abs=1.0e-4)


def test_a_load_that_turns_about_plumb_keeps_its_upper_side_and_is_not_refused():
    """A spreader on two falls, drawn 100 deg askew about plumb."""
    tips = [sheave((x, 0.0, 10.0), 0.3, name=name) for x, name in ((-3.0, "port"), (3.0, "starboard"))]
    path = [end("load", name="a", offset=(-1.5, 0.0, 0.4)), *tips, end("load", name="b", offset=(1.5, 0.0, 0.4))]
    drawn = load(orientation=[0.0, 0.0, 1.75])
    _, turned, _ = at_rest(crane(path, [drawn], LIGHT, mesh={"elements_per_span": 1}, start="static"))
    assert turned.magnitude() < 1.0e-3


def test_a_pipe_that_is_hung_by_its_end_may_be_given_a_heading():
    """It turns by 90 deg, whatever rounding says of that."""
    _, turned, _ = at_rest(hung((2.0, 0.0, 0.0), orientation=[0.0, 0.0, 0.5 * np.pi]))
    assert turned.apply((2.0, 0.0, 0.0)) == pytest.approx([0.0, 0.0, 2.0], abs=1.0e-4)


@pytest.mark.parametrize("wind", [-0.3, -0.1, 0.09, 0.15, 0.3])
@pytest.mark.parametrize("eye", [(2.0, 0.0, 0.0), (2.0, 0.0, -0.1)])
def test_a_pipe_in_wind_hangs_by_its_end_in_line_with_its_rope_and_keeps_its_heading(eye, wind):
    """Whatever side the wind comes from. It turns about its own y alone, which is the least turn."""
    made = {"orientation": [0.0, 0.0, 0.0], "inertia": [90.0, 1700.0, 1700.0]}
    _, turned, _ = at_rest(hung(eye, force=[wind * MASS * GRAVITY, 0.0, 0.0], **made))
    line = np.array([-wind, 0.0, 1.0]) / np.hypot(wind, 1.0)
    assert turned.apply(eye) == pytest.approx(np.linalg.norm(eye) * line, abs=1.0e-3)
    assert turned.apply((0.0, 1.0, 0.0)) == pytest.approx([0.0, 1.0, 0.0], abs=1.0e-9)


@pytest.mark.parametrize("drawn", [(0.0, 0.0, 0.0), (0.3, -0.2, 2.0), (-0.4, 0.3, -1.0)])
def test_a_body_on_one_end_is_turned_by_the_least_angle_that_brings_the_end_over_its_centre(drawn):
    """About an axis that is level, and across the end as drawn."""
    eye, begin = np.array([1.0, 0.4, 0.9]), Rotation.from_euler("xyz", drawn)
    _, turned, _ = at_rest(hung(tuple(eye.tolist()), orientation=list(drawn)))
    axis = np.cross(begin.apply(eye), (0.0, 0.0, 1.0))
    assert np.cross((turned * begin.inv()).as_rotvec(), axis) == pytest.approx(np.zeros(3), abs=1.0e-6)


@pytest.mark.parametrize(
    "mass, side, stiffness, eye, drawn",
    [
        (101.5, 0.874, (18782.0, 8162.0, 9242.0), (-0.2377, 0.9601, 1.3220), (-0.2561, 0.2484, 0.4206)),
        (840.7, 0.0293, (13902.0, 3429.0, 19653.0), (-1.2033, 0.9211, 0.7829), (0.3680, 0.0604, -0.3860)),
    ],
)
def test_a_load_between_springs_and_a_rope_rests_in_line_with_its_rope(mass, side, stiffness, eye, drawn):
    """On the way there the springs carry all of it, and the rope pulls with its own weight of 1e-5 of the load's."""
    rope = LIGHT | {"mass_per_length": 1.0e-4, "strain": "engineering"}
    held = body(
        "load", mass, (side, 0.0, 0.0), inertia=[mass, 0.8 * mass, 0.6 * mass], orientation=list(drawn),
        spring={"stiffness": list(stiffness)},
    )  # fmt: skip
    path = [TOP, end("load", offset=eye)]
    where, turned, _ = at_rest(crane(path, [held], rope, mesh={"elements_per_span": 1}, start="static"))
    line = np.array([0.0, 0.0, 10.0]) - where
    assert turned.apply(eye) == pytest.approx(np.linalg.norm(eye) * line / np.linalg.norm(line), abs=1.0e-4)
    assert where[2] == pytest.approx(0.0, abs=1.0e-6)
    assert stiffness[0] * (where[0] - side) == pytest.approx(mass * GRAVITY * line[0] / line[2], rel=1.0e-4)


def test_blocks_in_neutral_balance_are_not_let_run_away_because_one_of_them_could_turn():
    """Atwood's machine: 4 t on two falls against 2 t. What is unstable there is no turn, with `inertia` or without."""
    block, load_ = body("block", 2.0 * MASS, (0.2, 0.0, 2.0)), body("load", MASS, (1.3, 0.0, 2.0))
    path = [
        anchor((0.0, 0.0, 10.0)),
        {"sheave": {"name": "moving", "body": "block", "radius": 0.2, "axis": [0, 1, 0], "wrap": "under"}},
        sheave((1.0, 0.0, 10.0), 0.3, name="tip"),
        end("load", offset=(0.2, 0.0, 0.3)),
    ]
    for one in (load_, load_ | {"inertia": [9.0, 17.0, 15.0]}):
        rope = LIGHT | {"mass_per_length": 0.5}
        scene = crane(path, [block, one], rope, mesh={"elements_per_span": 1}, start="static")
        model = model_of(scene)
        state = new_state(model.system)
        model.settle(state)
        assert count_negative(model.system, state).negative == 1


def test_no_unknown_of_a_body_that_turns_is_called_a_place_or_material():
    layout = lay_out(parsed(hung((0.0, 0.0, 1.0))))
    assert {layout.degrees.names[layout.turn["load"] + k] for k in range(4)} == {"load: orientation"}


def test_a_release_that_leaves_more_below_the_centre_than_there_was_is_refused():
    drops = {"at": 0.5, "remaining": 100.0, "bottom": 3.0}
    with pytest.raises(SceneError, match=r"release\.bottom.*more than the whole body has, 0.5 m"):
        parsed(hung((0.0, 0.0, 1.0), ground=GROUND, bottom=0.5, release=drops))


def test_a_load_that_the_rope_lifts_off_the_deck_hangs_plumb():
    rope = {"length": 10.5}
    _, turned, _ = at_rest(hung((0.5, 0.0, 1.0), anchor((0.5, 0.0, 12.0)), rope, ground=GROUND, bottom=0.5))
    assert turned.apply((0.5, 0.0, 1.0))[:2] == pytest.approx([0.0, 0.0], abs=1.0e-6)


@pytest.mark.parametrize("length, told", [(11.01, 0), (10.99, 1), (10.5, 0)])
def test_a_load_that_a_short_rope_lets_stand_askew_on_the_deck_is_told(length, told):
    """The eye is 0.4 m beside the centre, 11.007 m from the anchor where it stands; it hangs from 10.92 m."""
    rope = {"length": length, "mass_per_length": 0.5}
    scene = hung((0.4, 0.0, 1.0), anchor((0.0, 0.0, 12.0)), rope, ground=GROUND, bottom=0.5, solver={"end": 0.02})
    result = ran(scene)
    words = set_down_askew(result, parsed(scene))
    assert len(words) == told and all("load begins on the ground, turned by" in text for text in words)


@pytest.mark.parametrize("eye, wind", [((0.0, 0.0, 1.0), 0.1), ((0.4, 0.0, 1.0), 0.0)])
def test_a_load_that_is_drawn_touching_the_deck_and_hangs_in_its_rope_is_not_told_to_stand_askew(eye, wind):
    """It hangs in line with its rope, turned by atan 0.1 or atan 0.4. Rounding of its height decided what was told.

    The rope carries all of it: sqrt(1 + wind^2) of its weight.
    """
    weight = MASS * float(np.linalg.norm(GRAVITY))
    height = GROUND["level"] + 0.5
    more = {"ground": GROUND, "bottom": 0.5, "force": [wind * weight, 0.0, 0.0], "solver": {"end": 0.01}}
    scene = hung(eye, anchor((0.0, 0.0, height + 12.0)), **more)
    result = ran(scene)
    assert result["tension"][0].max() == pytest.approx(np.hypot(1.0, wind) * weight, rel=1e-3)
    assert set_down_askew(result, parsed(scene)) == []


@pytest.mark.parametrize("depth, told", [(1.0e-6, 0), (1.0e-3, 1)])
def test_a_load_is_told_to_stand_askew_where_the_ground_carries_a_part_of_it(depth, told):
    """Ground of 1e7 N/m pushes with 10 N in 1 um, and with half the weight of 2 t in 1 mm."""
    scene = parsed(hung((0.4, 0.0, 1.0), anchor((0.0, 0.0, 12.0)), {"length": 12.0}, ground=GROUND, bottom=0.5))
    turned = {"body_turn": [[[np.cos(0.1), 0.0, np.sin(0.1), 0.0]]], "body_position": [[[0.0, 0.0, -depth]]]}
    assert len(set_down_askew(turned, scene)) == told
