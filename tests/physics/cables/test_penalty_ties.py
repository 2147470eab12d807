"""Penalty springs between spans of a rope: how stiff they are chosen, and what rounding leaves of their forces.

A mass M let go on a light elastic rope falls by twice its stretch at rest, 2 M g L/EA, and comes back.
"""

import re
from dataclasses import replace
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest
from physics.cables.tied_cables import (
    FREE,
    PINNED,
    at_rest,
    element,
    join,
    model_of,
    node,
    of_nodes,
    run,
    run_unwatched,
    scene,
)

from tautline.cable.input.material import element_lengths
from tautline.cable.input.scene import parse
from tautline.cable.model import magnitudes
from tautline.cable.model.build import assemble_cables
from tautline.cable.model.observe import angle_of, gap_of
from tautline.cable.model.ties import stiff_tie
from tautline.cable.warnings import figures
from tautline.integrators.state import WORST
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.warnings import warnings_of

MASS, LENGTH, g = 1000.0, 10.0, 9.81
HANGING = {"type": "G-alpha", "rho_inf": 1.0, "eps_energy": 1e-8, "time_step": 5e-3, "time_end": 0.5, "plotpoints": 200}


def rope(way, EA, bottom=0.0, stiffness=None, **solver):
    """A vertical rope of 10 m and 0.5 kg in two spans that are joined in its middle, with a ton on its end."""
    z, down = bottom - np.array([0.0, 2.5, 5.0, 5.0, 7.5, 10.0]), (0, 0, -1)
    held = [(1, 1, 1, 0, 0, 0, 1), *[(*FREE[:6], 1)] * 5]
    nodes = [node(i, (0, 0, z[i]), held[i], down) for i in range(6)]
    elements = [element(i, *ends, EA=EA, rhoA=0.05) for i, ends in enumerate([(0, 1), (1, 2), (3, 4), (4, 5)])]
    load = f"PointMass: {{id: 0, nodes7: [5], mass: {MASS}}}"
    tied = join(way, 2, 3, stiffness=None if stiffness is None else [stiffness, stiffness * 2.5**2])
    chosen = solver if solver.get("type") == "RK4" else HANGING | solver
    return scene([*nodes, *elements, *tied, load], (0, 0, -g), **chosen)


def fall(result):
    """Deepest fall of the mass, m."""
    z = of_nodes(result, "position", [5])[:, 0, 2]
    return z[0] - z.min()


@pytest.mark.parametrize(
    ("EA", "top"), [(1e6, 0.0), (3e7, 0.0), (1e8, 0.0), (2e8, 0.0), (1e8, -2000.0), (4e8, -2000.0), (9e8, -3000.0)]
)
def test_ropes_run_to_their_end_with_penalties_of_the_chosen_stiffness(EA, top):
    # measured 8e-6 of the fall between the ways, 6e-5 at -3000 m; the rope itself weighs 5e-4 of the mass, and Green's
    # strain of 2 % at 1e6 N takes 2 % of the fall
    by = {way: run(rope(way, EA, top)) for way in ("multiplier", "penalty")}
    assert by["penalty"]["time"][-1] == pytest.approx(0.5)
    assert fall(by["penalty"]) == pytest.approx(fall(by["multiplier"]), rel=1e-4)
    assert fall(by["penalty"]) == pytest.approx(2.0 * MASS * g * LENGTH / EA, rel=1e-3 + 2.0 * MASS * g / EA)
    forces = [np.array(result["axial_force"]).max() for result in by.values()]
    assert forces[1] == pytest.approx(forces[0], rel=2e-4)


@pytest.mark.parametrize("multiple", [1e2, 1e4, 1e6, 2.5e7])
def test_a_rope_far_from_the_origin_runs_with_any_stated_penalty(multiple):
    # 2000 m are known to 2e-13 m: the tolerance is no smaller than what that leaves of the springs' energy
    stiffness = multiple * 1e8 / 2.5
    result = run(rope("penalty", 1e8, -2000.0, stiffness))
    assert fall(result) == pytest.approx(2.0 * MASS * g * LENGTH / 1e8, rel=1e-3 + 0.3 / multiple)


