"""Form finding: the exact extensible rod against what was written apart from it, and the lumps beside the rod."""

from functools import partial
from unittest.mock import patch

import numpy as np
import pytest
from of_the_suite import studies
from physics.wells.strings import COLLAR, DENSITY, GRAVITY, E, area, mass_per_length, shipped, straight_hole
from references import extensible_rod as written_apart

from drillstring.statics import form as form_finding
from drillstring.statics.form import at_rest, find_form, pieces_of, reference_of
from drillstring.statics.rod import NoRod, Piece, bend, hang
from tautline.integrators.status import StoppedEarly
from tautline.scene.errors import SceneError

LEVEL = 0.5 * np.pi
CONFIGURATIONS = ("A", "B", "C")
TIGHT = "C to the tolerance of rods"


def configuration(case, elements=(), by="static"):
    return find_form(shipped(f"configuration_{case.lower()}"), elements, by)


@pytest.fixture(scope="module")
def found():
    """Configurations at n = 25, 50, 100; that of C has a looser rod, unless it is asked for by `TIGHT`.

    Its boundary layers take four seconds with the tolerance that rods have, and a twentieth of that with 1e-5, where
    it is off by 2e-12 m.
    """
    known = {}

    def of(case):
        if case not in known:
            loose = partial(bend, tolerance=1e-5) if case == "C" else bend
            with patch.object(form_finding, "bend", loose):
                known[case] = configuration(case[0], (25, 50, 100))
        return known[case]

    return of


# the rod
@pytest.mark.parametrize("case", [*CONFIGURATIONS, *studies(TIGHT)])
def test_the_rod_is_the_extensible_elastica_of_the_references_within_a_millionth_of_its_length(found, case):
    # measured 1e-9, 6e-10 and 2e-10 m on 1000 m
    rod, reference = found(case).reference.rod, written_apart.solve(case[0])
    s = np.linspace(0.0, 1000.0, 401)
    x, y = rod.locate(s)
    exact = np.array([reference.at(where) for where in s])
    assert np.abs(x - exact[:, 0]).max() < 1e-6 * 1000.0
    assert np.abs(y - exact[:, 1]).max() < 1e-6 * 1000.0
    assert y.min() == pytest.approx(reference.sag, rel=1e-4)
    assert x[-1] - 1000.0 == pytest.approx(reference.end_displacement, abs=1e-6)


@pytest.mark.parametrize("case", ["A", "B"])
def test_the_rod_says_an_error_that_a_looser_solution_keeps_to(found, case):
    # a thousand times the tolerance: what it is off is within ten times of what it says
    exact = found(case).reference.rod
    scene = shipped(f"configuration_{case.lower()}")
    loose = bend(pieces_of(scene, 1200.0), LEVEL, scene.bit.force, tolerance=1e-5)
    s = np.linspace(0.0, 1000.0, 401)
    off = np.abs(loose.locate(s) - exact.locate(s)).max()
    assert exact.error < 1e-6
    assert 0.0 < loose.error and off < 10.0 * loose.error


def test_a_hanging_rod_stretches_by_w_l_squared_over_2_ea():
    rod = hang([Piece(1000.0, 7e8, 1e6, 250.0)])
    assert rod.stretch == pytest.approx(250.0 * 1000.0**2 / (2 * 7e8), rel=1e-14)
    assert rod.locate(np.array([1000.0]))[0, 0] - 1000.0 == pytest.approx(rod.stretch, rel=1e-9)
    assert rod.tension(np.array([0.0, 400.0])) == pytest.approx([250e3, 150e3])
    assert rod.hook_load == pytest.approx(250e3)


def test_the_hanging_string_of_pipe_and_collar_stretches_as_the_references_say():
    found = find_form(shipped("hanging"))
    assert found.reference.rod.stretch == pytest.approx(written_apart.hanging_elongation(), rel=1e-13)
    assert found.reference.rod.stretch == pytest.approx(0.376529, abs=1e-6)
    assert found.difference(found.finest).max() < 1e-9
    assert found.finest.hook_load == pytest.approx(found.reference.rod.hook_load, rel=1e-10)


