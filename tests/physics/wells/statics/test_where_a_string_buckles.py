"""Where a string buckles, against the closed form of a vertical hole.

Without friction the compression a distance s above the bit is F = F_bit - w s, and the limits of a pipe are 2.55 and
5.55 (EI w^2)^(1/3) (J. Wu, H. C. Juvkam-Wold and R. Lu, 1993). So it buckles from the bit up to (F_bit - limit)/w,
whatever the number of links. Steel of 7850 kg/m^3 hangs in mud of 1200 kg/m^3.
"""

import numpy as np
import pytest
from physics.wells.strings import GRAVITY
from scipy.optimize import brentq

from drillstring.model.prepared import prepared
from drillstring.scene.scene import BEAM, LUMPED, DrillstringScene
from drillstring.statics.torque_drag import Case, torque_drag
from drillstring.string import buckling
from drillstring.string.buckled import buckled_at_rest, stretches
from drillstring.view.torque_figures import torque_drag_figure
from drillstring.warnings import warnings
from drillstring.well.wellbore import from_survey

DEPTH, COLLARS, E = 3000.0, 120.0, 206e9
PIPE, COLLAR = (0.127, 0.1086), (0.2032, 0.0714)
SCENE = """
title: pushed
well: {{sections: [{{hold: 3000 m}}], diameter: 12.25 in, wall: {{stiffness: 1.0e9, friction: 0.2}}}}
string:
  - {{name: pipe, length: rest, od: 127 mm, id: 108.6 mm}}
  - {{name: collar, length: 120 m, od: 203.2 mm, id: 71.4 mm}}
material: {{youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}}
mud: {{density: 1200}}
bit: {{force: {force} kN}}
model: {{kind: {kind}, elements: 20}}
solver: {{method: generalized-alpha, rho_inf: 0.5, step: 2 ms, end: 6 s}}
output: {{interval: 50 ms}}
"""
FACTORS = {"sinusoidal": 2.55, "helical": 5.55}


def weight(tube):
    """Buoyed, N/m."""
    return (7850.0 - 1200.0) * GRAVITY * np.pi / 4.0 * (tube[0] ** 2 - tube[1] ** 2)


def limit(tube, kind):
    rigidity = E * np.pi / 64.0 * (tube[0] ** 4 - tube[1] ** 4)
    return FACTORS[kind] * np.cbrt(rigidity * weight(tube) ** 2)


def height(push, tube, kind):
    """Distance above the place where it is pushed by so much, up to which a tube buckles, m."""
    return (push - limit(tube, kind)) / weight(tube)


def pushed(force, kind, elements):
    scene = DrillstringScene.parse(SCENE.format(force=-force / 1e3, kind=kind))
    (case,) = torque_drag(scene, elements=elements)
    return case.points[0]


@pytest.mark.parametrize("elements", [20, 100])
@pytest.mark.parametrize("kind", [LUMPED, BEAM])
def test_a_string_that_its_bit_pushes_beyond_its_limit_buckles_up_to_where_the_closed_form_says(kind, elements):
    # the middle of the lowest link of 120 or 30 m is pushed by 13.8 or 82.2 kN, below the limit of 98.9 kN
    point = pushed(110e3, kind, elements)
    for motion in ("pick_up", "slack_off", "rotating"):
        ((top, bottom),) = point.buckled(motion, "sinusoidal")
        assert DEPTH - top == pytest.approx(height(110e3, COLLAR, "sinusoidal"), abs=0.05)
        assert bottom == pytest.approx(DEPTH, rel=1e-12) and point.buckled(motion, "helical") == []


def test_a_string_is_a_helix_up_to_where_the_closed_form_says():
    ((top, bottom),) = pushed(230e3, BEAM, 50).buckled("rotating", "helical")
    assert DEPTH - top == pytest.approx(height(230e3, COLLAR, "helical"), abs=0.05)
    assert bottom == pytest.approx(DEPTH, rel=1e-12)


def test_pipe_above_collars_buckles_in_two_stretches_where_the_stiff_collars_hold():
    # at the top of the collars 40 kN of push are left: beyond both limits of the pipe, below those of the collars
    force = 40e3 + weight(COLLAR) * COLLARS
    point = pushed(force, LUMPED, 100)
    end = DEPTH - COLLARS
    for kind in FACTORS:
        (pipe, collars) = point.buckled("rotating", kind)
        assert end - pipe[0] == pytest.approx(height(40e3, PIPE, kind), abs=0.1)
        assert pipe[1] == pytest.approx(end, rel=1e-12)
        assert DEPTH - collars[0] == pytest.approx(height(force, COLLAR, kind), abs=0.05)
        assert collars[1] == pytest.approx(DEPTH, rel=1e-12)


def test_a_string_that_its_bit_pushes_by_less_than_its_limit_buckles_nowhere():
    point = pushed(0.999 * limit(COLLAR, "sinusoidal"), LUMPED, 100)
    assert [point.buckled(motion, "sinusoidal") for motion in point.profiles] == [[], [], []]


