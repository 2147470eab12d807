"""Whatever is wrong with a scene is said with its line, its key and a cure, and never by another exception."""

import os
import re
import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import tautline
from drillstring.scene.scene import DrillstringScene, check_lengths, json_schema, read
from drillstring.warnings import warnings
from tautline.errors import ArgumentTypeError
from tautline.scene.errors import SceneError
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

JWELL = Path(__file__).parents[2] / "data" / "jwell.yaml"
TEXT = JWELL.read_text()


def bit(keys, key, words):
    """A fault of a bit on bottom."""
    return "on_bottom: false", f"on_bottom: true, {keys}", 22, f"bit.{key}", words


def drive(keys, key, words):
    """A fault of a top drive."""
    return "{constant: 0 rpm}", f"{{controller: {{{keys}}}}}", 21, f"top.rotation.controller.{key}", words


# what is replaced, by what, the line, the key, words of the message
EDITS = {
    "a length in degrees": ("diameter: 0.2032 m", "diameter: 20 deg", 8, "well.diameter = 20 deg", "a length such as"),
    "a density in metres": ("7850 kg/m^3", "7850 m", 16, "material.density", "a density such as 7850 kg/m^3"),
    "an unknown unit": ("od: 0.127", "od: 5 inchs_", 14, "string[0].od", "a length such as"),
    "a unit nearly right": ("200 GPa", "200 GPA", 16, "material.youngs_modulus", "did you mean 'GPa'"),
    "Hz for a rotary speed": ("0 rpm", "2 Hz", 21, "top.rotation.constant", "rpm"),
    "a number in quotes": ("od: 0.127", 'od: "0.127"', 14, "string[0].od", "remove the quotes"),
    "true for a number": ("od: 0.127", "od: true", 14, "string[0].od", "not numbers"),
    "a list for a number": ("od: 0.127", "od: [0.127]", 14, "string[0].od", "a list is not a number"),
    "a mapping for a number": ("od: 0.127", "od: {m: 0.127}", 14, "string[0].od", "a mapping is not a number"),
    "nothing for a number": ("od: 0.127", "od: ", 14, "string[0].od", "is empty"),
    "a word for a number": ("length: rest", "length: test", 14, "string[0].length", "did you mean 'rest'"),
    "a decimal comma": ("od: 0.127", "od: 0,127", 14, "string[0].127", "with a point"),
    "a fraction": ("od: 0.127", "od: 1/8 m", 14, "string[0].od", "is a fraction"),
    "not a number": ("od: 0.127", "od: .nan", 14, "string[0].od", "not a finite number"),
    "nan as a word": ("od: 0.127", "od: nan", 14, "string[0].od", "not a finite number"),
    "infinite": ("stiffness: 1.0e9", "stiffness: .inf", 10, "well.wall.stiffness", "not a finite number"),
    "infinite by its exponent": ("stiffness: 1.0e9", "stiffness: 1e999", 10, "well.wall.stiffness", "not a finite"),
    "infinite with a unit": (
        "stiffness: 1.0e9",
        "stiffness: 1e999999999 N/m",
        10,
        "well.wall.stiffness",
        "not a finite",
    ),
    "an endless integer": ("stiffness: 1.0e9", "stiffness: " + "9" * 5000, 10, "well.wall.stiffness", "not a finite"),
    "a negative length": ("length: 240 m", "length: -240 m", 15, "string[1].length = -240 m", "greater than zero"),
    "a negative hold": ("hold: 2200 m", "hold: -1", 5, "well.sections[0].hold", "must not be negative"),
    "a negative diameter": ("diameter: 0.2032 m", "diameter: -0.2", 8, "well.diameter", "greater than zero"),
    "a negative friction": ("static: 0.3", "static: -0.3", 12, "well.wall.friction.static", "must not be negative"),
    "a negative stiffness": ("stiffness: 1.0e9", "stiffness: -1", 10, "well.wall.stiffness", "greater than zero"),
    "an inclination over 180 degrees": (
        "to: 90 deg",
        "to: 190 deg",
        6,
        "well.sections[1].build.to",
        "not be more than",
    ),
    "keys of an arc that stand beside it": (
        "{build: {radius: 1000 m, to: 90 deg, azimuth: 0 deg}}",
        "{build: 60 deg, curvature: 3 deg/30 m}",
        6,
        "well.sections[1]",
        "write build: {rate: 3 deg/30 m, to: 60 deg}",
    ),
    "a pipe thinner than its bore, in inches": (
        "od: 0.165",
        "od: 2 in",
        15,
        "string[1].od = 2 in",
        "is smaller than the inner diameter (string[1].id = 0.0572, line 15)",
    ),
    "a pipe thinner than its bore": (
        "od: 0.165",
        "od: 0.05",
        15,
        "string[1].od = 0.05",
        "(string[1].id = 0.0572, line",
    ),
    "a pipe without a wall": ("od: 0.165", "od: 0.0572", 15, "string[1].od", "equal to the inner diameter"),
    "a collar larger than the hole": ("od: 0.165", "od: 0.3", 15, "string[1].od = 0.3", "widen well.diameter"),
    "a collar as large as the hole": (
        "od: 0.165",
        "od: 0.2032",
        15,
        "string[1].od",
        "does not fit into the hole (well.diameter = 0.2032 m, line 8)",
    ),
    "a tool joint larger than the hole": (
        "id: 0.1086",
        "id: 0.1086, tool_joint_od: 9 in",
        14,
        "string[0].tool_joint_od = 9 in",
        "does not fit",
    ),
    "a tool joint thinner than the pipe": (
        "id: 0.1086",
        "id: 0.1086, tool_joint_od: 4 in",
        14,
        "string[0].tool_joint_od",
        "smaller than the od, 5 in (0.127 m)",
    ),
    "two rests": ("length: 240 m", "length: rest", 15, "string[1].length", "give its length"),
    "an eccentricity of one number": (
        "id: 0.1086",
        "id: 0.1, eccentricity: 0.1",
        14,
        "string[0].eccentricity",
        "a list",
    ),
    "an eccentricity outside of the pipe": (
        "id: 0.1086",
        "id: 0.1086, eccentricity: [0, 64 mm]",
        14,
        "string[0].eccentricity",
        "outside of the pipe",
    ),
    "a number of elements with an exponent": ("elements: 12", "elements: 1e3", 23, "model.elements", "write 1000"),
    "an eccentricity of three": (
        "id: 0.1086",
        "id: 0.1, eccentricity: [0, 0, 0]",
        14,
        "string[0].eccentricity",
        "give 2",
    ),
    "kinetic friction above static": (
        "kinetic: 0.2",
        "kinetic: 0.5",
        12,
        "friction.kinetic = 0.5",
        "larger than static",
    ),
    "an unknown law": ("law: projection", "law: projecton", 12, "well.wall.friction.law", "did you mean 'projection'"),
    "a misspelt method": ("method: generalized-alpha", "method: newmrk", 24, "solver.method", "did you mean 'newmark'"),
    "a number for a method": ("method: generalized-alpha", "method: 4", 24, "solver.method", "newmark or rk4"),
    "a step of nothing": ("step: 1 ms", "step: 0", 24, "solver.step = 0", "greater than zero"),
    "a step back": ("step: 1 ms", "step: -1 ms", 24, "solver.step = -1 ms", "greater than zero"),
    "a step too small to end": ("step: 1 ms", "step: 1e-12", 24, "solver.step", "larger step"),
    "an end before the first step": ("end: 40 s", "end: 0.5 ms", 24, "solver.end", "smaller step"),
    "an interval below the step": (
        "interval: 50 ms",
        "interval: 0.1 ms",
        25,
        "output.interval",
        "at least solver.step",
    ),
    "an interval over the end": ("interval: 50 ms", "interval: 50 s", 25, "output.interval", "less than solver.end"),
    "a rho_inf over one": ("rho_inf: 0.1", "rho_inf: 1.1", 24, "solver.rho_inf = 1.1", "not be more than 1"),
    "rho_inf and alpha_m": ("rho_inf: 0.1", "rho_inf: 0.1, alpha_m: 0", 24, "solver.alpha_m", "keep rho_inf"),
    "alpha_m alone": ("rho_inf: 0.1", "alpha_m: 0.1", 24, "solver.alpha_f", "add `alpha_f:`"),
    "alpha_f over a half": ("rho_inf: 0.1", "alpha_m: 0, alpha_f: 0.6", 24, "solver.alpha_f", "0.5 or less"),
    "alpha_m over alpha_f": ("rho_inf: 0.1", "alpha_m: 0.4, alpha_f: 0.3", 24, "solver.alpha_m", "lower alpha_m"),
    "a solver that is a word": ("solver: {", "solver: fast\nsolve: {", 24, "solver", "write a mapping of keys"),
    "half an element": ("elements: 12", "elements: 12.5", 23, "model.elements = 12.5", "a whole number"),
    "fewer elements than sections": ("elements: 12", "elements: 1", 23, "model.elements = 1", "at least 2"),
    "too many elements": ("elements: 12", "elements: 1000000", 23, "model.elements", "at most 100000"),
    "elements that do not add up": (
        "id: 0.1086",
        "id: 0.1, elements: 12",
        14,
        "string[0].elements",
        "make the two agree",
    ),
    "a beam bent softly": (
        "kind: lumped, elements: 12, bending: stiff",
        "kind: ale-ancf, elements: 12, bending: soft",
        23,
        "model.bending = soft",
        "kind: lumped",
    ),
    "an unknown model": ("kind: lumped", "kind: lumpy", 23, "model.kind = lumpy", "did you mean 'lumped'"),
    "a bit on the bottom without a weight": ("on_bottom: false", "on_bottom: true", 22, "bit.weight", "weight: 100 kN"),
    "a negative weight on bit": bit("weight: -1 kN", "weight = -1 kN", "must not be negative"),
    "a bit held less at rest": bit("weight: 1, torque: {static: 1, kinetic: 2}", "torque.static", "swap the two"),
    "a torque at no weight": bit("weight: 0, torque: {static: 2, kinetic: 1}", "torque.weight", "at which this torque"),
    "a rate at no weight": bit("weight: 0, penetration: {rate: 1, speed: 1}", "penetration.weight", "is missing"),
    "a rate in metres": bit("weight: 1, penetration: {rate: 15 m, speed: 1}", "penetration.rate = 15 m", "a speed"),
    "a threshold above the weight": bit(
        "weight: 1, penetration: {rate: 1, speed: 1, threshold: 2}", "penetration.threshold = 2", "not below 1 N"
    ),
    "two laws of torque": bit(
        "weight: 1, torque: {static: 2, kinetic: 1}, cutting: {specific_energy: 1e8}", "torque", "remove `cutting`"
    ),
    "a damper under blades": bit(
        "weight: 1, rock: {damping: 1}, cutting: {specific_energy: 1e8, blades: 5}", "rock.damping", "remove it"
    ),
    "half a blade": bit("weight: 1, cutting: {specific_energy: 1e8, blades: 2.5}", "cutting.blades", "a whole number"),
    "a drive without gains": drive("speed: 1, inertia: 2", "proportional", "1500 N m s/rad"),
    "a drive without inertia": drive("kind: soft_torque, speed: 1", "inertia", "is missing"),
    "a stiff drive with a limit": drive("kind: stiff, speed: 1, torque_limit: 1", "torque_limit", "kind: pi"),
    "an unknown drive": drive("kind: soft, speed: 1", "kind = soft", "soft-torque"),
    "no for false": ("on_bottom: false", "on_bottom: no", 22, "bit.on_bottom = no", "true or false"),
    "no, with its cure": (
        "on_bottom: false",
        "on_bottom: no",
        22,
        "bit.on_bottom = no",
        "write false, without quotes; no",
    ),
    "yes for true": (
        "on_bottom: false",
        "on_bottom: yes",
        22,
        "bit.on_bottom = yes",
        "write true, without quotes; yes",
    ),
    "true in quotes": ("on_bottom: false", "on_bottom: 'true'", 22, "bit.on_bottom", "write true, without quotes"),
    "a number for false": ("on_bottom: false", "on_bottom: 0", 22, "bit.on_bottom = 0", "0 is a number in YAML 1.2"),
    "a word for true": (
        "on_bottom: false",
        "on_bottom: maybe",
        22,
        "bit.on_bottom",
        "write true or false, without quotes",
    ),
    "an unknown key": ("od: 0.127", "diametr: 0.127", 14, "string[0].diametr", "unknown key"),
    "an unknown key at the root": ("material:", "materials:", 16, "materials", "did you mean 'material'"),
    "an unknown function": ("chirp: {", "chrip: {", 20, "top.block", "did you mean 'chirp'"),
    "an unknown key in a function": ("rate: 0.0025", "rat: 1", 20, "top.block.chirp.rat = 1", "did you mean 'rate'"),
    "two functions at once": (
        "{constant: 0 rpm}",
        "{constant: 0, sum: [1]}",
        21,
        "top.rotation",
        "both constant and sum",
    ),
    "an empty function": ("{constant: 0 rpm}", "{}", 21, "top.rotation", "empty mapping"),
    "an empty sum": ("{constant: 0 rpm}", "{sum: []}", 21, "top.rotation.sum", "write a list"),
    "a fault inside of a sum": (
        "{constant: 0 rpm}",
        "{sum: [1, {ramp: {to: 5 m, over: 1}}]}",
        21,
        "top.rotation.sum[1].ramp.to = 5 m",
        "rpm",
    ),
    "a ramp to nowhere": ("{constant: 0 rpm}", "{ramp: {over: 1}}", 21, "top.rotation.ramp.to", "or `rate: slope`"),
    "a ramp in next to no time": (
        "{constant: 0 rpm}",
        "{ramp: {to: 1, over: 1e-20}}",
        21,
        "ramp.over",
        "in which anything can move",
    ),
    "a ramp in no time": ("{constant: 0 rpm}", "{ramp: {to: 1, over: 0}}", 21, "ramp.over = 0", "greater than zero"),
    "a table that goes back in time": (
        "{constant: 0 rpm}",
        "{table: {time: [0, 2, 1], value: [0, 1, 2]}}",
        21,
        "top.rotation.table.time[2] = 1",
        "increasing order",
    ),
    "a table of unequal columns": (
        "{constant: 0 rpm}",
        "{table: {time: [0, 2], value: [0]}}",
        21,
        "top.rotation.table.value",
        "a value for every time",
    ),
    "a table without a file": (
        "{constant: 0 rpm}",
        "{table: {file: nowhere.csv}}",
        None,
        "nowhere.csv",
        "relative to the scene's folder",
    ),
    "an empty well": ("  sections:   ", "  sections: []\n  turns:   ", 4, "well.sections", "at least one"),
    "a section of no kind": ("hold: 2200 m", "drop: 2200 m", 5, "well.sections[0]", "known: hold, build, turn"),
    "an arc without a curvature": ("radius: 1000 m, ", "", 6, "well.sections[1].build.radius", "3 deg/30m"),
    "an arc of two curvatures": (
        "radius: 1000 m",
        "radius: 1 km, rate: 0.001",
        6,
        "sections[1].build.rate",
        "keep one",
    ),
    "sections and a survey": ("  diameter:", "  survey: s.csv\n  diameter:", 8, "well.survey", "keep one"),
    "no path": ("  sections:   ", "  inclination: 0\n  x:", 5, "well.x", "unknown key"),
    "no wall": ("  wall: ", "  walls: ", 9, "well.walls", "did you mean 'wall'"),
    "a wall of a word": ("  wall:  ", "  wall: some\n  xs: ", 9, "well.wall = some", "`none` for free space"),
    "an empty wall": ("  wall:  ", "  wall:\n  xs: ", 9, "well.wall", "is empty"),
    "a duplicate key": ("od: 0.127, ", "od: 0.127, od: 0.1, ", 14, "string[0].od", "keep one of the two"),
    "a recursive alias": ("top:", "top: &a {block: *a}\nbottom:", 19, "top.block", "inside of what it repeats"),
    "an alias of nothing": ("od: 0.127", "od: *pipe", 14, "string[0].od", "mark a value with &pipe"),
    "a merge key": ("{on_bottom: false}", "{<<: {on_bottom: false}}", 22, "bit", "write the keys out"),
    "a tag of Python": ("0 rpm}", "!!python/object/apply:os.system ['ls']}", 21, "top.rotation.constant", "evaluated"),
    "a tag": ("od: 0.127", "od: !!float 0.127", 14, "string[0].od", "remove the tag"),
    "a tab": ("  diameter:", "\tdiameter:", 8, "", "indent with spaces"),
    "an open bracket": ("bit: {on_bottom: false}", "bit: {on_bottom: false", 23, "", "brackets"),
    "two documents": ("solver:", "---\nsolver:", 24, "", "one scene in a file"),
    "a list as a key": ("od: 0.127", "[od]: 0.127", 14, "string[0]", "a key must be a word"),
    "a control character": ("title: J", "title: \x07J", 2, "", "remove it"),
    "a nesting without end": ("od: 0.127", "od: " + "[" * 100_000, 14, "string[0].od", "nested"),
    "a code for a number": (
        "od: 0.127",
        "od: __import__('os').getcwd() m",
        14,
        "string[0].od",
        "not a number with a unit",
    ),
    "a power tower for a unit": ("od: 0.127", "od: 9 m**9**9**9**9", 14, "string[0].od", "unit"),
    "a list for a string": ("string:  ", "string: []\nstrong:  ", 13, "string", "at least one"),
    "a mapping for a string": ("string:  ", "string: {od: 1}\nstrong:  ", 13, "string", "a list"),
    "a string section that is a word": ("string:  ", "string: [pipe]\nstrong:  ", 13, "string[0]", "a mapping of keys"),
    "a start of no kind": (
        "solver:",
        "start: moving\nsolver:",
        24,
        "start = moving",
        "must be static, relaxed or straight",
    ),
    "unknown units of print": (
        "solver:",
        "units: imperial\nsolver:",
        24,
        "units = imperial",
        "must be si, metric or field",
    ),
    "a tubular of an unknown grade": (
        "{name: BHA,",
        "{tubular: 5 in 19.5 S120, name: BHA,",
        15,
        "string[1].tubular = 5 in 19.5 S120",
        "known grades: E75, X95, G105, S135",
    ),
    "a tubular that may be several": (
        "{name: BHA,",
        "{tubular: 5 in 19.5, name: BHA,",
        15,
        "string[1].tubular",
        "'drill pipe 5 in 19.50 lb/ft S135'; name one of them",
    ),
    "a tubular that is none": (
        "{name: BHA,",
        "{tubular: HWDP 7 in, name: BHA,",
        15,
        "string[1].tubular",
        "the nearest are 'HWDP 6 5/8 in'",
    ),
    "a yield load in pounds": ("length: 240 m,", "length: 240 m, yield_load: 700 klb,", 15, "string[1].yield", "klbf"),
    "gravity upwards": ("solver:", "gravity: -9.81\nsolver:", 24, "gravity = -9.81", "must not be negative"),
    "an added mass of a word": (
        "added_mass: 1.0",
        "added_mass: anular",
        17,
        "mud.added_mass",
        "did you mean 'annular'",
    ),
}

