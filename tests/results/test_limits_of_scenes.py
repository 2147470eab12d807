"""A scene gives limits, and a run says of each whether it was kept, by how much, when, where and how long."""

import json
import math
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import tautline
from tautline.application.installed import Installed
from tautline.application.limits import read_limits
from tautline.cli.commands.simulate import simulate as verb
from tautline.cli.run import Ended, ExitCode
from tautline.results.assessment.bounds import Bound, held, judge, stretches
from tautline.results.assessment.limits import AT_LEAST, AT_MOST
from tautline.results.result import Result
from tautline.results.variable import Variable
from tautline.scene.errors import SceneError
from tautline.scene.limits import Limit
from tautline.study.trials.trial import Setting, Subject

DATA = Path(__file__).parents[2] / "data"
HOIST = (DATA / "hoist.yaml").read_text(encoding="utf8")
PLUMB = """\
well: {sections: [{hold: 500 m}], diameter: 8.5 in, wall: none}
string: [{name: drill pipe, length: rest, od: 5 in, id: 4.276 in}]
material: {youngs_modulus: 200 GPa, shear_modulus: 79 GPa, density: 7850}
model: {kind: lumped, elements: 10}
solver: {method: generalized-alpha, step: 5 ms, end: 50 ms}
output: {interval: 50 ms}
"""
HANGING = """\
hose: {length: 0.5, elements: 10, axial_stiffness: 1000, bending_stiffness: 1.0e-3, mass_per_length: 0.4,
       direction: [0, 0, -1]}
gravity: 9.81
disturbance: [0.0001, 0, 0]
start: static
solver: {method: generalized-alpha, step: 1 ms, end: 5 ms}
output: {interval: 5 ms}
"""
CABLE = """\
CableModelMaterial: {Gravity: [0, 0, -9.81], CableStiffness: 5.0e5, CableMass: 2, CableDamping: 0}
CableModel:
  - Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [0, 0, -1], BC: [1, 1, 1, 0, 0, 0, 1]}
  - Node7Dof: {id: 1, xyz: [0, 0, -5], xyz_d: [0, 0, -1], BC: [0, 0, 0, 0, 0, 0, 1]}
  - Node7Dof: {id: 2, xyz: [0, 0, -10], xyz_d: [0, 0, -1], BC: [0, 0, 0, 0, 0, 0, 1]}
  - CableALEelement: {id: 0, nodes7: [0, 1], EJ: 0.1, strain: engineering}
  - CableALEelement: {id: 1, nodes7: [1, 2], EJ: 0.1, strain: engineering}
GeneralizedAlpha: {type: G-alpha, rho_inf: 0.8, time_step: 0.01, time_end: 0.02, start: static}
"""


def stored(time, values):
    """A result with one variable, ``x`` (m, n)."""
    time, values = np.asarray(time, float), np.asarray(values, float)
    arrays = {"time": time, "x": values if values.ndim == 2 else values[:, None]}
    variables = [Variable("time", ("time",), "s", ""), Variable("x", ("time", "place"), "N", "")]
    return Result(None, (variables, arrays, {}, {}, {}))


def bound(sense=AT_MOST, limit=1.0, lasting=0.0, places=("",), name="high"):
    return Bound(name, "x", sense, limit, "N", lasting, lambda frames: frames["x"], places)


def verdict(time, values, **about):
    (record,) = judge([bound(**about)], stored(time, values), {})
    return record


def scene(text, limits):
    return tautline.read(text.rstrip() + "\nlimits:\n" + "".join(f"  - {one}\n" for one in limits))


def given(result):
    """Records of the limits that the scene gives, by name."""
    return {record["name"]: record for record in result.limits if "output" in record}


def short(text=HOIST, end="1.5 s"):
    return text.replace("end: 12 s", f"end: {end}")


# -- what is judged ----------------------------------------------------------------------------------------------------

TIME = np.linspace(0.0, 10.0, 20001)
WAVE, OMEGA = 3.0, 2.0 * np.pi / 4.0


