"""Planned wells: closed forms for builds, an independent integration for turns, refusals."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillstring.well import sections
from drillstring.well.wellbore import Build, Hold, Turn, WellboreError, from_sections

DEG = math.pi / 180.0


def test_the_j_well_ends_3200_m_down_and_1000_m_north_at_3770_796_m():
    well = from_sections([Hold(2200.0), Build(1000.0, 90 * DEG, 0.0)])
    assert well.length == pytest.approx(2200.0 + 500.0 * math.pi, abs=1e-12)
    assert np.allclose(well.position(well.length), [1000.0, 0.0, 3200.0], atol=1e-11)
    assert well.length == pytest.approx(3770.796, abs=5e-4)
    k1, k2 = well.curvature(3000.0)
    assert (k1, k2) == (pytest.approx(1e-3, abs=1e-18), pytest.approx(0.0, abs=1e-18))
    assert well.turning(well.length)[0] == pytest.approx(math.pi / 2, abs=1e-14)


def test_the_bit_past_the_j_wells_end_is_on_the_same_circle():
    well = from_sections([Hold(2200.0), Build(1000.0, 90 * DEG, 0.0)])
    angle = (well.length + 1.64 - 2200.0) / 1000.0
    expected = [1000.0 - 1000.0 * math.cos(angle), 0.0, 2200.0 + 1000.0 * math.sin(angle)]
    assert np.allclose(well.position(well.length + 1.64), expected, atol=1e-10)


def test_a_vertical_well_keeps_north_east_down():
    well = from_sections([Hold(1500.0)])
    s = np.linspace(-10.0, 1600.0, 9)
    assert np.allclose(well.position(s), np.outer(s, [0, 0, 1]))
    assert np.allclose(well.frame(s), np.eye(3)[:, None, :], atol=0.0)
    assert np.all(well.inclination(s) == 0.0) and np.all(well.azimuth(s) == 0.0)


def test_a_closed_circle_comes_back_to_where_it_began():
    # Down, north, up; at the top of the inclination the azimuth picks south; down again. 360 deg of turning.
    well = from_sections([Build(250.0, 180 * DEG, 0.0), Build(250.0, 0.0, 180 * DEG)])
    assert well.length == pytest.approx(500.0 * math.pi, abs=1e-10)
    assert np.allclose(well.position(well.length), 0.0, atol=1e-11)
    assert np.allclose(well.frame(well.length), np.eye(3), atol=1e-14)
    assert well.turning(well.length)[0] == pytest.approx(2 * math.pi, abs=1e-14)
    centre = well.position(np.linspace(0.0, well.length, 77)) - [250.0, 0.0, 0.0]
    assert np.allclose(np.linalg.norm(centre, axis=-1), 250.0, atol=1e-11)


def test_an_s_well_drops_back_to_the_vertical_by_closed_form():
    well = from_sections([Hold(400.0), Build(600.0, 40 * DEG, 90 * DEG), Hold(500.0), Build(800.0, 0.0), Hold(100.0)])
    c, s = math.cos(40 * DEG), math.sin(40 * DEG)
    east = 600.0 * (1 - c) + 500.0 * s + 800.0 * (1 - c)
    down = 400.0 + 600.0 * s + 500.0 * c + 800.0 * s + 100.0
    assert np.allclose(well.position(well.length), [0.0, east, down], atol=1e-10)
    assert np.allclose(well.frame(well.length), np.eye(3), atol=1e-14)


def exact_turn(inclination, start, change, radius):
    """Position and Bishop frame at the end of a turn, from its own equations, with the frame carried by integration.

    t = (sin I cos a, sin I sin a, cos I), a' = 1/(R sin I), t' = (-sin a, cos a, 0)/R, m' = -(m . t') t.
    """
    level, deep = math.sin(inclination), math.cos(inclination)
    length = radius * level * abs(change)

    def slope(s, y):
        a = start + change * s / length
        t = np.array([level * math.cos(a), level * math.sin(a), deep])
        bend = math.copysign(1.0 / radius, change) * np.array([-math.sin(a), math.cos(a), 0.0])
        m1, m2 = y[3:6], y[6:9]
        return np.concatenate([t, -(m1 @ bend) * t, -(m2 @ bend) * t])

    return slope, length


@pytest.mark.parametrize(("inclination", "to"), [(45, 120), (8, 170), (85, -60), (120, 30)])
def test_a_turn_follows_the_exact_curve_of_constant_inclination(inclination, to):
    well = from_sections([Turn(500.0, to * DEG)], inclination * DEG, 10 * DEG)
    slope, length = exact_turn(inclination * DEG, 10 * DEG, (to - 10) * DEG, 500.0)
    start = np.concatenate([np.zeros(3), well.m1s[0], well.m2s[0]])
    end = solve_ivp(slope, (0.0, length), start, rtol=1e-12, atol=1e-12, method="DOP853").y[:, -1]
    assert well.length == pytest.approx(length, rel=1e-13)
    assert np.abs(end[:3] - well.position(well.length)).max() < 1e-6 * length  # measured 6e-7, 0.4 mm in 680 m
    assert np.abs(end[3:6] - well.frame(well.length)[0]).max() < 1e-6
    assert np.allclose(np.hypot(well.k1, well.k2), 1 / 500.0, rtol=1e-6)
    assert np.allclose(well.inclination(well.md), inclination * DEG, atol=1e-14)
    assert np.ptp(well.inclination(np.linspace(0.0, length, 4001))) < 2.4e-6  # (0.25 deg)**2 / 8 at most


def test_a_turns_end_point_and_frame_converge_with_the_square_of_the_step(monkeypatch):
    slope, length = exact_turn(50 * DEG, 0.0, 100 * DEG, 300.0)
    errors = []
    for step in (2.0, 1.0, 0.5):
        monkeypatch.setattr(sections, "TURN_STEP", step * DEG)
        well = from_sections([Turn(300.0, 100 * DEG)], 50 * DEG, 0.0)
        start = np.concatenate([np.zeros(3), well.m1s[0], well.m2s[0]])
        end = solve_ivp(slope, (0.0, length), start, rtol=1e-13, atol=1e-13, method="DOP853").y[:, -1]
        errors.append(
            [
                np.linalg.norm(end[:3] - well.position(length)),
                np.linalg.norm(end[3:6] - well.frame(length)[0]),
                np.abs(np.hypot(well.k1, well.k2) * 300.0 - 1.0).max(),
            ]
        )
    rates = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.allclose(rates, 2.0, atol=0.02)


def test_a_turn_takes_the_short_way_over_north():
    well = from_sections([Turn(400.0, 10 * DEG)], 60 * DEG, 350 * DEG)
    assert well.length == pytest.approx(400.0 * math.sin(60 * DEG) * 20 * DEG, rel=1e-13)
    azimuth = np.degrees(well.azimuth(np.linspace(1.0, well.length, 50)))
    assert np.all((azimuth >= 350.0) | (azimuth <= 10.0 + 1e-9))


def test_a_level_turn_is_a_circle_in_the_horizontal_plane():
    well = from_sections([Turn(200.0, 90 * DEG)], 90 * DEG, 0.0)
    assert np.allclose(well.position(well.length), [200.0, 200.0, 0.0], atol=1e-10)


def test_an_inclined_start_carries_the_frame_from_the_vertical():
    inclined = from_sections([Hold(10.0)], 35 * DEG, 70 * DEG)
    drilled = from_sections([Build(100.0, 35 * DEG, 70 * DEG), Hold(10.0)])
    assert np.allclose(inclined.frame(0.0), drilled.frame(drilled.length), atol=1e-15)


def test_sections_cut_in_two_give_the_same_hole_and_frame():
    whole = from_sections([Hold(100.0), Build(300.0, 60 * DEG, 1.0), Turn(300.0, 2.0), Hold(60.0)])
    halves = from_sections(
        [Hold(37.0), Hold(63.0), Build(300.0, 20 * DEG, 1.0), Build(300.0, 60 * DEG), Turn(300.0, 2.0), Hold(60.0)]
    )
    s = np.linspace(0.0, whole.length, 300)
    assert halves.length == pytest.approx(whole.length, abs=1e-10)
    assert np.allclose(whole.position(s), halves.position(s), atol=1e-10)
    assert np.allclose(whole.frame(s), halves.frame(s), atol=1e-12)
    assert np.allclose(whole.turning(s), halves.turning(s), atol=1e-12)


def test_sections_of_no_length_are_dropped():
    well = from_sections(
        [Hold(0.0), Hold(10.0), Build(50.0, 0.0), Build(50.0, 1.0, 0.5), Build(9.0, 1.0), Turn(9.0, 0.5)]
    )
    assert len(well.k1) == 2 and np.all(np.diff(well.md) > 0.0)


REFUSED = {
    "hold below zero": ([Hold(5.0), Hold(-1.0)], "negative", 1),
    "hold not a number": ([Hold(math.nan)], "not a finite number", 0),
    "radius of zero": ([Build(0.0, 1.0)], "positive radius", 0),
    "infinite radius": ([Build(math.inf, 1.0)], "not a finite number", 0),
    "inclination beyond 180 deg": ([Build(100.0, 200 * DEG)], "0 to 180 deg", 0),
    "build off the azimuth": ([Build(100.0, 1.0, 0.0), Build(100.0, 1.2, 0.3)], "use turn", 1),
    "turn of a vertical hole": ([Hold(5.0), Turn(100.0, 1.0)], "before the turn", 1),
    "turn upside down": ([Build(100.0, math.pi), Turn(100.0, 1.0)], "before the turn", 1),
    "turn by half a circle": ([Build(100.0, 1.0, 0.5), Turn(100.0, 0.5 + math.pi)], "two turns", 1),
    "turn to no number": ([Build(100.0, 1.0), Turn(100.0, math.nan)], "not a finite number", 1),
    "no sections": ([], "at least one section", None),
    "no length": ([Hold(0.0), Build(100.0, 0.0)], "at least one section", None),
}


@pytest.mark.parametrize("case", REFUSED)
def test_a_well_that_cannot_be_drilled_is_refused_with_a_cure(case):
    wrong, says, index = REFUSED[case]
    with pytest.raises(WellboreError, match=says) as caught:
        from_sections(wrong)
    assert isinstance(caught.value, ValueError) and caught.value.cure and caught.value.index == index


def test_a_build_may_repeat_the_present_azimuth_a_whole_turn_off():
    well = from_sections([Build(100.0, 0.5, -10 * DEG), Build(100.0, 1.0, 350 * DEG)])
    assert np.degrees(well.azimuth(well.length)) == pytest.approx(350.0, abs=1e-10)


def test_a_start_outside_0_to_180_deg_is_refused():
    with pytest.raises(WellboreError, match="inclination"):
        from_sections([Hold(1.0)], inclination=-0.1)
