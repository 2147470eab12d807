"""Varied cranes: what a study changes of a scene is changed, and nothing else is."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml
from of_the_suite import kept, studies
from physics.lifting.lifts import anchor, body, drum, end, plain, sheave
from scipy.integrate import quad
from scipy.optimize import brentq

from crane.groups.bends import Bends
from crane.groups.masses import Bodies, Springs
from crane.groups.span import MATERIAL, Spans
from crane.model import variations as vary
from crane.model.build import assembled, build
from crane.scene.consistency import MOST_ELEMENTS
from crane.scene.scene import CraneScene
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.vibration.modes import modes
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

DATA = Path(__file__).parents[3] / "data"
SHIPPED = sorted(path.stem for path in DATA.glob("*.yaml") if "path" in yaml.safe_load(path.read_text(encoding="utf8")))
ROPE = {"mass_per_length": 6.5, "axial_stiffness": 8.0e7, "damping": 1.0e-4, "diameter": 0.036}
SOLVER = {"method": "generalized-alpha", "rho_inf": 0.6, "step": 5e-3, "end": 1.0}


def crane(path, bodies=(), rope=None, **top):
    """A scene; keys are those of its file, and a key that is None is left out of it."""
    document = {"rope": ROPE | (rope or {}), "path": path, "bodies": [*bodies], "mesh": {"elements_per_span": 3}}
    document |= {"solver": SOLVER, "output": {"interval": 0.05}} | top
    written = {key: value for key, value in plain(document).items() if value is not None}
    return validate(CraneScene, Document.parse(yaml.safe_dump(written, sort_keys=False), "crane.yaml"))


WINCH, TIP = drum([0, 0, 0], 0.5), sheave("tip", 0.4, center=[12, 0, 30], inertia=20)
PULLING = {"drum": {key: value for key, value in WINCH["drum"].items() if key != "pay_out"}}
PULLING["drum"] |= {"tension": 5e4, "inertia": 2000.0}
LOAD = body("payload", 5000.0, [12.4, 0, 5])
SPRING = {"stiffness": ["1 MN/m", 0, 2.0e6], "damping": [0, 100.0, 0]}


def hoist(load=None, **more):
    """One fall over a sheave."""
    return crane([WINCH, TIP, end("payload")], [LOAD | (load or {})], **more)


def sprung():
    """Two loads on one rope whose springs are one object, as YAML's aliases make them."""
    path = [end("one"), sheave("wheel", 0.5, center=[0, 0, 20]), end("other")]
    loads = [body("one", 900.0, [-0.5, 0, 5]), body("other", 900.0, [0.5, 0, 8])]
    made = crane(path, [load | {"spring": SPRING} for load in loads], ground={"level": 0.0, "stiffness": "5 MN/m"})
    shared = [load | {"spring": SPRING} for load in made.document.root["bodies"]]
    return validate(CraneScene, made.document.replaced({("bodies",): (shared, "test")}))


def bar(n, fall=100.0, **more):
    """A rope that hangs from an anchor and carries a load, or is held at both ends where there is none."""
    return crane([anchor([0, 0, 0]), end("load")], [body("load", 900.0, [0, 0, -fall], guide="xy")],
                 mesh={"elements_per_span": n}, start="as drawn", **more)  # fmt: skip


def held(n, **more):
    """A rope between two anchors, weightless and as long as it is drawn."""
    far = {"anchor": {"name": "far", "position": [100.0, 0, 0]}}
    return crane([anchor([0, 0, 0]), far], mesh={"elements_per_span": n}, gravity=[0, 0, 0], start="as drawn", **more)


MORE = {
    "a number for each span": lambda: hoist(mesh={"elements_per_span": [2, 7]}),
    "the mesh left to its default": lambda: hoist(mesh=None),
    "single elements": lambda: hoist(mesh={"elements_per_span": 1}),
    "pairs of elements": lambda: hoist(mesh={"elements_per_span": 2}),
    "a rope that bends": lambda: hoist(rope={"bending_stiffness": "900 N*m^2", "compression": "elastic"}),
    "a rope of a length, and ground": lambda: hoist(
        rope={"length": "57.3 m"}, start="as drawn", ground={"level": 0, "stiffness": 2e7}
    ),
    "springs that are aliases, and ground": sprung,
    "a winch that holds a tension": lambda: crane([PULLING, TIP, end("payload")], [LOAD]),
    "a damper alone": lambda: hoist({"spring": {"stiffness": [0, 0, 0], "damping": [0, 0, 50.0]}}),
}


