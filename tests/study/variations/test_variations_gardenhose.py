"""Varied hoses: what a study changes of a scene is changed, and nothing else is."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml
from physics.pipes.hoses import COUPLINGS, SECTION, WATER
from physics.pipes.hoses import scene as hose_scene
from scipy.integrate import quad
from scipy.optimize import brentq

from gardenhose import variations as vary
from gardenhose.build import assembled, build
from gardenhose.cables import arc_lengths, cables_of, streams
from gardenhose.scene import HoseScene
from tautline.constraints.penalty import Penalties
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.vibration.modes import modes
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

DATA = Path(__file__).parents[3] / "data"
SHIPPED = sorted(path.stem for path in DATA.glob("*.yaml") if "hose" in yaml.safe_load(path.read_text(encoding="utf8")))
REST = {"gravity": [0, 0, 0]}

BORES = [
    SECTION | {"length": "30 cm", "elements": 6, "damping": 0.002},
    SECTION | {"length": 0.08, "elements": 1, "water_mass_per_length": 0.0004, "bending_stiffness": "0.002 N*m^2"},
    SECTION | {"length": 0.12, "elements": 3, "mass_per_length": 0.005},
]
ALIASES = """
segments:
  - &piece {length: 0.2, elements: 4, axial_stiffness: 10, bending_stiffness: 0.001, mass_per_length: 0.003}
  - {length: 0.1, elements: 1, axial_stiffness: 20, bending_stiffness: 0.001, mass_per_length: 0.003}
  - *piece
"""
MORE = {
    "three bores": lambda: hose_scene({"segments": BORES}, {"speed": 15.0}),
    "one piece among segments": lambda: hose_scene({"segments": BORES[:1]}),
    "no water": lambda: hose_scene({"segments": [BORES[0], BORES[2]]}, False),
    "penalty springs that are given": lambda: hose_scene(coupling="penalty", stiffness="2 kN/m"),
    "penalty springs that are chosen": lambda: hose_scene({"segments": BORES}, coupling="augmented"),
    "multipliers": lambda: hose_scene(coupling="lagrange"),
    "held at both ends": lambda: hose_scene({"end": "pinned", "direction": [1, 1, 0], "clamp": "slope"}),
    "no damping, a single element": lambda: hose_scene({"elements": 1, "damping": None, "tip_mass": "1 g"}),
}


def aliased():
    """Two pieces that are one object, as YAML's aliases make them."""
    pieces = Document.parse(ALIASES).root["segments"]
    assert pieces[0] is pieces[2]
    made = hose_scene({"segments": BORES})
    return validate(HoseScene, made.document.replaced({("hose", "segments"): (pieces, "test")}))


MORE["pieces that are aliases"] = aliased
SCENES = {name: lambda name=name: HoseScene.read(DATA / f"{name}.yaml") for name in SHIPPED} | MORE


@pytest.fixture(params=SCENES)
def scene(request):
    """A scene, which must stand as it did after the test."""
    made = SCENES[request.param]()
    before = made.model_dump(), copy.deepcopy(made.document.root)
    yield made
    assert (made.model_dump(), made.document.root) == before


def counts(scene):
    return [piece.elements for piece in scene.hose.pieces]


def without(scene, *keys):
    """All that a scene says but some keys of its pieces, and how many there are."""
    said = scene.model_dump(exclude={"hose"}), scene.hose.model_dump(exclude={*keys, "segments"})
    return said, [piece.model_dump(exclude=set(keys)) for piece in scene.hose.pieces]


def mass(scene):
    """Of hose and water, kg."""
    pieces = scene.hose.pieces
    return [sum(piece.length * (getattr(piece, key) or 0.0) for piece in pieces) for key in MASSES]


MASSES = ("mass_per_length", "water_mass_per_length")


def frequencies(scene):
    """Angular frequencies of the scene as it begins, ascending, rad/s."""
    model = build(scene)
    return modes(model.system, new_state(model.system)).omega


def tip_of(scene):
    """Place of the tip in static equilibrium, m."""
    made = build(scene)
    state = new_state(made.system)
    find_equilibrium(made.system, state, made.step_limit)
    place = 7 * scene.hose.element_count
    return state.full_q[place : place + 3]


# the mesh
@pytest.mark.parametrize("factor", [2, 3, 2.5])
def test_each_piece_has_so_many_times_its_elements_and_all_else_stays(scene, factor):
    varied = vary.elements(scene, factor)
    assert counts(varied) == [int(count * factor + 0.5) for count in counts(scene)]
    assert without(varied, "elements") == without(scene, "elements")
    assert arc_lengths(varied)[-1] == pytest.approx(arc_lengths(scene)[-1], rel=1e-14)
    build(varied)