WHOLE_FILES = {
    "empty": (b"", "is empty"),
    "only comments": (b"# a scene\n", "is empty"),
    "a list": (b"- 1\n- 2\n", "a mapping of keys"),
    "a word": (b"scene\n", "a mapping of keys"),
    "binary": (bytes(range(256)) * 4, "save it as UTF-8"),
    "an image": (b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "save it as UTF-8"),
    "Latin-1": ("title: Brønn\n".encode("latin-1"), "byte 10 is not UTF-8"),
    "UTF-16 without a mark": ("title: x\n".encode("utf-16-le"), "save it as UTF-8"),
    "half of UTF-16": (b"\xff\xfet\0i", "save it as UTF-8"),
    "an alias bomb": (
        b"a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
        + b"".join(b"a%d: &a%d [%s]\n" % (i, i, b", ".join([b"*a%d" % (i - 1)] * 10)) for i in range(1, 9)),
        "remove the aliases",
    ),
    "an alias staircase": (
        b"a0: &a0 [x]\n" + b"".join(b"a%d: &a%d [*a%d]\n" % (i, i, i - 1) for i in range(1, 99)),
        "nested more than 50 deep",
    ),
}


def refusal(text: str, path: str = "jwell.yaml") -> str:
    with pytest.raises(SceneError) as caught:
        DrillstringScene.parse(text, path)
    return str(caught.value)


