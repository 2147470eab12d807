"""Whirl of a collar between two ends, one lump that is free: forward, rubbing, and rolling backward, in closed form.

The lump, steel mass m and moving mass M = m + mud, sits in the middle of two links of length l = L / 2 between ends on
the hole's axis; bending holds it with k = 4 EI / l^3 (the one bend of the discrete rod, EI / l times twice u / l). Its
centre of gravity is e off the axis and turns with the rotary at Omega. With z = u + iv, clockwise looking down:

    M z'' + c z' + D |z'| z' + k z + N (1 + i mu sign(w)) z/|z| = m e Omega^2 exp(i Omega t),  N = k_c (|z| - delta),

w = R Omega + |z| times the whirl rate being the slip of the pipe's surface on the wall. Its circular motions are solved
for here without integrating anything (J. P. Den Hartog, Mechanical Vibrations, 1956, ch. 6; D. W. Childs,
Turbomachinery Rotordynamics, 1993, ch. 1).
"""

from math import pi, sqrt

import numpy as np
import pytest
from of_the_suite import studies
from physics.wells.strings import COLLAR, area, mass_per_length, run, straight_hole
from physics.wells.strings import E as YOUNG
from scipy.optimize import brentq

from drillstring.results.whirl import Whirl, busiest, whirl_of
from tautline import simulate

MUD, HOLE, LENGTH, OFF, ZETA = 1200.0, 0.2032, 10.0, 2e-3, 0.1
LINK, RADIUS, CLEARANCE = LENGTH / 2, COLLAR[0] / 2, (HOLE - COLLAR[0]) / 2
WALL, SOFT = 1e9, 1e8
"""Stiffness of the wall, N/m: hard where a ratio of diameters is asked for, else soft enough to come to rest soon."""
STEEL = mass_per_length() * LINK
MASS = STEEL + MUD * LINK * (area(COLLAR[0], 0.0) + area(COLLAR[1], 0.0))
SPRING = 4 * YOUNG * pi / 64 * (COLLAR[0] ** 4 - COLLAR[1] ** 4) / LINK**3
CRITICAL = sqrt(SPRING / MASS)
DRAG = 0.5 * MUD * COLLAR[0] * LINK
"""Of C_d = 1, N s^2/m^2."""


def damping(zeta):
    return float(2 * zeta * CRITICAL * MASS)


def span(speed, off=OFF, zeta=ZETA, **changes):
    """The lump in a vertical hole, wide enough unless a diameter is given, without gravity; twist is damped away."""
    usual = {
        "diameter": 1.0, "gravity": 0.0, "mud": {"density": MUD, "added_mass": 1.0, "drag": 0.0},
        "well__wall__stiffness": WALL, "well__wall__damping": 1e5, "string__0__eccentricity": [off, 0.0],
        "damping": {"translation": damping(zeta), "structural": 1e-3},
        "bit": {"lateral": "pinned"}, "top__rotation": float(speed),
        "model__bending": "stiff", "solver__step": 1e-3, "solver__end": 9.0, "solver__rho_inf": 1.0,
        "output__interval": 5e-3,
    }  # fmt: skip
    return straight_hole(length=LENGTH, elements=2, **{"inclination": 0.0} | usual | changes)


def way(result):
    """Complex offset of the middle lump, its angle that does not jump, and that of the pipe."""
    z = result["lateral_displacement"][:, 1, 0] + 1j * result["lateral_displacement"][:, 1, 1]
    return z, np.unwrap(np.angle(z)), result["rotation"][:, 1]


def late(result, seconds=1.0):
    """The last so many seconds."""
    return np.flatnonzero(result.time >= result.time[-1] - seconds - 1e-9)


def whole_turns(result, seconds=2.0):
    """Frames of the last so many seconds, less what is no whole turn around the hole: a slight gravity averages out."""
    at = late(result, seconds)
    _, angle, _ = way(result)
    gone = np.abs(angle[at] - angle[at[0]]) / (2 * pi)
    return at[gone < np.floor(gone[-1])]


def whirl_rate(result, seconds=1.0):
    at = late(result, seconds)
    _, angle, _ = way(result)
    return (angle[at[-1]] - angle[at[0]]) / (result.time[at[-1]] - result.time[at[0]])


