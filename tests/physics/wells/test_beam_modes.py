"""Natural modes of the string's beam against closed forms, exact roots, and those of lumps.

Closed forms as in test_natural_modes.py. A hanging string without bending: f_n = j_n/(4 pi) sqrt(g/L) with the zeros
j_n of the Bessel function J0 (H. Lamb, Higher Mechanics, 1920, section 84). Measured: the third frequency of a pinned
beam of 6, 12 and 24 elements is off by 4.5e-3, 3.3e-4 and 2.5e-5, of order 3.8 without tension and 3.97 in it; that of
a hanging string, whose tension vanishes at its end, of 20, 40 and 80 by 5.0e-3, 7.9e-4 and 8.4e-5, lumps by 3.7e-2,
9.7e-3 and 2.4e-3.
"""

from math import pi, sqrt

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, GRAVITY, shipped, straight_hole
from physics.wells.strings import E as YOUNG
from physics.wells.test_natural_modes import EULER, FAST, LENGTH, MASS, RIGIDITY, beam, check
from references import stepped_rod_modes as rods
from scipy.special import jn_zeros

from drillstring.modes import bha
from drillstring.modes.campbell import campbell
from drillstring.modes.rest import rest_of
from drillstring.scene.scene import BEAM

MUD = 1200.0


def of_beam(**changes):
    return beam(**{"model__kind": BEAM} | changes)


def rest(scene, elements):
    """A string of one section at rest, cut into elements."""
    return rest_of(bha.Cut(bha._meshed(scene, (elements,)), (elements,), 0))


def free(linear):
    return np.arange(linear.lumps.length.size + 1) < 1


@pytest.mark.parametrize("pull", [1e-6, 5.0 * EULER])
def test_lateral_frequencies_of_a_pinned_beam_are_of_fourth_order(pull):
    wave = 3.0 * pi / LENGTH
    exact = wave * sqrt((pull + RIGIDITY * wave**2) / MASS) / (2 * pi) / (1.0 + pull / (YOUNG * rods_area()))
    errors = []
    for count in (6, 12, 24):
        linear = rest(of_beam(force=pull), count)
        frequency = linear.lateral(0, free(linear), 20.0).frequency
        errors.append(abs(frequency[4] / exact - 1.0))
    orders = -np.diff(np.log2(errors))
    assert errors[1] < 4e-4 and (orders > 3.6).all(), (errors, orders)


def rods_area():
    return pi / 4 * (COLLAR[0] ** 2 - COLLAR[1] ** 2)


def test_axial_frequencies_are_of_fourth_order_and_those_in_torsion_of_second():
    speed = {"axial": sqrt(YOUNG / DENSITY), "torsional": sqrt(79e9 / DENSITY)}
    for kind, least, most in (("axial", 3.7, 7.0), ("torsional", 1.8, 2.2)):
        exact = 3.0 * speed[kind] / (4.0 * LENGTH)
        errors = []
        for count in (2, 4, 8):
            frequency, shapes = rest(of_beam(force=1e-6, lateral="free"), count).along(kind, 1e4)
            assert shapes.shape == (count + 1, frequency.size)
            errors.append(abs(frequency[1] / exact - 1.0))
        orders = -np.diff(np.log2(errors))
        assert least < orders[-1] < most, (kind, errors, orders)


def test_frequencies_of_a_hanging_string_come_to_the_zeros_of_bessels_function_faster_than_those_of_lumps():
    length = 500.0
    exact = jn_zeros(0, 4) / (4.0 * pi) * sqrt(GRAVITY / length)
    off = {}
    for kind in (BEAM, "lumped"):
        scene = straight_hole(0.0, length, 4, model__kind=kind, model__bending="none", well__wall="none")
        for count in (40, 80):
            linear = rest(scene, count)
            found = linear.lateral(0, free(linear), 0.2).frequency
            # two planes each
            assert found[1:8:2] == pytest.approx(found[0:8:2], rel=1e-6)
            # its own weight stretches the string by 5.4e-5
            off[kind, count] = np.abs(found[0:8:2] / exact - 1.0 + 5.4e-5)
    assert (off[BEAM, 80] < 6e-4).all() and off[BEAM, 80][3] < 0.2 * off[BEAM, 40][3]
    assert (off[BEAM, 80] < 0.1 * off["lumped", 80]).all()


