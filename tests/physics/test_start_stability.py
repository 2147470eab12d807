"""An equilibrium at the start is taken only where it is stable."""

import numpy as np
import pytest
from physics.cables.rope_text import GRAVITY, PINNED, chain, model_of, node
from physics.pipes.hoses import pipe
from references.cables import catenary
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from crane.model.build import build as build_crane
from crane.scene.scene import CraneScene
from gardenhose.static import form
from tautline.integrators.state import new_state
from tautline.integrators.statics import stability
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.statics.stability import count_negative, find_stable_equilibrium
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.model import validate
from tautline.scene.reading.document import Document
from tautline.simulation import simulate

LENGTH, SPAN, MASS, EA = 120.0, 80.0, 3.7, 2.0e7


def straight(span, length, n=4):
    """Linear elements of EA = 1e6 N without weight between two pins: taut or pressed."""
    xyz = np.outer(np.linspace(0.0, span, n + 1), [1.0, 0.0, 0.0])
    return chain(xyz, np.linspace(0.0, length, n + 1), {0: PINNED, n: PINNED}, linear=True, EA=1e6)


@pytest.mark.parametrize("span, negative", [(8.1, 0), (7.9, 6)], ids=["taut", "pressed"])
def test_a_pressed_rope_has_a_negative_pivot_for_each_sideways_motion_of_its_inner_nodes(span, negative):
    model = model_of(straight(span, 8.0), gravity=(0.0, 0.0, 0.0))
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    assert count_negative(model.system, state).negative == negative


def test_a_taut_rope_starts_and_says_that_nothing_is_unstable():
    result = simulate(model_of(straight(8.1, 8.0), gravity=(0.0, 0.0, 0.0), start="static"))
    assert result.attributes["start"]["stable"] and result.attributes["start"]["negative_pivots"] == 0
    assert result.attributes["start"]["moved"] < 0.1


X = np.linspace(0.0, 1.0, 21)
DRAWN = {
    "straight, a strut of 6.7 MN": 0.0 * X,
    "an arch": 140.0 * X * (1.0 - X),
    "seven half waves": 5.0 * np.sin(7.0 * np.pi * X),
    "folded upwards": 96.0 * np.minimum(X, 1.0 - X),
}


@pytest.mark.parametrize("linear", [True, False], ids=["linear", "cubic"])
@pytest.mark.parametrize("drawn", DRAWN)
def test_a_rope_drawn_far_from_its_shape_hangs_as_a_catenary(drawn, linear):
    """120 m over a level span of 80 m: 0.9 kN of horizontal force, by the closed form of the elastic catenary."""
    xyz = np.stack([SPAN * X, 0.0 * X, DRAWN[drawn]], 1)
    material = {"EA": EA, "rhoA": MASS, "strain": "engineering", "linear": linear}
    items = chain(xyz, np.linspace(0.0, LENGTH, len(X)), {0: PINNED, len(X) - 1: PINNED}, **material)
    result = simulate(model_of(items, start="static"))
    exact = catenary(SPAN, 0.0, LENGTH, EA, MASS * GRAVITY, "engineering")
    horizontal = abs(exact.end_forces[0, 0])
    force = np.asarray(result["axial_force"][0])
    # at the lowest point the rope bears the horizontal force alone
    assert force.min() == pytest.approx(horizontal, rel=0.02) and horizontal == pytest.approx(895.0, abs=1.0)
    assert force.max() < np.hypot(*exact.end_forces[0]) * 1.001
    assert result.attributes["start"]["stable"]
    assert any("far from the initial geometry" in warning for warning in result.warnings)


