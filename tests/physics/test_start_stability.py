"""An equilibrium at the start is taken only where it is stable."""

import numpy as np
import pytest
from physics.cables.rope_text import GRAVITY, PINNED, chain, model_of, node
from physics.pipes.hoses import pipe, scene
from references.cables import catenary
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

from crane.model.build import build as build_crane
from crane.scene.scene import CraneScene
from gardenhose.build import build
from gardenhose.static import form, forms, stable_beside
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


def test_a_search_that_ends_next_to_a_rest_does_not_call_it_far():
    """No residual is small enough for a tolerance below zero: the taut rope is at rest all the same."""
    model = model_of(straight(8.01, 8.0), gravity=(0.0, 0.0, 0.0), start="static")
    with pytest.raises(StoppedEarly) as stop:
        find_equilibrium(model.system, new_state(model.system), 1.0, tolerance=-1.0e-7)
    assert "next to a rest" in stop.value.sentence and "too far" not in stop.value.sentence


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


def column(n, share, slope=0.0, axial=1e6):
    """A cantilever of 1 m and EJ = 7.26 N m^2, pressed by a share of Euler's load pi^2 EJ / 4 along its axis, pushed
    sideways by a millionth of that; ``slope`` rad turns it about y."""
    load = share * np.pi**2 * 7.26 / 4.0
    along, aside = np.array([np.sin(slope), 0.0, np.cos(slope)]), np.array([np.cos(slope), 0.0, -np.sin(slope)])
    force = (load * (1e-6 * aside - along)).tolist()
    items = (
        f"  - Node7Dof: {{id: 0, xyz: [0, 0, 0], xyz_d: {along.tolist()}, BC: [1, 1, 1, 1, 1, 1, 1]}}\n"
        f"  - Node7Dof: {{id: 1, xyz: {along.tolist()}, BC: [0, 0, 0, 0, 0, 0, 1]}}\n"
        f"  - CableLine: {{id: 0, nodes7: [0, 1], elements: {n}, length: 1, EA: {axial!r}, EJ: 7.26, rhoA: 1}}\n"
        f"  - PointForce: {{id: 0, nodes7: [1], force: {force}}}\n"
    )
    return model_of(items, gravity=(0.0, 0.0, 0.0), start="static"), along, aside


def tip_of(result):
    return np.asarray(result["position"][0])[np.asarray(result["node"]).tolist().index(1)]


def elastica(share):
    """Where the tip of a column of length one is beyond Euler's load: along its axis and aside (Love, Mathematical
    Theory of Elasticity, section 263)."""
    m = brentq(lambda m: ellipk(m) - 0.5 * np.pi * np.sqrt(share), 1e-9, 1.0 - 1e-9)
    return 2.0 * ellipe(m) / ellipk(m) - 1.0, 2.0 * np.sqrt(m) / ellipk(m)


@pytest.mark.parametrize("n", [20, 80, 160, 250])
@pytest.mark.parametrize("share", [1.5, 3.0])
def test_a_column_beyond_eulers_load_falls_however_fine_its_mesh(n, share):
    """The lowest stiffness of n elements is 1 / n^4 of that of a row: it is no rounding."""
    model, along, aside = column(n, share)
    result = simulate(model)
    assert result.attributes["start"]["stable"]
    tip = tip_of(result)
    # The rope shortens by P / EA, and cubic elements are a little stiff.
    np.testing.assert_allclose([tip @ along, tip @ aside], elastica(share), atol=2e-4)


@pytest.mark.parametrize("n", [20, 250])
def test_a_column_below_eulers_load_stands_however_fine_its_mesh(n):
    """It bends by its side force H as a beam column: H L (tan u - u) / (P u), u = pi / 2 sqrt(P / P_E)."""
    model, _, aside = column(n, 0.9)
    result = simulate(model)
    u = 0.5 * np.pi * np.sqrt(0.9)
    assert result.attributes["start"]["negative_pivots"] == 0
    assert tip_of(result) @ aside == pytest.approx(1e-6 * (np.tan(u) - u) / u, rel=2e-3)


@pytest.mark.parametrize("slope", [0.0, np.pi / 6, np.pi / 4])
@pytest.mark.parametrize("axial", [1e5, 1e8])
def test_an_inclined_column_beyond_eulers_load_falls_however_stiff_its_rope(slope, axial):
    """Along no axis of the coordinates the rows are stiff as EA: bending is 1e-10 of that."""
    model, along, aside = column(20, 1.5, slope, axial)
    tip = tip_of(simulate(model))
    np.testing.assert_allclose([tip @ along, abs(tip @ aside)], elastica(1.5), atol=2e-3)