def test_stretches_join_neighbouring_pieces_and_end_where_the_excess_crosses_zero():
    depth = np.array([[0.0, 10.0], [10.0, 20.0], [20.0, 30.0], [30.0, 40.0]])
    excess = np.array([[-1.0, 3.0], [3.0, -1.0], [-2.0, -1.0], [4.0, 1.0]])
    assert stretches(depth, excess) == [(2.5, 17.5), (30.0, 40.0)]
    assert stretches(depth, -np.ones((4, 2))) == [] == stretches(depth, np.full((4, 2), np.nan))


# at rest, as `check` and `simulate` warn of it
def at_rest(force, depth=DEPTH):
    text = SCENE.format(force=-force / 1e3, kind=LUMPED).replace("3000 m", f"{depth:g} m")
    scene = DrillstringScene.parse(text)
    ready = prepared(scene)
    return buckled_at_rest(scene, ready.well, ready.lumps), scene


@pytest.mark.parametrize("depth", [3000.0, 8000.0])
def test_a_long_string_at_rest_is_judged_by_the_push_at_its_bit(depth):
    # a piece of 1/200 of 8000 m would be pushed by 83 kN in its middle, below the limit of 98.9 kN
    found, scene = at_rest(120e3, depth)
    assert found.compression == pytest.approx(120e3, rel=1e-12) and found.section == 1
    assert found.limit == pytest.approx(limit(COLLAR, "sinusoidal"), rel=1e-6)
    assert depth - found.top == pytest.approx(height(120e3, COLLAR, "sinusoidal"), rel=1e-6)
    assert found.bottom == depth
    (told,) = [one.text for one in warnings(scene) if one.where == "bit.force"]
    assert "compresses collar by up to 120 kN at rest. Beyond 98.92 kN it buckles: from" in told


def test_pipe_above_collars_at_rest_is_pushed_most_at_its_lower_end():
    # 14 kN are left there, 2 kN beyond the limit of the pipe: over 9 m, less than a piece of 29 m
    left = limit(PIPE, "sinusoidal") + 2e3
    found, _ = at_rest(left + weight(COLLAR) * COLLARS)
    assert DEPTH - COLLARS - found.top == pytest.approx(2e3 / weight(PIPE), rel=1e-6)


def test_a_string_at_rest_that_is_pushed_by_less_than_its_limit_buckles_nowhere():
    assert at_rest(0.9999 * limit(COLLAR, "sinusoidal"))[0] is None


# the limit of a hole that is inclined and curved, and what it takes to find it
def least_force(factor, inclination, around, curvature, place):
    """Least F of F^2 = m EI |-F t' + w (e_z - (e_z.t) t)|/r, by vectors, from its first change of sign on."""
    rigidity, clearance, load = place
    t = np.array([np.sin(inclination), 0.0, np.cos(inclination)])
    high = np.array([np.cos(inclination), 0.0, -np.sin(inclination)])
    bend = -curvature * (np.cos(around) * high + np.sin(around) * np.array([0.0, 1.0, 0.0]))
    weighs = load * (np.array([0.0, 0.0, 1.0]) - t[2] * t)

    def excess(force):
        pressed = np.linalg.norm(weighs - np.asarray(force)[..., None] * bend, axis=-1)
        return force**2 - factor * rigidity / clearance * pressed

    forces = np.geomspace(1.0, 1e9, 40001)
    first = np.flatnonzero(excess(forces) > 0.0)[0]
    return brentq(excess, forces[first - 1], forces[first], xtol=1e-9, rtol=1e-14), bend[2]


@pytest.mark.parametrize("around", [0.0, 60.0, 120.0, 180.0], ids=lambda x: f"drops_{x:g}")
@pytest.mark.parametrize("inclination", [20.0, 70.0])
def test_limits_in_a_curved_hole_are_the_least_force_of_he_and_kyllingstad(inclination, around):
    # many curvatures at once: each place has its own root
    place, curvatures = (1.2e6, 0.04, 240.0), [1e-5, 1e-4, 1e-3, 4e-3]
    angles = np.radians(inclination), np.radians(around)
    for kind, factor in (("sinusoidal", 4.0), ("helical", 8.0)):
        expected, turns = zip(*(least_force(factor, *angles, k, place) for k in curvatures), strict=True)
        held = FACTORS[kind] * np.cbrt(place[0] * (place[2] * np.cos(angles[0])) ** 2)
        columns = [np.full(4, x) for x in (*place, np.cos(angles[0]))]
        found = buckling.limit(kind, *columns, np.array(turns), np.array(curvatures))
        assert found == pytest.approx(np.maximum(expected, held), rel=1e-9)


