"""Cranes against the closed forms of reeving (tests/references/crane.py): Atwood, capstan, blocks, bounce, reversal.

Figures in comments are what was measured; tolerances leave a factor of about two to four above them.
"""

from pathlib import Path

import numpy as np
import pytest
import yaml
from physics.lifting.lifts import (
    G,
    anchor,
    at_start,
    atwood,
    block,
    body,
    drawn_length,
    end,
    energy_missing,
    of,
    orders,
    ramp,
    rope_length,
    run,
    scene,
    taut,
    travel,
)
from references import crane as reference
from scipy.integrate import solve_ivp

from crane.scene.scene import CraneScene
from tautline.integrators.vibration.modes import modes
from tautline.scene.model import validate
from tautline.scene.reading.document import Document

SCENES = Path(__file__).parents[2] / "input" / "crane_scenes"


# Atwood's machine
def test_atwoods_machine_with_a_sheave_of_inertia():
    # Newton: a = (m_2 - m_1) g/(m_1 + m_2 + I/R^2). Measured: speed 4e-7, tensions 7e-7
    expected, T1, T2 = reference.atwood(80.0, 100.0, 12.0, 0.4)
    result = run(atwood(80.0, 100.0, 0.4, {"law": "no_slip", "inertia": 12.0}))
    time, late = of(result, "time"), slice(2, None)
    speed = -of(result, "body_velocity")[:, 1, 2]
    assert speed[late] / time[late] == pytest.approx(expected, rel=3e-6)
    assert travel(result)[-1] == pytest.approx(0.5 * expected, rel=3e-6)
    tension = of(result, "tension")[late]
    assert tension[:, 0] == pytest.approx(T1, rel=3e-6) and tension[:, 1] == pytest.approx(T2, rel=3e-6)
    assert of(result, "sheave_rotation")[-1, 0] == pytest.approx(travel(result)[-1] / 0.4, rel=3e-6)


HEAVY = {"mass_1": 80.0, "mass_2": 100.0, "mass_per_length": 2.0, "length": 30.0, "inertia": 12.0, "radius": 0.4}


@pytest.mark.parametrize("elements", [1, 8])
def test_atwoods_machine_with_a_heavy_rope_runs_off_with_the_hyperbolic_cosine(elements):
    # Of 1.4 m in 2 s: 2.3e-6 m, whatever the mesh. Tension at the masses: 1e-8
    law = {"law": "no_slip", "inertia": 12.0}
    side = 0.5 * (30.0 - np.pi * 0.4)
    rope = {"mass_per_length": 2.0}
    made = atwood(80.0, 100.0, 0.4, law, 0.5, side, rope=rope, elements=elements, solver={"end": 2.0}, interval=0.1)
    result = run(made)
    expected = reference.heavy_atwood(of(result, "time"), **HEAVY, x0=0.5)
    assert 0.5 + travel(result) == pytest.approx(expected.x, abs=1e-5)
    tension, a = of(result, "tension")[2:], expected.a[2:]
    assert tension[:, 0, 0] == pytest.approx(80.0 * (G + a), rel=1e-7)
    assert tension[:, 1, 1] == pytest.approx(100.0 * (G - a), rel=1e-7)
    # at the mark on top of the sheave half the rope on it hangs on either side: 12.3 N of 1 kN at rest
    arc = 2.0 * 0.5 * np.pi * 0.4
    assert tension[:, 0, 1] == pytest.approx(expected.tension_1[2:] + arc * (G + a), abs=0.02)
    assert tension[:, 1, 0] == pytest.approx(expected.tension_2[2:] + arc * (G - a), abs=0.02)


# capstan
GROOVES = pytest.mark.parametrize(("friction", "groove"), [(0.12, None), (0.06, np.pi / 3.0)])


def capstan(friction, groove=None, **more):
    return {"law": "capstan", "friction": friction} | ({} if groove is None else {"groove": float(groove)}) | more


@GROOVES
def test_rope_that_slips_over_a_locked_sheave_has_the_ratio_of_euler_and_eytelwein(friction, groove):
    expected, T1, T2 = reference.slipping_atwood(80.0, 130.0, friction, groove=groove)
    result = run(atwood(80.0, 130.0, 0.4, capstan(friction, groove, locked=True), tension=0.5 * (T1 + T2)))
    late = slice(2, None)
    tension = of(result, "tension")[late]
    assert tension[:, 1, 0] / tension[:, 0, 1] == pytest.approx(
        reference.capstan_ratio(friction, np.pi, groove), rel=1e-6
    )
    assert tension[:, 0] == pytest.approx(T1, rel=1e-5) and tension[:, 1] == pytest.approx(T2, rel=1e-5)
    speed, time = -of(result, "body_velocity")[late, 1, 2], of(result, "time")[late]
    assert np.diff(speed) / np.diff(time) == pytest.approx(expected, rel=1e-5)
    assert np.all(of(result, "slipping")[late, 0] != 0)
    # ratio 9e-9, acceleration 2e-6, heat 4e-7
    heat, x = np.ptp(of(result, "dissipated_energy")[late]), np.ptp(travel(result)[late])
    assert heat == pytest.approx((T2 - T1) * x, rel=5e-6)


