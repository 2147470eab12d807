"""Ropes through which material runs steadily: where they come to rest, how they swing about it, and their energy.

Material that runs along a perfectly flexible rope adds m v^2 to its tension and leaves its shape what it is (Routh,
Advanced Rigid Dynamics, 1905, art. 597): a catenary has H = w a + m v^2. A string between two eyelets, whose waves run
at c, has the frequencies n (c^2 - v^2) / (2 L c) (Sack 1954). Linear elements err as the square of their length.
"""

from functools import cache

import numpy as np
import pytest
from of_the_suite import studies
from physics.cables.rope_text import GRAVITY, chain, element, model_of, node, scene, straight
from scipy.optimize import brentq

import tautline.cable.warnings  # noqa: F401  (its warnings are registered)
from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.linearise import start_moving
from tautline.integrators.state import new_state
from tautline.integrators.statics.equilibrium import find_equilibrium
from tautline.integrators.status import StoppedEarly
from tautline.integrators.vibration.vibrations import vibrations
from tautline.scene.warnings import warnings_of
from tautline.simulation import simulate

OVER = (1, 1, 1, 0, 0, 0, 0)
"""An eyelet: held in space, and material runs through it."""
HELD = (1, 1, 1, 0, 0, 0, 1)
LOOSE = (0,) * 7
KINDS = pytest.mark.parametrize("linear", [False, True], ids=["cubic", "linear"])


def through(xyz, p, speed, linear, **material):
    """Items of a rope between two eyelets, all of whose material runs at one speed, m/s of unstretched rope."""
    n, dof = len(p) - 1, 4 if linear else 7
    drives = {0: (0,) * (dof - 1) + (1,)}
    slopes = None if linear else np.gradient(xyz, p, axis=0, edge_order=2)
    held = {i: LOOSE for i in range(1, n)} | {0: HELD, n: OVER}
    items = chain(xyz, p, held, slopes=slopes, linear=linear, functions=drives, **material)
    for i in range(1, n + 1):
        items += follows(i, 0, p[i] - p[0], dof)
    return items + (
        f"  - Function_VelocityDefined: {{id: 1, pos0: {float(p[0])!r}, timeList: [0, 1000], "
        f"velocityList: [{float(speed)!r}, {float(speed)!r}]}}\n"
    )


def follows(slave, master, way, dof=7):
    """A p that is another's, and a constant."""
    masters = f"masters: [{{mNode: {master}, mDof: {dof}, factor: 1}}]"
    return f"  - LinearCoupl: {{id: {slave}, sNode: {slave}, sDof: {dof}, f0: {float(way)!r}, {masters}}}\n"


# where it comes to rest
SPAN, ROPE, MASS = 20.0, 25.0, 2.0


@cache
def catenary(n):
    """Places (n + 1, 3) and p of an inextensible rope over `SPAN`, and its horizontal force, N."""
    a = brentq(lambda a: 2 * a * np.sinh(0.5 * SPAN / a) - ROPE, 1.0, 100.0)
    p = np.linspace(0.0, ROPE, n + 1)
    x = a * np.arcsinh((p - 0.5 * ROPE) / a)
    return np.column_stack([x, 0.0 * x, a * np.cosh(x / a)]), p, MASS * GRAVITY * a


@KINDS
@pytest.mark.parametrize("start", ["static", *studies("relaxed")])
@pytest.mark.parametrize("speed", [15.0, *studies(0.0, 5.0)])
def test_a_catenary_that_flows_begins_with_w_a_and_m_v_squared_and_stands_still(linear, start, speed):
    xyz, p, force = catenary(12)
    items = through(xyz, p, speed, linear, EA=1.0e7, rhoA=MASS)
    result = simulate(model_of(items, start=start, time_step=0.01, time_end=0.2, plotpoints=4, rho_inf=0.9))
    middle = np.asarray(result["axial_force"])[:, 5:7].mean(axis=1)
    # measured 1.6e-3 (cubic) and 5.7e-3 (linear) of w a, at every speed
    assert middle == pytest.approx(np.full(middle.size, force + MASS * speed**2), abs=8e-3 * force)
    assert np.ptp(np.asarray(result["position"]), axis=0).max() < 1e-5


# how it swings
LENGTH, TENSION, EA = 10.0, 1000.0, 1.0e6
STRETCH = brentq(lambda x: 0.5 * EA * (x * x - 1.0) * x - TENSION, 1.0, 1.5)
WAVES = np.sqrt(TENSION / (1.0 / STRETCH))


