"""A scene of a hose is read as meant, or refused with line, key and cure; `check` warns where it should."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gardenhose.application import Gardenhose
from gardenhose.build import assembled
from gardenhose.estimates import rk4_limit, speeds
from gardenhose.scene import HoseScene, json_schema, read, with_speed
from gardenhose.warnings import figures, warnings
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.integrators.state import new_state
from tautline.integrators.vibration.critical_step import CriticalStep
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant, Ramp
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

HOSE = Path(__file__).parents[2] / "data" / "hose.yaml"
TEXT = HOSE.read_text(encoding="utf8")

SPEED = "{ramp: {to: 35.0, over: 0.1}}"
DIRECTION = "direction: [1, 0, 0]"
WATER = re.search(r"(?m)^water:\n(  .*\n)+", TEXT)[0]
WHOLE = re.search(r"(?m)^hose:\n(  .*\n)+", TEXT)[0]
SECTION = re.search(r"(?m)(?<=^hose:\n)(  .*\n)+?(?=  root)", TEXT)[0]
PIECE = "{length: 0.25, elements: 5, axial_stiffness: 10, bending_stiffness: 0.001, mass_per_length: 0.003}"
SEGMENTS = f"  segments:\n    - {PIECE}\n    - {PIECE}\n"


def beside(key, extra):
    """An edit that adds keys to the hose below its direction; the first stands in line 12."""
    return DIRECTION, f"{DIRECTION}\n  {key}: {extra}"


# what is replaced, by what, the line, the key, words of the message
EDITS = {
    # the section
    "a negative mass": ("0.0031316   # kg", "-0.003   # kg", 8, "hose.mass_per_length = -0.003", "greater than zero"),
    "no mass": ("0.0031316   # kg", "0   # kg", 8, "hose.mass_per_length = 0", "a mass per length such as"),
    "a mass in kilogrammes": ("0.0031316   # kg", "3 kg   # kg", 8, "hose.mass_per_length = 3 kg", "not the unit"),
    "no elements": ("elements: 10", "elements: 0", 5, "hose.elements = 0", "must be at least 1"),
    "a milliard elements": ("elements: 10", "elements: 1000000000", 5, "hose.elements", "must be at most 100000"),
    "elements by halves": ("elements: 10", "elements: 10.5", 5, "hose.elements = 10.5", "a whole number"),
    "elements as text": ("elements: 10", "elements: ten", 5, "hose.elements = ten", "a whole number"),
    "a missing number of elements": ("  elements: 10\n", "", 3, "hose.elements", "add `elements:`, such as 10"),
    "a length of nothing": ("length: 0.5", "length: 0", 4, "hose.length = 0", "greater than zero"),
    "a length in seconds": ("length: 0.5", "length: 0.5 s", 4, "hose.length = 0.5 s", "a length such as"),
    "a length that is no number": ("length: 0.5", "length: .nan", 4, "hose.length = .nan", "finite"),
    "a length without end": ("length: 0.5", "length: .inf", 4, "hose.length = .inf", "finite"),
    "a length too small": ("length: 0.5", "length: 1e-200", 4, "hose.length = 1e-200", "from 1e-30 to 1e+30"),
    "no axial stiffness": ("10.0        # EA", "0        # EA", 6, "hose.axial_stiffness = 0", "a force such as"),
    "an infinite stiffness": ("10.0        # EA", "1e999        # EA", 6, "hose.axial_stiffness", "finite"),
    "a stiffness beyond all": ("10.0        # EA", "1e300        # EA", 6, "hose.axial_stiffness", "computed with"),
    "a negative EJ": ("0.00108 ", "-0.00108 ", 7, "hose.bending_stiffness = -0.00108", "must not be negative"),
    "an EJ in newtons": ("0.00108 ", "0.00108 N ", 7, "hose.bending_stiffness = 0.00108 N", "a bending stiffness"),
    "a damping that drives": ("damping: 0.003", "damping: -0.003", 9, "hose.damping", "must not be negative"),
    "a hose of nothing": (SECTION, "", 3, "hose.length", "there are no segments; give length, elements"),
    "a misspelt key of the hose": ("axial_stiffness:", "axial_stifness:", 6, "axial_stifness", "'axial_stiffness'?"),
    "water's mass beside the hose's": (
        *beside("water_mass_per_length", "0.1"),
        12,
        "hose.water_mass_per_length",
        "unknown key",
    ),
    # segments
    "segments beside the section": (*beside("segments", f"[{PIECE}]"), 4, "hose.length = 0.5", "together with seg"),
    "segments beside a damping": (
        SECTION,
        "  damping: 0.001\n" + SEGMENTS,
        4,
        "hose.damping = 0.001",
        "give it in each segment",
    ),
    "no segments": (SECTION, "  segments: []\n", 4, "hose.segments", "at least one entry"),
    "segments that are no list": (SECTION, f"  segments: {PIECE}\n", 4, "hose.segments", "must be a list"),
    "a segment without stiffness": (
        SECTION,
        SEGMENTS.replace("axial_stiffness: 10, ", "", 1),
        5,
        "hose.segments[0].axial_stiffness",
        "add `axial_stiffness:`, such as 10 N",
    ),
    "a segment of no mass": (
        SECTION,
        SEGMENTS.replace("gth: 0.003}", "gth: 0}", 1),
        5,
        "hose.segments[0].mass_per_length = 0",
        "greater than zero",
    ),
    "a segment without water": (
        SECTION,
        SEGMENTS.replace("0.003}", "0.003, water_mass_per_length: 0}", 1),
        5,
        "segments[0].water_mass_per_length = 0",
        "greater than zero",
    ),
    "segments of too many elements": (
        SECTION,
        SEGMENTS.replace("elements: 5", "elements: 50001"),
        6,
        "hose.segments[1].elements = 50001",
        "100002 elements, more than 100000",
    ),
    "a segment far too long": (
        SECTION,
        SEGMENTS.replace("length: 0.25,", "length: 1e99,", 1),
        5,
        "hose.segments[0].length = 1e99",
        "computed with",
    ),
    # place and ends
    "a direction of nothing": (DIRECTION, "direction: [0, 0, 0]", 11, "hose.direction", "no direction"),
    "a direction in a plane": (DIRECTION, "direction: [1, 0]", 11, "hose.direction", "three numbers"),
    "a direction as a word": (DIRECTION, "direction: down", 11, "hose.direction = down", "such as [1, 0, 0]"),
    "a direction in metres": (DIRECTION, "direction: [1 m, 0, 0]", 11, "hose.direction[0] = 1 m", "plain number"),
    "a root of one number": ("root: [0, 0, 0]", "root: 0", 10, "hose.root = 0", "three numbers: x, y and z"),
    "a root that is no place": ("root: [0, 0, 0]", "root: [0, .nan, 0]", 10, "hose.root[1] = .nan", "finite"),
    "a root in kilogrammes": ("root: [0, 0, 0]", "root: [0 kg, 0, 0]", 10, "hose.root[0] = 0 kg", "a length such as"),
    "a root beyond the moon": ("root: [0, 0, 0]", "root: [0, 0, 1e9]", 10, "hose.root", "origin near the hose"),
    "an unknown support": (*beside("root_support", "held"), 12, "hose.root_support = held", "clamped or pinned"),
    "an unknown end": (*beside("end", "fre"), 12, "hose.end = fre", "did you mean 'free'"),
    "an unknown clamp": (*beside("clamp", "slopes"), 12, "hose.clamp = slopes", "did you mean 'slope'"),
    "an unknown strain": (*beside("strain", "engineerin"), 12, "hose.strain", "did you mean 'engineering'"),
    "a negative tip mass": (*beside("tip_mass", "-1 kg"), 12, "hose.tip_mass = -1 kg", "must not be negative"),
    # water
    "speed as text": (SPEED, "fast", 14, "water.speed = fast", "is not a number with a unit"),
    "speed in quotes": (SPEED, "'35'", 14, "water.speed = 35", "remove the quotes"),
    "speed in rpm": (SPEED, "35 rpm", 14, "water.speed = 35 rpm", "a speed such as"),
    "speed as a list": (SPEED, "[0, 35]", 14, "water.speed", "a list is not a number"),
    "a speed that is no number": (SPEED, ".nan", 14, "water.speed = .nan", "finite"),
    "a ramp to nowhere": (SPEED, "{ramp: {over: 0.1}}", 14, "water.speed.ramp.to", "give `to: value`"),
    "a misspelt function": (SPEED, "{rampe: {to: 3}}", 14, "water.speed", "did you mean 'ramp'"),
    "water without speed": (f"  speed: {SPEED}", "", 12, "water.speed", "add `speed:`, such as 15 m/s"),
    "water without mass": ("  mass_per_length: 0.0007854\n", "", 12, "water.mass_per_length", "is missing"),
    "massless water": ("0.0007854", "0", 13, "water.mass_per_length = 0", "greater than zero"),
    "water too light to compute with": ("0.0007854", "1e-99", 13, "water.mass_per_length", "from 1e-30"),
    "water that is a number": (WATER, "water: 35\n", 12, "water = 35", "mass_per_length, speed, outlet"),
    "an outlet of nothing": (SPEED, f"{SPEED}\n  outlet: 0", 15, "water.outlet = 0", "greater than zero"),
    "a nozzle on a held end": (
        (DIRECTION, f"speed: {SPEED}"),
        (f"{DIRECTION}\n  end: pinned", f"speed: {SPEED}\n  outlet: 2"),
        16,
        "water.outlet = 2",
        "whose end is pinned has no jet",
    ),
    "a coupling misspelt": ("coupling: linear", "coupling: penaltee", 15, "coupling = penaltee", "'penalty'"),
    "a coupling of no water": (
        (WATER, "coupling: linear"),
        ("", "coupling: lagrange"),
        12,
        "coupling = lagrange",
        "no water",
    ),
    "water in a segment of a dry hose": (
        (SECTION, WATER),
        (SEGMENTS.replace("0.003}", "0.003, water_mass_per_length: 0.1}", 1), ""),
        5,
        "segments[0].water_mass_per_length = 0.1",
        "the scene has no water",
    ),
    "a stiffness of linear coupling": (
        "coupling: linear",
        "coupling: linear\nstiffness: 1.0e4",
        16,
        "stiffness = 1.0e4",
        "coupling linear has no springs",
    ),
    "a stiffness of multipliers": (
        "coupling: linear",
        "stiffness: 1.0e4\ncoupling: lagrange",
        15,
        "stiffness = 1.0e4",
        "is not used",
    ),
    "a penalty of nothing": ("coupling: linear", "coupling: penalty\nstiffness: 0", 16, "stiffness = 0", "than zero"),
    # gravity, start, motion
    "gravity as a word": ("[0, 0, -9.81]", "down", 16, "gravity = down", "an acceleration such as"),
    "gravity upwards as a number": ("[0, 0, -9.81]", "-9.81", 16, "gravity = -9.81", "must not be negative"),
    "gravity of two": ("[0, 0, -9.81]", "[0, -9.81]", 16, "gravity", "has 2 entries, not 3"),
    "gravity left empty": ("[0, 0, -9.81]", "", 16, "gravity", "is empty"),
    "gravity without end": ("[0, 0, -9.81]", "[0, 0, -1e99]", 16, "gravity", "computed with"),
    "a disturbance of one number": ("solver:", "disturbance: 0.1\nsolver:", 17, "disturbance = 0.1", "x, y and z"),
    "a disturbance of a held tip": (
        (DIRECTION, "solver:"),
        (f"{DIRECTION}\n  end: clamped", "disturbance: [0, 1, 0]\nsolver:"),
        18,
        "disturbance",
        "the tip, which is clamped",
    ),
    "an unknown start": ("solver:", "start: statical\nsolver:", 17, "start = statical", "did you mean 'static'"),
    "a rest of a free pendulum": (
        (DIRECTION, "gravity: [0, 0, -9.81]"),
        (f"{DIRECTION}\n  root_support: pinned", "gravity: 0\nstart: static"),
        18,
        "start = static",
        "free to turn",
    ),
    "a rest of a limp hose": (
        ("0.00108 ", "gravity: [0, 0, -9.81]"),
        ("0 ", "gravity: [0, 0, 0]\nstart: static"),
        17,
        "start = static",
        "nothing straightens",
    ),
    # the whole
    "an unknown part": ("water:", "watter:", 12, "watter", "did you mean 'water'"),
    "no hose": (WHOLE, "", 1, "hose", "add `hose:`, such as {length: 0.5"),
    "a hose that is a number": (WHOLE, "hose: 3\n", 3, "hose = 3", "is not a mapping; write a mapping of keys"),
    "a title of a list": ("Garden hose, 35 m/s", "[1]", 2, "title", "must be a text"),
    "no solver": (re.search(r"solver: .*\n", TEXT)[0], "", 1, "solver", "add `solver:`, such as {method"),
    "a step of nothing": ("step: 1 ms", "step: 0", 17, "solver.step = 0", "greater than zero"),
    "frames between steps": ("interval: 5 ms", "interval: 0.1 ms", 18, "output.interval = 0.1 ms", "at least solver"),
    "a duplicate key": ("  elements: 10\n", "  elements: 10\n  elements: 12\n", 6, "hose.elements", "duplicate"),
}


def edited(old, new):
    """The shipped scene with one or several places replaced."""
    text = TEXT
    for before, after in zip(*([old], [new]) if isinstance(old, str) else (old, new), strict=True):
        assert before in text, before
        text = text.replace(before, after, 1)
    return text


def scene_of(*edits):
    """The shipped scene with (old, new) replaced, parsed."""
    return HoseScene.parse(edited([old for old, _ in edits], [new for _, new in edits]))


def test_the_table_holds_more_than_forty_broken_scenes():
    assert len(EDITS) > 40


@pytest.mark.parametrize("name", EDITS)
def test_a_broken_scene_is_refused_with_line_key_and_cure(name):
    old, new, line, key, cure = EDITS[name]
    with pytest.raises(SceneError) as caught:
        HoseScene.parse(edited(old, new), "hose.yaml")
    message = str(caught.value)
    found = [m for m in message.splitlines() if m.startswith(f"hose.yaml:{line}: ") and key in m.split("; ")[0]]
    assert any(cure in m for m in found), message
    assert all("; " in m for m in message.splitlines()), f"a cure is missing: {message}"


def test_several_faults_are_told_at_once():
    text = edited(("elements: 10", SPEED, "coupling: linear"), ("elements: 0", "fast", "coupling: lineer"))
    with pytest.raises(SceneError) as caught:
        HoseScene.parse(text)
    assert [problem.line for problem in caught.value.problems] == [5, 14, 15]


def test_every_lacking_key_of_a_section_is_named():
    text = edited(SECTION, "  length: 0.5\n  elements: 4\n")
    with pytest.raises(SceneError) as caught:
        HoseScene.parse(text)
    assert [p.key for p in caught.value.problems] == [
        f"hose.{key}" for key in ("axial_stiffness", "bending_stiffness", "mass_per_length")
    ]


@pytest.mark.parametrize("name", ["a negative mass", "no elements", "speed as text", "a direction of nothing"])
def test_check_exits_2_with_the_line_and_no_traceback(name, tmp_path, capsys):
    old, new, line, key, cure = EDITS[name]
    path = tmp_path / "scene.yaml"
    path.write_text(edited(old, new))
    with pytest.raises(SystemExit) as left:
        run(make_app(Gardenhose(), ["check"]), ["check", str(path)])
    printed = re.sub(r"\s+", " ", "".join(capsys.readouterr()))
    assert left.value.code == 2
    assert f"scene.yaml:{line}: " in printed and key in printed and cure in printed and "Traceback" not in printed


# Good scenes


def test_the_shipped_scene_is_table_2_2():
    scene = read(HOSE)
    (piece,) = scene.hose.pieces
    assert (piece.length, piece.elements, piece.axial_stiffness, piece.bending_stiffness) == (0.5, 10, 10.0, 0.00108)
    assert (piece.mass_per_length, piece.damping, piece.water_mass_per_length) == (0.0031316, 0.0031316, 0.0007854)
    assert isinstance(scene.water.speed, Ramp) and scene.water.speed.to == 35.0
    assert scene.gravity == (0.0, 0.0, -9.81)
    assert scene.document.path == HOSE


def test_what_is_left_out_is_the_plainest_hose():
    text = edited((WATER, "coupling: linear               #"), ("", "#"))
    scene = HoseScene.parse(re.sub(r"(?m)^(gravity:|  root:|  direction:|  damping:).*\n", "", text))
    hose = scene.hose
    assert (hose.root, hose.direction) == ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    assert (hose.clamp, hose.root_support, hose.end) == ("direction", "clamped", "free")
    assert (hose.tip_mass, hose.strain, hose.pieces[0].damping) == (0.0, "green", 0.0)
    assert (scene.water, scene.coupling, scene.stiffness, scene.start) == (None, "linear", None, "straight")
    assert (scene.gravity, scene.disturbance) == ((0.0, 0.0, -9.81), (0.0, 0.0, 0.0))
    assert hose.pieces[0].water_mass_per_length is None


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("9.81", (0.0, 0.0, -9.81)),
        ("9.81 m/s^2", (0.0, 0.0, -9.81)),
        ("[0, 981 cm/s^2, 0]", (0.0, 9.81, 0.0)),
        ("0", (0.0,) * 3),
    ],
)
def test_gravity_is_a_number_downwards_or_a_vector(written, meant):
    scene = scene_of(("[0, 0, -9.81]", written), ("solver:", "disturbance: [0, 1 cm/s, 0]\nsolver:"))
    assert scene.gravity == pytest.approx(meant, abs=1e-12)
    assert scene.disturbance == (0.0, 0.01, 0.0)


def test_segments_carry_the_water_of_the_hose_but_where_they_give_their_own():
    narrow = SEGMENTS[: SEGMENTS.rindex("}")] + ", water_mass_per_length: 0.5 g/m, damping: 1 ms}\n"
    scene = scene_of((SECTION, narrow), ("[0, 0, 0]", "[0, 1 ft, 0]"), (DIRECTION, "direction: [0, 0, -3]"))
    assert [piece.water_mass_per_length for piece in scene.hose.pieces] == [0.0007854, 0.0005]
    assert [piece.damping for piece in scene.hose.pieces] == [0.0, 0.001]
    assert scene.hose.total_length == 0.5 and scene.hose.element_count == 10
    assert scene.hose.unit_direction == (0.0, 0.0, -1.0) and scene.hose.root == (0.0, 0.3048, 0.0)


@pytest.mark.parametrize("size", [1.0, 1e-300, 1e300, 5e-324])
def test_the_length_of_the_direction_does_not_matter(size):
    scene = scene_of((DIRECTION, f"direction: [{size!r}, 0, {size!r}]"))
    assert scene.hose.unit_direction == pytest.approx((math.sqrt(0.5), 0.0, math.sqrt(0.5)), rel=1e-15)


@pytest.mark.parametrize(
    "edits",
    [
        [(DIRECTION, f"{DIRECTION}\n  root_support: pinned\n  end: pinned")],
        [(DIRECTION, f"{DIRECTION}\n  root_support: pinned"), ("solver:", "start: static\nsolver:")],
        [(DIRECTION, f"{DIRECTION}\n  end: CLAMPED\n  clamp: slope\n  strain: engineering")],
        [(SPEED, "-3 ft/s\n  outlet: 2")],
        [(SPEED, "{sum: [{constant: 9}, {harmonic: {amplitude: 1, frequency: 4 Hz}}]}")],
        [("coupling: linear", "coupling: penalty\nstiffness: 1 kN/m")],
        [("coupling: linear", "coupling: Augmented\nstiffness: null")],
        [(WATER, "")],
        [("0.00108 ", "0 ")],
        [("gravity: [0, 0, -9.81]", "gravity: 0\nstart: static")],
    ],
)
def test_a_good_variant_is_read(edits):
    assert scene_of(*edits).hose.total_length == 0.5


@pytest.mark.parametrize("name", Gardenhose().templates)
def test_a_template_is_good_without_a_warning_and_begins_with_what_it_is(name):
    text = Gardenhose().templates[name]
    assert text.startswith("# ")
    scene = HoseScene.parse(text)
    assert warnings(scene) == []
    assert Gardenhose().recognises(scene.document.root)


def test_the_hose_template_is_the_shipped_scene():
    template, shipped = HoseScene.parse(Gardenhose().templates["hose"]), read(HOSE)
    assert template.model_dump() == shipped.model_dump()


def test_a_speed_can_be_put_in_place_of_the_scene_s():
    scene = with_speed(read(HOSE), np.float64(12.0))
    assert scene.water.speed == Constant(value=12.0) and scene.hose == read(HOSE).hose
    assert scene.hose.pieces[0].water_mass_per_length == 0.0007854
    assert with_speed(scene, -3).water.speed.value == -3.0
    made = HoseScene(hose=scene.hose, water=scene.water, solver=scene.solver, output=scene.output)
    assert with_speed(made, 7.0).water.speed.value == 7.0


@pytest.mark.parametrize(("edit", "value"), [((WATER, ""), 3.0), ((SPEED, "3"), math.nan)])
def test_a_speed_of_nothing_or_no_speed_is_refused(edit, value):
    with pytest.raises(SceneError, match=r"is missing: nothing can flow|--speed nan: is not a finite"):
        with_speed(scene_of(edit), value)


def test_overrides_reach_the_solver_and_faults_name_the_option():
    application = Gardenhose()
    scene = application.with_overrides(read(HOSE), method="newmark", step=1e-4, end=0.5)
    assert (scene.solver.method, scene.solver.step, scene.solver.end) == ("newmark", 1e-4, 0.5)
    with pytest.raises(SceneError, match=r"--step: solver.step = -1"):
        application.with_overrides(read(HOSE), step=-1.0)


def test_the_schema_knows_every_key_of_the_shipped_scenes():
    schema = json_schema()
    assert schema["type"] == "object" and set(schema["required"]) == {"hose", "solver", "output"}
    text = json.dumps(schema)
    for scene in (TEXT, *Gardenhose().templates.values()):
        for key in re.findall(r"(\w+):(?=\s)", re.sub(r"#.*", "", scene)):
            assert f'"{key}"' in text, key


# Warnings


def found(*edits):
    """Warnings of the shipped scene with (old, new) replaced: where -> text."""
    return {warning.where: warning.text for warning in warnings(scene_of(*edits))}


RK4 = "method: generalized-alpha, rho_inf: 0.9, step: 1 ms", "method: rk4, step: "

WARNED = {
    "rk4 by damping": ([(RK4[0], RK4[1] + "0.1 ms")], "solver.step", "c omega / 2 = 20.4"),
    "rk4 undamped": ([(RK4[0], RK4[1] + "0.25 ms"), ("damping: 0.00", "damping: 0 # ")], "solver.step", "0.00021 s"),
    "a long step": ([("step: 1 ms", "step: 10 ms"), ("5 ms", "10 ms")], "solver.step", "period of flutter"),
    "a long step at rest": (
        [("step: 1 ms", "step: 100 ms"), ("5 ms", "100 ms"), (SPEED, "1")],
        "solver.step",
        "first natural frequency",
    ),
    "frames between the steps": ([("step: 1 ms", "step: 0.9 ms")], "output.interval", "0.000833333 s"),
    "a soft hose": ([(SPEED, "60")], "hose.axial_stiffness", "28 % of EA"),
    "water faster than its hose": ([(SPEED, "120")], "hose.axial_stiffness", "faster than 113 m/s"),
    "elements too long for the flow": ([(SPEED, "50")], "hose.elements", "Take 16"),
    "elements too long for the weight": ([("0.00108 ", "1e-6 "), (SPEED, "0")], "hose.elements", "within 0.0072 m"),
    "a flow in a limp hose": ([("0.00108 ", "0 ")], "hose.bending_stiffness", "shortest waves"),
    "aspiration": ([("35.0", "-35.0")], "water.speed", "drawn in at the tip"),
    "aspiration for a moment": ([(SPEED, "{harmonic: {amplitude: 3, period: 1}}")], "water.speed", "down to -3 m/s"),
    "aspiration through a nozzle": ([(SPEED, "-3\n  outlet: 2")], "water.outlet", "Set it to 1"),
    "a diffuser": ([(SPEED, "3\n  outlet: 0.5")], "water.outlet", "slower than the water"),
    "no gravity": ([("[0, 0, -9.81]", "0")], "disturbance", "gravity is zero"),
    "gravity along the hose": ([(DIRECTION, "direction: [0, 0, -2]")], "disturbance", "acts along the hose"),
    "a disturbance along the hose": (
        [("[0, 0, -9.81]", "0\ndisturbance: [1, 0, 0]")],
        "disturbance",
        "Give `disturbance`",
    ),
    "a held hose that nothing moves": (
        [("[0, 0, -9.81]", "0"), (DIRECTION, f"{DIRECTION}\n  end: pinned")],
        "gravity",
        "a little of gravity",
    ),
    "a mass that hangs on a support": (
        [(DIRECTION, f"{DIRECTION}\n  end: pinned\n  tip_mass: 1")],
        "hose.tip_mass",
        "has no effect",
    ),
}


@pytest.mark.parametrize("name", WARNED)
def test_a_warning_names_its_place_and_cause(name):
    edits, where, words = WARNED[name]
    assert words in found(*edits).get(where, ""), found(*edits)


QUIET = {
    "the shipped scene": [],
    "rk4 within its damping": [(RK4[0], RK4[1] + "5 us")],
    "rk4 without damping": [(RK4[0], RK4[1] + "0.2 ms"), ("damping: 0.00", "damping: 0 # ")],
    "more elements for more flow": [(SPEED, "45"), ("elements: 10", "elements: 16")],
    "a frame of many steps": [("step: 1 ms", "step: 0.1 ms")],
    "a step that is chosen": [("step: 1 ms", "step: auto")],
    "no water": [(WATER, "")],
    "a limp hose without flow": [("0.00108 ", "0 "), (SPEED, "0")],
    "flow towards the root of a held hose": [("35.0", "-3.0"), (DIRECTION, f"{DIRECTION}\n  end: clamped")],
    "a nozzle": [(SPEED, f"{SPEED}\n  outlet: 2")],
    "a disturbed hose without gravity": [("[0, 0, -9.81]", "0\ndisturbance: [0, 0.01, 0]")],
    "gravity a little across": [(DIRECTION, "direction: [0.001, 0, -1]")],
}


@pytest.mark.parametrize("name", QUIET)
def test_there_is_no_warning_without_a_cause(name):
    assert found(*QUIET[name]) == {}


def test_a_warning_about_a_segment_names_it():
    second = PIECE.replace("bending_stiffness: 0.001", "bending_stiffness: 0.00001")
    where = set(found((SECTION, SEGMENTS.replace(PIECE, second).replace(second, PIECE, 1))))
    assert where == {"hose.segments[1].elements"}


# Estimates


def test_an_undamped_element_s_axial_limit_is_the_effective_length_of_the_thesis():
    # Table 2.1, pinned-free: L_eff = 0.19 L_e (0.1914 here); h = 2.8 L_eff / (2 S), eq. 2.151; no water, no bending
    bar = [("elements: 10", "elements: 1"), ("0.00108 ", "0 "), ("damping: 0.00", "damping: 0 # "), (WATER, "")]
    sound = math.sqrt(10.0 / 0.0031316)
    limit = rk4_limit(scene_of(*bar))
    assert limit.motion == "axial"
    assert limit.step == pytest.approx(2.8 * 0.19144 * 0.5 / (2.0 * sound), rel=1e-3)


def test_the_step_of_table_2_2_is_set_by_its_damping():
    damped, plain = rk4_limit(read(HOSE)), rk4_limit(scene_of(("damping: 0.00", "damping: 0 # ")))
    omega = 2.8 / plain.step
    assert damped.undamped == plain.step
    assert damped.step == pytest.approx(2.785294 / (0.0031316 * omega**2), rel=2e-3)


def test_a_run_stops_above_the_step_that_check_names_and_goes_on_below():
    limit = rk4_limit(read(HOSE)).step
    system = assembled(read(HOSE)).system
    found, _ = CriticalStep(system).search(new_state(system), 0.0)
    assert found == pytest.approx(limit, rel=0.01)


def test_a_hose_in_segments_of_one_section_has_the_critical_step_of_the_whole():
    whole = rk4_limit(read(HOSE)).step
    same = re.sub(r"\s*#.*", "", SECTION).replace("0.5", "0.25").replace("10\n", "5\n", 1)
    piece = "{" + ", ".join(line.strip() for line in same.strip().splitlines()) + "}"
    parts = rk4_limit(scene_of((SECTION, f"  segments: [{piece}, {piece}]\n"))).step
    assert parts == pytest.approx(whole, rel=1e-3)


def test_the_figures_are_those_of_table_2_2():
    figure = figures(read(HOSE))
    hose, flow = figure["hose"], figure["flow"]
    assert hose["mass"] == pytest.approx(0.0015658) and hose["water"] == pytest.approx(0.0003927)
    assert hose["mass_ratio"] == pytest.approx(0.2005, abs=1e-4)
    assert hose["gravity"] == pytest.approx(0.003917 * 9.81 * 0.125 / 0.00108, rel=1e-4)
    assert hose["first_frequency"] == pytest.approx(3.516 / (2 * math.pi) * math.sqrt(0.00108 / 0.003917) / 0.25, 1e-3)
    assert flow["largest_speed"] == 35.0
    assert flow["dimensionless_speed"] == pytest.approx(0.5 * 35.0 * math.sqrt(0.0007854 / 0.00108))
    assert flow["critical_speed"] == pytest.approx(13.1, abs=0.1)
    json.dumps(figure, allow_nan=False)


@pytest.mark.parametrize(("ends", "u"), [(("clamped", "clamped"), 2 * math.pi), (("pinned", "pinned"), math.pi)])
def test_a_held_pipe_diverges_at_euler_s_load(ends, u):
    scene = scene_of((DIRECTION, f"{DIRECTION}\n  root_support: {ends[0]}\n  end: {ends[1]}"))
    flow = figures(scene)["flow"]
    assert flow["critical_speed"] == pytest.approx(u / 0.5 * math.sqrt(0.00108 / 0.0007854))
    assert flow["critical_frequency"] == 0.0


def test_what_cannot_be_estimated_is_none():
    limp = figures(scene_of(("0.00108 ", "0 ")))
    assert limp["hose"]["gravity"] is None and limp["flow"]["critical_speed"] is None
    swinging = figures(scene_of((DIRECTION, f"{DIRECTION}\n  root_support: pinned")))
    assert swinging["hose"]["first_frequency"] is None and swinging["flow"]["critical_speed"] is None
    assert figures(scene_of((WATER, "")))["flow"] is None


def test_the_speed_is_sampled_over_the_run():
    sampled = speeds(scene_of((SPEED, "{ramp: {to: 40, over: 2, from: -1}}")))
    assert sampled.min() == -1.0 and sampled.max() == pytest.approx(40.0)


# Anything at all

VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from([1e-30, 1e30, 1e-300, 1e300, [0, 0, 1e30], [1e-300, 0, 0], 1, 2000, "static", "pinned"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
KEYS = [("hose", key) for key in ("length", "elements", "axial_stiffness", "bending_stiffness", "mass_per_length")]
KEYS += [("hose", key) for key in ("damping", "segments", "root", "direction", "end", "tip_mass", "root_support")]
KEYS += [("water",), ("water", "mass_per_length"), ("water", "speed"), ("water", "outlet"), ("gravity",), ("start",)]
KEYS += [("disturbance",), ("coupling",), ("stiffness",), ("hose",)]


@settings(max_examples=50, deadline=None)
@given(st.dictionaries(st.sampled_from(KEYS), VALUES, min_size=1, max_size=3), st.booleans())
def test_any_value_in_any_place_is_read_or_refused_and_nothing_else(values, explicit):
    document = Document.parse(TEXT, "hose.yaml")
    changes = {key: (value, "vary") for key, value in sorted(values.items(), key=lambda item: len(item[0]))}
    if explicit:
        changes |= {("solver", "method"): ("rk4", "vary")}
    try:
        scene = validate(HoseScene, document.replaced(changes))
    except SceneError as error:
        assert error.problems and all(problem.cure for problem in error.problems)
        return
    assert all(warning.where and "nan" not in warning.text for warning in warnings(scene))
    json.dumps(figures(scene))


def test_a_scene_with_other_values_is_the_one_that_a_file_with_them_gives():
    scene = read(Document.parse(TEXT, "hose.yaml"))
    values = {("hose", "elements"): 7, ("solver", "end"): 0.5}
    document = Document.parse(TEXT, "hose.yaml").replaced({path: (value, "vary") for path, value in values.items()})
    for changed in (scene.varied(values, "vary"), scene.with_values({k: (v, "vary") for k, v in values.items()})):
        assert changed.model_dump() == validate(HoseScene, document).model_dump() != scene.model_dump()
        assert changed.written == document.root
    with pytest.raises(SceneError, match="put together in Python"):
        HoseScene.model_construct(**dict(scene)).written  # noqa: B018
