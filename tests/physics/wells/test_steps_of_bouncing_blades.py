"""Steps that hide how blades make a bit bounce: a method that damps what they cannot follow shows smooth drilling.

The bit is one lump M on a spring K_s, with damping C, over chips of stiffness K = n a zeta eps, and each blade cuts
what the one before it left: M s^2 + C s + K_s + K (1 - exp(-s tau)) = 0, tau = 2 pi / (n Omega). Where a root lies
on the right, the bit swings up by itself until it leaves the bottom.
"""

import cmath
from math import pi, sqrt

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, E, area, straight_hole

from drillstring.model.build import build
from drillstring.warnings import warnings
from tautline.simulation import simulate
from tautline.study.accuracy.precision import TangentLook

LENGTH, WEIGHT, SPIN, N, A_ZETA_EPS, LOST = 200.0, 5e4, 100.0 * pi / 30.0, 4, 0.108 * 0.6 * 40e6, 2e-3
CHIPS, DELAY = N * A_ZETA_EPS, 2.0 * pi / (N * SPIN)
MASS, SPRING = DENSITY * area(*COLLAR) * LENGTH / 2.0, E * area(*COLLAR) / LENGTH
PERIOD = 2.0 * pi * sqrt(MASS / CHIPS)
CUTTING = {"specific_energy": "0.4 MPa", "inclination": 60.0, "radius": 0.108, "blades": N}
"""Nearly all of the cutting force is along the hole: torque would twist the string, and change the speed."""
LONG, SHORT = 0.1, 0.005


def drilled(step, **changes):
    """The lump at work, pushed a little at the start; it is lowered as fast as it drills."""
    feed = WEIGHT / A_ZETA_EPS * SPIN / (2.0 * pi)
    push = {"table": {"time": [0.0, 0.1, 0.2], "value": [0.0, 1e-5, 0.0]}}
    usual = {
        "length": LENGTH, "elements": 1, "bit": {"on_bottom": True, "weight": WEIGHT, "cutting": CUTTING},
        "top__rotation": SPIN, "top__block": {"velocity": {"sum": [feed, push]}}, "well__wall": "none",
        "solver__rho_inf": 0.5, "solver__step": step, "solver__end": 4.0, "output__interval": 0.02,
        "damping": {"structural": LOST},
    }  # fmt: skip
    return straight_hole(0.0, **(usual | changes))


def fastest_growth():
    """Largest real part of the roots, 1/s, by Newton's method from many places."""
    best = -np.inf
    for begin in np.arange(5.0, 60.0, 1.0):
        s = complex(1.0, begin)
        for _ in range(60):
            late = CHIPS * cmath.exp(-s * DELAY)
            value = MASS * s * s + LOST * SPRING * s + SPRING + CHIPS - late
            s -= value / (2.0 * MASS * s + LOST * SPRING + DELAY * late)
        if abs(value) < 1e-6 * CHIPS and s.imag > 1.0:
            best = max(best, s.real)
    return best


def swing(result, begin, end):
    """Size of the swing of the weight on bit between two times, N."""
    weight = result["weight_on_bit"][(result.time >= begin) & (result.time <= end)]
    return float((weight - WEIGHT).std())


def checked(scene):
    return [one for one in warnings(scene) if "blades" in one.text]


def said(result):
    return [one for one in result.attributes["warnings"] if "blades" in one]


@pytest.mark.parametrize("step", [SHORT, "auto"])
def test_a_step_that_is_short_enough_shows_how_the_bit_swings_up_and_nothing_is_said(step):
    result = simulate(build(drilled(step)))
    found = np.log(swing(result, 3.0, 4.0) / swing(result, 1.0, 2.0)) / 2.0
    assert found == pytest.approx(fastest_growth(), rel=0.1) and fastest_growth() > 1.0
    assert not said(result) and not checked(drilled(step))


def test_a_step_that_hides_it_is_told_when_the_scene_is_checked_and_after_the_run():
    scene = drilled(LONG, output__interval=0.1)
    result = simulate(build(scene))
    assert swing(result, 3.0, 4.0) < 0.1 * swing(result, 0.5, 1.5), "the swing dies out, in truth it grows"
    (before,), (after,) = checked(scene), said(result)
    assert before.where == "solver.step" and before.text == after and "smooth drilling" in after


@pytest.mark.parametrize(("spin", "least"), [(SPIN, 0.03 * PERIOD), (10.0 * SPIN, DELAY / 200.0)])
def test_the_longest_step_is_a_share_of_the_period_on_the_chips_or_of_the_delay_between_blades(spin, least):
    for share, told in ((0.98, False), (1.02, True)):
        scene = drilled(share * least, top__rotation=spin, output__interval=share * least)
        assert bool(checked(scene)) is told


def test_a_bit_that_cuts_nothing_in_the_run_needs_no_short_step():
    rubs = {"on_bottom": True, "weight": 1e3, "cutting": CUTTING | {"wear_flat": "1 mm", "contact_strength": "60 MPa"}}
    bare = {"on_bottom": True, "weight": WEIGHT, "cutting": {"specific_energy": "40 MPa"}}
    for changes in ({"bit": rubs, "top__block": 0.0}, {"top__rotation": -SPIN}, {"bit": bare}):
        assert not checked(drilled(LONG, output__interval=LONG, **changes))
    assert checked(drilled(LONG, output__interval=LONG, bit=rubs))


@pytest.mark.parametrize("flats", [{}, {"wear_flat": "0.5 mm", "contact_strength": "60 MPa"}], ids=["sharp", "worn"])
def test_the_tangent_of_blades_that_have_just_committed_their_cut_is_not_called_wrong(flats):
    """The bit stands on a kink in its angle and, with flats that bear all they can, on one in its depth."""
    cutting = {"specific_energy": "120 MPa", "radius": 0.108, "blades": 8} | flats
    scene = drilled(
        5e-4, bit={"on_bottom": True, "weight": 6e4, "cutting": cutting}, length=400.0, elements=8, solver__end=0.2,
        output__interval=2e-3,
    )  # fmt: skip
    model = build(scene)
    look = TangentLook(model.system)
    simulate(model, look=look)
    assert len(look.errors) > 4 and max(look.errors) < 1e-6
