"""Natural frequencies of the assembly against closed forms: beams under load or on a foundation, and rods.

Beams and rods: R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979, tables 8-1 and 8-16; a beam on an
elastic foundation: omega^2 = (k + EI b^4) / m with the b of the beam alone. A frequency may be off by twice the error
that is told with it, and the string's stretch.
"""

from math import pi, sqrt

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, GRAVITY, G, area, mass_per_length, shipped, straight_hole
from physics.wells.strings import E as YOUNG
from references import stepped_rod_modes as rods
from scipy.optimize import brentq

from drillstring.modes.bha import assembly_of, stabilisers_of
from drillstring.modes.campbell import campbell

LENGTH, MUD = 30.0, 1200.0
RIGIDITY = YOUNG * pi / 64 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
MASS = mass_per_length() + MUD * (area(COLLAR[0], 0.0) + area(COLLAR[1], 0.0))
EULER = RIGIDITY * (pi / LENGTH) ** 2
FAST = (0.0, 200.0 * 2.0 * pi / 60.0)


def beam(force=1.0, lateral="pinned", **changes):
    """A collar in mud, without gravity and wall, pinned in the drive; `force` at the bit, N, tension positive."""
    usual = {"gravity": 0.0, "well__wall": "none", "mud": {"density": MUD, "drag": 0.0}, "model__bending": "stiff"}
    return straight_hole(0.0, LENGTH, 4, **usual | {"bit": {"lateral": lateral, "force": float(force)}} | changes)


def lateral(scene, up_to=20.0, **asked):
    return campbell(scene, FAST, up_to=up_to, **asked).modes


def check(modes, exact, stretch=1e-6):
    for mode, f in zip(modes, exact, strict=True):
        assert abs(mode.frequency - f) <= 2.0 * mode.error + stretch * f, (mode.frequency, f, mode.error)
        assert mode.error < 5e-3 * f


@pytest.mark.parametrize("pull", [0.0, 0.5, 5.0])
def test_a_pinned_beam_in_tension_and_mud_has_the_frequencies_of_the_closed_form(pull):
    # omega = (n pi / L) sqrt((T + EI (n pi / L)^2) / m), m with added mass and the mud inside
    force = pull * EULER
    wave = np.arange(1, 8) * pi / LENGTH
    exact = wave * np.sqrt((force + RIGIDITY * wave**2) / MASS) / (2 * pi)
    modes = lateral(beam(force or 1e-6))
    check(modes, exact[exact <= 20.0], 2.0 * force / (YOUNG * area(*COLLAR)) + 1e-7)
    assert {mode.plane for mode in modes} == {"any plane"}


def test_a_beam_near_eulers_load_goes_to_zero_frequency_and_beyond_it_is_told_to_buckle():
    free = EULER / RIGIDITY * sqrt(RIGIDITY / MASS) / (2 * pi)
    for share in (0.5, 0.9, 0.99):
        (first, *_) = lateral(beam(-share * EULER))
        assert first.frequency == pytest.approx(free * sqrt(1.0 - share), rel=2e-2 if share == 0.99 else 1e-3)
    found = campbell(beam(-1.2 * EULER), FAST)
    assert found.unstable[0].frequency == pytest.approx(-free * sqrt(0.2), rel=1e-2)
    assert all(found.modes[one.mode].frequency > 0.0 for one in found.critical)


@pytest.mark.parametrize(
    ("end", "roots"),
    [("free", (1.87510407, 4.69409113, 7.85475744)), ("pinned", (3.92660231, 7.06858275, 10.21017612))],
)
def test_a_beam_that_is_held_at_its_upper_end_is_clamped_there(end, roots):
    # Blevins table 8-1: clamped-free and clamped-pinned; the upper third is held
    free = 20.0
    found = campbell(beam(1e-6, end), FAST, up_to=25.0, top=LENGTH - free)
    exact = (np.array(roots) / free) ** 2 * sqrt(RIGIDITY / MASS) / (2 * pi)
    assert found.top == pytest.approx(LENGTH - free, abs=1e-9)
    check(found.modes[:3], exact)


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
def test_sections_that_are_held_clamp_what_is_between_them(kind):
    # clamped-clamped, 4.73004074: between two stabilisers that are held for a metre each
    string = [
        {"name": name, "length": length, "od": COLLAR[0], "id": COLLAR[1]}
        for name, length in (("upper", 1.0), ("span", 20.0), ("lower", 1.0))
    ]
    scene = beam(1e-6, "free", string=string, well__sections=[{"hold": 22.0}], model__kind=kind)
    found = campbell(scene, FAST, up_to=10.0, held=frozenset({"upper", "lower"}))
    exact = (np.array([4.73004074, 7.85320462]) / 20.0) ** 2 * sqrt(RIGIDITY / MASS) / (2 * pi)
    check(found.modes[:2], exact)
    assert [(one.section, one.how) for one in found.supports[1:]] == [("upper", "held"), ("lower", "held")]