@pytest.mark.parametrize("coupling", ["linear", "penalty", "augmented", "lagrange"])
def test_a_hose_held_at_both_ends_is_judged_alike_however_its_water_is_coupled(coupling):
    """Clamped at both ends: u = 2 pi (Paidoussis, section 3.4)."""
    hose = pipe(0.25, 20, {"root_support": "clamped", "end": "clamped"}, coupling=coupling)
    speeds = [share * 2.0 * np.pi / np.sqrt(0.25) for share in (0.97, 1.03)]
    assert [one.negative for one in forms(hose, speeds)] == [0, 2]


@pytest.mark.parametrize("coupling", ["linear", "penalty", "augmented", "lagrange"])
def test_a_hose_starts_in_its_stable_shape_however_its_water_is_coupled(coupling):
    """The size of the bend is that of the shape beside the straight one, for its ends are held."""
    speed = {"speed": float(2.2 * np.pi / np.sqrt(0.25)), "mass_per_length": 0.25}
    held = {"root_support": "clamped", "end": "clamped", "elements": 20, "mass_per_length": 0.75}
    held |= {"length": 1.0, "axial_stiffness": 1e5, "bending_stiffness": 1.0, "damping": 0.0}
    hose = scene(held, speed, {"end": 1e-3}, 1e-3, gravity=[0, 0, -1e-3], coupling=coupling, start="static")
    result = simulate(build(hose))
    z = np.asarray(result["position"])[0, :21, 2]
    size = 2.0 / np.pi * np.sqrt(4.0 * np.pi**2 * (1.1**2 - 1.0) / 1e5)
    assert result.attributes["start"]["stable"] and not result.attributes["start"]["far"]
    assert z[10] == pytest.approx(-size, rel=0.03) and z[10] == z.min()


@pytest.mark.parametrize("n", [20, 100, 200])
def test_the_critical_flow_of_a_held_hose_does_not_depend_on_its_mesh(n):
    hose = pipe(0.25, n, {"root_support": "clamped", "end": "clamped"})
    speeds = [share * 2.0 * np.pi / np.sqrt(0.25) for share in (0.995, 1.005)]
    assert [form(hose, speed).negative for speed in speeds] == [0, 2]


def test_a_stable_shape_is_found_beside_a_straight_one_that_is_not():
    """Beyond u = 2 pi it bends as a clamped column does whose ends are held: the stretch (pi a / 2 L)^2 of the bend
    takes the thrust that is too much, M U^2 - 4 pi^2 EJ / L^2 = EA (pi a / 2 L)^2, for one of small size."""
    hose = pipe(0.25, 20, {"root_support": "clamped", "end": "clamped"})
    straight = form(hose, 1.1 * 2.0 * np.pi / np.sqrt(0.25))
    bent = stable_beside(hose, straight)
    assert straight.sag[0] < 1e-9 and straight.negative == 2
    assert bent is not None and bent.negative == 0
    too_much = 4.0 * np.pi**2 * (1.1**2 - 1.0)
    assert bent.sag == (pytest.approx(2.0 / np.pi * np.sqrt(too_much / 1e7), rel=0.03), 10)


@pytest.mark.parametrize("n", [100, 1000])
@pytest.mark.parametrize("axial", [1e3, 1e9])
def test_a_rope_without_tension_is_not_pressed_by_the_rounding_of_its_coordinates(n, axial):
    """Drawn as long as it is, on no axis of the coordinates: every motion sideways is neutral."""
    p = np.linspace(0.0, 100.0, n + 1)
    items = chain(np.outer(p, [0.6, 0.48, -0.64]), p, {0: PINNED, n: PINNED}, linear=True, EA=axial)
    model = model_of(items, gravity=(0.0, 0.0, 0.0))
    state = new_state(model.system)
    found = find_stable_equilibrium(model.system, state, model.step_limit)
    assert found.negative == 0


def counted_both_ways(model, monkeypatch):
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    matrix = stability._stiffness(model.system, state).matrix
    none = stability._nothing(model.system, state, matrix)
    full = stability._by_eigenvalues(model.system, matrix, none, np.zeros(model.system.size)).negative
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
    # The pull of 22.27 N along x and w s across it, 4.375 m from the middle, along the section: 47.50 N.
    assert np.asarray(result["axial_force"][0]).max() == pytest.approx(47.530, abs=0.01)