def steady(result):
    """Offset in the frame that turns with the pipe, mean of the end, which must have settled."""
    z, _, turned = way(result)
    turning = (z * np.exp(-1j * turned))[late(result)]
    spread = np.ptp(np.abs(turning)) / np.abs(turning).mean()
    assert spread < 1e-3, "the end is steady"
    return turning.mean()


# -- forward, without the wall


@pytest.mark.parametrize("speed", [0.5, 1.0, 1.1, 4.0, *studies(0.9, 2.0)])
def test_forward_whirl_with_linear_damping_has_amplitude_and_phase_of_the_one_mass_rotor(speed):
    # r/e = (m/M) x^2 / sqrt((1 - x^2)^2 + (2 zeta x)^2), behind the unbalance by atan(2 zeta x / (1 - x^2))
    found = steady(run(span(speed * CRITICAL)))
    size = OFF * STEEL / MASS * speed**2 / sqrt((1 - speed**2) ** 2 + (2 * ZETA * speed) ** 2)
    assert abs(found) == pytest.approx(size, rel=1e-3)
    assert -np.angle(found) == pytest.approx(np.arctan2(2 * ZETA * speed, 1 - speed**2), abs=1e-3)


@pytest.mark.parametrize("speed", [0.6, 1.0, 3.0, *studies(1.5)])
def test_forward_whirl_with_quadratic_drag_has_the_amplitude_of_exact_harmonic_balance(speed):
    # on a circle the drag D (r Omega)^2 is tangential and steady: ((k - M W^2) r)^2 + (D W^2 r^2)^2 = (m e W^2)^2
    drag, turn = 20.0, speed * CRITICAL
    mud = {"density": MUD, "added_mass": 1.0, "drag": drag}
    result = run(span(turn, off=0.02, zeta=0.0, mud=mud, solver__end=20.0))
    stiff, loss, push = SPRING - MASS * turn**2, drag * DRAG * turn**2, STEEL * 0.02 * turn**2
    size = sqrt(2.0 * push**2 / (stiff**2 + sqrt(stiff**4 + 4.0 * (loss * push) ** 2)))
    found = steady(result)
    assert abs(found) == pytest.approx(size, rel=1e-3)
    assert -np.angle(found) == pytest.approx(np.arctan2(loss * size, stiff), abs=2e-3)
    # what the mud takes comes from the rotary
    torque = result["surface_torque"][late(result)].mean()
    assert torque == pytest.approx(drag * DRAG * size**3 * turn**2, rel=2e-3)


def test_far_above_the_critical_speed_the_centre_of_gravity_comes_to_rest_on_the_axis_of_the_hole():
    # z = m e W^2 / (k - m W^2 + i c W) without mud, so z + e = e (k + i c W) / (k - m W^2 + i c W): e / x^2 and less
    speed, c = 10.0 * CRITICAL, damping(0.03)
    result = run(span(speed, zeta=0.03, mud={"density": 1e-9, "drag": 0.0}, solver__step=2.5e-4, solver__end=20.0))
    left = abs((SPRING + 1j * c * speed) / (SPRING - STEEL * speed**2 + 1j * c * speed))
    assert abs(steady(result) + OFF) / OFF == pytest.approx(left, abs=5e-4)
    assert left < 0.02


def test_the_rotary_does_the_work_that_the_damping_takes_at_the_critical_speed():
    # c r^2 Omega is the torque of a steady circle
    result = run(span(CRITICAL))
    torque = result["surface_torque"][late(result)].mean()
    assert torque == pytest.approx(damping(ZETA) * (OFF * STEEL / MASS / (2 * ZETA)) ** 2 * CRITICAL, rel=2e-3)


# -- forward, rubbing on the wall


def rub(speed, off, zeta, friction):
    """Complex offset of a synchronous rub: |(k - M W^2) r + N + i (c W r + mu N)| = m e W^2, N = k_c (r - delta)."""

    def resistance(r):
        normal = SOFT * (r - CLEARANCE)
        tangential = damping(zeta) * speed * r + friction * normal
        return complex((SPRING - MASS * speed**2) * r + normal, tangential)

    push = STEEL * off * speed**2
    r = brentq(lambda r: abs(resistance(r)) - push, CLEARANCE, 1.1 * CLEARANCE)
    return r * np.exp(-1j * np.angle(resistance(r)))