@pytest.mark.parametrize("name", EDITS)
def test_a_broken_scene_is_refused_with_line_key_and_cure(name):
    old, new, line, key, cure = EDITS[name]
    assert old in TEXT
    message = refusal(TEXT.replace(old, new, 1))
    place = f"jwell.yaml:{line}: " if line else ""
    found = [m for m in message.splitlines() if m.startswith(place + key) or (place in m and key in m)]
    assert found, message
    assert any(cure in m for m in found), message
    assert all("; " in m for m in message.splitlines()), f"a cure is missing: {message}"


def test_mud_heavier_than_steel_is_refused_with_its_line_where_lengths_are_known():
    scene = DrillstringScene.parse(TEXT.replace("density: 1840", "density: 9000"), "jwell.yaml")
    with pytest.raises(SceneError, match=r"jwell.yaml:17: mud.density = 9000.*would float.*12\.5 ppg"):
        warnings(scene)


@pytest.mark.parametrize("key", ["well", "string", "material", "model", "solver", "output"])
def test_a_missing_part_is_named_with_what_to_add(key):
    text = re.sub(rf"(?m)^{key}:.*\n(^  .*\n)*", "", TEXT)
    assert f"jwell.yaml:1: {key}: is missing; add `{key}:`, such as" in refusal(text)


