"""The largest tension of a string at rest stands where its hole is highest: w (TVD_bit - TVD_min) without friction."""

import numpy as np
import pytest

from drillstring.model.prepared import prepared
from drillstring.scene.scene import DrillstringScene
from drillstring.string.strength import largest_at_rest, tension_at
from drillstring.warnings import warnings
from drillstring.well.wellbore import from_survey

SCENE = """
title: a hole that climbs
well:
  inclination: {first}
  sections: [{sections}]
  diameter: 8.5 in
  wall: {{stiffness: 1.0e8, damping: 1.0e6, friction: 0.0}}
string: [{string}]
material: {{youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}}
mud: {{density: 1200}}
model: {{kind: lumped, elements: 50}}
solver: {{method: generalized-alpha, step: 2 ms, end: 1 s}}
output: {{interval: 50 ms}}
"""
HUMP = (
    "{hold: 100 m}, {build: {rate: 3 deg/30m, to: 150 deg}}, {hold: 800 m}, {build: {rate: 3 deg/30m, to: 20 deg}}, "
    "{hold: 1500 m}"
)
PIPE = "od: 0.127, id: 0.1086"
WEIGHT = (7850.0 - 1200.0) * 9.81 * np.pi / 4.0 * (0.127**2 - 0.1086**2)
RADIUS = 30.0 / np.radians(3.0)


def scene(string, first="30 deg", sections=HUMP):
    return DrillstringScene.parse(SCENE.format(string=string, first=first, sections=sections))


def told(given):
    return [one for one in warnings(given) if one.where.endswith("yield_load")]


def above_the_bit():
    """How much higher than the bit the hump is, m: an arc from level to 20 deg, and 1500 m at that angle."""
    return RADIUS * (1.0 - np.sin(np.radians(20.0))) + 1500.0 * np.cos(np.radians(20.0))


def test_a_section_whose_hole_climbs_is_judged_by_its_tension_at_the_top_of_the_hump():
    given = scene(f"{{name: dp, length: rest, {PIPE}, yield_load: 300 kN}}")
    (said,) = told(given)
    load = WEIGHT * above_the_bit()
    assert load > 3.9e5
    assert float(said.text.split("carries ")[1].split(" kN")[0]) * 1e3 == pytest.approx(load, rel=2e-3)
    # 100 m, 1200 m up to 150 deg, 800 m, and from there an arc by 60 deg to the level
    assert float(said.text.split("at rest at ")[1].split(" m")[0]) == pytest.approx(2100.0 + 600.0, abs=1.0)
    assert told(scene(f"{{name: dp, length: rest, {PIPE}, yield_load: {load / 0.81} N}}")) != []
    assert told(scene(f"{{name: dp, length: rest, {PIPE}, yield_load: {load / 0.79} N}}")) == []


def test_each_section_is_judged_by_what_is_largest_within_it():
    upper, lower = (f"{{name: {name}, length: {length}, {PIPE}, yield_load: {load}}}"
                    for name, length, load in (("u", "2000 m", "3 MN"), ("l", "rest", "300 kN")))  # fmt: skip
    (said,) = told(scene(f"{upper}, {lower}"))
    assert said.where == "string[1].yield_load" and "l carries 39" in said.text


def test_the_largest_tension_is_nowhere_less_than_at_a_thousand_places_of_a_crooked_hole():
    generator = np.random.default_rng(5)
    md = np.arange(0.0, 1800.0, 30.0)
    inc = np.radians(90.0 + 25.0 * np.sin(md / 110.0) + generator.normal(0.0, 4.0, md.size))
    well = from_survey(md, inc, np.radians(generator.normal(0.0, 5.0, md.size)))
    level = well.level()
    assert level.size > 4 and well.inclination(level) == pytest.approx(np.pi / 2.0, abs=1e-9)
    fine = np.linspace(0.0, well.length, 200_001)
    assert level.size == np.count_nonzero(np.diff(np.sign(np.cos(well.inclination(fine)))))
    given = scene(f"{{name: a, length: 700 m, {PIPE}}}, {{name: b, length: 1070 m, od: 0.165, id: 0.07}}")
    lumps = prepared(scene(f"{{name: a, length: 700 m, {PIPE}}}, {{name: b, length: rest, od: 0.165, id: 0.07}}")).lumps
    most, place = largest_at_rest(given, well, lumps)
    places = np.linspace(0.0, well.length, 1000)
    tension = tension_at(given, well, lumps, places)
    for i, inside in enumerate((places < 700.0, places >= 700.0)):
        assert most[i] >= tension[inside].max() and most[i] == pytest.approx(tension[inside].max(), rel=1e-3)
        assert tension_at(given, well, lumps, place[i : i + 1]) == pytest.approx(most[i])
