"""Cables at rest and their small vibrations against closed forms (tests/references/cables.py), without a scene file.

Figures in comments are what was measured; tolerances leave a factor of about two to four above them.
"""

import numpy as np
import pytest
from physics.cables.rope_text import GRAVITY, PINNED, Still, chain, element, model_of, node, straight
from references.cables import (
    catenary,
    elastica,
    extensible_cantilever,
    force_of,
    hanging_chain_frequencies,
    hanging_chain_mode,
    hanging_rope,
    hermite_bar,
    stretch_of,
    string_frequencies,
)
from scipy.optimize import brentq

from tautline.integrators.vibration.modes import modes
from tautline.simulation import simulate

EA = 1.0e5
STRAINS = ("green", "engineering")
SPANS = {  # span, rise, length
    "level, slack": (100.0, 0.0, 110.0),
    "level, taut": (100.0, 0.0, 99.8),
    "inclined, slack": (80.0, 60.0, 120.0),
    "inclined, taut": (80.0, 60.0, 99.9),
    "downhill": (80.0, -60.0, 101.0),
}


def orders(errors):
    """Observed orders of convergence of errors at doubled numbers of elements."""
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


# the elastic catenary
def hung(span, rise, length, n, strain, linear=False, **solver):
    """A cable between supports, begun as a parabola of about its length, and its material coordinates."""
    slack = length - np.hypot(span, rise)
    sag = np.sqrt(3 / 8 * span * slack) if slack > 0 else 0.0
    x = np.linspace(0, 1, n + 1)
    xyz = np.stack([span * x, 0 * x, rise * x - 4 * sag * x * (1 - x)], 1)
    p = np.linspace(0, length, n + 1)
    items = chain(xyz, p, {0: PINNED, n: PINNED}, EA=EA, strain=strain, linear=linear)
    return model_of(items, **solver), p


def misses(case, n, strain, linear=False):
    """Error of the supports' forces over the largest, and of the nodes' positions over the length."""
    span, rise, length = SPANS[case]
    model, p = hung(span, rise, length, n, strain, linear)
    still, exact = Still(model, linear), catenary(span, rise, length, EA, GRAVITY, strain)
    force = np.abs(still.forces[[0, n]][:, [0, 2]] - exact.end_forces).max() / np.abs(exact.end_forces).max()
    assert np.abs(still.position[:, 1]).max() < 1e-9, "it hangs in its plane"
    return force, np.abs(still.position[:, [0, 2]].T - exact.shape(p)).max() / length


@pytest.mark.parametrize("strain", STRAINS)
@pytest.mark.parametrize("case", SPANS)
def test_sixteen_cubic_elements_hang_as_the_elastic_catenary(case, strain):
    # measured: worst is 'inclined, slack', 1.3e-6 and 4.4e-6; taut ones 2e-10 to 4e-9 and 1.3e-8 to 2.5e-8
    force, shape = misses(case, 16, strain)
    slack = "slack" in case
    assert force < (4e-6 if slack else 5e-8)
    assert shape < (1.2e-5 if slack else 2e-7)


@pytest.mark.parametrize("case", ["level, slack", "inclined, taut"])
def test_cubic_elements_converge_to_the_catenary_with_order_four_at_least(case):
    # measured from 16 to 32 to 64 elements: shape 3.51, 3.73 (slack; coming up to 4) and 3.87, 3.96, forces 5.7, 5.9
    force, shape = zip(*(misses(case, n, "green") for n in (16, 32, 64)), strict=True)
    assert orders(shape).min() > 3.4
    assert orders(shape)[-1] == pytest.approx(4.0, abs=0.4)
    assert orders(force[:2]).min() > 4.5


@pytest.mark.parametrize("strain", STRAINS)
@pytest.mark.parametrize("case", SPANS)
def test_linear_elements_converge_to_the_catenary_with_order_two(case, strain):
    # measured at 8, 16, 32, 64 elements: 1.997 to 2.035
    force, shape = zip(*(misses(case, n, strain, linear=True) for n in (8, 16, 32)), strict=True)
    np.testing.assert_allclose(orders(force), 2.0, atol=0.05)
    np.testing.assert_allclose(orders(shape), 2.0, atol=0.05)
    assert force[-1] < 8e-4
    assert shape[-1] < 4e-4