RUBBING = {
    "diameter": HOLE,
    "well__wall__stiffness": SOFT,
    "solver__step": 2.5e-4,
    "solver__end": 8.0,
    "solver__rho_inf": 0.8,
}


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.3])
def test_an_unbalanced_lump_with_little_friction_rubs_forward_around_the_hole(friction):
    # normal force, place and phase of the rub, which the wall's friction brakes all the way around
    speed, off = 2.0 * CRITICAL, 0.02
    assert STEEL * off * speed**2 > (MASS * speed**2 - SPRING) * CLEARANCE, "the free circle is wider than the hole"
    result = run(span(speed, off, 0.02, friction=friction, **RUBBING))
    exact = rub(speed, off, 0.02, friction)
    found = steady(result)
    assert whirl_rate(result) / speed == pytest.approx(1.0, rel=1e-3)
    assert abs(found) == pytest.approx(abs(exact), rel=1e-4)
    assert np.angle(found) == pytest.approx(np.angle(exact), abs=2e-3)
    normal = result["contact_force"][late(result), 1].mean()
    assert normal == pytest.approx(SOFT * (abs(exact) - CLEARANCE), rel=2e-3)
    braked = damping(0.02) * abs(exact) ** 2 * speed + friction * normal * (RADIUS + abs(exact))
    assert result["surface_torque"][late(result)].mean() == pytest.approx(braked, rel=5e-3)


def test_the_same_lump_with_much_friction_is_thrown_back_at_its_first_blow_and_rolls():
    # 0.6 beside the 0.3 above: rubbing forward and rolling backward are both solutions, and the first blow decides
    speed, off = 2.0 * CRITICAL, 0.02
    result = run(span(speed, off, 0.02, friction=0.6, **RUBBING | {"solver__end": 4.0}))
    r = np.abs(way(result)[0])[late(result)].mean()
    assert whirl_rate(result) / speed == pytest.approx(-RADIUS / r, rel=1e-3)


# -- backward


def level(friction, speed=4 * pi, zeta=0.0, **changes):
    """The lump on the low side of a level hole, without bending, in a slight gravity: it starts in contact."""
    return span(
        speed, 0.0, zeta, inclination=pi / 2, friction=friction, gravity=0.5, model__bending="none",
        **RUBBING | {"well__wall__stiffness": WALL, "solver__end": 5.0} | changes,
    )  # fmt: skip


def climb(friction, angle):
    """Speed squared over r g of a mass that a belt of friction mu drives up a hole, from rest at the bottom.

    dy/dpsi = 2 (mu N - sin psi), N = cos psi + y in weights, has the solution A cos + B sin - A exp(2 mu psi).
    """
    down, along = (2 - 4 * friction**2) / (1 + 4 * friction**2), 6 * friction / (1 + 4 * friction**2)
    return down * (np.cos(angle) - np.exp(2 * friction * angle)) + along * np.sin(angle)


def rolling(speed):
    """Radius of pure rolling: k_c (r - delta) = M r W_w^2 with W_w = R Omega / r."""
    return brentq(lambda r: WALL * (r - CLEARANCE) - MASS * (RADIUS * speed) ** 2 / r, CLEARANCE, 1.2 * CLEARANCE)


def test_a_lump_in_contact_rolls_backward_where_friction_exceeds_one_over_the_root_of_two():
    # A < 0 in `climb`: friction carries it over the top, and on until its surface no longer slips
    speed = 4 * pi
    assert climb(0.8, np.linspace(0.1, 2 * pi, 50)).min() > 0.0
    result = run(level(0.8, speed))
    assert result.attributes["halvings"] == 0, "a contact that rolls is no contact that chatters"
    rate, r = whirl_rate(result, 2.0), rolling(speed)
    assert rate / speed == pytest.approx(-COLLAR[0] / (HOLE - COLLAR[0]), rel=1e-2), "a rigid wall"
    assert rate / speed == pytest.approx(-RADIUS / r, rel=1e-3), "the wall as soft as it is"
    normal = result["contact_force"][whole_turns(result), 1].mean()
    assert normal == pytest.approx(MASS * r * rate**2, rel=3e-3)


def test_a_lump_in_contact_with_less_friction_swings_on_the_low_side_as_far_as_the_closed_form_says():
    for friction in (0.4, 0.6):
        result = run(level(friction))
        _, angle, _ = way(result)
        top = brentq(lambda x, mu=friction: climb(mu, x), 0.8 * np.arctan(friction) * 2, pi)
        assert angle[0] - angle.min() == pytest.approx(top, rel=1e-2)
        assert abs(whirl_rate(result, 4.0)) < 0.02 * 4 * pi


