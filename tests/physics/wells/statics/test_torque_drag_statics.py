"""Torque and drag from the statics of the lumped model, against closed forms, the soft string and a slow pull.

The references are not the code's own soft string (apps/drillstring/statics/soft_string.py) but
tests/references/soft_string.py, which integrates with scipy along a well of its own, and closed forms. In an arc of
radius R in a vertical plane, with a the inclination and m = mu on the high side of the hole (T > w R sin a), pulled up,

    dT/da = -w R cos a - m (T - w R sin a),    T = w R [(m^2 - 1) sin a - 2 m cos a]/(1 + m^2) + C exp(-m a),

and m changes its sign on the low side and when lowered (`arc_tension`). The lump in the drive has no wall: a well that
begins with a curve or a slant would lack half a lump's friction there, so the arc hangs under a straight piece. Stretch
and clearance, which the closed form leaves out, are 2e-4 of the hook load there: a stiff string in a narrow hole shows
how the error falls with the number of lumps: (pick up, slack off) at n = 12, 25, 50, 100: 0.2: -1.6e-3 -1.9e-3, -6.0e-4
-3.4e-4, -1.6e-4 -1.1e-4, -6.3e-5 +0.3e-5; 0.3: -2.9e-3 -2.6e-3, -3.4e-4 -2.0e-4, -1.4e-4 -0.9e-4, -8.7e-5 -0.4e-5. What
is left with very many is 5e-5 of either sign.
"""

import numpy as np
import pytest
from of_the_suite import studies
from physics.wells.statics.test_torque_and_drag import moved
from physics.wells.strings import DATA, GRAVITY, JWELL, mass_per_length, shipped, soft_load, soft_torque, straight_hole
from references import soft_string as reference

from drillstring.scene.scene import DrillstringScene
from drillstring.statics import soft_string as integral
from drillstring.statics.motion import Motion
from drillstring.statics.soft_string import KEPT, StringInHole, soft_string
from drillstring.statics.statics import Statics
from drillstring.statics.torque_drag import torque_drag
from drillstring.string.buckling import limits
from drillstring.string.factors import Factors
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import new_state
from tautline.kernels.matrix import new_matrix, sparse
from tautline.scene.errors import SceneError

W = mass_per_length() * GRAVITY
RADIUS, ABOVE = 1000.0, 300.0
DEPTH = ABOVE + 0.5 * np.pi * RADIUS
SIGN = {"pick_up": 1.0, "slack_off": -1.0}
SOFT = {"model__bending": "soft"}


def build_section(**changes):
    """A collar in an arc of 90 degrees under a straight piece."""
    arc = [{"hold": ABOVE}, {"build": {"radius": RADIUS, "to": "90 deg", "azimuth": 0.0}}]
    changes = {"diameter": 0.2, "well__sections": arc, "string__0__length": "rest"} | changes
    return straight_hole(0.0, elements=50, friction=0.2, **changes)


def arc_load(friction, direction):
    """Closed form: arc, then straight."""
    return ABOVE * W + reference.arc_tension(0.5 * np.pi, 0.0, 0.0, W, RADIUS, friction, direction)


# hook load
@pytest.mark.parametrize("inclination", [0.3, 1.0])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_hook_load_in_a_slant_hole_is_the_closed_form_to_a_millionth(direction, inclination):
    # the hole is hardly wider than the pipe: the lump in the drive stands on the axis, and the others off it
    n, length, friction = 10, 1000.0, 0.3
    scene = straight_hole(inclination, length=length, elements=n, diameter=0.1652, friction=friction)
    (case,) = torque_drag(scene, elements=n)
    weight = np.full(n + 1, W * length / n)
    weight[[0, -1]] *= 0.5
    touching = weight[1:].sum() * np.sin(inclination)
    exact = weight.sum() * np.cos(inclination) + SIGN[direction] * friction * touching
    assert case.hook_loads(direction)[0] == pytest.approx(exact, rel=1e-6)
    # the soft string, all of which touches
    whole = reference.slant_hook_load(W, length, inclination, friction, direction)
    assert case.soft_hook_loads(direction)[0] == pytest.approx(whole, rel=1e-12)


