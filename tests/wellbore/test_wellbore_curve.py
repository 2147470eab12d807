"""The curve and its frame, whatever they were built from."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillstring.well.wellbore import Build, Hold, Turn, from_sections, from_survey

DEG = math.pi / 180.0

THREE_D = from_sections(
    [Hold(300.0), Build(500.0, 50 * DEG, 40 * DEG), Turn(400.0, 110 * DEG), Hold(150.0), Build(600.0, 20 * DEG)]
)
CROOKED = from_survey(
    [0, 120, 121, 400, 640, 655, 900],
    np.array([0, 3, 3, 40, 90, 92, 60]) * DEG,
    np.array([77, 350, 350, 10, 45, 46, 300]) * DEG,
)
WELLS = pytest.mark.parametrize("well", [THREE_D, CROOKED], ids=["planned", "surveyed"])


def depths(well, count=2001):
    """Depths from above the table to beyond the end, none on a joint."""
    return np.linspace(-50.3, well.length + 80.7, count)


@WELLS
def test_the_frame_is_orthonormal_and_right_handed_everywhere(well):
    m1, m2, t = well.frame(depths(well))
    frames = np.stack([m1, m2, t], axis=-2)
    assert np.abs(frames @ np.swapaxes(frames, -1, -2) - np.eye(3)).max() < 1e-14
    assert np.allclose(np.cross(m1, m2), t, atol=1e-14)


@WELLS
def test_the_tangent_is_the_derivative_of_the_position(well):
    h = 1e-3
    s = depths(well)
    s = s[np.abs(s[:, None] - well.md).min(axis=1) > 2 * h]
    difference = (well.position(s + h) - well.position(s - h)) / (2 * h)
    assert np.abs(difference - well.frame(s)[2]).max() < 1e-9  # rounding: 1e-13 * 1e3 m over h


@WELLS
def test_bishop_equations_hold_by_differences(well):
    h = 1e-2
    s = depths(well)
    s = s[np.abs(s[:, None] - well.md).min(axis=1) > 2 * h]
    k1, k2 = (k[:, None] for k in well.curvature(s))
    m1, m2, t = well.frame(s)
    up, down = well.frame(s - h), well.frame(s + h)
    dm1, dm2, dt = ((b - a) / (2 * h) for a, b in zip(up, down, strict=True))
    # The central difference of a sine is short by h**2 k**3 / 6: 7e-12 at the sharpest arc here, 1/134 m.
    assert np.abs(dm1 + k1 * t).max() < 1e-11
    assert np.abs(dm2 + k2 * t).max() < 1e-11
    assert np.abs(dt - k1 * m1 - k2 * m2).max() < 1e-11


@WELLS
def test_turning_is_the_integral_of_curvature(well):
    s = depths(well, 200001)
    for k, phi in zip(well.curvature(s), well.turning(s), strict=True):
        integral = np.concatenate([[0.0], np.cumsum(0.5 * (k[1:] + k[:-1]) * np.diff(s))])
        integral -= np.interp(0.0, s, integral)
        # The trapezoidal sum is exact but for half a step of each jump at a joint.
        assert np.abs(integral - phi).max() <= 0.5 * np.abs(np.diff(k)).sum() * (s[1] - s[0]) * 1.001


@WELLS
def test_position_and_frame_agree_with_an_integration_of_the_bishop_equations(well):
    def slope(s, y):
        m1, m2, t = y[3:].reshape(3, 3)
        k1, k2 = well.curvature(s)
        return np.concatenate([t, -k1 * t, -k2 * t, k1 * m1 + k2 * m2])

    y = np.concatenate([np.zeros(3), np.eye(3).ravel()])
    for a, b in zip(well.md[:-1], well.md[1:], strict=True):
        # Arc by arc, just inside its ends, for the curvature jumps at the joints.
        y = solve_ivp(slope, (a + 1e-9, b - 1e-9), y, rtol=1e-11, atol=1e-11, method="DOP853").y[:, -1]
        assert np.abs(y[:3] - well.position(b)).max() < 2e-6  # 2e-9 m left out at each of up to 294 joints
        assert np.abs(y[3:] - np.concatenate(well.frame(b))).max() < 1e-8


@WELLS
def test_position_and_frame_are_continuous_at_the_joints(well):
    s = well.md[1:-1]
    assert np.abs(well.position(s - 1e-9) - well.position(s)).max() < 2e-9
    for a, b in zip(well.frame(s - 1e-9), well.frame(s), strict=True):
        assert np.abs(a - b).max() < 1e-11


@WELLS
def test_above_the_table_the_hole_is_straight(well):
    s = np.array([-1e-9, -1.0, -1000.0])
    assert np.allclose(well.position(s), s[:, None] * well.tangents[0], atol=1e-12)
    assert np.all(np.array(well.curvature(s)) == 0.0) and np.all(np.array(well.turning(s)) == 0.0)
    assert np.array_equal(well.frame(s)[0], np.broadcast_to(well.m1s[0], (3, 3)))


def test_beyond_the_end_the_last_arc_goes_on():
    short = from_sections([Hold(100.0), Build(300.0, 30 * DEG)])
    longer = from_sections([Hold(100.0), Build(300.0, 80 * DEG)])
    s = short.length + np.array([0.0, 1.64, 50.0, 200.0])
    assert np.allclose(short.position(s), longer.position(s), atol=1e-11)
    assert np.allclose(short.turning(s), longer.turning(s), atol=1e-14)
    assert np.allclose(short.frame(s), longer.frame(s), atol=1e-14)


def test_a_point_off_the_curve_stands_where_its_frame_says():
    s = np.array([10.0, 500.0, 900.0])
    m1, m2, _ = THREE_D.frame(s)
    expected = THREE_D.position(s) + 0.03 * m1 - 0.02 * m2
    assert np.allclose(THREE_D.point(s, 0.03, -0.02), expected, atol=1e-13)
    assert THREE_D.point(500.0, np.linspace(-1, 1, 7), 0.0).shape == (7, 3)


def test_shapes_follow_the_depths_given():
    assert THREE_D.position(12.0).shape == (3,) and THREE_D.tvd(12.0).shape == ()
    s = np.full((4, 5), 350.0)
    assert THREE_D.position(s).shape == (4, 5, 3) and THREE_D.inclination(s).shape == (4, 5)
    assert THREE_D.arc(s).shape == (4, 5)


def test_the_arc_at_a_joint_is_the_lower_one_and_at_the_end_the_last():
    well = from_sections([Hold(10.0), Build(100.0, 0.5), Hold(10.0)])
    assert list(well.arc([-1.0, 0.0, 10.0, 60.0, 70.0, 99.0])) == [0, 0, 1, 2, 2, 2]


def test_arrays_are_contiguous_float64_for_compiled_code():
    for name in ("md", "k1", "k2", "phi1", "phi2", "positions", "m1s", "m2s", "tangents"):
        array = getattr(CROOKED, name)
        assert array.dtype == np.float64 and array.flags.c_contiguous and array.flags.writeable, name


def test_a_tangent_that_rounds_a_corner_of_an_octant_turns_the_frame_by_its_solid_angle():
    # Down -> north -> east -> down encloses an eighth of the sphere, pi/2: the frame comes back turned by that.
    well = from_sections([Build(100.0, 90 * DEG, 0.0), Turn(100.0, 90 * DEG), Build(100.0, 0.0)])
    m1, m2, t = well.frame(well.length)
    assert np.allclose([m1, m2, t], [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], atol=1e-13)
