"""Varied drill strings: what a study changes of a scene is changed, and nothing else is."""

import copy
from pathlib import Path

import numpy as np
import pytest
import yaml
from physics.wells.strings import DENSITY, Balance, E, area, mass_per_length, shipped, straight_hole
from scipy.linalg import eigh

from drillstring.groups.contact import WallContact
from drillstring.model import variations as vary
from drillstring.model.build import build
from drillstring.scene.scene import DrillstringScene
from drillstring.string.lumps import cut
from tautline.integrators.linearise import matrices
from tautline.integrators.state import new_state
from tautline.integrators.vibration.modes import modes
from tautline.lumped.bend import Bends
from tautline.lumped.body import Bodies, EccentricBodies
from tautline.lumped.link import Links
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[3] / "data"
SHIPPED = sorted(path.stem for path in DATA.glob("*.yaml") if "well" in yaml.safe_load(path.read_text(encoding="utf8")))

PIPE = {"name": "drill pipe", "od": "5 in", "id": 0.1086}
COLLAR = {"name": "collar", "length": "120 m", "od": 0.165, "id": 0.0572}
STRINGS = {
    "some sections with their own number": [
        PIPE | {"length": 2000.0, "elements": 5},
        {"name": "heavy pipe", "length": "rest", "od": 0.14, "id": 0.09},
        COLLAR | {"elements": 2},
    ],
    "all sections with their own number, the last the rest": [
        PIPE | {"length": 1000.0, "elements": 3},
        COLLAR | {"elements": 1},
        {"name": "rest", "length": "rest", "od": 0.14, "id": 0.09, "elements": 8},
    ],
    "tool joints, given masses and moduli, off the centre": [
        PIPE | {"length": "rest", "tool_joint_od": 0.168, "mass_per_length": "31.9 kg/m", "second_moment": 6.0e-6},
        COLLAR | {"youngs_modulus": "206 GPa", "shear_modulus": 8.0e10, "density": 8000.0, "eccentricity": [0.003, 0]},
    ],
    "a string shorter than its hole": [PIPE | {"length": 2900.0}, COLLAR | {"length": 130.0}],
}
ALIASES = """
string:
  - &pipe {name: pipe, length: 800 m, od: 0.127, id: 0.1086}
  - {name: rest, length: rest, od: 0.14, id: 0.09}
  - *pipe
"""


def with_string(sections):
    """The J-well with another string."""
    return shipped("jwell", string=sections)


SCENES = (
    {name: lambda name=name: shipped(name) for name in SHIPPED}
    | {name: lambda sections=sections: with_string(sections) for name, sections in STRINGS.items()}
    | {"sections that are aliases": lambda: with_string(aliased())}
)


def aliased():
    """Two sections that are one object, as YAML's aliases make them."""
    from tautline.scene.reading.document import Document

    sections = Document.parse(ALIASES).root["string"]
    assert sections[0] is sections[2]
    return sections


@pytest.fixture(params=SCENES)
def scene(request):
    """A scene, which must stand as it did after the test."""
    made = SCENES[request.param]()
    before = made.model_dump(), copy.deepcopy(made.document.root)
    yield made
    assert (made.model_dump(), made.document.root) == before


def lumps(scene):
    links = vary.links_of(scene)
    return cut([tube for tube, _ in links], scene.model.elements)


def counts(scene):
    return [count for _, count in vary.links_of(scene)]


def of_kind(scene, *kinds):
    return next(group for group in build(scene).system.groups if isinstance(group, kinds))


def weighs(scene):
    return lumps(scene).of_lumps(lambda tube: tube.mass_per_length).sum()


def axial(scene):
    """Angular frequencies along the hole at rest, ascending, rad/s."""
    balance = Balance(scene)
    mass, _, stiffness = matrices(balance.model.system, balance.state)
    rows = np.ix_(*[balance.rows("along the hole")] * 2)
    return np.sqrt(eigh(stiffness[rows], mass[rows], eigvals_only=True))