def test_axial_force_that_is_stored_is_the_tension_of_the_catenary_in_the_middle_of_elements():
    span, rise, length = SPANS["inclined, slack"]
    model, p = hung(span, rise, length, 32, "green", start="static", time_step=0.01, time_end=0.02)
    result = simulate(model)
    exact = catenary(span, rise, length, EA, GRAVITY, "green")
    force = np.asarray(result["axial_force"])
    tension = exact.tension((p[1:] + p[:-1]) / 2)
    assert np.abs(force[0] / tension - 1).max() < 1.5e-3  # measured 8.8e-4; 4.9e-3 with 16 elements, 1.2e-4 with 64
    assert np.abs(force[-1] - force[0]).max() < 1e-6 * tension.max(), "what begins at rest stays"
    assert np.abs(np.asarray(result["velocity"])[-1]).max() < 1e-7


# a rope that hangs straight down
def hanging(n, strain, length=100.0, weight=30.0):
    p = np.linspace(0, length, n + 1)
    mass = f"  - PointMass: {{id: 0, nodes7: [{n}], mass: {weight / GRAVITY!r}}}\n"
    still = Still(model_of(chain(np.outer(p, [0.0, 0.0, -1.0]), p, {0: PINNED}, EA=1e4, strain=strain) + mass))
    depth, force = hanging_rope(p, length, 1e4, GRAVITY, weight, strain)
    return still, np.abs(-still.position[:, 2] - depth).max() / length, force


@pytest.mark.parametrize("n", [1, 2, 8])
def test_hanging_rope_of_engineering_strain_is_exact_with_any_number_of_elements(n):
    # the depth is a parabola of p, which a cubic element holds: measured 2e-15 to 1.5e-11 (tolerance of the search)
    still, miss, force = hanging(n, "engineering")
    assert miss < 1e-9
    np.testing.assert_allclose(still.forces[0, :3], [0, 0, force[0]], rtol=1e-9, atol=1e-9 * force[0])
    slopes = still.unknowns[:, 5]
    np.testing.assert_allclose(slopes, -1 - force / 1e4, rtol=1e-9)


def test_hanging_rope_of_green_strain_elongates_as_the_integral_of_its_stretch():
    # measured at 2, 4, 8 elements: 5.7e-7, 5.3e-8, 4.0e-9
    miss = [hanging(n, "green")[1] for n in (2, 4, 8)]
    assert miss[-1] < 1e-8
    assert orders(miss).min() > 3.2


# material coordinates that are free
OPEN = (1, 1, 1, 0, 0, 0, 0)  # stands still and lets the rope through


@pytest.mark.parametrize(("strain", "n", "limit"), [("engineering", 1, 1e-9), ("green", 4, 1e-9)])
def test_rope_through_an_open_end_slides_until_nothing_pulls_there(strain, n, limit):
    # N = 0 at an open end without friction, so the rope between the support and the opening is that which its own
    # weight stretches over the distance: an integral of the stretch. Measured 2e-15 and 1.2e-10 m
    distance, EA = 10.5, 1e3
    exact = brentq(lambda s: hanging_rope(np.array([s]), s, EA, GRAVITY, 0.0, strain)[0][0] - distance, 5.0, 11.0)
    p = np.linspace(0, 10.3, n + 1)
    xyz = np.outer(p / 10.3 * distance, [0.0, 0.0, -1.0])
    still = Still(model_of(chain(xyz, p, {0: PINNED, n: OPEN}, EA=EA, strain=strain)))
    assert still.unknowns[-1, 6] == pytest.approx(exact, abs=limit)
    np.testing.assert_allclose(still.forces[0, :3], [0, 0, GRAVITY * exact], rtol=0, atol=2e-8)
    np.testing.assert_allclose(still.forces[n, :3], 0, atol=1e-7)


