"""A cable written as one item, `CableLine`: what it stands for, how it hangs, and what is refused of it."""

import dataclasses
import re
from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from tautline.application.installed import Installed
from tautline.cable.input.lines import hanging
from tautline.cable.input.material import material_coordinates
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.cable.warnings import coarse_lines
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

SOLVER = "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.005, time_end: 0.05}\n"
HELD = "BC: [1, 1, 1, 0, 0, 0, 1]"


def text(line, first="[0, 0, 0]", last="[100, 0, 10]", gravity="[0, 0, -9.81]", more="", kind="Node7Dof", held=HELD):
    return (
        f"CableModelMaterial: {{Gravity: {gravity}}}\nCableModel:\n"
        f"  - {kind}: {{id: 0, xyz: {first}, {held}}}\n  - {kind}: {{id: 1, xyz: {last}, {held}}}\n"
        f"  - CableLine: {{id: 0, {line}}}\n{more}{SOLVER}"
    )


SECTION = "EA: 1.0e7, EJ: 10, rhoA: 5"


def positions(scene, ids):
    nodes = {node.id: node for node in scene.nodes}
    return np.array([nodes[id].position for id in ids])


def test_a_line_is_what_its_nodes_and_elements_are_when_each_is_written():
    scene = parse(text(f"nodes7: [0, 1], elements: 4, {SECTION}", last="[8, 0, 6]"))
    nodes = "".join(
        f"  - Node7Dof: {{id: {i + 1}, xyz: [{2.0 * i}, 0, {1.5 * i}], BC: [0, 0, 0, 0, 0, 0, 1]}}\n" for i in (1, 2, 3)
    )
    elements = "".join(
        f"  - CableALEelement: {{id: {i}, nodes7: [{a}, {b}], {SECTION}}}\n"
        for i, (a, b) in enumerate([(0, 2), (2, 3), (3, 4), (4, 1)])
    )
    written = text("", last="[8, 0, 6]").replace("  - CableLine: {id: 0, }\n", nodes + elements)
    written = parse(written)
    assert material_coordinates(scene) == pytest.approx(material_coordinates(written), abs=1e-14)
    nowhere = {"line": 0, "place": ()}
    assert [e._replace(**nowhere) for e in scene.elements] == [e._replace(**nowhere) for e in written.elements]
    for one, other in zip(sorted(scene.nodes), sorted(written.nodes), strict=True):
        assert one.position == pytest.approx(other.position, abs=1e-14) and one.slope == pytest.approx(other.slope)
        assert (one.id, one.held, one.functions) == (other.id, other.held, other.functions)


@pytest.mark.parametrize("length", [101.0, 110.0, 400.0])
@pytest.mark.parametrize(
    ("last", "gravity"),
    [((100.0, 0.0, 0.0), (0, 0, -9.81)), ((60.0, -60.0, 50.0), (0, 0, -9.81)), ((20.0, 30.0, 90.0), (3.0, 4.0, -2.0))],
)
def test_a_line_longer_than_the_way_hangs_in_a_catenary_with_nodes_at_equal_arcs(length, last, gravity):
    scene = parse(
        text(f"nodes7: [0, 1], elements: 12, length: {length}, {SECTION}", "[0, 0, 0]", list(last), list(gravity))
    )
    place = positions(scene, [0, *range(2, 13), 1])
    up = -np.array(gravity) / np.linalg.norm(gravity)
    high = place @ up
    level = place - high[:, None] * up
    along = np.linalg.norm(level, axis=1)
    assert np.abs(level - along[:, None] * level[-1] / along[-1]).max() < 1e-10, "it hangs in a plane"
    # z = a cosh((x - c) / a) + d of the same ends and length: a from the length, c from the ends
    width, rise = along[-1], high[-1]
    chord = np.sqrt(length**2 - rise**2)
    a = 0.5 * width / brentq(lambda x: np.sinh(x) / x - chord / width, 1e-3, 50.0, xtol=1e-15)
    c = 0.5 * width - a * np.arctanh(rise / length)
    curve = a * (np.cosh((along - c) / a) - np.cosh(c / a))
    assert high == pytest.approx(curve, abs=1e-9)
    arcs = [quad(lambda x: np.cosh((x - c) / a), *ends, epsabs=1e-12)[0] for ends in pairwise(along)]
    assert arcs == pytest.approx([length / 12] * 12, rel=1e-9)
    slopes = np.array([node.slope for node in scene.nodes])
    assert np.linalg.norm(slopes, axis=1) == pytest.approx(1.0) and list(material_coordinates(scene).values())[-1] in (
        pytest.approx(length),
    )


