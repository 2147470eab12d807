"""Varied cable scenes: what a study changes of a scene is changed, and nothing else is."""

import copy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from physics.axial_bars import BC, cantilever
from physics.axial_bars import element as bar_element
from physics.axial_bars import node as bar_node
from physics.rope_text import FREE, GRAVITY, PINNED, Still, chain, element, node, scene, straight
from scipy.integrate import quad
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq

from tautline.cable import variations as vary
from tautline.cable.application import Cable
from tautline.cable.build import build
from tautline.cable.joined import penalty_stiffness
from tautline.cable.members import flow_of
from tautline.cable.scene import parse, read
from tautline.cable.split import Chart, runs_of
from tautline.constraints.multiplier import Multipliers
from tautline.constraints.penalty import Penalties
from tautline.integrators.linearise import start_moving
from tautline.integrators.modes import modes
from tautline.integrators.state import new_state
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

HERE = Path(__file__).parents[1]
DATA = HERE.parent / "data"
SHIPPED = sorted(
    path.stem for path in DATA.glob("*.yaml") if "CableModel" in yaml.safe_load(path.read_text(encoding="utf8"))
)
ARC = np.linspace(0.0, 1.2, 5)
CURVED = np.column_stack([np.sin(ARC), 0.1 * ARC**2, 1.0 - np.cos(ARC)])


# scenes
def bent(linear=False, more="", held=None, **material):
    """Four elements along an arc between two supports, stretched a little; the file leaves nothing to be found."""
    ends = {0: PINNED, 4: PINNED} if held is None else held
    items = chain(CURVED, ARC / 1.01, ends, linear=linear, **({"EA": 1e4} | material)) + more
    return parse(scene(items, start="static"))


def sliding(n=3, angle=0.5, stretch=1.0):
    """A rope that slides down between two supports: all p follow that of the first node."""
    along = np.array([np.cos(angle), 0.0, -np.sin(angle)])
    p = np.linspace(0, 1 / stretch, n + 1)
    held = {i: (0, 0, 0, 0, 0, 0, 0) for i in range(n + 1)} | {i: (1, 1, 1, 0, 0, 0, 0) for i in (0, n)}
    items = chain(straight(0 * along, along, n), p, held, slopes=np.tile(stretch * along, (n + 1, 1)), EA=1e5)
    for i in range(1, n + 1):
        masters = "masters: [{mNode: 0, mDof: 7, factor: 1}]"
        items += f"  - LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: {float(p[i])!r}, {masters}}}\n"
    return parse(scene(items, type="Newmark"))


def interpolated():
    """A rope on an eyelet, where p is free: what is between it and the fixed end keeps its share."""
    held = {0: PINNED, 1: (0,) * 7, 2: (0,) * 7, 3: (1, 1, 1, 0, 0, 0, 0), 4: FREE}
    items = chain(straight([0, 0, 0], [2, 0, 0], 4), np.linspace(0, 2, 5), held, EA=1e4)
    for i in (1, 2):
        masters = f"[{{mNode: 3, mDof: 7, factor: {i / 3!r}}}]"
        items += f"  - LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, masters: {masters}}}\n"
    return parse(scene(items))


def passing(same=True):
    """A rope that is fed in at one end and taken off at the other: at one rate, or at two."""
    through = {0: (1, 1, 1, 0, 0, 0, 1), 1: (1, 1, 1, 0, 0, 0, 1)}
    items = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), through, EA=1e4,
                  functions={0: (0,) * 6 + (1,), 1: (0,) * 6 + (2,)})  # fmt: skip
    for number, begin, rate in ((1, 0.0, -0.3), (2, 1.0, -0.3 if same else -0.1)):
        listed = f"timeList: [0, 1], velocityList: [{rate}, {rate}]"
        items += f"  - Function_VelocityDefined: {{id: {number}, pos0: {begin}, {listed}}}\n"
    return parse(scene(items, time_step=0.01, time_end=0.2))


def carried():
    """A bar along x that two driven ends carry along y."""
    items = chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), {}, EA=1e3)
    items = items.replace("BC: [0, 0, 0, 0, 0, 0, 1]", "BC: [0, 1, 1, 0, 1, 1, 1], BC_functions: [0, 1, 0, 0, 0, 0, 0]")
    items += "  - Function: {id: 1, value: {ramp: {to: 0.2, over: 0.1}}}\n"
    return parse(scene(items, (0, 0, 0), time_step=0.01, time_end=0.2))


