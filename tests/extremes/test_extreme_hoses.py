"""Hoses at the edge of what makes sense, each with what must not change: similar, turned, moved, mirrored, or refused.

The hose of Table 2.2 in units of mass and time that are a million apart, and of length from a decimetre to a kilometre,
has the same shape at rest and flutters at the same speed: a wrong power of a length anywhere fails.
"""

import numpy as np
import pytest
from of_the_suite import studies
from physics.pipes.hoses import SECTION, UNIFORM, WATER, energy_missing, flowing, pipe, run, scene, tip_of

from gardenhose.flutter import crossings
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.errors import SceneError

GRAVITY = 9.81
UNITS = [
    (1e3, 1.0, 1.0), (0.1, 1.0, 1.0), (1.0, 1e6, 1.0), (1.0, 1e-6, 1.0), (1.0, 1.0, 1e3), (1.0, 1.0, 1e-3),
    (1e2, 1e4, 1e-2), (0.3048, 0.45359237, 1.0), (1e3, 1e9, 60.0),
]  # fmt: skip
"""Units of length, mass and time, in m, kg and s."""


def similar(units, **hose):
    """Table 2.2's hose, its numbers of SI taken for numbers of other units."""
    length, mass, time = units
    force = mass * length / time**2
    made = {
        "length": 0.5 * length, "elements": 10, "axial_stiffness": SECTION["axial_stiffness"] * force,
        "bending_stiffness": SECTION["bending_stiffness"] * force * length**2,
        "mass_per_length": SECTION["mass_per_length"] * mass / length, "damping": SECTION["damping"] * time,
    }  # fmt: skip
    water = {"mass_per_length": WATER * mass / length}
    step = {"step": 1e-3 * time, "end": time}
    down = [0.0, 0.0, -GRAVITY * length / time**2]
    return scene(made | hose, water, step, 5e-3 * time, gravity=down)


@pytest.mark.parametrize("speed", [0.0, 6.0])
@pytest.mark.parametrize("units", UNITS)
def test_a_hose_of_other_units_rests_in_the_same_shape(units, speed):
    length, _, time = units
    usual = tip_of(similar((1.0, 1.0, 1.0)), speed)
    assert tip_of(similar(units), speed * length / time) / length == pytest.approx(usual, abs=1e-8)


@pytest.mark.parametrize(
    "units", [(1e-2, 1e-6, 1.0), (1e2, 1e4, 1e-2), *studies(((1e2, 1.0, 1.0),), ((1.0, 1.0, 1e-2),))]
)
def test_a_pipe_of_other_units_flutters_at_the_same_speed(units):
    """U = u sqrt(EJ / M) / L."""
    length, mass, time = units
    force = mass * length / time**2
    hose = {
        "length": length, "axial_stiffness": 1e7 * force, "bending_stiffness": force * length**2,
        "mass_per_length": 0.8 * mass / length,
    }  # fmt: skip
    speeds = np.linspace(8.0, 16.0, 9)
    usual = crossings(pipe(0.2, 6), speeds)[0]
    made = scene(
        {"elements": 6, "damping": 0.0} | hose, {"mass_per_length": 0.2 * mass / length}, gravity=[0, 0, 0],
        solver={"step": 1e-3 * time, "end": time}, interval=5e-3 * time,
    )  # fmt: skip
    found = crossings(made, speeds * length / time)[0]
    assert found.speed * time / length == pytest.approx(usual.speed, rel=1e-6)
    assert found.frequency * time == pytest.approx(usual.frequency, rel=1e-5)


@pytest.mark.parametrize("angle", [0.3, np.pi / 2, 2.0, np.pi, -1.0, 1e-9])
@pytest.mark.parametrize("speed", [0.0, 6.0])
def test_a_hose_turned_about_the_vertical_rests_in_the_same_shape(angle, speed):
    x, _, z = tip_of(scene(), speed)
    turned = tip_of(scene({"direction": [float(np.cos(angle)), float(np.sin(angle)), 0.0]}), speed)
    assert turned == pytest.approx([x * np.cos(angle), x * np.sin(angle), z], abs=1e-8)


@pytest.mark.parametrize("root", [[0, 0, 1000.0], [-1e4, 3.0, 0.0], [1e-40, 0, 0]])
def test_a_hose_somewhere_else_rests_in_the_same_shape(root):
    assert tip_of(scene({"root": root}), 6.0) - root == pytest.approx(tip_of(scene(), 6.0), abs=1e-8)


@pytest.mark.parametrize("speed", [0.0, 3.0])
@pytest.mark.parametrize("direction", [[1, 0, 0], [0, -2, 0], [0, 0, 1e-3], [1, 1, 1], [-3, 4, 12]])
def test_a_hose_without_gravity_is_straight(direction, speed):
    tip = tip_of(scene({"direction": direction}, gravity=[0, 0, 0]), speed)
    along = np.array(direction) / np.linalg.norm(direction)
    assert tip - (tip @ along) * along == pytest.approx(np.zeros(3), abs=1e-9)
    assert tip @ along == pytest.approx(0.5, abs=1e-12 if speed == 0.0 else 1e-3)


