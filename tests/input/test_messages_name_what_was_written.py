"""A message points at the line and the key that a person wrote, and repeats the value as it was written."""

from pathlib import Path

import pytest
from cli.in_process import commands_of, only_object

import tautline
from crane.application import Crane
from drillstring.application import Drillstring
from gardenhose.application import Gardenhose
from tautline.cli.output.summary import _along
from tautline.scene.errors import SceneError

DATA = Path(__file__).parents[2] / "data"
JWELL = (DATA / "jwell.yaml").read_text(encoding="utf8")
HOIST = (DATA / "hoist.yaml").read_text(encoding="utf8")
LANDING = (DATA / "landing.yaml").read_text(encoding="utf8")
HOSE = (DATA / "hose.yaml").read_text(encoding="utf8")


def changed(folder, text, *edits):
    """A scene's file with (old, new) replaced, each once."""
    for old, new in edits:
        assert old in text, old
        text = text.replace(old, new, 1)
    path = folder / "scene.yaml"
    path.write_text(text, encoding="utf8")
    return path


def line_of(path, word):
    """Number of the only line that has a word."""
    (line,) = [n for n, text in enumerate(path.read_text(encoding="utf8").splitlines(), 1) if word in text]
    return line


def refusals(application, path):
    with pytest.raises(SceneError) as caught:
        application.warnings(application.read(path))
    return str(caught.value).splitlines()


def test_a_small_sheave_is_told_with_its_line_and_the_radius_that_the_file_says(tmp_path):
    path = changed(tmp_path, HOIST, ("radius: 0.4", "radius: 0.285"))
    crane = Crane()
    text = next(str(one) for one in crane.warnings(crane.read(path)) if "D/d" in one.text)
    line = line_of(path, "radius: 0.285")
    # 570 mm on 36 mm: 15.83
    assert text.startswith(f"path[1].sheave.radius (line {line}): sheave diameter 0.57 m (2 x radius 0.285 m) on 36 mm")
    assert "D/d 15.8, below 16" in text


@pytest.mark.parametrize(
    ("motion", "key"),
    [("{file: mru.csv}", "file"), ("{sea: {significant_height: 2.5, peak_period: 9}, rao: mru.csv}", "rao")],
)
def test_a_vessel_s_file_that_is_missing_is_refused_at_the_scene_s_line_and_key(tmp_path, motion, key):
    old = next(text for text in HOIST.splitlines() if text.startswith("  motion: "))
    path = changed(tmp_path, HOIST, (old, f"  motion: {motion}"))
    (told,) = refusals(Crane(), path)
    assert told.startswith(f"{path}:{line_of(path, '  motion: ' + motion)}: vessel.motion.{key} = mru.csv: there is no")
    assert str(tmp_path / "mru.csv") in told and "; give its path" in told


def test_steel_of_a_density_that_no_pipe_has_is_blamed_before_the_mud_it_would_float_in(tmp_path):
    path = changed(tmp_path, JWELL, ("density: 7850 kg/m^3", "density: 7.85"))
    first, second = refusals(Drillstring(), path)
    line = line_of(path, "density: 7.85")
    assert (
        first.startswith(f"warning: {path}: material.density: 7.85 kg/m^3 (line {line})")
        and "7.85 sg = 7850 kg/m^3" in first
    )
    assert second.startswith(f"{path}:{line}: material.density = 7.85: the string would float")
    assert "mud.density 1840 kg/m^3" in second


def test_json_says_of_a_warning_among_the_problems_of_a_scene_that_it_is_one(tmp_path, capsys):
    path = changed(tmp_path, JWELL, ("density: 7850 kg/m^3", "density: 7.85"))
    code, out, _ = commands_of(Drillstring(), capsys)("check", str(path), "--json")
    assert code == 2 and [one.get("warning", False) for one in only_object(out)["problems"]] == [True, False]


def test_mud_heavier_than_steel_is_blamed_itself_and_the_steel_is_named(tmp_path):
    path = changed(tmp_path, JWELL, ("density: 1840", "density: 9000"))
    told = refusals(Drillstring(), path)
    assert told[0].startswith(f"warning: {path}: mud.density: 9000 kg/m^3 (line 17)") and "plausible" in told[0]
    assert (
        "mud.density = 9000 kg/m^3: the string would float" in told[1] and "material.density is 7850 kg/m^3" in told[1]
    )


