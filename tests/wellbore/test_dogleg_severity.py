"""What `check` says of a hole and its string: dogleg severity, mud and weights, against closed forms."""

import math
from pathlib import Path

import numpy as np
import pytest

from drillstring.scene.scene import DrillstringScene
from drillstring.warnings import describe, figures, sharpest, warnings
from drillstring.well import wellbore
from tautline.scene.errors import SceneError

JWELL = (Path(__file__).parents[2] / "data" / "jwell.yaml").read_text(encoding="utf8")
OD, ID, STEEL, MUD, GRAVITY = 0.127, 0.1086, 7850.0, 1200.0, 9.81
PLAIN = f"""
well: {{sections: [{{hold: 1000 m}}], diameter: 0.2, wall: {{stiffness: 1.0e7}}}}
string: [{{name: pipe, length: rest, od: {OD}, id: {ID}}}]
material: {{youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: {STEEL}}}
mud: {{density: {MUD}}}
model: {{kind: lumped, elements: 12}}
solver: {{method: generalized-alpha, step: 1 ms, end: 1 s}}
output: {{interval: 50 ms}}
"""


def scene_of(*edits):
    text = PLAIN
    for old, new in edits:
        assert old in text
        text = text.replace(old, new, 1)
    return DrillstringScene.parse(text)


def told(scene):
    return dict(describe(figures(scene)))


@pytest.mark.parametrize("radius", [150.0, 286.479, 1000.0])
def test_the_dogleg_severity_of_stations_on_a_circle_in_a_tilted_plane_is_one_over_its_radius(radius):
    one = np.array([math.sin(0.4), 0.0, math.cos(0.4)])
    other = np.array([0.0, 1.0, 0.0]) * math.cos(0.3) + np.cross(one, [0.0, 1.0, 0.0]) * math.sin(0.3)
    turned = np.linspace(0.0, 1.2, 9)
    tangents = np.cos(turned)[:, None] * one + np.sin(turned)[:, None] * other
    straight = np.array([0.0, 200.0, 400.0])
    md = np.r_[straight, 400.0 + radius * turned[1:]]
    tangents = np.vstack([np.tile(tangents[0], (3, 1)), tangents[1:]])
    well = wellbore.from_survey(md, np.arccos(tangents[:, 2]), np.arctan2(tangents[:, 1], tangents[:, 0]))
    severity, begin, end = sharpest(well)
    assert severity == pytest.approx(1.0 / radius, rel=1e-9)
    assert (begin, end) == (pytest.approx(400.0), pytest.approx(400.0 + radius * turned[-1]))


@pytest.mark.parametrize(
    ("rate", "units", "said", "warned"),
    [
        ("3 deg/30m", "si", "3 deg/30 m from 1000 m to 1600 m", False),
        ("3 deg/30m", "field", "3.05 deg/100 ft from 3281 ft to 5249 ft", False),
        ("12 deg/30m", "si", "12 deg/30 m from 1000 m to 1150 m", True),
    ],
)
def test_check_tells_the_largest_dogleg_severity_and_warns_above_ten_degrees(rate, units, said, warned):
    arc = f"{{hold: 1000 m}}, {{build: {{rate: {rate}, to: 60 deg}}}}"
    scene = scene_of(("{hold: 1000 m}", arc), ("\nwell", f"\nunits: {units}\nwell"))
    assert told(scene)["largest dogleg severity"] == said
    texts = [one.text for one in warnings(scene) if one.where == "well.sections"]
    assert len(texts) == warned and all("12 deg/30 m at 1000 to 1150 m" in text for text in texts)


@pytest.mark.parametrize(("inclination", "warned"), [(180, True), (100, True), (91, False), (89, False), (0, False)])
def test_check_warns_of_a_hole_that_goes_up_above_the_table_and_tells_how_far(inclination, warned):
    scene = scene_of(("{sections", f"{{inclination: {inclination} deg, sections"))
    texts = [one.text for one in warnings(scene) if one.where == "well.sections"]
    assert len(texts) == warned
    height = f"{-1000.0 * math.cos(math.radians(inclination)):.4g} m above the rotary table, at 1000 m along it"
    assert all(height in text and "0 deg is down" in text for text in texts)


def test_a_short_arc_between_long_sections_is_not_passed_over():
    pieces = "{hold: 5000 m}, {build: {radius: 100 m, to: 0.5 deg}}, {hold: 5000 m}"
    severity, begin, end = sharpest(
        wellbore.from_sections(
            [wellbore.Hold(5000.0), wellbore.Build(100.0, math.radians(0.5), 0.0), wellbore.Hold(5000.0)]
        )
    )
    assert severity == pytest.approx(0.01) and end - begin == pytest.approx(100.0 * math.radians(0.5))
    assert "17.2 deg/30 m" in told(scene_of(("{hold: 1000 m}", pieces)))["largest dogleg severity"]


