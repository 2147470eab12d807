"""A scene of a crane is read as meant, or refused with line, key and cure."""

import json
import math
import re
from pathlib import Path

import pytest
from broken_cranes import BLOCK, BROKEN, FOLDER, JIB, MOTION, PAY_OUT, PAYLOAD, TEXTS, TIP
from hypothesis import given, settings
from hypothesis import strategies as st

from crane.application import Crane
from crane.scene.scene import (
    Anchor,
    Body,
    CraneScene,
    Drum,
    Efficiency,
    End,
    Layers,
    Motion,
    MotionFile,
    Rope,
    SeaMotion,
    Sheave,
    Vessel,
    json_schema,
    read,
)
from tautline.cli.run import run
from tautline.cli.verbs import make_app
from tautline.scene.errors import SceneError
from tautline.scene.functions import Constant, Harmonic, Ramp, Spectrum, Table
from tautline.scene.model import Model, validate
from tautline.scene.reading.document import Document
from tautline.scene.solver import Output, Solver


def edited(scene, *edits):
    """A shipped text with (old, new) replaced, each once."""
    text = TEXTS[scene]
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text


def scene_of(scene, *edits):
    return CraneScene.parse(edited(scene, *edits))


def test_the_table_holds_more_than_sixty_broken_scenes():
    assert len(BROKEN) > 60


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_scene_is_refused_with_line_key_and_cure(name):
    scene, old, new, line, key, words, *more = BROKEN[name]
    with pytest.raises(SceneError) as caught:
        CraneScene.parse(edited(scene, (old, new), *more), "crane.yaml")
    message = str(caught.value)
    found = [m for m in message.splitlines() if m.startswith(f"crane.yaml:{line}: ") and key in m.split("; ")[0]]
    assert any(words in m for m in found), message
    assert all("; " in m for m in message.splitlines()), f"a cure is missing: {message}"


def test_several_faults_are_told_at_once():
    edits = (("mass: 5 t", "mass: -5 t"), ("radius: 0.5", "radius: 0"), ("law: no_slip", "law: noslip"))
    with pytest.raises(SceneError) as caught:
        scene_of("hoist", *edits)
    assert [problem.line for problem in caught.value.problems] == [12, 14, 17]


@pytest.mark.parametrize("name", ["a negative mass", "a drum of two drives", "a capstan without friction"])
def test_check_exits_2_with_the_line_and_no_traceback(name, tmp_path, capsys):
    scene, old, new, line, key, words, *more = BROKEN[name]
    path = tmp_path / "scene.yaml"
    path.write_text(edited(scene, (old, new), *more))
    with pytest.raises(SystemExit) as left:
        run(make_app(Crane(), ["check"]), ["check", str(path)])
    printed = re.sub(r"\s+", " ", "".join(capsys.readouterr()))
    assert left.value.code == 2
    assert f"scene.yaml:{line}: " in printed and key in printed and words in printed and "Traceback" not in printed


# Good scenes


def lost(written, read_as, at=""):
    """Keys of the file that the model does not hold as given."""
    if isinstance(written, dict) and len(written) == 1 and not set(written) & set(type(read_as).model_fields):
        ((key, inner),) = written.items()
        if isinstance(read_as, Constant):
            return [] if key == "constant" else [f"{at}.{key}"]
        found = type(read_as).__name__.lower() == key
        return lost(inner, read_as, f"{at}.{key}") if found else [f"{at}.{key}"]
    if isinstance(written, dict):
        given = {(info.alias or name): name for name, info in type(read_as).model_fields.items()}
        here = [f"{at}.{key}" for key in written if given.get(key) not in read_as.model_fields_set]
        return here + [
            x for k, v in written.items() if k in given for x in lost(v, getattr(read_as, given[k]), f"{at}.{k}")
        ]
    if isinstance(written, list):
        assert len(written) == len(read_as)
        return [x for i, (v, r) in enumerate(zip(written, read_as, strict=True)) for x in lost(v, r, f"{at}[{i}]")]
    assert not isinstance(read_as, Model) or isinstance(read_as, Constant), at
    return []