def test_a_tubular_too_wide_for_the_hole_is_told_by_the_key_that_was_written_and_the_hole_as_written(tmp_path):
    edits = [("od: 0.127, id: 0.1086", "tubular: 5 in 19.50 lb/ft S135"), ("diameter: 0.2032 m", "diameter: 4 in")]
    path = changed(tmp_path, JWELL, *edits)
    told = refusals(Drillstring(), path)
    hole = line_of(path, "diameter: 4 in")
    assert f"{path}:14: string[0].tubular = 5 in 19.50 lb/ft S135: its tool joint, 6.625 in" in told[0]
    assert f"does not fit into the hole (well.diameter = 4 in, line {hole})" in told[0]
    scene = Drillstring().read(DATA / "jwell.yaml")
    with pytest.raises(SceneError, match=r"string\[0\].od = 0.127: does not fit .*\(well.diameter = 4 1/4 in, --set\)"):
        scene.replace({"well.diameter": "4 1/4 in"}, "--set")


@pytest.mark.parametrize(
    ("application", "text", "old", "new", "said"),
    [
        (Drillstring, JWELL, "{on_bottom:", "{wob: 1, on_bottom:", "bit.wob = 1: unknown key; did you mean 'weight'"),
        (Crane, HOIST, "mass: 5 t", "weight: 5 t", "bodies[0].weight = 5 t: unknown key; did you mean 'mass'?"),
    ],
)  # fmt: skip
def test_the_field_s_other_word_for_a_key_is_answered_with_the_key(tmp_path, application, text, old, new, said):
    path = changed(tmp_path, text, (old, new))
    with pytest.raises(SceneError) as caught:
        application().read(path)
    assert said in str(caught.value)


def test_an_argument_in_python_is_named_as_an_argument_and_not_as_an_option():
    with pytest.raises(SceneError, match=r"^argument end: solver.end = 1 kg: "):
        tautline.simulate(DATA / "hoist.yaml", end="1 kg")
    with pytest.raises(SceneError, match=r"^argument method: solver.method = euler: "):
        tautline.simulate(DATA / "hoist.yaml", method="euler")


def test_a_stroke_upwards_is_told_without_a_sign_and_one_downwards_as_it_is():
    for value, way in ((-0.2401, "up"), (0.2401, "down")):
        assert _along(f"break-away of the bit: stroke of the block, {way}", value) == 0.2401


def test_a_hole_of_a_mixed_number_of_inches_is_that_of_the_decimal_one(tmp_path):
    wide = Drillstring().read(changed(tmp_path, JWELL, ("diameter: 0.2032 m", "diameter: 12 1/4 in")))
    assert wide.well.diameter == pytest.approx(12.25 * 0.0254, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("mass: 5 t", "masss: 5 t", ["bodies[0].masss = 5 t: unknown key; did you mean 'mass'?"]),
        ("mass: 5 t", "weight: 5 t", ["bodies[0].weight = 5 t: unknown key; did you mean 'mass'?"]),
        ("name: payload, mass: 5 t", "nam: payload, masss: 5 t", ["did you mean 'name'?", "did you mean 'mass'?"]),
        ("mass: 5 t", "colour: red", ["bodies[0].colour = red: unknown key; known:", "bodies[0].mass: is missing"]),
        ("mass: 5 t", "mass: 5 t, masss: 5 t", ["bodies[0].masss = 5 t: unknown key; did you mean 'mass'?"]),
        (", mass: 5 t", "", ["bodies[0].mass: is missing"]),
    ],
)
def test_a_misspelt_key_is_one_fault_and_no_missing_key_as_well(tmp_path, old, new, told):
    with pytest.raises(SceneError) as found:
        Crane().read(changed(tmp_path, HOIST, (old, new)))
    lines = [str(SceneError([one])) for one in found.value.problems]
    assert len(lines) == len(told)
    for part in told:
        assert any(part in line for line in lines)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("rope:", "line_type:", ["line_type: unknown key; did you mean 'rope'?"]),
        ("step: 5 ms", "dt: 5 ms", ["solver.dt = 5 ms: unknown key; did you mean 'step'?"]),
        ("radius: 0.5", "diameter: 1 m", ["did you mean 'radius'? Note: it is half of the diameter"]),
        ("- sheave:", "- pulley:", ["path[1]: unknown key 'pulley'; did you mean 'sheave'?"]),
        ("- drum:", "- winch:", ["path[0]: unknown key 'winch'; did you mean 'drum'?"]),
        ("mass: 5 t", "mass: 5 t, Cd: 1.2", ["bodies[0].Cd = 1.2: unknown key; write drag: {quadratic: [x, y, z]}"]),
        (
            "heave: {harmonic: {amplitude: 0.5, period: 8, ramp: 8}}",
            "heave: {spectrum: {Hs: 2, Tp: 9}}",
            [
                "Hs = 2: unknown key; did you mean 'significant_height'?",
                "Tp = 9: unknown key; did you mean 'peak_period'?",
            ],
        ),
    ],
)
def test_a_word_of_the_trade_is_answered_with_the_key_and_is_no_missing_key_as_well(tmp_path, old, new, told):
    lines = refusals(Crane(), changed(tmp_path, HOIST, (old, new)))
    assert len(lines) == len(told)
    for part, line in zip(told, lines, strict=True):
        assert part in line