def test_a_cantilever_sinks_by_w_l4_over_8_ej_within_the_order_of_its_deflection_squared():
    # linear beam: what is left goes with the square of the deflection over the length, here with a factor near one
    length, bending, off = 10.0, 1e4, []
    for deflection in (0.02, 0.04):
        weight = deflection * length * 8.0 * bending / length**4
        rod = bend([Piece(length, 1e12, bending, weight)], LEVEL, top="clamped", end="free")
        down = -rod.locate(np.array([length]))[1, 0]
        off.append(abs(down / (deflection * length) - 1.0))
        assert off[-1] < deflection**2
    assert np.log2(off[1] / off[0]) == pytest.approx(2.0, abs=0.02)


def test_a_clamped_rod_without_weight_under_end_force_is_its_hookean_length():
    # straight: F L / EA, by the same collocation as all bent rods
    rod = bend([Piece(3.0, 1e4, 5.0, 0.0), Piece(2.0, 3e4, 9.0, 0.0)], 1.0, force=40.0)
    exact = 40.0 * (3.0 / 1e4 + 2.0 / 3e4)
    assert rod.stretch == pytest.approx(exact, rel=1e-10)
    assert rod.locate(np.array([5.0]))[:, 0] == pytest.approx([5.0 + exact, 0.0], abs=1e-10)


def test_a_rod_of_several_like_pieces_is_the_rod_of_one():
    one = bend([Piece(100.0, 1e7, 1e5, 30.0)], 1.2, 2e3, tolerance=1e-6)
    three = bend([Piece(part, 1e7, 1e5, 30.0) for part in (20.0, 50.0, 30.0)], 1.2, 2e3, tolerance=1e-6)
    s = np.linspace(0.0, 100.0, 51)
    assert three.locate(s) == pytest.approx(one.locate(s), abs=1e-6)
    assert three.tension(s) == pytest.approx(one.tension(s), rel=1e-6)


def test_forces_on_an_inclined_rod_balance():
    # what hangs along the hole, and the end force, are the hook load; the arc is as long as the strain says
    w, length, force, lean = 30.0, 100.0, 2e3, 1.2
    rod = bend([Piece(length, 1e7, 1e5, w)], lean, force)
    assert rod.hook_load == pytest.approx(force + w * length * np.cos(lean), rel=1e-12)
    s = np.linspace(0.0, length, 200001)
    arc = np.hypot(*np.diff(rod.locate(s))).sum()
    assert arc - length == pytest.approx(rod.stretch, rel=1e-5)


def test_a_pendulum_is_no_boundary_value_problem():
    with pytest.raises(NoRod, match="pendulum"):
        bend([Piece(1.0, 1.0, 1.0, 1.0)], LEVEL, end="free")


# the lumps beside it
SAG = {"A": -3.278958, "B": -233.5539, "C": -24.735459}
END = {"B": -149.31423, "C": 0.108223}
"""By tests/references/extensible_rod.py, m."""


@pytest.mark.parametrize("case", CONFIGURATIONS)
def test_fifty_lumps_sag_as_the_exact_rod_within_a_thousandth(found, case):
    form = found(case).forms[1]
    assert form.elements == 50
    assert form.offset.max() == pytest.approx(-SAG[case], rel=1e-3)
    # every lump, over the sag: 0.02 %, 0.05 % and 0.01 %
    assert found(case).difference(form).max() < 1e-3 * abs(SAG[case])
    if case in END:
        assert form.moved[-1, 0] == pytest.approx(END[case], abs=1e-3 * abs(SAG[case]))