def test_the_time_of_a_sine_beyond_a_bound_is_that_of_its_closed_form():
    found = verdict(TIME, WAVE * np.sin(OMEGA * TIME), limit=1.8)
    # sin is above 0.6 from asin(0.6) to pi - asin(0.6); three crests lie within 10 s
    begin = math.asin(0.6) / OMEGA
    one = (np.pi - 2.0 * math.asin(0.6)) / OMEGA
    assert found["longest"] == pytest.approx(one, rel=1e-6)
    assert found["exceeded"] == pytest.approx(3.0 * one, rel=1e-6)
    assert (found["since"] - begin) % 4.0 == pytest.approx(0.0, abs=1e-6)
    assert found["value"] == pytest.approx(WAVE, rel=1e-7) and found["margin"] == pytest.approx(1.8 - WAVE, rel=1e-6)
    assert found["passed"] is False and found["time"] % 4.0 == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("lasting", [0.1, 0.7, 1.9])
def test_the_value_that_a_sine_holds_for_a_time_is_that_of_its_closed_form(lasting):
    found = verdict(TIME, WAVE * np.sin(OMEGA * TIME), limit=1.8, lasting=lasting)
    # about a crest, WAVE cos(omega t) stays above this from -lasting/2 to lasting/2
    value = WAVE * math.cos(0.5 * OMEGA * lasting)
    assert found["value"] == pytest.approx(value, abs=1e-5)
    assert found["passed"] is (value <= 1.8)
    assert (found["margin"] >= 0.0) is found["passed"]
    assert found["time"] % 4.0 == pytest.approx(1.0 - 0.5 * lasting, abs=1e-3)


def test_a_spike_that_is_shorter_than_it_has_to_last_is_kept():
    time = np.arange(0.0, 5.0, 0.1)
    values = np.where(np.abs(time - 2.0) < 0.05, 9.0, 0.0)
    assert verdict(time, values)["passed"] is False
    kept = verdict(time, values, lasting=0.5)
    assert kept["passed"] is True and kept["margin"] == pytest.approx(1.0)
    # From 0 to 9 and back within 0.2 s: above 1 for 8/9 of it
    assert kept["longest"] == pytest.approx(0.2 * 8.0 / 9.0)
    assert verdict(time, np.where(np.abs(time - 2.0) < 0.35, 9.0, 0.0), lasting=0.5)["passed"] is False


def test_a_bound_below_of_zero_or_of_a_negative_number_is_judged_by_the_difference():
    time, values = [0, 1, 2], [0.5, -2.0, -1.0]
    low = verdict(time, values, sense=AT_LEAST, limit=-1.5)
    assert (low["passed"], low["value"], low["time"]) == (False, -2.0, 1.0)
    assert low["margin"] == pytest.approx(-0.5)
    assert verdict(time, values, sense=AT_LEAST, limit=-2.0)["passed"] is True
    assert verdict(time, values, limit=0.0)["margin"] == pytest.approx(-0.5)
    assert verdict(time, values, limit=-3.0)["passed"] is False


def test_at_its_bound_a_value_is_kept_and_rounding_does_not_break_it():
    assert verdict([0, 1], [0.3, 0.1 + 0.2], limit=0.3)["passed"] is True
    assert verdict([0, 1], [0.3, 0.3 + 1e-6], limit=0.3)["passed"] is False
    # An output that never changes is judged like any other.
    assert verdict([0, 1, 2], [4.0, 4.0, 4.0], limit=4.0, lasting=0.5)["margin"] == pytest.approx(0.0)
    assert verdict([0, 1, 2], [4.0, 4.0, 4.0], limit=3.0, lasting=0.5)["passed"] is False


def test_the_worst_of_several_places_is_told_by_its_name_for_a_lasting_bound_too():
    time = np.arange(0.0, 4.0, 0.1)
    spike, plateau = np.where(np.abs(time - 1.0) < 0.05, 9.0, 0.0), np.where(time >= 2.0, 2.0, 0.0)
    both = np.stack((spike, plateau), axis=-1)
    assert verdict(time, both, places=("left", "right"))["place"] == "left"
    lasting = verdict(time, both, places=("left", "right"), lasting=0.5)
    assert (lasting["place"], lasting["passed"]) == ("right", False)
    assert lasting["value"] == pytest.approx(2.0)


def test_what_is_no_number_is_neither_kept_nor_broken_and_says_so():
    nan = np.nan
    assert verdict([0, 1, 2], [nan, nan, nan])["passed"] is None
    hidden = verdict([0, 1, 2], [0.5, nan, 0.5])
    assert hidden["passed"] is None and "not a number in 1 of 3 frames" in hidden["note"]
    # What is known to be broken stays so.
    broken = verdict([0, 1, 2], [0.5, nan, 2.0])
    assert (broken["passed"], broken["value"], broken["time"]) == (False, 2.0, 2.0)
    assert stretches(np.arange(5.0), np.array([2.0, 2.0, -np.inf, 2.0, 0.0]), 1.0)[1] == pytest.approx(1.0)