def test_axial_and_torsional_modes_of_a_stepped_string_are_the_exact_roots():
    found = campbell(shipped("hanging", model__kind=BEAM), FAST, kinds=("torsional", "axial"))
    assert found.model == BEAM
    for kind, exact in (("torsional", rods.torsional), ("axial", rods.axial)):
        modes = [mode for mode in found.modes if mode.kind == kind]
        check(modes, exact(rods.TABLE_2_3, len(modes)), 1e-5)
        if kind == "axial":
            off = [abs(mode.frequency / f - 1.0) for mode, f in zip(modes, exact(rods.TABLE_2_3, 3), strict=False)]
            assert max(off) < 2e-5, "only the string's stretch is left"


def test_axial_modes_of_a_beam_in_a_curved_hole_are_those_of_lumps():
    # Moving along the hole it is no stiffer than in a straight one. Elements of 120 m err by 1 %, of 15 m by 2e-5.
    both = [
        campbell(shipped("jwell", model__kind=kind), FAST, kinds=("axial",), up_to=0.6).modes
        for kind in ("lumped", BEAM)
    ]
    for one, other in zip(*both, strict=True):
        assert abs(one.frequency - other.frequency) <= 2.0 * (one.error + other.error) + 2e-5 * one.frequency
        assert other.error < 1e-4 * other.frequency


def test_slow_modes_of_a_stepped_string_are_not_lost_beside_the_springs_at_its_steps():
    # a level string without tension: 1 km swings at a third of a millihertz
    found = []
    for kind in ("lumped", BEAM):
        scene = shipped("configuration_a", model__kind=kind)
        linear = rest_of(bha.Cut(bha._meshed(scene, (88, 12)), (88, 12), 0))
        found.append(linear.lateral(0, free(linear), 0.01).frequency[:6])
    assert found[1] == pytest.approx(found[0], rel=5e-3) and found[0][0] < 4e-4


def test_a_collar_on_the_low_side_rocks_as_a_beam_on_the_foundation_of_its_weight():
    hole, loose = 0.2032, 24.0
    scene = straight_hole(
        pi / 2, 60.0, 6, hole, mud={"density": MUD, "drag": 0.0}, model__bending="stiff", model__kind=BEAM,
        well__wall__stiffness=1e10, well__wall__lumps=6,
    )  # fmt: skip
    found = campbell(scene, FAST, up_to=8.0, top=60.0 - loose)
    weight = DENSITY * rods_area() * (1.0 - MUD / DENSITY) * GRAVITY
    rocking = weight / (0.5 * (hole - COLLAR[0]) + weight * 10.0 / 1e10)
    exact = np.sqrt((rocking + RIGIDITY * (np.array([1.87510407, 4.69409113]) / loose) ** 4) / MASS) / (2 * pi)
    assert [mode.plane for mode in found.modes[:2]] == ["sideways"] * 2, "the wall holds up and down"
    assert [mode.frequency for mode in found.modes[:2]] == pytest.approx(list(exact), rel=5e-3)


def test_a_beam_beyond_eulers_load_is_told_to_buckle():
    first = sqrt(RIGIDITY / MASS) * (pi / LENGTH) ** 2 / (2 * pi)
    near, beyond = (campbell(of_beam(force=-share * EULER), FAST) for share in (0.9, 1.2))
    assert near.modes[0].frequency == pytest.approx(first * sqrt(0.1), rel=1e-3) and not near.unstable
    assert beyond.unstable[0].frequency == pytest.approx(-first * sqrt(0.2), rel=1e-2)


def test_both_models_give_the_modes_of_an_assembly_with_stabilisers():
    both = [campbell(shipped("field_well", model__kind=kind), FAST, up_to=6.0) for kind in ("lumped", BEAM)]
    lumps, of_it = ([mode for mode in one.modes if mode.kind == "lateral"] for one in both)
    assert len(lumps) == len(of_it) > 2
    for one, other in zip(lumps, of_it, strict=True):
        assert (one.plane, one.frequency) == (other.plane, pytest.approx(other.frequency, rel=2e-2))
    assert [s.section for s in both[0].supports] == [s.section for s in both[1].supports]