@pytest.mark.parametrize("strain", STRAINS)
def test_ropes_on_a_differential_drum_pull_with_stretch_times_force_at_their_open_ends(strain):
    # two weightless ropes of unlike stiffness between fixed points, drawn through their first ends by one drum of two
    # radii: p_2 = f0 - k p_1. Virtual work of the material that leaves (dr/ds dp against N): lambda N is in balance,
    # and not lambda N - Psi as at an end that belongs to the rope (docs/cables.md), which would be 6e-5 m away
    height, ratio, f0 = 1.0, 2.0, 0.13
    stiff = (1e3, 400.0)

    def stretches(p):
        return height / (1 - p), height / (1 - (f0 - ratio * p))

    def pull(stretch, EA):
        return stretch * force_of(stretch, EA, strain)

    exact = brentq(lambda p: pull(stretches(p)[0], stiff[0]) - ratio * pull(stretches(p)[1], stiff[1]), 0.0, 0.06)
    items = ""
    for i, first in enumerate((0.03, f0 - ratio * 0.03)):
        xyz = straight([i, 0, 0], [i, 0, -height], 1)
        items += node(2 * i, xyz[0], [0, 0, -1], OPEN, first) + node(2 * i + 1, xyz[1], [0, 0, -1], PINNED, 1.0)
    items += "".join(element(i, 2 * i, 2 * i + 1, EA=stiff[i], strain=strain) for i in range(2))
    masters = f"masters: [{{mNode: 0, mDof: 7, factor: {-ratio}}}]"
    items += f"  - LinearCoupl: {{id: 0, sNode: 2, sDof: 7, f0: {f0}, {masters}}}\n"
    still = Still(model_of(items, gravity=(0, 0, 0)), nodes=4)
    np.testing.assert_allclose(still.unknowns[[0, 2], 6], [exact, f0 - ratio * exact], rtol=0, atol=1e-9)
    forces = [force_of(stretch, EA, strain) for stretch, EA in zip(stretches(exact), stiff, strict=True)]
    np.testing.assert_allclose(still.forces[[0, 2], 2], forces, rtol=1e-7)


@pytest.mark.parametrize("strain", STRAINS)
@pytest.mark.parametrize("tie", ["coupling", "multiplier"])
def test_rope_over_a_smooth_edge_has_one_tension_on_both_sides(tie, strain):
    # level from a support to an edge, then down with a weight: p at the edge and the force are those of one tension.
    # Measured: 2e-16 m for engineering strain, 2e-8 m (coupling) and 8e-14 m (multiplier) for Green strain
    EA, length, level, weight, load = 1e3, 4.0, 1.5, GRAVITY, 20.0
    edge = brentq(lambda p: p * stretch_of(weight * (length - p) + load, EA, strain) - level, 1.0, 1.6, xtol=1e-14)
    tension = weight * (length - edge) + load
    items = node(0, [-level, 0, 0], [1, 0, 0], PINNED, 0.0)
    items += node(1, [0, 0, 0], [1, 0, 0], OPEN, level) + node(2, [0, 0, 0], [0, 0, -1], OPEN, level)
    items += "".join(node(2 + k, [0, 0, -1.25 * k], [0, 0, -1], p=level + 1.25 * k) for k in (1, 2))
    items += element(0, 0, 1, EA=EA, strain=strain)
    items += "".join(element(k, k + 1, k + 2, EA=EA, strain=strain, extra=f", load: [0, 0, {-weight}]") for k in (1, 2))
    items += f"  - PointForce: {{id: 0, nodes7: [4], force: [0, 0, {-load}]}}\n"
    if tie == "coupling":
        items += "  - LinearCoupl: {id: 0, sNode: 2, sDof: 7, f0: 0, masters: [{mNode: 1, mDof: 7, factor: 1}]}\n"
    else:
        items += "  - LagMultipl7: {id: 0, nodes7: [1, 2], constr: 1}\n"
    still = Still(model_of(items, gravity=(0, 0, 0)), nodes=5)
    np.testing.assert_allclose(still.unknowns[[1, 2], 6], edge, rtol=0, atol=5e-8)
    np.testing.assert_allclose(still.forces[0, :3], [-tension, 0, 0], rtol=0, atol=1e-4)
    np.testing.assert_allclose(still.forces[1, :3] + still.forces[2, :3], [tension, 0, tension], rtol=0, atol=1e-4)


# the cantilever
SOFT = (1, 1, 1, 0, 1, 1, 1)  # the direction of r' is held, its length is free
HARD = (1, 1, 1, 1, 1, 1, 1)


