"""Torque and drag from the statics of the string's beam, against closed forms, soft and stiff strings integrated apart.

The references are tests/references/soft_string.py and tests/references/stiff_string.py, which integrate along wells of
their own, and Mitchell's closed forms of a helix (test_helix.py). Measured: on the J-well 24, 48, 96 and 192 elements
are off the soft string, picking up with friction 0.2, by +2.9e-3, -9.4e-5, -1.1e-4 and -1.1e-4, the last being stretch
and clearance, which a soft string leaves out. Collars pulled out of a bend of 50 m in radius carry 2.8 % more than the
soft string says, and hold 2.8 % more when lowered; 25, 50 and 100 elements are off that by 5.8e-3, -9.0e-4 and 1.8e-5.
"""

import subprocess
import sys

import numpy as np
import pytest
from of_the_suite import studies
from physics.wells.statics.test_helix import CLEARANCE, DIAMETER, FRICTION, RIGIDITY, level, vertical
from physics.wells.statics.test_torque_drag_statics import DEPTH, SIGN, arc_load, build_section
from physics.wells.strings import (
    COLLAR,
    DATA,
    GRAVITY,
    JWELL,
    E,
    mass_per_length,
    shipped,
    soft_load,
    soft_torque,
    straight_hole,
)
from references.stiff_string import StiffString

from drillstring.scene.scene import BEAM, of_kind
from drillstring.statics.helix import helix_force
from drillstring.statics.soft_string import soft_string
from drillstring.statics.statics import Statics
from drillstring.statics.torque_drag import torque_drag
from tautline.integrators.linearise import evaluate
from tautline.integrators.state import new_state
from tautline.integrators.status import StoppedEarly
from tautline.kernels.matrix import new_matrix, sparse
from tautline.scene.errors import SceneError

W = mass_per_length() * GRAVITY


@pytest.fixture(scope="module")
def jwell():
    """The J-well as 48 elements."""
    return Statics(shipped("jwell", model__kind=BEAM), JWELL.length, 48)


