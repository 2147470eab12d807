"""Numbers and units: exact, equal to pint, and never a surprise."""

import math
import subprocess
import sys

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic_core import PydanticCustomError

from tautline.scene.errors import SceneError
from tautline.scene.reading.columns import Columns
from tautline.scene.values.quantity import MEANINGS, quantity
from tautline.scene.values.units import TABLE, UnknownUnit, pint_registry, read_unit

PINTS_NAME = {
    **dict.fromkeys(("bbl", "bbls", "barrel", "barrels"), "oil_bbl"),
    "rev": "revolution",
    "%": "percent",
    "lbm": "pound",
    "klbm": "klb",
    "usft": "survey_foot",
}


def si(written, unit, **bounds):
    return quantity(unit, **bounds).read(written)


@pytest.mark.parametrize("name", TABLE)
def test_every_unit_of_the_table_equals_pint(name):
    registry, unit = pint_registry(), TABLE[name]
    pints = registry.Quantity(1.0, registry.parse_units(PINTS_NAME.get(name, name))).to_base_units()
    assert float(unit.factor) * math.pi**unit.turns == pytest.approx(pints.magnitude, rel=1e-14)
    dimension = dict(pints.dimensionality)
    assert (unit.mass, unit.length, unit.time) == tuple(dimension.get(f"[{n}]", 0) for n in ("mass", "length", "time"))


@pytest.mark.parametrize(
    ("written", "unit", "value"),
    [
        ("36 mm", "m", 0.036),
        ("50 ms", "s", 0.05),
        ("5 in", "m", 0.127),
        ("5in", "m", 0.127),
        ("1.1 MN", "N", 1.1e6),
        ("5 t", "kg", 5000.0),
        ("200 GPa", "Pa", 2.0e11),
        ("7850 kg/m^3", "kg/m^3", 7850.0),
        ("7850 kg/m3", "kg/m^3", 7850.0),
        ("7850 kg/m³", "kg/m^3", 7850.0),
        ("7850 kg m**-3", "kg/m^3", 7850.0),
        ("1.84 sg", "kg/m^3", 1840.0),
        ("1.84 g/cc", "kg/m^3", 1840.0),
        ("12.5 ppg", "kg/m^3", 12.5 * 0.45359237 / (231 * 0.0254**3)),
        ("90 deg", "rad", math.pi / 2),
        ("180°", "rad", math.pi),
        ("60 rpm", "rad/s", 2 * math.pi),
        ("60 rev/min", "rad/s", 2 * math.pi),
        ("1.5 rev", "rad", 3 * math.pi),
        ("90 deg/s", "rad/s", math.pi / 2),
        ("3 deg/30m", "rad/m", math.radians(3) / 30),
        ("3 deg/30 m", "rad/m", math.radians(3) / 30),
        ("3 deg/100ft", "rad/m", math.radians(3) / 30.48),
        ("0.001 1/m", "rad/m", 0.001),
        ("20 kN m", "N m", 2.0e4),
        ("20 kN*m", "N m", 2.0e4),
        ("1000 ft-lbf", "N m", 1000 * 0.3048 * 4.4482216152605),
        ("10 klbf", "N", 44482.216152605),
        ("10 kip", "N", 44482.216152605),
        ("20 kft-lbf", "N m", 20e3 * 0.3048 * 4.4482216152605),
        ("20 klbf ft", "N m", 20e3 * 0.3048 * 4.4482216152605),
        ("20 kip-ft", "N m", 20e3 * 0.3048 * 4.4482216152605),
        ("3000 psi", "Pa", 3000 * 4.4482216152605 / 0.0254**2),
        ("3937 usft", "m", 1200.0),
        ("15 kpsi", "Pa", 15e3 * 4.4482216152605 / 0.0254**2),
        ("300 klb", "kg", 300e3 * 0.45359237),
        ("30 Mpsi", "Pa", 30e6 * 4.4482216152605 / 0.0254**2),
        ("19.5 lb/ft", "kg/m", 19.5 * 0.45359237 / 0.3048),
        ("19.5 lbm/ft", "kg/m", 19.5 * 0.45359237 / 0.3048),
        ("19.5 ppf", "kg/m", 19.5 * 0.45359237 / 0.3048),
        ("490 pcf", "kg/m^3", 490 * 0.45359237 / 0.3048**3),
        ("1e5 lbf/ft", "N/m", 1e5 * 4.4482216152605 / 0.3048),
        ("60 ft/hr", "m/s", 60 * 0.3048 / 3600),
        ("10 N s/m", "N s/m", 10.0),
        ("20 N m s/rad", "N m s/rad", 20.0),
        ("20 N/(m/s)", "N s/m", 20.0),
        ("86 in^4", "m^4", 86 * 0.0254**4),
        ("30 %", "", 0.3),
        ("-1.5e-3 m", "m", -1.5e-3),
        ("2 fathom", "m", 3.6576),
        (3, "m", 3.0),
        (1e-3, "m", 1e-3),
    ],
)
def test_a_quantity_is_read_in_si(written, unit, value):
    assert si(written, unit) == pytest.approx(value, rel=2e-15 if written != "2 fathom" else 1e-5)


