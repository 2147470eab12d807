"""Bodies feel the water at any height: `check`, a run and storms say so of a load that comes out of it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from storms.test_operability import ALONE, asked

import tautline
from crane.application import Crane
from crane.operability.storms import operability
from crane.results.out_of_water import heights_of, out_of_water_in_storms

HOISTED = """
title: lift through the surface
rope: {mass_per_length: 2 kg/m, axial_stiffness: 20 MN, damping: 10 ms, diameter: 24 mm, breaking_load: 400 kN}
water: {surface: 0 m, density: 1025 kg/m^3}
bodies:
  - {name: load, mass: 5 t, position: [10.2, 0, -5], volume: 2 m^3, drag: {quadratic: [1000, 1000, 5000]}}
path:
  - drum: {name: winch, center: [0, 0, 10], radius: 0.4, axis: [0, 1, 0], wrap: over,
           pay_out: {ramp: {to: -0.5 m/s, over: 2 s}}}
  - sheave: {name: tip, center: [10, 0, 20], radius: 0.2, axis: [0, 1, 0], wrap: over}
  - end: {name: hook, body: load}
mesh: {elements_per_span: 1}
vessel:
  reference: [0, 0, 0]
  motion: {heave: {spectrum: {significant_height: 0.3 m, peak_period: 8 s, components: 600, ramp: 5 s}}}
solver: {step: 50 ms, end: 16 s}
output: {interval: 50 ms}
"""
BUOYANCY = "20.1"
"""kN, of 2 m^3 of sea water: 1025 * 2 * 9.80665."""


def check(text):
    return [one.text for one in Crane().warnings(tautline.read(text)) if "out of the water" in one.text]


def test_check_foresees_when_the_winch_has_the_load_out_of_the_water():
    (told,) = check(HOISTED)
    # 5 m at 0.5 m/s after a ramp of 2 s that takes half of that: 11 s.
    assert "out of the water at about t = 11 s" in told and f"{BUOYANCY}" in told and "safety factors too high" in told
    assert check(HOISTED.replace("-0.5 m/s", "0.5 m/s")) == [] and check(HOISTED.replace("16 s", "9 s")) == []
    in_air = HOISTED.replace(", volume: 2 m^3, drag: {quadratic: [1000, 1000, 5000]}", "")
    assert check(in_air) == []


def test_a_run_tells_when_and_how_high_it_comes_out():
    scene = tautline.read(HOISTED)
    run = tautline.simulate(scene)
    (told,) = [one for one in run.attributes["warnings"] if "out of the water" in one]
    height = run["body_position"][:, 0, 2]
    first = run.time[height > 0.0][0]
    assert f"first at t = {first:.4g} s" in told and f"up to {height.max():.3g} m above" in told and BUOYANCY in told
    # In air the rope would bear all of the load, and it bears less by the buoyancy.
    tension = run["tension"].reshape(len(run.time), -1)[height > 1.0].mean()
    assert tension < 5000.0 * 9.80665 - 15e3
    short = tautline.simulate(scene.replace({"solver.end": 8.0}))
    assert not any("out of the water" in one for one in short.attributes["warnings"])


@pytest.mark.parametrize(("end", "storms"), [(20.0, 3), (5.0, 0)])
def test_storms_tell_in_how_many_of_them_it_comes_out(end, storms):
    slow = HOISTED.replace("-0.5 m/s", "-0.2 m/s")
    found = operability(Crane(), tautline.read(slow), asked((0.3,), 3, end, limits=["max_tension < 65 kN"]), ALONE)
    told = [one for one in found.warnings if "out of the water" in one]
    # 20 s of lead-in bring it 3.8 m up; the surface is 1.2 m or 6 s away.
    assert len(told) == (storms > 0) and all("in 3 of 3 storms" in one and BUOYANCY in one for one in told)


REST = HOISTED.replace("[10.2, 0, -5]", "[10.2, 0, 0]").replace(
    "pay_out: {ramp: {to: -0.5 m/s, over: 2 s}}", "pay_out: 0"
).replace("significant_height: 0.3 m", "significant_height: 1 mm")  # fmt: skip


def test_a_load_at_rest_in_the_surface_is_not_out_of_the_water_by_rounding():
    assert not any("above the water" in one.text for one in Crane().warnings(tautline.read(REST)))
    above = tautline.read(REST.replace("[10.2, 0, 0]", "[10.2, 0, 2.9e-14]"))
    assert not any("above the water" in one.text for one in Crane().warnings(above))
    run = tautline.simulate(above.replace({"solver.end": 2.0}))
    assert 0.0 < run["body_position"][:, 0, 2].max() < 0.01
    assert not any("out of the water" in one for one in run.attributes["warnings"])
    rounding = {"load.position[2] max": np.array([2.9e-14, 0.009])}
    assert in_storms(rounding, HOISTED) == []


def in_storms(columns, text, begin=10.0):
    data = {name: SimpleNamespace(values=values) for name, values in columns.items()}
    scene = tautline.read(text)
    return out_of_water_in_storms(data, heights_of(scene), scene, begin)


def let_go(at, volume="0 m^3"):
    left = f"release: {{at: {at} s, remaining: 2 t, volume: {volume}, drag: {{quadratic: [0, 0, 0]}}}}"
    return HOISTED.replace("quadratic: [1000, 1000, 5000]}", f"quadratic: [1000, 1000, 5000]}}, {left}")


@pytest.mark.parametrize(
    ("at", "volume", "kilonewtons"),
    [
        (5, "0 m^3", None), (12, "0 m^3", None), (20, "0 m^3", BUOYANCY), (5, "1 m^3", "10.06"), (12, "1 m^3", "10.06"),
        (20, "1 m^3", BUOYANCY),
    ],
)  # fmt: skip
def test_storms_judge_what_of_a_load_is_there_in_them(at, volume, kilonewtons):
    """A storm counts from 10 s to 16 s: water does not act on a hook that lost its load before."""
    told = in_storms({"load.position[2] max": np.array([1.0, -2.0])}, let_go(at, volume))
    assert len(told) == (kilonewtons is not None)
    assert all("in 1 of 2 storms" in one and f"above the surface: {kilonewtons}" in one for one in told)


def test_a_run_that_check_has_foreseen_does_not_tell_the_cure_again():
    scene = tautline.read(HOISTED)
    (before,) = check(HOISTED)
    (after,) = [one for one in tautline.simulate(scene).attributes["warnings"] if "out of the water" in one]
    assert "`height`" in before and "scene of its own" not in after and BUOYANCY in after
    (storms,) = in_storms({"load.position[2] max": np.array([1.0])}, HOISTED)
    assert "`height`" not in storms and BUOYANCY in storms


def test_a_run_that_nobody_has_foreseen_tells_the_cure():
    lifted = HOISTED.replace("pay_out: {ramp: {to: -0.5 m/s, over: 2 s}}", "pay_out: 0")
    assert check(lifted) == []
    (storms,) = in_storms({"load.position[2] max": np.array([1.0])}, lifted)
    assert "`height`" in storms and BUOYANCY in storms
