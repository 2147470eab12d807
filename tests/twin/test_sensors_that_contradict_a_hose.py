"""A hose with water, of which the tip is measured: what is hidden is found, or the twin says that it is not."""

import functools

import numpy as np
import pytest
import yaml

import tautline
from tautline.twin.twin import Twin

pytestmark = pytest.mark.study

STIFFNESS, MASS = 1.08e-3, 7.854e-4
"""What the twin does not know, N m2 and kg/m: as in the shipped scene."""
NOISE = 1e-3
"""Of either sensor of the tip, m."""
SENSORS = """
sensors:
  - {column: flow, unit: m/s, input: water.speed}
  - {column: up, unit: m, output: "tip.position[2]", sd: 1 mm}
  - {column: along, unit: m, output: "tip.position[0]", sd: 1 mm}
window: 1 s
estimate:
  - {parameter: hose.fluid_mass, start: 1.2e-3, sd: 4e-4, range: [1e-4, 3e-3]}
"""
STIFF = "  - {parameter: hose.bending_stiffness, start: 0.002, sd: 0.0008, range: [0.0003, 0.005]}\n"


def hose():
    scene = yaml.safe_load(open("data/hose.yaml"))
    scene["hose"]["elements"] = 5
    scene["water"]["speed"] = {"ramp": {"to": 6.0, "over": 0.5}}
    scene["solver"] |= {"step": "2 ms", "end": 8.0}
    scene["output"]["interval"] = 0.05
    return tautline.read(scene)


@functools.cache
def measured():
    """Stamps, flow, and the tip's height and reach, without noise."""
    data = tautline.simulate(hose()).data
    return data.time.values, data.flow_speed.values, data.tip.values[:, 2], data.tip.values[:, 0]


def lines(map, until, seed=0, off=lambda t: 0.0):
    """Lines of a twin whose sensor of the tip's height is off."""
    twin, noise, found = Twin(hose(), map), np.random.default_rng(seed), []
    for t, *values in zip(*measured(), strict=True):
        if t > until:
            break
        values = np.array(values) + [0.0, *NOISE * noise.standard_normal(2)]
        found += twin.add(float(t), values + [0.0, off(t), 0.0])
    return found


def off_by(line, name, truth):
    """How many stated deviations an estimate is off."""
    one = line["estimates"][name]
    return abs(one["value"] - truth) / one["sd"]


@pytest.mark.parametrize("seed", range(4))
def test_two_unknowns_and_a_short_window_are_found_from_a_first_guess_far_away(seed):
    found = [line for line in lines(SENSORS + STIFF, 5.0, seed) if line["time"] > 2.5]
    assert all(line["health"] == "good" for line in found)
    for name, truth, first in (("hose.bending_stiffness", STIFFNESS, 8e-4), ("hose.fluid_mass", MASS, 4e-4)):
        assert found[-1]["estimates"][name]["sd"] < 0.7 * first
        assert max(off_by(line, name, truth) for line in found) < 3.0


def test_health_is_not_good_for_long_where_a_sensor_drifts_away_from_what_is_expected():
    found = lines(SENSORS, 6.5, off=lambda t: 0.02 * max(0.0, t - 3.0))
    far = [line for line in found if line["time"] > 3.5 and abs(line["residuals"]["tip.position[2]"]) > 0.02]
    assert len(far) > 20 and {line["health"] for line in far} == {"degraded"}
    assert off_by(found[-1], "hose.fluid_mass", MASS) < 3.0
    assert {line["health"] for line in found if 2.0 < line["time"] < 3.0} == {"good"}


def test_where_one_of_two_sensors_is_off_for_good_the_truth_is_within_the_deviations_or_health_is_not_good():
    found = [line for line in lines(SENSORS, 8.0, off=lambda t: 0.02 * (t > 3.0)) if line["time"] > 3.5]
    assert max(off_by(line, "hose.fluid_mass", MASS) for line in found) < 5.0
    wrong = [line for line in found if off_by(line, "hose.fluid_mass", MASS) > 3.0]
    assert sum(line["health"] == "good" for line in wrong) <= 10  # half a second
    assert found[-1]["health"] == "degraded"
