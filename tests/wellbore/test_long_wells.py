"""Wells of many arcs: put together in plain numbers, they are the curves that arrays give."""

import math

import numpy as np

from drillstring.well import wellbore
from drillstring.well.sections import direction, dogleg, plain_direction
from drillstring.well.wellbore import Build, Hold, Turn, from_sections, from_survey


def by_arrays(well):
    """Frames and positions at the joints of a well, each carried along its arc by array operations."""
    r, m1, m2, t = (values[0] for values in (well.positions, well.m1s, well.m2s, well.tangents))
    joints = [(r, m1, m2, t)]
    for i, length in enumerate(np.diff(well.md)):
        r, m1, m2, _ = wellbore._along_arc(r, m1, m2, t, well.k1[i], well.k2[i], length)
        t = well.tangents[i + 1]
        m1 = m1 - (m1 @ t) * t
        m1 = m1 / np.linalg.norm(m1)
        m2 = np.cross(t, m1)
        joints.append((r, m1, m2, t))
    return [np.array(values) for values in zip(*joints, strict=True)]


def wells():
    rng = np.random.default_rng(8)
    md = np.cumsum(rng.uniform(0.0, 40.0, 300))
    inc = np.abs(np.cumsum(rng.normal(0.0, 0.02, 300)))
    inc[:20] = 0.0
    yield from_survey(md, inc, np.cumsum(rng.normal(0.0, 0.05, 300)))
    yield from_sections([Hold(500.0), Build(900.0, 0.7, 1.1), Turn(700.0, -2.0), Hold(0.0), Build(400.0, 0.1)])
    yield from_sections([Turn(500.0, 1.5), Hold(30.0)], 0.8, 1.4)


def test_a_well_is_the_one_that_array_operations_on_each_arc_give():
    for well in wells():
        for found, wanted in zip((well.positions, well.m1s, well.m2s, well.tangents), by_arrays(well), strict=True):
            assert np.allclose(found, wanted, rtol=1e-13, atol=1e-13 * max(1.0, np.abs(wanted).max()))
        assert all(array.flags.c_contiguous and array.dtype == float for array in vars(well).values())


def test_each_interval_of_a_survey_is_walked_once(monkeypatch):
    walked = []
    step = wellbore._step_along
    monkeypatch.setattr(wellbore, "_step_along", lambda *given: walked.append(given) or step(*given))
    from_survey(np.linspace(0.0, 3000.0, 501), np.linspace(0.0, 1.0, 501), np.full(501, 0.3))
    assert len(walked) == 500


def test_a_direction_in_plain_numbers_is_that_of_arrays():
    for inclination, azimuth in ((0.0, 0.0), (0.3, 5.0), (2.9, -1.0)):
        assert np.allclose(plain_direction(inclination, azimuth), direction(inclination, azimuth), rtol=0, atol=1e-16)


def test_arcs_of_a_turn_bend_by_their_doglegs():
    well = from_sections([Turn(800.0, 1.0)], 0.6, 0.2)
    bend = np.hypot(well.k1, well.k2) * np.diff(well.md)
    assert len(bend) == math.ceil(0.8 / math.radians(0.25))
    assert np.allclose(bend, dogleg(well.tangents[:-1], well.tangents[1:]), rtol=1e-12)