@pytest.mark.parametrize(
    ("old", "key"),
    [
        ("diameter: 0.2032 m", "well.diameter"),
        (", od: 0.127", "string[0].od"),
        (", density: 7850 kg/m^3", "material.density"),
    ],
)
def test_a_missing_key_is_named_with_an_example(old, key):
    message = refusal(TEXT.replace(old, "", 1))
    assert re.search(rf"jwell.yaml:\d+: {re.escape(key)}: is missing; add `\w+:`, such as", message), message


@pytest.mark.parametrize("name", WHOLE_FILES)
def test_a_file_that_is_no_scene_is_refused_with_a_cure(name, tmp_path):
    data, cure = WHOLE_FILES[name]
    path = tmp_path / "scene.yaml"
    path.write_bytes(data)
    with pytest.raises(SceneError, match=re.escape(cure)) as caught:
        read(path)
    assert str(caught.value).startswith(f"{path}:")


def test_a_file_of_100_mb_is_refused_before_it_is_read(tmp_path):
    path = tmp_path / "large.yaml"
    path.touch()
    os.truncate(path, 100_000_000)
    start = time.process_time()
    with pytest.raises(SceneError, match=r"100 MB long.*CSV"):
        read(path)
    assert time.process_time() - start < 0.05


def test_a_missing_file_is_refused_with_the_nearest_name(tmp_path):
    (tmp_path / "jwell.yaml").write_text(TEXT)
    with pytest.raises(SceneError, match=r"jwel\.yaml: there is no such file; did you mean .*jwell\.yaml"):
        read(tmp_path / "jwel.yaml")
    with pytest.raises(SceneError, match="no such file"):
        read(tmp_path / "no" / "jwell.yaml")
    with pytest.raises(SceneError, match="no such file"):
        read(tmp_path / "jwell.yaml" / "x.yaml")


