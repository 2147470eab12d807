"""Material that passes a node between unlike elements: what `check` says, and what becomes of its mass."""

import numpy as np
import pytest
from rope_text import FREE, element, node, scene
from scipy.integrate import solve_ivp

import tautline
from tautline.cable.application import Cable
from tautline.cable.input.scene import parse

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