@KINDS
@pytest.mark.parametrize("part", [0.5, 0.99, *studies(-0.5, 0.0)])
def test_a_string_that_runs_at_v_between_eyelets_has_frequencies_n_c2_less_v2_over_2_l_c(linear, part):
    n = 32
    p = np.linspace(0.0, LENGTH / STRETCH, n + 1)
    items = through(straight([0, 0, 0], [LENGTH, 0, 0], n), p, part * WAVES / STRETCH, linear, EA=EA)
    model = model_of(items, gravity=(0, 0, 0))
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    found = np.sort([one.imag for one in vibrations(model.system, state).value if one.imag > 1e-3])[:4]
    first = 2.0 * np.pi * (1.0 - part**2) * WAVES / (2.0 * LENGTH)
    # both planes alike; measured at most 1.1e-7 (cubic) and 1.3e-2 (linear, the second mode at 0.99 c)
    tolerance = 0.02 if linear else 1e-6
    assert found == pytest.approx(np.array([1, 1, 2, 2]) * first, rel=tolerance)


@pytest.mark.parametrize(("part", "length"), [(1.02, LENGTH / STRETCH), (0.0, 1.01 * LENGTH)], ids=["fast", "pressed"])
def test_a_string_that_is_refused_as_unstable_is_told_of_its_flow_where_it_has_one(part, length, monkeypatch):
    monkeypatch.setattr("tautline.integrators.statics.stability.LEAVING", ())
    monkeypatch.setattr("tautline.integrators.statics.stability.SHIFTS", ())
    p = np.linspace(0.0, length, 9)
    items = through(straight([0, 0, 0], [LENGTH, 0, 0], 8), p, part * WAVES / STRETCH, False, EA=EA)
    with pytest.raises(StoppedEarly, match="is unstable") as stop:
        simulate(model_of(items, gravity=(0, 0, 0), start="static"))
    words = "faster than waves run along a rope" in stop.value.sentence, "more slowly" in stop.value.sentence
    assert words == (part > 0.0, part > 0.0)


# its energy
def falling(speed, linear):
    """Result of a taut string that falls into its sag, in steps that do not follow its first mode."""
    n = 16
    p = np.linspace(0.0, LENGTH / STRETCH, n + 1)
    items = through(straight([0, 0, 0], [LENGTH, 0, 0], n), p, speed, linear, EA=EA)
    return simulate(model_of(items, time_step=0.1, time_end=2.0, plotpoints=20, rho_inf=0.5))


@KINDS
def test_the_energy_of_a_string_is_judged_alike_at_a_creeping_and_at_a_fast_flow(linear):
    # at a tenth of the waves' speed it moves alike, and the material has twenty times the energy of the fall
    creeping, flowing = (falling(speed, linear).attributes["energy_error"] for speed in (1.0e-6, 0.1 * WAVES))
    assert creeping > 0.1 and flowing == pytest.approx(creeping, rel=0.01)  # measured 2e-3 and 7e-4


# spans that are tied, each with one p for all of its nodes
KEYS = {"multiplier": "LagMultipl", "augmented": "AugLagrange", "penalty": "Penalty"}
WAYS = ("multiplier", "augmented")


def spans(n, linear, way, first, inner=LOOSE, angle=0.0, stretch=1.0, driven=False):
    """Items of two ropes of n elements each, in one line of 10 m, tied in the middle: r, r' and p.

    The p of all nodes of the first are those of node 0, of the second those of node n + 1. ``first`` is the BC of node
    0, ``inner`` that of nodes within the line; ``driven`` lets function 1 drive p of node 0.
    """
    dof, along = (4 if linear else 7), np.array([np.cos(angle), 0.0, -np.sin(angle)])
    held = {0: first, 2 * n + 1: OVER}
    items = ""
    for i in range(2 * n + 2):
        p = 5.0 * (i if i <= n else i - 1) / n / stretch
        bc = held.get(i, inner)
        bc = (*bc[:3], bc[6]) if linear else bc
        drive = (0,) * (dof - 1) + (1,) if driven and i == 0 else None
        items += node(i, stretch * p * along, None if linear else stretch * along, bc, p, drive)
        if i not in (0, n + 1):
            master = 0 if i <= n else n + 1
            items += follows(i, master, 5.0 * (i - master) / n / stretch, dof)
        if i not in (n, 2 * n + 1):
            items += element(i, i, i + 1, linear=linear, EA=1.0e5)
    for what in (0, 1) if linear else (0, 1, 2):
        items += f"  - {KEYS[way]}{dof}: {{id: {what}, nodes{dof}: [{n}, {n + 1}], constr: {what}}}\n"
    return items


