"""What the command says of faults in a map: causes and cures that are true of what stands there."""

import pytest
from twin.rehearsal import HOIST, STILL

import tautline
from tautline.twin.twin import Twin

MAP = """
sensors:
  - {column: winch_pos, unit: m, input: winch.pay_out}
  - {column: rope, unit: UNIT, output: winch.tension}
estimate:
  - {parameter: payload.mass, START sd: 4 t, range: RANGE}
"""


def problems(unit="kN", start="start: 9 t,", span="[0.5 t, 20 t]", **instead):
    """Problems of a map: key, cause and cure of each."""
    text = MAP.replace("UNIT", unit).replace("START", start).replace("RANGE", span)
    for old, new in instead.values():
        assert old in text
        text = text.replace(old, new)
    with pytest.raises(tautline.SceneError) as found:
        Twin(STILL, text)
    return [(one.key, one.cause, one.cure) for one in found.value.problems]


@pytest.mark.parametrize(
    ("start", "span", "cause", "cure"),
    [
        (
            "38",
            "[20 t, 60 t]",
            "is 38 kg, and range is 20 t to 60 t. A number without a unit is in kg",
            "write 38 t if",
        ),
        ("38", "[20000, 60 t]", "is 38 kg, and range is 20000 kg to 60 t. A number", "write 38 t if that is meant"),
        ("38", "[20000, 60000]", "is 38 kg, and range is 20000 kg to 60000 kg", "start within the range"),
        ("80", "[20 t, 60 t]", "is 80 kg, and range is 20 t to 60 t", "start within the range"),
        ("80 t", "[20 t, 60 t]", "is 80 t, and range is 20 t to 60 t", "start within the range"),
        ("", "[20 t, 60 t]", "is that of the scene, 5000 kg, and range is 20 t to 60 t", "start within the range"),
    ],
)
def test_a_start_outside_its_range_is_told_with_both_and_with_the_unit_that_was_likely_forgotten(
    start, span, cause, cure
):
    ((key, why, what),) = problems(start=f"start: {start}," if start else "", span=span)
    assert key == "estimate[0].start" and why.startswith(cause) and what.startswith(cure)


def test_a_range_that_cannot_be_read_is_told_and_nothing_else_fails():
    assert "estimate[0].range[0]" in [key for key, _, _ in problems(start="start: 38,", span="[20 m, 30]")]


@pytest.mark.parametrize("start", ["start: 8,", "start: 9 t,", ""])
def test_a_range_that_ends_before_it_begins_is_told_and_not_where_the_start_would_have_to_be(start):
    ((key, cause, _),) = problems(start=start, span="[10 t, 5 t]")
    assert key == "estimate[0].range" and cause == "ends before it begins"


@pytest.mark.parametrize(
    ("instead", "where"),
    [
        ({"start": "start: true,"}, "estimate[0].start"),
        ({"sd": ("sd: 4 t", "sd: true")}, "estimate[0].sd"),
        ({"span": "[false, 20 t]"}, "estimate[0].range[0]"),
        ({"sd": ("sd: 4 t", "sd: 4 t, drift: true")}, "estimate[0].drift"),
        ({"sensor": ("output: winch.tension", "output: winch.tension, sd: true")}, "sensors[1].sd"),
        ({"more": ("\nestimate", "\nwatch: [{output: winch.tension, above: true}]\nestimate")}, "watch[0].above"),
    ],
)
def test_true_and_false_are_told_to_be_no_numbers_where_they_stand(instead, where):
    found = [(key, cause) for key, cause, _ in problems(**instead)]
    assert [one for one in found if one[0] == where and "true and false are not numbers" in one[1]], found


@pytest.mark.parametrize(
    ("unit", "force"), [("t", "tf"), ("kg", "kgf"), ("tonne", "tf"), ("lb", "lbf"), ("klb", "klbf")]
)
def test_a_load_cell_in_units_of_mass_is_told_the_force_to_write_and_a_map_with_that_is_taken(unit, force):
    ((key, cause, cure),) = problems(unit=unit)
    assert key == "sensors[1].unit" and cause == f"'{unit}' is a unit of mass, and this is a force"
    assert cure == f"write unit: {force}, the weight of 1 {unit}"
    text = MAP.replace("UNIT", force).replace("START", "").replace("RANGE", "[0.5 t, 20 t]")
    weights = {"t": 9806.65, "tonne": 9806.65, "kg": 9.80665, "lb": 4.4482216152605, "klb": 4448.2216152605}
    # N, by the standard gravity of 1901, 9.80665 m/s2, and the pound of 0.45359237 kg.
    assert Twin(STILL, text).plan.channels[1].factor == pytest.approx(weights[unit], rel=1e-14)


@pytest.mark.parametrize(("unit", "said"), [("m", "its unit is N"), ("Mg/s", "its unit is N"), ("g", "such as kN")])
def test_other_units_of_a_load_cell_are_told_its_unit(unit, said):
    ((_, _, cure),) = problems(unit=unit)
    assert said in cure


@pytest.mark.parametrize(
    ("kind", "name", "right"), [("input", "winch.tension", "output"), ("output", "vessel.heave", "input")]
)
def test_an_output_named_as_an_input_or_the_reverse_is_told_as_such_and_nothing_that_follows_from_it(kind, name, right):
    """A second sensor has the same name under the right key."""
    with pytest.raises(tautline.SceneError) as found:
        Twin(HOIST, f"sensors: [{{column: a, {kind}: {name}}}, {{column: b, {right}: {name}}}]")
    (problem,) = found.value.problems
    assert (problem.key, problem.cause) == (f"sensors[0].{kind}", f"there is no {kind} '{name}'")
    assert problem.cure == f"there is an {right} of that name: write {right}: {name}"


def test_two_sensors_of_one_output_are_told_at_the_key_that_stands_there():
    second = "  - {column: other, unit: kN, output: winch.tension}\nestimate"
    assert [one[:2] for one in problems(more=("estimate", second))] == [
        ("sensors[2].output", "'winch.tension' stands twice")
    ]


def watched(text):
    """Problems of a map with such a watch, and such further keys."""
    sensors = MAP.partition("estimate:")[0].replace("UNIT", "kN")
    with pytest.raises(tautline.SceneError) as found:
        Twin(STILL, sensors + text)
    return [(one.key, one.cause) for one in found.value.problems]


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("watch: [{output: winch.tension, above: 80 kN, ahead: 1e9 s}]\n", "watch[0].ahead"),
        ("ahead: 1000 s\n", "ahead"),
    ],
)
def test_a_look_ahead_of_longer_than_ten_minutes_is_refused_in_the_map(text, key):
    ((where, cause),) = watched(text)
    assert where == key and "must not be more than 600 s" in cause


def test_the_cure_of_a_look_ahead_that_is_too_long_names_the_longest():
    with pytest.raises(tautline.SceneError) as found:
        Twin(STILL, MAP.partition("estimate:")[0].replace("UNIT", "kN") + "ahead: 1000 s\n")
    assert [one.cure for one in found.value.problems] == ["give a time of at most 600 s"]


def test_bounds_that_leave_nothing_between_them_are_refused():
    ((key, cause),) = watched("watch: [{output: winch.tension, above: 80 kN, below: 90 kN}]\n")
    assert key == "watch[0].above" and "every value is beyond one of both" in cause
