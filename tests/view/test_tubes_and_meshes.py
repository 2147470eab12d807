"""Geometry of what is drawn: rings along lines, bodies of revolution, boxes."""

import numpy as np
import pytest
from drawn import volume

from tautline.view.space.appearance import axes_of
from tautline.view.space.mesh import box, cylinder, joined, moved, turned_about
from tautline.view.space.tube import normals, rings, skin, tangents


def helix(count: int) -> np.ndarray:
    angle = np.linspace(0.0, 6.0 * np.pi, count)
    return np.stack([np.cos(angle), np.sin(angle), 0.3 * angle], axis=-1)


def test_rings_stand_across_the_line_at_its_radius():
    points, radius = helix(200), np.linspace(0.05, 0.1, 200)
    at, out = rings(points, radius, 8)
    away = at.reshape(200, 8, 3) - points[:, None]
    assert np.allclose(np.linalg.norm(away, axis=-1), radius[:, None], rtol=1e-12)
    assert np.allclose(np.einsum("psc,pc->ps", away, tangents(points)), 0.0, atol=1e-12)
    assert np.allclose(out.reshape(200, 8, 3) * radius[:, None, None], away, atol=1e-12)


def test_normals_turn_against_a_helix_own_by_its_torsion():
    """Bishop, There is more than one way to frame a curve (1975): the angle from the normal to one that does not twist
    goes back by the integral of the torsion, b / (a^2 + b^2) times the length for a helix."""
    points, angle = helix(2000), np.linspace(0.0, 6.0 * np.pi, 2000)
    u, _ = normals(tangents(points))
    inward = -np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    binormal = np.stack([0.3 * np.sin(angle), -0.3 * np.cos(angle), 1.0 + 0.0 * angle], axis=-1) / np.sqrt(1.09)
    turned = np.unwrap(np.arctan2((u * binormal).sum(-1), (u * inward).sum(-1)))
    assert turned[-2] - turned[1] == pytest.approx(-0.3 / np.sqrt(1.09) * (angle[-2] - angle[1]), rel=1e-4)


def test_a_straight_line_and_one_with_a_point_twice_have_normals_everywhere():
    points = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 1], [0, 0, 2.5], [0, 0, 2.5]], float)
    at, _ = rings(points, 0.1, 6)
    assert np.all(np.isfinite(at))
    assert np.allclose(tangents(points), [0, 0, 1])


def test_a_line_that_is_one_point_is_drawn_as_a_dot_and_not_as_nan():
    at, out = rings(np.zeros((3, 3)), 0.2, 6)
    assert np.all(np.isfinite(at)) and np.all(np.isfinite(out))


def test_a_line_that_turns_back_on_itself_has_finite_rings():
    at, _ = rings(np.array([[0, 0, 0], [1, 0, 0], [0, 0, 0]], float), 0.1, 6)
    assert np.all(np.isfinite(at))


def test_the_skin_of_a_straight_tube_holds_the_volume_of_its_prism():
    points = np.linspace([0, 0, 0], [0, 3.0, 0], 5)
    at, _ = rings(points, 0.5, 12)
    area = 0.5 * 12 * 0.5**2 * np.sin(2.0 * np.pi / 12)
    assert volume(at, skin(5, 12, closed=True)) == pytest.approx(3.0 * area, rel=1e-12)


def test_a_box_holds_its_volume_about_its_centre():
    points, triangles = box((2.0, 3.0, 4.0), (1.0, -2.0, 5.0))
    assert volume(points, triangles) == pytest.approx(24.0)
    assert np.allclose(points.mean(axis=0), [1.0, -2.0, 5.0])


def test_a_cylinder_holds_the_volume_of_its_prism():
    points, triangles = cylinder(0.7, 2.0, 16)
    assert volume(points, triangles) == pytest.approx(2.0 * 8 * 0.7**2 * np.sin(np.pi / 8), rel=1e-12)


def test_a_ring_with_a_bore_holds_what_pappus_says():
    profile = [(1.0, -0.1), (1.2, -0.1), (1.2, 0.1), (1.0, 0.1), (1.0, -0.1)]
    points, triangles = turned_about(profile, 720)
    # Pappus: area of the section times the way of its centre; the polygon of 720 sides misses 3e-5 of it.
    assert volume(points, triangles) == pytest.approx(0.2 * 0.2 * 2.0 * np.pi * 1.1, rel=1e-4)


def test_joined_and_moved_bodies_keep_their_volume():
    one = moved(box((1, 1, 1)), axes_of([1.0, 2.0, 2.0], 0.7), (3, 4, 5))
    both = joined(one, cylinder(1.0, 1.0, 8))
    assert volume(*both) == pytest.approx(1.0 + 4 * np.sin(np.pi / 4))


@pytest.mark.parametrize("axis", [(0, 0, 1), (0, 1, 0), (1, 0, 0), (1, -2, 3)])
def test_axes_of_a_wheel_turn_right_handed_about_it(axis):
    z = np.array(axis) / np.linalg.norm(axis)
    before, after = axes_of(np.array(axis, float)), axes_of(np.array(axis, float), 0.1)
    assert np.allclose(after[:, 2], z)
    assert np.linalg.det(after) == pytest.approx(1.0)
    assert np.cross(before[:, 0], after[:, 0]) @ z == pytest.approx(np.sin(0.1))