def test_frames_of_less_time_than_a_bound_has_to_last_do_not_tell():
    short_run = verdict([0, 0.2], [2.0, 2.0], lasting=0.5)
    assert short_run["passed"] is None and "too short" in short_run["note"]
    assert verdict([0, 0.2], [0.5, 0.5], lasting=0.5)["passed"] is True
    assert verdict([0], [2.0])["passed"] is False
    none = verdict([], np.zeros((0, 1)))
    assert none["passed"] is None and none["until"] is None and none["note"] == "no frame was stored"
    assert verdict([0, 1], np.zeros((2, 0)), places=())["passed"] is None


def test_a_figure_that_a_run_has_not_is_not_judged_unless_it_has_nothing_of_the_kind():
    figure = Bound("f", "longest_slack", AT_MOST, 0.1, "s")
    (record,) = judge([figure], stored([0], [0]), {})
    assert record["passed"] is None and "no longest_slack" in record["note"]
    nothing = Bound("f", "longest_slack", AT_MOST, 0.1, "s", absent=0.0)
    assert judge([nothing], stored([0], [0]), {})[0]["passed"] is True
    told = {"longest_slack": {"value": 0.3, "unit": "s", "text": "longest slack event (hook, at 2 s)"}}
    (record,) = judge([nothing], stored([0], [0]), told)
    assert (record["passed"], record["note"]) == (False, "longest slack event (hook, at 2 s)")
    assert record["margin"] == pytest.approx(-0.2)


def test_a_value_held_is_never_more_than_the_largest_and_falls_with_time():
    random = np.random.default_rng(3)
    time = np.cumsum(random.uniform(0.01, 0.2, 400))
    values = np.cumsum(random.normal(size=400))
    found = [held(time, values, lasting) for lasting in (0.0, 0.05, 0.3, 1.0, 5.0)]
    assert found[0] == pytest.approx(values.max(), abs=1e-9)
    assert all(one >= two - 1e-9 for one, two in pairwise(found))


# -- scenes ------------------------------------------------------------------------------------------------------------


def test_a_crane_is_judged_over_all_frames_with_time_and_place_and_by_the_units_that_are_written():
    read = scene(
        short(),
        ["{output: winch.tension, above: 52 kN, name: overload}", "{output: winch.tension, above: 52000, name: bare}",
         "{output: tension, above: 52 kN, name: anywhere}", "{output: min_tension, below: 1 kN, name: slack}",
         "{output: 'payload.position[2]', above: 6 m, name: height}", "{output: 'boom tip.position[2]', below: 29.5}",
         "{output: dynamic_amplification, above: 120 %, name: jerk}", "{output: max_tension_hook, above: 1 MN}",
         "{output: max_tension, above: 1 MN, name: pull}"],
    )  # fmt: skip
    result = tautline.simulate(read)
    found = given(result)
    pull, k = result["drum_tension"][:, 0], int(result["drum_tension"][:, 0].argmax())
    overload = found["overload"]
    assert (overload["value"], overload["time"], overload["place"]) == (pull.max(), result.time[k], "winch")
    assert overload["passed"] is False and overload["margin"] == pytest.approx(52e3 - pull.max())
    assert {**overload, "name": "", "text": ""} == {**found["bare"], "name": "", "text": ""}
    tension = result["tension"]
    frame, span, end = np.unravel_index(int(tension.argmax()), tension.shape)
    names = ["winch to boom tip", "boom tip to hook"], ["first", "last"]
    assert found["anywhere"]["place"] == f"{names[0][span]}, {names[1][end]}"
    assert (found["anywhere"]["value"], found["anywhere"]["time"]) == (tension.max(), result.time[frame])
    assert found["slack"]["value"] == tension.min() and found["slack"]["passed"] is True
    assert found["slack"]["place"].startswith("winch to boom tip")
    assert found["height"]["value"] == pytest.approx(result["body_position"][:, 0, 2].max())
    tip = found["boom tip.position[2] below 29.5"]
    assert tip["value"] == pytest.approx(result["position"][:, 4, 2].min()) and tip["place"] == "boom tip"
    jerk = found["jerk"]
    assert jerk["limit"] == pytest.approx(1.2) and jerk["time"] is None
    assert jerk["value"] == result.headline["dynamic_amplification"]["value"]
    assert found["max_tension_hook above 1 MN"]["passed"] is True
    # An extreme over places is told with the place that has it: beside the tip, where the rope comes from the winch.
    assert found["pull"]["value"] == tension.max() and found["pull"]["place"] == found["anywhere"]["place"]
    assert found["pull"]["place"] == "winch to boom tip, last"


