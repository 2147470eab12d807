"""A crane that starts with a speed: the damping of one element at t = 0, which grows with the mesh, counts nowhere.

Reference: a load on a spring with its damper, of which the upper end begins to move with A sin w t. The rope weighs
0.3 % of the load.
"""

from __future__ import annotations

import numpy as np
import pytest

import tautline

MASS, ROPE, LENGTH, STIFFNESS, DAMPING, GRAVITY = 20e3, 2.2, 26.0, 40e6, 10e-3, 9.81
AMPLITUDE, PERIOD, BREAKING = 0.9, 9.0, 0.6e6
END, INTERVAL, MESHES = 2.0, 0.05, (4, 24)
SCENE = """
title: A crate below a tip that heaves from the start on
rope: {{mass_per_length: 2.2 kg/m, axial_stiffness: 40 MN, damping: 10 ms, breaking_load: 0.6 MN, strain: {strain}}}
bodies: [{{name: crate, mass: 20 t, position: [0, 0, -20]}}]
path: [{{anchor: {{name: tip, position: [0, 0, 6]}}}}, {{end: {{name: hook, body: crate}}}}]
mesh: {{elements_per_span: {elements}}}
vessel: {{reference: [0, 0, 0], motion: {{heave: {{harmonic: {{amplitude: {amplitude} m, period: 9 s}}}}}}}}
solver: {{step: 10 ms, end: 2 s}}
output: {output}
limits: [{{output: max_tension, above: 400 kN}}, {{output: min_tension, below: 50 kN}}]
"""
FRAMES = "{interval: 50 ms}"
STATISTICS = "{interval: 50 ms, keep: statistics, windows: 0.2 s}"


def scene(elements, amplitude=AMPLITUDE, output=FRAMES, strain="engineering"):
    return tautline.read(SCENE.format(elements=elements, amplitude=amplitude, output=output, strain=strain))


def of_a_spring(amplitude):
    """Tension at the tip at the frames, N: at rest, and then that of m u'' + c k u' + k u = m y''."""
    time, k, w = np.arange(0.0, END + 1e-9, INTERVAL), STIFFNESS / LENGTH, 2.0 * np.pi / PERIOD
    driven = (
        -MASS * w**2 * amplitude / (k - MASS * w**2 + 1j * w * DAMPING * k)
    )  # of exp(i w t), of which the sine counts
    damped = -DAMPING * k / (2.0 * MASS)
    free = np.sqrt(k / MASS - damped**2)
    u0, v0 = -driven.imag, amplitude * w - (1j * w * driven).imag
    left, root = u0 - 1j * (v0 - damped * u0) / free, damped + 1j * free
    u = (driven * np.exp(1j * w * time)).imag + (left * np.exp(root * time)).real
    rate = (1j * w * driven * np.exp(1j * w * time)).imag + (root * left * np.exp(root * time)).real
    moved = k * (u + DAMPING * rate)
    return (MASS + ROPE * LENGTH) * GRAVITY + np.where(time > 0.0, moved, 0.0)


def value(result, name):
    return result.headline[name]["value"]


@pytest.mark.parametrize("output", [FRAMES, STATISTICS], ids=["frames", "statistics"])
@pytest.mark.parametrize("amplitude", [AMPLITUDE, -AMPLITUDE])
@pytest.mark.parametrize("elements", MESHES)
def test_largest_and_smallest_tension_after_a_sudden_start_are_those_of_a_spring_in_any_mesh(
    elements, amplitude, output
):
    result, exact = tautline.simulate(scene(elements, amplitude, output)), of_a_spring(amplitude)
    assert value(result, "max_tension") == pytest.approx(exact.max(), rel=1e-2)
    assert value(result, "min_tension") == pytest.approx(exact.min(), rel=3e-2)
    assert value(result, "dynamic_amplification") == pytest.approx(exact.max() / exact[0], rel=1e-2)
    records = {record.get("output") or record["name"]: record for record in result.limits}
    assert records["max_tension"]["value"] == pytest.approx(exact.max(), rel=1e-2)
    assert records["min_tension"]["value"] == pytest.approx(exact.min(), rel=3e-2)
    assert records["breaking_load"]["value"] == pytest.approx(exact.max(), rel=1e-2)
    if output == FRAMES:
        assert value(result, "safety_factor") == pytest.approx(BREAKING / exact.max(), rel=1e-2)
        assert value(result, "slack_events") == 0


