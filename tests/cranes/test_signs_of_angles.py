"""Signs of the angles that a rope makes with its wheels are those that docs/crane.md tells."""

import numpy as np
import pytest

from crane.results.angles import leads, out_of_plane

DOWN = (0.0, 0.0, -9.81)


@pytest.mark.parametrize(("side", "towards"), [(1.0, -1.0), (-1.0, 1.0)])
def test_offlead_is_positive_towards_axis_times_gravity_and_sidelead_along_the_axis(side, towards):
    axis = np.array([[0.0, side, 0.0]])
    offlead, sidelead = leads(np.array([[0.1 * towards, 0.0, -1.0]]), axis, DOWN)
    assert offlead == pytest.approx(np.arctan(0.1)) and sidelead == pytest.approx(0.0)
    offlead, sidelead = leads(np.array([[0.0, 0.1, -1.0]]), axis, DOWN)
    assert offlead == pytest.approx(0.0) and sidelead == pytest.approx(side * np.arctan(0.1))
    assert np.cross(axis[0], DOWN)[0] * towards > 0.0


def test_a_fleet_angle_is_positive_where_the_rope_goes_the_way_of_the_axis():
    along = np.array([np.cos(0.1), np.sin(0.1), 0.0])
    assert out_of_plane(along, np.array([0.0, 1.0, 0.0])) == pytest.approx(0.1)
    assert out_of_plane(along, np.array([0.0, -1.0, 0.0])) == pytest.approx(-0.1)
