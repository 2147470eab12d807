"""What a map says of a sensor, and what it must not say."""

import pytest
from pydantic import ValidationError

from tautline.twin.map.file import Sensor

WRONG = {
    "an input and an output": ({"input": "a", "output": "b"}, "gives input and output", "keep one"),
    "all three": ({"input": "a", "output": "b", "signal": "c"}, "gives input and output and signal", "keep one"),
    "none": ({}, "gives none of input, output and signal", "signal:"),
    "an infinite scale": ({"output": "b", "scale": float("inf")}, "has a scale of inf", "such as -1"),
    "no scale": ({"output": "b", "scale": 0.0}, "has a scale of 0", "such as -1"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_sensor_is_refused_for_what_is_wrong_with_it(case):
    keys, cause, cure = WRONG[case]
    with pytest.raises(ValidationError) as found:
        Sensor.model_validate({"column": "x"} | keys)
    (problem,) = found.value.errors()
    assert cause in problem["msg"] and cure in problem["ctx"]["cure"]
