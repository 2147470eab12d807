"""Surveyed wells: published positions, independent integrations, hard cases of minimum curvature."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad_vec

from drillstring.well.survey import read_survey
from drillstring.well.wellbore import Build, Hold, WellboreError, from_sections, from_survey

DEG = math.pi / 180.0
ISCWSA = Path(__file__).parents[2] / "data" / "iscwsa_reference.csv"


@pytest.fixture(scope="module")
def reference():
    survey = read_survey(ISCWSA)
    return survey, from_survey(survey.md, survey.inc, survey.azi)


def test_the_iscwsa_reference_well_comes_back_to_the_rounding_of_its_positions(reference):
    survey, well = reference
    rows = list(csv.DictReader(line for line in ISCWSA.open() if not line.startswith("#")))
    published = np.array([[float(row[name]) for name in ("n [m]", "e [m]", "tvd [m]")] for row in rows])
    assert len(survey.md) == 100 and well.length == 2940.0
    assert np.abs(well.position(survey.md) - published).max() <= 0.005 + 1e-9  # written to 0.01 m


def test_the_iscwsa_reference_well_is_planar_so_one_curvature_component_is_zero(reference):
    _, well = reference
    assert np.abs(well.k2).max() < 1e-18
    assert well.turning(well.length)[0] == pytest.approx(-90 * DEG, abs=1e-12)  # to the south, away from m1


CROOKED = (
    np.array([0.0, 7.0, 30.0, 31.5, 300.0, 480.0, 900.0, 1250.0]),
    np.array([0.0, 1.0, 2.0, 2.0, 45.0, 90.0, 91.0, 20.0]) * DEG,
    np.array([0.0, 359.0, 1.0, 180.0, 240.0, 250.0, 90.0, 91.0]) * DEG,
)


def slerp_position(md, inc, azi):
    """Station positions by quadrature of the great-circle tangent of each interval: no ratio factor, no frame."""
    t = np.column_stack([np.sin(inc) * np.cos(azi), np.sin(inc) * np.sin(azi), np.cos(inc)])
    positions = [md[0] * t[0]]
    for i, length in enumerate(np.diff(md)):
        angle = math.acos(np.clip(t[i] @ t[i + 1], -1.0, 1.0))
        if angle < 1e-7:
            step = 0.5 * (t[i] + t[i + 1])
        else:
            step, _ = quad_vec(
                lambda x, i=i, a=angle: (math.sin((1 - x) * a) * t[i] + math.sin(x * a) * t[i + 1]) / math.sin(a),
                0.0, 1.0, epsabs=1e-14,
            )  # fmt: skip
        positions.append(positions[-1] + length * step)
    return np.array(positions)


def test_stations_of_a_crooked_well_agree_with_quadrature_along_great_circles():
    well = from_survey(*CROOKED)
    assert np.abs(well.position(CROOKED[0]) - slerp_position(*CROOKED)).max() < 1e-9


def test_stations_of_a_crooked_well_agree_with_wellpathpy():
    mincurve = pytest.importorskip("wellpathpy.mincurve")
    tvd, north, east, dogleg = mincurve.minimum_curvature_inner(*CROOKED)
    well = from_survey(*CROOKED)
    assert np.abs(well.position(CROOKED[0][1:]) - np.column_stack([north, east, tvd])).max() < 1e-9
    assert np.allclose(np.hypot(well.k1, well.k2) * np.diff(well.md), dogleg, atol=1e-12)


def test_the_hole_passes_every_station_in_its_direction():
    md, inc, azi = CROOKED
    well = from_survey(md, inc, azi)
    assert np.allclose(well.inclination(md), inc, atol=1e-13)
    slanted = inc > 0.0
    assert np.allclose(well.azimuth(md)[slanted], azi[slanted], atol=1e-12)
    # From above each station too: the arc arrives in the direction in which the next one leaves.
    assert np.allclose(well.inclination(md[1:] - 1e-9), inc[1:], atol=1e-10)


def test_azimuth_wraps_from_359_to_1_deg_by_two_degrees():
    md, inc = [0.0, 100.0], [90 * DEG, 90 * DEG]
    well = from_survey(md, inc, [359 * DEG, 1 * DEG])
    assert np.hypot(well.k1, well.k2)[0] * 100.0 == pytest.approx(2 * DEG, abs=1e-14)
    assert well.position(100.0)[0] == pytest.approx(100.0 * math.sin(DEG) / DEG, abs=1e-10)
    assert np.degrees(well.azimuth([0.0, 49.0, 51.0])) == pytest.approx([359.0, 359.98, 0.02], abs=1e-9)
    again = from_survey(md, inc, [-1 * DEG, 361 * DEG])
    assert np.allclose(again.position(60.0), well.position(60.0), atol=1e-12)


def test_the_azimuth_of_a_vertical_station_does_not_matter():
    md, inc = [0.0, 500.0, 600.0, 700.0], np.array([0.0, 0.0, 10.0, 0.0]) * DEG
    one = from_survey(md, inc, np.array([0, 0, 80, 0]) * DEG)
    other = from_survey(md, inc, np.array([200, 123, 80, 311]) * DEG)
    s = np.linspace(0.0, 700.0, 57)
    assert np.allclose(one.position(s), other.position(s), atol=1e-12)
    assert np.allclose(one.frame(s), other.frame(s), atol=1e-14)


def test_intervals_without_dogleg_are_straight():
    well = from_survey([0.0, 10.0, 500.0], [0.7, 0.7, 0.7], [2.0, 2.0, 2.0 + 2 * math.pi])
    assert np.abs([well.k1, well.k2]).max() < 1e-17
    assert np.allclose(well.position(321.0), 321.0 * well.tangents[0], atol=1e-11)


@pytest.mark.parametrize("small", [1e-3, 1e-6, 1e-9, 1e-12])
def test_the_smallest_doglegs_keep_their_curvature_and_plane(small):
    well = from_survey([0.0, 30.0], [0.0, small], [0.0, 30 * DEG])
    assert well.k1[0] == pytest.approx(small / 30.0 * math.cos(30 * DEG), rel=1e-6)
    assert well.k2[0] == pytest.approx(small / 30.0 * math.sin(30 * DEG), rel=1e-6)


def test_a_dogleg_of_178_degrees_is_still_drilled_and_180_refused():
    well = from_survey([0.0, 100.0], [0.0, 178 * DEG], [0.0, 50 * DEG])
    radius = 100.0 / (178 * DEG)
    assert np.linalg.norm(well.position(100.0)) == pytest.approx(2 * radius * math.sin(89 * DEG), abs=1e-10)
    with pytest.raises(WellboreError, match="plane is not known") as caught:
        from_survey([0.0, 50.0, 100.0], [80 * DEG, 90 * DEG, 90 * DEG], [0.0, 0.0, 180 * DEG])
    assert caught.value.index == 2


def test_stations_split_in_two_give_the_same_hole_and_frame():
    coarse = from_survey(*CROOKED)
    md = np.sort(np.concatenate([CROOKED[0], 0.5 * (CROOKED[0][1:] + CROOKED[0][:-1])]))
    fine = from_survey(md, coarse.inclination(md), coarse.azimuth(md))
    s = np.linspace(-5.0, coarse.length + 5.0, 700)
    assert np.allclose(coarse.position(s), fine.position(s), atol=1e-9)
    assert np.allclose(coarse.frame(s), fine.frame(s), atol=1e-11)
    assert np.allclose(coarse.turning(s), fine.turning(s), atol=1e-11)


def test_a_surveyed_plan_is_the_plan():
    plan = from_sections([Hold(400.0), Build(600.0, 75 * DEG, 200 * DEG), Hold(300.0), Build(900.0, 90 * DEG)])
    md = np.unique(np.concatenate([plan.md, np.linspace(0.0, plan.length, 60)]))
    well = from_survey(md, plan.inclination(md), plan.azimuth(md))
    s = np.linspace(0.0, plan.length, 400)
    assert np.allclose(well.position(s), plan.position(s), atol=1e-9)
    assert np.allclose(well.frame(s), plan.frame(s), atol=1e-11)


def test_a_survey_that_starts_below_the_table_is_tied_in_straight():
    well = from_survey([120.0, 150.0], [20 * DEG, 25 * DEG], [90 * DEG, 90 * DEG])
    assert np.allclose(well.position(120.0), [0.0, 120.0 * math.sin(20 * DEG), 120.0 * math.cos(20 * DEG)], atol=1e-12)
    assert list(well.md) == [0.0, 120.0, 150.0] and well.k1[0] == well.k2[0] == 0.0


def test_ten_thousand_crooked_arcs_leave_the_frame_orthonormal():
    rng = np.random.default_rng(1)
    n = 10_000
    well = from_survey(np.arange(n) * 3.0, np.abs(np.cumsum(rng.normal(0, 1e-3, n))), rng.uniform(0, 2 * math.pi, n))
    frames = np.stack([well.m1s, well.m2s, well.tangents], axis=1)
    assert np.abs(frames @ np.swapaxes(frames, 1, 2) - np.eye(3)).max() < 1e-14


@pytest.mark.parametrize(
    ("md", "inc", "azi", "says"),
    [
        ([0, 10], [0], [0, 0], "different lengths"),
        ([0, 10], [0, math.nan], [0, 0], "inc is not a finite number at station 1"),
        ([0, 10, 10], [0, 0, 0], [0, 0, 0], "not below the one before"),
        ([0, 10, 9], [0, 0, 0], [0, 0, 0], "not below the one before"),
        ([-1, 10], [0, 0], [0, 0], "above the rotary table"),
        ([0, 10], [0, -0.1], [0, 0], "no inclination"),
        ([0], [0], [0], "no length"),
        ([], [], [], "no length"),
    ],
)
def test_stations_that_make_no_hole_are_refused(md, inc, azi, says):
    with pytest.raises(WellboreError, match=says):
        from_survey(md, inc, azi)
