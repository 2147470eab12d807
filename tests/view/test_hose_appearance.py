"""What a hose looks like: its cubic, the water's marks that move with the flow, what holds it, the path of its tip."""

import numpy as np
import pytest
from figures.synthetic_hose import LENGTH, result
from scipy.interpolate import CubicHermiteSpline

from gardenhose.view.appearance import JUMP, MARKS, appearance
from tautline.results.errors import ResultError
from tautline.results.store import Store
from tautline.view.space.appearance import Look, placed

SCENE = """
hose:
  length: 0.5
  elements: 10
  axial_stiffness: 10.0
  bending_stiffness: 0.00108
  mass_per_length: 0.003
  {more}
water: {{mass_per_length: 0.0008, speed: 10}}
solver: {{step: 1 ms, end: 1 s}}
output: {{interval: 5 ms}}
"""
TWO_BORES = """
hose:
  segments:
    - {length: 0.25, elements: 5, axial_stiffness: 10, bending_stiffness: 0.001, mass_per_length: 0.003}
    - {length: 0.25, elements: 5, axial_stiffness: 10, bending_stiffness: 0.001, mass_per_length: 0.003,
       water_mass_per_length: 0.0004}
water: {mass_per_length: 0.0008, speed: 10}
solver: {step: 1 ms, end: 1 s}
output: {interval: 5 ms}
"""


def told(scene, path=None, flow=None, **made):
    """A made-up result that carries a scene, and a flow of its own."""
    plain = result(**made)
    values = {v.name: plain[v.name] for v in plain.variables.values() if v.dims[0] == "time"}
    variables = [plain.variables[name] for name in values]
    if flow is not None:
        values["flow_speed"] = flow(plain.time)
    coordinates = {
        v.name: (v.dims, plain[v.name], v.units, v.long_name)
        for v in plain.variables.values()
        if v.dims[0] != "time"
    }  # fmt: skip
    with Store(path, variables, coordinates, plain.attributes | {"scene": scene}) as store:
        store.append(values)
        return store.finish()


def marks(seen):
    return [solid for solid in seen.solids if solid.name.startswith("water")]


def along(seen, made, frame):
    """Distance along the hose, m, of each mark at a frame: of the nearest of many points of the cubic."""
    s = np.linspace(0.0, LENGTH, 20_001)
    curve = CubicHermiteSpline(made["arc_length"], made["position"][frame], made["slope"][frame])(s)
    places = np.array([mark.pose(frame)[:3, 3] for mark in marks(seen)])
    apart = np.linalg.norm(curve - places[:, None], axis=-1)
    assert apart.min(axis=1).max() < 2e-5
    return s[apart.argmin(axis=1)]


def around(distance, turn=LENGTH / MARKS):
    """What is left of distances when whole turns are taken off, between minus and plus half a turn."""
    return (distance + 0.5 * turn) % turn - 0.5 * turn