# against the soft string and closed forms
@pytest.mark.parametrize("friction", [*studies(0.2), 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off", "rotating"])
def test_hook_load_of_the_jwell_is_the_soft_strings_within_0_03_percent_at_48_elements(jwell, direction, friction):
    profile = jwell.solve(friction, direction)
    assert profile.hook_load == pytest.approx(soft_load(friction, direction), rel=3e-4)
    assert profile.measured_depth[-1] == pytest.approx(JWELL.length, abs=1e-6)
    if direction == "rotating":
        assert profile.surface_torque == pytest.approx(soft_torque(friction), rel=5e-3)
        assert profile.torque[0] == pytest.approx(profile.surface_torque, rel=1e-9)


@pytest.mark.parametrize("friction", [0.2, 0.3])
@pytest.mark.parametrize("direction", ["pick_up", "slack_off"])
def test_hook_load_over_an_arc_is_the_closed_form_within_0_04_percent_at_50_elements(direction, friction):
    profile = Statics(build_section(model__kind=BEAM), DEPTH, 50).solve(friction, direction)
    assert profile.hook_load == pytest.approx(arc_load(friction, direction), rel=4e-4)


def test_strokes_that_move_the_bit_are_those_of_the_soft_string_within_half_a_percent():
    # tests/references/soft_string.py with the clearance: 0.394004 m up, 0.433944 m down with friction 0.2
    (case,) = torque_drag(shipped("jwell", model__kind=BEAM), elements=48)
    assert case.model == BEAM and case.failures == []
    assert case.points[0].strokes[:2] == pytest.approx((0.394004, 0.433944), rel=5e-3)


def test_beam_that_turns_lies_up_the_wall_by_the_angle_of_friction():
    scene = straight_hole(1.0, length=1000.0, elements=10, diameter=0.1652, friction=0.3, model__kind=BEAM)
    statics = Statics(scene, 1000.0, 10)
    still, turning = statics.solve(0.0, "rotating"), statics.solve(0.3, "rotating")
    assert turning.side_force == pytest.approx(still.side_force / np.hypot(1.0, 0.3), rel=2e-5)
    force = turning.side_force @ statics.string.tributary
    assert turning.surface_torque == pytest.approx(0.3 * 0.5 * COLLAR[0] * force, rel=1e-9)
    # The drive carries part of the first quarter of an element, the wall all the rest.
    whole = W * 1000.0 * np.sin(1.0) / np.hypot(1.0, 0.3)
    assert (1.0 - 0.25 / 10) * whole < force < whole


def test_pipe_of_a_stand_above_the_table_hangs_on_the_hook_and_rubs_nowhere():
    scene = shipped("jwell", model__kind=BEAM)
    plain, stood = Statics(scene, 3700.0, 48), Statics(scene, 3700.0, 48, above=28.0)
    for direction in ("pick_up", "slack_off"):
        one, other = plain.solve(0.2, direction), stood.solve(0.2, direction)
        assert other.hook_load - one.hook_load == pytest.approx(plain.weight[0] * 28.0, rel=2e-2)
        assert other.measured_depth[-1] == pytest.approx(3700.0, abs=1e-6) and other.measured_depth[0] < 0.0


# stiffness
@pytest.fixture(scope="module")
def bend():
    """Collars through a bend of 60 degrees and 50 m in radius: the scene, and the stiff string in its plane."""
    radius, wall, hold, tail = 50.0, 1e5, 200.0, 100.0
    arc = radius * np.deg2rad(60.0)
    length = hold + arc + tail
    sections = [{"hold": hold}, {"build": {"radius": radius, "to": "60 deg", "azimuth": 0.0}}, {"hold": tail}]
    scene = straight_hole(
        0.0, length=float(length), elements=100, diameter=0.2, friction=0.3, model__kind=BEAM, model__bending="stiff",
        well__sections=sections, well__wall__stiffness=float(wall * length / 100), string__0__length="rest",
    )  # fmt: skip
    rigidity = E * np.pi / 64 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    pieces = [(hold, 0.0), (arc, 1.0 / radius), (tail, 0.0)]
    return scene, StiffString(pieces, rigidity, W, 0.5 * (0.2 - COLLAR[0]), wall), float(length)


@pytest.mark.parametrize("direction", ["pick_up", *studies("slack_off")])
def test_collars_in_a_sharp_bend_carry_the_load_of_a_stiff_string_and_not_of_a_soft_one(bend, direction):
    scene, stiff, length = bend
    depth, values = stiff.solve(0.3, SIGN[direction])
    exact = values[4, 0]
    statics = Statics(scene, length, 100)
    found = statics.solve(0.3, direction)
    assert found.hook_load == pytest.approx(exact, rel=2e-4)
    soft = soft_string(statics.well, statics.tubes, statics.weight, 0.3, direction).hook_load
    assert SIGN[direction] * (exact / soft - 1.0) > 0.025
    # In the middle of the arc, away from its ends, curvature is constant and the stiff string presses as a soft one.
    middle = (found.measured_depth > 220.0) & (found.measured_depth < 232.0)
    wall = np.interp(found.measured_depth[middle], depth, np.abs(stiff.wall_force(values[0])))
    assert found.side_force[middle].mean() == pytest.approx(wall.mean(), rel=2e-2)
    coarse = [abs(Statics(scene, length, n).solve(0.3, direction).hook_load / exact - 1.0) for n in (25, 50)]
    assert coarse[0] > 1.5 * coarse[1] > 3.0 * abs(found.hook_load / exact - 1.0)


# pushed strings
@pytest.mark.parametrize("bending", ["stiff", "none"])
@pytest.mark.parametrize(
    ("inclination", "force", "length", "exact"),
    [(0.5 * np.pi, 1.2e6, 300.0, level(1.2e6, 300.0)), (0.0, 5e5, 200.0, vertical(5e5, 200.0))],
    ids=["level", "vertical"],
)
def test_force_that_pushes_a_helix_is_that_of_mitchells_closed_form(inclination, force, length, exact, bending):
    # measured at 20, 50, 100 elements, with bending and without: level 3.1e-5, 4.9e-6, 1.2e-6, vertical 1.1e-5, 1.8e-6,
    # 4.4e-7; lumps 3e-3 at 100
    scene = straight_hole(
        inclination, length=length, elements=20, diameter=DIAMETER, friction=FRICTION, bit={"force": -force},
        model__kind=BEAM, model__bending=bending,
    )  # fmt: skip
    found = Statics(scene, length, 20).solve(FRICTION, "slack_off")
    assert -found.hook_load == pytest.approx(exact, rel=5e-5)
    pressed = helix_force(-found.tension[10], CLEARANCE, RIGIDITY)
    assert found.side_force[20:22] == pytest.approx(pressed, rel=1e-3)


def test_beam_that_is_slid_into_a_level_well_with_much_friction_buckles_where_lumps_do():
    (case,) = torque_drag(shipped("jwell", model__kind=BEAM), [0.5], elements=50)
    (point,) = case.points
    assert point.hook_load("slack_off") == pytest.approx(point.soft["slack_off"].hook_load, rel=5e-3)
    ((top, bottom),) = point.buckled("slack_off", "helical")
    assert 1850.0 < top < 2050.0 and 2150.0 < bottom < 2350.0


def test_beam_whose_helix_outgrows_any_force_locks_up():
    scene = shipped("jwell", model__kind=BEAM, bit={"force": "-200 kN"})
    (case,) = torque_drag(scene, [0.4], elements=48)
    (point,) = case.points
    assert point.locked and 0.0 < point.locks["slack_off"] < 2200.0
    assert case.hook_loads("pick_up") == pytest.approx(case.soft_hook_loads("pick_up"), rel=2e-3)


# the system
@pytest.mark.parametrize("direction", ["slack_off", "rotating"])
def test_tangent_of_a_braced_beam_is_the_difference_of_its_residual(direction):
    scene = straight_hole(
        1.2, length=100.0, elements=3, diameter=0.3, friction=0.3, bit={"force": -4e5}, model__kind=BEAM,
        model__bending="stiff",
    )  # fmt: skip
    statics = Statics(scene, 100.0, 3)
    statics.solve(0.3, direction)
    assert (statics.string.braces.springs.stiffness > 0.0).all()
    system, state = statics.system, new_state(statics.system)
    random = np.random.default_rng(5)
    state.q[:] = statics.free[0] + 1e-3 * random.standard_normal(system.size)
    x = random.uniform(-1.0, 1.0, system.size)
    matrix, ends = new_matrix(system.size, system.bandwidth, system.border), np.zeros((2, system.size))
    evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, matrix, ends[0])
    slope, q = sparse(matrix) @ x, state.q.copy()
    for end, sign in zip(ends, (1.0, -1.0), strict=True):
        state.q[:] = q + sign * 1e-7 * x
        evaluate(system, state, 0.0, 1.0, True, 0.0, 0.0, 1.0, matrix, end)
    assert (ends[0] - ends[1]) / 2e-7 == pytest.approx(slope, abs=1e-5 * np.abs(slope).max())


def test_string_that_is_folded_up_is_no_equilibrium(jwell):
    jwell.solve(0.2, "pick_up")
    state = new_state(jwell.system)
    jwell._check(state)
    folded = state.full_q.copy()
    folded[8 * 10 : 8 * 10 + 3] = folded[8 * 12 : 8 * 12 + 3]
    with pytest.raises(StoppedEarly, match="the string at"):
        jwell._check(state._replace(full_q=folded))


def test_soft_bending_is_refused_for_a_beam_by_its_key():
    with pytest.raises(SceneError, match="a beam has its stiffness"):
        of_kind(shipped("jwell", model__bending="soft"), BEAM)


def test_statics_of_lumps_import_none_of_the_beams_code():
    said = (
        "import sys; from drillstring.scene.scene import read; from drillstring.statics.torque_drag import Statics;"
        f"Statics(read({str(DATA / 'jwell.yaml')!r}), 3770.0, 4);"
        "print([m for m in sys.modules if 'beam' in m or m.startswith('tautline.elements.beam.bending')])"
    )
    done = subprocess.run([sys.executable, "-c", said], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