def test_the_hook_load_of_a_plumb_string_is_judged_against_its_weight():
    area = 0.25 * np.pi * ((5 * 0.0254) ** 2 - (4.276 * 0.0254) ** 2)
    weight = 7850.0 * area * 500.0 * 9.81
    read = scene(
        PLUMB,
        [f"{{output: hook_load, above: {1.01 * weight / 4448.2216:.4f} klbf, name: more}}",
         f"{{output: top.hook_load, below: {1.01 * weight} N, name: less}}",
         "{output: tension, above: 1 N, name: pull}",
         "{output: hook_load_max, above: 1 N, name: figure}", "{output: surface_torque_max, above: 1 N m, name: none}"],
    )  # fmt: skip
    found = given(tautline.simulate(read))
    assert found["more"]["passed"] is True and found["more"]["margin"] == pytest.approx(0.01 * weight, rel=0.02)
    assert found["less"]["passed"] is False and found["less"]["value"] == pytest.approx(weight, rel=1e-3)
    # The uppermost of ten elements of 50 m.
    assert found["pull"]["place"] == "drill pipe, 0 to 50 m"
    assert found["figure"]["passed"] is False
    assert found["none"]["passed"] is True and found["none"]["value"] == 0.0


def test_the_axial_force_of_a_hanging_hose_is_judged_against_its_weight():
    weight = 0.4 * 0.5 * 9.81
    limits = [f"{{output: axial_force, above: {0.9 * weight}, name: root}}", "{output: axial_force_max, above: 3 N}"]
    found = given(tautline.simulate(scene(HANGING, limits)))
    # In the middle of the uppermost of ten elements 95 % of it hang, at its end all.
    assert found["root"]["passed"] is False and found["root"]["value"] == pytest.approx(weight, rel=1e-4)
    assert found["root"]["place"] == "element 1, 0 to 0.05 m"
    assert found["axial_force_max above 3 N"]["passed"] is True


def test_an_element_of_a_hanging_cable_is_judged_against_the_weight_below_it():
    below = 2.0 * 9.81 * 5.0
    limits = [
        f"{{output: element 1.axial_force, above: {0.9 * below}, name: lower}}",
        f"{{output: axial_force, above: {10 * below}, name: all}}",
        "{output: displacement_max, above: 1 m}",
    ]
    found = given(tautline.simulate(scene(CABLE, limits)))
    assert found["lower"]["passed"] is False and found["lower"]["value"] == pytest.approx(below, rel=0.01)
    assert (found["lower"]["place"], found["all"]["place"]) == ("element 1", "element 0")
    assert found["displacement_max above 1 m"]["passed"] is True


@pytest.mark.parametrize("text", [HOIST, PLUMB, HANGING, CABLE], ids=["crane", "drillstring", "gardenhose", "cable"])
def test_every_figure_of_a_run_can_have_a_limit_in_its_own_unit(text):
    read = tautline.read(short(text, "0.2 s"))
    application = Installed().of(read)
    model = application.build(read)
    headline = tautline.simulate(read).headline
    numbers = {
        name: one["unit"] for name, one in headline.items() if isinstance(one["value"], (int, float))
    }  # fmt: skip
    assert len(numbers) >= 3
    assert {name: model.figure_units.get(name) for name in numbers} == numbers
    assert set(model.nothing) <= set(model.figure_units)


@pytest.mark.parametrize("name", ["crane", "drillstring", "gardenhose", "cable"])
def test_the_schema_of_every_application_knows_the_key(name):
    application = next(one for one in Installed().all() if one.name == name)
    schema = json.loads(json.dumps(application.schema()))
    limit = schema["$defs"]["Limit"]["properties"]
    assert schema["properties"]["limits"]["items"]["$ref"] == "#/$defs/Limit"
    assert set(limit) == {"output", "above", "below", "at_most", "at_least", "for", "name"}


