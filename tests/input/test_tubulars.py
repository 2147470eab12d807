"""The catalogue of tubulars agrees with geometry, words find one tubular or say why not, and a string weighs it."""

from itertools import groupby
from math import cos, pi, radians
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drillstring.model.build import build
from drillstring.model.prepared import tubes_of
from drillstring.scene.scene import DrillstringScene, json_schema
from drillstring.scene.tubulars import NoSuchTubular, catalogue, find, inches, matching
from drillstring.warnings import warnings
from tautline.scene.errors import SceneError

INCH, FOOT, POUND = 0.0254, 0.3048, 0.45359237
STEEL = 489.5
"""lb/ft^3, the density that API weights are computed with (RP 7G)."""
PIPES = [one for one in catalogue() if one.kind == "drill pipe"]
HEAVY = [one for one in catalogue() if one.kind == "HWDP"]
JOINT = {"NC26": 15.0, "NC31": 16.0, "NC38": 16.5, "NC40": 17.0, "NC46": 17.0, "NC50": 17.0, "5 1/2 FH": 18.0}
JOINT["6 5/8 FH"] = 19.0
"""Pin and box of new tool joints together, in, without the tapers (API Spec 7)."""
UPSET = {"NC26": 2.5625, "NC31": 3.1875, "NC38": 3.875, "NC40": 4.1875, "NC46": 4.6875, "NC50": 5.125}
UPSET |= {"5 1/2 FH": 5.6875, "6 5/8 FH": 6.9375}
"""Outside diameter of the pipe where the tool joint is welded on, in (API Spec 7)."""
CENTRE = {"3 1/2": 4.0, "4": 4.5, "4 1/2": 5.0, "5": 5.5, "6 5/8": 7.125}
"""Outside diameter of the upset in the middle of a joint of heavy weight pipe, in."""


def area(od, id):
    return pi / 4.0 * (od**2 - id**2)


@pytest.mark.parametrize("one", PIPES, ids=lambda one: one.label)
def test_a_pipe_s_published_plain_end_weight_is_that_of_its_tube_and_its_nominal_weight_a_little_more(one):
    plain = area(one.od, one.id) / FOOT**2 * STEEL
    assert one.plain_end * FOOT / POUND == pytest.approx(plain, rel=1e-3)
    assert 1.05 < one.nominal / plain < 1.15


@pytest.mark.parametrize("one", PIPES, ids=lambda one: one.label)
def test_a_pipe_weighs_what_its_tube_and_its_tool_joints_weigh_and_some_upset_metal(one):
    # API RP 7G's formula for a joint of 29.4 ft of pipe and a tool joint, in inches and pounds; what is left is the
    # metal of the upsets, 1 to 22 lb a joint
    length, upset = JOINT[one.connection], UPSET[one.connection]
    od, id = one.tool_joint_od / INCH, one.tool_joint_id / INCH
    joint = 0.222 * length * (od**2 - id**2) + 0.167 * (od**3 - upset**3) - 0.501 * id**2 * (od - upset)
    joint_length = (length + 2.253 * (od - upset)) / 12.0
    whole = one.mass_per_length * FOOT / POUND * (29.4 + joint_length)
    left = whole - joint - 29.4 * one.plain_end * FOOT / POUND
    assert 1.0 < left < 22.0


def test_pipes_of_one_size_and_weight_have_the_same_upset_metal_for_x95_and_above():
    # a slip of one digit in a weight moves this by pounds
    for _, group in groupby(PIPES, key=lambda one: (one.size, one.nominal)):
        left = []
        for one in group:
            if one.grade == "E75":
                continue
            length, upset = JOINT[one.connection], UPSET[one.connection]
            od, id = one.tool_joint_od / INCH, one.tool_joint_id / INCH
            joint = 0.222 * length * (od**2 - id**2) + 0.167 * (od**3 - upset**3) - 0.501 * id**2 * (od - upset)
            weight = one.mass_per_length * FOOT / POUND * (29.4 + (length + 2.253 * (od - upset)) / 12.0)
            left.append(weight - joint - 29.4 * one.plain_end * FOOT / POUND)
        assert not left or max(left) - min(left) < 3.0