@pytest.mark.parametrize("friction", [0.3, 0.5, 1.0])
def test_friction_of_any_size_is_the_same_by_both_methods(friction):
    # The tension over the sheave grows by up to 23 times: what accelerations add to friction is more than the masses.
    rope = {"mass_per_length": 5.0, "axial_stiffness": 2e6, "damping": 2e-3}
    speeds = []
    for method, step in (("generalized-alpha", 1e-3), ("rk4", 5e-5)):
        heavy = 80.0 * reference.capstan_ratio(friction, np.pi, None) * 1.6 + 150.0
        solver = {"method": method, "step": step, "end": 0.3}
        made = atwood(80.0, heavy, 0.01, capstan(friction, locked=True), tension=1500.0, rope=rope, solver=solver)
        speeds.append(-of(run(made), "body_velocity")[-1, 1, 2])
    # 3e-4 m/s or less of 0.4 to 0.9
    assert speeds[0] == pytest.approx(speeds[1], abs=1e-3) and speeds[1] > 0.3


@pytest.mark.parametrize(("method", "step"), [("generalized-alpha", 1e-3), ("rk4", 1e-4)])
def test_friction_of_heavy_rope_goes_by_the_tension_that_accelerates_it_too(method, step):
    # T_2 - rho v^2 = r (T_1 - rho v^2), T_2 = M_2 (g - a) and T_1 = M_1 (g + a), M the masses with the rope on their
    # sides: 1.96 m/s^2; a friction that goes by what rope weighs, and not by what it resists with, leaves 1.5 % more.
    rope = {"mass_per_length": 5.0, "axial_stiffness": 2e6, "damping": 2e-2}
    law, solver = capstan(0.12, locked=True), {"method": method, "step": step, "end": 0.6}
    made = atwood(80.0, 200.0, 0.01, law, tension=1500.0, rope=rope, solver=solver)
    result, ratio = run(made), reference.capstan_ratio(0.12, np.pi, None)
    time, speed = of(result, "time"), -of(result, "body_velocity")[:, 1, 2]
    middle = 5.0 * (of(result, "body_position")[-3:-1, 1, 2].mean() + 5.0)
    out, into = 200.0 + 25.0 - middle, ratio * (80.0 + 25.0 + middle)
    thrown = (ratio - 1.0) * 5.0 * speed[-3:-1].mean() ** 2
    found = (speed[-1] - speed[-4]) / (time[-1] - time[-4])
    # Measured: 6e-4 with either method, which differ by 4e-7; the rope is stretched by 1e-3.
    assert found == pytest.approx(((out - into) * G + thrown) / (out + into), rel=1.5e-3)


@GROOVES
def test_rope_at_98_percent_of_the_ratio_does_not_creep_over_a_locked_sheave(friction, groove):
    # at rest under 100 kg on both sides, pulled down to 98 % of the ratio: 1e-15 m between 1 s and 11 s
    pull = (0.98 * reference.capstan_ratio(friction, np.pi, groove) - 1.0) * 100.0 * G
    law = capstan(friction, groove, locked=True)
    solver = {"step": 5e-3, "end": 11.0}
    result = run(atwood(100.0, 100.0, 0.4, law, force=ramp(-pull, 0.5), solver=solver, interval=0.5))
    held = of(result, "time") >= 1.0
    assert np.ptp(travel(result)[held]) < 1e-8
    assert np.ptp(of(result, "material_coordinate")[held, 1]) < 1e-8
    tension = of(result, "tension")[-1]
    assert tension[1, 0] / tension[0, 1] == pytest.approx(
        0.98 * reference.capstan_ratio(friction, np.pi, groove), rel=1e-6
    )


def test_rope_just_above_the_ratio_does_slip():
    pull = (1.01 * reference.capstan_ratio(0.12, np.pi) - 1.0) * 100.0 * G
    result = run(atwood(100.0, 100.0, 0.4, capstan(0.12, locked=True), force=ramp(-pull, 0.5), solver={"end": 2.0}))
    assert of(result, "slipping")[-1, 0] != 0 and travel(result)[-1] > 1e-2


