"""Friction that changes while the string moves, without a connection in between: it is followed, and it is said."""

import numpy as np
import pytest

import tautline
from tautline.twin.map.file import read_map
from tautline.twin.record import Sensing, record
from tautline.twin.twin import Twin

WELL = """
title: A slant hole in which the block goes to and fro
well:
  inclination: 50 deg
  azimuth: 200 deg
  sections: [{hold: 3000 m}]
  diameter: 8.5 in
  wall: {stiffness: 1.0e9, damping: 5.0e6, friction: 0.2}
string:
  - {name: dp, length: rest, od: 5 in, id: 4.276 in, tool_joint_od: 6.625 in, mass_per_length: 33}
material: {youngs_modulus: 206 GPa, shear_modulus: 79 GPa, density: 7850}
mud: {density: 1500, inside_density: 1100}
damping: {structural: 20 ms}
top: {block: {harmonic: {amplitude: 2 m, period: 30 s, ramp: 10 s}}, rotation: 0}
model: {elements: 10}
solver: {step: 20 ms, end: 220, rho_inf: 0.5}
output: {interval: 0.2}
"""
MAP = """
sensors:
  - {column: block, unit: m, input: top.block}
  - {column: hook, unit: kN, output: top.hook_load, sd: 1 %}
estimate:
  - {parameter: wall.friction, start: 0.4, sd: 0.15, range: [0.02, 0.8]}
ahead: 0 s
"""
BEFORE, AFTER, CHANGED = 0.2, 0.35, 120.0


def rows_with(scene, plan, friction):
    """Rows of a string in a hole with this friction, with 1 % of noise."""
    return list(record(scene.replace({"well.wall.friction": friction}), plan, Sensing(rate=2.5, noise=0.01, seed=1)))


@pytest.fixture(scope="module")
def lines(tmp_path_factory):
    folder = tmp_path_factory.mktemp("changes")
    (folder / "well.yaml").write_text(WELL)
    (folder / "map.yaml").write_text(MAP)
    scene, plan = tautline.read(folder / "well.yaml"), read_map(folder / "map.yaml")
    old, new = (rows_with(scene, plan, friction) for friction in (BEFORE, AFTER))
    rows = [row for row in old if row[0] < CHANGED] + [row for row in new if row[0] >= CHANGED]
    twin = Twin(scene, plan)
    return [line for t, values in rows for line in twin.add(t, values)] + twin.finish()


def friction(lines, time):
    return min(lines, key=lambda line: abs(line["time"] - time))["estimates"]["wall.friction"]


def test_friction_that_changes_is_found_again_within_one_and_a_half_minutes(lines):
    assert friction(lines, CHANGED - 1.0)["value"] == pytest.approx(BEFORE, abs=0.005)
    assert friction(lines, CHANGED + 90.0)["value"] == pytest.approx(AFTER, abs=0.01)


def test_that_friction_has_changed_is_told_within_a_minute_and_not_before(lines):
    told = [line["time"] for line in lines if any(one["name"] == "changed" for one in line["alarms"])]
    assert told and CHANGED < told[0] < CHANGED + 60.0
    assert np.isfinite(friction(lines, told[0])["sd"])