BROKEN = {
    "{output: winch.tensoin, above: 1 kN}": ("limits[0].output = winch.tensoin", "no such output", "'winch.tension'"),
    "{output: max_tensio, above: 1 kN}": ("limits[0].output", "no such output, and no such figure", "'max_tension'"),
    "{output: winch.tension, above: 1 m}": ("limits[0].above = 1 m", "not the unit of a force", "50 kN"),
    "{output: winch.tension, above: [1]}": ("limits[0].above", "is not a number", "60 kN"),
    "{output: winch.tension, above: heavy}": ("limits[0].above = heavy", "not a number with a unit"),
    "{output: winch.tension}": ("limits[0]", "has no bound", "above: or below:"),
    "{output: winch.tension, abov: 1 kN}": ("limits[0].abov", "unknown key", "did you mean 'above'?"),
    "{above: 1 kN}": ("limits[0].output", "is missing", "winch.tension"),
    "{output: winch.tension, above: 1 kN, below: 2 kN}": ("limits[0].above", "is not more than `below`"),
    "{output: winch.tension, at_most: 1 kN, at_least: 2 kN}": ("limits[0].at_most", "is not more than `at_least`"),
    "{output: winch.tension, at_most: 1 m}": ("limits[0].at_most = 1 m", "not the unit of a force", "50 kN"),
    "{output: winch.tension, above: 1 kN, at_most: 2 kN}": ("limits[0].at_most", "beside `above`", "remove one"),
    "{output: payload.position, above: 1 m}": ("limits[0].output", "several components", "payload.position[0]"),
    "{output: 'payload.position[3]', above: 1 m}": ("payload.position[3]", "has 3 of these", "from 0 to 2"),
    "{output: 'winch.tension[0]', above: 1 kN}": ("winch.tension[0]", "is one number", "write winch.tension"),
    "{output: safety_factor, below: 3, for: 1 s}": ("limits[0].for", "figure of the whole run"),
    "{output: winch.tension, above: 1 kN, for: -1 s}": ("limits[0].for", "must not be negative"),
}