@pytest.mark.parametrize("one", HEAVY, ids=lambda one: one.label)
def test_heavy_pipe_weighs_what_a_joint_of_31_ft_with_4_ft_of_tool_joint_and_2_ft_of_upset_does(one):
    pieces = [(25.0, one.od, one.id), (4.0, one.tool_joint_od, one.tool_joint_id)]
    pieces += [(2.0, CENTRE[one.size] * INCH, one.id)]
    weight = sum(length * area(od, id) for length, od, id in pieces) / 31.0 / FOOT**2 * STEEL
    assert one.mass_per_length * FOOT / POUND == pytest.approx(weight, rel=0.01)


@pytest.mark.parametrize(
    ("name", "kip"),
    # published tensile yields of new pipe (API RP 7G, tables 2 and 3), lbf
    [
        ("5 in 19.5 E75", 395.595),
        ("5 in 19.5 S135", 712.070),
        ("3 1/2 13.3 G105", 380.197),
        ("4 1/2 16.6 X95", 418.707),
    ],
)
def test_the_yield_load_is_the_published_one(name, kip):
    assert find(name).yield_load / 4448.2216152605 == pytest.approx(kip, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "pounds"),
    # API RP 7G, table of drill collar weights, which is rounded to whole pounds
    [("3 1/8 x 1 1/4", 22), ("6 1/2 x 2 13/16", 92), ("6 x 2 1/4", 83), ("8 x 2 13/16", 150), ("9 1/2 x 3", 217)],
)
def test_a_collar_weighs_what_the_table_of_collars_says(name, pounds):
    collar = find(f"drill collar {name}")
    assert collar.mass_per_length is None
    assert area(collar.od, collar.id) / FOOT**2 * STEEL == pytest.approx(pounds, abs=0.75)


def test_every_tubular_is_found_by_its_label_and_no_two_have_the_same():
    assert [find(one.label) for one in catalogue()] == list(catalogue())
    assert {"2 3/8", "6 5/8"} <= {one.size for one in PIPES} and {one.grade for one in PIPES} == {
        "E75",
        "X95",
        "G105",
        "S135",
    }
    assert max(inches(one.size) for one in catalogue()) == 11.0


@pytest.mark.parametrize(
    ("words", "label"),
    [
        ("5in 19.5ppf S135", "drill pipe 5 in 19.50 lb/ft S135"),
        ('5" 19.50 s-135', "drill pipe 5 in 19.50 lb/ft S135"),
        ("DP 5 19.5# grade S", "drill pipe 5 in 19.50 lb/ft S135"),
        ("5 in 19.5 lb/ft S135 NC50", "drill pipe 5 in 19.50 lb/ft S135"),
        ("5-1/2 21.9 G-105", "drill pipe 5 1/2 in 21.90 lb/ft G105"),
        ("5½ in 24.70 lb/ft X 95", "drill pipe 5 1/2 in 24.70 lb/ft X95"),
        ("5.5 in 21.9 E75", "drill pipe 5 1/2 in 21.90 lb/ft E75"),
        ("HWDP 5 in", "HWDP 5 in"),
        ("5 in heavy-weight drill pipe 49.3 lb/ft", "HWDP 5 in"),
        ("drill collar 6 1/2 x 2 13/16", "drill collar 6 1/2 x 2 13/16 in"),
        ('DC 6-1/2" × 2-13/16"', "drill collar 6 1/2 x 2 13/16 in"),
        ("collar 8 in", "drill collar 8 x 2 13/16 in"),
    ],
)
def test_a_tubular_is_found_however_it_is_spelled(words, label):
    assert find(words).label == label


@pytest.mark.parametrize(
    ("words", "cause"),
    [
        ("drill pipe 5 in 19.5", "may mean 4 tubulars: 'drill pipe 5 in 19.50 lb/ft E75', "),
        ("drill collar 6 1/2", "may mean 2 tubulars"),
        ("5 in 19.5 V150", "known grades: E75, X95, G105, S135"),
        ("5 in 22 S135", "the nearest are 'drill pipe 5 in 19.50 lb/ft S135'"),
        ("drill collar 12 x 3", "the nearest are 'drill collar 11 x 3 in'"),
        ("casing 9 5/8", "'casing' is not understood"),
        ("", "names no tubular"),
        ("1/0 in", "is not understood"),
        ("5 in 19.5 S135 3", "one number too many"),
    ],
)
def test_words_that_mean_none_or_several_are_refused_with_those_there_are(words, cause):
    with pytest.raises(NoSuchTubular) as caught:
        find(words)
    assert cause in str(caught.value)