def test_rotatory_terms_that_the_model_lacks_are_estimated_to_first_order():
    # Rayleigh's quotient of a pinned beam: rho J (n pi / L)^2 / m, of which omega loses a quarter
    polar = DENSITY * pi / 32 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
    for n, mode in enumerate(lateral(beam(1e-6))[:3], 1):
        ratio = polar * (n * pi / LENGTH) ** 2 / MASS
        assert mode.turning == pytest.approx(ratio, rel=2e-2)
        assert mode.rotatory == pytest.approx(0.25 * ratio, rel=2e-2)
        omega = 2 * pi * mode.frequency
        assert mode.gyroscopic(20.0) == pytest.approx(20.0 * ratio / (2.0 * omega), rel=2e-2)


def test_a_collar_on_the_low_side_rocks_as_a_beam_on_the_foundation_of_its_weight():
    # around the hole a contact of force N resists by N / r; EI b^4 is that of the clamped-free beam
    hole, free = 0.2032, 24.0
    scene = straight_hole(
        pi / 2, 60.0, 6, hole, mud={"density": MUD, "drag": 0.0}, model__bending="stiff",
        well__wall__stiffness=1e10, well__wall__lumps=6,
    )  # fmt: skip
    found = campbell(scene, FAST, up_to=8.0, top=60.0 - free)
    weight = mass_per_length() * (1.0 - MUD / DENSITY) * GRAVITY
    rocking = weight / (0.5 * (hole - COLLAR[0]) + weight * 10.0 / 1e10)
    roots = np.array([1.87510407, 4.69409113, 7.85475744])
    exact = np.sqrt((rocking + RIGIDITY * (roots / free) ** 4) / MASS) / (2 * pi)
    assert [mode.plane for mode in found.modes[:3]] == ["sideways"] * 3, "the wall holds up and down"
    # the middle lump of the end takes half a link's weight on its whole foundation: first order in the link
    assert [mode.frequency for mode in found.modes[:3]] == pytest.approx(list(exact), rel=5e-3)


def test_torsional_and_axial_modes_of_a_uniform_string_are_those_of_a_rod_fixed_at_the_top():
    # (2 n - 1) c / (4 L)
    found = campbell(beam(1e-6, "free"), FAST, kinds=("torsional", "axial"), up_to=150.0)
    for kind, speed in (("torsional", sqrt(G / DENSITY)), ("axial", sqrt(YOUNG / DENSITY))):
        modes = [mode for mode in found.modes if mode.kind == kind]
        exact = (2 * np.arange(1, len(modes) + 1) - 1) * speed / (4 * LENGTH)
        check(modes, exact)
        assert np.argmax(np.abs(modes[0].shape)) == len(modes[0].shape) - 1


@pytest.mark.parametrize("kind", ["lumped", "ale-ancf"])
@pytest.mark.parametrize("rock", [1e13, 2e8])
def test_axial_modes_on_bottom_are_those_of_a_rod_between_the_drive_and_the_rocks_spring(kind, rock):
    # EA x/L cos x + k sin x = 0 with x = omega L/c: hard rock holds the bit, n c/(2 L), soft rock lowers that
    bit = {"on_bottom": True, "weight": 10.0, "rock": {"stiffness": rock}, "penetration": {"rate": 0.004, "speed": 12}}
    found = campbell(beam(bit=bit, model__kind=kind), FAST, kinds=("axial",), up_to=300.0)
    held, soft = sqrt(YOUNG / DENSITY) / (2 * LENGTH), YOUNG * area(*COLLAR) / LENGTH
    exact = [
        held / pi * brentq(lambda x: soft * x * np.cos(x) + rock * np.sin(x), (n - 0.5) * pi, n * pi)
        for n in range(1, len(found.modes) + 1)
    ]
    assert found.rock == rock and len(exact) > 2
    check(found.modes, exact)
    assert exact[0] == pytest.approx(held, rel=1e-3) if rock == 1e13 else exact[0] < 0.96 * held


def test_torsional_and_axial_modes_of_a_stepped_string_are_the_exact_ones():
    found = campbell(shipped("hanging"), FAST, kinds=("torsional", "axial"))
    for kind, exact in (("torsional", rods.torsional), ("axial", rods.axial)):
        modes = [mode for mode in found.modes if mode.kind == kind]
        check(modes, exact(rods.TABLE_2_3, len(modes)), 1e-5)


def test_what_moves_as_a_whole_is_no_mode_and_a_drives_spring_makes_it_one():
    # pinned-free beam: 15.4182 after the rigid turn; a drive of inertia I on k_i swings against the pipe's inertia
    free = lateral(beam(1e-6, "free"), 3.0)
    assert free[0].frequency == pytest.approx(15.4182057 / LENGTH**2 * sqrt(RIGIDITY / MASS) / (2 * pi), rel=1e-3)
    polar = DENSITY * pi / 32 * (COLLAR[0] ** 4 - COLLAR[1] ** 4) * LENGTH
    for integral in (0.0, 200.0):
        drive = {"speed": 10.0, "proportional": 300.0, "integral": integral, "inertia": 2000.0}
        scene = beam(1e-6, "free", top={"rotation": {"controller": drive}})
        modes = campbell(scene, FAST, kinds=("torsional",), up_to=20.0).modes
        swing = [sqrt(integral / (2000.0 + polar)) / (2 * pi)] if integral else []
        assert [mode.frequency for mode in modes] == pytest.approx(swing, rel=1e-4)