def cantilever(n, load, EA, clamp, strain="green"):
    """Position of the tip, x and z, of a bar of unit length and bending stiffness along x with a load along z."""
    p = np.linspace(0, 1, n + 1)
    items = chain(straight([0, 0, 0], [1, 0, 0], n), p, {0: clamp}, EA=EA, EJ=1.0, strain=strain)
    items += f"  - PointForce: {{id: 0, nodes7: [{n}], force: [0, 0, {load!r}]}}\n"
    return Still(model_of(items, gravity=(0, 0, 0)))


def tip_error(still, exact):
    return np.hypot(still.position[-1, 0] - exact.x, still.position[-1, 2] - exact.y)


@pytest.mark.parametrize(("n", "limit"), [(4, 3.0e-3), (8, 1.5 * 1.8e-4), (16, 2.5e-5)])
def test_thin_cantilever_does_not_lock(n, limit):
    # EA L^2/EI = 1e7 and P L^2/EI = 10; measured 2.34e-3, 1.83e-4, 1.10e-5 (docs/cables.md)
    assert tip_error(cantilever(n, 10.0, 1e7, SOFT), elastica(10.0, 1.0, 1.0)) < limit


def test_cantilever_of_any_thinness_errs_alike():
    # locking would grow with EA: 5 Gauss points err by 1.3e-2 at 1e5 and 5.4e-2 at 1e7 (docs/cables.md)
    exact = elastica(10.0, 1.0, 1.0)
    errors = [tip_error(cantilever(8, 10.0, EA, SOFT), exact) for EA in (1e7, 1e8, 1e9)]
    assert max(errors) / min(errors) < 1.05


@pytest.mark.parametrize(
    ("load", "EA", "strain"), [(10.0, 1e3, "green"), (1.0, 1e2, "green"), (1.0, 1e2, "engineering")]
)
def test_cantilever_converges_with_order_four_where_the_length_of_the_clamped_slope_is_free(load, EA, strain):
    # measured at 8, 16, 32 elements, load 10: 2.0e-4, 1.3e-5, 8.5e-7; load 1: 1.9e-6, 1.2e-7, 7.5e-9
    exact = extensible_cantilever(load, 1.0, EA, 1.0, strain, curvature="geometric")
    stills = [cantilever(n, load, EA, SOFT, strain) for n in (8, 16, 32)]
    errors = [tip_error(still, exact) for still in stills]
    assert orders(errors).min() > 3.8
    assert errors[-1] < (2e-6 if load > 1 else 2e-8)
    slope = np.arctan2(*stills[-1].unknowns[-1, [5, 3]])
    assert slope == pytest.approx(exact.slope, abs=1e-5)


def test_other_curvature_is_told_apart():
    # kappa = theta' instead of theta'/stretch is another rod: the tip ends 4.8e-3 elsewhere at EA L^2/EI = 100
    still = cantilever(16, 1.0, 1e2, SOFT)
    assert tip_error(still, extensible_cantilever(1.0, 1.0, 1e2, 1.0, curvature="material")) > 2e-3


@pytest.mark.parametrize(("load", "EA"), [(10.0, 1e3), (1.0, 1e2)])
def test_clamp_that_holds_all_of_the_slope_costs_the_order(load, EA):
    # it pins the stretch at the clamp to one; measured orders 1.89, 1.27, 1.06 (load 10) and 1.05, 1.01, 1.00 (load 1)
    exact = extensible_cantilever(load, 1.0, EA, 1.0, curvature="geometric")
    errors = [tip_error(cantilever(n, load, EA, HARD), exact) for n in (4, 8, 16)]
    assert orders(errors).max() < 2.5
    assert errors[-1] > 10 * tip_error(cantilever(16, load, EA, SOFT), exact)


# modes
CHAIN = 10.0


@pytest.fixture(scope="module")
def chain_at_rest():
    """A chain hung at one end, so stiff that it counts as inextensible: weight/EA = 1e-6."""
    p = np.linspace(0, CHAIN, 9)
    return Still(model_of(chain(np.outer(p, [0.0, 0.0, -1.0]), p, {0: PINNED}, EA=GRAVITY * CHAIN * 1e6))), p


