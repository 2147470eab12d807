"""What a cable looks like: its elements' cubics, by an evaluation of another's, and what holds and pulls it."""

import numpy as np
import pytest
from physics.cables.rope_text import PINNED, chain, element, node, scene
from scipy.interpolate import CubicHermiteSpline
from view.made_up import moved

from tautline.cable.view.appearance import appearance
from tautline.results.errors import ResultError
from tautline.view.space.appearance import Look

CLAMPED = (1, 1, 1, 1, 1, 1, 1)


@pytest.fixture(scope="module")
def hanging():
    """Three elements between two pins, the middle of them twice as long; rope leaves at the end, which rests.

    A linear element hangs on its own beside them.
    """
    p = np.array([0.0, 0.5, 1.5, 2.0])
    xyz = np.stack([0.95 * p, 0 * p, -0.05 * p * (2.0 - p)], axis=-1)
    items = chain(xyz, p, {0: PINNED, 3: PINNED}, EA=1e4, EJ=0.1, damping=1e-3)
    items += node(10, (0, 1, 0), held=(1, 1, 1, 1)) + node(11, (0, 1, -1), held=(0, 0, 0, 1))
    items += element(10, 10, 11, EA=1e3, linear=True)
    items += "  - PointMass: {id: 1, nodes7: [1], mass: 0.5}\n"
    items += "  - OneNodeSpring: {id: 1, nodes7: [2], stiffness: 10.0, damping: 0.1}\n"
    items += "  - PointForce: {id: 1, nodes4: [11], force: [0, 3, 0], timeInterval: [0.05, 0.1]}\n"
    return moved(scene(items), still=(0, 3, 10), rates={3: -0.2})


def spline(result, frame, nodes):
    p = result["material_coordinate"][frame, nodes]
    return CubicHermiteSpline(p, result["position"][frame, nodes], result["slope"][frame, nodes]), p


def spread(p, steps):
    """Points evenly over each element, (elements steps + 1,), and the element of each."""
    x = np.arange(steps) / steps
    return np.append((p[:-1, None] + np.diff(p)[:, None] * x).ravel(), p[-1])


def test_the_line_is_the_elements_own_cubic_also_where_rope_leaves(hanging):
    line = appearance(hanging, Look()).lines[0]
    steps = (len(line.points(0)) - 1) // 3
    assert hanging["material_coordinate"][-1, 3] < 2.0 - 0.03
    for frame in (0, 7, -1):
        curve, p = spline(hanging, frame, [0, 1, 2, 3])
        points = line.points(frame % len(hanging.time))
        np.testing.assert_allclose(points, curve(spread(p, steps)), rtol=0, atol=1e-13)
        np.testing.assert_array_equal(points[line.nodes], hanging["position"][frame, [0, 1, 2, 3]])


def test_curvature_is_that_of_the_cubic_at_every_point_between_nodes(hanging):
    line = appearance(hanging, Look()).lines[0]
    curvature = next(q for q in line.quantities if q.name == "curvature")
    frame, steps = len(hanging.time) - 1, (len(line.points(0)) - 1) // 3
    curve, p = spline(hanging, frame, [0, 1, 2, 3])
    at = spread(p, steps)
    first, second = curve(at, 1), curve(at, 2)
    expected = np.linalg.norm(np.cross(first, second), axis=-1) / np.linalg.norm(first, axis=-1) ** 3
    between = np.setdiff1d(np.arange(len(at)), line.nodes)
    np.testing.assert_allclose(curvature.values(frame)[between], expected[between], rtol=1e-11)
    # In the middle of elements it is what the run has stored.
    np.testing.assert_allclose(
        curvature.values(frame)[steps // 2 :: steps], hanging["curvature"][frame, :3], rtol=1e-11
    )


def test_a_ring_of_cubics_has_the_curvature_of_its_circle():
    """Sixteen Hermite cubics around a circle miss its curvature by (2 pi/16)^2/12 at the ends, 1.3 %: less is asked."""
    angle, radius = np.linspace(0.0, np.pi, 9), 0.8
    xyz = radius * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    slopes = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], axis=-1)
    items = chain(xyz, radius * angle, {0: CLAMPED, 8: CLAMPED}, slopes=slopes, EA=1e4, EJ=0.1)
    result = moved(scene(items), size=0.0, frames=1)
    line = appearance(result, Look()).lines[0]
    curvature = next(q for q in line.quantities if q.name == "curvature")
    np.testing.assert_allclose(curvature.values(0), 1.0 / radius, rtol=0.015)
    assert abs(curvature.values(0).mean() * radius - 1.0) < 0.002


