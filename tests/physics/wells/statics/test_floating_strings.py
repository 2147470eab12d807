"""A string that is lighter than the mud lies on the high side of its hole: limits of buckling, torque and drag.

Weight turned round is the hole seen from below: the limits of F^2 = m EI N(F)/r have w^2 and w t'_z in N, and so stay
as they are where the weight and the way in which the hole turns change their signs together (He and Kyllingstad,
"Helical buckling and lock-up conditions for coiled tubing in curved wells", SPE Drilling & Completion 10(1), 1995).
"""

import numpy as np
import pytest
from physics.wells.strings import GRAVITY, area, mass_per_length, straight_hole

from drillstring.statics.statics import Statics
from drillstring.string.buckling import limits

MUD, INCLINATION, FRICTION = 1600.0, np.radians(30.0), 0.3
PIPE, CASING = (0.127, 0.0762), (0.244475, 0.2204974)
LENGTHS = 1100.0, 400.0
RIGIDITY, CLEARANCE, WEIGHT = 2.06e6, 0.03, 62.48


def limits_of(weight, down, turn, curvature):
    """Sine and helix, N."""
    given = (RIGIDITY, CLEARANCE, weight, down, turn, curvature)
    return [float(one[0]) for one in limits(*(np.array([float(x)]) for x in given))]


@pytest.mark.parametrize("inclination", [0.0, 0.01, 0.5, 1.5])
def test_string_that_floats_in_a_straight_hole_buckles_where_one_as_heavy_does(inclination):
    floating, sunk = (limits_of(w, np.cos(inclination), 0.0, 0.0) for w in (-WEIGHT, WEIGHT))
    side = WEIGHT * np.sin(inclination)
    along = np.cbrt(RIGIDITY * (WEIGHT * np.cos(inclination)) ** 2)
    exact = [max(np.sqrt(m * RIGIDITY * side / CLEARANCE), n * along) for m, n in ((4.0, 2.55), (8.0, 5.55))]
    assert floating == sunk == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize("turn", [-0.5, 0.3, 1.0])
def test_string_that_floats_where_the_hole_builds_buckles_as_one_that_sinks_where_it_drops(turn):
    curvature, down = 1.0 / 300.0, np.cos(0.5)
    # In the plane of the hole t'_z is up to the sine of the inclination times the curvature.
    turn *= curvature * np.sin(0.5)
    floating = limits_of(-WEIGHT, down, turn, curvature)
    assert floating == limits_of(WEIGHT, down, -turn, curvature)
    for factor, force in zip((4.0, 8.0), floating, strict=True):
        side = np.sqrt((curvature * force) ** 2 + 2.0 * force * WEIGHT * turn + (WEIGHT * np.sin(0.5)) ** 2)
        least = {4.0: 2.55, 8.0: 5.55}[factor] * np.cbrt(RIGIDITY * (WEIGHT * down) ** 2)
        assert force == pytest.approx(max(least, np.sqrt(factor * RIGIDITY * side / CLEARANCE)), rel=1e-6)


@pytest.mark.filterwarnings("error")
def test_statics_of_a_string_whose_casing_floats_are_the_closed_form_of_a_slant_hole():
    scene = straight_hole(
        INCLINATION, length=sum(LENGTHS), elements=60, diameter=0.31115, friction=FRICTION,
        mud={"density": MUD, "inside": False},
        string=[
            {"name": name, "od": od, "id": bore, "length": length}
            for name, (od, bore), length in zip(("pipe", "casing"), (PIPE, CASING), LENGTHS, strict=True)
        ],
    )  # fmt: skip
    weights = [GRAVITY * (mass_per_length(od, bore) - MUD * area(od, 0.0)) for od, bore in (PIPE, CASING)]
    assert weights[0] > 0.0 > weights[1]
    statics = Statics(scene, sum(LENGTHS), 60)
    for motion, sign in {"pick_up": 1.0, "slack_off": -1.0, "rotating": 0.0}.items():
        exact = sum(
            length * (w * np.cos(INCLINATION) + sign * FRICTION * abs(w) * np.sin(INCLINATION))
            for w, length in zip(weights, LENGTHS, strict=True)
        )
        # The lumps on the way from the low side to the high one touch neither.
        assert statics.solve(FRICTION, motion).hook_load == pytest.approx(exact, rel=0.01)