def test_critical_speeds_are_where_multiples_of_the_rotary_speed_meet_a_mode():
    found = campbell(beam(1e-6), FAST, orders=(1.0, 3.0))
    first, second = (mode.frequency for mode in found.modes[:2])
    speeds = {(one.mode, one.order): one.speed / (2 * pi) for one in found.critical}
    assert speeds[0, 1.0] == pytest.approx(first) and speeds[0, 3.0] == pytest.approx(first / 3.0)
    assert speeds[1, 1.0] == pytest.approx(second)
    assert max(speeds.values()) <= 200.0 / 60.0 and sorted(speeds.values()) == list(speeds.values())


# -- which part of a string


def packed(**changes):
    """Pipe, collars with a stabiliser among them, and a bit that is thicker than its sub, in an inclined hole."""
    collar = {"od": COLLAR[0], "id": COLLAR[1]}
    string = [
        {"name": "pipe", "length": "rest", "od": 0.127, "id": 0.1086, "tool_joint_od": 0.16},
        {"name": "collar", "length": 60.0} | collar,
        {"name": "stabiliser", "length": 1.5, "tool_joint_od": 0.21} | collar,
        {"name": "span", "length": 12.0} | collar,
        {"name": "bit", "length": 0.5, "tool_joint_od": 0.2155} | collar,
    ]
    return straight_hole(
        np.radians(50.0), 500.0, 40, 0.216, mud={"density": MUD, "drag": 0.0}, string=string, model__bending="stiff",
        **changes,
    )  # fmt: skip


def test_the_assembly_is_what_is_below_the_rest_and_stabilisers_are_short_and_thick():
    assert assembly_of(packed()) == 1 and stabilisers_of(packed()) == [2, 4]
    assert assembly_of(shipped("hanging")) == 1 and assembly_of(beam()) == 0 and stabilisers_of(beam()) == []


def test_the_part_that_is_looked_at_ends_where_the_collars_lie_on_the_wall_above_the_stabiliser():
    found = campbell(packed(), FAST)
    assert 426.0 < found.top < 486.0 - 5.0, "in the collars, some way above the stabiliser"
    held = [(one.section, one.how) for one in found.supports]
    assert held[0] == ("collar", "lies on the wall")
    assert ("stabiliser", "on the wall") in held and held[-1] == ("bit", "on the wall")
    assert all(mode.depth[0] == pytest.approx(found.top) and mode.shape[0].max() == 0.0 for mode in found.modes)
    # statics: what the wall bears from the upper end down is the weight of it, and shear and moment of what is above
    weight = 74.0 * mass_per_length() * (1.0 - MUD / DENSITY) * GRAVITY * np.sin(np.radians(50.0))
    assert 0.2 * weight < sum(one.force for one in found.supports[1:]) < weight


def test_an_assembly_below_pipe_that_is_too_long_is_held_at_its_top():
    # clamped-free collars under 3 km of pipe in a vertical hole, without gravity: the pipe has no say
    collar = {"od": COLLAR[0], "id": COLLAR[1]}
    string = [
        {"name": "pipe", "length": "rest", "od": 0.127, "id": 0.1086},
        {"name": "collar", "length": LENGTH} | collar,
    ]
    scene = beam(1e-6, "free", string=string, well__sections=[{"hold": 3000.0}])
    found = campbell(scene, FAST, up_to=8.0)
    assert found.top == pytest.approx(3000.0 - LENGTH) and found.supports[0].how == "held"
    exact = (np.array([1.87510407, 4.69409113]) / LENGTH) ** 2 * sqrt(RIGIDITY / MASS) / (2 * pi)
    check(found.modes[:2], exact, 1e-3)


def test_a_stabiliser_that_is_clear_of_the_wall_at_rest_is_told():
    assert campbell(packed(), FAST).loose == ()
    string = [
        {"name": name, "length": length, "od": COLLAR[0], "id": COLLAR[1], "tool_joint_od": wide}
        for name, length, wide in (("pipe", 60.0, 0.17), ("stabiliser", 1.5, 0.21), ("collar", 12.0, 0.165))
    ]
    upright = straight_hole(0.0, 73.5, 6, 0.216, string=string, model__bending="stiff", model__elements=6)
    assert campbell(upright, FAST, up_to=2.0).loose == ("stabiliser",)
    assert campbell(upright, FAST, up_to=2.0, held=frozenset({"stabiliser"})).loose == ()


def test_frequencies_of_an_assembly_on_the_wall_do_not_depend_on_the_scenes_own_mesh():
    few, many = (campbell(packed(model__elements=n), FAST) for n in (10, 80))
    assert [m.frequency for m in few.modes] == pytest.approx([m.frequency for m in many.modes], rel=1e-6)
