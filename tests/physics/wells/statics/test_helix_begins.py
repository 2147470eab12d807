"""Where a soft string becomes a helix its wall force jumps: the place within a step counts as exactly as the rest.

The reference integrates the same equations with scipy, along a well of its own, from one crossing of the limit to the
next. In a hole that builds in one plane, of curvature k and inclination i, the load on the wall per length is
N = |T k - w sin i|, and compression F = -T makes a helix of the string from F^2 = 8 EI (F k + w sin i)/r on, at least
5.55 (EI w^2 cos^2 i)^(1/3), and that presses with r F^2/(4 EI). Where a step of 5 m is not split there it is 1.4e-3
off in the level hole and 7.5e-4 in the arc, and where it is 1e-6. In a hole that drops k is below zero. There the limit
goes to zero towards the vertical, but is 8 EI |k|/r at it.
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
LEVEL, SLANT = 0.5 * np.pi, np.pi / 3.0
WELLS = {
    "level": [Hold(1.0), Build(300.0, LEVEL), Hold(2000.0)],
    "arc": [Hold(300.0), Build(150.0, LEVEL), Hold(800.0)],
    "drop": [Hold(500.0), Build(300.0, SLANT), Hold(300.0), Build(1500.0, 0.0), Hold(300.0)],
}


def pieces_of(sections):
    """Length m, curvature 1/m, above zero where it builds, and inclination at the lower end, of each piece down."""
    above = 0.0
    for one in sections:
        turned = one.to - above if isinstance(one, Build) else 0.0
        above += turned
        yield (
            (one.length, 0.0, above)
            if turned == 0.0
            else (abs(turned) * one.radius, np.sign(turned) / one.radius, above)
        )


def string_in(sections, step, motion, force):
    """The program's."""
    total = sum(length for length, *_ in pieces_of(sections))
    tube = Tube("pipe", total, OD, BORE, OD, E, 79e9, 7850.0, 7850.0 * area(OD, BORE), RIGIDITY / E)
    return soft_string(from_sections(sections), [tube], [W], FRICTION, motion, -force, HOLE, step)


def reference(sections, along, around, force):
    """Hook load N, torque N m, and number of changes, by friction factors along the hole and around it."""
    state, changes = np.array([-force, 0.0]), 0
    for length, curvature, bottom in reversed([*pieces_of(sections)]):

        def excess(s, state, curvature=curvature, bottom=bottom):
            i = bottom - s * curvature
            half, ratio = 4.0 * RIGIDITY / CLEARANCE * curvature, 8.0 * RIGIDITY / CLEARANCE
            curved = half + np.sqrt(half**2 + ratio * W * max(0.0, np.sin(i)))
            return -state[0] - max(curved, 5.55 * np.cbrt(RIGIDITY * (W * np.cos(i)) ** 2))

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


@pytest.mark.parametrize("force", [150e3, 170e3])
@pytest.mark.parametrize("step", [5.0, 1.0])
def test_a_string_that_is_a_helix_where_its_hole_drops_to_the_vertical_is_the_integral(force, step):
    exact, _, changes = reference(WELLS["drop"], -FRICTION, 0.0, force)
    found = string_in(WELLS["drop"], step, "slack_off", force)
    assert changes > 0 and found.locked is None
    assert found.hook_load == pytest.approx(exact, rel=1e-6)


@pytest.mark.parametrize(("motion", "force"), [(Motion(0.0, 1.0), 80e3), (Motion(0.2, 3.0), 200e3)])
def test_torque_of_a_string_that_turns_and_is_a_helix_in_part_is_the_integral(motion, force):
    along, around = motion.friction(0.5 * OD)
    exact, torque, changes = reference(WELLS["arc"], FRICTION * along, FRICTION * around, force)
    found = string_in(WELLS["arc"], 5.0, motion, force)
    assert changes > 0
    assert found.hook_load == pytest.approx(exact, rel=3e-6)
    assert found.surface_torque == pytest.approx(torque, rel=1e-5)