@pytest.mark.parametrize("name", TEXTS)
def test_a_shared_scene_is_read_with_every_key_kept(name):
    scene = read(FOLDER / f"{name}.yaml")
    assert lost(scene.document.root, scene) == []
    assert Crane().recognises(scene.document.root)


def test_four_scenes_are_shared():
    assert set(TEXTS) == {"hoist", "hookblock", "landing", "slewing"}


def test_the_hoist_is_what_it_says():
    scene = read(FOLDER / "hoist.yaml")
    winch, tip, hook = scene.path
    assert (type(winch), type(tip), type(hook)) == (Drum, Sheave, End)
    assert (scene.rope.axial_stiffness, scene.rope.breaking_load, scene.rope.diameter) == (8.0e7, 1.1e6, 0.036)
    assert isinstance(winch.pay_out, Ramp) and (winch.pay_out.to, winch.drive, winch.prescribed) == (
        -2.0,
        "pay_out",
        True,
    )
    assert (tip.law, tip.inertia, tip.bearing.radius) == ("no_slip", 20.0, 0.06)
    assert tip.unit_axis == (0.0, 1.0, 0.0) and tip.fleet_limit == pytest.approx(math.radians(4.0))
    assert scene.body(hook.body).mass == 5000.0 and scene.body("payload").position == (12.4, 0.0, 5.0)
    assert isinstance(scene.vessel.motion, Motion) and isinstance(scene.vessel.motion.heave, Harmonic)
    assert scene.vessel.motion.roll == scene.vessel.motion.yaw == Constant(value=0.0)
    assert scene.elements == (4, 4) and scene.sheaves == (tip,) and scene.drums == (winch,)
    assert scene.folder == FOLDER


def test_the_landing_is_what_it_says():
    scene = read(FOLDER / "landing.yaml")
    template, (drum,) = scene.body("template"), scene.drums
    assert template.added_mass == (0.0, 0.0, 6.0e4) and template.drag.quadratic == (0.0, 0.0, 2.0e5)
    assert isinstance(drum.pay_out, Table) and drum.layers is None
    assert isinstance(scene.vessel.motion.heave, Spectrum) and scene.vessel.motion.heave.rao == 0.6
    assert scene.heave_compensation.limits.acceleration == 2.0 and scene.water.rope_drag == 1.2


def test_what_is_left_out_is_the_plainest_crane():
    scene = CraneScene.parse(Crane().templates["lift"])
    (drum,), (tip,), (crate,) = scene.drums, scene.sheaves, scene.bodies
    assert (tip.law, tip.inertia, tip.friction, tip.groove, tip.bearing) == ("frictionless", 0.0, None, None, None)
    assert (drum.inertia, drum.brake, drum.layers, drum.rope_on_drum) == (None, None, None, None)
    assert (crate.velocity, crate.guide, crate.inertia, crate.release, crate.force) == (
        (0.0,) * 3,
        (),
        None,
        None,
        None,
    )
    assert (crate.volume, crate.bottom, crate.spring) == (0.0, 0.0, None)
    assert (scene.rope.bending_stiffness, scene.rope.compression, scene.rope.diameter) == (0.0, "none", None)
    assert (scene.vessel, scene.water, scene.ground, scene.heave_compensation, scene.frames) == (
        None,
        None,
        None,
        None,
        (),
    )
    assert (scene.elements, scene.gravity, scene.start) == ((4, 4), (0.0, 0.0, -9.81), "static")


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("inertia: 3", "no_slip"),
        ("inertia: 0", "frictionless"),
        ("fleet_limit: 1 deg", "frictionless"),
        ("law: no slip", "no_slip"),
        ("law: Capstan, friction: 0.1", "capstan"),
        ("law: {efficiency: 98 %}", Efficiency(efficiency=0.98)),
    ],
)
def test_a_sheave_follows_the_law_it_is_given_or_the_usual_one(written, meant):
    assert scene_of("hoist", (TIP, written)).sheaves[0].law == meant


