"""The error of a friction factor that is fitted to hook loads, against loads of a string of known friction.

The loads are those of a soft string in a channel of the hole's width, with friction 0.3 and points 0.1 m apart along
the vertical, the arc and the slant of the well below (tests/references/channel_string.py). Those without clearance were
integrated apart from this program too, dT/ds by 40 000 steps of the midpoint rule. They are not the loads of a string
in this hole: picked up, it crosses from the upper to the lower side at the end of the build, and nothing rubs there.
"""

from functools import cache
from unittest import mock

import numpy as np
import pytest
import yaml
from of_the_suite import studies

import tautline
from drillstring.statics import back_calculation
from drillstring.statics.back_calculation import Measured, fit
from drillstring.view.torque_summary import fit_in_words

FRICTION, FOOT, KLBF = 0.3, 0.3048, 4448.2216
WELL = yaml.safe_load("""
title: A well that builds to 45 degrees
well:
  sections:
    - {hold: 3000 ft}
    - {build: {rate: 3 deg/100ft, to: 45 deg, azimuth: 30 deg}}
    - {hold: 4000 ft}
  diameter: 8.5 in
  wall: {stiffness: 1.0e+9, damping: 5.0e+6, friction: {static: 0.25, kinetic: 0.25}}
string:
  - {name: drill pipe, length: rest, od: 5 in, id: 4.276 in}
  - {name: BHA, length: 600 ft, od: 6.5 in, id: 2.8125 in}
material: {youngs_modulus: 30e6 psi, shear_modulus: 11.5e6 psi, density: 7850 kg/m^3}
mud: {density: 10 ppg, added_mass: 1.0, drag: 1.0, inside: true}
top: {block: {constant: 0}, rotation: {constant: 0}}
bit: {on_bottom: false}
model: {kind: lumped, elements: 100, bending: stiff}
solver: {method: generalized-alpha, step: 1 ms, end: 1 s}
output: {interval: 50 ms}
""")
LOADS = np.array(
    [
        [5000.0, 117.1982, 84.1694],
        [6000.0, 135.5610, 89.9866],
        [7000.0, 153.1988, 95.9756],
        [8000.0, 170.8452, 101.9570],
    ]
)
WITHOUT_CLEARANCE = np.array(
    [
        [5000.0, 117.5110, 84.0944],
        [6000.0, 135.9245, 89.8710],
        [7000.0, 153.6322, 95.8234],
        [8000.0, 171.3304, 101.7718],
    ]
)


@cache
def counted(elements, without_clearance=False):
    """The fit, and of how many elements each string was that it made, and each that it solved."""
    made, solved = [], []

    class Counted(back_calculation.Statics):
        def __init__(self, scene, depth, elements, **how):
            super().__init__(scene, depth, elements, **how)
            made.append(elements)
            self.elements = elements

        def solve(self, friction, motion):
            solved.append(self.elements)
            return super().solve(friction, motion)

    depth, up, down = (WITHOUT_CLEARANCE if without_clearance else LOADS).T
    measured = Measured(depth * FOOT, up * KLBF, down * KLBF, np.arange(depth.size) + 2)
    with mock.patch.object(back_calculation, "Statics", Counted):
        return fit(tautline.read(WELL), measured, elements), made, solved


@cache
def fitted(*how):
    return counted(*how)[0]


def test_the_error_of_a_fitted_factor_covers_that_of_the_model_and_shrinks_with_more_elements():
    few, many = fitted(50), fitted(200)
    for one in (few, many):
        assert abs(one.friction - FRICTION) < 1.2 * one.error, one
    assert abs(few.friction - FRICTION) > 5.0 * few.spread, "the scatter of the loads does not tell it"
    assert many.error < 0.7 * few.error
    assert "is that of the model" in fit_in_words(few)


@pytest.mark.parametrize("elements", [100, *studies(200)])
def test_the_error_of_a_fitted_factor_falls_with_the_elements_and_still_covers_the_channel_string(elements):
    found = fitted(elements)
    assert abs(found.friction - FRICTION) < found.error < 0.3 / elements


@pytest.mark.study
def test_loads_of_a_string_without_clearance_ask_for_more_friction_than_there_is_by_what_clearance_takes_off():
    # picked up it is 0.28 % of the hook load, whatever the number of elements
    assert fitted(200, True).friction - fitted(200).friction == pytest.approx(0.0031, abs=2e-4)


def test_more_elements_are_offered_only_where_it_is_they_that_make_the_error():
    coarse, fine = fitted(100), fitted(200)
    assert coarse.elements_error == coarse.model_error and fine.elements_error < fine.model_error
    assert "more make this smaller (--elements)" in fit_in_words(coarse)
    assert "--elements" not in fit_in_words(fine)
    assert f"More elements change it by about {fine.elements_error:.1g}" in fit_in_words(fine)


@pytest.mark.study
def test_elements_that_cannot_be_halved_are_doubled_to_see_the_error():
    found = fitted(2)
    assert np.isfinite(found.model_error) and found.model_error > 0.0
    assert found.error == pytest.approx(np.hypot(found.spread, found.model_error))


def test_the_error_of_the_model_costs_a_coarser_string_for_each_depth_and_one_solution_for_each_load():
    _, made, solved = counted(50)
    assert (made.count(50), made.count(25)) == (len(LOADS), len(LOADS))
    assert solved.count(25) == 2 * len(LOADS)
