"""Numbers as people write them elsewhere are not read as others, and what is meant is offered."""

import pytest

from crane.scene.scene import CraneScene
from tautline.scene.errors import SceneError

TEXT = open("data/hoist.yaml").read()


def refused(text):
    with pytest.raises(SceneError) as error:
        CraneScene.parse(text)
    return str(error.value)


@pytest.mark.parametrize(
    ("written", "meant"),
    [("1,25", "1.25"), ("0,025", "0.025"), ("12,5 ft", "12.5 ft"), ("1,5e3 m", "1.5e3 m"), ("12,5m", "12.5m")],
)
def test_a_decimal_comma_in_braces_is_offered_as_the_number_that_was_meant(written, meant):
    told = refused(f"ground: {{level: -5, stiffness: 1e6, damping: {written}}}\n{TEXT}")
    assert f"is it a decimal comma? Write {meant} with a point, for damping" in told


@pytest.mark.parametrize(("written", "meant"), [("-0,5", "-0.5"), ("-0,5 m", "-0.5 m"), ("-1,5", "-1.5")])
def test_a_negative_decimal_comma_keeps_its_sign_in_what_is_offered(written, meant):
    told = refused(TEXT.replace("pay_out: {ramp: {to: -2.0, over: 1.0}}", f"pay_out: {written}", 1))
    assert f"is it a decimal comma? Write {meant} with a point, for pay_out" in told


def test_a_key_of_digits_with_a_value_is_no_decimal_comma():
    assert "comma" not in refused("ground: {level: -5, 25: 1e6}\n" + TEXT)


def test_numbers_of_base_8_and_16_are_refused_where_they_stand():
    told = refused(TEXT + "ground: {level: 0x10, stiffness: 0o17, damping: 1}\n")
    assert "ground.level = 0x10: is a number of base 8 or 16" in told
    assert "ground.stiffness = 0o17: is a number of base 8 or 16" in told


def test_a_whole_number_in_quotes_is_to_lose_them():
    told = refused("mesh: {elements_per_span: '20'}\n" + TEXT.replace("mesh:", "mesh_:"))
    assert "remove the quotes: write 20" in told
