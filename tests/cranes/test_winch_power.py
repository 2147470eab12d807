"""Power and energy of a winch against integrals done by hand, and what a drum does that nothing drives."""

import numpy as np
import pytest
from physics.lifting.crane_scenes import hoist, ran

from crane.results.power import winch_energy, winch_power


def test_power_is_tension_times_speed_and_negative_when_lowering():
    assert winch_power([5e4, 5e4], [2.0, -2.0]).tolist() == [1e5, -1e5]


def test_a_steady_hoist_gives_the_work_of_the_lift():
    energy = winch_energy(np.linspace(0.0, 10.0, 11), np.full(11, 5e4), np.full(11, 2.0))
    assert energy.hoisted == energy.net == pytest.approx(5e4 * 20.0)
    assert energy.peak == energy.mean == energy.hoisting_mean == pytest.approx(1e5)
    assert energy.regenerated == energy.regenerated_peak == 0.0


def test_up_and_down_cancels_in_the_net_alone():
    # Speed 2 (1 - t) m/s for 2 s: up 1 m, down 1 m; the turn falls between frames.
    time = np.array([0.0, 0.7, 1.6, 2.0])
    energy = winch_energy(time, np.full(4, 3e4), 2.0 * (1.0 - time))
    assert energy.hoisted == pytest.approx(3e4) and energy.regenerated == pytest.approx(3e4)
    assert energy.net == pytest.approx(0.0, abs=1e-9) and energy.mean == pytest.approx(0.0, abs=1e-9)
    assert energy.hoisting_time == pytest.approx(1.0) and energy.hoisting_mean == pytest.approx(3e4)
    assert (energy.peak, energy.peak_time) == (pytest.approx(6e4), 0.0)
    assert (energy.regenerated_peak, energy.regenerated_peak_time) == (pytest.approx(6e4), 2.0)


def test_tension_and_speed_that_both_vary_are_integrated_exactly():
    # T = 1000 (1 + t), v = 2 - t over 0..4, by hand 1000 int (2 + t - t^2).
    energy = winch_energy([0.0, 4.0], [1000.0, 5000.0], [2.0, -2.0])
    assert energy.hoisted == pytest.approx(1000.0 * (4.0 + 2.0 - 8.0 / 3.0))
    assert energy.net == pytest.approx(1000.0 * (8.0 + 8.0 - 64.0 / 3.0))


def test_a_winch_at_rest_and_a_single_frame_have_no_energy():
    for count in (1, 4):
        energy = winch_energy(np.arange(float(count)), np.full(count, 5e4), np.zeros(count))
        assert all(np.isfinite(energy)) and energy.net == energy.hoisted == energy.mean == energy.peak == 0.0
    assert winch_energy([0.0], [5.0], [2.0]).peak == 10.0


def test_a_load_let_go_between_two_frames_of_one_time_does_no_work():
    energy = winch_energy([0.0, 1.0, 1.0, 2.0], [8e3, 8e3, -1e3, -1e3], [1.0, 1.0, -1.0, -1.0])
    assert energy.hoisted == pytest.approx(8e3 + 1e3) and energy.regenerated == pytest.approx(0.0)


def test_a_winch_that_only_lowers_has_no_peak_of_its_own():
    energy = winch_energy([0.0, 1.0], [1e4, 1e4], [-1.0, -2.0])
    assert energy.peak == 0.0 and energy.hoisting_mean == 0.0
    assert energy.regenerated == pytest.approx(1.5e4) and energy.regenerated_peak == pytest.approx(2e4)


def test_what_is_not_finite_is_refused():
    with pytest.raises(ValueError, match="speed: frame 1"):
        winch_energy([0.0, 1.0], [1.0, 1.0], [1.0, np.nan])


@pytest.mark.parametrize("height", [0.0, 100.0, -1000.0])
def test_a_drum_that_is_let_go_turns_as_the_load_and_its_heavy_rope_pull_wherever_the_scene_stands(height):
    """(I / R^2 + m + rhoA L) a = m g + rhoA g (drum's height - load's), of an inextensible rope, as it begins.

    A twentieth of a second of free vibration is left out by fitting a parabola to a second of speed.
    """
    inertia, radius, mass, rope = 8000.0, 0.5, 1000.0, 30.0
    scene = hoist(
        mass, elements=8, drive={"center": (0.0, 0.0, 20.0 + height), "torque": {"constant": 0.0}, "inertia": inertia},
        tip={}, rope={"mass_per_length": rope, "damping": 5e-3}, solver={"end": 1.0},
    )  # fmt: skip
    scene["path"][1]["sheave"]["center"] = (12.0, 0.0, 30.0 + height)
    scene["bodies"][0]["position"] = (12.4, 0.0, 5.0 + height)
    result = ran(scene)
    length = float(np.hypot(12.0, 10.0)) + 25.0
    pull = mass * 9.81 + rope * 9.81 * 15.0
    expected = pull / (inertia / radius**2 + mass + rope * length)
    speed = result["pay_out_speed"][:, 0]
    found = np.polyfit(result.time, speed, 2)
    assert found[1] == pytest.approx(expected, rel=0.02)
