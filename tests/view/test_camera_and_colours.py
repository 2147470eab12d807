"""Where the eye is, and what colours mean."""

import math

import numpy as np
import pytest
from drawn import appearance

from tautline.results.errors import ResultError
from tautline.view.space.appearance import Look, chosen, ranged
from tautline.view.space.camera import ANGLE, VIEWS, aim, fitted
from tautline.view.space.colours import shading, table


def seen(points: np.ndarray, camera, aspect: float) -> np.ndarray:
    """Where points are in the picture, from -1 to 1 both ways, by a pinhole of the camera's own."""
    back = camera.eye - camera.focus
    back = back / np.linalg.norm(back)
    right = np.cross(camera.up, back)
    away = (camera.eye - points) @ back
    slope = math.tan(math.radians(0.5 * ANGLE))
    return (
        np.stack([(points - camera.eye) @ right / (slope * aspect), (points - camera.eye) @ camera.up / slope], -1)
        / (away[:, None])
    )


@pytest.mark.parametrize("name", VIEWS)
@pytest.mark.parametrize("shape", [(1.0, 1.0, 1.0), (1e-3, 50.0, 0.2), (0.0, 0.0, 4000.0)])
@pytest.mark.parametrize("aspect", [0.5, 1.78])
def test_everything_is_in_the_picture_and_fills_it(name, shape, aspect):
    points = np.random.default_rng(3).uniform(-1.0, 1.0, (200, 3)) * shape + [7.0, -3.0, 100.0]
    at = seen(points, fitted(points, aim(name, (1, 0, 0)), aspect), aspect)
    assert np.abs(at).max() <= 1.0 + 1e-9
    if shape == (1.0, 1.0, 1.0):
        assert np.abs(at).max() > 0.9


def test_azimuth_and_elevation_turn_the_eye_from_the_front_to_the_right_and_up():
    assert np.allclose(aim("0,0", (1, 1, 1)).eye, [0, -1, 0])
    assert np.allclose(aim("90,0", (1, 1, 1)).eye, [1, 0, 0])
    assert np.allclose(aim("0,90", (1, 1, 1)).eye, [0, 0, 1], atol=1e-12)
    assert aim("30,20,2", (1, 1, 1)).zoom == 2.0


@pytest.mark.parametrize("text", ["frontal", "30", "30,95", "1,2,3,4", "a,b", "nan,0", "0,0,0"])
def test_a_view_that_is_none_is_refused_with_those_that_are(text):
    with pytest.raises(ResultError, match="front, back"):
        aim(text, (1, 0, 0))


def test_the_first_quantity_colours_the_lines_in_the_legends_unit():
    shade = shading(appearance(), None)
    assert (shade.title, shade.factor) == ("tension [kN]", 1e3)
    assert (shade.low, shade.high) == pytest.approx((10.0, 40.0))


def test_zero_is_grey_and_both_signs_are_to_one_scale():
    shade = shading(appearance(), "twist")
    assert (shade.low, shade.high) == pytest.approx((-2.0, 6.0))
    zero = shade.table[round(255 * 2.0 / 8.0)].astype(int)
    assert np.ptp(zero) < 12
    # A value and its opposite are as far from grey.
    whole = table(-6.0, 6.0, True)
    assert np.array_equal(shade.table[0], whole[round(255 * 4.0 / 12.0)])


def test_a_quantity_that_never_changes_has_a_legend_of_some_width():
    line = appearance().lines[0]
    flat = ranged("tension", "tension", "N", np.full((41, 21), 5.0e3))
    shade = shading(appearance(lines=(type(line)("rope", line.points, 0.1, (flat,)),)), None)
    assert shade.low < 5.0 < shade.high


def test_an_unknown_quantity_or_view_is_refused_with_those_that_there_are():
    with pytest.raises(ResultError, match="known: tension, twist, none"):
        shading(appearance(), "tensoin")
    with pytest.raises(ResultError, match="known: side"):
        chosen({"side": "from the side"}, Look(view="above"))


def test_no_quantity_means_plain_lines():
    assert shading(appearance(), "none") is None