def test_a_groove_wedges_the_rope():
    sheave = scene_of("hookblock", (BLOCK, f"{BLOCK}, groove: 60 deg")).sheaves[1]
    assert sheave.groove_friction == pytest.approx(0.2)
    assert scene_of("hookblock").sheaves[1].groove_friction == 0.1


def test_layers_lie_in_the_hollows_of_the_ones_below():
    layers = Layers(turns=40, core_radius=1.2)
    assert layers.pitch_radius(1, 0.08) == pytest.approx(1.24)
    assert layers.pitch_radius(3, 0.08) == pytest.approx(1.24 + math.sqrt(3.0) * 0.08)
    assert layers.capacity(0.08) is None
    two = layers.model_copy(update={"count": 2})
    assert two.capacity(0.08) == pytest.approx(2.0 * math.pi * 40 * (2 * 1.24 + 0.5 * math.sqrt(3.0) * 0.08))


FRAMES = ("frame: boom, inertia", "frame: {}, inertia")


@pytest.mark.parametrize(
    ("frame", "vessel", "meant"),
    [
        ("boom", False, "boom"),
        ("ground", False, None),
        ("null", False, None),
        ("boom", True, "boom"),
        ("ground", True, None),
        ("null", True, "vessel"),
        ("vessel", True, "vessel"),
    ],
)
def test_what_says_nothing_rides_on_the_vessel_where_there_is_one(frame, vessel, meant):
    edits = [(FRAMES[0], FRAMES[1].format(frame))] + (
        [("mesh:", "vessel: {reference: [0, 0, 0]}\nmesh:")] if vessel else []
    )
    scene = scene_of("slewing", *edits)
    assert scene.frame_of(scene.item("boom tip")) == meant
    assert scene.frame_of(scene.item("winch")) == "boom" and scene.frame_of(scene.item("hook")) is None
    assert scene.frame_of(scene.frame("boom")) == ("vessel" if vessel else None)


def test_a_frame_may_stand_on_another_or_on_the_ground():
    scene = scene_of("slewing", ("mesh:", JIB + JIB.replace("jib", "mast").replace("boom", "ground") + "mesh:"))
    assert [scene.frame_of(frame) for frame in scene.frames] == [None, "boom", None]


def test_a_sheave_on_a_body_is_in_no_frame():
    scene = scene_of("hookblock", ("mesh:", "vessel: {reference: [0, 0, 0]}\nmesh:"))
    assert [scene.frame_of(item) for item in scene.path] == ["vessel", "vessel", None, "vessel"]


def test_items_are_found_by_name_and_by_place():
    scene = read(FOLDER / "hookblock.yaml")
    assert [scene.key_of(item) for item in scene.path] == [
        ("path", 0, "drum"),
        ("path", 1, "sheave"),
        ("path", 2, "sheave"),
        ("path", 3, "anchor"),
    ]
    assert scene.problem((*scene.key_of(scene.item("hook sheave")), "radius"), "is odd").line == 10
    for find in (scene.body, scene.item, scene.frame):
        with pytest.raises(KeyError, match="nobody"):
            find("nobody")


@pytest.mark.parametrize(
    ("solver", "controlled"),
    [
        ("step: 5 ms", True),
        ("step: 5 ms, control: fixed", False),
        ("step: 5 ms, control: error, step_error: 1e-5", True),
        ("step: auto", True),
        ("step: auto, control: fixed", True),
        ("method: newmark, step: 5 ms", True),
        ("method: rk4, step: 1 ms", False),
        ("method: rk4, step: auto", False),
    ],
)
def test_the_step_follows_its_error_unless_the_scene_says_otherwise(solver, controlled):
    scene = scene_of("hoist", ("method: generalized-alpha, rho_inf: 0.6, step: 5 ms", solver))
    assert scene.controlled is controlled