def test_a_tolerance_below_what_rounding_leaves_of_stiff_springs_is_told():
    model = model_of(rope("penalty", 1e8, -2000.0))
    assert any("eps_energy = 1e-08 is below" in note for note in model.notes)
    # k d^2 of three axes and d = 2 eps 2010 m: what a gap that is rounded to d stores
    assert model.solver.tolerance == pytest.approx((3.0 * 1.33e12) ** 0.5 * 2.0 * 2.2e-16 * 2010.0, rel=0.02)


@pytest.mark.parametrize(("of_elements", "larger"), [(1e-3, 1e-3), (1e-9, 1.78e-6)])
def test_of_what_springs_and_elements_leave_by_rounding_the_larger_is_told_alone(of_elements, larger):
    # both are asked of scenes of many unknowns; what the springs leave is that of the test above
    many = patch("tautline.cable.model.build.MANY", 1)
    with many, patch("tautline.integrators.statics.attainable.attainable", return_value=of_elements):
        model = model_of(rope("penalty", 1e8, -2000.0))
    (note,) = [note for note in model.notes if "eps_energy" in note]
    assert note.startswith("eps_energy = 1e-08 is below") and f"The run uses {model.solver.tolerance:.1e}" in note
    assert model.solver.tolerance == pytest.approx(larger, rel=0.1)


def test_a_chosen_penalty_shares_its_error_between_its_give_and_its_rounding():
    # k = sqrt(K F/d): K/k of an element's stretch and k d/F of the force are the same, 3e-5 at -2000 m
    model, state = at_rest(rope("penalty", 1e8, -2000.0))
    (stiffness,) = {float(k) for group in model.system.groups for k in getattr(group, "stiffness", [])[:1]}
    force = MASS * g
    assert 1e-5 < 4e7 / stiffness < 1e-4
    assert 1e-5 < stiffness * 2.2e-16 * 2010.0 / force < 1e-4
    gap = state.full_q[2 * 7 + 2] - state.full_q[3 * 7 + 2]
    assert gap == pytest.approx(force / stiffness, rel=1e-3)


def test_a_step_without_solution_beside_a_stiff_penalty_names_it_and_the_multiplier():
    with pytest.raises(StoppedEarly) as stop:
        run(rope("penalty", 1e8, maxIter=1))
    assert stop.value.status is Status.NOT_CONVERGED
    assert re.search(r"a penalty spring of 1\.\d*e\+13 N/m ties node [23]", stop.value.sentence)
    assert "LagMultipl7" in stop.value.sentence


@pytest.mark.parametrize(("way", "stiffness"), [("multiplier", None), ("penalty", 1e9)])
def test_a_step_without_solution_blames_no_penalty_that_is_soft_or_not_there(way, stiffness):
    with pytest.raises(StoppedEarly) as stop:
        run(rope(way, 1e8, stiffness=stiffness, maxIter=1))
    assert "penalty" not in stop.value.sentence


