"""Bits on rock that is very hard or soft, torques that hold for ever or not at all: right, or stopped by name."""

import numpy as np
import pytest
from physics.wells.strings import run, straight_hole

from drillstring.model.build import build
from tautline.integrators.status import StoppedEarly
from tautline.simulation import simulate

LENGTH, WEIGHT = 400.0, 5e4
TORQUE = {"static": 8e3, "kinetic": 5e3}


def scene(bit, rotation=None, end=6.0, step=2e-3, **changes):
    """A collar on the bottom whose drive comes to 8 rad/s in a second."""
    rotation = {"ramp": {"to": 8.0, "over": 1.0}} if rotation is None else rotation
    keys = {
        "length": LENGTH, "elements": 4, "well__wall": "none", "top__rotation": rotation, "solver__end": end,
        "solver__step": step, "output__interval": 0.02, "bit": {"on_bottom": True, "weight": WEIGHT} | bit,
        "damping": {"structural": 1e-3},
    }  # fmt: skip
    return straight_hole(0.0, **(keys | changes))


@pytest.mark.parametrize("stiffness", [1e4, 1e9, 1e12])
def test_soft_and_hard_rock_bears_the_weight(stiffness):
    result = run(scene({"rock": {"stiffness": stiffness}, "torque": TORQUE}))
    assert result["weight_on_bit"] == pytest.approx(WEIGHT, rel=1e-3)
    assert result["bit_depth"] - result["hole_depth"] == pytest.approx(WEIGHT / stiffness, rel=1e-2, abs=1e-9)
    assert result["rotation_rate"][:, -1].max() > 8.0


def test_a_drive_weaker_than_the_bit_stalls_at_its_limit_and_does_not_wind_up():
    controller = {"speed": {"ramp": {"to": 8.0, "over": 1.0}}, "proportional": 2000.0, "integral": 1000.0}
    controller |= {"inertia": 2000.0, "torque_limit": 6e3}
    result = run(scene({"torque": {"static": 1e5, "kinetic": 5e3}}, {"controller": controller}, end=20.0))
    assert np.abs(result["rotation_rate"][:, -1]).max() < 1e-6, "the bit never turns"
    assert "stick_slip_severity" not in result.headline
    # The drive swings on the string about the torque that it can give.
    assert np.abs(result["drive_torque"]).max() == pytest.approx(6e3)
    assert result["torque_on_bit"][result.time > 10.0].mean() == pytest.approx(6e3, rel=0.1)
    assert np.abs(result["drive_speed"]).max() < 8.0


@pytest.mark.parametrize("torque", [{"static": 0.0, "kinetic": 0.0}, {"static": 1e-6, "kinetic": 0.0}])
def test_next_to_no_torque_does_not_hold_a_bit(torque):
    result = run(scene({"torque": torque}, end=3.0))
    assert result["rotation_rate"][-1, -1] > 4.0
    assert np.abs(result["torque_on_bit"]).max() <= 1e-6


@pytest.mark.parametrize("decay", [1e-4, 1e4])
def test_torque_that_falls_at_once_or_hardly_ever(decay):
    result = run(scene({"torque": TORQUE | {"decay": decay}}))
    torque, spin = result["torque_on_bit"], result["rotation_rate"][:, -1]
    turns = spin > 1.0
    expected = 5e3 + 3e3 * np.exp(-np.abs(spin[turns]) / decay)
    assert torque[turns] == pytest.approx(expected, rel=1e-6)
    assert torque.max() <= 8e3 * (1.0 + 1e-6)


def test_a_string_that_turns_backwards_sticks_and_slips_as_in_a_mirror():
    one = run(scene({"torque": TORQUE}))
    other = run(scene({"torque": TORQUE}, {"ramp": {"to": -8.0, "over": 1.0}}))
    assert np.array_equal(one["rotation"], -other["rotation"])
    assert np.array_equal(one["torque_on_bit"], -other["torque_on_bit"])


def test_a_bit_turned_backwards_does_not_drill():
    bit = {"torque": TORQUE, "penetration": {"rate": "20 m/h", "speed": "120 rpm"}}
    result = run(scene(bit, {"ramp": {"to": -8.0, "over": 1.0}}))
    slipping_back = result["rotation_rate"][:, -1] < 0.0
    assert np.all(result["rate_of_penetration"][slipping_back] == 0.0)


@pytest.mark.parametrize("step", [0.02, 0.1])
def test_steps_too_long_for_stick_slip_give_a_bounded_torque_or_a_name(step):
    try:
        result = simulate(build(scene({"torque": TORQUE}, step=step, output__interval=0.1)))
    except StoppedEarly as stop:
        assert stop.sentence
        return
    assert np.abs(result["torque_on_bit"]).max() <= 8e3 * (1.0 + 1e-6)
    assert np.isfinite(result["rotation"]).all()


def test_one_element_drills_and_two_hundred_do():
    rates = []
    for elements in (1, 200):
        bit = {"penetration": {"rate": "20 m/h", "speed": "120 rpm"}, "torque": {"static": 300.0, "kinetic": 200.0}}
        result = run(scene(bit, 12.566370614359172, end=0.6, elements=elements, top__block={"velocity": "20 m/h"}))
        rates.append(result["rate_of_penetration"][-1])
    assert rates == pytest.approx([20.0 / 3600.0] * 2, rel=5e-3)


@pytest.mark.parametrize("blades", [1, 20])
def test_one_blade_and_twenty_drill_into_hard_rock(blades):
    cutting = {"specific_energy": "2 GPa", "contact_strength": "1 GPa", "wear_flat": "0.2 mm", "blades": blades}
    result = simulate(build(scene({"cutting": cutting}, 10.0, end=0.4)))
    assert np.isfinite(result["weight_on_bit"]).all() and result["weight_on_bit"].min() >= 0.0
    assert np.all(np.diff(result["hole_depth"]) >= 0.0)