def tied(way, whats=(0, 2), **keys):
    """A bar of two halves, each of two elements, tied in the middle; EA = rhoA = 1 and a metre long."""
    p = (0.0, 0.25, 0.5, 0.5, 0.75, 1.0)
    items = [bar_node(i, x, "free" if i else "pinned", p=x) for i, x in enumerate(p)]
    items += [bar_element(i, ends, EA=1.0) for i, ends in enumerate([(0, 1), (1, 2), (3, 4), (4, 5)])]
    more = "".join(f", {key}: {value}" for key, value in keys.items())
    items += [f"{way}7: {{id: {what}, nodes7: [2, 3], constr: {what}{more}}}" for what in whats]
    listed = "".join(f"  - {item}\n" for item in items)
    return parse(scene(listed, (0, 0, 0)))


def mixed():
    """Ties of several methods, springs, masses, forces and plots, each on a node of one chain."""
    more = "  - Penalty7: {id: 1, nodes7: [4, 5], constr: 0, p_spring: 3.0e5}\n"
    more += "  - Penalty7: {id: 2, nodes7: [4, 5], constr: 2}\n"
    more += "  - LagMultipl7: {id: 3, nodes7: [5, 4], constr: 1}\n"
    more += "  - OneNodeSpring: {id: 1, nodes7: [1], stiffness: 250.0, damping: 1.0}\n"
    more += "  - OneNodeSpring: {id: 2, nodes7: [5], stiffness: 70.0}\n  - PointMass: {id: 1, nodes7: [2], mass: 2}\n"
    more += "  - TwoNodeSpring: {id: 1, nodes7: [1, 3], stiffness: 9.0}\n"
    more += "  - PointForce: {id: 1, nodes7: [3], force: [0, 1, 0]}\n"
    end = CURVED[-1]
    more += node(5, end, [0, 0, 1], FREE, ARC[-1] / 1.01) + node(6, end + [0, 0, 1], [0, 0, 1], FREE)
    more += element(7, 5, 6, EA=1e4, extra=", compression: false, load: [0, 1, 0]")
    text = scene(chain(CURVED, ARC / 1.01, {0: PINNED}, EA=1e4, EJ=2.0, damping=0.01) + more)
    return parse(text + "Plots:\n  - SubPlot: [{Cable: 7, what: N}, {Cable: 0, what: kappa}, {Node: 6, what: p}]\n")


def hung():
    """An arc, and a rope that hangs on its middle by couplings."""
    items = chain(CURVED, ARC / 1.01, {0: PINNED, 4: PINNED}, EA=1e4)
    items += node(5, CURVED[2], [0, 0, -1], FREE, 0.0) + node(6, CURVED[2] - [0, 0, 1], [0, 0, -1], FREE, 1.0)
    items += element(5, 5, 6, EA=1e4)
    for dof in (1, 2, 3):
        items += f"  - LinearCoupl: {{id: {dof}, sNode: 5, sDof: {dof}, masters: [{{mNode: 2, mDof: {dof}}}]}}\n"
    return parse(scene(items, start="static"))


MORE = {
    "a stretched arc": bent,
    "a rope that hangs on another": hung,
    "a bent arc": lambda: bent(EJ=3.0, extra=", quadrature: gauss"),
    "an arc from its far end": lambda: parse(
        scene(chain(CURVED, ARC / 1.01, {0: PINNED, 4: PINNED}, reverse=True, EA=1e4))
    ),
    "an arc of linear elements": lambda: bent(linear=True),
    "a rope that slides": sliding,
    "a rope on an eyelet": interpolated,
    "a rope that passes through": passing,
    "a rope that is stretched as it passes": lambda: passing(False),
    "a bar that is carried": carried,
    "multipliers": lambda: tied("LagMultipl"),
    "penalty springs": lambda: tied("Penalty", p_spring=2.0e4),
    "springs of the builder's choice": lambda: tied("AugLagrange"),
    "everything": mixed,
    "the appendix": lambda: read(HERE / "input" / "appendix_a.yaml"),
    "coordinates that the file leaves out": lambda: parse(Cable().templates["span"]),
    "one bar": lambda: parse(Cable().templates["bar"].replace("Node: 2", "Node: 0")),
}
SCENES = {name: lambda name=name: read(DATA / f"{name}.yaml") for name in SHIPPED} | MORE
UNSOUND = {"the appendix"}
"""Scenes that are read and not built: they say things twice."""