SCENES = {name: lambda name=name: CraneScene.read(DATA / f"{name}.yaml") for name in SHIPPED} | MORE


LARGE = ("sixteen_falls",)
"""It has many spans, and takes long for it; what it has in them the hook block has too."""


@pytest.fixture(params=kept(SCENES, SCENES.keys() - {*LARGE}))
def scene(request):
    """A scene, which must stand as it did after the test."""
    made = SCENES[request.param]()
    before = made.model_dump(), copy.deepcopy(made.document.root)
    yield made
    assert (made.model_dump(), made.document.root) == before


def lengths(scene):
    """Unstretched lengths of the elements of every span as the builder lays them out, m."""
    layout = assembled(scene).layout
    p = layout.degrees.value[np.array(layout.station) + MATERIAL]
    return [np.diff(p[first : last + 1]) for first, last in layout.spans]


def group(scene, kind):
    return next(group for group in build(scene).system.groups if isinstance(group, kind))


def frequencies(scene):
    """Angular frequencies of the scene as it begins, ascending, rad/s."""
    model = build(scene)
    return modes(model.system, new_state(model.system)).omega


# the mesh
@pytest.mark.parametrize("factor", [3, 2.5, *studies(2)])
def test_each_span_has_so_many_times_its_elements_and_as_much_rope_as_before(scene, factor):
    varied = vary.elements(scene, factor)
    assert varied.elements == tuple(int(count * factor + 0.5) for count in scene.elements)
    assert varied.model_dump(exclude={"mesh"}) == scene.model_dump(exclude={"mesh"})
    for fine, coarse in zip(lengths(varied), lengths(scene), strict=True):
        assert fine.sum() == pytest.approx(coarse.sum(), rel=1e-13)
    build(varied)


def test_twice_the_elements_divide_every_straight_piece_in_halves(scene):
    fine, coarse = (assembled(made).layout for made in (vary.elements(scene, 2), scene))
    for (first, last), (begin, stop) in zip(fine.spans, coarse.spans, strict=True):
        places = [np.array(x.station) for x in (fine, coarse)]
        new, old = (x.degrees.value[at[:, None] + np.arange(4)] for x, at in zip((fine, coarse), places, strict=True))
        inner = slice(first + 2, last, 2), slice(begin + 1, stop)
        assert new[inner[0]] == pytest.approx(old[inner[1]], rel=1e-12, abs=1e-12)


def test_twice_the_elements_and_then_half_of_them_are_the_scene_again(scene):
    assert vary.elements(vary.elements(scene, 2), 0.5).model_dump() == scene.model_dump()


def test_half_the_elements_leave_at_least_one_in_every_span():
    scene = MORE["a number for each span"]()
    assert vary.elements(scene, 0.5).elements == (1, 4)
    assert vary.elements(scene, 0.01).elements == (1, 1)
    assert vary.elements(MORE["single elements"](), 0.5) is None


@pytest.mark.parametrize(
    ("name", "factor", "message"),
    [
        ("a number for each span", 240, r"study: mesh\.elements_per_span: makes 2160 elements, more than 2000"),
        ("a number for each span", 500, r"study: mesh\.elements_per_span\[1\] = 3500: must be at most 2000"),
        ("single elements", 1500, r"study: mesh\.elements_per_span = 1500: makes 3000 elements, more than 2000"),
    ],
)
def test_more_elements_than_a_rope_may_have_are_refused_by_name(name, factor, message):
    with pytest.raises(SceneError, match=message):
        vary.elements(MORE[name](), factor)


