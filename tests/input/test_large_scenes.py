"""Large scenes: what reading and building them takes grows with their rows and elements, and no faster.

Nothing is timed. Calls of functions are counted, those of Python and those of compiled modules.
"""

import itertools
import math
import random
import sys
from fractions import Fraction

import numpy as np
import pytest

from drillstring.application import Drillstring
from drillstring.scene.hole import Build, Well
from drillstring.string.lumps import Tube, cut, share_elements
from gardenhose.application import Gardenhose
from tautline.application.installed import Installed
from tautline.cable.application import Cable
from tautline.cable.input import material
from tautline.kernels.dofs import HELD, TIED
from tautline.scene.reading import files
from tautline.scene.reading.document import Document
from tautline.scene.values.units import TABLE
from tautline.system.masters import Masters
from tautline.system.pattern import pattern_of

REST = """  diameter: 0.2
  wall: {stiffness: 1.0e9, friction: 0.2}
string: [{name: pipe, length: rest, od: 0.127, id: 0.1086}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {kind: lumped, elements: %d}
solver: {method: generalized-alpha, step: 1 ms, end: 10 ms}
output: {interval: 10 ms}
"""
SOLVER = "GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.01, time_end: 0.1}\n"
MATERIAL = "CableModelMaterial: {Gravity: [0, 0, -9.81], CableStiffness: 1.0e6, CableMass: 1.0}\n"


def calls(work):
    """How many functions are called."""
    count = itertools.count()

    def note(frame, event, argument):
        if event in ("call", "c_call"):
            next(count)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    return next(count)


def by_survey(folder, rows):
    place = folder / f"{rows}"
    place.mkdir()
    lines = [f"{2000 * i / rows},{60 * i / rows},{30 + 40 * i / rows}" for i in range(rows + 1)]
    (place / "s.csv").write_text("\n".join(["md [m],inc [deg],azi [deg]", *lines]))
    (place / "scene.yaml").write_text(f"well:\n  survey: s.csv\n{REST % 12}")
    return place / "scene.yaml"


