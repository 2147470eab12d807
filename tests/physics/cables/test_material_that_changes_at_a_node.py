"""Material that passes a node between unlike elements: what `check` says, and what becomes of its mass."""

import numpy as np
import pytest
from rope_text import FREE, element, node, scene
from scipy.integrate import solve_ivp

import tautline
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse
from tautline.cable.warnings import changed_material

GRAVITY, END = 9.81, 0.4


def falling(below=(3.0, 1.0e4), linear=False, p_held=0, EJ=0.0):
    """A rope of 3 m that falls through an eyelet at node 1: 1 kg/m and EA = 1e4 N above it, ``below`` beneath it."""
    items, held = "", {0: (1, 1, 0, 0, 0, 0, 1), 1: (1, 1, 1, 0, 0, 0, p_held)}
    for i in range(4):
        bc = held.get(i, FREE)
        items += node(i, [0, 0, 1 - i], None if linear else [0, 0, -1], (*bc[:3], bc[6]) if linear else bc, float(i))
    for i, (rhoA, EA) in enumerate(((1.0, 1.0e4), below, below)):
        items += element(i, i, i + 1, EA, EJ if i else 0.0, rhoA, 1.0e-3, linear=linear)
    return scene(items, time_step=1.0e-3, time_end=END, plotpoints=50, rho_inf=0.9)


def told(text):
    return [str(text) for text in Cable().warnings(parse(text)) if "changes its" in str(text)]


@pytest.mark.parametrize("linear", [False, True])
def test_check_tells_of_material_that_changes_its_mass(linear):
    (text,) = told(falling(linear=linear))
    assert "node 1" in text and "elements 0 and 1" in text and "rhoA 1 and 3 kg/m" in text and "held" in text
    assert "EA" not in text


def test_check_tells_of_material_that_changes_its_stiffness():
    (text,) = told(falling((1.0, 3.0e3), EJ=2.0))
    assert "EA 10000 and 3000 N" in text and "EJ 0 and 2 N m^2" in text and "rhoA" not in text


@pytest.mark.parametrize("made", [falling((1.0, 1.0e4)), falling(p_held=1)])
def test_nothing_is_told_of_one_material_or_of_a_node_whose_p_is_held(made):
    assert not told(made)


def test_a_rope_of_two_layers_beside_one_as_heavy_is_one_material():
    whole = falling((1.0, 1.0e4))
    layers = whole.replace(
        "  - CableALEelement: {id: 0, nodes7: [0, 1], EA: 10000.0, EJ: 0.0, rhoA: 1.0",
        "  - CableALEelement: {id: 9, nodes7: [0, 1], EA: 4000.0, EJ: 0.0, rhoA: 0.25, cDamp: 0.001}\n"
        "  - CableALEelement: {id: 0, nodes7: [0, 1], EA: 6000.0, EJ: 0.0, rhoA: 0.75",
    )
    assert layers != whole and not told(layers)


def test_a_rope_of_two_equal_layers_beside_one_of_them_changes_its_mass():
    """No two elements differ, and the curves do: by twice the mass."""
    one = falling((1.0, 1.0e4))
    element = "  - CableALEelement: {id: 0, nodes7: [0, 1]"
    line = next(text for text in one.splitlines() if text.startswith(element))
    (text,) = told(one.replace(line, f"{line}\n{line.replace('id: 0,', 'id: 9,')}"))
    assert "rhoA 2 and 1 kg/m" in text


def driven(ends, functions, ties="", speeds=(0.0, 0.1), begins=1.0):
    """Two linear elements of 1 and 2 kg/m between nodes 0 and 1 and between 2 and 3, or ``ends``.

    Nodes 1 and 2 are held at one point with p = ``begins`` and follow functions of time, by their ids.
    """
    places, p = ([-1, 0, 0], [0, 0, 0], [0, 0, 0], [1, 0, 0]), (begins - 1.0, begins, begins, begins + 1.0)
    items = "".join(
        node(i, places[i], None, (1, 1, 1, 1), p[i], [0, 0, 0, functions[i - 1] if i in (1, 2) else 0])
        for i in sorted({i for pair in ends for i in pair})
    )
    for i, pair in enumerate(ends):
        items += element(i, *pair, 1.0e4, rhoA=1.0 + i, linear=True)
    for i in sorted(set(functions)):
        rates = f"timeList: [0, 1], velocityList: {list(speeds)}"
        items += f"  - Function_VelocityDefined: {{id: {i}, pos0: {begins}, {rates}}}\n"
    return scene(items + ties)


def test_ropes_that_only_meet_at_a_point_are_two():
    assert not told(driven([(0, 1), (2, 3)], (1, 2)))
    assert told(driven([(0, 1), (2, 3)], (1, 1)))  # what leaves the one enters the other
    assert told(driven([(0, 1), (2, 3)], (1, 2), "  - LagMultipl4: {id: 1, nodes4: [1, 2], constr: 0}\n"))


def test_nothing_passes_between_elements_that_both_begin_or_both_end_at_a_node():
    apart = driven([(0, 1), (1, 3)], (1, 1))
    assert told(apart)
    places, functions = ([0, 0, 0], [1, 0, 0], [0, 0, -1]), ([0, 0, 0, 1], [0, 0, 0, 0], [0, 0, 0, 0])
    both_begin = "".join(node(i, places[i], None, (1, 1, 1, 1), min(i, 1), functions[i]) for i in range(3))
    both_begin += element(0, 0, 1, 1.0e4, linear=True) + element(1, 0, 2, 1.0e4, rhoA=2.0, linear=True)
    rates = "timeList: [0, 1], velocityList: [0, -0.1]"
    assert not told(scene(both_begin + f"  - Function_VelocityDefined: {{id: 1, pos0: 0.0, {rates}}}\n"))


def test_p_that_follows_what_stands_still_is_held():
    assert told(driven([(0, 1), (1, 3)], (1, 1)))
    assert not told(driven([(0, 1), (1, 3)], (1, 1), speeds=(0.0, 0.0)))


def test_ropes_of_one_material_are_asked_nothing_more(monkeypatch):
    asked = []
    monkeypatch.setattr(changed_material, "_moving", lambda scene: asked.append(scene) or set())
    assert not told(falling((1.0, 1.0e4))) and not asked
    assert not told(falling()) and asked


@pytest.mark.parametrize("below", [3.0, 0.3])
def test_mass_comes_with_the_rope_in_cubic_elements_and_without_energy_in_linear_ones(below):
    """Cubic: every particle falls freely. Linear: M s.. + M' s.^2 / 2 = M g, which keeps M s.^2 / 2 less the weight's
    work; s is how far the rope has gone, M its mass, kg."""

    def rates(_, y):
        return [y[1], GRAVITY - 0.5 * (below - 1.0) * y[1] ** 2 / (1.0 - y[0] + below * (2.0 + y[0]))]

    ends = {
        False: 0.5 * GRAVITY * END**2,
        True: solve_ivp(rates, (0.0, END), [0.0, 0.0], rtol=1e-9, atol=1e-12).y[0, -1],
    }
    for linear, fallen in ends.items():
        position = np.asarray(tautline.simulate(falling((below, 1.0e4), linear))["position"])
        assert -2.0 - position[-1, -1, 2] == pytest.approx(fallen, abs=1.0e-3)
