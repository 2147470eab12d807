"""Verbs of drill strings that make no run tell what is odd about a scene as `check` does: on the terminal, in JSON."""

import re
from pathlib import Path

import pytest
from cli.in_process import commands_of, leave_out_pixels, only_object

from drillstring.application import Drillstring

DATA = Path(__file__).parents[3] / "data"
JWELL = (DATA / "jwell.yaml").read_text(encoding="utf8")
DRILLING = (DATA / "drilling.yaml").read_text(encoding="utf8").replace("elements: 24", "elements: 6")
WITHOUT_A_RUN = [
    ("torque-drag", "--elements", "20"), ("form", "--elements", "20"), ("campbell", "--modes", "torsional"),
]  # fmt: skip
VERBS = pytest.mark.parametrize("words", WITHOUT_A_RUN, ids=lambda words: words[0])


@pytest.fixture
def here(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("jwell.yaml").write_text(JWELL, encoding="utf8")
    Path("drilling.yaml").write_text(DRILLING, encoding="utf8")
    leave_out_pixels(monkeypatch)
    return commands_of(Drillstring(), capsys)


def places(report):
    return [one["where"] for one in report["warnings"]]


@VERBS
def test_a_slip_of_a_unit_is_warned_of_by_verbs_that_make_no_run_as_check_does(here, words):
    verb, *options = words
    code, out, err = here(verb, "jwell.yaml", "--set", "mud.density=10", *options, "--json")
    report, told = only_object(out), " ".join(err.split())
    assert code == 0 and places(report) == ["mud.density"] and report["warnings"][0]["text"] in told
    assert "Was 10 ppg = 1198 kg/m^3 meant?" in told and told.count("warning:") == 1
    checked = only_object(here("check", "jwell.yaml", "--set", "mud.density=10", "--json")[1])
    assert report["warnings"] == checked["warnings"]


@VERBS
def test_a_sound_scene_is_not_warned_of(here, words):
    code, out, err = here(words[0], "jwell.yaml", *words[1:], "--json")
    assert code == 0 and only_object(out)["warnings"] == [] and "warning:" not in err


def test_a_weight_that_a_hanging_bit_does_not_get_is_told_by_torque_drag(here):
    change = ("--set", "bit={weight: 200 kN}")
    code, _, err = here("torque-drag", "jwell.yaml", *change, "--elements", "20")
    assert code == 0 and "bit.weight: has no effect while bit.on_bottom is false" in " ".join(err.split())


def test_a_friction_factor_that_the_option_refuses_is_warned_of_where_the_scene_has_it(here):
    code, _, err = here("torque-drag", "jwell.yaml", "--set", "well.wall.friction=1.9", "--elements", "20")
    assert code == 0 and "well.wall.friction: 1.9 is unusual" in " ".join(err.split())


@VERBS
def test_what_counts_in_a_run_alone_is_not_told_by_verbs_that_make_none(here, words):
    changes = ("--set", "solver.step=0.3 s", "--set", "output.interval=0.7 s")
    checked = only_object(here("check", "jwell.yaml", *changes, "--json")[1])
    assert {"solver.step", "output.interval"} <= set(places(checked))
    code, out, _ = here(words[0], "jwell.yaml", *changes, *words[1:], "--json")
    assert code == 0 and places(only_object(out)) == []


def test_elements_are_those_that_torque_drag_takes_and_not_those_of_the_scene(here):
    few = ("--set", "model.elements=3")
    assert "model.elements" in places(only_object(here("check", "jwell.yaml", *few, "--json")[1]))
    for options, warned in (((), False), (("--elements", "3"), True)):
        code, out, _ = here("torque-drag", "jwell.yaml", *few, *options, "--json")
        assert code == 0 and ("model.elements" in places(only_object(out))) == warned


def test_of_several_scenes_form_names_the_one_that_is_warned_of(here):
    Path("other.yaml").write_text(re.sub(r"mud:.*", "mud: {density: 10}", JWELL), encoding="utf8")
    code, out, err = here("form", "jwell.yaml", "other.yaml", "--elements", "20", "--json")
    assert code == 0 and [places(one) for one in only_object(out)["scenes"]] == [[], ["mud.density"]]
    assert "warning: other.yaml: mud.density" in err


def test_stick_slip_tells_the_warnings_of_the_scene_that_it_runs(here):
    words = ("--speed", "60", "--weight", "60 kN", "--end", "100 s", "--jobs", "1", "--json")
    code, out, err = here("stick-slip", "drilling.yaml", "--set", "mud.density=10", *words)
    report = only_object(out)
    assert code == 0 and "mud.density" in [one["where"] for one in report["scene_warnings"]]
    assert "warning: mud.density: 10 kg/m^3" in err and report["warnings"] == []


PIPE, HEAVY, COLLAR = (
    "{name: dp, od: 5 in, id: 4.276 in, mass_per_length: 33, length: %s}",
    "{name: hwdp, od: 5 in, id: 3 in, mass_per_length: 74, length: 200 m}",
    "{name: collar, od: 6.5 in, id: 2.8125 in, mass_per_length: 136, length: 100 m}",
)
LIGHT = "{name: light, od: 3.5 in, id: 2.764 in, mass_per_length: 21, length: 400 m}"
SLANTED = "well.sections=[{hold: 1000 m}, {build: {radius: 500 m, to: 60 deg, azimuth: 0 deg}}, {hold: 1500 m}]"
LINER = "{name: liner, od: 7 in, id: 6.184 in, mass_per_length: 43, length: rest}"
TUBING = "{name: tubing, od: 2.875 in, id: 2.441 in, mass_per_length: 9.7, length: %s}"
SLIM = "{name: slim pipe, od: 3.5 in, id: 2.764 in, mass_per_length: 21, length: rest}"
MOTOR = "{name: motor, od: 6.75 in, id: 4 in, mass_per_length: 115, length: 9 m}"
REST, MORE = PIPE % "rest", PIPE % "500 m"


@pytest.mark.parametrize(
    ("sections", "warned"),
    [
        pytest.param([COLLAR, HEAVY, REST], True, id="from the bit up"),
        pytest.param([HEAVY, COLLAR, REST], True, id="heavy at the top in another order"),
        pytest.param([REST, HEAVY, COLLAR], False, id="from the table down"),
        pytest.param([REST, HEAVY, MORE], False, id="heavier in the middle"),
        pytest.param([HEAVY, REST, COLLAR], False, id="heavy at both ends"),
        pytest.param([REST, LIGHT], False, id="tapered"),
        pytest.param([COLLAR.replace("100 m", "12 m"), REST], False, id="a kelly"),
        pytest.param([HEAVY, LINER], False, id="a liner on heavy pipe"),
        pytest.param([COLLAR, TUBING % "rest"], False, id="tubing below collars"),
        pytest.param([COLLAR, SLIM], True, id="slim pipe from the bit up"),
        pytest.param([HEAVY.replace("200 m", "rest"), LIGHT], False, id="a stinger below heavy pipe"),
        pytest.param([COLLAR, REST, MOTOR], True, id="collars, pipe and a motor"),
        pytest.param([COLLAR, HEAVY, REST, MOTOR], True, id="collars, heavy pipe, pipe and a motor"),
        pytest.param([HEAVY, REST, MOTOR], False, id="heavy pipe, pipe and a motor"),
        pytest.param([MOTOR, COLLAR, REST], True, id="from the bit up with its motor"),
    ],
)
def test_a_string_with_its_heavy_pipe_at_the_table_alone_is_asked_whether_it_was_written_from_the_bit_up(
    here, sections, warned
):
    string = f"[{', '.join(sections)}]"
    report = only_object(here("check", "jwell.yaml", "--set", f"string={string}", "--set", SLANTED, "--json")[1])
    text = " ".join(one["text"] for one in report["warnings"] if one["where"] == "string")
    assert ("Then reverse it" in text) == warned


def test_heavy_pipe_above_light_pipe_in_a_horizontal_hole_is_on_purpose(here):
    change = ("--set", f"string=[{HEAVY}, {REST}]")
    slanted, level = (
        only_object(here("check", "jwell.yaml", *change, *hole, "--json")[1]) for hole in (("--set", SLANTED), ())
    )
    assert "string" in places(slanted) and "string" not in places(level)


STATED = tuple(
    word
    for key, value in (("string[0].elements", 16), ("string[1].elements", 3), ("string[2].elements", 5))
    for word in ("--set", f"{key}={value}")
)
"""Elements of every section of the string of drilling.yaml."""


@pytest.mark.parametrize("options", [(), ("--elements", "12"), ("--depth", "2500")], ids=["own", "fewer", "depth"])
def test_torque_drag_of_sections_that_all_state_their_elements_is_not_refused(here, options):
    code, out, err = here("torque-drag", "drilling.yaml", *STATED, "--set", "model.elements=24", *options, "--json")
    assert code == 0, err
    assert "model.elements" not in places(only_object(out))


BUILD = (
    "--set", "well.sections=[{hold: 600 m}, {build: {rate: 6 deg/30m, to: 85 deg, azimuth: 0 deg}}, {hold: 400 m}]",
    "--set", "string=[{name: dp, od: 5 in, id: 4.276 in, mass_per_length: 33, length: rest}]",
)  # fmt: skip
"""A hole that eight elements of the beam cut across, while eight links of lumps are enough for it."""
BEAM_OF_60 = ("--set", "model.kind=ale-ancf", "--set", "model.elements=60")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        pytest.param(("torque-drag", "--model", "lumped,ale-ancf", "--elements", "8"), ["ale-ancf, 8"], id="second"),
        pytest.param(
            ("torque-drag", "--set", "model.kind=ale-ancf", "--elements", "8", "--model", "lumped"), [], id="no beam"
        ),
        pytest.param(("form", "--set", "model.elements=3", "--elements", "40"), [], id="more than the scene's"),
        pytest.param(("form", *BEAM_OF_60, "--elements", "6"), ["an element of"], id="fewer than the scene's"),
        pytest.param(("form", *BEAM_OF_60, "--elements", "6,60"), ["ale-ancf, 6 elements"], id="one of two"),
    ],
)
def test_a_mesh_is_warned_of_as_it_is_computed_and_its_cure_is_the_option_that_counts(here, words, told):
    verb, *options = words
    code, out, _ = here(verb, "jwell.yaml", *BUILD, *options, "--json")
    found = [one["text"] for one in only_object(out)["warnings"] if one["where"] == "model.elements"]
    assert code == 0 and len(found) == len(told)
    for text, begin in zip(found, told, strict=True):
        assert text.startswith(begin) and "give --elements " in text and "or give --model lumped" in text
        wanted = re.search(r"give --elements (\d+)", text)[1]
        cured = [word if word not in ("8", "6") else wanted for word in options if word != "6,60"]
        cured += [wanted] if "6,60" in options else []
        code, out, _ = here(verb, "jwell.yaml", *BUILD, *cured, "--json")
        assert code == 0 and "model.elements" not in places(only_object(out))


def test_a_block_that_moves_past_the_shoe_counts_in_a_run_alone(here):
    changes = ("--set", "well.wall.casing={shoe: 1500 m, friction: 0.15}", "--set", "model.elements=100")
    changes += ("--set", "top.block={velocity: {ramp: {to: -5 m/s, over: 1 s}}}", "--set", "solver.end=40 s")
    assert "well.wall.casing" in places(only_object(here("check", "jwell.yaml", *changes, "--json")[1]))
    code, out, _ = here("torque-drag", "jwell.yaml", *changes, "--elements", "20", "--json")
    assert code == 0 and "well.wall.casing" not in places(only_object(out))