@pytest.mark.parametrize(("width", "rise", "length"), [(1.0, 0.0, 1.0 + 1e-8), (1.0, 0.0, 1e4), (1.0, 999.0, 1000.0)])
def test_extreme_catenaries_end_where_they_must(width, rise, length):
    along, high, _ = hanging(width, rise, length, np.array([0.0, 0.5 * length, length]))
    assert along == pytest.approx([0.0, along[1], width], abs=1e-8) and 0.0 < along[1] < width
    assert high == pytest.approx([0.0, high[1], rise], abs=1e-8 * length)


def test_a_hanging_line_is_nearly_at_rest_and_comes_to_rest_at_once():
    made = parse(text("nodes7: [0, 1], elements: 400, length: 110, EA: 1.0e9, EJ: 0, rhoA: 5", last="[100, 0, 0]"))
    model = Installed().of(made).build(made)
    state = new_state(model.system)
    before = state.q.copy()
    assert find_equilibrium(model.system, state, model.step_limit).iterations <= 10
    # The stretch of 110 m by 2 kN over 1e9 N is 2e-4 m; sag grows by some of it.
    assert 1e-6 < np.abs(state.q - before).max() < 1e-3


def test_a_line_shorter_than_the_way_is_stretched_alike_everywhere():
    scene = parse(text(f"nodes7: [0, 1], elements: 7, length: 99, {SECTION}", last="[100, 0, 0]", gravity="[0, 0, 0]"))
    model = Installed().of(scene).build(scene)
    frames = new_state(model.system)
    assert material_coordinates(scene)[1] == pytest.approx(99.0)
    assert np.array([node.slope for node in scene.nodes]) == pytest.approx(np.array([[100 / 99, 0, 0]] * 8))
    before = frames.q.copy()
    find_equilibrium(model.system, frames, model.step_limit)
    assert frames.q == pytest.approx(before, abs=1e-9), "it is in equilibrium as it is drawn"


def test_ids_follow_what_is_written_and_items_may_name_the_nodes_between():
    more = (
        "  - Node7Dof: {id: 50, xyz: [200, 0, 10], BC: [1, 1, 1, 0, 0, 0, 1]}\n"
        f"  - CableLine: {{id: 10, nodes7: [1, 50], elements: 3, between: 20, {SECTION}}}\n"
        "  - PointForce: {id: 0, nodes7: [21, 51], force: [0, 0, -10]}\n"
        "Plots: [{SubPlot: [{Node: 51, what: r, DOF: 3}, {Cable: 12, what: N}]}]\n"
    )
    scene = parse(text(f"nodes7: [0, 1], elements: 4, {SECTION}", more=more))
    assert [node.id for node in scene.nodes] == [0, 51, 52, 53, 1, 20, 21, 50]
    assert [e.id for e in scene.elements] == [0, 1, 2, 3, 10, 11, 12]
    assert [e.nodes for e in scene.elements][-4:] == [(53, 1), (1, 20), (20, 21), (21, 50)]


def test_a_line_of_linear_elements_and_one_of_a_single_element_are_drawn():
    line = "nodes4: [0, 1], elements: 3, length: 110, EA: 1.0e7, rhoA: 5"
    linear = parse(text(line, kind="Node4Dof", held="BC: [1, 1, 1, 1]"))
    assert {e.kind for e in linear.elements} == {"linear"} and material_coordinates(linear)[1] == pytest.approx(110.0)
    one = parse(text(f"nodes7: [0, 1], elements: 1, length: 110, {SECTION}"))
    assert len(one.nodes) == 2 and material_coordinates(one)[1] == pytest.approx(110.0)