def test_a_hanging_rope_stretches_by_the_integral_of_its_strain_with_an_error_of_second_order():
    # N(s) = (m + rho (L - s)) g = EA (lambda^2 - 1) lambda / 2 with Green's strain, integrated apart
    rope, fall = {"axial_stiffness": 1.0e5}, 100.0

    def stretch(s):
        pull = 9.81 * (900.0 + 6.5 * (fall - s)) / 1.0e5
        return brentq(lambda x: 0.5 * (x * x - 1.0) * x - pull, 1.0, 2.0, xtol=1e-15)

    exact = quad(stretch, 0.0, fall, epsabs=1e-12)[0]
    errors = []
    for factor in (1, 2, 4):
        made = bar(2, fall, rope=rope)
        layout = assembled(made).layout
        model = build(vary.elements(made, factor) or made)
        state = new_state(model.system)
        find_equilibrium(model.system, state, model.step_limit)
        errors.append(-state.full_q[layout.body["load"] + 2] - exact)
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2.0, 2.0], abs=0.05)
    assert abs(errors[0]) < 1e-3 * (exact - fall)


# stiffness
def test_the_rope_is_so_many_times_as_stiff_and_all_else_stays(scene):
    varied = vary.stiffness(scene, 7.0)
    keys = {"axial_stiffness", "bending_stiffness"}
    assert varied.model_dump(exclude={"rope": keys}) == scene.model_dump(exclude={"rope": keys})
    before, after = (group(made, Spans).rows for made in (scene, varied))
    assert after.stiffness == pytest.approx(7.0 * before.stiffness, rel=1e-15)
    assert np.array_equal(after.mass, before.mass) and np.array_equal(after.damping, before.damping)


def test_a_rope_that_bends_is_so_many_times_as_stiff_there_too():
    scene = MORE["a rope that bends"]()
    assert vary.stiffness(scene, 7.0).rope.bending_stiffness == 6300.0
    before, after = (group(made, Bends).rows for made in (scene, vary.stiffness(scene, 7.0)))
    assert after.stiffness == pytest.approx(7.0 * before.stiffness, rel=1e-15)
    assert np.array_equal(after.damping, before.damping)


@pytest.mark.parametrize("factor", [0.01, 4.0])
def test_frequencies_of_a_stretched_rope_go_with_the_root_of_its_stiffness(factor):
    # the strain is given, so that the tension that it swings by goes with the stiffness as well
    scene = held(6, rope={"length": 99.0})
    plain, stiff = frequencies(scene), frequencies(vary.stiffness(scene, factor))
    assert plain[0] > 1.0
    assert stiff == pytest.approx(np.sqrt(factor) * plain, rel=1e-9)


# what it touches
def test_ground_and_springs_are_as_stiff_as_they_are_told_along_the_axes_that_they_act_on(scene):
    varied = vary.contact(scene, 3.0e7)
    springs = [one.spring for one in scene.bodies if one.spring is not None and any(one.spring.stiffness)]
    if scene.ground is None and not springs:
        assert varied is None and vary.stiffnesses(scene) == {"contact": None, "penalty": None}
        return
    assert vary.stiffnesses(varied) == {"contact": 3.0e7, "penalty": None}
    if scene.ground is not None:
        before, after = (group(made, Bodies).ground for made in (scene, varied))
        assert after[1] == 3.0e7 and np.array_equal(after[[0, 2, 3]], before[[0, 2, 3]])
    if springs:
        before, after = (group(made, Springs) for made in (scene, varied))
        assert np.array_equal(after.stiffness, np.where(before.stiffness > 0.0, 3.0e7, 0.0))
        assert np.array_equal(after.damping, before.damping) and np.array_equal(after.rest, before.rest)


def test_the_largest_stiffness_of_what_it_touches_is_told():
    assert vary.stiffnesses(MORE["springs that are aliases, and ground"]())["contact"] == 5.0e6
    assert vary.stiffnesses(hoist({"spring": SPRING}))["contact"] == 2.0e6


def test_a_crane_has_no_constraints_to_impose_in_another_way(scene):
    assert vary.constraints(scene) == ()
    assert vary.constraint(scene, "lagrange") is None and vary.penalty(scene, 1e9) is None


