"""The largest tension is amplified over the tension at rest, also where vessel or load start with a speed.

At rest a rope that hangs straight down carries the load and its own weight below the place: m g + q g z.
"""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import tautline

MASS, ROPE, LENGTH, GRAVITY = 20e3, 2.2, 26.0, 9.81
HANGS = MASS * GRAVITY
AT_REST = np.array([HANGS + ROPE * GRAVITY * LENGTH, HANGS])
"""At the tip and at the hook, N."""
SCENE = """
title: A crate below a tip that heaves from the start on
rope: {{mass_per_length: 2.2 kg/m, axial_stiffness: 40 MN, damping: {damping}, breaking_load: 0.6 MN}}
bodies: [{{name: crate, mass: 20 t, position: [0, 0, -20]}}]
path: [{{anchor: {{name: tip, position: [0, 0, 6]}}}}, {{end: {{name: hook, body: crate}}}}]
mesh: {{elements_per_span: 8}}
vessel: {{reference: [0, 0, 0], motion: {{heave: {{harmonic: {{amplitude: {amplitude} m, period: 9 s}}}}}}}}
solver: {{step: 10 ms, end: 2 s}}
output: {{interval: 50 ms}}
limits: [{{output: dynamic_amplification, above: {most}}}]
"""
MOST = 1.6


def scene(damping="10 ms", amplitude=-0.9, most=MOST):
    return tautline.read(SCENE.format(damping=damping, amplitude=amplitude, most=most))


def of_hand(result, begin=0.0):
    """The factor by the weights that hang on the rope."""
    some = result.time >= begin - 1e-9
    return float((result["tension"][some, 0] / AT_REST).max())


def daf(result):
    return result.headline["dynamic_amplification"]


def judged(result):
    (record,) = (record for record in result.limits if record.get("output") == "dynamic_amplification")
    return record


@pytest.fixture(scope="module")
def heaving():
    return tautline.simulate(scene())


# A start upwards stretches the rope at the tip and one downwards lets it go.
@pytest.mark.parametrize(("damping", "amplitude"), [("0.5 ms", 0.9), ("10 ms", 0.9), ("10 ms", -0.9)])
def test_the_factor_is_over_the_weight_that_hangs_whatever_the_damping_does_at_a_sudden_start(damping, amplitude):
    result = tautline.simulate(scene(damping, amplitude))
    assert daf(result)["value"] == pytest.approx(of_hand(result), rel=1e-4)
    assert "first frame" not in daf(result)["text"] and "estimated" not in daf(result)["text"]


def test_a_limit_on_the_factor_is_judged_by_the_tension_at_rest(heaving):
    assert of_hand(heaving) < MOST
    assert judged(heaving)["passed"] is True and judged(heaving)["value"] == daf(heaving)["value"]


@pytest.mark.parametrize("begin", [0.0, 1.0])
def test_statistics_measure_the_factor_over_the_tension_at_rest_too(heaving, begin):
    output = {"interval": 0.05, "keep": "statistics", "windows": 0.2, "begin": begin}
    kept = tautline.simulate(scene().replace({"output": output}))
    assert daf(kept)["value"] == pytest.approx(of_hand(heaving, begin), rel=1e-4)
    assert judged(kept)["value"] == daf(kept)["value"]


@pytest.mark.parametrize("keep", ["frames", "statistics"])
def test_a_run_that_is_gone_on_with_measures_the_factor_over_the_tension_at_rest(heaving, tmp_path, keep):
    first = tautline.simulate(scene(), end=1.0, path=tmp_path / "first.nc")
    output = {"interval": 0.05} if keep == "frames" else {"interval": 0.05, "keep": keep, "windows": 0.2}
    on = tautline.simulate(scene().replace({"output": output}), resume=first, path=tmp_path / "on.nc")
    assert daf(on)["value"] == pytest.approx(of_hand(heaving), rel=1e-4) and daf(on)["text"] == daf(heaving)["text"]
    read = tautline.Result.read(tmp_path / "on.nc")
    assert np.allclose(read.attributes["start"]["at_rest"]["tension"], [AT_REST], rtol=1e-4)


@pytest.mark.parametrize("keep", [True, 0.5])
def test_a_simulation_measures_the_factor_over_the_tension_at_rest_also_after_a_way_back(heaving, keep):
    sim = tautline.Simulation(scene(), keep=keep)
    sim.advance_to(1.0)
    state = sim.save()
    sim.advance_to(2.0)
    begin = 0.0 if keep is True else 1.5
    assert daf(sim.result)["value"] == pytest.approx(of_hand(heaving, begin), rel=1e-4)
    assert daf(sim.copy().result) == daf(sim.result)
    other = tautline.Simulation(scene(), keep=keep)
    other.restore(pickle.loads(pickle.dumps(state)))
    other.advance_to(2.0)
    assert daf(other.result)["value"] == pytest.approx(of_hand(other.result), rel=1e-4)
    assert "where the result begins" not in daf(other.result)["text"]


def test_a_sweep_and_its_limits_have_the_factor_of_the_run(heaving):
    collect = ["dynamic_amplification", "limits_failed"]
    data = tautline.sweep(scene(), {"rope.damping": ["10 ms", "0.5 ms"]}, collect=collect, jobs=1)
    assert float(data["dynamic_amplification"][0]) == pytest.approx(daf(heaving)["value"], rel=1e-9)
    assert data["limits_failed"].values.tolist() == [0, 0]


def test_a_result_of_an_earlier_version_says_that_the_factor_is_over_the_first_frame(heaving):
    from crane.results.summary import headline

    class Earlier(dict):
        time = heaving.time
        attributes = heaving.attributes | {"start": {"found": "static", "stable": True}}

    part = Earlier({name: heaving[name] for name in ("tension", "body_position", "position")})
    # The first frame of an earlier version had the rope's damping in it.
    part["tension"] = np.concatenate(([0.8 * heaving["tension"][0]], heaving["tension"][1:]))
    found = headline(part, scene(), names=["dynamic_amplification"])["dynamic_amplification"]
    assert found["value"] == pytest.approx(of_hand(heaving) / 0.8, rel=1e-4)
    assert "over the tension in the first frame" in found["text"]


def test_a_scene_that_starts_as_drawn_is_measured_over_an_estimate_of_the_tension_at_rest():
    drawn = tautline.simulate(scene().replace({"start": "as drawn", "rope.length": LENGTH / (1.0 + HANGS / 40e6)}))
    assert "at_rest" not in drawn.attributes.get("start", {})
    assert "tension at rest estimated" in daf(drawn)["text"]
    assert daf(drawn)["value"] == pytest.approx(of_hand(drawn), rel=1e-3)