@pytest.mark.parametrize(
    ("written", "unit", "value"),
    [
        ("12 rpm", "Hz", 0.2),
        ("1 rad/s", "Hz", 1 / (2 * math.pi)),
        ("360 deg/s", "Hz", 1.0),
        ("3 turn/min", "Hz", 0.05),
        ("12 1/min", "Hz", 0.2),
        ("2 1/s", "Hz", 2.0),
        ("50 mHz", "Hz", 0.05),
        ("2 MHz", "Hz", 2e6),
        ("2 turn/s", "rad/s", 4 * math.pi),
        ("60 rpm/s", "rad/s^2", 2 * math.pi),
        ("0.1 Hz", "1/s", 0.1),
    ],
)
def test_a_turn_is_one_cycle_and_two_pi_radians(written, unit, value):
    assert si(written, unit) == pytest.approx(value, rel=4e-15)


@pytest.mark.parametrize(
    ("written", "unit"),
    [("60 1/min", "rad/s"), ("1 1/s", "rad/s"), ("1 Hz", "rad/s"), ("1 kHz", "rad/s"), ("0.1 Hz/s", "rad/s^2")]
    + [("0.1 1/s^2", "rad/s^2"), ("3 N m/Hz", "N m s/rad")],
)
def test_a_rotary_speed_of_something_uncounted_is_refused(written, unit):
    with pytest.raises(PydanticCustomError, match="does not say whether turns or radians are counted"):
        si(written, unit)


@pytest.mark.parametrize("unit", ["Hz", "rad/s", "1/s"])
def test_decays_of_a_nuclide_are_no_frequency(unit):
    with pytest.raises(PydanticCustomError, match="'Bq' is not the unit"):
        si("3 Bq", unit)


@pytest.mark.parametrize("written", ["kkN", "MkN", "kkPa", "kkPas", "kkg", "mmm", "kMPa", "mft", "Mlbf"])
def test_no_unit_that_lacks_or_changes_a_prefix_is_said_to_be_meant(written):
    with pytest.raises(UnknownUnit) as caught:
        read_unit(written)
    assert "did you mean" not in str(caught.value) and "known: m, km, mm" in str(caught.value)


@pytest.mark.parametrize(
    ("written", "meant"), [("kpsii", "kpsi"), ("Mpaa", "MPa"), ("rpmm", "rpm"), ("lbff", "lbf"), ("Mfot", "foot")]
)
def test_a_slip_of_the_pen_in_a_unit_is_answered_with_the_unit(written, meant):
    with pytest.raises(UnknownUnit, match=f"did you mean '{meant}'"):
        read_unit(written)


@pytest.mark.parametrize("written", ["pin", "mpsi", "kin", "mft", "Mlbf", "kmile"])
def test_a_prefix_on_a_unit_that_takes_none_is_refused(written):
    with pytest.raises(UnknownUnit, match="takes no such prefix"):
        read_unit(written)


@pytest.mark.parametrize(("written", "unit"), [("50 klb", "N"), ("100 lb", "N"), ("20000 ft-lb", "N m")])
def test_a_pound_where_a_force_is_wanted_is_refused_with_how_to_write_it(written, unit):
    with pytest.raises(PydanticCustomError, match="a pound is a mass") as caught:
        si(written, unit)
    assert "write lbf, klbf or ft-lbf" in caught.value.context["cure"]


@pytest.mark.parametrize(
    ("written", "inches"), [("12 1/4 in", 12.25), ("6 1/2in", 6.5), ("-1 3/4 in", -1.75), ("4 1/3 in", 13.0 / 3.0)]
)
def test_a_mixed_number_of_a_length_is_read_as_the_sum_of_whole_and_fraction(written, inches):
    assert si(written, "m") == pytest.approx(0.0254 * inches, rel=1e-15)
    assert si("17 1/2 ft", "m") == pytest.approx(17.5 * 0.3048, rel=1e-15)


@pytest.mark.parametrize(
    ("written", "unit", "decimal"),
    [("8 1/2 kN", "N", "8.5 kN"), ("1/2 in", "m", "0.5 in"), ("2 5/4 in", "m", "3.25 in"), ("1/0 in", "m", "")],
)
def test_any_other_fraction_is_refused_with_the_decimal_number_to_write(written, unit, decimal):
    with pytest.raises(PydanticCustomError, match="is a fraction") as caught:
        si(written, unit)
    assert caught.value.context["cure"].startswith(f"write {decimal}, or give " if decimal else "give a length")


def test_decimal_prefixes_lose_no_bit():
    for n in range(1, 2000):
        assert si(f"{n} mm", "m") == float(f"{n}e-3")
        assert si(f"{n} ms", "s") == float(f"{n}e-3")