# very short elements
@pytest.mark.parametrize("factor", [2.0, *studies(100.0)])
def test_one_span_has_elements_so_many_times_shorter_than_the_shortest_and_the_others_stay(scene, factor):
    varied = vary.shortest(scene, factor)
    before, after = lengths(scene), lengths(varied)
    least = min(span.min() for span in before)
    changed = [k for k, counts in enumerate(zip(varied.elements, scene.elements, strict=True)) if len({*counts}) > 1]
    assert len(changed) == 1
    shortest = after[changed[0]].min()
    assert least / factor * (1 + 1e-9) >= shortest
    # one element fewer would not do
    fewer = list(varied.elements)
    fewer[changed[0]] -= 1
    coarser = validate(CraneScene, scene.document.replaced({vary.MESH: (fewer, "test")}))
    assert min(span.min() for span in lengths(coarser)) > least / factor * (1 + 1e-9)
    for k, (fine, coarse) in enumerate(zip(after, before, strict=True)):
        assert fine.sum() == pytest.approx(coarse.sum(), rel=1e-13)
        assert k in changed or fine == pytest.approx(coarse, rel=1e-13)
    build(varied)


def test_the_span_that_is_divided_is_the_one_that_takes_the_fewest_elements():
    assert vary.shortest(CraneScene.read(DATA / "landing.yaml"), 100.0).elements == (800, 8)
    assert vary.shortest(CraneScene.read(DATA / "hoist.yaml"), 100.0).elements == (4, 400)


def test_no_rope_is_divided_more_finely_than_it_may_be():
    scene = MORE["a number for each span"]()
    most = vary.shortest(scene, 1e5)
    assert sum(most.elements) == MOST_ELEMENTS and most.elements[0] in (2, most.elements[0])
    assert vary.shortest(most, 2.0) is None


# bars
def test_every_unlike_element_is_a_bar_of_its_length_and_speed_of_sound(scene):
    bars = vary.bars(scene)
    laid = np.concatenate(lengths(scene))
    for found in bars:
        assert np.abs(laid / found.length - 1.0).min() < 1e-12
        assert found.speed == pytest.approx(np.sqrt(scene.rope.axial_stiffness / scene.rope.mass_per_length), rel=1e-14)
        assert found.shape == "linear"
    for length in laid:
        assert min(abs(found.length / length - 1.0) for found in bars) < 1e-9
    free = [found.name for found in bars if found.free_end]
    ends = [item for item in (scene.path[0], scene.path[-1])
            if item.key == "end" or (item.key == "drum" and not item.prescribed)]  # fmt: skip
    assert [name.rpartition(" at ")[2] for name in free] == [item.name.rpartition(" at ")[2] for item in ends]


def test_a_load_that_is_guided_along_the_rope_does_not_free_its_end():
    assert [found.free_end for found in vary.bars(bar(1))] == [True]
    made = crane([anchor([0, 0, 0]), end("load")], [body("load", 900.0, [0, 0, -100.0], guide="xyz")])
    assert not any(found.free_end for found in vary.bars(made))


@pytest.mark.parametrize("n", [2, 3, 40])
def test_the_fastest_vibration_is_the_bars_but_for_what_the_held_ends_take(n):
    # linear elements with consistent mass, held at both ends: omega^2 = 6 (S/L)^2 (1 - cos x) / (2 + cos x) with
    # x = pi (n - 1) / n, which is 12 (S/L)^2 as x goes to pi; Bar has it to five figures
    scene = held(n)
    (found,) = vary.bars(scene)
    x = np.pi * (n - 1) / n
    expected = found.fastest * np.sqrt(0.5 * (1.0 - np.cos(x)) / (2.0 + np.cos(x)))
    assert frequencies(scene).max() == pytest.approx(expected, rel=1e-5)


def test_a_crane_that_was_varied_can_be_varied_again(scene):
    again = vary.stiffness(vary.elements(vary.shortest(scene, 10.0), 2), 3.0)
    assert again.elements == tuple(2 * n for n in vary.shortest(scene, 10.0).elements)
    assert again.rope.axial_stiffness == 3.0 * scene.rope.axial_stiffness


def test_a_scene_without_a_text_is_told_that_it_needs_one():
    scene = CraneScene.model_validate(hoist().document.root)
    with pytest.raises(SceneError, match="put together in Python cannot be changed by keys; read it from a file"):
        vary.elements(scene, 2)