@pytest.mark.parametrize("case", CONFIGURATIONS)
def test_lumps_converge_to_the_rod_at_second_order(found, case):
    # of C at 440 m and at the end only: where pipe and collar meet the curvature jumps within sqrt(EJ / T) of 0.9 to
    # 2.2 m, which no link of 10 m can follow, and 0.8 mm of distance stay until links are that short
    worst = []
    for form in found(case).forms:
        seen = np.isin(form.unstretched, [440.0, 1000.0]) if case == "C" else slice(None)
        worst.append(found(case).difference(form)[seen].max())
    assert np.log2(worst[0] / worst[1]) == pytest.approx(2.0, abs=0.2)
    assert np.log2(worst[1] / worst[2]) == pytest.approx(2.0, abs=0.2)


def test_the_pulled_string_is_farthest_from_the_rod_in_the_boundary_layer_where_pipe_and_collar_meet(found):
    finest = found("C").finest
    worst = found("C").difference(finest)
    assert finest.unstretched[worst.argmax()] == pytest.approx(880.0)
    assert worst.max() < 1e-3


@pytest.mark.parametrize("case", CONFIGURATIONS)
def test_hook_load_and_stretch_are_those_of_the_rod(found, case):
    form, rod = found(case).finest, found(case).reference.rod
    largest = float(rod.tension(np.array([0.0, 1000.0])).max())
    assert form.hook_load == pytest.approx(rod.hook_load, abs=1e-7 * largest)
    assert form.stretch == pytest.approx(rod.stretch, rel=1e-3)
    assert form.tension.max() == pytest.approx(largest, rel=0.05), "at the middle of a link, not at the pin"


@pytest.mark.parametrize("name", ["configuration_a", "configuration_b", "configuration_c", "hanging"])
def test_dynamic_relaxation_comes_to_rest_where_the_static_solver_does_within_a_millionth_of_the_length(name):
    # measured 6e-5, 5e-6, 3e-7 and 4e-10 m on 1000 m
    static, relaxed = (at_rest(shipped(name, model__elements=25), by) for by in ("static", "relaxation"))
    assert np.abs(static.position - relaxed.position).max() < 1e-6 * 1000.0
    # Each row of the relaxed string is in balance to 1e-7 of its scale, and the hook load is the sum of them all.
    assert static.hook_load == pytest.approx(relaxed.hook_load, abs=3e-6 * max(1.0, static.tension.max()))


def test_a_pinned_string_in_an_inclined_hole_without_walls_is_the_rod_too():
    # inclination 60 degrees, mud: the rod has the part of the buoyed weight along the hole
    scene = straight_hole(
        np.radians(60.0), 100.0, 40, well__wall="none", well__azimuth=0.7, bit={"lateral": "pinned", "force": 2e5},
        model__bending="stiff", mud={"density": 1500.0},
    )  # fmt: skip
    found = find_form(scene, (20, 40))
    worst = [found.difference(form).max() for form in found.forms]
    sag = found.finest.offset.max()
    assert sag > 0.3 and worst[1] < 2e-3 * sag
    assert np.log2(worst[0] / worst[1]) == pytest.approx(2.0, abs=0.2)
    weight = mass_per_length() * GRAVITY * 100.0 * (1.0 - 1500.0 / DENSITY)
    assert found.finest.hook_load == pytest.approx(2e5 + 0.5 * weight, rel=1e-9)


def test_a_string_with_a_free_end_swings_out_of_its_inclined_hole_and_hangs_straight_down():
    # pinned at the block in free space; closed form of its stretch, w L^2 / (2 EA)
    scene = straight_hole(np.radians(20.0), 100.0, 10, well__wall="none", model__bending="stiff")
    found = find_form(scene)
    end = found.finest.position[-1]
    stretch = mass_per_length() * GRAVITY * 100.0**2 / (2 * E * area(*COLLAR))
    assert end == pytest.approx([0.0, 0.0, 100.0 + stretch], abs=1e-7)
    assert found.difference(found.finest).max() < 1e-7