def test_axial_force_is_what_is_stored_in_the_middle_of_elements_and_linear_between(hanging):
    line = appearance(hanging, Look()).lines[0]
    force, frame = line.quantities[0], 12
    steps = (len(line.points(0)) - 1) // 3
    stored = hanging["axial_force"][frame, :3]
    assert force.name == "axial_force" and force.unit == "N" and force.where == "in the middle of each element"
    np.testing.assert_allclose(force.values(frame)[steps // 2 :: steps], stored, rtol=1e-12)
    p = hanging["material_coordinate"][frame, :4]
    between = 0.5 * (p[:2] + p[1:3])
    weight = (p[1] - between[0]) / (between[1] - between[0])
    assert np.isclose(force.values(frame)[steps], (1 - weight) * stored[0] + weight * stored[1], rtol=1e-12)
    assert (force.low, force.high) == (hanging["axial_force"][:, :3].min(), hanging["axial_force"][:, :3].max())


def test_speed_is_that_of_the_material_which_leaves_at_a_node_that_rests(hanging):
    """The end rests in space and its p falls at 0.2 m/s, so rope goes out through it at 0.2 |dr/dp|."""
    speed = appearance(hanging, Look()).lines[0].quantities[-1]
    frame = 9
    np.testing.assert_array_equal(hanging["velocity"][frame, 3], 0.0)
    assert np.isclose(speed.values(frame)[-1], 0.2 * np.linalg.norm(hanging["slope"][frame, 3]), rtol=1e-9)
    assert speed.low == 0.0 and speed.high >= speed.values(frame).max()


def test_speed_at_moving_nodes_is_that_of_the_piece_of_rope_there_followed_from_frame_to_frame():
    """Central differences of where the cubics of the frames around have the material that is at a node now."""
    p = np.array([0.0, 0.5, 1.5, 2.0])
    items = chain(np.stack([p, 0 * p, 0 * p], axis=-1), p, {}, EA=1e4, EJ=0.1)
    result = moved(scene(items), interval=1e-4, rates={0: 0.3, 1: 0.5, 2: 0.1, 3: -0.4})
    line = appearance(result, Look()).lines[0]
    for frame in (5, 15):
        before, after = (
            spline(result, k, [0, 1, 2, 3])[0](result["material_coordinate"][frame]) for k in (frame - 1, frame + 1)
        )
        expected = np.linalg.norm(after - before, axis=-1) / 2e-4
        np.testing.assert_allclose(line.quantities[-1].values(frame)[line.nodes], expected, rtol=0, atol=2e-3)


def test_a_linear_element_is_straight_and_a_chain_of_its_own(hanging):
    seen = appearance(hanging, Look())
    assert [line.name for line in seen.lines] == ["cable 1", "cable 2", "spring"]
    points = seen.lines[1].points(20)
    ends = hanging["position"][20, 4:6]
    np.testing.assert_allclose(points, [ends[0], ends.mean(axis=0), ends[1]], atol=1e-14)
    assert "curvature" not in [q.name for q in seen.lines[1].quantities]


def test_what_holds_pulls_and_weighs_is_where_it_acts(hanging):
    seen = appearance(hanging, Look())
    solids = {solid.name: solid for solid in seen.solids}
    assert set(solids) == {"supports", "mass"}
    np.testing.assert_array_equal(solids["mass"].pose(15)[:3, 3], hanging["position"][15, 1])
    low, high = solids["supports"].points.min(axis=0), solids["supports"].points.max(axis=0)
    assert np.all(low <= hanging["position"][0, [0, 3, 4]].min(axis=0)) and np.all(high[:2] >= [1.9, 1.0])
    spring = seen.lines[2]
    np.testing.assert_allclose(spring.points(15)[[0, -1]], hanging["position"][[0, 15], 2], atol=1e-14)
    assert np.linalg.norm(np.diff(spring.points(0), axis=0), axis=-1).min() > 0.0
    force = seen.arrows[0]
    acting = [bool(np.any(force.vectors(k))) for k in range(len(hanging.time))]
    assert acting == [0.05 <= t < 0.1 for t in hanging.time] and force.longest == 3.0
    np.testing.assert_array_equal(force.points(8)[0], hanging["position"][8, 5])
    assert any("not to scale" in note for note in seen.notes)


def test_exaggerated_displacements_grow_by_the_factor_and_the_note_says_so(hanging):
    plain, large = (appearance(hanging, look) for look in (Look(), Look(exaggerate=5.0)))
    begun, moved = plain.lines[0].points(0), plain.lines[0].points(15)
    np.testing.assert_allclose(large.lines[0].points(15), begun + 5.0 * (moved - begun), atol=1e-13)
    np.testing.assert_array_equal(large.lines[0].points(0), begun)
    np.testing.assert_allclose(
        large.solids[-1].pose(15)[:3, 3], large.lines[0].points(15)[large.lines[0].nodes[1]], atol=1e-13
    )
    assert any("5 times" in note for note in large.remarks) and not any("times" in note for note in plain.remarks)
    bent = [look.lines[0].quantities[1].values(15) for look in (plain, large)]
    np.testing.assert_array_equal(*bent)


def test_a_slack_rope_of_one_upright_element_can_be_seen():
    items = node(0, (0, 0, 0), held=(1, 1, 1, 1)) + node(1, (0, 0, 0.9), held=(0, 0, 0, 1), p=1.0)
    items = items.replace("BC: [1, 1, 1, 1]}", "BC: [1, 1, 1, 1], p: 0.0}")
    items += element(0, 0, 1, EA=1e3, linear=True, extra=", compression: false")
    result = moved(scene(items), size=0.0)
    seen = appearance(result, Look())
    force = seen.lines[0].quantities[0]
    assert result["axial_force"][0, 0] == 0.0 and np.all(force.values(0) == 0.0)
    assert np.isfinite(seen.eye).all() and abs(seen.eye[2]) < 0.5 * np.linalg.norm(seen.eye)


def test_a_plane_is_seen_nearly_square_from_the_side_where_x_goes_to_the_right():
    angle = np.linspace(0.0, 0.5 * np.pi, 5)
    xyz = np.stack([np.sin(angle), 0 * angle, np.cos(angle) - 1.0], axis=-1)
    items = chain(xyz, 0.5 * np.pi * np.linspace(0, 1, 5), {0: PINNED}, EA=1e3)
    eye = np.array(appearance(moved(scene(items), size=0.0), Look()).eye)
    assert eye[1] < 0.0 and 0.95 < -eye[1] / np.linalg.norm(eye) < 1.0


@pytest.mark.parametrize(
    "look, words",
    [(Look(view="inside"), "no view 'inside'"), (Look(exaggerate=0.0), "factor"), (Look("", np.nan), "factor")],
)
def test_a_look_that_there_is_not_is_refused(hanging, look, words):
    with pytest.raises(ResultError, match=words):
        appearance(hanging, look)
