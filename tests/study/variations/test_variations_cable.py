"""Cable scenes on other meshes: the elements are cut and joined, and the rope and all that holds it are the same."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from physics.cables.axial_bars import BC
from physics.cables.rope_text import GRAVITY, PINNED, Still, chain, scene, straight
from scipy.integrate import quad
from scipy.optimize import brentq
from study.variations.varied_cables import (
    ARC,
    CURVED,
    DATA,
    MORE,
    SCENES,
    bent,
    by_id,
    carried,
    count,
    frequencies,
    hung,
    is_same_curve,
    is_sound,
    mixed,
    passing,
    sliding,
    tied,
    with_coordinates,
    without_mesh,
)

from tautline.cable.input.scene import parse, read
from tautline.cable.model.build import build
from tautline.cable.model.elements import flow_of
from tautline.cable.study import variations as vary
from tautline.cable.study.refinement import Chart
from tautline.integrators.linearise import start_moving
from tautline.integrators.state import new_state
from tautline.scene.errors import SceneError
from tautline.simulation import simulate


@pytest.fixture(params=SCENES)
def given(request):
    """A scene, which must stand as it did after the test."""
    made = SCENES[request.param]()
    before = copy.deepcopy(made), copy.deepcopy(made.document.root)
    yield made
    assert (made, made.document.root) == before


# the mesh
@pytest.mark.parametrize("factor", [2, 3])
def test_the_elements_are_cut_and_the_curve_its_length_and_its_mass_are_the_same(given, factor):
    varied = vary.elements(given, factor)
    assert len(varied.elements) == factor * len(given.elements)
    assert is_same_curve(varied, given)
    assert without_mesh(varied) == without_mesh(given) and varied.plots == given.plots
    old = by_id(with_coordinates(given).nodes)
    assert all(by_id(varied.nodes)[i] == old[i] for i in old)
    assert [n.id for n in varied.nodes if n.id in old] == [*old]
    assert [varied.nodes[i].id for i in (0, -1)] == [given.nodes[i].id for i in (0, -1)]
    for e in given.elements:
        assert by_id(varied.elements)[e.id].nodes[0] == e.nodes[0]
    for parts in (varied.nodes, varied.elements, varied.couplings):
        assert len(by_id(parts)) == len(parts)
    assert is_sound(varied) == is_sound(given)


def test_twice_the_elements_and_then_half_of_them_are_the_scene_again(given):
    assert vary.elements(vary.elements(given, 2), 0.5) == with_coordinates(given)
    twice = vary.elements(vary.elements(given, 2), 2)
    assert vary.elements(twice, 0.25) == with_coordinates(given)


def test_runs_are_divided_into_the_nearest_number_of_elements_and_at_least_one():
    made = bent()
    assert count(made) == [4]
    for factor, expected in ((0.5, 2), (0.25, 1), (0.01, 1), (0.75, 3), (1.25, 5), (1.4, 6)):
        varied = vary.elements(made, factor)
        assert (count(varied), len(varied.nodes)) == ([expected], expected + 1)
        p = Chart(varied).p
        lengths = [p[e.nodes[1]] - p[e.nodes[0]] for e in varied.elements]
        assert lengths == pytest.approx([1.2 / 1.01 / expected] * expected, rel=1e-12)
        build(varied)
    assert vary.elements(made, 1) is None


def test_new_nodes_and_elements_stand_in_the_file_between_those_that_they_are_between():
    for made in (bent(), MORE["an arc from its far end"]()):
        varied = vary.elements(made, 3)
        x = np.array([one.position for one in varied.nodes])[:, 0]
        assert np.all(np.diff(x) > 0.0) and x.size == 13
    varied = vary.elements(bent(), 3)
    assert [e.nodes[0] for e in varied.elements] == [one.id for one in varied.nodes[:-1]]


def test_a_coarser_mesh_stands_on_nodes_of_the_finer_and_keeps_their_slopes():
    coarse, fine = (by_id(made.nodes) for made in (vary.elements(bent(), 0.5), with_coordinates(bent())))
    assert coarse == {i: fine[i] for i in (0, 2, 4)}


def test_nodes_that_something_refers_to_stay_where_the_mesh_is_made_coarser():
    made = mixed()
    assert count(made) == [1, 1, 1, 1, 1]
    assert vary.elements(made, 0.5) is None
    for name in ("cantilever_bar", "reeled_span"):
        runs = {"cantilever_bar": [2], "reeled_span": [1, 1, 1]}[name]
        assert count(read(DATA / f"{name}.yaml")) == runs


def test_a_support_within_a_rope_and_a_change_of_its_section_stay_where_the_mesh_is_made_coarser():
    propped = bent(held={0: PINNED, 2: (0, 0, 1, 0, 0, 0, 1), 4: PINNED})
    assert [one.id for one in vary.elements(propped, 0.5).nodes] == [0, 2, 4]
    assert count(propped) == [2, 2]
    first, *others = bent().elements
    stepped = replace(bent(), elements=(first._replace(rhoA=2.0), *others))
    assert count(stepped) == [1, 3]


def test_a_node_that_another_follows_stays_where_the_mesh_is_made_coarser():
    assert count(hung()) == [2, 2, 1]
    coarse = vary.elements(hung(), 0.5)
    assert [one.id for one in coarse.nodes] == [0, 2, 4, 5, 6]
    assert coarse.couplings == hung().couplings
    build(coarse)


def test_an_element_that_a_plot_draws_goes_on_under_its_name_and_its_curve_with_what_is_there():
    text = scene(chain(CURVED, ARC / 1.01, {0: PINNED, 4: PINNED}, EA=1e4))
    drawn = parse(text + "Plots:\n  - SubPlot: [{Cable: 1, what: N}, {Cable: 2, what: N}, {Cable: 3, what: N}]\n")
    coarse = vary.elements(drawn, 0.5)
    assert [e.id for e in coarse.elements] == [1, 2]
    assert [curve.cable for curve in coarse.plots[0]] == [1, 2, 2]
    assert [by_id(coarse.elements)[i].nodes for i in (1, 2)] == [(0, 2), (2, 4)]


def test_a_bar_that_stays_on_its_line_is_cut_into_bars_that_do():
    varied = vary.elements(read(DATA / "cantilever_bar.yaml"), 2)
    assert [new.held for new in varied.nodes if new.id > 2] == [tuple(map(bool, BC["free"]))] * 2


def test_what_is_between_two_clamps_or_two_pins_is_free():
    clamps = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), {0: (1,) * 7, 1: (1,) * 7}, EA=1.0, EJ=1.0)
    pins = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), {0: PINNED, 1: PINNED}, EA=1.0, linear=True)
    for items, size in ((clamps, 7), (pins, 4)):
        _, new, _ = vary.elements(parse(scene(items)), 2).nodes
        assert new.held == (False,) * (size - 1) + (True,)
        assert new.p == 0.5


def test_a_clamped_beam_of_one_element_swings_as_a_beam_does_once_it_is_cut():
    # first frequency of a clamped beam: 22.3733 sqrt(EJ / rhoA) / L^2 (Blevins, Table 8-1); eight elements: 1e-5
    items = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), {0: (1,) * 7, 1: (1,) * 7}, EA=1e4, EJ=1.0)
    omega = frequencies(vary.elements(parse(scene(items, (0, 0, 0))), 8))
    assert omega[0] == pytest.approx(22.3733, rel=1e-4)


@pytest.mark.parametrize("n", [1, 3])
def test_material_that_slides_begins_to_on_a_finer_mesh_as_newton_says(n):
    # p'' = -g sin(alpha) / stretch, as in tests/physics/cables/test_cable_motion.py
    made = sliding(n, 0.5, 1.1)
    varied = vary.elements(made, 2)
    assert all(c.masters == ((0, 7, 1.0),) for c in varied.couplings)
    chart = Chart(varied)
    assert {flow_of(chart.layout, e) for e in varied.elements} == {"shared"}
    model = build(varied)
    state = new_state(model.system)
    start_moving(model.system, state, 1e-3)
    pdd = state.full_a[: 7 * (2 * n + 1)].reshape(-1, 7)[:, 6]
    assert pdd == pytest.approx(-GRAVITY * np.sin(0.5) / 1.1, rel=1e-6)


def test_new_nodes_keep_their_share_of_material_that_is_driven():
    made = passing(False)
    varied = vary.elements(made, 4)
    result = simulate(build(varied))
    ids, p = [int(i) for i in result["node"]], np.asarray(result["material_coordinate"])
    ends = p[:, ids.index(0)], p[:, ids.index(1)]
    assert np.ptp(ends[1] - ends[0]) > 0.03
    shares = {Chart(varied).p[i]: p[:, ids.index(i)] for i in ids if i > 1}
    for x, path in shares.items():
        assert path == pytest.approx((1 - x) * ends[0] + x * ends[1], abs=1e-13)
    assert sorted(shares) == pytest.approx([0.25, 0.5, 0.75])


def test_material_that_passes_at_one_rate_is_seen_to_on_a_finer_mesh():
    made = passing()
    for varied in (made, vary.elements(made, 2), vary.elements(vary.elements(made, 2), 3)):
        assert {flow_of(Chart(varied).layout, e) for e in varied.elements} == {"shared"}


def test_a_bar_that_is_carried_is_carried_when_it_is_cut():
    result = simulate(build(vary.elements(carried(), 4)))
    y = np.asarray(result["position"])[:, :, 1]
    assert y[-1] == pytest.approx(0.2, abs=1e-12)
    assert np.ptp(y, axis=1).max() < 1e-12


@pytest.mark.parametrize(("linear", "least", "most"), [(False, 4.0, 6.1), (True, 1.95, 2.05)])
def test_a_hanging_bar_stretches_by_the_integral_of_its_strain_with_the_error_of_its_element(linear, least, most):
    # N(s) = rho g (L - s) = EA (lambda^2 - 1) lambda / 2 with Green's strain, integrated apart. A cubic has fourth
    # order, and up to sixth at its nodes (measured 5.2 and 5.4); a linear element second
    EA = 30.0

    def stretch(s):
        pull = GRAVITY * (1.0 - s) / EA
        return brentq(lambda x: 0.5 * (x * x - 1.0) * x - pull, 1.0, 2.0, xtol=1e-15)

    exact = quad(stretch, 0.0, 1.0, epsabs=1e-14)[0]
    items = chain(straight([0, 0, 0], [0, 0, -1], 2), np.linspace(0, 1, 3), {0: PINNED}, linear=linear, EA=EA)
    made = parse(scene(items))
    errors = []
    for factor in (1, 2, 4):
        found = Still(build(vary.elements(made, factor) or made), linear)
        errors.append(abs(found.position[2 * factor, 2] + exact))
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.all((least <= orders) & (orders <= most))


@pytest.mark.parametrize("way", ["LagMultipl", "Penalty", "AugLagrange"])
def test_a_tied_bar_swings_as_one_on_a_finer_mesh(way):
    # sqrt(EA/rhoA) / 4 L, the fundamental of a bar that is fixed at one end; the springs give way by 3e-6
    keys = {} if way == "LagMultipl" else {"p_spring": 1e6}
    made = vary.elements(tied(way, **keys), 2)
    assert frequencies(made)[0] == pytest.approx(0.5 * np.pi, rel=5e-6)


# a sliver
@pytest.mark.parametrize("factor", [2.0, 100.0])
def test_one_element_is_so_many_times_shorter_than_the_shortest_and_the_curve_is_the_same(given, factor):
    varied = vary.shortest(given, factor)
    assert is_same_curve(varied, given)
    assert without_mesh(varied) == without_mesh(given) and varied.plots == given.plots
    before, after = Chart(given), Chart(varied)
    sliver = min(before.length(e) for e in given.elements) / factor
    assert [e.id for e in varied.elements[:-1]] == [e.id for e in given.elements]
    assert after.length(varied.elements[-1]) == pytest.approx(sliver, rel=1e-11)
    assert is_sound(varied) == is_sound(given)


def test_a_sliver_of_nothing_is_refused_by_name():
    made = bent()
    message = r"scene.yaml:\d+: CableModel\[8\].CableALEelement: nothing is left of its 0.297 m if"
    for factor in (0.5, 1e20):
        with pytest.raises(SceneError, match=message):
            vary.shortest(made, factor)
    with pytest.raises(SceneError, match="nothing is left of the element"):
        vary.shortest(made, 1e12)


def test_a_cable_that_was_varied_can_be_varied_again(given):
    again = vary.stiffness(vary.elements(vary.shortest(given, 10.0), 2), 3.0)
    assert len(again.elements) == 2 * (len(given.elements) + 1)
    assert is_sound(again) == is_sound(given)