def test_four_hundred_short_links_come_to_rest_though_they_have_far_to_go(found):
    # they sag by 233 m, a hundred times their length; the error of the end goes on falling from 0.07 m at n = 50
    form = at_rest(shipped("configuration_b", model__elements=400))
    assert found("B").difference(form).max() < 0.005


def test_a_rod_that_is_pressed_beyond_eulers_load_says_that_it_has_other_shapes(found):
    pressed = reference_of(shipped("configuration_b", bit__force=-100.0), found("B").finest)
    assert "pressed by 100 N, beyond Euler's 11.7 N" in pressed.said
    assert "Euler" not in found("B").reference.said


# where there is none
@pytest.mark.parametrize(
    ("scene", "said"),
    [
        (lambda: straight_hole(np.radians(30.0), elements=4), "the wall may carry the string"),
        (lambda: straight_hole(LEVEL, well__wall="none", elements=4, bit={"lateral": "pinned"}), "without bending"),
        (lambda: shipped("jwell"), "the hole is curved"),
        (lambda: straight_hole(np.pi), "the string stands upwards"),
        (lambda: straight_hole(0.4, well__wall="none", bit={"force": 1e3}), "not where a force on the bit pulls"),
    ],
    ids=["wall", "no bending", "curved", "upwards", "free end"],
)
def test_where_the_rod_does_not_apply_there_is_none_and_the_reason_is_said(scene, said):
    scene = scene()
    top = find_form(straight_hole(0.0)).finest
    found = reference_of(scene, top)
    assert found.rod is None and said in found.said


def test_lumps_that_lie_on_the_wall_are_counted():
    # a collar in a hole of 30 degrees: all lumps but the one that hangs in the block
    found = find_form(straight_hole(np.radians(30.0), elements=4))
    assert found.reference.rod is None and found.difference(found.finest) is None
    assert found.finest.touching == 4


def test_a_string_that_still_moves_is_told_and_is_no_form():
    with pytest.raises(StoppedEarly, match="did not come to rest") as stop:
        find_form(shipped("configuration_c", model__elements=10), by="relaxation", most=40)
    assert "10 elements" in stop.value.sentence and "40 steps" in stop.value.sentence


def test_a_string_in_air_far_from_its_curved_axis_is_told_to_move_to_its_rest_and_does():
    sections = [{"hold": 100.0}, {"build": {"radius": 200.0, "to": "80 deg"}}, {"hold": 100.0}]
    pipe = [{"name": "pipe", "length": "rest", "od": 0.127, "id": 0.1086}]
    scene = shipped(
        "hanging", well={"diameter": 0.2159, "wall": "none", "sections": sections}, string=pipe, model__elements=20,
        solver={"step": 0.005, "end": 1.0}, damping={"translation": 200.0, "structural": 0.01},
    )  # fmt: skip
    with pytest.raises(StoppedEarly, match="--by relaxation"):
        find_form(scene)
    found = find_form(scene, by="relaxation").finest
    # A pendulum at rest: straight down, all of its weight on the hook.
    assert found.position[-1, :2] == pytest.approx([0.0, 0.0], abs=0.5)
    assert found.position[-1, 2] == pytest.approx(found.unstretched[-1], rel=1e-3)


def test_fewer_elements_than_sections_are_refused_naming_the_option():
    with pytest.raises(SceneError, match="--elements") as refusal:
        find_form(shipped("hanging"), (1,))
    assert "fewer than the 2 sections" in str(refusal.value)


@pytest.mark.parametrize("elements", [400, *studies(1000)])
def test_a_string_of_many_short_links_sags_as_far_as_one_of_few(elements):
    # 233.5539 m by tests/references/extensible_rod.py; the links are 2.5 and 1 m long.
    form = at_rest(shipped("configuration_b", model__elements=elements))
    assert form.offset.max() == pytest.approx(233.5539, rel=1e-5)