def test_check_tells_the_weight_in_mud_and_the_hook_load_at_rest_of_a_vertical_string_by_its_buoyancy_factor():
    weight = GRAVITY * STEEL * math.pi / 4.0 * (OD**2 - ID**2) * 1000.0
    found = figures(scene_of())["string"]
    assert found["buoyed_weight"] == pytest.approx(weight * (1.0 - MUD / STEEL), rel=1e-9)
    assert found["hook_load_at_rest"] == pytest.approx(found["buoyed_weight"], rel=1e-9)
    assert "mud" not in told(scene_of())


def test_check_says_that_a_string_without_mud_hangs_in_air():
    dry = scene_of((f"mud: {{density: {MUD}}}\n", ""))
    assert told(dry)["mud"] == "none: the string hangs in air"
    weight = GRAVITY * STEEL * math.pi / 4.0 * (OD**2 - ID**2) * 1000.0
    assert figures(dry)["string"]["buoyed_weight"] == pytest.approx(weight, rel=1e-9)
    assert "weight of the string" in told(dry)


def test_the_hook_load_at_rest_of_a_deviated_string_is_its_weight_over_the_vertical_depth():
    found = figures(DrillstringScene.parse(JWELL))
    # 2200 m of hold and a quarter of a circle of radius 1000 m: the pipe over 3200 m of depth but for the collars
    pipe, collar = (math.pi / 4.0 * (a**2 - b**2) for a, b in ((0.127, 0.1086), (0.165, 0.0572)))
    depth = 2200.0 + 1000.0 * math.sin((found["well"]["length"] - 240.0 - 2200.0) / 1000.0)
    weight = (pipe * depth + collar * (3200.0 - depth)) * GRAVITY * (7850.0 - 1840.0)
    assert found["string"]["hook_load_at_rest"] == pytest.approx(weight, rel=1e-6)


@pytest.mark.parametrize(("written", "key"), [("rate: 12 deg/30m", "rate"), ("radius: 143 m", "radius")])
def test_the_warning_of_a_sharp_bend_names_the_key_that_stands_in_its_section(written, key):
    gentle = "{build: {KEY, to: 60 deg}}".replace("KEY", "radius: 800 m" if key == "rate" else "rate: 2 deg/30m")
    arcs = f"{{hold: 1000 m}}, {gentle}, {{build: {{{written}, to: 90 deg}}}}"
    (text,) = [one.text for one in warnings(scene_of(("{hold: 1000 m}", arcs))) if one.where == "well.sections"]
    assert text.endswith(f"check the {key}")


REFUSED = [
    ("rate: 3", "si", "5.16e+03 deg/30 m, a radius of 0.3333 m", "859 deg/30 m", "3 deg/30m"),
    ("rate: 3", "field", "deg/100 ft, a radius of 1.094 ft", "873 deg/100 ft", "3 deg/100ft"),
    ("radius: 1.9 m", "si", "905 deg/30 m, a radius of 1.9 m", "859 deg/30 m", "570 m"),
    ("radius: 1.9 m", "field", "deg/100 ft, a radius of 6.234 ft", "873 deg/100 ft", "1870 ft"),
]


@pytest.mark.parametrize(("written", "units", "bend", "most", "usual"), REFUSED)
@pytest.mark.parametrize("kind", ["build", "turn"])
def test_a_section_that_bends_as_no_well_does_is_refused_by_its_key_in_the_units_of_the_scene(
    written, units, bend, most, usual, kind
):
    arcs = f"{{hold: 1000 m}}, {{build: {{radius: 500 m, to: 20 deg}}}}, {{{kind}: {{{written}, to: 60 deg}}}}"
    with pytest.raises(SceneError) as caught:
        warnings(scene_of(("{hold: 1000 m}", arcs), ("\nwell", f"\nunits: {units}\nwell")))
    (problem,) = caught.value.problems
    assert problem.key == f"well.sections[2].{kind}.{written.split(':')[0]}" and problem.line
    assert bend in problem.cause and most in problem.cause and problem.cure.endswith(f"such as {usual}")