def test_two_roots_that_all_but_meet_are_not_passed_where_the_hole_drops():
    # in one plane F^2 = c (w sin(i) - k F) has a root below w sin(i)/k; beyond it is another, close to it
    rigidity, clearance, load, curvature = 3.0e7, 0.02, 500.0, 0.02
    for inclination in np.radians([0.05, 0.5, 5.0, 50.0, 89.0, 120.0, 176.0]):
        c, w = 4.0 * rigidity / clearance, load * np.sin(inclination)
        expected = 2.0 * w / (curvature + np.sqrt(curvature**2 + 4.0 * w / c))
        held = 2.55 * np.cbrt(rigidity * (load * np.cos(inclination)) ** 2)
        turn = curvature * np.sin(inclination)
        values = rigidity, clearance, load, np.cos(inclination), turn, curvature
        (found,) = buckling.limit("sinusoidal", *(np.array([x]) for x in values))
        assert found == pytest.approx(max(expected, held), rel=1e-9)


def test_a_pipe_that_fills_the_hole_does_not_buckle():
    values = [1.2e6, 1.2e6], [0.0, 0.04], [240.0, 240.0], [1.0, 1.0], [0.0, 0.0], [0.0, 0.0]
    found = buckling.limits(*map(np.array, values))
    for kind, factor in FACTORS.items():
        assert getattr(found, kind) == pytest.approx([np.inf, factor * np.cbrt(1.2e6 * 240.0**2)])


@pytest.mark.parametrize("rows", [30, 3000])
def test_the_limits_of_a_long_survey_at_rest_are_found_at_once_and_of_one_kind(monkeypatch, rows):
    asked, solve = [], buckling._least_roots
    monkeypatch.setattr(np, "roots", lambda _: pytest.fail("a root of one place alone"))
    monkeypatch.setattr(buckling, "_least_roots", lambda *of: asked.append(of[0].size) or solve(*of))
    scene = DrillstringScene.parse(SCENE.format(force=-300, kind=LUMPED))
    depth = np.linspace(0.0, DEPTH, rows)
    well = from_survey(depth, np.linspace(0.0, 1.2, rows), np.zeros(rows))
    assert buckled_at_rest(scene, well, prepared(scene).lumps) is not None
    # once for the upper and once for the lower ends of all pieces: 200 of two sections and one for each row
    assert len(asked) == 2 and max(asked) <= 200 + rows


def test_the_figure_shows_the_string_from_the_hook_to_the_bit():
    push = 1.2 * limit(COLLAR, "sinusoidal")
    point = pushed(push, LUMPED, 20)
    figure = torque_drag_figure([Case(point.friction, [point])])
    tension, depth = (np.asarray(x, float) for x in figure.axes[0].lines[0].get_data())
    assert "kN" in figure.axes[0].get_xlabel()
    assert depth[0] == pytest.approx(0.0, abs=1e-9) and depth[-1] == pytest.approx(DEPTH)
    assert tension[0] == pytest.approx(1e-3 * point.hook_load("pick_up")) and tension[-1] == pytest.approx(-1e-3 * push)
    limits = [np.asarray(line.get_xdata(), float) for line in figure.axes[0].lines if line.get_linewidth() == 3]
    assert tension[-1] < limits[0][-1] == pytest.approx(-1e-3 * limit(COLLAR, "sinusoidal"), rel=1e-3)


def test_buckling_limits_go_on_to_the_edge_of_the_axis_and_the_legend_says_which_lie_beyond():
    # a tenth of the tensions: 85 kN. Of the collars the lower limit is 99 kN, on the axis, the upper one 215 kN
    point = pushed(1.2 * limit(PIPE, "sinusoidal"), LUMPED, 20)
    pulled = point.profiles["pick_up"]
    less = pulled._replace(tension=0.1 * pulled.tension, hook_load=0.1 * pulled.hook_load)
    figure = torque_drag_figure([Case(point.friction, [point._replace(profiles={"pick_up": less})])])
    _, helix = (np.asarray(line.get_xdata(), float) for line in figure.axes[0].lines if line.get_linewidth() == 3)
    assert figure.axes[0].get_xlim()[0] > helix[-1] == pytest.approx(-1e-3 * limit(COLLAR, "helical"), rel=1e-3)
    told = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "buckles into a sine" in told and "buckles into a helix, in part beyond the axis" in told


@pytest.mark.parametrize("locks", [True, False])
def test_the_figure_says_which_motion_has_no_curve_and_why(locks):
    point = pushed(1.2 * limit(PIPE, "sinusoidal"), LUMPED, 20)
    others = {name: one for name, one in point.profiles.items() if name != "slack_off"}
    missing = point._replace(profiles=others, locks={"slack_off": 900.0} if locks else {})
    cases = [Case(point.friction, [missing]), Case(point.friction, [missing, point._replace(depth=100.0)])]
    why = "locks up" if locks else "no equilibrium"
    for case, where in zip(cases, ("", " at 1 of 2 depths"), strict=True):
        told = [text.get_text() for text in torque_drag_figure([case]).legends[0].get_texts()]
        assert f"no slack off at friction {point.friction:.3g}: {why}{where}" in told


def test_side_forces_of_a_string_that_touches_nothing_are_drawn_as_none():
    point = pushed(1.2 * limit(COLLAR, "sinusoidal"), LUMPED, 20)
    figure = torque_drag_figure([Case(point.friction, [point])])
    assert all(not np.any(line.get_xdata()) for line in figure.axes[1].lines)