# the mesh
@pytest.mark.parametrize("factor", [2, 3, 2.5])
def test_each_section_has_so_many_times_its_links_and_length_and_mass_of_the_string_stay(scene, factor):
    varied = vary.elements(scene, factor)
    assert counts(varied) == [int(count * factor + 0.5) for count in counts(scene)]
    assert varied.model.elements == sum(counts(varied))
    assert lumps(varied).total == pytest.approx(lumps(scene).total, rel=1e-14)
    assert weighs(varied) == pytest.approx(weighs(scene), rel=1e-13)
    build(varied)


def test_twice_the_links_divide_the_string_where_it_was_divided(scene):
    fine, coarse = (lumps(made).measured_depth for made in (vary.elements(scene, 2), scene))
    assert fine[::2] == pytest.approx(coarse, abs=1e-9)


def test_twice_the_links_and_then_half_of_them_are_the_links_again(scene):
    again = vary.elements(vary.elements(scene, 2), 0.5)
    assert counts(again) == counts(scene)
    assert np.array_equal(lumps(again).measured_depth, lumps(scene).measured_depth)


def test_half_the_links_leave_at_least_one_of_every_section():
    scene = with_string(STRINGS["all sections with their own number, the last the rest"])
    assert counts(scene) == [3, 1, 8]
    assert counts(vary.elements(scene, 0.5)) == [2, 1, 4]
    assert counts(vary.elements(scene, 0.01)) == [1, 1, 1]


def test_nothing_is_left_to_halve_of_a_single_link():
    assert vary.elements(straight_hole(0.0), 0.5) is None


def test_more_links_than_a_string_may_have_are_refused_by_name():
    with pytest.raises(SceneError, match=r"study: model\.elements = 120000: must be at most 100000"):
        vary.elements(shipped("jwell"), 1e4)


def test_the_stretch_of_a_hanging_string_is_exact_on_every_mesh_of_it():
    # Table 2.3's string stretches by 0.376529 m whatever the number of elements (docs/lumped_string.md)
    scene = shipped("hanging")
    for factor in (0.5, 2, 4):
        balance = Balance(vary.elements(scene, factor))
        stretch = balance["position"][-1, 2] - balance.unstretched_depth[-1]
        assert stretch == pytest.approx(0.376529, abs=1e-6)


# stiffness
def test_all_springs_of_the_string_are_so_many_times_as_stiff_and_as_heavy_as_before(scene):
    varied = vary.stiffness(scene, 7.0)
    for name in ("axial", "torsional"):
        before, after = (of_kind(made, Links).springs[name] for made in (scene, varied))
        assert after == pytest.approx(7.0 * before, rel=1e-14)
    before, after = (of_kind(made, Bends).stiffness for made in (scene, varied))
    assert after == pytest.approx(7.0 * before, rel=1e-14)
    before, after = (of_kind(made, Bodies, EccentricBodies).lumps for made in (scene, varied))
    assert before.tobytes() == after.tobytes()
    assert of_kind(varied, Links).damping == of_kind(scene, Links).damping
    assert np.array_equal(lumps(varied).measured_depth, lumps(scene).measured_depth)


@pytest.mark.parametrize("factor", [0.01, 4.0])
def test_frequencies_along_the_string_go_with_the_root_of_its_stiffness(factor):
    scene = straight_hole(0.0, elements=8, well__wall="none")
    assert axial(vary.stiffness(scene, factor)) == pytest.approx(np.sqrt(factor) * axial(scene), rel=1e-6)


# what it touches
def test_the_wall_is_as_stiff_as_it_is_told_and_free_space_has_none(scene):
    varied = vary.contact(scene, 3.0e7)
    if scene.well.wall is None:
        assert varied is None and vary.stiffnesses(scene) == {"contact": None, "penalty": None}
        return
    assert vary.stiffnesses(varied) == {"contact": 3.0e7, "penalty": None}
    before, after = (of_kind(made, WallContact).springs for made in (scene, varied))
    assert after.stiffness * vary.stiffnesses(scene)["contact"] == pytest.approx(3.0e7 * before.stiffness, rel=1e-14)
    assert np.array_equal(after.damping, before.damping)