@pytest.mark.parametrize(
    ("application", "text", "old", "new", "told"),
    [
        (Crane, HOIST, "period: 8", "period: 0.1 Hz", "did you mean 'frequency'? 'period' takes a time such as 8 s"),
        (Crane, HOIST, "pay_out: {ramp: {to: -2.0", "pay_out: {ramp: {to: -60 rpm", "did you mean 'speed'?"),
        (Crane, HOIST, "pay_out: {ramp: {to: -2.0", "speed: {ramp: {to: -1 m/s", "did you mean 'pay_out'?"),
        (
            Drillstring,
            JWELL,
            "block: {chirp: {amplitude: 1 m",
            "block: {chirp: {amplitude: 9 ft/min",
            "velocity: ...}'?",
        ),
    ],
)
def test_a_unit_of_another_key_of_the_same_item_is_answered_with_that_key(tmp_path, application, text, old, new, told):
    (line,) = refusals(application(), changed(tmp_path, text, (old, new)))
    assert told in line


def test_a_time_in_a_drum_s_speed_is_not_taken_for_the_unit_of_another_key(tmp_path):
    (line,) = refusals(Crane(), changed(tmp_path, HOIST, ("over: 1.0", "over: 1 m/s")))
    assert "is not the unit of a time; expected a time" in line


@pytest.mark.parametrize(
    ("key", "old", "new"),
    [
        ("bodies", "bodies:\n  - {", "bodies:\n    {"),
        ("frames", "rope:", "frames: {name: boom, pivot: [0, 0, 5]}\nrope:"),
    ],
)
def test_a_list_whose_dash_was_forgotten_is_answered_with_an_entry_of_its_own_and_the_dash(tmp_path, key, old, new):
    (line,) = refusals(Crane(), changed(tmp_path, HOIST, (old, new)))
    assert f"{key}: must be a list; give a list such as [{{name: " in line and "begins with `- `" in line


@pytest.mark.parametrize(
    ("old", "new", "meant"),
    [
        ("friction: {", "ff: {", "did you mean 'friction'?"),
        ("diameter: 0.2032", "od: 0.2032", "did you mean 'diameter'?"),
        ("string:", "bha:", "did you mean 'string'?"),
        ("{hold: 2200 m}", "{md: 2200 m}", "did you mean 'hold'?"),
        ("length: 240 m", "md: 240 m", "did you mean 'length'?"),
        ("radius: 1000 m", "dls: 3", "did you mean 'rate'? Write its unit too, such as rate: 3 deg/30m"),
        (
            "rotation: {constant: 0 rpm}",
            "rpm: 60",
            "did you mean 'rotation'? Write its unit too, such as rotation: 60 rpm",
        ),
    ],
)
def test_words_of_drilling_are_answered_with_the_key_that_is_meant(tmp_path, old, new, meant):
    path = changed(tmp_path, JWELL, (old, new))
    # Nothing follows from it, such as a key that is missing: one fault, one message.
    (told,) = refusals(Drillstring(), path)
    assert f":{line_of(path, new)}: " in told and told.endswith(meant)


@pytest.mark.parametrize(
    ("application", "text", "old", "new"),
    [
        (Drillstring, JWELL, "radius: 1000 m", "rop: 15"),
        (Drillstring, JWELL, "radius: 1000 m", "rpm: 15"),
        (Drillstring, JWELL, "rotation: {constant: 0 rpm}", "rotation: {ramp: {to: 60 rpm, dls: 3}}"),
        (Drillstring, JWELL, "rotation: {constant: 0 rpm}", "rotation: {ramp: {to: 60 rpm, rop: 3}}"),
        (Drillstring, JWELL, "{rotation: 20,", "{rpm: 20,"),
        (Crane, LANDING, "limits: {", "limits: {rpm: 60, "),
        (Gardenhose, HOSE, "speed:", "rpm: 60\n  speed:"),
    ],
)
def test_a_word_with_a_unit_is_not_answered_with_a_key_that_does_not_take_the_unit(
    tmp_path, application, text, old, new
):
    path = changed(tmp_path, text, (old, new))
    (told, *_) = [line for line in refusals(application(), path) if "unknown key" in line]
    assert "; known: " in told and "did you mean" not in told