@settings(max_examples=100, deadline=None)
@given(st.text(alphabet='0123456789 ./-x"½inlbftSEGXNCppfhwdrco#', max_size=30))
def test_any_words_are_read_or_refused_and_nothing_else(words):
    try:
        assert set(matching(words)) <= set(catalogue())
    except NoSuchTubular as none:
        assert none.cause and none.cure


SCENE = """
well: {sections: [{hold: 3000 ft}, {build: {rate: 3 deg/100ft, to: 60 deg}}, {hold: 1000 ft}], diameter: 8.5 in,
  wall: {stiffness: 1.0e8}}
string:
  - {tubular: 5 in 19.50 lb/ft S135, length: rest}
  - {tubular: HWDP 5 in, length: 500 ft}
  - {tubular: drill collar 6 1/2 x 2 13/16, length: 300 ft}
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 10 ppg}
model: {elements: 16}
solver: {step: 1 ms, end: 1 s}
output: {interval: 50 ms}
"""


def test_a_string_weighs_the_catalogue_s_weights_times_lengths_times_buoyancy():
    # by hand: lengths in ft, weights in lb/ft as the tables print them; 91.79 lb/ft is what a collar of 6 1/2 x 2 13/16
    # in weighs at 490.06 lb/ft^3, the scene's 7850 kg/m^3
    hole = 3000.0 + 60.0 / 3.0 * 100.0 + 1000.0
    pounds = (hole - 800.0) * 22.60 + 500.0 * 49.3 + 300.0 * 91.79
    buoyancy = 1.0 - 10.0 * 7.48051948 / 490.06
    model = build(DrillstringScene.parse(SCENE))
    weight = next(g for g in model.system.groups if hasattr(g, "lumps")).lumps.weight.sum()
    assert weight == pytest.approx(pounds * buoyancy * POUND * 9.81, rel=1e-3)


def test_keys_beside_the_tubular_override_it_and_a_worn_pipe_weighs_and_bears_less():
    keys = "name: worn, od: 4.9 in, tool_joint_od: 6.25 in, eccentricity: [0, 1 mm]"
    scene = DrillstringScene.parse(SCENE.replace("S135, length", f"S135, {keys}, length"))
    new, worn = find("5 in 19.5 S135"), scene.string[0]
    lost = pi / 4.0 * (5.0**2 - 4.9**2) * INCH**2
    assert (worn.name, worn.tool_joint_od) == ("worn", pytest.approx(6.25 * INCH))
    assert worn.mass_per_length == pytest.approx(new.mass_per_length - 7850.0 * lost, rel=1e-12)
    assert worn.yield_load == pytest.approx(new.yield_load - lost * new.yield_strength, rel=1e-12)
    own = DrillstringScene.parse(SCENE.replace("S135, length", "S135, mass_per_length: 30, yield_load: 1 MN, length"))
    assert (own.string[0].mass_per_length, own.string[0].yield_load) == (30.0, 1.0e6)