@pytest.mark.parametrize("strain", ["engineering", "green"])
def test_the_first_frame_carries_what_hangs_below_each_place(strain):
    # three nodes: the weight of the rope below each, and half an element more or less in the middle of elements
    sim = tautline.Simulation(scene(2, strain=strain))
    tension = np.ravel(sim["tension"])
    assert tension == pytest.approx([(MASS + ROPE * LENGTH) * GRAVITY, MASS * GRAVITY], rel=1e-4)
    sim.advance_to(0.05)
    first = sim.result["axial_force"][0]
    assert first == pytest.approx((MASS + ROPE * LENGTH * np.array([0.75, 0.25])) * GRAVITY, rel=1e-4)


def test_a_sweep_over_meshes_has_one_largest_tension():
    data = tautline.sweep(scene(4), {"mesh.elements_per_span": list(MESHES)}, collect=["max_tension"], jobs=1)
    assert data["max_tension"].values == pytest.approx(of_a_spring(AMPLITUDE).max(), rel=1e-2)


def test_a_drum_that_begins_to_hoist_tells_the_tension_at_rest_in_its_first_frame():
    hoist = """
title: A drum above the crate hoists from the start on
rope: {mass_per_length: 2.2 kg/m, axial_stiffness: 40 MN, damping: 10 ms}
bodies: [{name: crate, mass: 20 t, position: [0.5, 0, -20]}]
path:
  - drum: {name: winch, center: [0, 0, 6], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: {constant: -0.5}}
  - end: {name: hook, body: crate}
mesh: {elements_per_span: 4}
solver: {step: 10 ms, end: 50 ms}
output: {interval: 50 ms}
"""
    result = tautline.simulate(tautline.read(hoist))
    # The momentum of the rope that runs, 2.2 kg/m (0.5 m/s)^2, is in it.
    assert result["drum_tension"][0, 0] == pytest.approx((MASS + ROPE * LENGTH) * GRAVITY, rel=1e-4)


def test_a_copy_tells_the_tensions_at_rest_of_a_sudden_start_now_and_in_its_result():
    sim = tautline.Simulation(scene(24))
    copy = sim.copy()
    assert np.ravel(copy["tension"])[0] == pytest.approx((MASS + ROPE * LENGTH) * GRAVITY, rel=1e-4)
    copy.advance_to(0.05)
    assert np.ravel(copy.result["tension"][0])[0] == pytest.approx((MASS + ROPE * LENGTH) * GRAVITY, rel=1e-4)


def test_a_state_of_another_start_tells_what_hung_in_that_one():
    """A heavy rope that a force pulls aside: at the tip it carries that force, and all weight below."""
    heavy, aside = 300.0, 400e3
    text = SCENE.format(elements=24, amplitude=0.0, output=FRAMES, strain="engineering")
    made = tautline.read(text).replace({"rope.mass_per_length": heavy})
    pulled = tautline.Simulation(made, ["crate.force"], initial={"crate.force": [aside, 0.0, 0.0]})
    other = tautline.Simulation(made, ["crate.force"])
    other.restore(pulled.save())
    at_tip, at_hook = np.ravel(other["tension"])
    length = np.ptp(other["material_coordinate"])
    assert at_hook == pytest.approx(np.hypot(aside, MASS * GRAVITY), rel=2e-4)
    assert at_tip == pytest.approx(np.hypot(aside, (MASS + heavy * length) * GRAVITY), rel=2e-4)
    assert other["tension"].tolist() == pulled["tension"].tolist()