def test_a_folder_and_a_device_are_refused(tmp_path):
    with pytest.raises(SceneError, match="is a folder"):
        read(tmp_path)
    with pytest.raises(SceneError, match="not a regular file"):
        read("/dev/null")
    with pytest.raises(SceneError):
        read("a\0b")


def test_several_faults_are_told_at_once_in_the_order_of_the_file():
    text = (
        TEXT.replace("od: 0.127", "od: -1")
        .replace("step: 1 ms", "step: 0")
        .replace("diameter: 0.2032 m", "diameter: x")
    )
    lines = refusal(text).splitlines()
    assert [line.split(":")[1] for line in lines] == ["8", "14", "24"]


def test_the_table_of_another_file_is_blamed_by_that_file_and_line(tmp_path):
    (tmp_path / "block.csv").write_text("time [s], value [m]\n0, 0\n1, oops\n")
    path = tmp_path / "jwell.yaml"
    path.write_text(re.sub(r"block: \{.*", "block: {table: {file: block.csv}}", TEXT))
    with pytest.raises(SceneError, match=r"block\.csv:3: oops in value is not a number; write plain numbers"):
        read(path)
    (tmp_path / "block.csv").write_text("t [ms], heave [kN]\n0, 0\n")
    with pytest.raises(SceneError, match=r"block\.csv:1: 'kN' is not a unit like m; write the unit .* heave \[m\]"):
        read(path)
    (tmp_path / "block.csv").write_text("# from the rig\nt [ms]; value [cm]\n0; 1\n500; 3\n")
    block = read(path).top.block
    assert block.time == (0.0, 0.5)
    assert block.value == pytest.approx((0.01, 0.03))


