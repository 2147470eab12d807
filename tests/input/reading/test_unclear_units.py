"""A unit of one size here and of another there is refused with what to write; one that only one unit has is read."""

import pytest
from pydantic_core import PydanticCustomError

from tautline.scene.errors import SceneError
from tautline.scene.reading.columns import Columns
from tautline.scene.values.quantity import Quantity
from tautline.scene.values.units import UnknownUnit, read_unit
from tautline.twin.sources.reading_units import OtherQuantity, factor_between


def told(written, unit):
    with pytest.raises(PydanticCustomError) as caught:
        Quantity(unit).read(written)
    return str(caught.value.context["cause"])


@pytest.mark.parametrize("written", ["2 ton", "2 tons", "2 Ton", "2 TONS"])
def test_a_ton_is_refused_as_it_may_be_one_of_three(written):
    cause = told(written, "kg")
    assert "1000 kg" in cause and "2000 lb" in cause and "2240 lb" in cause and "write t for tonnes" in cause


@pytest.mark.parametrize(("written", "unit"), [("3 ton/m", "kg/m"), ("2 kg/pint", "kg/m^3"), ("1 ton m^2", "kg m^2")])
def test_a_unit_of_several_sizes_is_refused_within_a_product_too(written, unit):
    assert " may be " in told(written, unit) or "Britain" in told(written, unit)


@pytest.mark.parametrize(
    ("written", "unit", "cure"),
    [
        ("5 tonf", "N", "write tf"),
        ("3 cwt", "kg", "write the mass in lb"),
        ("2 pint", "m^3", "write the volume in l"),
        ("2 qt", "m^3", "write the volume in l"),
        ("5 mil", "m", "write thou"),
        ("5 mils", "rad", "mrad for the angle"),
        ("2 MT", "kg", "write t for the tonne"),
        ("2 mt", "kg", "write t for the tonne"),
        ("2 te", "kg", "write t for the tonne"),
        ("2 metric_ton", "kg", "is written t here"),
        ("2 short_ton/m", "kg/m", "is 2000 lb; write the mass in lb"),
        ("2 long_ton", "kg", "is 2240 lb; write the mass in lb"),
        ("2 ton_force", "N", "write tf"),
    ],
)
def test_a_name_that_is_unclear_is_answered_with_what_to_write(written, unit, cure):
    assert cure in told(written, unit)


@pytest.mark.parametrize(("name", "times"), [("kton", "a thousand"), ("Mton", "a million"), ("ktonf", "a thousand")])
def test_a_thousand_tons_are_as_unclear_as_one_and_are_never_answered_with_a_tonne(name, times):
    cause = told(f"2 {name}", "N" if name.endswith("f") else "kg")
    assert f"{times} times '{name[1:]}'" in cause and "2240 lb" in cause and "did you mean" not in cause


@pytest.mark.parametrize("name", ["t", "tonne", "tonnes", "tf", "kip", "lb", "oz", "gal", "gallon", "kt", "hp", "thou"])
def test_a_name_that_only_one_unit_has_is_read(name):
    assert read_unit(name).factor > 0


@pytest.mark.parametrize("name", ["bbl", "bbls", "barrel", "barrels"])
def test_a_barrel_is_that_of_the_oilfield_of_42_us_gallons(name):
    assert Quantity("m^3").read(f"1 {name}") == pytest.approx(42 * 3.785411784e-3, rel=1e-14)


def test_a_temperature_scale_is_no_unit():
    with pytest.raises(UnknownUnit, match="cannot be used here"):
        read_unit("degF")


def test_feet_a_minute_are_a_speed():
    assert Quantity("m/s").read("-30 fpm") == pytest.approx(-30 * 0.3048 / 60, rel=1e-15)


def test_no_unit_of_another_quantity_is_offered_for_a_name_that_stands_alone():
    assert told("30 xpm", "m/s") == "unknown unit 'xpm'" and "'rpm'" in told("30 xpm", "rad/s")


def test_a_ton_in_the_header_of_a_table_of_a_scene_is_refused(tmp_path):
    (tmp_path / "loads.csv").write_text("time [s],mass [ton]\n0,2\n")
    with pytest.raises(SceneError, match="may be the tonne"):
        Columns(tmp_path / "loads.csv").values(1, "kg")


def test_a_ton_in_the_header_of_sensor_data_is_not_converted_to_tonnes():
    with pytest.raises(OtherQuantity, match="may be the tonne"):
        factor_between("ton", "t")