@cache
def sag(stretch):
    """How far a rope of 1 kg/m and EA 1e5 N (Green) hangs down in the middle of 10 m, m: each half along its own p."""
    p, w = np.polynomial.legendre.leggauss(40)
    half = 5.0 / stretch
    p, w = 0.5 * half * (p + 1.0), 0.5 * half * w

    def stretched(force):
        """How much longer than its material a rope is under tensions, 0.5 EA (s^2 - 1) s."""
        return np.array([brentq(lambda s, N=N: 0.5e5 * (s * s - 1.0) * s - N, 1.0, 2.0) for N in force])

    def ways(H):
        """From the middle to an end, along and upwards."""
        V = GRAVITY * p
        N = np.hypot(H, V)
        return np.array([w @ (stretched(N) * H / N), w @ (stretched(N) * V / N)])

    return float(ways(brentq(lambda H: ways(H)[0] - 5.0, 1.0, 1e4))[1])


@KINDS
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("n", [8, 12, 40])
def test_spans_with_one_p_each_that_are_tied_in_p_hang_as_one_rope_on_any_mesh(n, way, linear):
    model = model_of(spans(n, linear, way, HELD, stretch=1.001))
    state = new_state(model.system)
    find_equilibrium(model.system, state, model.step_limit)
    deep = -state.full_q[n * (4 if linear else 7) + 2]
    assert deep == pytest.approx(sag(1.001), rel=0.3 / n**2 if linear else 1e-4)


@pytest.mark.parametrize("method", ["Newmark", "RK4"])
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("n", [8, 30])
def test_spans_whose_p_are_free_and_tied_begin_to_slide_together_with_g_sin_alpha(n, way, method):
    # p'' = -g sin(alpha) / stretch, as of one rope on an incline: both p are masters of many, and the tie of both
    angle, stretch = 0.5, 1.1
    model = model_of(spans(n, False, way, OVER, OVER, angle, stretch), type=method)
    state = new_state(model.system)
    start_moving(model.system, state, 1e-3)
    sliding = state.full_a[: 7 * (2 * n + 2)].reshape(-1, 7)[:, 6]
    assert sliding == pytest.approx(-GRAVITY * np.sin(angle) / stretch, rel=1e-9)


GROWING = "Function_VelocityDefined: {id: 1, pos0: 0, timeList: [0, 1], velocityList: [0, 3]}"
RUNNING = "Function_VelocityDefined: {id: 1, pos0: 0, timeList: [-1, 1], velocityList: [1, 5]}"
WAVING = "Function: {id: 1, value: {harmonic: {amplitude: 0.5, period: 2}}}"


def flow_warnings(items, dof=7):
    """What is said of ties of p of a scene, and with which rates of p nodes 4 and 5 begin to move."""
    made = parse(scene(items, gravity=(0, 0, 0)))
    told = [one.text for one in warnings_of("cable", made) if "on the other side of the tie" in one.text]
    system = build(made).system
    state = new_state(system)
    start_moving(system, state, 1e-3)
    return told, state.full_v[[5 * dof - 1, 6 * dof - 1]]


@KINDS
@pytest.mark.parametrize("way", [*WAYS, "penalty"])
@pytest.mark.parametrize("drive", [GROWING, RUNNING, WAVING], ids=["growing", "running", "waving"])
def test_a_tie_between_material_that_runs_and_material_that_stands_at_the_start_is_warned_of(drive, way, linear):
    items = spans(4, linear, way, HELD, stretch=1.001, driven=True) + f"  - {drive}\n"
    told, rates = flow_warnings(items, 4 if linear else 7)
    assert rates[1] == 0.0
    if rates[0] == 0.0:
        assert told == []
    else:
        (text,) = told
        assert f"at {rates[0]:.3g} m/s at node 4 " in text and "at 0 m/s at node 5," in text


def test_material_that_runs_through_a_coupling_of_p_is_not_warned_of():
    tied = spans(4, False, "multiplier", HELD, stretch=1.001, driven=True) + f"  - {RUNNING}\n"
    (tie,) = [line for line in tied.splitlines() if "constr: 1" in line]
    told, rates = flow_warnings(tied.replace(tie + "\n", follows(5, 4, 0.0)))
    assert told == [] and rates == pytest.approx([3.0, 3.0])