@pytest.mark.parametrize("limit", BROKEN)
def test_a_limit_that_cannot_be_is_refused_with_file_line_key_and_cure_and_nothing_is_written(
    limit, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "lift.yaml"
    path.write_text(short() + f"limits: [{limit}]\n", encoding="utf8")
    with pytest.raises(SceneError) as error:
        verb(Installed(), path, None, {}, None, False, True, False)
    line = len(short().splitlines()) + 1
    assert f"lift.yaml:{line}: " in str(error.value)
    assert all(word in str(error.value) for word in BROKEN[limit]), str(error.value)
    assert [one.name for one in tmp_path.iterdir()] == ["lift.yaml"]


def test_an_application_that_does_not_say_how_many_places_there_are_is_judged_too():
    axes = [Variable("position", ("time", "node", "axis"), "m", ""), Variable("load", ("time", "node"), "N", "")]
    model = SimpleNamespace(handles=None, variables=axes, coordinates={}, figure_units={}, nothing=())
    wanted = ["position[1,2]", "load", "load[1]", "load[7]"]
    bounds = read_limits([Limit(output=name, above=1.0) for name in wanted], model, None)
    arrays = {"time": np.zeros(1), "position": np.arange(6.0).reshape(1, 2, 3), "load": np.array([[7.0, 8.0]])}
    found = judge(bounds, Result(None, ([Variable("time", ("time",), "s", ""), *axes], arrays, {}, {}, {})), {})
    assert [one["value"] for one in found] == [5.0, 8.0, 8.0, None]
    assert found[1]["place"] == "number 1" and found[3]["passed"] is None and found[3]["note"] == "there is no load[7]"


def test_two_limits_of_one_name_are_refused_and_two_sides_of_one_have_names_of_their_own():
    twice = ["{output: winch.tension, above: 1 kN, name: x}", "{output: max_tension, above: 1 kN, name: x}"]
    with pytest.raises(SceneError, match=r"limits\[1\]\.name = x: 'x' is the name of limits\[0\] already"):
        scene(short(), twice)
    with pytest.raises(SceneError, match=r"limits\[1\]\.output.*give it a name of its own"):
        scene(short(), ["{output: winch.tension, above: 1 kN}"] * 2)
    both = scene(short(), ["{output: winch.tension, above: 60 kN, below: 40 kN, name: band}",
                           "{output: max_tension, above: 60 kN, below: 40 kN}"])  # fmt: skip
    found = given(tautline.simulate(both, end=0.2))
    assert list(found) == ["band above", "band below", "max_tension above 60 kN", "max_tension below 40 kN"]
    assert [one["sense"] for one in found.values()] == ["at most", "at least"] * 2


def test_at_most_and_at_least_judge_and_are_called_as_above_and_below():
    failing = scene(
        short(), ["{output: max_tension, above: 52 kN}", "{output: winch.tension, below: 51 kN, for: 0.1 s}"]
    )
    allowed = scene(
        short(), ["{output: max_tension, at_most: 52 kN}", "{output: winch.tension, at_least: 51 kN, for: 0.1 s}"]
    )
    one, other = (given(tautline.simulate(read, end=0.5)) for read in (failing, allowed))
    assert one == other and list(one) == ["max_tension above 52 kN", "winch.tension below 51 kN"]
    assert one["max_tension above 52 kN"]["passed"] is (one["max_tension above 52 kN"]["value"] <= 52e3)


REVERSED = {
    "{output: max_tension, below: 15 kN, name: SWL}": ("limits[0].below", "at_most: 15 kN"),
    "{output: max_tension, at_least: 15 kN}": ("limits[0].at_least", "at_most: 15 kN"),
    "{output: max_tension_hook, below: 15 kN}": ("limits[0].below", "at_most: 15 kN"),
    "{output: min_tension, above: 1 kN}": ("limits[0].above", "at_least: 1 kN"),
    "{output: safety_factor, above: 3}": ("limits[0].above", "at_least: 3"),
}


@pytest.mark.parametrize("limit", REVERSED)
def test_a_bound_on_the_wrong_side_of_an_extreme_is_warned_of_with_its_line_and_cure(limit):
    key, cure = REVERSED[limit]
    read = scene(short(), [limit])
    (warning,) = [one for one in Installed().of(read).warnings(read) if one.where.startswith("limits")]
    assert warning.where == key and f"`{cure}`" in warning.text
    assert f"(line {len(short().splitlines()) + 2})" in warning.text and "the side that fails" in warning.text


@pytest.mark.parametrize(
    "limit",
    ["{output: max_tension, above: 60 kN}", "{output: max_tension, at_most: 60 kN}",
     "{output: max_tension, above: 60 kN, below: 1 kN}", "{output: min_tension, at_least: 1 kN}",
     "{output: winch.tension, below: 1 kN}", "{output: safety_factor, below: 3}"],
)  # fmt: skip
def test_a_bound_on_the_usual_side_and_one_on_a_plain_output_are_not_warned_of(limit):
    read = scene(short(), [limit])
    assert not [one for one in Installed().of(read).warnings(read) if one.where.startswith("limits")]


# -- runs --------------------------------------------------------------------------------------------------------------

OVERLOAD = "{output: winch.tension, above: 52 kN, name: overload}"
LIMITED = f"{short()}limits: [{OVERLOAD}, {{output: min_tension, below: 1 kN}}]\n"


def test_simulate_prints_kept_and_failed_limits_gives_them_in_json_and_ends_well(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "lift.yaml"
    path.write_text(LIMITED, encoding="utf8")
    verb(Installed(), path, None, {}, None, False, True, False)
    out, err = capfd.readouterr()
    found = {one["name"]: one for one in json.loads(out)["limits"] if "output" in one}
    assert found["overload"]["passed"] is False and found["min_tension below 1 kN"]["passed"] is True
    assert set(found["overload"]) == {
        "name", "text", "unit", "sense", "limit", "value", "passed", "time", "place", "output", "margin", "for",
        "variable", "since", "longest", "exceeded", "until", "note",
    }  # fmt: skip
    flat = " ".join(err.split())
    assert "overload (winch.tension) FAILED" in flat and "must be at most 52 kN (winch, t = 0.4 s)" in flat
    assert "min_tension kept" in flat and "beyond it for" in flat and "at the stored frames" in flat
    assert "warning: overload (winch.tension)" in flat and "of 10, see the warnings below" in flat
    assert "ended early" not in flat


def test_a_failed_limit_of_a_scene_is_a_warning_also_where_no_table_is_printed(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "lift.yaml"
    path.write_text(LIMITED, encoding="utf8")
    verb(Installed(), path, None, {}, None, False, False, True)
    assert "warning: overload (winch.tension)" in " ".join(capfd.readouterr().err.split())


def test_a_run_that_stops_is_judged_over_what_was_run_and_says_so(tmp_path, capfd, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "lift.yaml"
    # The hook meets its sheave at 12.98 s.
    path.write_text(LIMITED.replace("end: 1.5 s", "end: 14 s"), encoding="utf8")
    with pytest.raises(Ended) as ended:
        verb(Installed(), path, None, {}, None, False, True, False)
    assert ended.value.code == ExitCode.STOPPED_EARLY
    out, err = capfd.readouterr()
    report = json.loads(out)
    (overload,) = [one for one in report["limits"] if one["name"] == "overload"]
    last = tautline.Result.read(tmp_path / "lift.nc").time[-1]
    assert overload["passed"] is False and overload["until"] == last and 12.0 < last < 13.0
    assert f"judged until t = {last:.4g} s, where the run ended early" in " ".join(err.split())


def test_limits_may_change_when_a_run_is_gone_on_with_and_earlier_frames_are_judged_too(tmp_path):
    first = tautline.simulate(tautline.read(LIMITED), tmp_path / "first.nc", end=1.0)
    peak = given(first)["overload"]
    assert peak["time"] == pytest.approx(0.4)
    other = tautline.read(LIMITED.replace("above: 52 kN", "above: 60 kN"))
    found = given(tautline.simulate(other, tmp_path / "second.nc", resume=first))["overload"]
    assert (found["time"], found["value"], found["limit"]) == (peak["time"], peak["value"], 60e3)
    assert found["until"] == pytest.approx(1.5)


def test_limits_do_not_change_a_run():
    bare, judged = tautline.simulate(tautline.read(short())), tautline.simulate(tautline.read(LIMITED))
    assert np.array_equal(bare["position"], judged["position"])
    assert not given(bare) and len(given(judged)) == 2


@pytest.mark.parametrize("text", [HOIST, PLUMB, HANGING, CABLE], ids=["crane", "drillstring", "gardenhose", "cable"])
def test_limits_do_not_count_in_what_a_scene_is(text):
    build = Installed().of(tautline.read(text)).build
    bare, judged = (build(one) for one in (tautline.read(text), scene(text, ["{output: kinetic_energy, above: 1 J}"])))
    assert bare.attributes["model_hash"] == judged.attributes["model_hash"]
    assert len(bare.bounds) == 0 and len(judged.bounds) == 1


@pytest.mark.parametrize(
    ("text", "output"), [(short(HOIST, "0.1 s"), "axial_force[7]"), (CABLE, "element 1.axial_force")]
)
def test_a_study_runs_other_meshes_of_a_scene_whose_limit_names_an_element_that_they_lack(text, output):
    read = scene(text, [f"{{output: '{output}', above: 1 N}}"])
    for elements in (1.0, 0.5):
        trial = Subject(Installed().of(read), read).run(Setting(elements=elements))
        assert trial.done and not given(trial.result)


def test_a_simulation_that_is_stepped_judges_what_it_has_kept():
    sim = tautline.Simulation(tautline.read(LIMITED))
    sim.advance_to(0.5)
    found = given(sim.result)["overload"]
    assert found["passed"] is False and found["until"] == pytest.approx(0.5)


def test_limits_of_the_scene_are_drawn_with_their_variable_where_they_are_near():
    near = "{output: winch.tension, above: 60 kN, name: overload}"
    far = "{output: winch.tension, above: 9 MN, name: far}"
    largest = "{output: max_tension, above: 65 kN, name: largest}"
    text = HOIST.replace("end: 12 s", "end: 1 s") + f"limits: [{near}, {far}, {largest}]\n"
    result = tautline.simulate(tautline.read(text))
    (plot,) = result.plot("drum_tension").axes
    lines = {line.get_label(): line.get_ydata() for line in plot.lines}
    assert list(lines["overload"]) == [60.0, 60.0] and not {"far", "largest"} & set(lines)
    (plot,) = result.plot("tension:winch to boom tip:first").axes
    assert "largest" in [line.get_label() for line in plot.lines]
    assert len(result.plot("body_position").axes) == 3
