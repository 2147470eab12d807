"""Stick-slip of a bit on bottom against closed forms, and drives of given impedance against what they send back.

One element is one torsional lump: the bit has half of its inertia J and hangs on its stiffness k. It is wound up at a
steady speed, lets go at the static torque, and is caught when it comes to rest (J. P. den Hartog, Mechanical
Vibrations, chapter 7; the formulas stand at the tests).
"""

import dataclasses
from math import atan, exp, hypot, pi, sqrt

import numpy as np
import pytest
from physics.wells.strings import COLLAR, DENSITY, G, run, straight_hole
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from drillstring.drilling.impedance import pipe_impedance, torsional_frequency
from drillstring.model.build import build
from drillstring.results.drilling import stick_slip
from tautline.simulation import simulate

LENGTH = 1000.0
POLAR = pi / 32.0 * (COLLAR[0] ** 4 - COLLAR[1] ** 4)
STIFFNESS, INERTIA = G * POLAR / LENGTH, DENSITY * POLAR * LENGTH / 2.0
OMEGA = sqrt(STIFFNESS / INERTIA)
STATIC, KINETIC = 8.0e3, 5.0e3
STEP = 1e-3


def lump(speed, end=20.0, damping=0.0, step=STEP, **changes):
    """One lump under a drive that comes to its speed in a fifth of a second; the bit rests until it is wound up.

    ``damping`` N m s/rad is that of the lump: a scene gives that of one of 12 lumps.
    """
    bit = {"on_bottom": True, "weight": 1e5, "torque": {"static": STATIC, "kinetic": KINETIC}}
    whole = {
        "length": LENGTH, "well__wall": "none", "bit": bit, "damping": {"rotation": damping / 6.0},
        "top__rotation": {"ramp": {"to": speed, "over": 0.2}}, "solver__end": end, "solver__step": step,
        "output__interval": step,
    }  # fmt: skip
    return straight_hole(0.0, **(whole | changes))


def releases(result):
    """Times at which the bit lets go, s."""
    stuck = np.abs(result["rotation_rate"][:, -1]) < 1e-6
    return result.time[1:][stuck[:-1] & ~stuck[1:]]


@pytest.mark.parametrize("speed", [1.0, 2.0, 4.0])
def test_period_and_peak_speed_of_a_lump_are_those_of_the_closed_form(speed):
    """Stuck for 2 (T_s - T_k) / (k Omega), slipping for (2 pi - 2 atan(w A / Omega)) / w with A = (T_s - T_k) / k."""
    result = run(lump(speed))
    throw = (STATIC - KINETIC) / STIFFNESS
    period = 2.0 * throw / speed + (2.0 * pi - 2.0 * atan(OMEGA * throw / speed)) / OMEGA
    found = np.diff(releases(result))
    assert found.size >= 3
    assert found == pytest.approx(period, rel=2e-3)
    assert result["rotation_rate"][:, -1].max() == pytest.approx(speed + hypot(speed, OMEGA * throw), rel=2e-3)
    assert result.headline["stick_slip_severity"]["value"] == pytest.approx(
        (speed + hypot(speed, OMEGA * throw)) / (2.0 * speed), rel=0.1
    )


def test_a_stuck_bit_does_not_creep_and_bears_what_the_string_brings():
    result = run(lump(2.0, end=4.0))
    stuck = np.abs(result["rotation_rate"][:, -1]) < 1e-6
    settled = stuck & np.roll(stuck, 60)  # what is left of the shock of sticking fades within 60 steps
    assert settled.sum() > 300
    assert np.abs(result["rotation_rate"][settled, -1]).max() < 2e-8
    assert result["torque_on_bit"][settled] == pytest.approx(result["torque"][settled, -1], abs=1e-3 * STATIC)
    assert result["torque_on_bit"].max() <= STATIC * (1.0 + 1e-9)