def test_the_second_moment_is_the_tube_s_and_the_contact_the_tool_joint_s():
    tubes = tubes_of(DrillstringScene.parse(SCENE), 3000.0)
    assert tubes[0].second_moment == pytest.approx(pi / 64.0 * (5.0**4 - 4.276**4) * INCH**4, rel=1e-12)
    assert tubes[0].contact_od == pytest.approx(6.625 * INCH) and tubes[2].contact_od == pytest.approx(6.5 * INCH)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "19.50 lb/ft S135",
            "19.50 lb/ft S150",
            "scene.yaml:5: string[0].tubular = 5 in 19.50 lb/ft S150: 'S150' is no",
        ),
        ("19.50 lb/ft S135", "19.50 lb/ft", "scene.yaml:5: string[0].tubular = 5 in 19.50 lb/ft: may mean 4 tubulars"),
        ("HWDP 5 in", "HWDP 7 in", "scene.yaml:6: string[1].tubular = HWDP 7 in: is not in the catalogue"),
        ("tubular: HWDP 5 in", "tubular: 5", "scene.yaml:6: string[1].tubular = 5: must be a text"),
        ("tubular: HWDP 5 in", "tubular: null", "scene.yaml:6: string[1].tubular = null: is empty"),
        ("HWDP 5 in,", "HWDP 5 in, od: -1 in,", "string[1].od = -1 in: must be greater than zero"),
        ("HWDP 5 in,", "HWDP 5 in, od: 2 in,", "is smaller than the id of the tubular, 3 in (0.0762 m)"),
        ("HWDP 5 in,", "HWDP 5 in, yield_load: 5 in,", "'in' is not the unit of a force"),
        ("HWDP 5 in,", "HWDP 5 in, id: 5.5 in,", "id = 5.5 in: leaves no wall: the od of the tubular is 5 in"),
        ("HWDP 5 in,", "HWDP 5 in, tool_joint_od: 4 in,", "smaller than the od of the tubular, 5 in (0.127 m)"),
        ("HWDP 5 in,", "HWDP 5 in, od: 7 in,", "string[1].od = 7 in: wider than the tool joint of the tubular, 6.5 in"),
        ("diameter: 8.5 in", "diameter: 6 in", "does not fit into the hole (well.diameter = 6 in, line "),
    ],
)
def test_a_wrong_tubular_is_refused_with_line_key_and_cure(old, new, message):
    with pytest.raises(SceneError) as caught:
        DrillstringScene.parse(SCENE.replace(old, new, 1))
    assert message in str(caught.value) and "; " in str(caught.value)


@pytest.mark.parametrize(("blades", "cause"), [("8.5 in", "exactly as wide, does not fit"), ("9 in", "does not fit")])
def test_a_collar_of_the_catalogue_with_blades_as_wide_as_the_hole_is_refused_by_what_was_written(blades, cause):
    stabiliser = f"tubular: drill collar 6 1/2 x 2 13/16, tool_joint_od: {blades}"
    with pytest.raises(SceneError) as caught:
        DrillstringScene.parse(SCENE.replace("tubular: HWDP 5 in", stabiliser, 1))
    told = f"string[1].tool_joint_od = {blades}: {cause} into the hole (well.diameter = 8.5 in, line "
    assert told in str(caught.value)


def test_a_string_near_its_yield_load_at_rest_is_warned_of():
    hole, mud = SCENE.replace("hold: 3000 ft", "hold: 16000 ft"), 10.0
    strong = [c.where for c in warnings(DrillstringScene.parse(hole))]
    weak = [c for c in warnings(DrillstringScene.parse(hole.replace("S135", "E75"))) if "yield_load" in c.where]
    # by hand: weight in mud times depth under it; the arc's depth is R sin(60 deg)
    arc = 100.0 / radians(3.0)
    depth = 16000.0 + arc * np.sin(radians(60.0)) + 1000.0 * cos(radians(60.0))
    lower = (500.0 * 49.3 + 300.0 * 91.79) * cos(radians(60.0))
    carried = ((depth - 800.0 * cos(radians(60.0))) * 20.89 + lower) * (1.0 - mud * 7.48051948 / 490.06)
    share = 100.0 * carried / 395.6e3
    assert "string[0].yield_load" not in strong
    assert [c.where for c in weak] == ["string[0].yield_load"]
    told = float(weak[0].text.split(" % of")[0].split()[-1])
    assert told == pytest.approx(share, abs=0.6) and share > 80.0


def test_the_schema_takes_a_tubular_in_place_of_diameters():
    section = json_schema()["$defs"]["Section"]
    assert ["tubular", "length"] in [choice["required"] for choice in section["anyOf"]]
    assert "yield_load" in section["properties"]


def test_the_strings_of_the_page_are_strings():
    page = (Path(__file__).parents[2] / "docs" / "drillstring.md").read_text(encoding="utf8")
    example = page[page.index("```yaml\nstring:") :].split("```")[1].removeprefix("yaml\n")
    scene = DrillstringScene.parse(SCENE[: SCENE.index("string:")] + example + SCENE[SCENE.index("material:") :])
    worn, blades = scene.string[1], scene.string[4]
    # the premium class of new 5 in 19.50 pipe: OD 4.855 in, tensile yield 560.76 kip (API RP 7G, table 4)
    assert worn.yield_load / 4448.2216152605 == pytest.approx(560.76, rel=1e-3)
    assert (blades.name, blades.contact_diameter) == ("stabiliser", pytest.approx(8.375 * INCH))