def test_rope_at_98_percent_of_the_ratio_does_not_creep_over_a_sheave_that_turns_with_it():
    # m_2 such that the machine runs at 98 % of the ratio: rope and rim part by 1e-10 m in 10 s while 2 m pass
    ratio, inertia, radius = 0.98 * reference.capstan_ratio(0.1, np.pi), 4000.0, 0.5
    rim = inertia / radius**2
    # T_2 = ratio T_1 with a = (T_2 - T_1) R^2/I, T_1 = m_1 (g + a)
    a = (ratio - 1.0) * 100.0 * G / (rim - (ratio - 1.0) * 100.0)
    mass_2 = ratio * 100.0 * (G + a) / (G - a)
    law = capstan(0.1, inertia=inertia)
    made = atwood(100.0, mass_2, radius, law, solver={"step": 5e-3, "end": 10.5}, interval=0.5)
    result = run(made)
    rim_travel, x = radius * of(result, "sheave_rotation")[:, 0], travel(result)
    late = of(result, "time") >= 0.5
    tension = of(result, "tension")[-1]
    assert tension[1, 0] / tension[0, 1] == pytest.approx(ratio, rel=1e-4)
    assert x[-1] == pytest.approx(0.5 * a * 10.5**2, rel=1e-3)
    # As built the rope has one stretch all along, by which the contact counts its travel.
    stretch = drawn_length(made) / made.rope.length
    slipped = rim_travel + stretch * of(result, "material_coordinate")[:, 1]
    assert np.ptp(slipped[late]) < 1e-6


def test_heavy_rope_sticks_to_a_free_sheave_until_its_tensions_reach_the_ratio():
    # FrictionAtwood sticks for 6.07 s of 7 s, then slips. Of 7.8 m off by 0.4 mm, the rim by 0.6 mm: the reference has
    # the rope's weight all along the arc
    machine = reference.FrictionAtwood(300.0, 305.0, 0.03, 80.0, 0.4, 6.0, 30.0)
    expected = machine.simulate(np.linspace(0, 7, 29), x0=2.0)
    side = 0.5 * (30.0 - np.pi * 0.4)
    made = atwood(
        300.0, 305.0, 0.4, capstan(0.03, inertia=80.0), 2.0, side,
        rope={"mass_per_length": 6.0}, elements=8, solver={"step": 5e-3, "end": 7.0}, interval=0.25,
    )  # fmt: skip
    result = run(made)
    assert 2.0 + travel(result) == pytest.approx(expected.x, abs=1.5e-3)
    assert 0.4 * of(result, "sheave_rotation")[:, 0] == pytest.approx(expected.s, abs=2e-3)
    ((when, _),) = expected.events
    slips, time = of(result, "slipping")[:, 0], of(result, "time")
    assert np.all(slips[time < when - 0.25] == 0) and np.all(slips[time > when + 0.25] != 0)
    assert energy_missing(result) < 1e-4


# slips and sticks again
PULLED = {"mass": 100.0, "inertia": 20.0, "radius": 0.4, "friction": 0.1, "pull": 1800.0, "period": 1.0}


def pulled_atwood(times):
    """Equal masses over a free sheave, the second pulled by `pull` sin(2 pi t/period): sticks, slips, sticks again.

    Newton's equations phase by phase, weightless rope, to 1e-10: x, v of the rope and s, w of the rim (n, 4), and when
    it slips and sticks.
    """
    mass, ratio = PULLED["mass"], reference.capstan_ratio(PULLED["friction"], np.pi)
    rim = PULLED["inertia"] / PULLED["radius"] ** 2

    def stuck(time):
        pull = PULLED["pull"] * np.sin(2 * np.pi * time / PULLED["period"])
        a = pull / (2 * mass + rim)
        return a, a, mass * (G + a), mass * (G - a) + pull

    def slipping(time):
        pull = PULLED["pull"] * np.sin(2 * np.pi * time / PULLED["period"])
        a = (mass * G * (1 - ratio) + pull) / (mass * (1 + ratio))
        T = mass * (G + a)
        return a, (ratio - 1) * T / rim, T, ratio * T

    def lets_go(time, _):
        _, _, T1, T2 = stuck(time)
        return T2 - ratio * T1

    def catches(_, y):
        return y[1] - y[3]

    state, at, events, rows = np.zeros(4), 0.0, [], np.zeros((len(times), 4))
    for law, stop, sense in ((stuck, lets_go, 1), (slipping, catches, -1), (stuck, None, 1)):
        if stop is not None:
            stop.terminal, stop.direction = True, sense

        def rate(time, y, law=law):
            a, b, _, _ = law(time)
            return [y[1], a, y[3], b]

        done = solve_ivp(rate, (at, times[-1]), state, "DOP853", rtol=1e-11, atol=1e-13, events=stop, dense_output=True)
        inside = (times >= at) & (times <= done.t[-1])
        rows[inside] = done.sol(times[inside]).T
        at, state = done.t[-1], done.y[:, -1]
        events.append(at)
    return rows, events[:2]


