"""An unknown unit is answered with units of the kind that is wanted, and an example has the unit of its kind."""

import re

import pytest
from pydantic_core import PydanticCustomError

from tautline.scene.values.quantity import MEANINGS, Quantity
from tautline.scene.values.units import read_unit


def refused(written, unit):
    with pytest.raises(PydanticCustomError) as caught:
        Quantity(unit).read(written)
    return str((caught.value.context or {})["cause"]), str((caught.value.context or {})["cure"])


@pytest.mark.parametrize(
    ("written", "unit", "some", "others"),
    [
        ("5 tt", "kg", {"t", "kg", "lb"}, {"m", "s", "N", "psi"}),
        ("3 mmm", "m", {"m", "ft", "in"}, {"kg", "s", "bar"}),
        ("2 kkN", "N", {"kN", "lbf"}, {"kg", "m", "psi"}),
    ],
)
def test_an_unknown_unit_is_answered_with_those_of_its_kind(written, unit, some, others):
    cause, _ = refused(written, unit)
    named = set(cause.partition("known: ")[2].split(", "))
    assert some <= named and not others & named
    assert {read_unit(one).dimension for one in named} == {read_unit(unit).dimension}


@pytest.mark.parametrize(("written", "unit", "meant"), [("5 kpsii", "Pa", "kpsi"), ("3 rpmm", "rad/s", "rpm")])
def test_a_slip_of_the_pen_is_answered_with_the_unit(written, unit, meant):
    assert f"did you mean '{meant}'?" in refused(written, unit)[0]


@pytest.mark.parametrize(("written", "unit"), [("5 qqq", "N m^2"), ("5 qqq m", "N m"), ("5 qqq", "m/s")])
def test_where_no_single_unit_is_of_the_kind_the_example_is_all_that_is_told(written, unit):
    cause, cure = refused(written, unit)
    assert cause == "unknown unit 'qqq'" and cure == f"give {MEANINGS[unit][0]} such as {MEANINGS[unit][1]}"


@pytest.mark.parametrize("unit", [unit for unit in MEANINGS if unit])
def test_every_kind_of_quantity_has_an_example_with_its_unit(unit):
    examples = (re.fullmatch(r"[-+.\de]+ (?P<unit>\S.*)", one) for one in re.split(" or |, ", MEANINGS[unit][1]))
    assert read_unit(unit).dimension in {read_unit(one["unit"]).dimension for one in examples if one}


def test_a_bending_stiffness_in_another_unit_is_told_its_own():
    cause, cure = refused("1 Nm2", "N m^2")
    assert "Nm2" in cause and "0.001 N m^2" in cure
