"""A cure suggests what can be written there: of the size of the field, and in the unit of the one who wrote."""

import re
from pathlib import Path

import pytest
from pydantic import TypeAdapter, ValidationError

from drillstring.scene.scene import DrillstringScene
from tautline.scene.errors import SceneError
from tautline.scene.functions import time_function
from tautline.scene.values.quantity import MEANINGS, Quantity, suited
from tautline.scene.values.ranges import EXAMPLES, RANGES

DATA = Path(__file__).parents[3] / "data"
DRILLING = (DATA / "drilling.yaml").read_text(encoding="utf8")
COLLARS = "length: 160 m}"


CASES = {
    "a rate of penetration in m/h": ("rate: 20 m/h", "rate: 0 m/h", "give a speed such as 15 m/h"),
    "the same in feet": ("rate: 20 m/h", "rate: 0 ft/h", "give a speed such as 49 ft/h"),
    "the same without a unit": ("rate: 20 m/h", "rate: 0", "give a speed such as 15 m/h"),
    "the same in a unit of something else": ("rate: 20 m/h", "rate: 20 kN", "expected a speed such as 15 m/h"),
    "a diameter in mm": ("8.5 in", "0 mm", "give a length such as 220 mm"),
    "a stiffness of the rock": ("stiffness: 1.0e8", "stiffness: -1 kN/m", "give a stiffness such as 1e+06 kN/m"),
    "a length or a word": (COLLARS, "length: -160 ft}", "such as 890 ft, or the word rest"),
    "a wear flat": (
        "torque: {", "cutting: {wear_flat: -1 in, specific_energy: 1 MPa} #", "give a length such as 0.047 in"
    ),
    "one number for an eccentricity": (
        COLLARS, "length: 160 m, eccentricity: 1.5 mm}",
        "give a list such as [0, 1.5 mm]: both components, in the frame that turns with the pipe",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_cure_is_of_the_size_and_in_the_unit_of_its_field(case):
    old, new, cure = CASES[case]
    text = "  # penetration" if "cutting" in new else "  penetration"
    with pytest.raises(SceneError) as found:
        DrillstringScene.parse(DRILLING.replace("  penetration", text).replace(old, new))
    (problem,) = found.value.problems
    assert cure in problem.cure


@pytest.mark.parametrize("written", ["1e400 furlong", "3 m^0.5", "", None, [1], "1 \N{SNOWMAN}"])
def test_what_cannot_be_read_gets_the_usual_example(written):
    usual = "give a speed such as 0.5 m/s"
    assert suited(usual, written) == usual
    assert suited(usual, written, "15 m/h") == "give a speed such as 15 m/h"


@pytest.mark.parametrize(
    ("row", "example"),
    [("length", "30 m"), ("rope diameter", "28 mm"), ("duration", "5 s"), ("time simulated", "60 s"),
     ("axial stiffness", "50 MN")],
)  # fmt: skip
def test_the_example_of_a_cure_is_of_the_size_of_its_key(row, example):
    """A hose is no 5 inches long, and a ramp takes no millisecond."""
    assert Quantity(RANGES[row].unit, of=row).cure.endswith(f"such as {example}")


@pytest.mark.parametrize("row", EXAMPLES)
def test_the_example_of_a_row_is_read_and_plausible(row):
    known = RANGES[row]
    assert known.holds(Quantity(known.unit, of=row).read(EXAMPLES[row]))


def test_the_example_of_a_row_is_given_in_the_unit_that_was_written():
    cure = Quantity("m", of="length").cure
    assert suited(cure, "0 mm") == "give a length such as 30000 mm"
    assert suited(cure, "0") == cure


def test_no_example_says_one_thing_twice():
    for _, example in MEANINGS.values():
        first, _, second = example.partition(" or ")
        assert not second.startswith(f"{first} ")


def test_a_cure_that_suggests_no_quantity_stays():
    assert suited("swap od and id?", "5 in", "5 in") == "swap od and id?"


SUGGESTED = re.compile(r"such as ([-+.\w]+(?: [A-Za-z/]+)?)")


@pytest.mark.parametrize(
    ("key", "old", "wrong"),
    [("hole", "8.5 in", "0 mm"), ("rate", "rate: 20 m/h", "rate: 0 ft/h"), ("rate", "rate: 20 m/h", "rate: 20 kN")],
)
def test_what_a_cure_suggests_is_accepted(key, old, wrong):
    """What is read from the cure stands where the wrong value stood."""
    with pytest.raises(SceneError) as found:
        DrillstringScene.parse(DRILLING.replace(old, wrong))
    (problem,) = found.value.problems
    (suggested,) = SUGGESTED.findall(problem.cure)
    good = f"rate: {suggested}" if key == "rate" else suggested
    assert good not in (old, wrong)
    DrillstringScene.parse(DRILLING.replace(old, good))


def test_the_example_of_a_plain_number_is_never_in_the_angle_that_was_refused():
    """`friction: 5 deg` was answered with "a plain number such as 11 deg"."""
    assert suited(Quantity("").cure, "5 deg") == "give a plain number such as 0.2"
    assert suited(Quantity("").cure, "5 %") == "give a plain number such as 20 %"
    assert suited(Quantity("rad").cure, "5 gon").startswith("give an angle such as 100 gon")


@pytest.mark.parametrize("unit", ["", "m", "m/s", "rad", "rad/s", "N", "N m"])
@pytest.mark.parametrize(("keyed", "key"), [("spectrum", "rao"), ("ramp", "rate")])
def test_the_example_of_a_response_or_a_rate_can_be_written_as_it_stands(unit, keyed, key):
    """That of a force was "1.0 ((N)/m)"."""
    read = TypeAdapter(time_function(unit)).validate_python
    model = {"ramp": {"over": 1}, "spectrum": {"significant_height": 1, "peak_period": 8}}[keyed]
    with pytest.raises(ValidationError) as found:
        read({keyed: model | {key: "3 kg"}})
    cure = found.value.errors()[-1]["ctx"]["cure"]
    assert "(" not in cure
    example = re.search(r"such as (.*?)(, or .*)?$", cure)[1]
    read({keyed: model | {key: example.split(" or ")[-1]}})