def _margin(speed, damping):
    """By how much a lump that has let go comes to rest, rad/s.

    y = twist less that of steady turning, J y'' + c y' + k y = 0, y(0) = (T_s - T_k - c Omega) / k, y'(0) = Omega, and
    the bit rests where y' is Omega again. The least speed over the first turn is what counts: later ones are larger.
    """
    decay = damping / (2.0 * INERTIA)
    w = sqrt(STIFFNESS / INERTIA - decay**2)
    y = (STATIC - KINETIC - damping * speed) / STIFFNESS
    # y' = exp(-decay t) (a cos w t + b sin w t)
    a, b = speed, -(decay * speed + STIFFNESS / INERTIA * y) / w

    t = np.linspace(0.2 / w, 2.0 * pi / w, 20001)
    return float(np.max(np.exp(-decay * t) * (a * np.cos(w * t) + b * np.sin(w * t)))) - speed


@pytest.mark.parametrize("damping", [60.0, 250.0])
def test_sticking_ends_above_the_speed_of_the_closed_form(damping):
    """Within 1 %: 1 % below it a damped lump sticks again and again, 1 % above it never after it has let go once."""
    speed = brentq(lambda omega: _margin(omega, damping), 0.05, 60.0, rtol=1e-6)
    below, above = (run(lump(share * speed, end=10.0, damping=damping, step=5e-4)) for share in (0.99, 1.01))
    assert releases(below).size >= 3
    assert releases(above).size == 1
    after = above.time > releases(above)[0] + 0.05
    assert 0.0 < above["rotation_rate"][after, -1].min() < 0.05 * speed


def test_torque_that_falls_with_speed_gives_the_cycle_of_an_independent_integration():
    """T_k + (T_s - T_k) exp(-speed / decay): DOP853 from the release to rest, and the time to be wound up again."""
    speed, decay = 1.5, 2.0
    bit = {"on_bottom": True, "weight": 1e5}
    bit["torque"] = {"static": STATIC, "kinetic": KINETIC, "decay": decay}
    result = run(lump(speed, bit=bit))

    def slide(t, y):
        twist, spin = y
        torque = KINETIC + (STATIC - KINETIC) * exp(-abs(spin) / decay)
        return [speed - spin, (STIFFNESS * twist - torque) / INERTIA]

    def rests(t, y):
        return y[1]

    rests.terminal, rests.direction = True, -1.0
    begin = [STATIC / STIFFNESS, 1e-9]
    # It leaves a state of balance: the first push is the drive's, in a millisecond.
    begin[0] += speed * 1e-6
    slip = solve_ivp(slide, (0.0, 20.0), begin, "DOP853", events=rests, rtol=1e-10, atol=1e-12, dense_output=True)
    time = slip.t_events[0][-1]
    period = time + (STATIC / STIFFNESS - slip.y_events[0][-1][0]) / speed
    assert np.diff(releases(result)) == pytest.approx(period, rel=5e-3)
    peak = slip.sol(np.linspace(0.0, time, 5001))[1].max()
    assert result["rotation_rate"][:, -1].max() == pytest.approx(peak, rel=3e-3)


def test_a_bit_turned_back_by_its_string_is_resisted_the_other_way():
    """The drive turns one way and then the other: the torque on the bit has both bounds, and energy balances."""
    turn = {"table": {"time": [0.0, 3.0, 3.5, 8.0], "value": [3.0, 3.0, -3.0, -3.0]}}
    result = run(lump(3.0, end=8.0, top__rotation=turn))
    torque = result["torque_on_bit"]
    assert torque.max() <= STATIC * (1.0 + 1e-9)
    assert torque.min() < -KINETIC * (1.0 - 1e-9) and torque.min() >= -STATIC * (1.0 + 1e-9)


FIGURES = ("bit_rotation_mean", "torque_on_bit_mean", "surface_torque_end")
"""Of a string that turns the other way these have the other sign; severity and share of time stuck are the same."""


def test_a_string_that_turns_the_other_way_has_the_mirrored_figures_of_stick_slip():
    right, left = (run(lump(speed)).headline for speed in (2.0, -2.0))
    assert set(left) == set(right) and right["stick_slip_severity"]["value"] > 1.0
    for name in FIGURES:
        assert left[name]["value"] == pytest.approx(-right[name]["value"], rel=1e-6)
    for name in ("stick_slip_severity", "rotation_stuck"):
        assert left[name]["value"] == pytest.approx(right[name]["value"], rel=1e-6)