@pytest.mark.parametrize(("share", "negative"), [(0.98, 0), (1.02, 2)])
def test_a_column_is_stable_up_to_eulers_load_and_past_it_bends_as_the_elastica_does(share, negative):
    """Clamped below, free above, P = pi^2 EI / (4 L^2) in both planes; the load stands on a slender rod."""
    height, bending = 2.0, 50.0
    load = share * np.pi**2 * bending / (4.0 * height**2)
    z = np.linspace(0.0, height, 9)
    xyz, slopes = np.outer(z, [0.0, 0.0, 1.0]), np.outer(np.ones(9), [0.0, 0.0, 1.0])
    held = {i: (0, 0, 0, 0, 0, 0, 1) for i in range(9)} | {0: (1, 1, 1, 1, 1, 1, 1)}
    items = chain(xyz, z, held, slopes, EA=1e7, EJ=bending, rhoA=1e-6)
    items += f"  - PointForce: {{id: 0, nodes7: [8], force: [0, 0, {-load!r}], timeInterval: [0, 100]}}\n"
    model = model_of(items, gravity=(0.0, 0.0, 0.0))
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    assert count_negative(model.system, state).negative == negative
    if negative:
        found = find_stable_equilibrium(model.system, state, model.step_limit)
        assert found.negative == 0
        # The elastica with K(m) = pi/2 sqrt(P / P_E): its tip is 2 sqrt(m) L / K off the axis, at L (2 E / K - 1).
        m = brentq(lambda m: ellipk(m) - 0.5 * np.pi * np.sqrt(share), 0.0, 0.5)
        x, y, top = state.full_q[7 * 8 : 7 * 8 + 3]
        assert np.hypot(x, y) == pytest.approx(2.0 * np.sqrt(m) * height / ellipk(m), rel=0.01)
        assert top == pytest.approx(height * (2.0 * ellipe(m) / ellipk(m) - 1.0), rel=0.001)


def test_an_equilibrium_that_stays_unstable_is_refused_by_name(monkeypatch):
    monkeypatch.setattr("tautline.integrators.statics.stability.LEAVING", ())
    monkeypatch.setattr("tautline.integrators.statics.stability.SHIFTS", ())
    with pytest.raises(StoppedEarly) as stop:
        simulate(model_of(straight(7.9, 8.0), gravity=(0.0, 0.0, 0.0), start="static"))
    assert stop.value.status is Status.NO_EQUILIBRIUM
    assert "6 negative pivots" in stop.value.sentence and "Euler" in stop.value.sentence


def test_where_nothing_balances_the_amount_the_cause_and_the_cure_are_told():
    """A rope that falls freely, and one that is held too."""
    xyz = np.outer(np.linspace(0.0, 2.0, 3), [1.0, 0.0, 0.0])
    with pytest.raises(StoppedEarly) as stop:
        simulate(model_of(chain(xyz, np.linspace(0.0, 2.0, 3), {}, EJ=1.0, EA=1e3), start="static"))
    assert stop.value.status == Status.NO_EQUILIBRIUM
    for words in ("% of the scene's largest force is still out of balance", "nothing holds a part of the scene",
                  "hold it", "take start: relaxed"):  # fmt: skip
        assert words in stop.value.sentence


CAR = """
rope: {mass_per_length: 1.0, axial_stiffness: 1.0e7, bending_stiffness: 0, damping: 1.0e-4, diameter: 13 mm}
bodies:
  - {name: car, mass: 800, position: [0, 0, 2], guide: [x, y]}
  - {name: counterweight, mass: 800, position: [2, 0, 20], guide: [x, y]}
path:
  - end: {name: car end, body: car}
  - sheave: {name: traction, center: [1, 0, 30], radius: 1.0, axis: [0, 1, 0], wrap: over, inertia: 20, law: no_slip}
  - end: {name: weight end, body: counterweight}
mesh: {elements_per_span: 4}
gravity: [0, 0, -9.81]
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 2 s}
output: {interval: 50 ms}
"""