@pytest.mark.parametrize("friction", [0.2, 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_hook_load_over_an_arc_is_the_closed_form_within_0_3_percent_at_50_lumps(direction, friction):
    profile = Statics(build_section(), DEPTH, 50).solve(friction, direction)
    assert profile.hook_load == pytest.approx(arc_load(friction, direction), rel=3e-3)


@pytest.mark.parametrize("friction", [0.2, 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_error_over_an_arc_falls_with_the_number_of_lumps(direction, friction):
    stiff = build_section(diameter=0.17, material__youngs_modulus=2e14)
    errors = [
        abs(Statics(stiff, DEPTH, n).solve(friction, direction).hook_load / arc_load(friction, direction) - 1.0)
        for n in (12, 25, 50)
    ]
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2]


@pytest.mark.parametrize("friction", [0.2, 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_soft_string_over_an_arc_is_the_closed_form_to_two_millionths(direction, friction):
    statics = Statics(build_section(), DEPTH, 2)
    found = soft_string(statics.well, statics.tubes, statics.weight, friction, direction)
    assert found.hook_load == pytest.approx(arc_load(friction, direction), rel=2e-6)


@pytest.fixture(scope="module")
def jwell():
    """The J-well's statics at 50 lumps, soft bending."""
    return Statics(shipped("jwell", **SOFT), JWELL.length, 50)


@pytest.mark.parametrize("friction", [0.2, 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off", "rotating"])
def test_hook_load_of_the_jwell_is_the_soft_strings_within_0_3_percent(jwell, direction, friction):
    exact = soft_load(friction, direction)
    assert jwell.solve(friction, direction).hook_load == pytest.approx(exact, rel=3e-3)
    ours = soft_string(jwell.well, jwell.tubes, jwell.weight, friction, direction)
    assert ours.hook_load == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_statics_give_the_hook_load_of_a_slow_move_within_0_1_percent(jwell, direction):
    result, near = moved(direction, 0.2, 50)
    assert jwell.solve(0.2, direction).hook_load == pytest.approx(result["hook_load"][near].mean(), rel=1e-3)


def test_friction_is_all_of_coulombs_and_tension_balances_it_lump_by_lump(jwell):
    # along a straight vertical hole the difference of tensions is the weight: no side force but that of the curve
    profile = jwell.solve(0.3, "pick_up")
    vertical = profile.measured_depth[1:-1] < 2100.0
    weight = np.array(jwell.model.coordinates["buoyed_weight"][1])[1:-1]
    assert -np.diff(profile.tension)[vertical] == pytest.approx(weight[vertical], rel=1e-3)
    free = jwell.solve(0.0, "pick_up")
    assert (np.diff(profile.tension) - np.diff(free.tension) < 1.0).all(), "friction pulls down the hole everywhere"


def test_bit_is_at_its_depth_under_every_friction(jwell):
    for direction in ("pick_up", "slack_off", "rotating"):
        assert jwell.solve(0.3, direction).measured_depth[-1] == pytest.approx(JWELL.length, abs=1e-6)


# torque
@pytest.mark.parametrize("friction", [0.2, 0.3])
def test_rotating_torque_is_the_soft_strings_after_climbing_the_wall_within_half_a_percent(friction):
    profile = Statics(shipped("jwell", **SOFT), JWELL.length, 100).solve(friction, "rotating")
    exact = soft_torque(friction)
    assert profile.surface_torque == pytest.approx(exact, rel=5e-3)
    assert abs(profile.surface_torque / soft_torque(friction, climbing=False) - 1) > 0.01
    # summed up the string: the top link passes all of it down, and the bit feels none
    assert profile.torque[0] == pytest.approx(profile.surface_torque, rel=1e-9)
    assert (np.diff(profile.torque) < 1e-6).all()


def test_turning_pipe_lies_up_the_wall_by_the_angle_of_friction():
    scene = straight_hole(1.0, length=1000.0, elements=10, diameter=0.1652, friction=0.3)
    statics = Statics(scene, 1000.0, 10)
    still, turning = statics.solve(0.0, "rotating"), statics.solve(0.3, "rotating")
    assert turning.side_force[1:] == pytest.approx(still.side_force[1:] / np.hypot(1.0, 0.3), rel=1e-5)
    assert turning.hook_load == pytest.approx(still.hook_load, rel=1e-9)


# the law of friction
@pytest.mark.parametrize("direction", ["pick_up", "rotating"])
def test_tangent_is_the_difference_of_the_residual_with_friction_in_a_direction(jwell, direction):
    jwell.solve(0.3, direction)  # sets the direction and the factor
    system, state = jwell.system, new_state(jwell.system)
    state.q[:] = jwell.free[0]
    random = np.random.default_rng(2)
    x = random.uniform(-1.0, 1.0, system.size)
    matrix, none = new_matrix(system.size, system.bandwidth, system.border), np.zeros(system.size)
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, matrix, none)
    tangent, q = sparse(matrix), state.q.copy()
    ends = [np.zeros(system.size) for _ in range(2)]
    step = 1e-7
    for end, sign in zip(ends, (1.0, -1.0), strict=True):
        state.q[:] = q + sign * step * x
        evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, matrix, end)
    difference = (ends[0] - ends[1]) / (2.0 * step)
    assert difference == pytest.approx(tangent @ x, abs=1e-5 * np.abs(tangent @ x).max())
    whole = tangent.toarray()
    assert np.abs(whole - whole.T).max() > 1e-3 * np.abs(whole).max(), "friction makes it non-symmetric"


# buckling
def at(curvature, turn, down):
    """EI = 1.2e6 N m^2, w = 240 N/m, r = 0.04 m, so that 4 EI / r = 1.2e8 N m."""
    found = limits(*(np.array([x]) for x in (1.2e6, 0.04, 240.0, down, turn, curvature)))
    return float(found.sinusoidal[0]), float(found.helical[0])


def test_straight_hole_at_60_degrees_buckles_at_dawson_and_paslays_load():
    # 2 sqrt(1.2e6 * 240 * 0.8660254 / 0.04) = 2 * 78964.4 N; the helix needs sqrt(2) times as much
    assert at(0.0, 0.0, 0.5) == pytest.approx((157928.9, 223345.2), rel=1e-6)


def test_building_hole_holds_more_and_dropping_hole_less_after_he_and_kyllingstad():
    # level, k = 1/1000: F^2 = 1.2e8 (0.24 +- F/1000 ...) -> F = (+-1.2e5 + sqrt(1.44e10 + 1.152e11))/2
    assert at(1e-3, -1e-3, 0.0)[0] == pytest.approx(240e3, rel=1e-9)
    assert at(1e-3, 1e-3, 0.0)[0] == pytest.approx(120e3, rel=1e-9)
    # F^2 = 2.4e8 (240 +- F/1000)
    root = np.sqrt(5.76e10 + 4 * 2.4e8 * 240)
    assert at(1e-3, -1e-3, 0.0)[1] == pytest.approx((2.4e5 + root) / 2, rel=1e-9)


def test_level_turn_adds_its_side_force_at_right_angles():
    # F^2 = 1.2e8 sqrt((F/1000)^2 + 240^2), F^2 = x: x^2 - 1.44e10 x - 8.2944e20 = 0
    x = (1.44e10 + np.sqrt(1.44e10**2 + 4 * 1.44e16 * 240**2)) / 2
    assert at(1e-3, 0.0, 0.0)[0] == pytest.approx(np.sqrt(x), rel=1e-9)


def test_vertical_hole_holds_by_the_strings_own_weight():
    # (1.2e6 * 240^2)^(1/3) = 4104.0 N
    assert at(0.0, 0.0, 1.0) == pytest.approx((2.55 * 4104.0, 5.55 * 4104.0), rel=1e-4)


def test_string_that_is_slid_into_a_level_well_with_much_friction_buckles_above_the_curve():
    jwell = shipped("jwell")
    loose, tight = torque_drag(jwell, [0.2, 0.5], elements=50)
    assert not loose.points[0].locked and loose.points[0].buckled("slack_off", "sinusoidal") == []
    ((top, bottom),) = tight.points[0].buckled("slack_off", "helical")
    # the soft string is in compression beyond what the vertical hole holds, over the same stretch
    soft = tight.points[0].soft["slack_off"]
    held = tight.points[0].limits.helical[0]
    marked = soft.measured_depth[(-soft.tension > held) & (soft.measured_depth < 2200.0)]
    assert top == pytest.approx(marked.min(), abs=80.0) and 2150.0 < bottom < 2350.0
    # its weight above still lowers it: lock-up is in test_helix.py
    assert not tight.points[0].locked and tight.points[0].hook_load("slack_off") > 0.0


# wells in space
TURN = np.deg2rad(2.0) / 30.0
STEEP = np.deg2rad(60.0)


def helix_inclination(s):
    """Vertical to 300 m, then a build to 60 degrees at 900 m."""
    return STEEP * np.clip((s - 300.0) / 600.0, 0.0, 1.0)


def helix_azimuth(s):
    """Below 900 m the hole turns by 2 degrees in 30 m at the same inclination: a helix."""
    return TURN * max(0.0, s - 900.0)


@pytest.fixture(scope="module")
def helix(tmp_path_factory):
    """Pipe in a helix that was surveyed every 10 m."""
    folder = tmp_path_factory.mktemp("helix")
    rows = [f"{s},{helix_inclination(s)},{helix_azimuth(s)}" for s in np.arange(0.0, 2401.0, 10.0)]
    (folder / "helix.csv").write_text("\n".join(["md [m],inc [rad],azi [rad]", *rows]), encoding="utf8")
    text = (DATA / "iscwsa.yaml").read_text(encoding="utf8")
    text = text.replace("iscwsa_reference.csv", "helix.csv").replace("bending: stiff", "bending: soft")
    (folder / "helix.yaml").write_text(text, encoding="utf8")
    return DrillstringScene.read(folder / "helix.yaml")


@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_hook_load_in_a_helix_comes_near_that_of_its_differential_equation_as_lumps_grow_in_number(helix, direction):
    # measured at n = 25, 50, 100, 200: pick up -1.8e-2, -9.1e-3, -5.3e-3, -3.0e-3, slack off 5.0e-3, 3.4e-3, 2.1e-3,
    # 1.5e-3. Of first order: where the build ends at 900 m the string passes from the high side to the low, and the
    # lump there has the mean of the two side forces, not the sum of their sizes
    string = reference.String([(2160.0, 0.127, 0.1086), (240.0, 0.165, 0.0572)], mud=1200.0)
    well = reference.well_from_angles(helix_inclination, helix_azimuth, 2400.0, (300.0, 900.0))
    exact = reference.hook_load(well, string, 0.3, direction)
    errors = []
    for elements in (25, 50, 200):
        statics = Statics(helix, 2400.0, elements)
        errors.append(abs(statics.solve(0.3, direction).hook_load / exact - 1.0))
    assert errors[0] > 1.3 * errors[1] > 2.6 * errors[2]
    assert errors[1] < 1e-2 and errors[2] < 4e-3
    ours = soft_string(statics.well, statics.tubes, statics.weight, 0.3, direction)
    assert ours.hook_load == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize("direction", ["pick_up", *studies("slack_off")])
def test_hook_load_in_the_surveyed_well_is_the_soft_strings_within_0_3_percent(direction):
    # measured at n = 25, 50, 100, 200: pick up -8.9e-4, +4.8e-4, -1.3e-4, -1.3e-4, slack off -6.5e-4, +1.3e-3, +1.3e-4,
    # +1.0e-4
    md, inc, azi = np.genfromtxt(DATA / "iscwsa_reference.csv", delimiter=",")[1:, :3].T
    well = reference.well_from_survey(md, np.deg2rad(inc), np.deg2rad(azi))
    string = reference.String([(md[-1] - 240.0, 0.127, 0.1086), (240.0, 0.165, 0.0572)], mud=1200.0)
    exact = reference.hook_load(well, string, 0.2, direction)
    statics = Statics(shipped("iscwsa", **SOFT), md[-1], 50)
    assert statics.solve(0.2, direction).hook_load == pytest.approx(exact, rel=3e-3)
    ours = soft_string(statics.well, statics.tubes, statics.weight, 0.2, direction)
    assert ours.hook_load == pytest.approx(exact, rel=1e-6)


# scenes
def test_survey_well_gives_what_the_soft_string_does_with_bending_and_clearance():
    scene = shipped("iscwsa")
    (case,) = torque_drag(scene, [0.2], [2000.0, 2940.0], elements=100)
    assert case.failures == []
    for direction in ("pick_up", "slack_off", "rotating"):
        assert case.hook_loads(direction) == pytest.approx(case.soft_hook_loads(direction), rel=2e-3)
    assert case.torques == pytest.approx(case.soft_torques, rel=5e-3)


def test_string_without_a_rest_is_shortened_at_its_top():
    scene = straight_hole(0.0, length=1000.0, elements=10)
    (case,) = torque_drag(scene, [0.0], [200.0, 700.0, 1000.0], elements=10)
    assert case.hook_loads("pick_up") == pytest.approx(W * np.array([200.0, 700.0, 1000.0]), rel=1e-9)


def test_scene_without_a_wall_and_depths_without_room_are_refused():
    with pytest.raises(SceneError, match=r"well\.wall.*no friction"):
        torque_drag(free_space())
    with pytest.raises(SceneError, match="below the end of the well"):
        torque_drag(shipped("jwell"), depths=[4000.0])
    with pytest.raises(SceneError, match=r"nothing is left of drill pipe.*give depths of more than 240 m"):
        torque_drag(shipped("jwell"), depths=[240.0])


def free_space() -> DrillstringScene:
    """A string without a wall."""
    return straight_hole(0.0, well__wall="none")


# what a string in its hole keeps
def test_what_is_kept_is_not_taken_for_another_friction_motion_force_casing_or_well(jwell):
    arc = Statics(build_section(), DEPTH, 2)
    strings = {one: StringInHole(one.well, one.tubes, one.weight, 0.25) for one in (jwell, arc)}
    first = {"friction": Factors(0.3, 0.2, 900.0), "motion": "slack_off", "bit_force": -3e5, "crosses": True}
    others = {
        "friction": (0.2, 0.3, 0.0, Factors(0.2, 0.2, 900.0), Factors(0.3, 0.1, 900.0), Factors(0.3, 0.2, 400.0)),
        "motion": ("pick_up", "rotating", Motion(-0.2, 8.0), Motion(0.2, 8.0)),
        "bit_force": (0.0, -4e5),
        "crosses": (False,),
    }
    for name, value in ((name, value) for name, values in others.items() for value in values):
        # the other one right behind the first, of one well behind the other
        for asked in (first, first | {name: value}):
            for one, string in strings.items():
                ours = string.solved(**asked)
                anew = soft_string(one.well, one.tubes, one.weight, hole=0.25, **asked)
                for field in ("measured_depth", "tension", "torque", "side_force"):
                    np.testing.assert_array_equal(getattr(ours, field), getattr(anew, field), f"{name} {value}")
                assert ours.locked == anew.locked
                assert ours.measured_depth[-1] == pytest.approx(one.depth), "its own well"


def test_a_string_that_is_solved_for_another_friction_integrates_once_and_for_the_same_not_at_all(monkeypatch):
    done, whole = [], integral._integrate
    monkeypatch.setattr(integral, "_integrate", lambda *given: done.append(given) or whole(*given))
    statics = Statics(build_section(), DEPTH, 10)
    statics.solve(0.2, "pick_up")
    # with friction, and without, where every search starts
    assert len(done) == 2
    statics.solve(0.3, "slack_off")
    assert len(done) == 3
    statics.solve(0.3, "slack_off")
    statics.solve(0.0, "rotating")
    assert len(done) == 3


def test_what_is_kept_cannot_be_written_to_and_is_a_few_solutions_at_most(jwell):
    string = StringInHole(jwell.well, jwell.tubes, jwell.weight, 0.25)
    first = string.solved(0.2, "pick_up")
    assert string.solved(0.2, "pick_up") is first
    for values in first[:4]:
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 0.0
    for k in range(KEPT):
        string.solved(0.21 + 0.01 * k, "pick_up")
    assert string.solved(0.2, "pick_up") is not first