def test_a_string_has_no_constraints_to_impose_in_another_way(scene):
    assert vary.constraints(scene) == ()
    assert vary.constraint(scene, "lagrange") is None and vary.penalty(scene, 1e9) is None


# a sliver
@pytest.mark.parametrize("factor", [2.0, 100.0])
def test_one_link_is_so_many_times_shorter_than_the_shortest_and_the_others_stay(scene, factor):
    varied = vary.shortest(scene, factor)
    before, after = lumps(scene), lumps(varied)
    sliver = before.length.min() / factor
    assert after.length[-1] == pytest.approx(sliver, rel=1e-12)
    n = counts(scene)[-1]
    last = before.length[-1] - sliver / n
    assert after.length[:-1] == pytest.approx(np.append(before.length[:-n], [last] * n), rel=1e-12)
    assert after.total == pytest.approx(before.total, rel=1e-14)
    assert weighs(varied) == pytest.approx(weighs(scene), rel=1e-13)
    *_, above, end = (tube for tube, _ in vary.links_of(varied))
    same = ("od", "id", "contact_od", "youngs_modulus", "shear_modulus", "density", "mass_per_length", "eccentricity")
    assert [getattr(end, key) for key in same] == [getattr(above, key) for key in same]
    build(varied)


def test_a_string_that_was_varied_can_be_varied_again(scene):
    again = vary.stiffness(vary.elements(vary.shortest(scene, 10.0), 2), 3.0)
    sliver = lumps(scene).length.min() / 20.0
    assert lumps(again).length[-2:] == pytest.approx([sliver, sliver], rel=1e-12)
    assert again.material.youngs_modulus == 3.0 * scene.material.youngs_modulus


def test_a_piece_longer_than_the_last_section_is_refused_by_name():
    with pytest.raises(SceneError, match=r"study: string\[\d\]\.length"):
        vary.shortest(with_string(STRINGS["a string shorter than its hole"]), 0.1)


# bars
def test_every_unlike_link_is_a_bar_of_its_length_and_speed_of_sound(scene):
    bars = vary.bars(scene)
    links = vary.links_of(scene)
    assert {round(bar.length, 9) for bar in bars} == {round(tube.length / count, 9) for tube, count in links}
    for bar in bars:
        tube = next(tube for tube, _ in links if bar.name.startswith(f"{tube.name}, element of "))
        assert bar.speed**2 * tube.mass_per_length == pytest.approx(tube.youngs_modulus * tube.area, rel=1e-12)
        assert bar.shape == "lumped"
    assert [bar.free_end for bar in bars] == [False] * (len(bars) - 1) + [True]


def test_the_speed_of_sound_in_a_plain_tube_is_that_of_steel():
    (bar,) = vary.bars(straight_hole(0.0))
    assert bar.name == "collar, element of 100 m at the lower end"
    assert bar.speed == pytest.approx(np.sqrt(E * area(0.165, 0.0572) / mass_per_length()), rel=1e-12)
    assert bar.speed == pytest.approx(np.sqrt(E / DENSITY), rel=1e-12)


@pytest.mark.parametrize("n", [1, 2, 12])
def test_the_fastest_vibration_is_the_bars_but_for_what_the_held_upper_end_takes(n):
    # n equal masses and springs, the last mass halved, held at the other end: omega = 2 S / L_e cos(pi / 4n)
    scene = straight_hole(0.0, elements=n, well__wall="none")
    bar = vary.bars(scene)[-1]
    model = build(scene)
    found = modes(model.system, new_state(model.system)).omega.max()
    assert found == pytest.approx(bar.fastest * np.cos(np.pi / (4 * n)), rel=1e-6)


def test_a_scene_without_a_text_is_told_that_it_needs_one():
    scene = DrillstringScene.model_validate(shipped("jwell").document.root)
    with pytest.raises(SceneError, match="put together in Python cannot be changed by keys; read it from a file"):
        vary.elements(scene, 2)