def test_a_bit_that_rocks_has_no_severity_and_its_summary_says_why():
    times, turns = 2.0 * np.arange(12.0), 6.0 * (-1.0) ** np.arange(12)
    there_and_back = {"table": {"time": times.tolist(), "value": turns.tolist()}}
    result = run(lump(6.0, end=20.0, top__rotation=there_and_back))
    spin = result["rotation_rate"][:, -1]
    assert spin.max() > 5.0 and spin.min() < -5.0
    assert "stick_slip_severity" not in result.headline
    assert "severity has no meaning" in result.headline["bit_rotation_mean"]["text"]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_severity_is_half_the_swing_over_the_size_of_the_mean_down_to_a_mean_of_a_twentieth(sign):
    time = np.arange(2001) * 0.01
    for mean, expected in ((2.0, 1.5), (0.2, 15.0), (0.1, np.nan), (0.0, np.nan)):
        found = stick_slip(time, sign * (mean + 3.0 * np.sin(2.0 * pi * time)))
        assert found["severity"] == pytest.approx(expected, rel=1e-2, nan_ok=True)


def test_the_bit_is_stuck_for_the_share_of_time_that_it_does_not_turn_in():
    # At rest for a quarter of each second, then 4/3 (1 - cos): a hundredth of the mean is no rest, 1e-6 of it is.
    phase = np.mod(np.arange(100_000) * 1e-4, 1.0)
    turning = np.where(phase < 0.25, 1e-6, 4.0 / 3.0 * (1.0 - np.cos(2.0 * pi * (phase - 0.25) / 0.75)))
    assert stick_slip(np.arange(100_000) * 1e-4, turning)["stuck"] == pytest.approx(0.25, abs=5e-3)
    # That of an explicit run creeps by the speed at which its torque is in full.
    crept = np.where(phase < 0.25, 0.05, 1.0)
    stuck = [stick_slip(np.arange(100_000) * 1e-4, crept, creep)["stuck"] for creep in (0.0, 0.1)]
    assert stuck == pytest.approx([0.0, 0.25], abs=1e-3)


def test_rk4_takes_the_regularised_torque_says_so_and_has_nearly_the_same_cycle():
    scene = lump(2.0, end=8.0, solver__method="rk4")
    model = build(scene)
    assert any("rk4" in note and "slip_speed" in note for note in model.notes)
    exact, crept = run(lump(2.0, end=8.0)), simulate(model)
    peaks = [one["rotation_rate"][:, -1].max() for one in (exact, crept)]
    assert peaks[1] == pytest.approx(peaks[0], rel=4e-2)


# -- the drive -------------------------------------------------------------------------------------------------------


def test_the_first_torsional_frequency_of_uniform_and_stepped_strings_is_exact():
    """c / 4 L, and of two parts tan(w t1) tan(w t2) = zeta1 / zeta2."""
    scene = straight_hole(0.0, length=700.0)
    (one,) = build(scene).observe.__self__.lumps.tubes
    speed = sqrt(G / DENSITY)
    assert torsional_frequency([one]) == pytest.approx(speed / (4.0 * 700.0), rel=1e-12)
    pipe = dataclasses.replace(one, od=0.127, id=0.1086, length=2800.0)
    f = torsional_frequency([pipe, one])
    w1, w2 = (2.0 * pi * f * part.length / speed for part in (pipe, one))
    assert np.tan(w1) * np.tan(w2) == pytest.approx(pipe_impedance(pipe) / pipe_impedance(one), rel=1e-9)
    assert f < speed / (4.0 * 3500.0)


PULSE, WIDTH, CELLS = 0.3, 60.0, 250
"""Of a pulse that travels up a pipe: largest rotation rad, half width m; links of the pipe."""