def short_radius(folder, written):
    """A scene of a 4.75 in hole, 1000 m down and then level along an arc of 12 m, and its file."""
    (folder / "s.csv").write_text(SHORT_RADIUS, encoding="utf8")
    pipe = (PLAIN.replace(str(OD), "2.875 in").replace(str(ID), "2.323 in")).replace(
        "diameter: 0.2", "diameter: 4.75 in"
    )
    path = folder / "scene.yaml"
    path.write_text(pipe.replace("sections: [{hold: 1000 m}]", written), encoding="utf8")
    return DrillstringScene.read(path)


# A third of the arc has a length of 12 m * 30 deg = 6.2832 m.
SHORT_RADIUS = "md [m],inc [deg],azi [deg]\n0,0,0\n1000,0,0\n1006.2832,30,0\n1012.5664,60,0\n1018.8496,90,0\n"


@pytest.mark.parametrize(
    ("written", "key"),
    [
        ("sections: [{hold: 1000 m}, {build: {radius: 12 m, to: 90 deg}}]", "well.sections"),
        ("sections: [{hold: 1000 m}, {build: {rate: 143 deg/30m, to: 90 deg}}]", "well.sections"),
        ("survey: {file: s.csv, max_gap: 1000 m}", "well.survey"),
    ],
    ids=["radius", "rate", "survey"],
)
def test_a_short_radius_well_is_warned_of_and_not_refused(tmp_path, written, key):
    # Wells of short radius bend by 1.5 to 3 deg/ft, 148 to 295 deg/30 m.
    (text,) = [one.text for one in warnings(short_radius(tmp_path, written)) if "the hole bends" in one.text]
    assert "143 deg/30 m at 1000 to 1018.8" in text


@pytest.mark.parametrize(("diameter", "refused"), [("71 mm", True), ("69 mm", False)])
@pytest.mark.parametrize("course", ["sections: [{build: {radius: 1.9 m, to: 60 deg}}, {hold: 8 m}]", "survey: s.csv"])
def test_holes_below_70_mm_may_bend_by_any_whatever_they_are_given_by(tmp_path, diameter, refused, course):
    (tmp_path / "s.csv").write_text("md [m],inc [deg],azi [deg]\n0,0,0\n0.9,30,0\n10,30,0\n", encoding="utf8")
    path = tmp_path / "scene.yaml"
    text = PLAIN.replace("sections: [{hold: 1000 m}]", course).replace("diameter: 0.2", f"diameter: {diameter}")
    path.write_text(text.replace(str(OD), "0.02").replace(str(ID), "0.01"), encoding="utf8")
    scene = DrillstringScene.read(path)
    if not refused:
        assert figures(scene)["well"]["length"] == pytest.approx(10.0, abs=0.1)
        return
    with pytest.raises(SceneError, match="859"):
        figures(scene)


@pytest.mark.parametrize(
    ("stations", "warned"),
    [
        ("500,20,10\\n900,30,350\\n1200,40,300", True),
        ("0,0,10\\n500,20,10\\n900,30,350\\n1200,40,300", False),
        ("0,20,10\\n500,20,10\\n900,30,350", False),
        ("500,0.5,10\\n900,30,350", False),
        ("20,20,10\\n420,30,350", False),
    ],
    ids=["deep and inclined", "with its tie-in", "a slant rig", "deep and vertical", "near the table"],
)
def test_a_survey_that_begins_deep_and_inclined_is_told_how_the_hole_above_is_taken(tmp_path, stations, warned):
    rows = stations.replace("\\n", "\n")
    (tmp_path / "s.csv").write_text(f"md [m],inc [deg],azi [deg]\n{rows}\n", encoding="utf8")
    path = tmp_path / "scene.yaml"
    path.write_text(PLAIN.replace("sections: [{hold: 1000 m}]", "survey: s.csv"), encoding="utf8")
    texts = [one.text for one in warnings(DrillstringScene.read(path)) if "first station" in one.text]
    assert len(texts) == warned
    assert all("500 m" in text and "straight at 20 deg" in text and "0, 0, 0" in text for text in texts)


@pytest.mark.parametrize(
    ("top", "how"),
    [
        ("rotation: 60 rpm", "turns"),
        ("rotation: {ramp: {to: 60 rpm, over: 5 s}}", ""),
        ("block: {velocity: 0.1}", "moves"),
        ("rotation: 0", ""),
    ],
)
def test_a_relaxed_start_of_a_string_that_is_in_motion_is_warned_of(top, how):
    edits = (
        ("{stiffness: 1.0e7}", "{stiffness: 1.0e7, friction: 0.3}"),
        ("\nmodel", f"\nstart: relaxed\ntop: {{{top}}}\nmodel"),
    )
    texts = [one.text for one in warnings(scene_of(*edits)) if one.where == "start"]
    assert [f"its top {how} at t = 0" in text for text in texts] == [True] * bool(how)
