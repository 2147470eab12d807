"""Numbers as people write them elsewhere are not read as others, and what is meant is offered."""

import pytest
from pydantic_core import PydanticCustomError

from crane.scene.scene import CraneScene
from drillstring.scene.scene import DrillstringScene
from tautline.scene.errors import SceneError
from tautline.scene.reading.columns import Columns
from tautline.scene.values.quantity import Quantity

TEXT = open("data/hoist.yaml").read()
JWELL = open("data/jwell.yaml").read()


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


@pytest.mark.parametrize(
    ("written", "unit", "told"),
    [
        ('8.5"', "m", "write 8.5 in"),
        ('8 1/2"', "m", "write 8.5 in"),
        ("12.25″", "m", "write 12.25 in"),
        ("30'", "m", "write 30 ft"),
        ("1,000 ft", "m", "write 1000 ft, or 1.000 ft if it is a decimal comma"),
        ("-12,500", "m", "write -12500, or -12.500 if"),
        ("1,234,567.8 kN", "N", "write 1234567.8 kN"),
        ("1,5 m", "m", "write 1.5 m with a point"),
        ("0,125 m", "m", "write 0.125 m with a point"),
        ("60 L/min", "m/s", "divide the flow by the area of the bore, and give a speed"),
        ("500 gal/min", "m/s", "'gal/min' is the unit of a flow"),
        ("15 gpm", "m/s", "'gpm' is the unit of a flow"),
    ],
)
def test_marks_of_inches_commas_and_flows_are_answered_with_what_is_meant(written, unit, told):
    with pytest.raises(PydanticCustomError) as caught:
        Quantity(unit).read(written)
    words = caught.value.context
    assert told in f"{words['cause']}; {words['cure']}"


def test_a_comma_of_thousands_in_braces_is_offered_without_it():
    told = refused(f"ground: {{level: -5, stiffness: 1e6, damping: 1,000 ft}}\n{TEXT}")
    assert "Write 1.000 ft with a point, for damping. Does it mark thousands? Then write 1000 ft" in told
    well = JWELL.replace("{hold: 2200 m}", "{hold: 2,200 m}")
    with pytest.raises(SceneError) as caught:
        DrillstringScene.parse(well)
    assert well != JWELL and "Does it mark thousands? Then write 2200 m" in str(caught.value)


@pytest.mark.parametrize(
    ("words", "name"),
    [("drill pipe 5 in, 19.50 lb/ft S135", "drill pipe 5 in, 19.50 lb/ft S135"), ("HWDP, 5 in", "HWDP, 5 in")],
)
def test_a_name_of_the_catalogue_that_braces_cut_at_its_comma_is_to_be_in_quotes(words, name):
    string = f"string: [{{tubular: {words}, length: rest}}]\n"
    begin, end = JWELL.index("string:"), JWELL.index("material:")
    with pytest.raises(SceneError) as caught:
        DrillstringScene.parse(JWELL[:begin] + string + JWELL[end:])
    assert f"is cut at a comma, before '{name.split(', ')[1]}'; write the name in quotes: '{name}'" in str(caught.value)
    scene = DrillstringScene.parse(JWELL[:begin] + string.replace(words, f"'{name}'") + JWELL[end:])
    assert scene.string[0].od == pytest.approx(0.127)


@pytest.mark.parametrize("begin", [b"PK\x03\x04\x14\x00", b"\xd0\xcf\x11\xe0\xa1\xb1"])
def test_a_workbook_of_a_spreadsheet_is_to_be_saved_as_csv(tmp_path, begin):
    path = tmp_path / "plan.xlsx"
    path.write_bytes(begin + bytes(range(256)))
    with pytest.raises(SceneError, match="is a workbook of a spreadsheet, and no text; save it as CSV"):
        Columns(path)