@pytest.mark.parametrize(
    ("motion", "meant"),
    [
        ("{file: mru.csv}", MotionFile(file="mru.csv")),
        (
            "{file: mru.csv, gap: 1 s, units: {t: ms, Roll: deg}, ramp: 20, begin: 1 min}",
            MotionFile(file="mru.csv", gap=1.0, units={"t": "ms", "Roll": "deg"}, ramp=20.0, begin=60.0),
        ),
        (
            "{sea: {significant_height: 2, peak_period: 9}, rao: ship.csv, direction: 180 deg}",
            SeaMotion(sea=Spectrum(significant_height=2.0, peak_period=9.0), rao="ship.csv", direction=math.pi),
        ),
        ("{}", Motion()),
        ("{pitch: {harmonic: {amplitude: 2 deg, period: 9}}}", None),
    ],
)
def test_a_vessel_moves_by_functions_by_a_file_or_in_a_sea(motion, meant):
    found = scene_of("hoist", (MOTION, motion)).vessel.motion
    assert found == meant if meant is not None else found.pitch.amplitude == pytest.approx(math.radians(2.0))


TORQUE = "torque: {ramp: {to: 30 kN m, over: 2}}, inertia: 900, friction_torque: 200"
GOOD = {
    "a drum of torque with a brake": [("hoist", (PAY_OUT, f"{TORQUE}, brake: {{torque: 40 kN m, until: 2}}"))],
    "a brake that closes": [
        ("hoist", (PAY_OUT, f"{TORQUE}, brake: {{torque: 40 kN m, closed: {{ramp: {{to: 1, over: 1}}}}}}"))
    ],
    "a winch of constant tension": [
        (
            "hoist",
            (PAY_OUT, "tension: 60 kN, inertia: 900, gains: {proportional: 2, integral: 1}, torque_limit: 90 kN m"),
        ),
    ],
    "a drum of given speed": [("hoist", (PAY_OUT, "speed: -3 rpm, rope_on_drum: 40 m"))],
    "compression with bending stiffness": [
        ("hoist", ("bending_stiffness: 0", "bending_stiffness: 90"), ("compression: none", "compression: elastic")),
    ],
    "a rope between two anchors": [
        (
            "hookblock",
            (
                "  - drum:   {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, "
                "pay_out: {ramp: {to: -1.0, over: 1.0}}}",
                "  - anchor: {name: other end, position: [0, 0, 9]}",
            ),
        ),
    ],
    "a drum at either end": [
        (
            "hookblock",
            (
                "  - anchor: {name: dead end, position: [13.1, 0, 30]}",
                "  - drum: {name: second, center: [25, 0, 1], radius: 1, axis: [0, 1, 0], wrap: over, speed: 0}",
            ),
        ),
    ],
    "a body of all kinds": [
        (
            "landing",
            (
                "mass: 100 t",
                "mass: 100 t, volume: 13, velocity: [0, 0, -1], guide: [x, y], bottom: 2, "
                "inertia: [9, 9, 9], orientation: [0, 0, 90 deg], release: {at: 5, remaining: 0}, "
                "spring: {stiffness: [1, 1, 0], rest: [60, 0, 0]}, force: [0, 1 kN, {ramp: {to: 2, over: 1}}]",
            ),
            ("mesh:", "ground: {level: -2 km, stiffness: 1.0e6, damping: 9, friction: 0.4}\nmesh:"),
        ),
    ],
    "a sheave about an upright axis": [
        ("hoist", ("radius: 0.4, axis: [0, 1, 0], wrap: over", "radius: 0.4, axis: [0, 0, -3], wrap: left")),
    ],
    "a body and an end of one name": [("hoist", ("name: hook", "name: payload"))],
    "a body that stands on the ground": [
        (
            "hoist",
            (PAYLOAD, f"{PAYLOAD}, bottom: 1"),
            ("mesh:", "ground: {level: 4, stiffness: 1}\nmesh:"),
            ("[0, 0, 0], radius: 0.5", "[0, 0, 6], radius: 0.5"),
        ),
    ],
    "tiny and large in their places": [
        ("hoist", ("[12.4, 0, 5]", "[12.4, 1e-40, 5]"), ("[0, 0, -10]", "[5e6, 0, 1e-35]"))
    ],
    "no gravity": [("hoist", ("[0, 0, -9.81]", "0"), ("start: static", "start: As Drawn"))],
    "a mesh for each span": [("hoist", ("span: 4", "span: [2, 7]"))],
}