def test_twice_the_elements_put_a_node_between_any_two_on_the_same_straight_line(scene):
    fine, coarse = (cables_of(made) for made in (vary.elements(scene, 2), scene))
    n = sum(counts(scene))
    before, after = ([node for node in made.nodes if node.id <= k * n + 1] for made, k in ((coarse, 1), (fine, 2)))
    for new, old in zip(after[::2], before, strict=True):
        assert new.position == pytest.approx(old.position, abs=1e-14)
        assert (new.slope, new.held) == (old.slope, old.held)
    assert [node.p for node in after[::2]] == pytest.approx([node.p for node in before], abs=1e-14)


def test_twice_the_elements_and_then_half_of_them_are_the_scene_again(scene):
    assert vary.elements(vary.elements(scene, 2), 0.5).model_dump() == scene.model_dump()


def test_half_the_elements_leave_at_least_one_of_every_piece():
    scene = MORE["three bores"]()
    assert counts(vary.elements(scene, 0.5)) == [3, 1, 2]
    assert counts(vary.elements(scene, 0.01)) == [1, 1, 1]


def test_nothing_is_left_to_halve_of_a_single_element():
    assert vary.elements(MORE["no damping, a single element"](), 0.5) is None


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("no damping, a single element", r"study: hose\.elements = 150000: must be at most 100000"),
        ("three bores", r"study: hose\.segments\[0\]\.elements = 900000: must be at most 100000"),
    ],
)
def test_more_elements_than_a_hose_may_have_are_refused_by_name(name, message):
    with pytest.raises(SceneError, match=message):
        vary.elements(MORE[name](), 150_000)


def test_a_hanging_hose_stretches_by_the_integral_of_its_strain_on_every_mesh():
    # N(s) = w (L - s) = EA (lambda^2 - 1) lambda / 2 with Green's strain, integrated apart. Halves of elements are
    # sixteen times less wrong: fourth order (1.7e-10, 1.0e-11, 6.5e-13 m)
    made = hose_scene({"direction": [0, 0, -1], "elements": 2, "axial_stiffness": 1.0, "length": 0.5}, False)
    piece = made.hose.pieces[0]
    weight = 9.81 * piece.mass_per_length

    def stretch(s):
        pull = weight * (0.5 - s) / piece.axial_stiffness
        return brentq(lambda x: 0.5 * (x * x - 1.0) * x - pull, 1.0, 2.0, xtol=1e-15)

    exact = quad(stretch, 0.0, 0.5, epsabs=1e-14)[0]
    errors = [abs(tip_of(vary.elements(made, factor) or made)[2] + exact) for factor in (1, 2, 4)]
    assert errors[0] < 1e-9
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([4.0, 4.0], abs=0.2)


# stiffness
def test_all_pieces_are_so_many_times_as_stiff_and_all_else_stays(scene):
    varied = vary.stiffness(scene, 7.0)
    keys = ("axial_stiffness", "bending_stiffness")
    assert without(varied, *keys) == without(scene, *keys)
    for after, before in zip(varied.hose.pieces, scene.hose.pieces, strict=True):
        assert [getattr(after, key) for key in keys] == [7.0 * getattr(before, key) for key in keys]


@pytest.mark.parametrize("factor", [0.01, 4.0])
def test_frequencies_of_a_hose_at_rest_go_with_the_root_of_its_stiffness(factor):
    scene = hose_scene({"elements": 4}, **REST)
    stiff, plain = frequencies(vary.stiffness(scene, factor)), frequencies(scene)
    assert stiff[0] == pytest.approx(np.sqrt(factor) * plain[0], rel=1e-9)
    assert stiff == pytest.approx(np.sqrt(factor) * plain, rel=1e-6)


# what it touches, what ties it
def test_a_hose_touches_nothing(scene):
    assert vary.contact(scene, 1e6) is None and vary.stiffnesses(scene)["contact"] is None


def test_penalty_springs_are_as_stiff_as_they_are_told_and_other_ties_have_none(scene):
    varied = vary.penalty(scene, 4321.0)
    if scene.coupling in ("linear", "lagrange"):
        assert varied is None and vary.stiffnesses(scene)["penalty"] is None
        return
    assert vary.stiffnesses(varied) == {"contact": None, "penalty": 4321.0}
    (springs,) = (group for group in assembled(varied).system.groups if isinstance(group, Penalties))
    assert set(springs.stiffness) == {4321.0}


def test_the_stiffness_that_the_builder_chooses_for_positions_is_told():
    scene = MORE["penalty springs that are chosen"]()
    (springs,) = (group for group in assembled(scene).system.groups if isinstance(group, Penalties))
    assert vary.stiffnesses(scene)["penalty"] == springs.stiffness.max() > 1.0
    assert vary.stiffnesses(MORE["penalty springs that are given"]())["penalty"] == 2000.0


def test_all_four_couplings_are_offered_the_scenes_own_first_and_none_without_water(scene):
    names = vary.constraints(scene)
    if scene.water is None:
        assert names == () and vary.constraint(scene, "lagrange") is None
        return
    assert names[0] == scene.coupling and sorted(names) == sorted(COUPLINGS)
    for name in names:
        varied = vary.constraint(scene, name)
        assert varied.coupling == name
        kept = scene.stiffness if name in ("penalty", "augmented") else None
        assert varied.stiffness == kept
        build(varied)


