"""The critical step of RK4 that `check` prints, against the eigenvalues of a chain of lumps, and a lump at the wall."""

from math import sqrt

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, E, area, mass_per_length, straight_hole

from drillstring.application import Drillstring
from drillstring.warnings import figures, warnings

LENGTH = 100.0


def of_a_chain(elements):
    """sqrt(8) / omega of lumps in a row, m, the upper one held and the last of half the mass, by numpy."""
    link = LENGTH / elements
    k, m = E * area(*COLLAR) / link, DENSITY * area(*COLLAR) * link
    stiffness = 2.0 * np.eye(elements) - np.eye(elements, k=1) - np.eye(elements, k=-1)
    mass = np.ones(elements)
    stiffness[-1, -1], mass[-1] = 1.0, 0.5
    root = 1.0 / np.sqrt(mass)
    largest = np.linalg.eigvalsh(root[:, None] * stiffness * root).max()
    return sqrt(8.0 / (largest * k / m))


@pytest.mark.parametrize("changes", [{}, {"well__wall": "none"}], ids=["soft wall", "no wall"])
@pytest.mark.parametrize("elements", [10, 100])
def test_the_critical_step_is_that_of_the_links_where_these_are_the_fastest(elements, changes):
    usual = {"well__wall": {"stiffness": 1e3, "lumps": elements}}
    found = figures(straight_hole(0.3, LENGTH, elements, **usual | changes))["critical_step_rk4"]
    assert found == pytest.approx(of_a_chain(elements), rel=0.015)


def test_the_critical_step_is_that_of_the_wall_where_it_is_the_stiffest():
    found = figures(straight_hole(0.3, LENGTH, 10, well__wall={"stiffness": 1e11, "lumps": 10}))["critical_step_rk4"]
    # A whole lump on its spring; the reach on the imaginary axis is rounded down to 2.8.
    assert found == pytest.approx(sqrt(8.0 / (1e11 / (mass_per_length() * LENGTH / 10))), rel=0.015)


# Frames of 1.6 critical steps are divided into steps of 0.8, and what is left at the end into steps that are no longer.
@pytest.mark.parametrize(
    ("step", "interval", "end", "warned"),
    [(1.1, 1.1, 110.0, True), (1.1, 1.2, 120.0, False), (1.5, 1.6, 161.4, False), (1.5, 1.6, 160.9, False)],
)
def test_a_step_of_rk4_that_is_too_long_for_the_links_is_warned_of_and_one_that_frames_divide_is_not(
    step, interval, end, warned
):
    limit = of_a_chain(100)
    solver = {"method": "rk4", "step": step * limit, "end": end * limit}
    told = warnings(straight_hole(0.3, LENGTH, 100, solver=solver, output={"interval": interval * limit}))
    assert any("longer than RK4's critical step" in str(one) for one in told) == warned


def test_check_prints_the_critical_step_of_a_string_without_a_wall():
    app = Drillstring()
    rows = dict(app.describe(app.check_figures(straight_hole(0.3, LENGTH, 10, well__wall="none"))))
    assert rows["critical step of RK4, about"]