WITH_P = f"p: 0, {HELD}"
WRONG = {
    "no such end": ({"line": "nodes7: [0, 9], elements: 3"}, "nodes7[1] = 9", "known: 0 to 3"),
    "ends in itself": ({"line": "nodes7: [0, 4], elements: 5"}, "nodes7", "between its own ends, 2 to 5"),
    "both ends one": ({"line": "nodes7: [1, 1], elements: 3"}, "nodes7", "name two nodes"),
    "no ends": ({"line": "elements: 3"}, "nodes7", "name both ends"),
    "no elements": ({"line": "nodes7: [0, 1], elements: 0"}, "elements = 0", "1"),
    "too many": ({"line": "nodes7: [0, 1], elements: 100001"}, "elements = 100001", "100000"),
    "a length of mass": ({"line": "nodes7: [0, 1], elements: 3, length: 5 kg"}, "length = 5 kg", "m"),
    "taken nodes": ({"line": "nodes7: [0, 1], elements: 5, between: 1"}, "between = 1", "the id 1, which is one of"),
    "taken elements": (
        {"line": "nodes7: [0, 1], elements: 5", "more": f"  - CableALEelement: {{id: 3, nodes7: [0, 1], {SECTION}}}\n"},
        "CableModel[3].CableALEelement.id = 3", "has this id already",
    ),
    "hangs without gravity": (
        {"line": "nodes7: [0, 1], elements: 5, length: 200", "gravity": "[0, 0, 0]"}, "length = 200", "without gravity",
    ),
    "hangs in a loop": (
        {"line": "nodes7: [0, 1], elements: 5, length: 200", "last": "[0, 0, 10]"}, "length = 200", "above one another",
    ),
    "stands at a point": ({"line": "nodes7: [0, 1], elements: 5", "last": "[0, 0, 0]"}, "nodes7", "at one point"),
    "two lengths": ({"line": "nodes7: [0, 1], elements: 5, length: 120", "held": WITH_P}, "length = 120", "p of its"),
    "linear with bending": ({"line": "nodes4: [0, 1], elements: 3"}, "EJ", "no bending"),
    "a torn line": ({"line": "nodes7: [0, 1], elements: 3, length: 1 mm"}, "length = 1 mm", "stretched so far"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_with_a_line_is_named_with_key_and_cure(case):
    changes, key, words = WRONG[case]
    with pytest.raises(SceneError) as raised:
        parse(text(**(changes | {"line": f"{changes['line']}, {SECTION}"})))
    message = str(raised.value)
    assert key in message and words in message


def test_a_line_that_is_stretched_by_much_is_warned_of_once_and_by_its_length():
    scene = parse(text(f"nodes7: [0, 1], elements: 50, length: 80, {SECTION}"))
    found = Installed().of(scene).warnings(scene)
    assert [one.where for one in found] == ["CableModel[2].CableLine.length (line 5)"]
    assert "stretched by 26 %" in found[0].text and "`length:`" in found[0].text


def test_a_line_without_mass_is_warned_of_once():
    scene = parse(text("nodes7: [0, 1], elements: 50, EA: 1e7, rhoA: 0"))
    texts = [warning.text for warning in Installed().of(scene).warnings(scene)]
    assert sum("has no mass" in line for line in texts) == 1


def test_a_branch_from_a_node_between_the_ends_takes_its_slope_from_where_the_line_lies():
    branch = (
        "  - Node7Dof: {id: 50, xyz: [5, 0, -2], BC: [0, 0, 0, 0, 0, 0, 1]}\n"
        f"  - CableALEelement: {{id: 10, nodes7: [3, 50], {SECTION}}}\n"
    )
    scene = parse(text(f"nodes7: [0, 1], elements: 4, between: 2, {SECTION}", last="[10, 0, 0]", more=branch))
    end = next(node for node in scene.nodes if node.id == 50)
    assert positions(scene, [3])[0] == pytest.approx([5.0, 0.0, 0.0])
    assert end.slope == pytest.approx((0.0, 0.0, -1.0))


@pytest.mark.parametrize(
    ("elements", "told"),
    [(200, "one turns by 85 degrees. Gauss points may"), (31, "turns by more than a right angle")],
)
def test_a_line_whose_elements_are_too_long_for_its_bend_is_warned_of_once_and_by_their_number(elements, told):
    line = f"nodes7: [0, 1], elements: {elements}, length: 150, quadrature: gauss, {SECTION}"
    scene = parse(text(line, last="[1, 0, 0]"))
    (warned,) = Installed().of(scene).warnings(scene)
    assert warned.where == "CableModel[2].CableLine.elements (line 5)"
    assert told in warned.text and re.search(r"[Gg]ive \d+ or more", warned.text)


def test_a_line_of_enough_elements_for_its_bend_is_not_warned_of():
    scene = parse(text(f"nodes7: [0, 1], elements: 4340, length: 150, {SECTION}", last="[1, 0, 0]"))
    assert list(Installed().of(scene).warnings(scene)) == []


def test_a_length_that_another_cable_between_the_same_nodes_contradicts_is_refused_once():
    """Both would share p of their ends: the second cable would have the length of the first."""
    other = f"  - CableLine: {{id: 10, nodes7: [0, 1], elements: 4, length: 120, {SECTION}}}\n"
    with pytest.raises(SceneError) as raised:
        parse(text(f"nodes7: [0, 1], elements: 4, {SECTION}", more=other))
    (problem,) = raised.value.problems
    assert "CableModel[3].CableLine.length" in str(problem)
    assert "is 120 m, and p at its ends differs by" in problem.cause and "a node of its own" in problem.cure


def test_two_cables_of_one_length_between_the_same_nodes_share_their_material():
    other = f"  - CableLine: {{id: 10, nodes7: [0, 1], elements: 7, length: 120, {SECTION}}}\n"
    p = material_coordinates(parse(text(f"nodes7: [0, 1], elements: 4, length: 120, {SECTION}", more=other)))
    assert p[1] == pytest.approx(120.0)


@pytest.mark.parametrize(("ends", "told"), [("[2, 1]", True), ("[1, 2]", False)])
def test_cables_that_meet_head_on_and_share_a_slope_are_warned_of(ends, told):
    """Their material begins at both far ends: the slope dr/dp of one is against that of the other."""
    free = "BC: [0, 0, 0, 0, 0, 0, 1]"
    more = (
        f"  - Node7Dof: {{id: 2, xyz: [200, 0, 0], {HELD}}}\n"
        f"  - CableLine: {{id: 20, nodes7: {ends}, elements: 10, length: 110, {SECTION}}}\n"
    )
    scene = text(f"nodes7: [0, 1], elements: 10, length: 110, {SECTION}", last="[100, 0, 0]", more=more)
    scene = parse(scene.replace(f"xyz: [100, 0, 0], {HELD}", f"xyz: [100, 0, 0], {free}"))
    found = [one for one in Installed().of(scene).warnings(scene) if "share the slope of node 1" in one.text]
    assert bool(found) is told
    if told:
        assert "elements 9 and 29" in found[0].text and "swap the nodes" in found[0].text


@pytest.mark.parametrize(
    ("section", "told"), [("EJ: 0", True), ("EJ: 0, quadrature: lobatto", False), ("EJ: 1", False)]
)
def test_a_corner_of_a_rope_of_smooth_elements_is_warned_of_where_it_spoils_the_force(section, told):
    """A load of 500 N at the middle of a rope; by symmetry each half is an elastic catenary (Irvine, 1981)."""
    load = "  - PointForce: {id: 0, nodes7: [11], force: [0, 0, -500]}\n"
    line = f"nodes7: [0, 1], elements: 20, length: 110, EA: 1e7, rhoA: 5, strain: engineering, {section}"
    scene = parse(text(line, last="[100, 0, 0]", more=load).replace("rho_inf: 0.8", "rho_inf: 0.8, start: static"))
    found = [one for one in Installed().of(scene).warnings(scene) if "has a corner" in one.text]
    assert bool(found) is told
    weight, EA, half = 5 * 9.81, 1e7, 55.0

    def across(pull):
        ends = [(250.0 + weight * s) / pull for s in (0.0, half)]
        return pull * half / EA + pull / weight * (np.arcsinh(ends[1]) - np.arcsinh(ends[0])) - 50.0

    pull = brentq(across, 100.0, 1e5)
    beside = np.hypot(pull, 250.0 + weight * 0.5 * half / 10)
    force = simulate(build(scene))["axial_force"][0, 9:11]
    assert (np.abs(force / beside - 1.0).max() > 0.05) is np.bool_(told)


def test_a_branch_that_shares_the_slope_of_a_line_is_refused_once_and_not_warned_of():
    more = (
        "  - Node7Dof: {id: 50, xyz: [50, 0, -20], BC: [0, 0, 0, 0, 0, 0, 1]}\n"
        f"  - CableALEelement: {{id: 10, nodes7: [3, 50], {SECTION}}}\n"
    )
    scene = parse(text(f"nodes7: [0, 1], elements: 4, between: 2, {SECTION}", last="[100, 0, 0]", more=more))
    assert not [one for one in Installed().of(scene).warnings(scene) if "share the slope" in one.text]
    with pytest.raises(SceneError) as raised:
        build(scene)
    (problem,) = raised.value.problems
    assert "1, 2 and 10, end at node 3 and share its slope" in problem.cause


@pytest.mark.parametrize(("over", "told"), [(0.001, True), (0.02, False)])
def test_a_prescribed_velocity_that_changes_within_a_step_is_warned_of(over, told):
    motion = f"  - Function_VelocityDefined: {{id: 1, timeList: [0, {over}, 1], velocityList: [0, 5, 5]}}\n"
    scene = text(f"nodes7: [0, 1], elements: 4, {SECTION}", last="[100, 0, 0]", more=motion)
    scene = parse(scene.replace(f"0], {HELD}", f"0], {HELD}, BC_functions: [1, 0, 0, 0, 0, 0, 0]", 1))
    found = [one for one in Installed().of(scene).warnings(scene) if "the velocity changes by 5 m/s" in one.text]
    assert bool(found) is told


def test_moments_too_close_for_numbers_are_refused_by_their_place():
    motion = "  - Function_VelocityDefined: {id: 1, timeList: [0, 1.0e-300], velocityList: [0, 5]}\n"
    with pytest.raises(SceneError, match=r"timeList\[1\].*is no time after the one before"):
        parse(text(f"nodes7: [0, 1], elements: 4, {SECTION}", more=motion))


def told_of_a_line(elements, length, last="[100, 0, 0]", points="gauss"):
    line = f"nodes7: [0, 1], elements: {elements}, length: {length}, quadrature: {points}, {SECTION}"
    scene = parse(text(line, last=last))
    return [one.text for one in Installed().of(scene).warnings(scene)]


def static_force(source):
    return simulate(build(parse(source.replace("0.05}", "0.05, start: static}"))))["axial_force"][0]


@pytest.mark.parametrize("elements", [12, 40, 100])
def test_a_line_that_hangs_folded_is_warned_of_where_its_points_make_its_forces_wrong(elements):
    """10 m over 1 m; source: the catenary that does not stretch, in closed form."""
    scale = brentq(lambda x: np.sinh(x) / x - 10.0, 1.0, 10.0)
    a, arcs = 0.5 / scale, (np.arange(elements) + 0.5) * 10.0 / elements - 5.0
    expected = 5 * 9.81 * np.hypot(a, arcs)
    rope = SECTION.replace("EJ: 10", "EJ: 0")
    for points in ("gauss", "lobatto"):
        line = f"nodes7: [0, 1], elements: {elements}, length: 10, quadrature: {points}, {rope}"
        source = text(line, last="[1, 0, 0]")
        off = np.abs(static_force(source) / expected - 1.0).max()
        said = told_of_a_line(elements, 10, "[1, 0, 0]", points)
        if points == "lobatto":
            assert off < 0.004 and said == []
        else:
            assert off > 0.1 and "Gauss points may" in said[0] and "Give `quadrature: lobatto`. " in said[0]
            assert ("half or more" if elements < 100 else "by a tenth") in said[0]


def test_a_hanging_line_of_many_elements_is_told_where_one_turns_by_more_than_30_degrees():
    """10 m over 1 m in 40 elements: steepness grows by 52/40 for each."""
    (said,) = told_of_a_line(40, 10, "[1, 0, 0]")
    assert "one turns by 66 degrees. Gauss points may make the forces near there wrong by half or more" in said
    assert "Give `quadrature: lobatto`. Without it: give 168 or more" in said
    assert told_of_a_line(168, 10, "[1, 0, 0]") == []


@pytest.mark.parametrize(("elements", "degrees"), [(1, 80), (2, 40), (3, 31), (4, None), (16, None)])
def test_a_hanging_line_whose_elements_turn_far_is_told_by_how_much_and_how_many_are_better(elements, degrees):
    """110 m over 100 m: its ends slope by 40.1 degrees, sinh(50 / a) a = 55 m."""
    texts = [said for said in told_of_a_line(elements, 110) if "too few for the bend" in said]
    if degrees is None:
        assert not texts
    else:
        assert len(texts) == 1 and f"turns by {degrees} degrees" in texts[0] and "give 4 or more" in texts[0]


@pytest.mark.parametrize(
    ("length", "last"),
    [(200, "[100, 0, 0]"), (400, "[100, 0, 0]"), (400, "[100, 0, 200]"), (150, "[100, 0, -40]"), (150, "[20, 0, 0]")],
)
@pytest.mark.parametrize("points", ["gauss", "lobatto"])
def test_a_line_too_coarse_for_its_bend_is_told_once_the_least_number_from_which_on_nothing_is_said(
    length, last, points
):
    found = {n: told_of_a_line(n, length, last, points) for n in range(1, 130)}
    assert all(len(texts) <= 1 for texts in found.values())
    most = max(n for n, texts in found.items() if texts)
    for texts in found.values():
        assert not texts or f"ive {most + 1} or more" in texts[0]
    assert found[1] and found[2] and most < 120


@pytest.mark.parametrize(("elements", "lacking"), [(1, 20), (2, 2.0), (3, 1.3), (4, 0.7), (6, 0.3)])
def test_forces_of_a_coarse_line_lack_the_share_of_the_catenarys_mean_that_the_warning_knows(elements, lacking):
    """Source: the elastic catenary (Irvine, Cable Structures, 1981), in closed form."""
    weight, EA, half = 5 * 9.81, 1e7, 55.0
    pull = brentq(lambda H: H * half / EA + H / weight * np.arcsinh(weight * half / H) - 50.0, 100.0, 1e5)
    arcs = np.linspace(-half, half, elements + 1)
    mean = [quad(lambda s: np.hypot(pull, weight * s), a, b)[0] / (b - a) for a, b in pairwise(arcs)]
    source = text(f"nodes7: [0, 1], elements: {elements}, length: 110, {SECTION}", last="[100, 0, 0]")
    force = static_force(source)
    worst = (force / mean - 1.0)[np.abs(force / mean - 1.0).argmax()]
    assert 100.0 * worst == pytest.approx(-lacking, abs=0.35 if elements == 1 else 0.06)


def passes_over(scene):
    """How often the warnings of a scene go through all of its nodes, and through all of its elements."""
    passes = Counter()

    class Counted(list):
        def __init__(self, name, parts):
            super().__init__(parts)
            self.name = name

        def __iter__(self):
            passes[self.name] += 1
            return super().__iter__()

    counted = {name: Counted(name, getattr(scene, name)) for name in ("nodes", "elements")}
    scene = dataclasses.replace(scene, **counted)
    assert sum("too few for the bend" in one.text for one in Installed().of(scene).warnings(scene))
    return passes


def lines_beside_one_another(count, spans=lambda i: 20.0):
    """Lines of three elements, 40 m each, that hang beside one another."""
    ends = "".join(
        f"  - Node7Dof: {{id: {2 * i + k}, xyz: [{k * spans(i)}, {i}, 0], {HELD}}}\n"
        for i in range(count)
        for k in (0, 1)
    )
    lines = "".join(
        f"  - CableLine: {{id: {6 * i}, nodes7: [{2 * i}, {2 * i + 1}], elements: 3, length: 40, {SECTION}}}\n"
        for i in range(count)
    )
    return parse(f"CableModelMaterial: {{Gravity: [0, 0, -9.81]}}\nCableModel:\n{ends}{lines}{SOLVER}")


def test_warnings_of_many_coarse_lines_go_through_the_scene_as_often_as_those_of_a_few():
    few, many = (passes_over(lines_beside_one_another(n, lambda i: 20.0 + 0.01 * i)) for n in (2, 30))
    assert many == few and min(few.values()) > 0


def test_the_elements_that_are_enough_are_looked_for_once_for_lines_that_hang_alike(monkeypatch):
    looked = Counter()
    true = coarse_lines._is_quiet
    monkeypatch.setattr(coarse_lines, "_is_quiet", lambda *asked: (looked.update([asked]), true(*asked))[1])
    scene = lines_beside_one_another(20, lambda i: 21.5)
    assert sum("too few for the bend" in one.text for one in Installed().of(scene).warnings(scene)) == 20
    assert set(looked.values()) == {1}


@pytest.mark.parametrize(("length", "last"), [(12, "[1.0e-3, 0, 10]"), (12, "[1.0e-3, 0, 0]"), (20000, "[1, 0, 0]")])
def test_a_line_too_folded_for_any_number_of_elements_is_told_to_hang_folded_and_no_number_that_is_refused(
    length, last
):
    (said,) = told_of_a_line(5, length, last)
    across = last.split(",")[0][1:]
    assert "hangs folded" in said and f"only {float(across):.3g} m apart, too close for a length of {length} m" in said
    assert "Give" not in said and "Even 100000 elements" in said


def test_the_cures_of_a_folded_line_leave_nothing_to_be_said():
    """Ends farther apart, and two lines whose lower ends are tied."""
    assert told_of_a_line(430, 12, "[0.5, 0, 10]") == []
    free = "BC: [0, 0, 0, 0, 0, 0, 1]"
    more = (
        f"  - Node7Dof: {{id: 2, xyz: [0, 0, -1], {free}}}\n  - Node7Dof: {{id: 3, xyz: [0.001, 0, 10], {HELD}}}\n"
        f"  - CableLine: {{id: 20, nodes7: [2, 3], elements: 11, length: 11, {SECTION}}}\n"
        "  - LagMultipl7: {id: 0, nodes7: [1, 2], constr: 0}\n"
    )
    scene = text(f"nodes7: [0, 1], elements: 5, length: 1, {SECTION}", last="[0, 0, -1]", more=more)
    scene = parse(scene.replace(f"xyz: [0, 0, -1], {HELD}", f"xyz: [0, 0, -1], {free}"))
    assert [one.text for one in Installed().of(scene).warnings(scene)] == []
    force = simulate(build(scene))["axial_force"][-1]
    # The lower end of each hangs free, and its upper end carries it all but half an element.
    assert np.isfinite(force).all() and force.max() < 12.0 * 5.0 * 9.81


def test_a_hanging_line_without_gravity_is_refused_with_the_word_that_its_load_is_not_looked_at():
    line = f"nodes7: [0, 1], elements: 4, length: 110, load: [0, 0, -10], {SECTION}"
    with pytest.raises(SceneError, match=r"without gravity .* its `load` is not looked at"):
        parse(text(line, gravity="[0, 0, 0]"))
