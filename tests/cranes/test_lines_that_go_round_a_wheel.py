"""Ropes whose line turns about a drum or a sheave by more than half a turn: no turn of rope comes or goes."""

import numpy as np
import pytest
from cranes.groups.test_bends import FRAME, chain
from physics.lifting.crane_scenes import anchor, body, crane, drum, end, ran, sheave, stopped

import tautline
from crane.geometry.line import PATH, WHEEL, find_line
from crane.groups.span import new_spans
from tautline.integrators.status import Status
from tautline.kernels.jit import entry

EA, RADIUS, FAR = 1.0e5, 0.4, 5.0
STRAIGHT = float(np.sqrt(FAR**2 - RADIUS**2))
ROPE = {"mass_per_length": 2.0, "axial_stiffness": EA, "damping": 1.0e-3, "strain": "engineering"}


def about_a_drum(turned, over, length, elements=1, **more):
    """An anchor, `FAR` beside a drum that stands still, is carried about it."""
    return crane(
        [drum((0.0, 0.0, 10.0), RADIUS), anchor((-FAR, 0.0, 10.0), name="hook", frame="boom")],
        rope=ROPE | {"length": length},
        frames=[{"name": "boom", "pivot": [0, 0, 10], "luff": {"ramp": {"to": turned, "over": over}}}],
        gravity=[0, 0, -0.01],
        mesh={"elements_per_span": elements},
        solver={"end": over},
        interval=0.1,
        **more,
    )


def tension(result):
    """Tension at the begin of the rope, N, at each frame."""
    return np.asarray(result["tension"]).reshape(len(result["time"]), -1)[:, 0]


def wound_by(time, turned, over):
    """Angle of the ramp's quintic, rad."""
    x = time / over
    return turned * x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


@pytest.mark.parametrize("turned", [-4.5, -9.0])
def test_rope_is_laid_on_a_drum_about_which_its_end_is_carried_round(turned):
    """T = EA (Lambda / L0 - 1), Lambda = sqrt(r^2 - R^2) + R phi; the rope's mass adds under 1 N at this speed."""
    length = STRAIGHT - 4.0e-3
    result = ran(about_a_drum(turned, 10.0, length))
    phi = np.abs(wound_by(result["time"], turned, 10.0))
    expected = EA * ((STRAIGHT + RADIUS * phi) / length - 1.0)
    assert np.abs(phi).max() > np.pi
    assert tension(result) == pytest.approx(expected, rel=2.0e-3, abs=30.0)


def test_rope_that_is_unwound_by_more_than_half_a_turn_stays_slack():
    result = ran(about_a_drum(4.5, 10.0, STRAIGHT - 4.0e-3))
    assert np.all(result["tension"][result["time"] > 3.0] == 0.0)


def test_the_wrap_of_a_sheave_grows_beyond_half_a_turn_of_either_side():
    """The end is carried about the sheave: T = EA (Lambda / L0 - 1), Lambda grown by R phi."""
    path = [
        drum((5.0, 0.0, 10.0), RADIUS),
        sheave((0.0, 0.0, 10.0), RADIUS, name="s"),
        anchor((0.2, 0.0, 6.0), name="hook", frame="boom"),
    ]
    scene = crane(
        path, rope=ROPE, gravity=[0, 0, -0.01], mesh={"elements_per_span": 1}, solver={"end": 10.0}, interval=0.1,
        frames=[{"name": "boom", "pivot": [0, 0, 10], "luff": {"ramp": {"to": -4.0, "over": 10.0}}}],
    )  # fmt: skip
    result = ran(scene)
    wrap, phi = np.asarray(result["wrap_angle"])[:, 0], np.abs(wound_by(result["time"], -4.0, 10.0))
    assert wrap == pytest.approx(wrap[0] + phi, abs=0.02)
    straight = 5.0 + np.sqrt(0.2**2 + 4.0**2 - RADIUS**2)
    before = straight + RADIUS * wrap[0]
    taut = phi > 0.5
    assert tension(result)[taut] == pytest.approx(EA * RADIUS * phi[taut] / before, rel=0.02)


