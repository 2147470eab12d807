"""Hoses and ropes whose axial stiffness is far above what acts on them: bent as an elastica, or refused in words.

The reference is the heavy elastica under a force that follows its tip (the water's thrust), by scipy's `solve_bvp`.
"""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_bvp

import tautline
from gardenhose.static import form
from gardenhose.warnings import warnings
from tautline.application.installed import Installed
from tautline.integrators.status import Status, StoppedEarly

DATA = Path(__file__).parents[3] / "data" / "hose.yaml"
LENGTH, BENDING, HOSE, WATER, GRAVITY = 0.5, 0.00108, 0.0031316, 0.0007854, 9.81
CABLE = """
CableModelMaterial: {{Gravity: [0, 0, -9.81]}}
CableModel:
  - Node7Dof: {{id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: [1, 1, 1, 0, 1, 1, 1]}}
  - Node7Dof: {{id: 1, xyz: [0.5, 0, 0], xyz_d: [1, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1]}}
  - CableLine: {{id: 0, nodes7: [0, 1], elements: 10, EA: {axial}, EJ: 0.00108, rhoA: 0.003917}}
GeneralizedAlpha: {{type: G-alpha, rho_inf: 0.8, time_step: 0.001, time_end: 0.001, start: {start}}}
"""


def elastica(speed):
    """Tip (x, z), m, of a cantilever that does not stretch: EJ a'' = -w (L - s) cos a - P sin(a - a(L)), a down."""
    weight, thrust = (HOSE + WATER) * GRAVITY, WATER * speed**2

    def slopes(s, y, end):
        turn = -(weight * (LENGTH - s) * np.cos(y[0]) + thrust * np.sin(y[0] - end[0])) / BENDING
        return np.array([y[1], turn, np.cos(y[0]), -np.sin(y[0])])

    def ends(first, last, end):
        return np.array([first[0], first[2], first[3], last[1], last[0] - end[0]])

    s = np.linspace(0.0, LENGTH, 41)
    guess = np.array([0.3 * s / LENGTH, 0.0 * s, s, -0.1 * s])
    found = solve_bvp(slopes, ends, s, guess, np.array([0.3]), tol=1e-8, max_nodes=100_000)
    assert found.success
    return found.sol(LENGTH)[2:]


def hose(axial, elements=10, **changes):
    return tautline.read(DATA).replace({"hose.axial_stiffness": axial, "hose.elements": elements, **changes})


def refusal_of(axial, elements, speed):
    with pytest.raises(StoppedEarly) as stop:
        form(hose(axial, elements), speed)
    assert stop.value.status is Status.NO_EQUILIBRIUM
    return stop.value.detail


@pytest.mark.parametrize("speed", [0.0, 12.0])
@pytest.mark.parametrize(("elements", "close"), [(10, 1e-5), (40, 1e-6)])  # measured: 5e-6, 2e-7
def test_a_hose_of_any_axial_stiffness_bends_as_the_elastica_or_is_refused(elements, close, speed):
    tip, found = elastica(speed), 0
    for axial in (1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e15):
        try:
            x, _, z = form(hose(axial, elements), speed).tip
        except StoppedEarly as stop:
            assert "the axial stiffness EA" in stop.detail
            continue
        found += 1
        assert np.hypot(x - tip[0], z - tip[1]) < close, axial
    assert found >= 2


@pytest.mark.parametrize("speed", [0.0, 12.0])
def test_the_stiffness_that_a_refusal_advises_gives_the_shape_to_six_digits(speed):
    advised = float(re.search(r"EA = (\S+) N gives", refusal_of(1e12, 40, speed))[1])
    x, _, z = form(hose(advised, 40), speed).tip
    assert np.hypot(x - elastica(speed)[0], z - elastica(speed)[1]) < 1e-6


def test_a_refusal_for_axial_stiffness_does_not_ask_for_more_stiffness():
    for axial in (1e9, 1e10, 1e11):
        assert "give it stiffness" not in refusal_of(axial, 10, 0.0)


def test_a_light_tube_is_refused_by_the_same_ratio_as_a_heavy_one():
    light = {
        "hose.mass_per_length": 1e-3 * HOSE,
        "water.mass_per_length": 1e-3 * WATER,
        "hose.bending_stiffness": 1e-3 * BENDING,
    }
    x, _, z = form(hose(1e3, **light), 0.0).tip
    assert np.hypot(x - elastica(0.0)[0], z - elastica(0.0)[1]) < 1e-5
    with pytest.raises(StoppedEarly, match="the axial stiffness EA"):
        form(hose(1e9, **light), 0.0)


def test_what_lies_straight_is_at_rest_with_any_axial_stiffness():
    for changes in ({"hose.direction": [0, 0, -1]}, {"gravity": [0, 0, 0]}):
        tip = form(hose(1e12, **changes), 2.0).tip
        assert np.linalg.norm(tip) == pytest.approx(LENGTH, rel=1e-9)


def test_a_hose_between_two_pins_that_hardly_stretches_sags_by_the_third_root_of_its_softness():
    # A straight string: sag = (3 w L^4 / (64 EA))^(1/3), where its bending carries nothing.
    sag, _ = form(hose(1e10, **{"hose.end": "pinned", "hose.root_support": "pinned"}), 0.0).sag
    weight = (HOSE + WATER) * GRAVITY
    assert sag == pytest.approx((3.0 * weight * LENGTH**4 / 64e10) ** (1 / 3), rel=0.05)
    assert not [one for one in warnings(hose(1e10, **{"hose.end": "pinned"})) if "axial stiffness EA" in one.text]


def test_what_is_told_of_an_axial_stiffness_that_is_too_large_says_hose_to_whoever_has_a_hose():
    scene = hose(1e12)
    told = [one.text for one in warnings(scene) if "axial stiffness EA" in one.text]
    told.append(refusal_of(1e12, 10, 0.0))
    assert len(told) == 2
    assert all("do not stretch the hose" in text and "rope" not in text for text in told)


def test_a_rope_so_stiff_along_itself_does_not_begin_as_drawn_without_a_word(tmp_path):
    path = tmp_path / "stiff_rope.yaml"
    for start in ("static", "relaxed"):
        path.write_text(CABLE.format(axial="1.0e12", start=start))
        with pytest.raises(StoppedEarly, match="the axial stiffness EA"):
            tautline.simulate(path)
    path.write_text(CABLE.format(axial="1.0e6", start="static"))
    x, _, z = tautline.simulate(path)["position"][0][-1]
    assert np.hypot(x - elastica(0.0)[0], z - elastica(0.0)[1]) < 1e-5


def test_a_step_without_solution_names_an_axial_stiffness_that_is_too_large():
    changes = {"start": "straight", "water.speed": 0.0, "solver.end": 0.1}
    with pytest.raises(StoppedEarly, match="the axial stiffness EA") as stop:
        tautline.simulate(hose(1e12, **changes))
    assert stop.value.status is Status.NOT_CONVERGED


def test_check_warns_of_an_axial_stiffness_that_hides_what_acts(tmp_path):
    places = {1e12: "hose.axial_stiffness", 1e6: None}
    for axial, place in places.items():
        told = [one for one in warnings(hose(axial)) if "axial stiffness EA" in one.text]
        assert [one.where for one in told] == ([place] if place else [])
    path = tmp_path / "stiff_rope.yaml"
    path.write_text(CABLE.format(axial="1.0e12", start="static"))
    scene = tautline.read(path)
    assert "CableLine.EA" in str([str(one) for one in Installed().of(scene).warnings(scene)])