@pytest.fixture(params=SCENES)
def given(request):
    """A scene, which must stand as it did after the test."""
    made = SCENES[request.param]()
    before = copy.deepcopy(made), copy.deepcopy(made.document.root)
    yield made
    assert (made, made.document.root) == before


def is_sound(made):
    try:
        build(made)
    except SceneError:
        return False
    return True


# what is asked of them
def by_id(parts):
    return {part.id: part for part in parts}


def curve(made, element, p):
    """Position and slope (n, 6) of an element at material coordinates, by scipy's Hermite spline or along the chord."""
    chart = Chart(made)
    ends = [chart.nodes[i] for i in element.nodes]
    x = [chart.p[i] for i in element.nodes]
    if element.kind == "linear":
        share = (p[:, None] - x[0]) / (x[1] - x[0])
        r = (1.0 - share) * ends[0].position + share * np.array(ends[1].position)
        return np.hstack([r, np.tile(np.subtract(ends[1].position, ends[0].position) / (x[1] - x[0]), (len(p), 1))])
    spline = CubicHermiteSpline(x, [end.position for end in ends], [end.slope for end in ends])
    return np.hstack([spline(p), spline(p, 1)])


def accuracy(p):
    """What rounding leaves of position and slope (6,) on an element; slopes are differences over its length."""
    return np.repeat([1e-14, max(1e-14, 2e-15 / np.ptp(p))], 3)


def is_same_curve(fine, coarse):
    """Whether every element of one scene lies on one of the other, with its section; lengths and mass are as before."""
    p_of = {id(made): Chart(made).p for made in (fine, coarse)}
    left = {element.id: 0.0 for element in coarse.elements}
    for piece in fine.elements:
        p = np.linspace(*(p_of[id(fine)][i] for i in piece.nodes), 7)
        middle = p.mean()
        owners = [
            one for one in coarse.elements
            if p_of[id(coarse)][one.nodes[0]] < middle < p_of[id(coarse)][one.nodes[1]]
            and np.all(np.abs(curve(coarse, one, p) - curve(fine, piece, p)) < accuracy(p))
            and replace(one, id=0, nodes=(0, 0), line=0, place=())
            == replace(piece, id=0, nodes=(0, 0), line=0, place=())
        ]  # fmt: skip
        if len(owners) != 1:
            return False
        left[owners[0].id] += p[-1] - p[0]
    lengths = {one.id: Chart(coarse).length(one) for one in coarse.elements}
    return all(abs(left[i] - lengths[i]) < 1e-14 for i in left)


def count(made):
    return [len(run.elements) for run in runs_of(Chart(made))]


def without_mesh(made):
    """All of a scene that a mesh does not change: what stands on nodes, and how it is solved."""
    names = ("title", "gravity", "ties", "forces", "anchors", "springs", "masses", "motions", "solver", "cautions")
    return [getattr(made, name) for name in names]


def with_coordinates(made):
    """A scene whose nodes all say their p, as those of a divided one do."""
    p = Chart(made).p
    return replace(made, nodes=tuple(n if n.functions[-1] else replace(n, p=p[n.id]) for n in made.nodes))


def frequencies(made):
    """Angular frequencies of a scene as it begins, ascending, rad/s."""
    model = build(made)
    return modes(model.system, new_state(model.system)).omega


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
    stepped = replace(bent(), elements=(replace(first, rhoA=2.0), *others))
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
    # p'' = -g sin(alpha) / stretch, as in tests/physics/test_cable_motion.py
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
    ids, p = [int(i) for i in result["node"]], np.asarray(result["material"])
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