def test_the_rotary_keeps_a_lump_rolling_by_the_work_that_its_damping_takes():
    # tangential balance c r W_w = F, of power R F Omega = c (r W_w)^2; rolling lasts where F < mu N: c < mu M W_w
    speed, zeta = 4 * pi, 0.02
    result = run(level(0.8, speed, zeta))
    r, rate = rolling(speed), -whirl_rate(result, 2.0)
    assert rate == pytest.approx(RADIUS * speed / r, rel=1e-3)
    first, last = whole_turns(result)[[0, -1]]
    spent = result.time[last] - result.time[first]
    for energy in ("dissipated_energy", "external_work"):
        power = (result[energy][last] - result[energy][first]) / spent
        assert power == pytest.approx(damping(zeta) * (r * rate) ** 2, rel=1e-2)
    assert damping(zeta) < 0.8 * MASS * rate


# -- what is told of it


def test_the_whirl_ratio_of_a_run_is_that_of_its_circle_and_frames_far_apart_do_not_deceive_it():
    # from positions alone, a frame every 50 ms would see the lump, which goes 8.6 times a second, go the other way
    slow = run(level(0.8, 4 * pi, output__interval=0.05))
    one = whirl_of(slow, busiest(slow))
    assert one.lump == 1 and one.rolling == pytest.approx(-COLLAR[0] / (HOLE - COLLAR[0]))
    assert one.ratio() == pytest.approx(-RADIUS / rolling(4 * pi), rel=2e-3)
    assert one.rate()[-1] == pytest.approx(one.ratio() * 4 * pi, rel=2e-2)


@pytest.mark.parametrize("narrow", [0.9, 0.5])
def test_the_whirl_ratio_of_a_whirl_with_the_rotary_is_one_whatever_the_form_of_its_orbit(narrow):
    # an ellipse: the angle about its middle goes round once a turn; area over r^2 has 2 a b / (a^2 + b^2) of that
    time, rate = np.linspace(0.0, 50.0, 5001), 9.0
    offset = np.cos(rate * time) + 1j * narrow * np.sin(rate * time)
    velocity = rate * (-np.sin(rate * time) + 1j * narrow * np.cos(rate * time))
    ellipse = Whirl(0, time, 1e-3 * offset, 1e-3 * velocity, np.full(time.size, rate), 10.0, None, None)
    assert ellipse.ratio() == pytest.approx(1.0, abs=6e-3)
    line = ellipse.offset.real + 1e-3j * ellipse.offset.imag
    across = Whirl(0, time, line, velocity.real * 1e-3 + 0j, ellipse.spin, 10.0, None, None)
    assert abs(across.ratio()) < 2e-3, "what swings through the axis goes around nothing"


def orbit(offset, velocity, time, rotary):
    return Whirl(0, time, 1e-3 * offset, 1e-3 * velocity, np.full(time.size, rotary), 10.0, None, None)


@pytest.mark.parametrize("narrow", [0.26, 0.24, 0.05])
def test_the_whirl_ratio_does_not_leap_where_an_orbit_becomes_narrow(narrow):
    """It was 0.998 of the axes 1 and 0.26, and 0.444 of 1 and 0.24."""
    time, rate = np.arange(0.0, 20.0, 0.01), 6.0
    one = orbit(
        np.cos(rate * time) + 1j * narrow * np.sin(rate * time),
        rate * (-np.sin(rate * time) + 1j * narrow * np.cos(rate * time)), time, rate,
    )  # fmt: skip
    assert one.counts() and one.ratio() == pytest.approx(1.0, abs=1e-2)


ROTARIES = {
    "started": (10.0, lambda t: 2.0 * pi * t / 10.0),
    "stopped": (10.0, lambda t: 18.0 * pi * (1.0 - t / 10.0) + 0.5),
    "stick-slip": (30.0, lambda t: 13.0 * (1.0 + np.cos(0.4 * pi * t))),
    "back and forth": (30.0, lambda t: 4.0 + 9.0 * np.cos(0.8 * pi * t)),
}


def fixed_to(turned, spin, ratio=1.0, narrow=0.0):
    """An orbit at a ratio of the pipe's angle; `narrow` is that of a part that goes the other way."""
    ahead, back = np.exp(1j * ratio * turned), narrow * np.exp(-1j * ratio * turned)
    return ahead + back, 1j * ratio * spin * (ahead - back)


