"""Where a soft string becomes a helix its wall force jumps: the place within a step counts as exactly as the rest.

The reference integrates the same equations with scipy, along a well of its own, from one crossing of the limit to the
next. In a hole that builds in one plane, of curvature k and inclination i, the load on the wall per length is
N = |T k - w sin i|, and compression F = -T makes a helix of the string from F^2 = 8 EI (F k + w sin i)/r on, at least
5.55 (EI w^2 cos^2 i)^(1/3), and that presses with r F^2/(4 EI). Where a step of 5 m is not split there it is 1.4e-3
off in the level hole and 7.5e-4 in the arc, and where it is 1e-6.
"""

import numpy as np
import pytest
from physics.wells.strings import GRAVITY, E, area
from scipy.integrate import solve_ivp

from drillstring.statics.motion import Motion
from drillstring.statics.soft_string import soft_string
from drillstring.string.lumps import Tube
from drillstring.well.sections import Build, Hold
from drillstring.well.wellbore import from_sections

OD, BORE, HOLE, FRICTION = 0.127, 0.1086104, 0.2159, 0.3
W = GRAVITY * (7850.0 - 1200.0) * area(OD, BORE)
RIGIDITY = E * np.pi / 64.0 * (OD**4 - BORE**4)
CLEARANCE = 0.5 * (HOLE - OD)
WELLS = {"level": (1.0, 300.0, 2000.0), "arc": (300.0, 150.0, 800.0)}


def string_in(lengths, step, motion, force):
    """The program's: a piece straight down, an arc of a radius to level, and a level piece, m."""
    above, radius, level = lengths
    well = from_sections([Hold(above), Build(radius, 0.5 * np.pi), Hold(level)])
    total = above + 0.5 * np.pi * radius + level
    tube = Tube("pipe", total, OD, BORE, OD, E, 79e9, 7850.0, 7850.0 * area(OD, BORE), RIGIDITY / E)
    return soft_string(well, [tube], [W], FRICTION, motion, -force, HOLE, step)


def reference(lengths, along, around, force):
    """Hook load N, torque N m, and number of changes, by friction factors along the hole and around it."""
    above, radius, level = lengths
    arc = 0.5 * np.pi * radius
    state, changes = np.array([-force, 0.0]), 0
    for length, curvature, bottom in ((level, 0.0, 0.5 * np.pi), (arc, 1.0 / radius, 0.5 * np.pi), (above, 0.0, 0.0)):

        def excess(s, state, curvature=curvature, bottom=bottom):
            i = bottom - s * curvature
            pushed = max(0.0, -state[0])
            curved = 8.0 * RIGIDITY / CLEARANCE * (pushed * curvature + W * np.sin(i))
            return pushed - max(np.sqrt(curved), 5.55 * np.cbrt(RIGIDITY * (W * np.cos(i)) ** 2))

        done, coiled = 0.0, excess(0.0, state) >= 0.0
        while done < length:

            def slope(s, state, curvature=curvature, bottom=bottom, coiled=coiled):
                i = bottom - s * curvature
                wall = abs(state[0] * curvature - W * np.sin(i)) / np.sqrt(1.0 + around**2)
                if coiled:
                    wall = max(wall, CLEARANCE * state[0] ** 2 / (4.0 * RIGIDITY))
                return W * np.cos(i) + along * wall, abs(around) * wall * 0.5 * OD

            excess.terminal, excess.direction = True, -1.0 if coiled else 1.0
            found = solve_ivp(slope, (done, length), state, events=excess, rtol=1e-10, atol=1e-6, max_step=2.0)
            done, state = float(found.t[-1]), found.y[:, -1]
            if found.status == 1:
                coiled, changes = not coiled, changes + 1
    return *state, changes


@pytest.mark.parametrize(("well", "force"), [("level", 150e3), ("arc", 200e3), ("arc", 190e3)])
@pytest.mark.parametrize("step", [5.0, 1.0])
def test_soft_string_slacked_off_that_becomes_a_helix_is_the_integral_to_a_few_millionths(well, force, step):
    exact, _, changes = reference(WELLS[well], -FRICTION, 0.0, force)
    found = string_in(WELLS[well], step, "slack_off", force)
    assert changes > 0 and found.locked is None
    assert found.hook_load == pytest.approx(exact, rel=3e-6)


@pytest.mark.parametrize(("motion", "force"), [(Motion(0.0, 1.0), 80e3), (Motion(0.2, 3.0), 200e3)])
def test_torque_of_a_string_that_turns_and_is_a_helix_in_part_is_the_integral(motion, force):
    along, around = motion.friction(0.5 * OD)
    exact, torque, changes = reference(WELLS["arc"], FRICTION * along, FRICTION * around, force)
    found = string_in(WELLS["arc"], 5.0, motion, force)
    assert changes > 0
    assert found.hook_load == pytest.approx(exact, rel=3e-6)
    assert found.surface_torque == pytest.approx(torque, rel=1e-5)