def by_sections(folder, rows):
    pairs = []
    for i in range(1, rows // 2 + 1):
        pairs.append(f"    - {{build: {{radius: 1500 m, to: {5 + 60 * i / rows} deg}}}}")
        pairs.append(f"    - {{turn: {{radius: 1500 m, to: {i / rows}}}}}")
    sections = "\n".join(["    - {hold: 600 m}", "    - {build: {radius: 1500 m, to: 5 deg}}", *pairs])
    path = folder / f"{rows}.yaml"
    path.write_text(f"well:\n  sections:\n{sections}\n{REST % 12}")
    return path


def by_elements(folder, elements):
    path = folder / f"{elements}.yaml"
    path.write_text(f"well:\n  sections: [{{hold: 2000 m}}]\n{REST % elements}")
    return path


def by_length(folder, elements):
    path = folder / f"{elements}.yaml"
    path.write_text(f"""hose:
  {{length: 1000, elements: {elements}, axial_stiffness: 1.0e6, bending_stiffness: 100, mass_per_length: 2}}
water: {{mass_per_length: 1.0, speed: 1.0}}
gravity: [0, 0, 0]
solver: {{method: generalized-alpha, step: 1 ms, end: 10 ms}}
output: {{interval: 10 ms}}
""")
    return path


def by_spans(folder, spans):
    """Spans of rope, each of one element, tied end to end: their coordinates follow from one another."""
    items = []
    for i in range(spans):
        held = "1, 1, 1" if i in (0, spans - 1) else "0, 0, 0"
        items += [
            f"  - Node7Dof: {{id: {2 * i}, xyz: [{i}, 0, 0], BC: [{held}, 0, 0, 0, 1]}}",
            f"  - Node7Dof: {{id: {2 * i + 1}, xyz: [{i + 1}, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1]}}",
            f"  - CableALEelement: {{id: {i}, nodes7: [{2 * i}, {2 * i + 1}]}}",
        ]
        items += [f"  - LagMultipl7: {{id: {i}, nodes7: [{2 * i - 1}, {2 * i}], constr: 0}}"] if i else []
    path = folder / f"{spans}.yaml"
    path.write_text("\n".join([f"{MATERIAL}CableModel:", *items, SOLVER]))
    return path


@pytest.mark.parametrize(
    ("application", "make", "size"),
    [
        (Drillstring, by_survey, 1000), (Drillstring, by_sections, 500), (Drillstring, by_elements, 2000),
        (Gardenhose, by_length, 4000), (Cable, by_spans, 100),
    ],
)  # fmt: skip
def test_reading_checking_and_building_takes_at_most_in_proportion_to(application, make, size, tmp_path):
    def work(path):
        one = application()
        scene = one.read(path)
        one.warnings(scene)
        one.build(scene)

    work(make(tmp_path, size // 20))  # imports, and what is made once
    paths = [make(tmp_path, n) for n in (size, 2 * size)]
    once, twice = (calls(lambda path=path: work(path)) for path in paths)
    assert size < once < twice < 2.05 * once


def test_a_command_reads_the_file_of_a_scene_once(tmp_path, monkeypatch):
    read = []
    plain = Document.parse.__func__

    def parse(cls, text, path="scene.yaml", home=None):
        read.append(path)
        return plain(cls, text, path, home)

    monkeypatch.setattr(Document, "parse", classmethod(parse))
    application, scene = Installed().read(by_spans(tmp_path, 3))
    application.warnings(scene)
    assert len(read) == 1


def test_coordinates_of_a_cable_are_found_once_and_the_copies_are_the_callers_own(tmp_path, monkeypatch):
    found = []
    plain = material._found
    monkeypatch.setattr(material, "_found", lambda scene: found.append(scene) or plain(scene))
    scene = Cable().read(by_spans(tmp_path, 3))
    Cable().warnings(scene)
    material.material_coordinates(scene)[0] = 99.0
    assert material.material_coordinates(scene)[0] == 0.0
    assert len(found) == 1
    Cable().read(by_spans(tmp_path, 4))
    assert len(found) == 2


def test_chains_take_their_coordinates_from_those_that_are_known_before_any_begins_anew(tmp_path):
    """The third span gives p, the second is tied to it, the first only to the second; the fourth to none."""
    text = f"""{MATERIAL}CableModel:
  - Node7Dof: {{id: 0, xyz: [0, 0, 0]}}
  - Node7Dof: {{id: 1, xyz: [1, 0, 0]}}
  - Node7Dof: {{id: 2, xyz: [1, 0, 0]}}
  - Node7Dof: {{id: 3, xyz: [2, 0, 0]}}
  - Node7Dof: {{id: 4, xyz: [2, 0, 0], p: 7.0}}
  - Node7Dof: {{id: 5, xyz: [3, 0, 0]}}
  - Node7Dof: {{id: 6, xyz: [0, 5, 0]}}
  - Node7Dof: {{id: 7, xyz: [1, 5, 0]}}
  - CableALEelement: {{id: 0, nodes7: [0, 1]}}
  - CableALEelement: {{id: 1, nodes7: [2, 3]}}
  - CableALEelement: {{id: 2, nodes7: [4, 5]}}
  - CableALEelement: {{id: 3, nodes7: [6, 7]}}
  - LagMultipl7: {{id: 0, nodes7: [1, 2], constr: 0}}
  - LagMultipl7: {{id: 1, nodes7: [3, 4], constr: 0}}
{SOLVER}"""
    (tmp_path / "scene.yaml").write_text(text)
    found = material.material_coordinates(Cable().read(tmp_path / "scene.yaml"))
    assert found == {0: 5.0, 1: 6.0, 2: 6.0, 3: 7.0, 4: 7.0, 5: 8.0, 6: 0.0, 7: 1.0}


def test_elements_go_where_they_are_longest_as_a_search_through_all_sections_finds():
    chance = random.Random(5)
    for _ in range(30):
        tubes = []
        for k in range(chance.randint(1, 9)):
            length, own = chance.choice([10.0, 20.0, chance.uniform(1, 900)]), chance.choice([None, None, 3])
            tubes.append(Tube(f"{k}", length, 0.1, 0.05, 0.1, 2e11, 8e10, 7850, 30, 1e-5, elements=own))
        counts = [tube.elements or 1 for tube in tubes]
        free = [k for k, tube in enumerate(tubes) if tube.elements is None]
        total = sum(counts) + (chance.randint(0, 60) if free else 0)
        asked = list(counts)
        for _ in range(total - sum(counts)):
            counts[max(free, key=lambda k: tubes[k].length / counts[k])] += 1
        assert share_elements(tubes, total) == counts
        lumps = cut(tubes, total)
        halves = np.zeros_like(lumps.halves)
        for i, k in enumerate(lumps.section):
            halves[i : i + 2, k] += 0.5 * tubes[k].length / counts[k]
        assert np.array_equal(lumps.halves, halves) and sum(asked) <= total


@pytest.mark.parametrize("most", [0, 10**9])
def test_a_pattern_holds_every_pair_that_a_stencil_couples_whether_it_is_sorted_or_marked(most, monkeypatch):
    monkeypatch.setattr("tautline.system.pattern.MOST_MARKS", most)
    rng = np.random.default_rng(2)
    number = np.array([0, 1, -1, 2, 3, -1, 4, 5, 6, 7])
    masters = Masters.of(number, [5], {2: [(1, 0.5), (-6, 1.0), (4, -1.0)]})
    stencils = [rng.integers(0, 10, (7, k)) for k in (1, 2, 4)] + [np.zeros((0, 3), int)]
    wanted = np.eye(8, dtype=int)
    for row in (row for stencil in stencils for row in stencil):
        unknowns = [k for i in row for k in masters.unknown[masters.start[i] : masters.start[i + 1]] if k >= 0]
        wanted[np.ix_(unknowns, unknowns)] = 1
    pattern = pattern_of(masters, 8, stencils)
    assert np.array_equal(pattern.toarray(), wanted) and len(pattern.row) == wanted.sum()
    assert np.all(np.diff(pattern.row * 8 + pattern.column) > 0)


def test_stencils_of_one_row_each_have_all_masters_looked_through_as_often_as_one_stencil_of_all_rows(monkeypatch):
    """A tie brings such a stencil, and a rope in pieces has thousands: each looked through all masters."""
    asked = []
    looked = Masters.is_single.fget
    monkeypatch.setattr(Masters, "is_single", property(lambda masters: asked.append(0) or looked(masters)))
    rows = np.arange(3000).reshape(-1, 2)
    patterns, counts = [], []
    for stencils in ([rows], [row[None, :] for row in rows]):
        patterns.append(pattern_of(Masters.of(np.arange(3000), [], {}), 3000, stencils))
        counts.append(len(asked))
        asked.clear()
    assert counts == [1, 1]
    assert np.array_equal(patterns[0].row, patterns[1].row) and np.array_equal(patterns[0].column, patterns[1].column)


def test_masters_mark_what_is_one_unknown_what_is_held_and_what_is_tied():
    number = np.array([0, -1, -1, 1, -1, -1, -1])
    tied = {2: [(0, 0.5), (-5, 1.0)], 5: [(1, 1.0)], 6: [(-5, 2.0)], 1: []}
    masters = Masters.of(number, [4, 1], tied)
    assert masters.start.tolist() == [0, 1, 1, 3, 4, 4, 5, 6]
    assert masters.unknown.tolist() == [0, 0, -5, 1, 1, -5]
    assert masters.marks(np.array([1, 0])).tolist() == [1, HELD, TIED, 0, HELD, 0, HELD]
    assert masters.ranked(np.array([1, 0])).tolist() == [1, 1, -5, 0, 0, -5]
    assert masters.is_free.tolist() == [True, False, True, True, False, True, False]
    assert masters.is_carried.tolist() == [False, False, True, False, False, False, True]


def test_files_are_not_sought_in_sections_which_can_name_none_and_are_found_in_a_survey():
    assert files._worth_a_look(Build) == ()
    assert [name for name, _ in files._worth_a_look(Well)] == ["sections", "survey", "wall"]
    well = Well.model_validate({"survey": {"file": "a.csv"}, "diameter": 0.2, "wall": "none"})
    assert list(files.files_of(well)) == ["a.csv"]


def test_numbers_with_units_are_rounded_once_as_a_reduced_fraction_is():
    chance = random.Random(3)
    for unit in TABLE.values():
        for _ in range(20):
            text = f"{chance.uniform(-9, 9):.{chance.randint(0, 17)}f}e{chance.randint(-20, 20)}"
            exact = float(Fraction(text) * unit.factor)
            assert unit.si(Fraction(text)) == (exact * math.pi**unit.turns if unit.turns else exact)