def test_rope_pulled_over_a_free_sheave_slips_and_sticks_again():
    # Of 0.53 m: 1.1e-5, 6.8e-6, 6.4e-6 m at 2, 1 and 0.5 ms, of which 6e-6 is the rope's stretch
    law = capstan(PULLED["friction"], inertia=PULLED["inertia"])
    force = {"harmonic": {"amplitude": -PULLED["pull"], "period": PULLED["period"]}}
    misses = []
    for step in (2e-3, 1e-3, 5e-4):
        made = atwood(
            100.0, 100.0, PULLED["radius"], law, force=force, solver={"step": step, "end": 0.54}, interval=0.02
        )
        result = run(made)
        expected, (lets_go, catches) = pulled_atwood(of(result, "time"))
        rim = PULLED["radius"] * of(result, "sheave_rotation")[:, 0]
        misses.append(np.abs(np.stack((travel(result), rim), 1) - expected[:, [0, 2]]).max())
        slips, time = of(result, "slipping")[:, 0], of(result, "time")
        assert np.all(slips[(time > lets_go + 5e-3) & (time < catches - 5e-3)] != 0)
        assert np.all(slips[(time < lets_go - 5e-3) | (time > catches + 5e-3)] == 0)
        tension = of(result, "tension")[slips != 0]
        assert tension[:, 1, 0] / tension[:, 0, 1] == pytest.approx(reference.capstan_ratio(0.1, np.pi), rel=1e-6)
    assert misses[0] > misses[-1] and misses[-1] < 2e-5


# blocks
@pytest.mark.parametrize("efficiency", [1.0, 0.97])
@pytest.mark.parametrize("pay_out", [-0.5, 0.5])
@pytest.mark.parametrize(("falls", "apart"), [(1, 0.0), (2, 0.0), (4, 0.0), (4, 0.1), (16, 0.0), (16, 0.05)])
def test_block_shares_its_load_between_its_falls_and_moves_as_they_do(falls, apart, pay_out, efficiency):
    # T_out = T_in/eta over each sheave: lead line, falls and dead end to 1e-5, side by side but for the falls' slant
    law = {"law": {"efficiency": efficiency}} if efficiency < 1.0 else {"law": "frictionless"}
    made = block(falls, 5000.0, law, ramp(pay_out, 0.5), apart, solver={"step": 5e-3, "end": 2.0}, interval=0.1)
    result = run(made)
    expected = reference.falls(falls, 5000.0 * G, efficiency, hoisting=pay_out < 0.0)
    tension, slant = of(result, "tension")[-1, :, 0], (apart / 10.0) ** 2
    assert tension == pytest.approx([expected.lead, *expected.tensions], rel=3e-6 + slant)
    assert 5000.0 * G / of(result, "drum_tension")[-1, 0] == pytest.approx(expected.advantage, rel=3e-6 + slant)
    speed = of(result, "body_velocity")[-1, 0, 2]
    assert -pay_out / speed == pytest.approx(expected.speed_ratio, rel=1e-4 + slant)
    # power at the load over that at the drum
    power = of(result, "winch_power")[-1, 0]
    share = 5000.0 * G * speed / power if pay_out < 0.0 else power / (5000.0 * G * speed)
    assert share == pytest.approx(expected.efficiency, rel=2e-4 + slant)


@pytest.mark.parametrize("pay_out", [-0.5, 0.5])
def test_friction_in_bearings_is_an_efficiency(pay_out):
    # (R - mu_b r_b)/(R + mu_b r_b) at 180 deg, less at the first sheave, which the rope leaves after 90 deg
    law = {"law": "no_slip", "bearing": {"friction": 0.1, "radius": 0.06}}
    result = run(block(4, 5000.0, law, ramp(pay_out, 0.5), solver={"step": 5e-3, "end": 2.0}, interval=0.1))
    ratio = [reference.bearing_efficiency(0.1, 0.06, 0.3, wrap) for wrap in of(result, "wrap_angle")[-1]]
    tension = of(result, "tension")[-1, :, 0]
    found = tension[1:] / tension[:-1] if pay_out < 0.0 else tension[:-1] / tension[1:]
    assert found == pytest.approx(ratio, rel=1e-5)
    assert ratio[1] == pytest.approx((0.3 - 0.006) / (0.3 + 0.006), rel=1e-6)


