"""What is told of a run that begins with a jump: what the start adds, beside the motion itself."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
import yaml
from figures.synthetic_crane import HOOK, LOAD, TIP, WINCH, forces_in, one_fall
from of_the_suite import studies

import tautline
from crane.assembly.estimates import estimate
from crane.assembly.jumps import jumps_of
from crane.assembly.prepared import compensation_of
from crane.scene.scene import CraneScene
from crane.warnings import warnings

EA, RHO = 8.0e7, 6.5
DATA = Path(__file__).parents[2] / "data"


def winch(pay_out=0.0):
    return {"drum": WINCH["drum"] | {"pay_out": pay_out}}


def hung(mass, height=5.0, pay_out=0.0, end=2.0, motion=None, elements=4, damping=None, **more):
    """A load on one fall from a tip at 30 m, on a vessel that moves where a motion is given."""
    vessel = {} if motion is None else {"vessel": {"reference": [0, 0, 0], "motion": motion}}
    rope = {"breaking_load": "9 MN"} | ({} if damping is None else {"damping": damping})
    return one_fall(
        path=[winch(pay_out), {"sheave": TIP["sheave"] | {"inertia": 0.01}}, HOOK],
        bodies=[LOAD | {"mass": mass, "position": [12.4, 0, height]}],
        rope=rope, solver={"end": end}, interval=0.01, mesh={"elements_per_span": elements}, **vessel, **more,
    )  # fmt: skip


def told(of):
    """What is told of the start."""
    (text,) = (one.text for one in warnings(of) if "sudden start" in one.text or "swing sideways" in one.text)
    return text


def told_of(of, pattern):
    return forces_in(told(of), pattern)


def more_and_less(of):
    """What the first bounce has more and less than the same motion without a sudden start, N."""
    (more,), (less,) = told_of(of, "up to FORCE more"), told_of(of, "up to FORCE less")
    return more, less


def tensions(of):
    result = tautline.simulate(of)
    tension = np.array(result["tension"])
    return np.array(result["time"]), tension.reshape(len(tension), -1)


def of_masses(of, speed, end, count=240):
    """Tensions of a row of masses and springs with the load at its end, above those at rest: own reference.

    Central differences at the step that a wave takes from mass to mass are exact for the bar. The rope of the first
    span begins as the drum pays it out, evenly down to none.
    """
    length, mass = estimate(of).path.length, of.bodies[0].mass
    first = estimate(of).path.chords[0]
    piece = length / count
    step, spring = piece / math.sqrt(EA / RHO), EA / piece
    masses = np.full(count + 1, RHO * piece)
    masses[-1] = 0.5 * RHO * piece + mass
    place = np.arange(count + 1) * piece
    v = speed * np.maximum(0.0, 1.0 - place / first)
    u, found = np.zeros(count + 1), []
    for _ in range(int(end / step)):
        pull = spring * np.diff(u)
        found.append(pull[[0, round(first / piece), -1]])
        v[1:] += step * np.append(np.diff(pull), -pull[-1]) / masses[1:]
        v[0] = speed
        u += step * v
    return np.array(found)


@pytest.mark.parametrize(
    ("mass", "height", "speed"),
    [
        *studies(("100 t", -970.0, -0.4), ("20 t", -970.0, -0.4), ("50 t", 5.0, -0.4)),
        ("5 t", -970.0, -0.4), ("20 t", -970.0, 0.4), ("5 t", 5.0, -0.4),
    ],
)  # fmt: skip
def test_front_and_bounce_are_told_with_the_sum_that_a_bar_with_a_load_shows(mass, height, speed):
    of = hung(mass, height, speed, damping=0.0)
    more, less = more_and_less(of)
    found = estimate(of)
    end = 0.8 / found.frequency + 2.0 * found.path.length / of.rope.wave_speed
    reference = of_masses(of, speed, end)
    assert more == pytest.approx(reference.max(), rel=0.05)
    assert less == pytest.approx(-reference.min(), rel=0.05)


@pytest.mark.parametrize(
    ("mass", "height", "elements", "end"),
    [*studies(("20 t", -970.0, 30, 3.3)), ("5 t", -970.0, 30, 2.2), ("5 t", 5.0, 4, 0.4)],
)
def test_a_run_rises_as_is_told_of_a_winch_that_jumps(mass, height, elements, end):
    of = hung(mass, height, -0.4, end, elements=elements)
    _, tension = tensions(of)
    assert more_and_less(of)[0] == pytest.approx((tension - tension[0]).max(), rel=0.13)


def test_a_bounce_smaller_than_the_front_is_told_too():
    of = hung("1 t", -970.0, -0.4, 1.6, elements=30, damping=1e-4)
    (bounce,), (front,) = told_of(of, "with FORCE more and less"), told_of(of, "wave of FORCE")
    assert 0.01 * estimate(of).largest_tension < bounce < front
    _, tension = tensions(of)
    rise = (tension - tension[0]).max()
    assert 15_300.0 < rise and 0.95 * rise < more_and_less(of)[0] < 1.25 * rise


def heave(**more):
    return {"heave": {"harmonic": {"amplitude": 1.0, "period": 6.0, **more}}}


@pytest.mark.parametrize("phase", [*studies(0.0), 45.0, *studies(90.0)])
def test_what_the_start_adds_is_the_run_less_the_same_sea_that_has_grown_before(phase):
    of = hung("50 t", end=1.2, motion=heave(phase=f"{phase} deg"))
    grown = hung("50 t", end=37.2, motion=heave(phase=f"{phase} deg", ramp=30))
    _, sudden = tensions(of)
    time, before = tensions(grown)
    begin = int(np.argmin(np.abs(time - 36.0)))
    added = sudden - before[begin : begin + len(sudden)]
    more, less = more_and_less(of)
    assert more == pytest.approx(added.max(), rel=0.1)
    assert less == pytest.approx(-added.min(), rel=0.1)


def test_a_bounce_from_a_sea_of_some_waves_is_that_of_their_closed_sum():
    waves = [(0.5, 8.0, 1.4), (0.3, 6.0, 2.0), (0.2, 10.0, 5.0)]
    terms = [{"harmonic": {"amplitude": a, "period": p, "phase": phase}} for a, p, phase in waves]
    of = hung("50 t", motion={"heave": {"sum": terms}})
    # x'' + W^2 x = u'' with x = x' - u' = 0 at t = 0: free is all that is not -a w^2 / (W^2 - w^2) sin(w t + phi)
    stiffness = EA / estimate(of).path.length
    natural = math.sqrt(stiffness / (50_000.0 + RHO * 25.0 / 3.0))
    stretch = speed = 0.0
    for a, period, phase in waves:
        w = 2.0 * math.pi / period
        forced = -a * w**2 / (natural**2 - w**2)
        stretch -= forced * math.sin(phase)
        speed += a * w * math.cos(phase) - forced * w * math.cos(phase)
    closed = stiffness * math.hypot(stretch, speed / natural)
    (bounce,) = told_of(of, "with FORCE more and less")
    assert bounce == pytest.approx(closed, rel=0.02)


def test_a_tip_that_moves_across_its_rope_sends_no_front_and_lets_the_load_swing():
    speed = 0.5
    of = hung("50 t", end=2.6, motion={"sway": {"harmonic": {"amplitude": 50.0, "period": 100.0 * 2.0 * math.pi}}})
    assert "tension wave" not in told(of)
    (angle,) = map(float, re.findall(r"swing sideways, by up to ([\d.]+) deg", told(of)))
    assert math.radians(angle) == pytest.approx(speed / math.sqrt(9.81 * 25.0), rel=0.05)
    result = tautline.simulate(of)
    lag = speed * np.array(result["time"]) - np.array(result["body_position"])[:, 0, 1]
    assert math.radians(angle) == pytest.approx(lag.max() / 25.0, rel=0.05)
    rise = tensions(of)[1]
    assert (rise - rise[0]).max() < 0.01 * rise[0].max()


def rows(phase):
    time = [0.25 * k for k in range(81)]
    return {"time": time, "value": [math.sin(2.0 * math.pi * t / 8.0 + phase) for t in time]}


CHIRP = {"chirp": {"amplitude": 0.5, "period": 8, "rate": 0.01}}


@pytest.mark.parametrize(
    "function", [{"table": rows(0.0)}, {"table": rows(0.5 * math.pi)}, CHIRP, {"sum": [CHIRP, {"table": rows(0.0)}]}]
)
def test_no_function_is_told_to_use_a_ramp_that_it_refuses(function):
    text = told(hung("50 t", motion={"heave": function}))
    assert "`ramp`" not in text and "begins with rest" in text.replace("begin with rest", "begins with rest")
    late = hung("50 t", motion={"heave": function}, heave_compensation={"gain": 0.9, "delay": 0.3})
    assert not any("`ramp`" in one.text for one in warnings(late))
    key = next(iter(function))
    if key != "sum":
        with pytest.raises(tautline.SceneError):
            hung("50 t", motion={"heave": {key: function[key] | {"ramp": 4}}})


def test_a_ramp_is_told_where_one_of_several_functions_has_it():
    terms = [{"harmonic": {"amplitude": 0.5, "period": 8}}, {"table": rows(0.0)}]
    text = told(hung("50 t", motion={"heave": {"sum": terms}}))
    assert "`ramp`" in text and "Let the table begin with rest" in text


def test_a_ramp_that_began_before_the_run_is_told_to_begin_later():
    ramp = {"ramp": {"to": 2.0, "over": 4.0, "at": -2.0}}
    text = told(hung("50 t", motion={"heave": ramp}))
    assert "Let the ramp begin at t = 0 or later" in text and "`ramp`" not in text


def test_a_load_below_an_actuator_at_its_stroke_is_not_told_to_hardly_bounce():
    harmonic = {"harmonic": {"amplitude": 0.5, "period": 8}}
    limits = {"gain": 1.0, "limits": {"stroke": 0.1}}
    assert "hardly" not in told(hung("50 t", motion={"heave": harmonic}, heave_compensation=limits))


def test_a_rope_that_the_start_lets_go_slack_is_told_to_snap():
    assert "go slack" in told(hung("1 t", 5.0, -0.4))
    assert "go slack" not in told(hung("50 t", 5.0, -0.4))


def test_drag_of_the_water_is_told_to_make_it_less_where_there_is_some():
    text = yaml.safe_load(hung("50 t", 5.0, -0.4).document.text)
    text["water"] = {"surface": 20, "density": 1025}
    assert "drag" not in told(CraneScene.parse(yaml.safe_dump(text)))
    text["bodies"][0]["drag"] = {"quadratic": [0, 0, 2.0e5]}
    assert "drag of the water is left out here" in told(CraneScene.parse(yaml.safe_dump(text)))


@pytest.mark.parametrize("name", ["hoist", "hookblock", "sixteen_falls", "slewing"])
def test_shipped_cranes_that_start_at_rest_are_told_nothing_of_their_start(name):
    of = CraneScene.read(DATA / f"{name}.yaml")
    jumps = jumps_of(estimate(of), compensation_of(of))
    assert max(jumps.front, jumps.swing, jumps.rise, jumps.drop, jumps.sway) == 0.0