def test_hose_and_water_swing_alike_however_they_are_coupled():
    # springs of 1e4 N/m hold the water, which pulls with less than 1 N/m; with far stiffer ones rounding shows
    scene = hose_scene({"elements": 4}, **REST)
    ways = {name: vary.constraint(scene, name) for name in COUPLINGS}
    ways |= {name: vary.penalty(ways[name], 1e4) for name in ("penalty", "augmented")}
    first = {name: frequencies(made)[:4] for name, made in ways.items()}
    for name in COUPLINGS:
        assert first[name] == pytest.approx(first["linear"], rel=1e-9 if name == "lagrange" else 1e-4)


def test_a_coupling_that_is_none_is_refused_by_name():
    with pytest.raises(SceneError, match=r"study: coupling = glue: is not known here"):
        vary.constraint(hose_scene(), "glue")


# a sliver
@pytest.mark.parametrize("factor", [2.0, 100.0])
def test_one_element_is_so_many_times_shorter_than_the_shortest_and_the_others_stay(scene, factor):
    varied = vary.shortest(scene, factor)
    before, after = np.diff(arc_lengths(scene)), np.diff(arc_lengths(varied))
    sliver, n = before.min() / factor, counts(scene)[-1]
    assert after[-1] == pytest.approx(sliver, rel=1e-10)
    assert after[:-1] == pytest.approx(np.append(before[:-n], [before[-1] - sliver / n] * n), rel=1e-12)
    assert mass(varied) == pytest.approx(mass(scene), rel=1e-14)
    assert len(streams(varied)) == len(streams(scene))
    kept = without(scene, "length", "elements", "segments", *UNIFORM_KEYS)[0]
    assert without(varied, "length", "elements", "segments", *UNIFORM_KEYS)[0] == kept
    build(varied)


UNIFORM_KEYS = ("axial_stiffness", "bending_stiffness", "mass_per_length", "damping")


def test_the_bore_of_the_whole_hose_is_not_written_into_its_pieces():
    varied = vary.shortest(hose_scene(), 10.0)
    assert [piece.water_mass_per_length for piece in varied.hose.segments] == [None, None]
    given = [piece.water_mass_per_length for piece in vary.shortest(MORE["three bores"](), 10.0).hose.segments]
    assert given == [None, 0.0004, None, None]


def test_a_hose_that_was_varied_can_be_varied_again(scene):
    again = vary.stiffness(vary.elements(vary.shortest(scene, 10.0), 2), 3.0)
    assert np.diff(arc_lengths(again))[-2:] == pytest.approx([np.diff(arc_lengths(scene)).min() / 20.0] * 2, rel=1e-10)
    assert again.hose.pieces[0].axial_stiffness == 3.0 * scene.hose.pieces[0].axial_stiffness


def test_a_sliver_that_rounding_would_bend_is_refused_by_name():
    with pytest.raises(SceneError, match=r"hose\.root: is so far away that rounding would bend elements of"):
        vary.shortest(hose_scene(), 1e12)


# bars
def test_every_unlike_element_is_a_bar_of_its_length_and_speed_of_sound_with_its_water(scene):
    bars, pieces = vary.bars(scene), scene.hose.pieces
    assert {round(bar.length, 12) for bar in bars} == {round(piece.length / piece.elements, 12) for piece in pieces}
    speeds = [
        np.sqrt(p.axial_stiffness / (p.mass_per_length + (p.water_mass_per_length or 0.0))) for p in pieces
    ]  # fmt: skip
    assert {bar.shape for bar in bars} == {"bent"}
    assert sorted({round(bar.speed, 9) for bar in bars}) == sorted({round(float(s), 9) for s in speeds})
    assert [bar.free_end for bar in bars].count(True) == (1 if scene.hose.end == "free" else 0)
    assert len({bar.name for bar in bars}) == len(bars)


@pytest.mark.parametrize("end", ["free", "pinned"])
@pytest.mark.parametrize("water", [False, {"speed": 0.0}])
@pytest.mark.parametrize(("bending", "shape"), [(0.0, "cubic"), (1e-6, "bent")])
def test_the_fastest_vibration_of_one_element_is_the_bars(end, water, bending, shape):
    # Bar gives L_eff / L_e to six figures
    made = hose_scene({"elements": 1, "bending_stiffness": bending, "end": end}, water, **REST)
    (bar,) = vary.bars(made)
    assert (bar.free_end, bar.shape) == (end == "free", shape)
    assert bar.speed == pytest.approx(np.sqrt(10.0 / (0.0031316 + (WATER if water else 0.0))), rel=1e-12)
    assert frequencies(made).max() == pytest.approx(bar.fastest, rel=1e-5)


def test_a_scene_without_a_text_is_told_that_it_needs_one():
    scene = HoseScene.model_validate(hose_scene().document.root)
    with pytest.raises(SceneError, match="put together in Python cannot be changed by keys; read it from a file"):
        vary.elements(scene, 2)