def test_the_hose_is_the_elements_own_cubic_with_their_curvature():
    made = result(frames=101)
    hose = appearance(made, Look()).lines[0]
    steps = (len(hose.points(0)) - 1) // 10
    s = np.linspace(0.0, LENGTH, 10 * steps + 1)
    curve = CubicHermiteSpline(made["arc_length"], made["position"][77], made["slope"][77])
    np.testing.assert_allclose(hose.points(77), curve(s), atol=1e-14)
    np.testing.assert_array_equal(hose.points(77)[hose.nodes], made["position"][77])
    first, second = curve(s, 1), curve(s, 2)
    expected = np.linalg.norm(np.cross(first, second), axis=-1) / np.linalg.norm(first, axis=-1) ** 3
    between = np.setdiff1d(np.arange(len(s)), hose.nodes)
    np.testing.assert_allclose(hose.quantities[1].values(77)[between], expected[between], rtol=1e-9)
    assert [q.name for q in hose.quantities] == ["axial_force", "curvature", "speed"]
    np.testing.assert_allclose(hose.quantities[0].values(77)[steps // 2 :: steps], made["axial_force"][77])
    np.testing.assert_allclose(hose.quantities[2].values(77)[hose.nodes], np.linalg.norm(made["velocity"][77], axis=-1))


def test_marks_move_with_the_water_where_that_is_slow_enough():
    """At 1 m/s they go 5 mm from frame to frame, a tenth of their spacing; in 60 frames six spacings."""
    made = result(frames=61, speed=1.0, ramp=0.0)
    seen = appearance(made, Look())
    spacing = LENGTH / MARKS
    for frame in (0, 1, 7, 60):
        there = along(seen, made, frame)
        np.testing.assert_allclose(around(there - 1.0 * made.time[frame]), 0.0, atol=5e-5)
        np.testing.assert_allclose(np.diff(np.sort(there)), spacing, atol=5e-5)
    assert "marks move with the water" in seen.notes


def test_marks_that_would_jump_are_slowed_by_a_round_factor_and_the_note_says_so():
    """At 35 m/s and 5 ms they would go 0.175 m, 3.5 of their spacings: ten times too far, so twenty is the factor."""
    made = result(frames=101, speed=35.0, ramp=0.1)
    seen = appearance(made, Look())
    assert any("20 times more slowly" in note for note in seen.notes)
    spacing = LENGTH / MARKS
    for before, after in ((3, 4), (50, 51), (80, 81)):
        moved = around(along(seen, made, after) - along(seen, made, before))
        water = 0.5 * (made["flow_speed"][before] + made["flow_speed"][after]) * 0.005
        np.testing.assert_allclose(moved, water / 20.0, atol=6e-5)
        assert water / 20.0 <= JUMP * spacing


def test_marks_turn_round_with_the_flow_and_point_its_way():
    made = told(SCENE.format(more=""), frames=41, flow=lambda t: np.where(t < 0.1, 1.0, -1.0))
    seen = appearance(made, Look())
    out, back = (np.array([mark.pose(frame)[:3, 2] for mark in marks(seen)]) for frame in (5, 35))
    assert np.all(out[:, 0] > 0.0) and np.all(back[:, 0] < 0.0)
    moved = around(along(seen, made, 35) - along(seen, made, 34))
    np.testing.assert_allclose(moved, -0.005, atol=6e-5)


def test_water_is_twice_as_fast_where_half_as_much_fills_the_hose():
    made = told(TWO_BORES, frames=41, flow=lambda t: np.full_like(t, 0.5))
    before, after = (np.sort(along(appearance(made, Look()), made, frame)) for frame in (10, 11))
    moved = after - before
    inside = (before < 0.23) | (before > 0.255)
    kept = inside & (np.abs(moved) < 0.02)
    assert kept.sum() >= MARKS - 2
    np.testing.assert_allclose(moved[kept], 0.005 * np.where(before[kept] < 0.25, 0.5, 1.0), atol=6e-5)


def test_without_flow_there_are_no_marks():
    seen = appearance(result(frames=21, speed=0.0), Look())
    assert not marks(seen) and not any("water" in note for note in seen.notes)


def test_a_clamped_root_is_a_plate_behind_it_and_a_mass_at_the_tip_a_ball():
    made = told(SCENE.format(more="tip_mass: 10 g"), frames=41)
    seen = appearance(made, Look())
    solids = {solid.name: solid for solid in seen.solids}
    plate = solids["supports"].points
    assert np.isclose(plate[:, 0].max(), 0.0, atol=1e-12) and plate[:, 0].min() > -0.05
    assert np.ptp(plate[:, 1]) > 3.0 * np.ptp(plate[:, 0]) and solids["supports"].pose is None
    np.testing.assert_allclose(solids["tip mass"].pose(33)[:3, 3], made["tip"][33], atol=1e-14)
    assert any("tip" in note for note in seen.notes)


def test_a_free_tip_tells_where_it_is_and_how_fast_it_and_the_water_are():
    made = told(SCENE.format(more=""), frames=41)
    tip = next(solid for solid in appearance(made, Look()).solids if solid.name == "tip")
    np.testing.assert_allclose(tip.pose(33)[:3, 3], made["tip"][33], atol=1e-14)
    values = {one.text: one.values for one in tip.histories}
    np.testing.assert_array_equal(values["height"], made["tip"][:, 2])
    np.testing.assert_allclose(values["speed of the tip"], np.linalg.norm(made["tip_velocity"], axis=1))
    np.testing.assert_array_equal(values["speed of the water"], made["flow_speed"])


def test_both_ends_that_are_held_are_shown():
    seen = appearance(told(SCENE.format(more="root_support: pinned\n  end: clamped"), frames=3), Look())
    x = seen.solids[0].points[:, 0]
    assert x.min() < 0.0 < 0.4 < x.max()


def test_the_path_of_the_tip_goes_through_every_frame_and_never_moves():
    made = result(frames=101)
    path = appearance(made, Look()).lines[1]
    points = path.points(0)
    assert path.points(50) is points and not path.thick and path.radius < 0.01 * LENGTH
    step = (len(points) - 1) // 100
    np.testing.assert_allclose(points[::step], made["tip"], atol=1e-9)


def test_exaggeration_leaves_what_lies_along_the_first_frame_as_it_is():
    made = result(frames=101, swing=0.02, sag=0.0)
    plain, large = (appearance(made, look) for look in (Look(), Look(exaggerate=10.0)))
    first, then = made["position"][0], made["position"][90]
    axis = (first[-1] - first[0]) / np.linalg.norm(first[-1] - first[0])
    moved = then - first
    lengthwise = (moved @ axis)[:, None] * axis
    at = plain.lines[0].nodes
    np.testing.assert_allclose(
        large.lines[0].points(90)[at], first + lengthwise + 10.0 * (moved - lengthwise), atol=1e-6
    )
    np.testing.assert_allclose(large.lines[1].points(0)[-1], large.lines[0].points(100)[-1], atol=1e-9)
    mark = marks(large)[3].pose(90)[:3, 3]
    assert np.linalg.norm(large.lines[0].points(90) - mark, axis=-1).min() < 0.01
    assert any("10 times" in note for note in large.remarks) and not any("drawn" in note for note in plain.remarks)


def test_a_run_of_one_frame_can_be_seen():
    seen = appearance(result(frames=1), Look())
    assert len(seen.lines) == 1 and np.isfinite(seen.extent([0])).all()


def test_marks_are_closed_bodies_that_stay_within_the_picture():
    made = result(frames=101)
    seen = appearance(made, Look())
    points = np.concatenate([placed(m.points, m.pose(k)) for m in marks(seen) for k in range(0, 101, 20)])
    assert np.isfinite(points).all() and np.abs(points).max() < 1.1 * LENGTH


def test_a_scene_of_something_else_is_refused_with_a_cure():
    with pytest.raises(ResultError, match=r"scene that cannot be read.*run the scene again"):
        appearance(told("crane: {}", frames=2), Look())