# stiffness
def test_all_elements_are_so_many_times_as_stiff_and_all_else_stays(given):
    varied = vary.stiffness(given, 7.0)
    for after, before in zip(varied.elements, given.elements, strict=True):
        assert (after.EA, after.EJ) == (7.0 * before.EA, 7.0 * before.EJ)
        assert replace(after, EA=before.EA, EJ=before.EJ) == before
    assert replace(varied, elements=given.elements) == given


@pytest.mark.parametrize("factor", [0.01, 4.0])
def test_frequencies_of_a_bar_go_with_the_root_of_its_stiffness(factor):
    items = "".join(f"  - {item}\n" for item in cantilever(3, EA=1.0))
    made = parse(scene(items, (0, 0, 0)))
    assert frequencies(vary.stiffness(made, factor)) == pytest.approx(np.sqrt(factor) * frequencies(made), rel=1e-9)


# what holds it
def test_springs_to_where_nodes_began_are_as_stiff_as_they_are_told():
    varied = vary.contact(mixed(), 4e6)
    assert [anchor.stiffness for anchor in varied.anchors] == [4e6, 4e6]
    assert replace(varied, anchors=mixed().anchors) == mixed()
    assert (vary.stiffnesses(mixed())["contact"], vary.stiffnesses(varied)["contact"]) == (250.0, 4e6)
    assert vary.contact(bent(), 4e6) is None and vary.stiffnesses(bent())["contact"] is None


def test_penalty_springs_are_as_stiff_as_they_are_told_and_slopes_by_a_length_squared(given):
    varied = vary.penalty(given, 5e4)
    sprung = [tie for tie in given.ties if tie.method != "multiplier"]
    if not sprung:
        assert varied is None and vary.stiffnesses(given)["penalty"] is None
        return
    assert vary.stiffnesses(varied)["penalty"] == pytest.approx(5e4, rel=1e-14)
    chart = Chart(given)
    for after, before in zip(varied.ties, given.ties, strict=True):
        near = [chart.length(e) for e in given.elements if {*e.nodes} & {*before.nodes}]
        wanted = 5e4 * min(near) ** 2 if before.what == 2 else 5e4
        assert after == (before if before.method == "multiplier" else replace(before, stiffness=wanted))
    assert replace(varied, ties=given.ties) == given


def test_the_stiffness_of_penalty_springs_is_told_as_the_builder_has_it():
    assert vary.stiffnesses(tied("Penalty", whats=(0,), p_spring=2.0e4))["penalty"] == 2.0e4
    assert vary.stiffnesses(tied("Penalty", whats=(2,), p_spring=2.0e4))["penalty"] == pytest.approx(2.0e4 / 0.0625)
    chosen = tied("Penalty")
    (springs,) = (group for group in build(chosen).system.groups if isinstance(group, Penalties))
    assert vary.stiffnesses(chosen)["penalty"] == springs.stiffness.max() == penalty_stiffness(Chart(chosen).layout)


def test_all_ties_can_be_imposed_in_three_ways_the_scenes_own_first(given):
    names = vary.constraints(given)
    if not given.ties:
        assert names == () and vary.constraint(given, "penalty") is None
        return
    methods = {tie.method for tie in given.ties}
    own = {"multiplier": "lagrange"}.get(*methods, *methods) if len(methods) == 1 else "as written"
    assert names[0] == own and {*names} - {"as written"} == {"lagrange", "penalty", "augmented"}
    assert vary.constraint(given, own) == given
    for name in names[1:]:
        varied = vary.constraint(given, name)
        (method,) = {tie.method for tie in varied.ties}
        assert vary.constraints(varied)[0] == name
        for after, before in zip(varied.ties, given.ties, strict=True):
            stiffness = None if method == "multiplier" else before.stiffness
            assert after == replace(before, method=method, stiffness=stiffness)
        assert replace(varied, ties=given.ties) == given


@pytest.mark.parametrize("way", ["LagMultipl", "Penalty", "AugLagrange"])
def test_a_tied_bar_swings_alike_however_its_ties_are_imposed(way):
    made = tied(way, **({} if way == "LagMultipl" else {"p_spring": 1e6}))
    kinds = {"lagrange": {Multipliers}, "penalty": {Penalties}, "augmented": {Multipliers, Penalties}}
    for name, groups in kinds.items():
        varied = vary.constraint(made, name)
        varied = vary.penalty(varied, 1e6) or varied
        assert groups == {type(group) for group in build(varied).system.groups} & {Multipliers, Penalties}
        assert frequencies(varied)[0] == pytest.approx(0.5 * np.pi, rel=2e-5)


