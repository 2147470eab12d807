"""Static starts of ropes with one element that is far shorter than the others, such as a fitting.

The references are solved here: a chain of straight elastic bars whose weights are halved between their ends, and the
elastic catenary (Irvine, Cable Structures, 1981, section 2.2). A rope with a free end bears the weight below.
"""

import numpy as np
import pytest
from scipy.optimize import fsolve

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.statics import stability
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.status import StoppedEarly
from tautline.simulation import simulate

EA, WEIGHT, SPAN, LENGTH = 1e5, 1.5 * 9.81, 8.0, 10.0


def arcs(short, count):
    """Material of the nodes: a short element in the middle of a rope, count of equal ones on each side."""
    half = np.linspace(0.0, 0.5 * LENGTH, count + 1)
    return np.concatenate([half, half + 0.5 * LENGTH + short])


def text(arc, places, kind):
    ends, last = (0, len(arc) - 1), kind - 4
    lines = []
    for i, (s, (x, z)) in enumerate(zip(arc, places, strict=True)):
        held = [int(i in ends)] * 3 + [0] * last + [1]
        lines.append(f"Node{kind}Dof: {{id: {i}, xyz: [{x}, 0, {z}], BC: {held}, p: {s}}}")
    key = "CableALEelement" if kind == 7 else "CableALEelementLin"
    given = f"EA: {EA}, rhoA: 1.5, strain: engineering" + (", quadrature: lobatto" if kind == 7 else "")
    lines += [f"{key}: {{id: {i}, nodes{kind}: [{i}, {i + 1}], {given}}}" for i in range(len(arc) - 1)]
    items = "".join(f"  - {line}\n" for line in lines)
    solver = "GeneralizedAlpha: {type: G-alpha, time_step: 1e-3, time_end: 1e-3, plotpoints: 0, start: static}"
    return f"CableModelMaterial: {{Gravity: [0, 0, -9.81]}}\nCableModel:\n{items}{solver}\n"


def vee(arc):
    """Places on two straight lines, 1.5 m deep for each 2 m: a rope drawn far from how it hangs."""
    middle = 0.5 * (arc[0] + arc[-1])
    return [(SPAN / LENGTH * s, 0.6 * (abs(s - middle) - middle)) for s in arc]


def chain(arc, span):
    """Forces in a chain of elastic bars between two points at one height."""
    lengths = np.diff(arc)

    def forces(unknown):
        level, first = unknown
        up = first - WEIGHT * 0.5 * (arc[1:] + arc[:-1])
        return level, up, np.hypot(level, up)

    def gap(unknown):
        level, up, force = forces(unknown)
        along = lengths * (1.0 / force + 1.0 / EA)
        return [(along * level).sum() - span, (along * up).sum()]

    return forces(fsolve(gap, [50.0, 0.5 * WEIGHT * arc[-1]], xtol=1e-13))[2]


def catenary(arc, span):
    """Forces in the elastic catenary at the middle of each element."""
    total, first = arc[-1], 0.5 * WEIGHT * arc[-1]
    level = fsolve(lambda h: h * total / EA + 2.0 * h / WEIGHT * np.arcsinh(first / h) - span, [50.0], xtol=1e-13)[0]
    return np.hypot(level, first - WEIGHT * 0.5 * (arc[1:] + arc[:-1]))


@pytest.mark.parametrize("short", [1e-2, 1e-3, 1e-4])
def test_a_rope_of_bars_starts_at_rest_however_short_one_of_them_is(short):
    arc = arcs(short, 2)
    places = vee(arc)
    result = simulate(build(parse(text(arc, places, 4))))
    assert result["axial_force"][0] == pytest.approx(chain(arc, places[-1][0]), rel=1e-8)


@pytest.mark.parametrize("short", [1e-2, 1e-3, 1e-4])
def test_a_rope_of_cubic_elements_starts_as_the_elastic_catenary_however_short_one_of_them_is(short):
    arc = arcs(short, 5)
    places = vee(arc)
    result = simulate(build(parse(text(arc, places, 7))))
    assert result["axial_force"][0] == pytest.approx(catenary(arc, places[-1][0]), rel=2e-5)