def test_a_multiplier_that_was_worst_blames_no_penalty_at_the_last_node():
    # the last node of the list is tied by a stiff penalty, and two others by multipliers, whose unknowns come after it
    places = [(0, 0, 0), (1, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (2, 0, 0)]
    nodes = [node(i, xyz, PINNED if i == 0 else (*FREE[:6], 1)) for i, xyz in enumerate(places)]
    elements = [element(i, *ends, EA=1e6) for i, ends in enumerate([(0, 1), (2, 3), (5, 4)])]
    ties = [*join("multiplier", 1, 2), *join("penalty", 3, 5, (0,), 1e12)]
    layout, system, *_ = assemble_cables(parse(scene([*nodes, *elements, *ties], **HANGING)))
    blamed = {}
    for worst, place in enumerate(system.free):
        state = SimpleNamespace(counters={WORST: worst})
        blamed[int(place)] = stiff_tie(layout, system, state, Status.NOT_CONVERGED)
    assert {place // 7 for place, told in blamed.items() if told} == {3, 5}
    assert max(blamed) > layout.lasts[-1]


# many ties
def spans(ties):
    """A rope along x, whose first span has 1 m and all others 0.5 m, that springs of chosen stiffness join."""
    places = [0.0, *np.repeat(1.0 + 0.5 * np.arange(ties), 2), 1.0 + 0.5 * ties]
    nodes = [node(i, (x, 0, 0), PINNED if i == 0 else (*FREE[:6], 1)) for i, x in enumerate(places)]
    elements = [element(i, 2 * i, 2 * i + 1, EA=1e6) for i in range(ties + 1)]
    tied = [item for i in range(ties) for item in join("penalty", 2 * i + 1, 2 * i + 2)]
    return parse(scene([*nodes, *elements, *tied], **HANGING))


def test_springs_between_slopes_take_the_shortest_element_of_both_nodes_and_look_at_all_elements_once():
    asked = []
    for ties in (3, 12):
        made = spans(ties)
        with patch.object(magnitudes, "element_lengths", side_effect=element_lengths) as lengths:
            slopes = [magnitudes.stiffness_of(made, tie, 4.0) for tie in made.ties if tie.what == 2]
            magnitudes.rounding_error(made)
        assert slopes == [4.0 * 0.5**2] * ties
        asked.append(lengths.call_count)
    assert asked[1] == asked[0]


# soft springs and springs that are too stiff
SMALL = "use LagMultipl7, or put the origin near the ropes, where coordinates are small"


def told_of(text):
    """What is told of the stiffness of ties."""
    return [warning.text for warning in warnings_of("cable", parse(text)) if "p_spring" in warning.where]


@pytest.mark.parametrize(("stiffness", "share"), [(1e5, 100.0), (1e6, 10.0)])
def test_a_soft_spring_is_told_with_the_share_of_stretch_that_it_really_adds(stiffness, share):
    # EA/L of the whole rope is 1e5 N/m, so a spring k adds 1e5/k of its stretch; measured on the rope at rest
    (text,) = told_of(rope("penalty", 1e6, stiffness=stiffness))
    assert f"adds about {share:.3g} % to the stretch" in text and "LagMultipl7" in text and "1e+07 or more" in text
    stretch = []
    for way in ("multiplier", "penalty"):
        _, state = at_rest(rope(way, 1e6, stiffness=None if way == "multiplier" else stiffness))
        stretch.append(-10.0 - state.full_q[5 * 7 + 2])
    assert 100.0 * (stretch[1] / stretch[0] - 1.0) == pytest.approx(share, rel=0.03)


@pytest.mark.parametrize(("way", "stiffness"), [("penalty", 1.1e7), ("penalty", None), ("augmented", 1e4)])
def test_springs_stiff_enough_and_beside_a_multiplier_are_not_called_soft(way, stiffness):
    assert told_of(rope(way, 1e6, stiffness=stiffness)) == []


def test_a_soft_spring_in_a_beam_without_axial_stiffness_is_told_with_its_share_of_the_bending():
    # a cantilever of 2 m gives L^3/(3 EJ) = 2.67e-4 m/N, and the spring in its middle 1/k = 1e-3 m/N more: 375 %
    held, guided = (1, 1, 1, 1, 1, 1, 1), (1, 1, 0, 1, 1, 0, 1)
    nodes = [node(i, (x, 0, 0), guided if i else held) for i, x in enumerate((0.0, 0.5, 1.0, 1.0, 1.5, 2.0))]
    elements = [element(i, *ends, EA=0.0, EJ=1e4) for i, ends in enumerate([(0, 1), (1, 2), (3, 4), (4, 5)])]
    pull = "PointForce: {id: 0, nodes7: [5], force: [0, 0, -0.1]}"
    slopes = join("multiplier", 2, 3, (2,))
    down, told = {}, {}
    for way, stiffness in (("multiplier", None), ("penalty", 1e3)):
        text = scene([*nodes, *elements, *join(way, 2, 3, (0,), stiffness), *slopes, pull], **HANGING)
        told[way] = told_of(text)
        down[way] = -at_rest(text)[1].full_q[5 * 7 + 2]
    assert down["multiplier"] == pytest.approx(0.1 * 2.0**3 / 3e4, rel=1e-3)
    assert 100.0 * (down["penalty"] / down["multiplier"] - 1.0) == pytest.approx(375.0, rel=1e-3)
    (sentence,) = told["penalty"]
    assert "It adds about 375 % to the bending of that rope" in sentence and told["multiplier"] == []


EJ, PULL = 1e4, 0.1


def joined_beam(slopes="penalty", stiffness=None, EJ=EJ, pull=PULL):
    """A cantilever of 2 m in two halves that are joined in its middle, pulled down at its tip."""
    nodes = [
        node(i, (x, 0, 0), (*FREE[:6], 1) if i else (1,) * 7) for i, x in enumerate((0.0, 0.5, 1.0, 1.0, 1.5, 2.0))
    ]
    elements = [element(i, *ends, EA=1e6, EJ=EJ) for i, ends in enumerate([(0, 1), (1, 2), (3, 4), (4, 5)])]
    load = [f"PointForce: {{id: 0, nodes7: [5], force: [0, 0, -{pull}]}}"] if pull else []
    tied = [*join("penalty", 2, 3, (0,), 1e9), *join(slopes, 2, 3, (2,), stiffness)]
    return scene([*nodes, *elements, *tied, *load], **HANGING | {"start": "static"})


@pytest.mark.parametrize(("stiffness", "share"), [(1e5, 5.0), (1e3, 500.0), (10.0, 5e4)])
def test_a_soft_spring_between_slopes_is_told_with_the_share_of_bending_that_it_really_adds(stiffness, share):
    # The tip turns by P L^2/(2 EJ) and sinks by P L^3/(3 EJ). The moment in the middle, P L/2, turns the spring by
    # P L/(2 k) more, EJ/(k L) of the rope's angle, and the tip sinks by L/2 of that.
    (text,) = told_of(joined_beam(stiffness=stiffness))
    assert f"adds about {share:.3g} % to the angle by which that rope bends" in text
    assert "Give 5e+05 or more, or use LagMultipl7" in text
    rigid, sprung = (
        at_rest(text)[1].full_q[5 * 7 :] for text in (joined_beam("multiplier"), joined_beam("penalty", stiffness))
    )
    assert -rigid[2] == pytest.approx(PULL * 2.0**3 / (3.0 * EJ), rel=1e-3)
    assert 100.0 * (sprung[5] / rigid[5] - 1.0) == pytest.approx(share, rel=2e-3)
    assert sprung[2] / rigid[2] == pytest.approx(1.0 + 0.75 * share / 100.0, rel=2e-3)


@pytest.mark.parametrize(
    "text",
    [
        pytest.param(joined_beam(stiffness=5.1e5), id="stiff enough"),
        pytest.param(joined_beam(), id="chosen"),
        pytest.param(joined_beam("augmented", 10.0), id="beside a multiplier"),
        pytest.param(joined_beam(stiffness=10.0, EJ=0.0), id="in a rope that does not resist bending"),
        pytest.param(joined_beam(stiffness=10.0, pull=0.0), id="in a rope that carries nothing"),
    ],
)
def test_a_spring_between_slopes_that_adds_no_bending_is_not_called_soft(text):
    assert told_of(text) == []


def test_many_soft_springs_between_slopes_are_one_warning_of_the_softest_with_their_number():
    places = (0.0, 0.5, 0.5, 1.0, 1.0, 1.5, 1.5, 2.0)
    nodes = [node(i, (x, 0, 0), (*FREE[:6], 1) if i else (1,) * 7) for i, x in enumerate(places)]
    elements = [element(i, 2 * i, 2 * i + 1, EA=1e6, EJ=EJ) for i in range(4)]
    tied = [
        item
        for i, k in zip((1, 3, 5), (1e4, 1e3, 1e9), strict=True)
        for item in join("penalty", i, i + 1, stiffness=[1e9, k])
    ]
    (text,) = told_of(scene([*nodes, *elements, *tied], (0, 0, -g), **HANGING))
    # 0.5 m on either side bend by 1e-4 rad under 1 N m, and 1e3 N m by 1e-3 rad
    assert "1e+03 N m" in text and "about 1e+03 %" in text and "the worst of 2 ties that are too soft" in text


def test_a_soft_spring_between_p_is_told_with_the_rope_that_appears_at_it():
    # 20 m and 5 m on both sides, EA 1e6: a newton stretches the rope by 25e-6 m as far as the next eyelet
    (text,) = told_of(over_an_eyelet(1e4))
    assert f"adds about {100.0 / (1e4 * 25e-6):.3g} % to the stretch" in text
    assert "So much of it appears or vanishes at the tie" in text and "LagMultipl4" in text
    assert told_of(over_an_eyelet(1e8)) == []


def unloaded(stiffness=1e5, gravity=0.0, stretch=1.0, **more):
    """A rope of 10 m along x in two spans without a load; `more` is that of the first element."""
    x, slope = (0.0, 5.0, 5.0, 10.0), (stretch, 0, 0)
    nodes = [node(i, (x[i], 0, 0), PINNED if i == 0 else (*FREE[:6], 1), slope) for i in range(4)]
    elements = [element(0, 0, 1, EA=1e6, **more), element(1, 2, 3, EA=1e6)]
    return scene([*nodes, *elements, *join("penalty", 1, 2, (0,), stiffness)], (0, 0, gravity), **HANGING)


def test_a_soft_spring_is_not_told_where_the_rope_carries_nothing():
    assert told_of(unloaded()) == []
    # Nothing is stretched there, and so the spring adds nothing: the rope stays as it is drawn.
    assert np.abs(run(unloaded())["axial_force"]).max() < 1e-14 * 1e6, "of an EA of 1e6 N, by rounding"
    assert len(told_of(unloaded(gravity=-g))) == 1
    assert len(told_of(unloaded(load=[0, 0, -1.0]))) == 1
    assert len(told_of(unloaded(stretch=1.01))) == 1, "drawn stretched"
    (stiff,) = told_of(unloaded(stiffness=1e14))
    assert "rounding eats the forces" in stiff, "what a run has by its arithmetic is told in any case"


@pytest.mark.parametrize(("word", "most", "least"), [("soft", 1e4, 1e5), ("stiff", 1e15, 1e14)])
def test_of_many_springs_that_are_too_soft_or_too_stiff_the_worst_is_told_with_their_number(word, most, least):
    count = 40
    nodes = [node(i, ((i + 1) // 2, 0, 0), PINNED if i == 0 else (*FREE[:6], 1)) for i in range(2 * count + 2)]
    elements = [element(i, 2 * i, 2 * i + 1, EA=1e6) for i in range(count + 1)]
    ties = [
        one for i in range(count) for one in join("penalty", 2 * i + 1, 2 * i + 2, (0,), most if i == 17 else least)
    ]
    found = [
        one
        for one in warnings_of("cable", parse(scene([*nodes, *elements, *ties], (0, 0, -g), **HANGING)))
        if "p_spring" in one.where
    ]
    (one,) = found
    assert one.text.startswith(f"{most:.2g} N/m") and one.text.endswith(
        f"This is the worst of {count} ties that are too {word}"
    )


def test_a_spring_whose_rounding_is_felt_far_from_the_origin_is_told_with_the_force_and_a_better_one():
    (text,) = told_of(rope("penalty", 1e8, -2000.0, 1e14))
    assert "rounding eats the forces" in text
    # k d at 2010 m: 1e14 N/m of 4.5e-13 m
    assert "by up to 4e+01 N; give 1e+12" in text


@pytest.mark.parametrize(("stiffness", "is_eaten"), [(4.1e11, False), (1e13, False), (1e14, False), (1e22, True)])
def test_a_spring_is_told_for_its_rounding_where_that_is_felt_and_not_for_being_stiff_alone(stiffness, is_eaten):
    # 1e6 to 2.5e8 times the stiffest element: measured 2e-9 of the largest force and less, but 8e-3 at 1e22 N/m, where
    # nothing is left of the rope's stiffness beside the spring's
    largest = [
        np.array(run(rope(way, 1e6, stiffness=k))["axial_force"]).max()
        for way, k in (("multiplier", None), ("penalty", stiffness))
    ]
    assert (abs(largest[1] / largest[0] - 1.0) > 1e-3) == is_eaten
    assert abs(largest[1] / largest[0] - 1.0) < 1e-8 or is_eaten
    told = told_of(rope("penalty", 1e6, stiffness=stiffness))
    assert len(told) == is_eaten and all("rounding eats the forces" in text for text in told)


@pytest.mark.parametrize(("EA", "bottom"), [(1e8, 0.0), (1e8, -2000.0), (3e5, 0.0), (7e7, -5e4), (2.9e6, -2e5)])
def test_a_spring_as_stiff_as_is_advised_is_not_told_again(EA, bottom):
    (text,) = told_of(rope("penalty", EA, bottom, 1e18))
    advised = float(re.search(r"give ([\d.e+]+)$", text).group(1))
    assert told_of(rope("penalty", EA, bottom, advised)) == []


@pytest.mark.parametrize("stiffness", [1e18, 2e11])
def test_where_rounding_is_felt_with_any_spring_the_multiplier_or_another_origin_is_advised(stiffness):
    # 4.2e6 m as of a map: doubles are 9.3e-10 m apart there; 4e8 N/m ask for 2e11 N/m: 200 N beside 1e5 N
    (text,) = told_of(rope("penalty", 1e9, -4.2e6, stiffness))
    assert text.endswith(SMALL)


def test_a_chosen_spring_whose_rounding_is_felt_is_told_once():
    found = [w for w in warnings_of("cable", parse(rope("penalty", 1e9, -4.2e6))) if "Penalty7" in w.where]
    (warning,) = found
    assert "N/m is chosen" in warning.text and warning.text.endswith(SMALL)
    assert [w for w in warnings_of("cable", parse(rope("penalty", 1e8))) if "Penalty7" in w.where] == []


def test_a_stiff_spring_between_elements_without_stiffness_is_told_with_the_multiplier_and_no_multiple():
    nodes = [node(i, (x, 0, 0), PINNED if i == 0 else (*FREE[:6], 1)) for i, x in enumerate((0, 1, 1, 2))]
    elements = [element(i, *ends, EA=0.0) for i, ends in enumerate([(0, 1), (2, 3)])]
    (text,) = told_of(scene([*nodes, *elements, *join("penalty", 1, 2, stiffness=1e14)], (0, 0, -g), **HANGING))
    # 1e14 N/m of the rounding of 2 m, 4.4e-16 m
    assert text == "1e+14 N/m: rounding eats the forces, by up to 0.04 N; " + SMALL


def test_the_largest_gap_of_penalty_springs_is_a_figure_of_the_run():
    # the load at rest pulls the spring open by (M + half the rope) g/k
    result = run(rope("penalty", 1e6, stiffness=1e5, start="static"))
    figure = model_of(rope("penalty", 1e6, stiffness=1e5)).headline(result)["tie_gap_max"]
    assert figure["value"] == pytest.approx((MASS + 0.25) * g / 1e5, rel=1e-6)
    assert figure["unit"] == "m"
    assert "tie_gap_max" not in model_of(rope("multiplier", 1e6)).headline(result)


def test_the_largest_angle_between_slopes_at_penalty_springs_is_a_figure_of_the_run():
    # the moment P L/2 turns a spring k by P L/(2 k): 0.01 rad
    text = joined_beam(stiffness=10.0)
    model = model_of(text)
    figure = model.headline(run(text))["tie_angle_max"]
    assert figure["value"] == pytest.approx(PULL * 1.0 / 10.0, rel=1e-3)
    assert figure["unit"] == model.figure_units["tie_angle_max"] == "rad"
    without = model_of(joined_beam("multiplier"))
    assert "tie_angle_max" not in without.figure_units and "tie_angle_max" not in without.headline(
        run(joined_beam("multiplier"))
    )


def test_an_angle_between_slopes_that_both_nodes_hold_is_none_of_a_spring():
    # the halves of a wire along x leave in other directions, which are held; nothing else bends them
    held = (1, 1, 1, 1, 1, 1, 1)
    nodes = [node(i, (x, 0, 0), held, (1, 0, d)) for i, (x, d) in enumerate([(0, 0.0), (1, 0.0), (1, 0.1), (2, 0.1)])]
    elements = [element(0, 0, 1, EA=1e6), element(1, 2, 3, EA=1e6)]
    made = parse(scene([*nodes, *elements, *join("penalty", 1, 2, (2,), 1e5)], **HANGING))
    slopes = np.array([[n.slope for n in made.nodes]] * 3)
    assert angle_of({"slope": slopes}, made) == 0.0
    freed = replace(made, nodes=[n._replace(held=(*n.held[:5], False, True)) for n in made.nodes])
    assert angle_of({"slope": slopes}, freed) == pytest.approx(np.arctan(0.1), rel=1e-12)


def test_a_gap_along_an_axis_that_both_nodes_hold_is_none_of_a_spring():
    # a stretched wire along x whose halves are drawn 0.5 m apart in y, where nothing may move: the spring opens by F/k
    places, held = [(0, 0, 0), (1, 0, 0), (1, 0.5, 0), (2, 0.5, 0)], [PINNED, *[(0, 1, 1, 0, 0, 0, 1)] * 3]
    nodes = [node(i, xyz, BC) for i, (xyz, BC) in enumerate(zip(places, held, strict=True))]
    elements = [element(0, 0, 1, EA=1e6), element(1, 2, 3, EA=1e6)]
    pull = "PointForce: {id: 0, nodes7: [3], force: [1000.0, 0, 0]}"
    text = scene([*nodes, *elements, *join("penalty", 1, 2, (0,), 1e5), pull], **HANGING | {"start": "static"})
    figure = model_of(text).headline(run(text))["tie_gap_max"]
    assert figure["value"] == pytest.approx(1000.0 / 1e5, rel=1e-6)


def test_a_variable_is_read_once_for_the_gap_of_all_penalty_springs():
    class Counted(dict):
        asked = 0

        def __getitem__(self, name):
            self.asked += 1
            return super().__getitem__(name)

    ropes = parse(over_an_eyelet(1e8)), parse(rope("penalty", 1e6))
    many = [replace(ropes[what], ties=ropes[what].ties * 50) for what in (0, 1)]
    for made in many:
        result = Counted(position=np.zeros((3, len(made.nodes), 3)), material_coordinate=np.zeros((3, len(made.nodes))))
        assert gap_of(result, made) == 0.0
        assert result.asked == 1


# the critical step of RK4
def over_an_eyelet(stiffness, **solver):
    """A rope over an eyelet, which is held twice, and whose p on either side a penalty spring makes equal."""
    places = [(0, 0, -20), (0, 0, 0), (0, 0, 0), (5, 0, 0), (5, 0, -20)]
    held = [(1, 1, 0, 1), *[(1, 1, 1, 0)] * 3, (1, 1, 0, 1)]
    nodes = [
        f"Node4Dof: {{id: {i}, xyz: {[*map(float, place)]}, BC: {[*BC]}, p: {p}}}"
        for i, (place, BC, p) in enumerate(zip(places, held, (0, 20, 20, 25, 45), strict=True))
    ]
    elements = [
        f"CableALEelementLin: {{id: {i}, nodes4: [{a}, {b}], EA: 1.0e6, rhoA: 0.01, cDamp: 0}}"
        for i, (a, b) in enumerate([(0, 1), (2, 3), (3, 4)])
    ]
    loads = [f"PointMass: {{id: {i}, nodes4: [{n}], mass: {m}}}" for i, n, m in ((0, 0, 1000), (1, 4, 800))]
    tie = f"Penalty4: {{id: 1, nodes4: [1, 2], constr: 1, p_spring: {stiffness}}}"
    return scene([*nodes, *elements, *loads, tie], (0, 0, -g), **solver)


@pytest.mark.parametrize(
    "made",
    [
        pytest.param(lambda **solver: rope("penalty", 1e6, **solver), id="of r and r', chosen"),
        pytest.param(lambda **solver: rope("penalty", 1e6, stiffness=1e9, **solver), id="of r and r', given"),
        pytest.param(lambda **solver: over_an_eyelet(1e9, **solver), id="of p"),
    ],
)
def test_the_critical_step_that_is_told_before_a_run_counts_penalty_springs(made):
    # measured 0.81, 0.81 and 0.88 of the step from which on RK4 is unstable: it is told as "at least about"
    told = figures(parse(made(type="RK4")))["critical_step_rk4"]
    solver = {"type": "RK4"}
    run_unwatched(made(**solver, time_step=told, time_end=300 * told))
    with pytest.raises(StoppedEarly) as stop:
        run(made(**solver, time_step=1.4 * told, time_end=4000 * told))
    assert stop.value.status is Status.UNSTABLE


def test_a_spring_beside_a_multiplier_leaves_the_critical_step_that_is_told():
    told = [figures(parse(rope(way, 1e6)))["critical_step_rk4"] for way in ("augmented", "multiplier")]
    assert told[0] == told[1]
