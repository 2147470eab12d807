"""Varied cable scenes: stiffness, supports and ties are as they are told, and nothing else is changed; bars."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from physics.cables.axial_bars import cantilever
from physics.cables.axial_bars import node as bar_node
from physics.cables.rope_text import PINNED, chain, element, scene, straight
from study.variations.varied_cables import DATA, SCENES, bent, frequencies, hung, interpolated, mixed, sliding, tied

from tautline.cable.input.scene import parse, read
from tautline.cable.model.build import build
from tautline.cable.model.magnitudes import penalty_stiffness
from tautline.cable.study import variations as vary
from tautline.cable.study.refinement import Chart
from tautline.constraints.multiplier import Multipliers
from tautline.constraints.penalty import Penalties
from tautline.scene.errors import SceneError


@pytest.fixture(params=SCENES)
def given(request):
    """A scene, which must stand as it did after the test."""
    made = SCENES[request.param]()
    before = copy.deepcopy(made), copy.deepcopy(made.document.root)
    yield made
    assert (made, made.document.root) == before


# stiffness
def test_all_elements_are_so_many_times_as_stiff_and_all_else_stays(given):
    varied = vary.stiffness(given, 7.0)
    for after, before in zip(varied.elements, given.elements, strict=True):
        assert (after.EA, after.EJ) == (7.0 * before.EA, 7.0 * before.EJ)
        assert after._replace(EA=before.EA, EJ=before.EJ) == before
    assert replace(varied, elements=given.elements) == given


@pytest.mark.parametrize("factor", [0.01, 4.0])
def test_frequencies_of_a_bar_go_with_the_root_of_its_stiffness(factor):
    items = "".join(f"  - {item}\n" for item in cantilever(3, EA=1.0))
    made = parse(scene(items, (0, 0, 0)))
    assert frequencies(vary.stiffness(made, factor)) == pytest.approx(np.sqrt(factor) * frequencies(made), rel=1e-9)


# what holds it
def test_springs_to_where_nodes_began_are_as_stiff_as_they_are_told():
    varied = vary.contact(mixed(), 4e6)
    assert [anchor.model.stiffness for anchor in varied.anchors] == [4e6, 4e6]
    assert replace(varied, nodal=mixed().nodal) == mixed()
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
    assert vary.stiffnesses(chosen)["penalty"] == springs.stiffness.max() == penalty_stiffness(chosen)


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
    light = replace(made, elements=(made.elements[0]._replace(rhoA=0.0), made.elements[1]._replace(EA=0.0)))
    assert vary.bars(light) == []


def read_bar(held):
    """One element along x from a pin to a node that is held so."""
    return parse(scene(chain(straight([0, 0, 0], [1, 0, 0], 1), np.array([0.0, 1.0]), {0: PINNED, 1: held}, EA=1.0)))


@pytest.mark.parametrize(
    ("made", "free"),
    [
        (lambda: read(DATA / "cantilever_bar.yaml"), [False, True]),
        (lambda: read(DATA / "reeled_span.yaml"), [False]),
        (lambda: tied("LagMultipl"), [False, True]),
        (interpolated, [False, True]),
        (sliding, [False]),
        (hung, [False, True]),
        (lambda: read_bar((1, 0, 0, 0, 0, 0, 1)), [False]),
        (lambda: read_bar((0, 1, 1, 0, 0, 0, 1)), [True]),
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