def test_an_overridden_value_is_blamed_on_its_option():
    document = Document.parse(TEXT, "jwell.yaml")
    with pytest.raises(SceneError, match=r"^--step: solver\.step = 0: must be greater than zero; give"):
        validate(DrillstringScene, document.replaced({("solver", "step"): (0, "--step")}))
    scene = validate(DrillstringScene, document.replaced({("solver", "method"): ("RK4", "--method")}))
    assert scene.solver.method == "rk4"
    with pytest.raises(SceneError, match=r"vary: solver\.step\.size: there is no such key"):
        document.replaced({("solver", "step", "size"): (1, "vary")})


def test_a_string_longer_than_the_hole_is_refused():
    scene = DrillstringScene.parse(TEXT, "jwell.yaml")
    assert check_lengths(scene, 3770.796) == pytest.approx((3530.796, 240.0))
    with pytest.raises(SceneError, match=r"jwell\.yaml:14: string\[0\]\.length = rest: no room is left"):
        check_lengths(scene, 200.0)
    fixed = DrillstringScene.parse(TEXT.replace("length: rest", "length: 4 km"), "jwell.yaml")
    with pytest.raises(SceneError, match=r"jwell\.yaml:14: string\[0\]\.length = 4 km: the string is 4240 m long"):
        check_lengths(fixed, 3770.796)
    assert check_lengths(fixed, 4240.0) == (4000.0, 240.0)


