"""Static starts of ropes with one element that is far shorter than the others, such as a fitting.

The references are solved here: a chain of straight elastic bars whose weights are halved between their ends, and the
elastic catenary (Irvine, Cable Structures, 1981, section 2.2).
"""

import numpy as np
import pytest
from scipy.optimize import fsolve

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
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