@pytest.mark.parametrize("rotary", ROTARIES)
@pytest.mark.parametrize("ratio", [1.0, -2.5])
def test_the_whirl_ratio_of_a_circle_that_goes_with_the_pipe_heeds_no_change_of_the_rotary(rotary, ratio):
    # a started rotary made it 1.049, one that sticks and slips 1.043
    end, speed = ROTARIES[rotary]
    time = np.arange(0.0, end, 0.01)
    spin = speed(time)
    turned = np.append(0.0, np.cumsum(0.005 * (spin[1:] + spin[:-1])))
    one = Whirl(0, time, *fixed_to(turned, spin, ratio), spin, 10.0, None, None)
    assert one.counts() and one.ratio() == pytest.approx(ratio, rel=1e-9)


@pytest.mark.parametrize("narrow", [0.3, 0.9])
def test_less_than_a_turn_of_pipe_and_lump_has_no_whirl_ratio(narrow):
    # it was 0.66 and 0.07 of a whirl with the rotary, a fifth of 0.6 of a turn
    time, rate = np.arange(0.0, 4.0, 0.01), 1.0
    one = Whirl(0, time, *fixed_to(rate * time, rate, 1.0, narrow), np.full(time.size, rate), 10.0, None, None)
    assert one.counts() and np.isnan(one.ratio())


@pytest.mark.parametrize(("rate", "end"), [(10.0, 3.0), (1.0, 31.0), (1.0, 6.3)])
@pytest.mark.parametrize(("ratio", "narrow"), [(1.0, 0.0), (1.0, 0.9), (0.5, 0.0), (0.0, 0.0)])
def test_where_the_last_fifth_is_less_than_a_turn_the_whirl_ratio_is_that_of_the_last_turn(rate, end, ratio, narrow):
    # last fifths of 0.95, 0.99 and 0.2 turns
    time = np.linspace(0.0, end, 3001)
    one = Whirl(0, time, *fixed_to(rate * time, rate, ratio, narrow), np.full(time.size, rate), 10.0, None, None)
    assert one.counts() and one.ratio() == pytest.approx(ratio, abs=1e-3) and one.span == "turn of the pipe"


def test_a_run_of_less_than_a_turn_says_that_it_has_no_whirl_ratio_and_what_gives_one():
    turn = 2.0 * pi / (0.5 * CRITICAL)
    for end, said in ((0.8 * turn, True), (1.5 * turn, False)):
        result = run(span(0.5 * CRITICAL, solver__end=end))
        told = [one for one in result.attributes["warnings"] if "no whirl ratio" in one]
        assert ("whirl_ratio" not in result.headline) == said == bool(told)
        assert all("--end" in one for one in told)


def test_a_string_that_stands_still_at_the_end_says_that_it_has_no_whirl_ratio_and_why():
    speed = 0.5 * CRITICAL
    stopped = {"table": {"time": [0.0, 4.0, 5.0, 9.0], "value": [speed, speed, 0.0, 0.0]}}
    result = run(span(speed, top__rotation=stopped))
    assert "whirl_ratio" not in result.headline and "lateral_offset_max" in result.headline
    (told,) = [one for one in result.attributes["warnings"] if "no whirl ratio" in one]
    assert "stands still in the last fifth of the run" in told


def test_a_pipe_that_turns_back_as_far_as_it_turned_on_has_no_whirl_ratio_and_that_is_said():
    # 20 s: the last fifth begins at 16 s, and the lump goes on around the axis as the pipe turns back at 18 s
    time = np.linspace(0.0, 20.0, 4001)
    spin = np.interp(time, [0.0, 17.0, 19.0, 20.0], [6.0, 6.0, -6.0, -6.0])
    around = np.exp(6j * time)
    one = Whirl(0, time, around, 6j * around, spin, 10.0, None, None)
    assert np.isnan(one.ratio()) and "turns to and fro" in one.why_none()


def test_whole_turns_of_a_lump_that_outruns_a_pipe_of_less_than_a_turn_make_a_whirl_ratio():
    time, rate = np.arange(0.0, 4.0, 0.001), 1.0  # 0.8 s: 0.13 turns of the pipe, 1.5 of the lump
    one = Whirl(0, time, *fixed_to(rate * time, rate, -12.0, 0.3), np.full(time.size, rate), 10.0, None, None)
    assert one.counts() and one.ratio() == pytest.approx(-12.0, rel=1e-3)


