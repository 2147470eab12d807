"""A swinging string of four lumps, no wall: energy is kept, or what is lost and put in accounts for it."""

import itertools
from functools import cache

import numpy as np
import pytest

from drillstring.model.lumped_string import curve_of
from drillstring.well import wellbore
from tautline.integrators.linearise import start_moving
from tautline.integrators.method import method_for
from tautline.integrators.state import HALVINGS, ITERATIONS, STEPS, new_state
from tautline.integrators.status import Status
from tautline.integrators.time_loop import new_frames, run_steps
from tautline.lumped.bend import Bends, bend_slopes
from tautline.lumped.body import LUMP, EccentricBodies
from tautline.lumped.curve import PER_BODY
from tautline.lumped.link import SPRING, Links, link_slopes
from tautline.scene.functions import Constant, Harmonic, Ramp
from tautline.system.model import SolverSettings
from tautline.system.records import records
from tautline.system.system import Degrees, assemble
from tautline.system.time_functions import FunctionRequest, compile_functions

PLACES = np.array([0.5, 1.7, 3.0, 4.2, 5.5])
FULL = PER_BODY * PLACES.size
END = 1.6
WELLS = {
    "planar": wellbore.from_survey(np.array([0.0, 9.0]), np.array([0.0, 1.2]), np.array([0.6, 0.6])),
    "spatial": wellbore.from_survey(np.array([0.0, 9.0]), np.array([0.4, 1.3]), np.array([0.5, 2.0])),
    "three arcs": wellbore.from_survey(
        np.array([0.0, 2.2, 3.6, 9.0]), np.array([0.2, 0.2, 0.55, 1.2]), np.array([0.5, 0.5, 0.9, 1.4])
    ),
}
COUNTS = (80, 160, 320, 640)
LOWERED = 1.0


def string(well, block, damped, on_axis):
    """The string, displaced and moving; its top follows a function of time and turns at 0.5 rad/s.

    ``on_axis`` holds the lumps, then points of mass without bending, to the axis of the hole: nothing jumps at a joint.
    """
    n = PLACES.size
    curve = curve_of(WELLS[well], PLACES)
    drag = 0.15 if damped else 0.0
    mass = np.linspace(1.0, 1.6, n)
    lumps = records(
        n, LUMP, mass=mass, polar=0.3, lateral_mass=0.4 * mass, weight=3.0 * mass,
        transverse=0.0 if on_axis else 0.15, e1=0.0 if on_axis else 0.05, e2=0.0 if on_axis else -0.1,
        damping_along=drag, damping_across=2.0 * drag, damping_about=drag,
    )  # fmt: skip
    length = np.diff(PLACES)
    springs = records(n - 1, SPRING, length=length, axial=80.0 / length, torsional=3.0 / length)
    groups = (
        EccentricBodies(curve, lumps, np.zeros((3, 4, 4))),
        Links(curve, springs, 0.02 if damped else 0.0, link_slopes(), np.zeros((3, 6, 6))),
        Bends(curve, length, np.full(n - 2, 0.0 if on_axis else 4.0), 1.0, bend_slopes(), np.zeros((9, 9))),
    )
    functions = compile_functions([FunctionRequest(block), FunctionRequest(Constant(value=0.5), integrate=True)])
    rng = np.random.default_rng(1)
    value, speed = np.zeros((n, PER_BODY)), np.zeros((n, PER_BODY))
    offset = 0.0 if on_axis else 0.05
    value[1:, 1:3], speed[1:] = offset * rng.standard_normal((n - 1, 2)), 0.3 * rng.standard_normal((n - 1, PER_BODY))
    degrees = Degrees([str(i) for i in range(FULL)], value.ravel(), np.full(FULL, 10.0))
    degrees.prescribe(0, 0)
    degrees.prescribe(3, 1)
    for i in range(n if on_axis else 1):
        degrees.fix(PER_BODY * i + 1)
        degrees.fix(PER_BODY * i + 2)
    bodies = np.arange(FULL).reshape(n, PER_BODY)
    triples = np.concatenate([bodies[:-2], bodies[1:-1], bodies[2:]], axis=1)
    return assemble(groups, degrees, functions, speed.ravel(), [triples], [bodies])