@pytest.mark.parametrize(
    "written",
    [True, None, [], {}, "", "m", "12", "1 kg", "1 degC m", "1 m m", "nan", "inf m", "1e999 m", math.nan, math.inf]
    + [10**400, "1 m^", "1 (m", "1 m)", "1 m//s s", "1 * m*", "1_000 m", "1/2 in", "0x10 m", "1 m" + " " * 10 + "!"]
    + [
        "1 " + "m/" * 100,
        "1 __import__",
        "1 m**9**9",
        "9e99999999999 m",
        "0." + "0" * 500 + "1 m",
        "1 0m",
        "1 m\n2",
        "1 m 10",
        "1 10 m",
    ],
)
def test_what_is_no_length_is_refused_with_a_cure(written):
    with pytest.raises(PydanticCustomError) as caught:
        si(written, "m")
    assert "a length such as" in caught.value.context["cure"]


def test_bounds_hold_at_their_edge():
    with pytest.raises(PydanticCustomError, match="greater than zero"):
        si(0, "m", positive=True)
    with pytest.raises(PydanticCustomError, match="must not be negative"):
        si("-1 mm", "m", nonnegative=True)
    with pytest.raises(PydanticCustomError, match="less than 1"):
        si(1, "", below=1.0)
    with pytest.raises(PydanticCustomError, match="more than 1"):
        si(1.1, "", at_most=1.0)
    assert si(0, "m", nonnegative=True) == 0.0
    assert si(1, "", at_most=1.0) == 1.0


def test_every_example_given_in_a_cure_is_itself_understood():
    for unit, (_, example) in MEANINGS.items():
        first = example.split(" or ")[0].split(",")[0]
        number = float(first) if first.replace(".", "").replace("e", "").replace("-", "").isdigit() else first
        assert math.isfinite(si(number, unit)), example
        if " or " in example and "," not in example:
            assert math.isfinite(si(example.split(" or ")[1], unit)), example


def test_common_units_do_not_load_pint():
    code = (
        "import sys; from tautline.scene.values.units import TABLE, read_unit; [read_unit(name) for name in TABLE];"
        "read_unit('deg/30m'); assert 'pint' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@settings(max_examples=100, deadline=None)
@given(st.text(alphabet="0123456789.eE+-*/^() kgmsNPadeg°%²", max_size=12))
def test_any_text_is_a_finite_number_or_refused(text):
    try:
        value = si(text, "m")
    except PydanticCustomError:
        return
    assert isinstance(value, float)
    assert math.isfinite(value)


@settings(max_examples=100, deadline=None)
@given(st.lists(st.sampled_from([name for name in TABLE if name.isalpha()]), min_size=1, max_size=4))
def test_products_and_quotients_are_those_of_their_factors(names):
    product, quotient = read_unit(" ".join(names)), read_unit("/".join(names))
    expected = math.prod(TABLE[name].factor for name in names)
    assert product.factor == expected
    assert quotient.factor == TABLE[names[0]].factor ** 2 / expected


def test_an_unknown_unit_is_met_with_the_nearest_known():
    with pytest.raises(UnknownUnit, match="unknown unit 'rmp'; did you mean 'rpm'"):
        read_unit("rmp")


def test_frequencies_in_the_header_of_a_table_are_turned_into_what_is_wanted(tmp_path):
    path = tmp_path / "speeds.csv"
    path.write_text("frequency [rpm],speed [1/min]\n12,60\n")
    columns = Columns(path)
    assert columns.values(0, "Hz") == pytest.approx((0.2,))
    with pytest.raises(SceneError, match="turns or radians"):
        columns.values(1, "rad/s")


@pytest.mark.parametrize("unit", ["kg/m^3", "kg m^-1", "N m^2", "1/s"])
def test_negative_powers_above_the_line_are_read_as_those_behind_a_caret(unit):
    raised = {"kg/m^3": "kg·m⁻³", "kg m^-1": "kg·m⁻¹", "N m^2": "N·m²", "1/s": "s⁻¹"}[unit]
    assert si(f"2 {raised}", unit) == 2.0


@pytest.mark.parametrize(
    "written, meant", [("10 Nm^2", "N m^2"), ("10 Nm2", "N m2"), ("10 Nm²", "N m²"), ("10 kNm²", "kN m²")]
)
def test_a_power_of_newton_metres_as_one_word_is_asked_about(written, meant):
    with pytest.raises(PydanticCustomError, match=r"is not (the unit of a bending stiffness|a unit)") as told:
        si(written, "N m^2")
    assert told.value.context["cure"].startswith(f"did you mean '{meant}'?")


def test_a_load_per_length_is_called_so():
    with pytest.raises(PydanticCustomError) as told:
        si("-1 kg/m", "N/m", of="load per length")
    assert "'kg/m' is not the unit of a load per length" in str(told.value) and "stiffness" not in str(told.value)