def sent_back(drive, length=1000.0):
    """Largest rotary speed of the wave that comes back from a drive, over that of the pulse that went up, with sign."""
    scene = straight_hole(
        0.0, length=length, elements=CELLS, well__wall="none", start="straight", gravity=0.0,
        top__rotation={"controller": {"speed": 0.0, "inertia": 0.01} | drive},
        solver__end=0.75 * length / sqrt(G / DENSITY), solver__step=2e-4, output__interval=1e-3,
    )  # fmt: skip
    model = build(scene)
    speed = sqrt(G / DENSITY)
    x = np.linspace(0.0, length, CELLS + 1) - 0.35 * length
    shape = PULSE * np.exp(-((x / WIDTH) ** 2))
    model.system.q[3::4] = shape
    model.system.v[3::4] = -2.0 * x / WIDTH**2 * shape * speed
    result = simulate(model)
    up, back = result["rotation_rate"][0], result["rotation_rate"][-1]
    # What is at x now met the drive when what was at c t - x did: a wave that came back is the pulse reversed.
    place = np.linspace(0.0, length, CELLS + 1)
    met = np.interp(speed * result.time[-1] - place, place, back)
    return float((met @ up) / (up @ up)), float(np.abs(back).max() / np.abs(up).max())


@pytest.mark.parametrize("ratio", [0.25, 1.0, 3.0])
def test_a_drive_sends_back_what_its_impedance_tells(ratio):
    """(zeta - Z) / (zeta + Z) of the speed's wave, (Z - zeta) / (Z + zeta) of the torque's: none where they match."""
    zeta = POLAR * sqrt(DENSITY * G)
    share, size = sent_back({"proportional": ratio * zeta})
    assert size == pytest.approx(abs(1.0 - ratio) / (1.0 + ratio), abs=1e-2)
    assert share == pytest.approx((1.0 - ratio) / (1.0 + ratio), abs=1e-2)


def test_soft_torque_is_tuned_to_the_pipe_and_to_the_first_frequency_and_says_so():
    scene = straight_hole(
        0.0, length=700.0, elements=10, well__wall="none",
        top__rotation={"controller": {"kind": "soft_torque", "speed": 5.0, "inertia": 1500.0}},
    )  # fmt: skip
    model = build(scene)
    (drive,) = (g for g in model.system.groups if type(g).__name__ == "TopDrive")
    zeta, first = POLAR * sqrt(DENSITY * G), sqrt(G / DENSITY) / (4.0 * 700.0)
    assert drive.proportional == pytest.approx(zeta, rel=1e-12)
    assert drive.integral == pytest.approx((2.0 * pi * first) ** 2 * 1500.0, rel=1e-9)
    (note,) = [note for note in model.notes if "soft torque" in note]
    assert f"{zeta:.4g} N m s/rad" in note and f"{first:.4g} Hz" in note


def test_a_stiff_drive_is_the_prescribed_speed():
    ramp = {"ramp": {"to": 2.0, "over": 0.2}}
    one = run(lump(2.0, end=2.0))
    other = run(lump(2.0, end=2.0, top__rotation={"controller": {"kind": "stiff", "speed": ramp}}))
    assert np.array_equal(one["rotation"], other["rotation"])


def test_a_drive_at_its_limit_does_not_wind_up():
    """A string that must be turned faster than its drive can: once it has the speed it keeps it, and does not overrun
    by what an integral would have gathered.
    """
    limit, inertia, wanted = 4000.0, 2000.0, 8.0
    controller = {"speed": wanted, "proportional": 3000.0, "integral": 3000.0, "inertia": inertia}
    controller["torque_limit"] = limit
    scene = straight_hole(
        0.0, length=100.0, elements=4, well__wall="none", solver__end=25.0, solver__step=5e-3, output__interval=0.05,
        top__rotation={"controller": controller | {"speed": {"ramp": {"to": wanted, "over": 0.1}}}},
    )  # fmt: skip
    result = run(scene)
    drive, torque = result["drive_speed"], result["drive_torque"]
    whole = inertia + DENSITY * POLAR * 100.0
    assert np.abs(torque).max() == pytest.approx(limit, rel=1e-12)
    # While at the limit it speeds up by limit / inertia; a PI loop of damping ratio near one overruns by little.
    assert drive[40] == pytest.approx(limit / whole * result.time[40], rel=0.05)
    assert drive.max() < 1.25 * wanted
    assert drive[-1] == pytest.approx(wanted, rel=1e-3)