def test_a_way_that_is_none_is_refused_by_name():
    with pytest.raises(SceneError, match="ties cannot be imposed by 'glue'; known: lagrange, penalty, augmented"):
        vary.constraint(tied("LagMultipl"), "glue")


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


# bars
def test_every_kind_of_element_is_a_bar_of_its_length_and_speed_of_sound(given):
    bars, chart = vary.bars(given), Chart(given)
    kinds = {(e.kind, round(chart.length(e), 12), round(np.sqrt(e.EA / e.rhoA), 9)) for e in given.elements}
    kind_of = {"bent": "cubic"}
    assert {(kind_of.get(bar.shape, bar.shape), round(bar.length, 12), round(bar.speed, 9)) for bar in bars} == kinds
    assert len({bar.name for bar in bars}) == len(bars)


def test_what_bears_no_sound_is_no_bar():
    items = chain(straight([0, 0, 0], [1, 0, 0], 2), np.linspace(0, 1, 3), {0: PINNED, 2: PINNED}, EA=4.0)
    made = parse(scene(items))
    assert [(bar.name, bar.speed) for bar in vary.bars(made)] == [("element 0 and 1 more of 0.5 m", 2.0)]
    light = replace(made, elements=(replace(made.elements[0], rhoA=0.0), replace(made.elements[1], EA=0.0)))
    assert vary.bars(light) == []


@pytest.mark.parametrize(
    ("made", "free"),
    [
        (lambda: read(DATA / "cantilever_bar.yaml"), [False, True]),
        (lambda: read(DATA / "reeled_span.yaml"), [False]),
        (lambda: tied("LagMultipl"), [False, True]),
        (interpolated, [False, True]),
        (sliding, [False]),
        (hung, [False, True]),
        (lambda: bent(held={0: (1, 1, 1, 1, 1, 1, 1)}), [False, True]),
    ],
)
def test_an_end_is_free_that_nothing_holds_along_the_rope_and_nothing_joins_to_another(made, free):
    assert [bar.free_end for bar in vary.bars(made())] == free


@pytest.mark.parametrize("ends", [("pinned", "free"), ("pinned", "pinned")])
@pytest.mark.parametrize(("extra", "shape"), [("", "cubic"), (", quadrature: lobatto", "bent")])
def test_the_fastest_vibration_of_one_cubic_element_is_the_bars(ends, extra, shape):
    # Bar gives L_eff / L_e to six figures
    nodes = "".join(f"  - {bar_node(i, 0.7 * i, end, p=0.7 * i)}\n" for i, end in enumerate(ends))
    made = parse(scene(nodes + element(0, 0, 1, EA=5.0, rhoA=3.0, extra=extra), (0, 0, 0)))
    (bar,) = vary.bars(made)
    assert (bar.free_end, bar.shape, bar.length) == (ends[1] == "free", shape, pytest.approx(0.7))
    assert frequencies(made).max() == pytest.approx(bar.fastest, rel=1e-5)


def test_an_element_that_bends_is_a_bar_of_lobatto_points_unless_it_takes_gauss_points():
    made = {name: vary.bars(bent(EJ=EJ, **more))[0].shape for name, EJ, more in (
        ("bends", 1.0, {}), ("bends, gauss", 1.0, {"extra": ", quadrature: gauss"}), ("does not", 0.0, {})
    )}  # fmt: skip
    assert made == {"bends": "bent", "bends, gauss": "cubic", "does not": "cubic"}


def test_the_fastest_vibration_of_one_linear_element_is_the_bars():
    held = (0, 1, 1, 1)
    items = chain(straight([0, 0, 0], [0.7, 0, 0], 1), np.array([0.0, 0.7]), {0: held, 1: held}, None, True, EA=5.0)
    made = parse(scene(items, (0, 0, 0)))
    (bar,) = vary.bars(made)
    assert (bar.shape, bar.free_end) == ("linear", True)
    assert frequencies(made).max() == pytest.approx(bar.fastest, rel=1e-5)