def test_the_whirl_ratio_of_a_line_through_the_axis_is_none_and_comes_from_the_area():
    time, rate = np.arange(0.0, 20.0, 0.01), 6.0
    line = orbit(np.cos(rate * time) + 0j, -rate * np.sin(rate * time) + 0j, time, rate)
    assert not line.counts() and line.ratio() == 0.0


@pytest.mark.parametrize("ratio", [-3.3, -0.4, 0.1, 0.5])
def test_the_whirl_ratio_of_circles_is_their_speed_forward_and_backward(ratio):
    time, rate = np.arange(0.0, 20.0, 0.01), 6.0
    circle = np.exp(1j * ratio * rate * time)
    assert orbit(circle, 1j * ratio * rate * circle, time, rate).ratio() == pytest.approx(ratio, rel=1e-9)


def test_turns_that_frames_leave_out_are_not_counted_and_the_ratio_is_still_that_of_the_circle():
    time, rate = np.arange(0.0, 50.0, 0.1), 6.0
    fast = -0.9 * 2.0 * pi / 0.1  # in each interval nine tenths of a turn backward, seen as one tenth forward
    circle = np.exp(1j * fast * time)
    one = orbit(circle, 1j * fast * circle, time, rate)
    assert not one.counts() and one.ratio() == pytest.approx(fast / rate, rel=1e-9)


def test_the_summary_says_where_a_whirl_ratio_is_no_count_of_turns():
    interval = 0.3 * 2.0 * pi / (2.0 * CRITICAL)  # three frames to a turn
    coarse, fine = (
        run(span(2.0 * CRITICAL, **more)).headline["whirl_ratio"] for more in ({"output__interval": interval}, {})
    )
    assert "by the area swept" in coarse["text"] and "by the area swept" not in fine["text"]


def test_headline_figures_of_an_unbalanced_string_tell_offset_whirl_ratio_and_acceleration():
    result = run(span(2.0 * CRITICAL))
    told = result.headline
    size = abs(steady(result))
    assert told["whirl_ratio"]["value"] == pytest.approx(1.0, abs=2e-3)
    assert told["lateral_offset_max"]["value"] == pytest.approx(np.abs(way(result)[0]).max())
    assert told["lateral_acceleration_max"]["value"] >= 0.99 * size * (2.0 * CRITICAL) ** 2
    assert "whirl_ratio" not in run(level(0.4, solver__end=0.5)).headline, "nothing is eccentric"


# -- either way


def test_the_acceleration_of_a_circle_that_frames_far_apart_miss_is_told():
    """Between frames a third of a turn apart the velocity changes by its chord: sin(pi / 3) / (pi / 3) of the arc."""
    speed = 1.5 * CRITICAL
    apart = 2 * pi / 3 / speed
    scene = span(speed, zeta=0.5, output__interval=apart, solver__end=30 * apart, solver__step=apart / 60)
    told = simulate(scene, verify=True).between_frames["figures"]
    share = next(one["share"] for one in told if one["name"] == "lateral_acceleration_max")
    assert share >= 0.9 * ((pi / 3) / np.sin(pi / 3) - 1)


@pytest.mark.parametrize("case", ["free", "rub", "roll"])
def test_the_other_sense_of_rotation_gives_the_mirrored_orbit(case):
    made = {
        "free": lambda speed: span(speed, solver__end=2.0),
        "rub": lambda speed: span(speed, 0.02, 0.02, friction=0.2, **RUBBING | {"solver__end": 1.0}),
        "roll": lambda speed: level(0.8, speed, solver__end=2.0),
    }[case]
    speed = 4 * pi if case == "roll" else 2.0 * CRITICAL
    right, left = run(made(speed)), run(made(-speed))
    # in a level hole the first of the two lateral directions is up, so both mirror the second
    mirrored = left["lateral_displacement"][:, 1] * (1.0, -1.0)
    assert mirrored == pytest.approx(right["lateral_displacement"][:, 1], abs=1e-9 * (1.0 if case == "free" else 1e3))
    assert left["rotation"] == pytest.approx(-right["rotation"], abs=1e-6)
    assert left["contact_force"] == pytest.approx(right["contact_force"], rel=1e-3, abs=10.0)
