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

from drillstring.drilling.end_groups import ROTATION, speeds_of
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


def test_blades_are_counted_that_something_outside_turns_while_the_scene_does_not():
    still = drilled(LONG, output__interval=LONG, top__rotation=0.0)
    assert not checked(still) and not checked(still.driven_by(("top.block_speed",)))
    for name in ("top.rotary_speed", "top.rotary_angle"):
        (told,) = checked(still.driven_by((name,)))
        assert float(told.text.split("longer than about ")[1].split(" s")[0]) == pytest.approx(0.03 * PERIOD, rel=0.05)


@pytest.mark.parametrize("turned", [
    {"table": {"time": [0.0, 1.0, 1.5, 2.0, 600.0], "value": [0.0, 0.0, SPIN, 0.0, 0.0]}},
    {"table": {"time": [0.0, 301.0, 301.5, 302.0, 600.0], "value": [0.0, 0.0, SPIN, 0.0, 0.0]}},
    {"harmonic": {"amplitude": SPIN, "period": 3.0}},
    {"harmonic": {"amplitude": SPIN, "period": 3.0, "phase": pi}},
    {"harmonic": {"amplitude": SPIN, "period": 3.0, "phase": 3.5}},
], ids=["pulse", "pulse between instants", "sine of which all instants show zeros", "the same, back first",
        "of which all show one side"])  # fmt: skip
def test_a_long_run_that_turns_the_bit_for_moments_only_is_counted_at_its_fastest(turned):
    scene = drilled(LONG, output__interval=LONG, top__rotation=turned, solver__end=600.0)
    assert checked(scene) and speeds_of(scene, ROTATION).max() == pytest.approx(SPIN, rel=1e-3)


def test_rounding_of_a_string_that_comes_to_rest_is_no_turn_forward():
    back = {"sum": [{"ramp": {"to": -0.37, "over": 1.3}}, {"ramp": {"to": 0.37, "over": 0.7, "at": 3.1}}]}
    scene = drilled(LONG, output__interval=LONG, top__rotation=back, solver__end=600.0)
    assert speeds_of(scene, ROTATION).max() == 0.0 and not checked(scene)


@pytest.mark.parametrize(("solver", "damps"), [
    ({"rho_inf": 0.5}, True), ({"rho_inf": 1.0}, False), ({"method": "newmark", "rho_inf": None}, False),
    ({"method": "rk4", "rho_inf": None}, True),
], ids=["damped", "rho_inf 1", "newmark", "rk4"])  # fmt: skip
def test_a_method_that_damps_nothing_is_not_said_to_damp(solver, damps):
    usual = {"method": "generalized-alpha", "step": LONG, "end": 4.0} | solver
    usual = {key: value for key, value in usual.items() if value is not None}
    scene = drilled(LONG, output__interval=LONG, solver=usual)
    texts = [one.text for one in warnings(scene)]
    (told,) = [one for one in texts if "bit with blades" in one]
    assert ("may damp that away" in told) is damps and ("do not follow that" in told) is not damps
    assert any("does not damp" in one for one in texts) is not damps


def test_steps_that_are_chosen_short_for_blades_are_told_and_warned_of_where_they_are_many():
    model = build(drilled("auto", output__interval=0.1))
    (note,) = [one for one in model.notes if "blades" in one]
    assert f"steps of {0.03 * PERIOD:.2g} s at most" in note
    assert not [one for one in build(drilled(SHORT)).notes if "blades" in one]
    for share, many in ((0.98, False), (1.02, True)):
        told = checked(drilled("auto", solver__end=share * 1e6 * 0.03 * PERIOD, output__interval=1e3))
        assert [one.where for one in told] == ["solver.step"] * many
        assert all("so the run takes 1e+06 steps" in one.text for one in told)


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