# small vibrations
@pytest.mark.parametrize("falls", [1, 2, 4, 16])
def test_block_bounces_with_the_frequency_of_its_falls(falls):
    # (n/2 pi) sqrt(EA/(L_0 M)), EA the tangent's of Green's law: 5e-8 to 7e-7
    rope = {"axial_stiffness": 1e7, "mass_per_length": 1e-4, "damping": 0.0}
    made = block(falls, 5000.0, {"law": "frictionless"}, rope=rope)
    system, state = at_start(made)
    expected = reference.bounce_frequency(falls, 1e7, rope_length(made, system), 5000.0, G)
    assert modes(system, state).frequency[0] == pytest.approx(expected, rel=3e-6)


def axial_misses(elements):
    """Relative errors of the lowest four frequencies of a rope with mass and a body at its end, pulled, no gravity."""
    stretch = reference.stretch_under(5e4, 1e7)
    load = body("load", 1000.0, (0.0, 0.0, -50.0 * stretch), "xy", force=[0.0, 0.0, -5e4])
    rope = {"axial_stiffness": 1e7, "mass_per_length": 6.5, "damping": 0.0}
    made = scene([anchor((0.0, 0.0, 0.0)), end("load")], [load], rope, elements=elements, gravity=0, start="as drawn")
    system, state = at_start(taut(made, 5e4))
    found = modes(system, state)
    # all but those across the rope
    along = np.abs(found.shape[system.free[[name.endswith("z") for name in system.names]]]).max(axis=0) > 0.5
    return found.frequency[along][:4] / reference.bar_frequencies(1e7, 6.5, 50.0, 1000.0, 4, stretch) - 1.0


def test_axial_frequencies_are_those_of_a_bar_with_a_mass_at_its_end():
    # beta tan(beta) = rho L/M. At 64 elements off by 3.0e-7, 1.0e-4, 4.0e-4, 9.0e-4; order two
    misses = [axial_misses(n) for n in (16, 32, 64)]
    assert orders(misses) == pytest.approx(np.full((2, 4), 2.0), abs=0.05)
    assert np.abs(misses[-1]).max() < 1.5e-3 and misses[-1][0] < 1e-6


# reversal
def shipped(name, *edits):
    document = yaml.safe_load((SCENES / f"{name}.yaml").read_text())
    document["solver"]["end"] = 4.0
    document["solver"]["tolerance"] = 1e-11  # what iterations leave is far below what is compared
    for edit in edits:
        edit(document)
    return document


def slippery(document):
    """A hook sheave that slips, and a dead end out of its plane."""
    document["path"][2]["sheave"]["friction"] = 0.001
    document["path"][3]["anchor"]["position"] = [13.1, 0.7, 30]


def askew(document):
    """A payload that hangs out of the sheaves' plane and swings."""
    document["bodies"][0]["position"] = [12.4, 0.6, 5]
    document["bodies"][0]["velocity"] = [0.5, 0.3, 0.0]


@pytest.mark.parametrize(
    "document",
    [shipped("hookblock"), shipped("hookblock", slippery), shipped("hoist", askew), shipped("slewing")],
    ids=["hook block", "hook block that slips", "hoist askew with a bearing", "slewing"],
)
def test_path_written_the_other_way_round_moves_the_same(document):
    # The sides of the sheaves stay what they are, travel and all senses turn. Positions to 1e-12 m
    one, two = (
        run(validate(CraneScene, Document.parse(yaml.safe_dump({**document, "path": path}), "crane.yaml")))
        for path in (document["path"], document["path"][::-1])
    )
    same = {"body_position": 1e-9, "body_velocity": 1e-9, "wrap_angle": 1e-8, "paid_out": 1e-9}
    for name, tolerance in same.items():
        assert turned(of(two, name), name) == pytest.approx(of(one, name), abs=tolerance), name
    most = of(one, "tension").max()
    assert of(two, "tension")[:, ::-1, ::-1] == pytest.approx(of(one, "tension"), abs=1e-8 * most)
    assert np.array_equal(of(two, "slipping")[:, ::-1], -of(one, "slipping"))
    if document["path"][-1].get("anchor", {}).get("position", [0, 0])[1] > 0.0:
        assert of(one, "slipping").any()


def turned(values, name):
    return values[:, ::-1] if name in ("wrap_angle", "tension") else values
