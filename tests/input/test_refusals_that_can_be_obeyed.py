"""What a refusal tells to write is then accepted, and a fault that follows from another is not told."""

import re

import pytest

from crane.model.build import STEP_ERROR, build
from crane.scene.scene import CraneScene
from tautline.scene.errors import SceneError

TEXT = """
rope: {mass_per_length: 6.5, axial_stiffness: 80 MN, diameter: 36 mm}
bodies: [{name: crate, mass: 3 t, position: [12.4, 0, 5]}]
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: crate}
solver: {step: 5 ms, end: 2 s}
output: {interval: 50 ms}
"""
SHEAVE, SOLVER = "axis: [0, 1, 0], wrap: over}", "{step: 5 ms, end: 2 s}"


def refused(old, new):
    """The one fault of the scene with a change."""
    with pytest.raises(SceneError) as error:
        CraneScene.parse(TEXT.replace(old, new))
    (problem,) = error.value.problems
    return problem


@pytest.mark.parametrize("written", ["efficiency: 0.97", "friction: {efficiency: 0.97}", "law: efficiency"])
def test_an_efficiency_in_a_wrong_place_is_told_how_it_is_written(written):
    cure = refused(SHEAVE, f"{SHEAVE[:-1]}, {written}}}").cure
    (advised,) = re.findall(r"\{efficiency: [\d.]+\}", cure)[:1]
    scene = CraneScene.parse(TEXT.replace(SHEAVE, f"{SHEAVE[:-1]}, law: {advised}}}"))
    assert scene.sheaves[0].law.efficiency == 0.98 and "law" in cure + written


def test_all_ways_of_a_law_are_told():
    assert (
        "must be frictionless, no_slip, capstan or {efficiency: 0.98}"
        in refused(SHEAVE, f"{SHEAVE[:-1]}, law: x}}").cure
    )


def test_words_that_may_be_written_are_told_as_a_sentence():
    assert refused("wrap: over, pay_out", "wrap: clockwise, pay_out").cure == "it must be over, under, left or right"


def test_a_blank_that_lacks_behind_a_colon_in_braces_is_told_once():
    problem = refused("step: 5 ms", "step:5 ms")
    assert problem.cure == "a blank is missing after the colon: write step: 5 ms"


@pytest.mark.parametrize(("old", "new"), [("radius: 0.4", "radius: 0,4"), ("step: 5 ms", "step: 0,005 s")])
def test_a_decimal_comma_is_told_without_what_it_makes_of_the_number_before_it(old, new):
    assert "decimal comma" in refused(old, new).cure


def test_a_modulus_for_a_stiffness_is_told_how_the_stiffness_follows():
    assert "modulus times the metal area" in refused("axial_stiffness: 80 MN", "axial_stiffness: 40 MPa").cure


@pytest.mark.parametrize(
    ("more", "error"),
    [("", STEP_ERROR), (", step_error: 1e-6", 1e-6), (", control: error", STEP_ERROR), (", control: fixed", 0.0),
     (", control: error, step_error: 1e-6", 1e-6), (", method: rk4", 0.0)],
)  # fmt: skip
def test_a_crane_takes_its_step_error_and_its_control_each_without_the_other(more, error):
    scene = CraneScene.parse(TEXT.replace(SOLVER, f"{SOLVER[:-1]}{more}}}"))
    assert build(scene).solver.step_error == error


def test_a_step_error_that_nothing_keeps_to_is_refused_with_what_is_written():
    fixed = refused(SOLVER, f"{SOLVER[:-1]}, control: fixed, step_error: 1e-6}}")
    assert "fixed step" in fixed.cause and "write `control: error`" in fixed.cure
    assert "rk4" in refused(SOLVER, f"{SOLVER[:-1]}, method: rk4, step_error: 1e-6}}").cause
