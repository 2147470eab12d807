"""A cure suggests what can be written there: of the size of the field, and in the unit of the one who wrote."""

import re
from pathlib import Path

import pytest

from drillstring.scene.scene import DrillstringScene
from tautline.scene.errors import SceneError
from tautline.scene.values.quantity import suited

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
    usual = "give a speed such as 0.5 or 0.5 m/s"
    assert suited(usual, written) == usual
    assert suited(usual, written, "15 m/h") == "give a speed such as 15 m/h"


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