def test_eight_elements_swing_as_a_hanging_chain_in_both_planes(chain_at_rest):
    # measured -2.8e-7, 1e-7, 1.1e-5, 2.1e-4 for the first four
    still, _ = chain_at_rest
    found = modes(still.model.system, still.state, 8).frequency
    exact = hanging_chain_frequencies(CHAIN, GRAVITY, 4)
    np.testing.assert_allclose(found[:6], np.repeat(exact[:3], 2), rtol=3e-5)
    np.testing.assert_allclose(found[6:], np.repeat(exact[3:], 2), rtol=5e-4)


def test_hanging_chain_swings_in_the_shapes_of_bessel(chain_at_rest):
    # measured 3e-7, 4e-5, 7e-4 at the nodes
    still, p = chain_at_rest
    shapes = modes(still.model.system, still.state, 6).shape
    for k, limit in enumerate((2e-6, 2e-4, 2e-3)):
        for column in (2 * k, 2 * k + 1):
            moved = shapes[:, column].reshape(-1, 7)[:, :3]
            assert np.abs(moved[:, 2]).max() < 1e-8, "across the chain"
            tip = moved[-1] / np.linalg.norm(moved[-1])
            along = moved @ tip / np.linalg.norm(moved[-1])
            assert np.abs(along - hanging_chain_mode(k + 1, 1 - p / CHAIN)).max() < limit


def test_modes_of_a_hanging_chain_are_orthogonal_in_the_consistent_mass(chain_at_rest):
    # the mass is that of Hermite polynomials in each direction, written down in the references
    still, _ = chain_at_rest
    shapes = modes(still.model.system, still.state, 20).shape.reshape(9, 7, 20)
    mass = hermite_bar(8, 1.0, 1.0, CHAIN)[1]
    by_axis = [np.stack([shapes[:, axis], shapes[:, 3 + axis]], 1).reshape(18, 20) for axis in range(3)]
    products = sum(u.T @ mass @ u for u in by_axis)
    size = np.sqrt(np.diag(products))
    assert np.abs(products / np.outer(size, size) - np.eye(20)).max() < 1e-9


def test_hanging_chain_converges_with_order_four_in_its_frequencies():
    exact = hanging_chain_frequencies(CHAIN, GRAVITY, 2)[1]
    errors = []
    for n in (2, 4):
        p = np.linspace(0, CHAIN, n + 1)
        still = Still(model_of(chain(np.outer(p, [0.0, 0.0, -1.0]), p, {0: PINNED}, EA=GRAVITY * CHAIN * 1e6)))
        errors.append(modes(still.model.system, still.state, 4).frequency[2] / exact - 1)
    assert orders(errors).min() > 4.0  # measured 1.6e-4, 4.4e-6: 5.1


@pytest.mark.parametrize("strain", STRAINS)
@pytest.mark.parametrize(("ends", "EI"), [("pinned", 50.0), ("pinned", 2000.0), ("clamped", 2000.0)])
def test_taut_string_with_bending_vibrates_at_its_frequencies(ends, EI, strain):
    # worst of the first three modes, in both planes; measured at 16 elements 1.0e-4 pinned, 2.4e-4 clamped, with
    # orders 3.6 and 3.9 (three Lobatto points cost the sixth order that frequencies would have)
    tension, length, rhoA = 1000.0, 10.0, 2.0
    stretch = stretch_of(tension, EA, strain)
    exact = string_frequencies(tension / stretch, EI / stretch**4, rhoA, length, 3, ends)
    errors = []
    for n in (8, 16):
        p = np.linspace(0, length, n + 1)
        held = (1, 1, 1, 0, 1, 1, 1) if ends == "clamped" else PINNED
        items = chain(
            straight([0, 0, 0], [length * stretch, 0, 0], n),
            p, {0: held, n: held}, EA=EA, EJ=EI, rhoA=rhoA, strain=strain,
        )  # fmt: skip
        still = Still(model_of(items, gravity=(0, 0, 0)))
        assert still.forces[n, 0] == pytest.approx(tension, rel=1e-9)
        found = modes(still.model.system, still.state, 6).frequency
        errors.append(np.abs(found / np.repeat(exact, 2) - 1).max())
    assert errors[-1] < 5e-4
    assert orders(errors)[0] > 3.3