@pytest.mark.parametrize("turned", [3.6, -14.0])
def test_a_load_hangs_on_from_a_boom_that_slews_round_its_winch(turned):
    """By half a turn and more: the rope at the winch is laid on or off by R phi, and the load goes up or down by it."""
    path = [
        drum((0.0, 0.0, 20.4), RADIUS, wrap="left", axis=(0, 0, 1)),
        sheave((12.0, 0.0, 20.0), RADIUS, frame="boom", name="tip"),
        end("load"),
    ]
    scene = crane(
        path, [body("load", 2000.0, (12.4, 0.0, 5.0))], rope=ROPE | {"axial_stiffness": 1.0e7},
        frames=[{"name": "boom", "pivot": [0, 0, 10], "slew": {"ramp": {"to": turned, "over": 120.0}}}],
        solver={"end": 120.0, "step": 0.02}, interval=0.5, mesh={"elements_per_span": 1},
    )  # fmt: skip
    result = ran(scene)
    phi, height = wound_by(result["time"], turned, 120.0), np.asarray(result["body_position"])[:, 0, 2]
    assert height - height[0] == pytest.approx(-np.sign(height[0] - height[-1]) * RADIUS * np.abs(phi), abs=0.1)
    assert np.abs(height[-1] - height[0]) == pytest.approx(RADIUS * abs(turned), abs=0.05)
    weight = 2000.0 * 9.81
    assert np.asarray(result["tension"]) == pytest.approx(weight, rel=0.05)


def test_a_node_that_is_wound_onto_a_wheel_is_named():
    """Of a span of four elements the first has a quarter of the rope, which R phi reaches."""
    stop = stopped(about_a_drum(-4.5, 10.0, STRAIGHT - 4.0e-3, elements=4), Status.NO_LENGTH)
    assert "beside winch" in str(stop) and "fewer elements" in str(stop)
    laid = RADIUS * abs(wound_by(stop.time, -4.5, 10.0))
    assert laid == pytest.approx((STRAIGHT + laid) / 4.0, rel=0.06)


def test_a_run_that_goes_on_behind_half_a_turn_knows_its_turns(tmp_path):
    scene = about_a_drum(-9.0, 10.0, STRAIGHT - 4.0e-3)
    whole = tautline.simulate(scene)
    first = tautline.simulate(scene, tmp_path / "first.nc", end=6.0)
    assert np.array_equal(tautline.simulate(scene, resume=first)["tension"], whole["tension"])
    sim = tautline.Simulation(scene)
    sim.advance_to(6.0)
    kept = sim.save()
    sim.advance_to(8.0)
    there = float(np.ravel(sim["tension"])[0])
    other = tautline.Simulation(scene)
    other.restore(kept)
    other.advance_to(8.0)
    assert float(np.ravel(other["tension"])[0]) == there == pytest.approx(float(tension(whole)[80]), rel=1.0e-9)


@entry
def _path(g, q, n):
    s = g.rows[n]
    find_line(s.a, s.b, s.wheel1, s.wheel2, g.wheels, q, q, g.start[n], g.turned[n], g.line)
    return g.line.number[PATH]


def test_an_attempt_that_goes_wild_leaves_no_turn_behind():
    """An end is tried at 0, 100, 200 and 300 degrees about a wheel; what counts is where it was accepted."""
    wheels = np.zeros(1, WHEEL)
    wheels[0] = (0, RADIUS, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), 0)
    group = new_spans(chain(1, (0, -1), axial=1.0, start=FRAME), wheels.view(np.recarray))
    q = np.zeros(FRAME + 8)
    q[3:12] = np.eye(3).ravel()
    paths = []
    for degrees in (0.0, 100.0, 200.0, 300.0, 0.0):
        angle = np.radians(degrees)
        q[FRAME + 4 : FRAME + 7] = FAR * np.cos(angle), 0.0, FAR * np.sin(angle)
        paths.append(_path(group, q, 0))
    assert paths[-1] == pytest.approx(paths[0], abs=1.0e-12)