@pytest.mark.parametrize("name", GOOD)
def test_a_good_variant_is_read(name):
    for scene, *edits in GOOD[name]:
        assert len(scene_of(scene, *edits).path) in (3, 4)


def test_a_scene_can_be_made_in_python():
    path = (Anchor(name="top", position=(0.0, 0.0, 9.0)), End(name="hook", body="load"))
    bodies = (Body(name="load", mass=10.0, position=(0.0, 0.0, 1.0)),)
    rope = Rope(mass_per_length=1.0, axial_stiffness=1.0e6)
    scene = CraneScene(
        rope=rope,
        bodies=bodies,
        path=path,
        vessel=Vessel(reference=(0.0, 0.0, 0.0), motion=Motion()),
        solver=Solver(step=0.01, end=1.0),
        output=Output(interval=0.1),
    )
    assert scene.frame_of(path[0]) == "vessel" and scene.controlled and scene.folder == Path()


@pytest.mark.parametrize("name", Crane().templates)
def test_a_template_is_good_and_begins_with_what_it_is(name):
    text = Crane().templates[name]
    assert text.startswith("# ") and max(map(len, text.splitlines())) <= 120
    assert CraneScene.parse(text).title


@pytest.mark.parametrize("name", TEXTS)
def test_a_template_is_the_shared_scene(name):
    assert CraneScene.parse(Crane().templates[name]).model_dump() == read(FOLDER / f"{name}.yaml").model_dump()


def test_overrides_reach_the_solver_and_faults_name_the_option():
    scene = Crane().with_overrides(read(FOLDER / "hoist.yaml"), method="newmark", step=1e-3, end=0.5)
    assert (scene.solver.method, scene.solver.step, scene.solver.end, scene.controlled) == ("newmark", 1e-3, 0.5, True)
    with pytest.raises(SceneError, match=r"--end: solver.end = -1"):
        Crane().with_overrides(scene, end=-1.0)


def test_the_schema_knows_every_key_of_the_scenes():
    schema = json_schema()
    assert schema["type"] == "object" and set(schema["required"]) == {"rope", "path", "solver", "output"}
    text = json.dumps(schema)
    for scene in (*TEXTS.values(), *Crane().templates.values()):
        for key in re.findall(r"(\w+):(?=\s)", re.sub(r"#.*", "", scene)):
            assert f'"{key}"' in text, key


# Anything at all

VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from([1e-30, 1e30, 1e-300, [0, 0, 1e30], [0, 1, 0], 1, "static", "capstan", "boom tip", "winch"]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
PLACES = [("rope", key) for key in Rope.model_fields] + [("bodies", 0, key) for key in Body.model_fields]
PLACES += [("path", 0, "drum", key) for key in Drum.model_fields]
PLACES += [("path", 2, "sheave", key) for key in Sheave.model_fields]
PLACES += [("path",), ("path", 1), ("path", 3, "anchor", "position"), ("mesh", "elements_per_span"), ("bodies",)]
PLACES += [("vessel",), ("vessel", "motion"), ("water",), ("ground",), ("heave_compensation",), ("frames",), ("start",)]


@settings(max_examples=50, deadline=None)
@given(st.dictionaries(st.sampled_from(PLACES), VALUES, min_size=1, max_size=3))
def test_any_value_in_any_place_is_read_or_refused_and_nothing_else(values):
    document = Document.parse(TEXTS["hookblock"], "hookblock.yaml")
    changes = {key: (value, "vary") for key, value in sorted(values.items(), key=lambda item: len(item[0]))}
    try:
        scene = validate(CraneScene, document.replaced(changes))
    except SceneError as error:
        assert error.problems and all(problem.cure for problem in error.problems)
        return
    assert len(scene.elements) == len(scene.path) - 1