@pytest.mark.parametrize("speed", [0.0, 6.0, 12.0])
def test_gravity_upwards_bends_a_hose_up_as_far_as_it_bends_it_down(speed):
    down, up = (tip_of(scene(gravity=[0, 0, g]), speed) for g in (-GRAVITY, GRAVITY))
    assert up == pytest.approx(down * [1, 1, -1], abs=1e-9)


@pytest.mark.parametrize("share", [1e-12, 1e-6, 1e-3])
def test_next_to_no_gravity_bends_a_hose_as_a_beam_whose_sag_goes_with_it(share):
    """Cantilever under its own weight: w L^4 / 8 EJ, with the water's."""
    weight = (SECTION["mass_per_length"] + WATER) * GRAVITY * share
    sag = weight * 0.5**4 / 8.0 / SECTION["bending_stiffness"]
    tip = tip_of(scene(gravity=[0, 0, -GRAVITY * share]), 0.0)
    # the square of what it has bent is left out
    assert tip[2] == pytest.approx(-sag, rel=2e-3 + share)


@pytest.mark.parametrize("elements", [1, 2, 100])
def test_one_element_to_a_hundred_hang_plumb_below_their_root(elements):
    tip = tip_of(scene({"elements": elements, "direction": [0, 0, -1]}), 0.0)
    weight = (SECTION["mass_per_length"] + WATER) * GRAVITY * 0.5
    assert tip == pytest.approx([0.0, 0.0, -0.5 - 0.25 * weight / SECTION["axial_stiffness"]], abs=1e-6)


def test_nothing_moves_without_a_cause():
    result = run(scene(solver={"end": 0.05}, gravity=[0, 0, 0]))
    assert np.abs(result["tip"] - result["tip"][0]).max() < 1e-12


@pytest.mark.parametrize(("step", "count"), [(1e-3, 1), (1e-6, 1), (1e-4, 10)])
def test_a_run_of_one_step_or_of_a_few_falls_freely_at_its_tip(step, count):
    """So early no bending has reached the tip but that of the next node: g t^2 / 2."""
    end = step * count
    result = run(flowing(0.0, step=step, end=end, interval=end))
    assert len(result["time"]) == 2 and energy_missing(result) < 0.03
    fallen = result["tip"][-1, 2]
    assert fallen == pytest.approx(-0.5 * GRAVITY * end**2, rel=0.05)


@pytest.mark.parametrize("gravity", [GRAVITY, -GRAVITY])
def test_a_moving_hose_is_the_mirror_image_of_one_that_falls_the_other_way(gravity):
    down = run(flowing(3.0, end=0.05, gravity=[0, 0, -GRAVITY]))
    other = run(flowing(3.0, end=0.05, gravity=[0, gravity, 0]))
    way = np.sign(gravity)
    assert other["tip"][:, 1] == pytest.approx(-way * down["tip"][:, 2], abs=1e-9)
    assert other["tip"][:, 0] == pytest.approx(down["tip"][:, 0], abs=1e-9)


REFUSED = [
    ({"hose": {"length": 0.0}}, "length"), ({"hose": {"length": -1.0}}, "length"),
    ({"hose": {"elements": 0}}, "elements"),
    ({"hose": {"elements": 10**9}}, "elements"), ({"hose": {"axial_stiffness": 0.0}}, "axial_stiffness"),
    ({"hose": {"bending_stiffness": -1e-9}}, "bending_stiffness"),
    ({"hose": {"mass_per_length": 0.0}}, "mass_per_length"),
    ({"hose": {"direction": [0, 0, 0]}}, "direction"), ({"hose": {"damping": -1.0}}, "damping"),
    ({"water": {"mass_per_length": -1.0}}, "mass_per_length"), ({"water": {"outlet": 0.0}}, "outlet"),
    ({"solver": {"end": 0.0}}, "end"), ({"solver": {"step": 0.0}}, "step"), ({"solver": {"step": -1e-3}}, "step"),
    ({"solver": {"step": 2.0}}, "step"), ({"solver": {"rho_inf": 1.5}}, "rho_inf"), ({"interval": 0.0}, "interval"),
    ({"interval": 5.0}, "interval"), ({"hose": {"end": "drooping"}}, "end"),
    ({"hose": {"root": [1e12, 0, 0]}}, "root"), ({"solver": {"end": 1e15}}, "end|steps"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "key"), REFUSED, ids=lambda x: x if isinstance(x, str) else "")
def test_what_no_hose_can_be_is_refused_by_its_key(changes, key):
    with pytest.raises(SceneError, match=key):
        scene(**changes)


@pytest.mark.parametrize("speed", [200.0, -200.0, 1e4])
def test_water_far_beyond_the_critical_speed_stops_by_name_or_stays_finite(speed):
    try:
        result = run(flowing(speed, end=0.02, interval=1e-3))
        assert result.time[-1] == pytest.approx(0.02)
    except StoppedEarly as stop:
        assert stop.status is Status.NOT_CONVERGED and "did not converge" in stop.sentence
        result = stop.result
    assert result is not None and len(result.time) > 1
    assert np.isfinite(result["tip"]).all()
    assert np.linalg.norm(result["tip"], axis=1).max() < 50.0 * UNIFORM["length"]