def test_the_j_well_is_read_as_it_stands():
    scene = read(JWELL)
    assert [type(section).__name__ for section in scene.well.sections] == ["Hold", "Build"]
    assert scene.well.sections[1].to == pytest.approx(1.5707963267948966, abs=0)
    assert scene.well.wall.friction.kinetic == 0.2
    assert scene.string[0].length == "rest"
    assert scene.material.youngs_modulus == 200e9
    assert scene.solver.step == 0.001
    assert scene.document.path == JWELL


def test_short_ways_of_writing_are_understood():
    text = re.sub(r"friction: \{.*\}", "friction: 0.25", TEXT).replace("{constant: 0 rpm}", "60 rpm")
    text = re.sub(r"block: \{.*", "block: {velocity: {ramp: {to: 0.5, over: 2}}}", text)
    scene = DrillstringScene.parse(text.replace("method: generalized-alpha", "method: G-Alpha"))
    assert (scene.well.wall.friction.static, scene.well.wall.friction.kinetic) == (0.25, 0.25)
    assert scene.top.rotation.value == pytest.approx(6.283185307179586)
    assert scene.top.block.velocity.to == 0.5
    assert scene.solver.method == "generalized-alpha"
    bent = DrillstringScene.parse(TEXT.replace("radius: 1000 m", "rate: 3 deg/30m")).well.sections[1]
    assert bent.bend_radius == pytest.approx(572.957795)
    surveyed = re.sub(r"(?m)^  sections:.*\n(^    .*\n)*", "  survey: {file: s.csv, md: ft}\n", TEXT)
    assert DrillstringScene.parse(surveyed).well.survey.units == {"md": "ft"}
    text = re.sub(r"(?m)^  wall:.*\n(^    .*\n)*", "  wall: none\n", TEXT)
    assert DrillstringScene.parse(text).well.wall is None
    controlled = TEXT.replace(
        "{constant: 0 rpm}", "{controller: {speed: 120 rpm, proportional: 100, integral: 50, inertia: 2000}}"
    )
    assert DrillstringScene.parse(controlled).top.rotation.speed.value == pytest.approx(12.566370614359172)


def test_byte_order_marks_and_line_ends_do_not_matter(tmp_path):
    expected = read(JWELL).model_dump()
    for i, data in enumerate(
        (
            TEXT.encode("utf-8-sig"),
            TEXT.encode("utf-16"),
            TEXT.replace("\n", "\r\n").encode(),
            ("\ufeff" + TEXT).encode(),
        )
    ):
        path = tmp_path / f"{i}.yaml"
        path.write_bytes(data)
        assert read(path).model_dump() == expected


def test_the_schema_knows_every_key_of_the_j_well():
    schema = str(json_schema())
    for key in re.findall(r"(\w+):", re.sub(r"#.*", "", TEXT)):
        assert f"'{key}'" in schema, key