@pytest.mark.parametrize("kind", [7, 4])
def test_a_short_element_takes_no_more_than_twice_the_iterations(kind):
    spent = {}
    for short in (1.0, 1e-4):
        arc = arcs(short, 5)
        model = build(parse(text(arc, vee(arc), kind)))
        spent[short] = find_equilibrium(model.system, new_state(model.system), model.step_limit).iterations
    assert spent[1e-4] <= 2 * spent[1.0]


DRAWN_FAR = """
CableModelMaterial: {Gravity: [0, 0, -9.81]}
CableModel:
%s
GeneralizedAlpha: {type: G-alpha, time_step: 1e-3, time_end: 1e-3, plotpoints: 0, start: %s}
"""


def drawn_far(nodes, kind, given, start="static"):
    """A rope by what of its nodes is held, where they are and their material: far from where they come to rest."""
    key = "CableALEelement" if kind == 7 else "CableALEelementLin"
    items = [
        f"  - Node{kind}Dof: {{id: {i}, xyz: {[x, 0, z]}, BC: {[held] * 3 + [0] * (kind - 4) + [1]}, p: {p}}}"
        for i, (held, x, z, p) in enumerate(nodes)
    ]
    items += [f"  - {key}: {{id: {i}, nodes{kind}: {[i, i + 1]}, {given}}}" for i in range(len(nodes) - 1)]
    return DRAWN_FAR % ("\n".join(items), start)


def test_a_rope_that_is_drawn_as_a_bow_starts_hanging_straight_down_from_its_one_held_end():
    """The first search ends where the rope stands on its head in part, and no way down from there is found."""
    nodes = [
        (1, 0.0, 0.0, 0.0), (0, 2.28546641681, -1.13478098229, 2.732725800161),
        (0, 2.69437722624, -1.30234208655, 3.2216593109257), (0, 5.08789592383, -2.06718888299, 6.0835829209002),
        (0, 7.58130490205, -2.47165214542, 9.0649450599491), (0, 7.64995246887, -2.47712519331, 9.147026763529),
        (0, 8.91899362934, -2.52364754759, 10.664415728501), (0, 12.0900143385, -2.1866006432, 14.455996318375),
        (0, 17.6190799787, -0.0502155352315, 21.067084634808), (0, 17.7076042262, 0.0, 21.172932829893),
    ]  # fmt: skip
    given, arc = (
        "EA: 6840.292008809604, rhoA: 1.2730043996932294, strain: engineering",
        np.array([p for *_, p in nodes]),
    )
    result = simulate(build(parse(drawn_far(nodes, 4, given))))
    below = 1.2730043996932294 * 9.81 * (arc[-1] - 0.5 * (arc[1:] + arc[:-1]))
    assert result["axial_force"][0] == pytest.approx(below, rel=1e-8)


def test_a_rope_that_is_drawn_as_a_vee_starts_where_it_comes_to_rest_by_itself():
    """One element is 22 times as long as others. The reference moves with time, damped: it searches no rest."""
    nodes = [
        (1, 0.0, 0.0, 0.0), (0, 0.778313533901, -0.64920429692, 1.5506456010457),
        (0, 1.5566270678, -1.29840859384, 3.1012912020914), (0, 2.3349406017, -1.94761289076, 4.6519368031371),
        (0, 19.4450772844, -0.64920429692, 38.740715970727), (1, 20.2233908183, 0.0, 40.291361571772),
    ]  # fmt: skip
    given = "EA: 2218.1323720917403, rhoA: 4.146714288882586, strain: engineering"
    at_rest, relaxed = (
        simulate(build(parse(drawn_far(nodes, 7, given, start))))["axial_force"][0] for start in ("static", "relaxed")
    )
    assert at_rest == pytest.approx(relaxed, rel=1e-6)


def test_a_search_without_another_path_is_not_made_twice(monkeypatch):
    """A rope of equal elements has as little room for each: what stands on its head is refused after one search."""
    made = []

    def search(*given):
        made.append(given)
        return find_equilibrium(*given)

    monkeypatch.setattr(stability, "find_equilibrium", search)
    monkeypatch.setattr(stability, "search_from", lambda *given: False)
    nodes = [(int(i == 0), 0.0, 0.1 * i, 0.1 * i) for i in range(4)]
    with pytest.raises(StoppedEarly, match="unstable"):
        simulate(build(parse(drawn_far(nodes, 4, "EA: 1e5, rhoA: 1.5, strain: engineering"))))
    assert len(made) == 1