def test_a_car_that_its_counterweight_balances_on_a_heavy_rope_is_refused_as_unstable():
    """Equal masses over one sheave: the longer side pulls, whichever it is, so that the only balance is unstable."""
    with pytest.raises(StoppedEarly, match=r"unstable: the tangent has one negative pivot.*take start: as drawn"):
        simulate(build_crane(validate(CraneScene, Document.parse(CAR, "car.yaml"))))


@pytest.mark.parametrize(("share", "negative"), [(0.97, 0), (1.03, 2)])
def test_a_hose_held_at_both_ends_is_at_rest_but_unstable_beyond_its_critical_flow(share, negative):
    """Pinned at both ends, u = pi (Paidoussis, Fluid-Structure Interactions vol. 1, section 3.4): the straight shape
    is an equilibrium at any speed, and beyond it a motion in each plane leaves it."""
    hose = pipe(0.25, 12, {"root_support": "pinned", "end": "pinned"})
    assert form(hose, share * np.pi / np.sqrt(0.25)).negative == negative


def test_whether_a_shape_with_a_free_tip_is_stable_is_not_told_by_pivots():
    """What leaves a free tip pushes along the tip, wherever it points: its forces have no potential."""
    assert form(pipe(0.25, 6), 2.0).negative == -1


def counted_both_ways(model, monkeypatch):
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    matrix = stability._stiffness(model.system, state).matrix
    full = stability._by_eigenvalues(model.system, matrix).negative
    monkeypatch.setattr(stability, "SMALL", 0)
    return full, count_negative(model.system, state).negative


@pytest.mark.parametrize("span", [8.1, 7.9], ids=["taut", "pressed"])
@pytest.mark.parametrize("tied", ["held", "by multipliers", "by a coupling"])
def test_pivots_of_the_factors_count_what_eigenvalues_count(span, tied, monkeypatch):
    """With and without multipliers: the way of large scenes against that of small ones."""
    items = straight(span, 8.0)
    if tied != "held":
        more = node(9, [span, 0.0, 0.0], held=(1, 1, 1, 1), p=8.0)
        last = f"id: 4, xyz: [{span!r}, 0.0, 0.0], BC: "
        free = items.replace(f"{last}[1, 1, 1, 1]", f"{last}[0, 0, 0, 1]")
        assert free != items
        tie = "  - LagMultipl4: {id: 1, nodes4: [9, 4], constr: 0}\n"
        couple = "".join(
            f"  - LinearCoupl: {{id: {k}, sNode: 4, sDof: {k}, f0: 0, masters: [{{mNode: 9, mDof: {k}, factor: 1}}]}}\n"
            for k in (1, 2, 3)
        )
        items = free + more + (tie if tied == "by multipliers" else couple)
    found = counted_both_ways(model_of(items, gravity=(0.0, 0.0, 0.0)), monkeypatch)
    assert found == ((0, 0) if span > 8.0 else (6, 6))


@pytest.mark.parametrize("size", [1e-4, 1e-2, 1.0, 100.0])
def test_a_stiff_rope_of_any_size_is_found_sagging_from_a_straight_strut(size):
    """10 m over 8 m, scaled: with EJ as the square of the length and mass as its inverse, shape and forces are alike. A
    chain sags by a (cosh(4/a) - 1) = 2.655 m, with 2 a sinh(4/a) = 10 m; the stiffness changes that by 0.2 %."""
    x = np.linspace(0.0, 8.0 * size, 9)
    material = {"EA": 1e5, "EJ": 100.0 * size**2, "rhoA": 1.0 / size}
    items = chain(np.stack([x, 0.0 * x, 0.0 * x], 1), 1.25 * x, {0: PINNED, 8: PINNED}, **material)
    result = simulate(model_of(items, start="static"))
    assert result.attributes["start"]["stable"]
    sag = -result["position"][0][:, 2].min() / size
    assert sag == pytest.approx(2.66096, abs=1e-4) and sag == pytest.approx(2.655, rel=0.005)
    assert np.asarray(result["axial_force"][0]).max() == pytest.approx(47.915, abs=0.01)