@st.composite
def mutations(draw):
    lines = TEXT.splitlines()
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(lines) - 1))
        line = lines[at]
        kind = draw(st.sampled_from(["delete", "repeat", "swap", "insert", "cut", "word"]))
        if kind == "delete":
            lines[at] = ""
        elif kind == "repeat":
            lines.insert(at, line)
        elif kind == "swap" and len(line) > 1:
            i = draw(st.integers(0, len(line) - 2))
            lines[at] = line[:i] + line[i + 1] + line[i] + line[i + 2 :]
        elif kind == "insert":
            i = draw(st.integers(0, len(line)))
            lines[at] = line[:i] + draw(st.text(max_size=3)) + line[i:]
        elif kind == "cut":
            lines[at] = line[: draw(st.integers(0, len(line)))]
        elif kind == "word":
            words = re.split(r"(\W+)", line)
            i = draw(st.integers(0, len(words) - 1))
            words[i] = draw(
                st.sampled_from(["", "0", "-1", "1e308", "null", "true", "[]", "{}", "rest", ".nan", "x", "m"])
            )
            lines[at] = "".join(words)
    return "\n".join(lines)


@settings(max_examples=40, deadline=None)
@given(mutations())
def test_a_mutated_scene_is_read_or_refused_and_nothing_else(text):
    try:
        DrillstringScene.parse(text, "jwell.yaml")
    except SceneError as error:
        assert all(str(problem).startswith("jwell.yaml") for problem in error.problems)
        assert "; " in str(error)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, len(TEXT)), st.binary(min_size=1, max_size=6))
def test_random_bytes_in_a_scene_are_read_or_refused_and_nothing_else(tmp_path_factory, at, data):
    path = tmp_path_factory.mktemp("bytes") / "jwell.yaml"
    whole = TEXT.encode()
    path.write_bytes(whole[:at] + data + whole[at:])
    try:
        read(path)
    except SceneError as error:
        assert str(path) in str(error)


@settings(max_examples=60, deadline=None)
@given(st.text(max_size=60))
def test_any_text_is_refused_as_a_scene(text):
    with pytest.raises(SceneError):
        DrillstringScene.parse(text)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
KEYS = [
    ("well",),
    ("well", "wall"),
    ("well", "sections", 1),
    ("string",),
    ("string", 0, "od"),
    ("mud",),
    ("top", "block"),
]
KEYS += [("top", "rotation"), ("solver",), ("solver", "method"), ("model", "elements"), ("well", "wall", "friction")]


@settings(max_examples=40, deadline=None)
@given(st.sampled_from(KEYS), VALUES)
def test_any_value_in_any_place_is_read_or_refused_and_nothing_else(key, value):
    document = Document.parse(TEXT, "jwell.yaml")
    try:
        validate(DrillstringScene, document.replaced({key: (value, "vary")}))
    except SceneError as error:
        assert error.problems


def test_where_every_section_is_at_fault_the_list_is_not_called_empty():
    with pytest.raises(SceneError) as caught:
        DrillstringScene.parse(TEXT.replace("od: 0.127", "od: thick").replace("od: 0.165", "od: thin"))
    assert [problem.key for problem in caught.value.problems] == ["string[0].od", "string[1].od"]


@pytest.mark.parametrize("line", ["{output: crate.position[2], statistic: range}", "{crate.position[2]: 3}"])
def test_a_part_of_a_name_without_quotes_between_braces_is_refused_with_the_quotes(line):
    with pytest.raises(SceneError) as refused:
        DrillstringScene.parse(f"bodies:\n  - {line}\n", "crate.yaml")
    told = str(refused.value)
    assert 'put the name in quotes: "crate.position[2]"' in told and "expected" not in told


@pytest.mark.parametrize(
    ("given", "missing", "example"),
    [("peak_period: 9", "significant_height", "2.5 m"), ("significant_height: 2", "peak_period", "9 s")],
)
def test_a_sea_without_its_height_or_period_is_told_one_that_a_sea_has(given, missing, example):
    text = TEXT.replace("{constant: 0 rpm}", f"{{spectrum: {{{given}}}}}")
    with pytest.raises(SceneError, match=rf"{missing}: is missing; add `{missing}:`, such as {example}"):
        DrillstringScene.parse(text, "jwell.yaml")


@pytest.mark.parametrize("text", ["", " "])
def test_an_empty_text_is_no_scene_and_not_the_folder_here(text):
    with pytest.raises(ArgumentTypeError, match="not an empty text"):
        tautline.read(text)