@cache
def run(well, block, damped, steps, on_axis=False):
    """Frames of a run by generalized-alpha with rho_inf = 1, every step a frame, and its counters."""
    system = string(well, block, damped, on_axis)
    settings = SolverSettings("generalized-alpha", 0.0, END, END, 0.5, 0.5, tolerance=1e-11)
    method, state = method_for(system, settings), new_state(system)
    start_moving(system, state, 1e-3)
    frames = new_frames(steps + 1, FULL, 0)
    # The first frame, of no steps, is the start.
    each = np.minimum(np.arange(steps + 1), 1)
    ends = END * np.arange(steps + 1) / steps
    status, filled, _ = run_steps(method, system, state, ends, each, 0.0, frames)
    assert (Status(status), filled) == (Status.DONE, steps + 1)
    return frames.energy.copy(), frames.q.copy(), state.counters.copy()


def imbalance(energy):
    """Energy over the run that neither work nor loss explains, J."""
    kinetic, strain, potential, work, lost = energy.T
    total = kinetic + strain + potential - work + lost
    return np.abs(total - total[0]).max()


def order(errors):
    return -np.polyfit(np.log(COUNTS), np.log(errors), 1)[0]


STILL, SWING = Constant(value=0.0), Harmonic(amplitude=0.2, period=1.1, phase=0.7)


@pytest.mark.parametrize("well", ["planar", "spatial"])
def test_a_frictionless_undamped_string_keeps_its_energy_but_for_a_drift_that_falls_as_the_step_squared(well):
    runs = [run(well, STILL, False, n) for n in COUNTS]
    drift = [imbalance(energy) for energy, _, _ in runs]
    assert order(drift) == pytest.approx(2.0, abs=0.2)
    exchanged = np.ptp(runs[-1][0][:, 0])
    assert drift[-1] < 1e-4 * exchanged
    assert not np.any(runs[-1][0][:, 4])


@pytest.mark.parametrize("well", ["planar", "spatial"])
def test_work_of_the_moving_top_and_what_damping_takes_close_the_energy_balance_at_second_order(well):
    runs = [run(well, SWING, True, n) for n in COUNTS]
    gap = [imbalance(energy) for energy, _, _ in runs]
    assert order(gap) == pytest.approx(2.0, abs=0.2)
    energy = runs[-1][0]
    assert gap[-1] < 1e-3 * energy[-1, 4] and np.abs(energy[:, 3]).max() > 10 * gap[-1]
    assert np.all(np.diff(energy[:, 4]) >= 0.0)


LOWERING = Ramp(to=LOWERED, over=END)
JOINTS = WELLS["three arcs"].md[1:-1]


def crossings(positions):
    """(joint, lump) of every lump that passes the joint of two arcs."""
    depth = PLACES + positions[:, ::PER_BODY]
    return [(j, i) for j in range(JOINTS.size) for i, d in enumerate(depth.T) if d[0] < JOINTS[j] < d[-1]]


def test_lumps_on_the_axis_cross_the_joint_of_two_arcs_at_second_order():
    runs = [run("three arcs", LOWERING, True, n, on_axis=True) for n in COUNTS]
    assert len(crossings(runs[-1][1])) >= 2
    gaps = [imbalance(energy) for energy, _, _ in runs]
    assert order(gaps) == pytest.approx(2.0, abs=0.3)
    assert gaps[-1] < 1e-4 * runs[-1][0][-1, 4]


def test_lumps_off_the_axis_that_cross_the_joint_of_two_arcs_do_not_upset_the_run():
    """No step is halved, none takes many more iterations than on one arc, and the motion converges.

    A lump at (u, v) keeps its rate of depth across the joint, so its speed changes by the factor of the betas: the
    energy that appears or goes is of the order m s'^2 (u dk1 + v dk2), 1e-4 of its energy in a hole.
    """
    runs = [run("three arcs", LOWERING, True, n) for n in COUNTS]
    found = crossings(runs[-1][1])
    assert len(found) >= 2
    assert all(counters[HALVINGS] == 0 for _, _, counters in runs)
    single = [run("spatial", LOWERING, True, n)[2] for n in COUNTS]
    for (_, _, joint), one in zip(runs, single, strict=True):
        assert joint[ITERATIONS] / joint[STEPS] < 1.2 * one[ITERATIONS] / one[STEPS]
    ends = [positions[-1] for _, positions, _ in runs]
    steps = [np.abs(a - b).max() for a, b in itertools.pairwise(ends)]
    assert steps[2] < 0.6 * steps[1] < 0.36 * steps[0]
    energy, positions, _ = runs[-1]
    most = np.ptp(WELLS["three arcs"].k1) + np.ptp(WELLS["three arcs"].k2)
    offset = np.abs(positions.reshape(-1, PLACES.size, PER_BODY)[:, :, 1:3]).max()
    assert imbalance(energy) < 0.5 * most * offset * energy[:, 0].max() * len(found)
