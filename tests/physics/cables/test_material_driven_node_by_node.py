"""Material that functions of their own drive at every node of a rope: what flows on while a start at rest is found.

Routh's catenary: material that runs along a perfectly flexible rope at v adds m v^2 to its tension, H = w a + m v^2,
and leaves its shape what it is. Whoever drives it, it is one rope, and it stands still.
"""

import re

import numpy as np
import pytest
from of_the_suite import studies
from physics.cables.rope_text import GRAVITY, chain, model_of, scene, straight
from scipy.optimize import brentq

import tautline.cable.warnings  # noqa: F401  (its warnings are registered)
from tautline.cable.input.scene import parse
from tautline.errors import ArgumentError
from tautline.integrators.state import new_state
from tautline.integrators.vibration.modes import modes
from tautline.integrators.vibration.vibrations import vibrations
from tautline.scene.warnings import warnings_of
from tautline.simulation import simulate

SPAN, ROPE, MASS, SPEED, N = 20.0, 25.0, 2.0, 15.0, 12
A = brentq(lambda a: 2 * a * np.sinh(0.5 * SPAN / a) - ROPE, 1.0, 100.0)


def table(i, p, v):
    values = [p - v, p + 100.0 * v]
    return f"Function: {{id: {i}, value: {{table: {{time: [-1, 100], value: {values}, interpolation: linear}}}}}}"


def speeds(i, p, v):
    return f"Function_VelocityDefined: {{id: {i}, pos0: {p!r}, timeList: [0, {100 + i}], velocityList: [{v!r}, {v!r}]}}"


def wave(i, p, v, turning=1e-3):
    value = f"{{amplitude: {v / turning!r}, frequency: {turning / (2 * np.pi)!r}, mean: {p!r}}}"
    return f"Function: {{id: {i}, value: {{harmonic: {value}}}}}"


def waves(i, p, v):
    """One rate at t = 0 only."""
    return wave(i, p, v, 0.1 * i)


def mixed(i, p, v):
    return (table, speeds, wave)[i % 3](i, p, v)


def hanging(write, linear=False, rates=(SPEED,) * (N + 1)):
    """Items of a rope that hangs over `SPAN`; function i + 1 drives p of node i."""
    p = np.linspace(0.0, ROPE, N + 1)
    x = A * np.arcsinh((p - 0.5 * ROPE) / A)
    xyz = np.column_stack([x, 0.0 * x, A * np.cosh(x / A)])
    last = 3 if linear else 6
    held = {i: (0, 0, 0, 0, 0, 0, 1) for i in range(N + 1)} | dict.fromkeys((0, N), (1, 1, 1, 0, 0, 0, 1))
    drives = {i: (0,) * last + (i + 1,) for i in range(N + 1)}
    slopes = None if linear else np.gradient(xyz, p, axis=0, edge_order=2)
    items = chain(xyz, p, held, slopes=slopes, linear=linear, functions=drives, EA=1e7, rhoA=MASS)
    items = re.sub(", p: [^,}]*", "", items)  # the functions say it
    given = (f"  - {write(i + 1, float(p[i]), float(v))}\n" for i, v in enumerate(rates))
    return items + "".join(given)


@pytest.mark.parametrize("linear", [False, True], ids=["cubic", "linear"])
@pytest.mark.parametrize("write", [table, speeds, wave, mixed, waves])
def test_a_catenary_driven_at_one_rate_by_functions_of_each_node_begins_with_w_a_and_m_v_squared(write, linear):
    steady = write is not waves
    end = 0.1 if steady else 0.01
    result = simulate(
        model_of(hanging(write, linear), start="static", time_step=0.01, time_end=end, plotpoints=2, rho_inf=0.9)
    )
    middle = np.asarray(result["axial_force"])[0, 5:7].mean()
    # as where one function drives all: measured 1.6e-3 (cubic) and 5.7e-3 (linear) of w a
    assert middle == pytest.approx(MASS * GRAVITY * A + MASS * SPEED**2, abs=8e-3 * MASS * GRAVITY * A)
    if steady:
        assert np.ptp(np.asarray(result["position"]), axis=0).max() < 1e-5


@pytest.mark.parametrize("linear", [False, True], ids=["cubic", "linear"])
@pytest.mark.parametrize("faster", [[6], [N], [2, 5, 9]], ids=["middle", "end", "three"])
def test_a_catenary_with_nodes_that_run_half_a_percent_faster_begins_with_w_a_and_m_v_squared_everywhere(
    faster, linear
):
    rates = [SPEED * (1.005 if i in faster else 1.0) for i in range(N + 1)]
    result = simulate(
        model_of(hanging(speeds, linear, rates=rates), start="static", time_step=1e-3, time_end=1e-3, rho_inf=0.9)
    )
    alike = simulate(model_of(hanging(speeds, linear), start="static", time_step=1e-3, time_end=1e-3, rho_inf=0.9))
    force, even = (np.asarray(of["axial_force"])[0] for of in (result, alike))
    # One end taken to stand still is off by m v^2 = 450 N; a difference of 0.5 % of the speed is some 1 % of it.
    np.testing.assert_allclose(force, even, atol=0.02 * MASS * SPEED**2)
    assert force[5:7].mean() == pytest.approx(MASS * GRAVITY * A + MASS * SPEED**2, rel=0.01)


@pytest.mark.parametrize("start", ["static", *studies("relaxed")])
def test_a_string_driven_beyond_the_speed_of_its_waves_stretches_until_its_waves_are_as_fast(start):
    """Green's strain: N = EA (s^2 - 1) s/2, and N/s = m v^2 at last; at 2 % of stretch waves run at 4.49 m/s."""
    p, fast = np.linspace(0.0, 1.0, 9), 4.8
    held = dict.fromkeys(range(9), (0, 0, 0, 0, 0, 0, 1)) | dict.fromkeys((0, 8), (1, 1, 1, 0, 0, 0, 1))
    drives = {i: (0,) * 6 + (i + 1,) for i in range(9)}
    items = chain(straight([0, 0, 0], [1.02, 0, 0], 8), p, held, functions=drives, EA=1000.0)
    items += "".join(f"  - {speeds(i + 1, float(x), fast)}\n" for i, x in enumerate(p))
    result = simulate(model_of(items, gravity=(0, 0, 0), start=start, time_step=1e-3, time_end=1e-3))
    stretch = np.sqrt(1.0 + fast**2 / 500.0)
    assert np.asarray(result["axial_force"])[0, 3:5] == pytest.approx(stretch * fast**2, rel=1e-5)


def growing(i, p, v):
    return f"Function_VelocityDefined: {{id: {i}, pos0: {p!r}, timeList: [0, 1], velocityList: [0, {v!r}]}}"


APART = np.linspace(1.0, 1.0 + 0.1 * N, N + 1)


@pytest.mark.parametrize(
    ("write", "rates", "flows"),
    [
        (speeds, APART, 0),
        (speeds, (-1.0) ** np.arange(N + 1), 0),
        (growing, APART, 0),
        (speeds, 4.0 + 1e-9 * APART, N + 1),
        (speeds, [4.0, 4.0, *(4.0 + APART[2:])], 2),
    ],
    ids=["apart", "against each other", "from rest", "but for rounding", "one element"],
)
def test_material_flows_on_at_rest_only_through_elements_that_keep_their_length(write, rates, flows):
    system = model_of(hanging(write, rates=rates)).system
    assert system.dofs.flowing.tolist() == [7 * i + 6 for i in range(flows)]


def string(ratio):
    """A string of 1 m, stretched by 2 %, whose material runs at a share of its waves' speed; and that, m/s."""
    fast = np.sqrt(500.0 * (1.02**2 - 1.0))
    p = np.linspace(0.0, 1.0, 9)
    held = dict.fromkeys(range(9), (0, 0, 0, 0, 0, 0, 1)) | dict.fromkeys((0, 8), (1, 1, 1, 0, 0, 0, 1))
    drives = {i: (0,) * 6 + (i + 1,) for i in range(9)}
    items = chain(straight([0, 0, 0], [1.02, 0, 0], 8), p, held, functions=drives, EA=1000.0)
    items += "".join(f"  - {speeds(i + 1, float(x), float(ratio * fast))}\n" for i, x in enumerate(p))
    return model_of(items, gravity=(0, 0, 0), time_step=1e-3, time_end=1e-3).system, fast


@pytest.mark.parametrize("ratio", [0.3, 0.89])
def test_vibrations_of_a_travelling_string_are_slower_by_one_less_v2_over_c2_and_modes_refuses_it(ratio):
    """f1 = c (1 - v^2/c^2)/(2 L) of a string that travels between two eyelets (Skutch 1897)."""
    system, fast = string(ratio)
    state = new_state(system)
    first = vibrations(system, state, 1).value[0].imag / (2.0 * np.pi)
    assert first == pytest.approx(0.5 * fast * (1.0 - ratio**2), rel=1e-3)
    with pytest.raises(ArgumentError, match="Coriolis"):
        modes(system, state, 1)


def test_modes_of_a_string_that_stands_still_are_not_refused():
    system, fast = string(0.0)
    assert modes(system, new_state(system), 1).frequency[0] == pytest.approx(0.5 * fast, rel=1e-4)


def told(items, **solver):
    made = parse(scene(items, **solver))
    return [one.text for one in warnings_of("cable", made) if "material flow on" in one.text]


def test_material_that_flows_on_at_one_end_of_an_element_only_is_told_with_the_force_that_is_lost():
    rates = [SPEED] * 7 + [SPEED * (1.0 + 0.05 * k) for k in range(1, 7)]
    (text,) = told(hanging(speeds, rates=rates), start="static")
    assert "at 15 m/s at node 6," in text and "at node 7, whose 15.75 m/s" in text and "= 450 N" in text


def test_material_that_creeps_is_not_told_where_the_force_that_is_lost_is_next_to_none():
    rates = 1e-3 * np.array([SPEED] * 7 + [SPEED * (1.0 + 0.05 * k) for k in range(1, 7)])
    assert told(hanging(speeds, rates=rates), start="static") == []


def test_material_that_runs_up_to_a_node_where_it_is_fixed_is_not_told():
    """Its own rate is 0: it stands still where it should."""
    assert told(hanging(speeds, rates=[SPEED] * N + [0.0]), start="static") == []


@pytest.mark.parametrize("start", ["static", "relaxed"])
def test_rates_that_nearly_agree_are_told_with_both_where_rest_is_looked_for(start):
    rates = [4.0] * 6 + [4.004] + [4.0] * 6
    text = told(hanging(speeds, rates=rates), start=start)[0]
    assert "at 4 m/s at node 5 " in text and "at 4.004 m/s at node 6:" in text and "1 more like it" in text
    assert ("take start: static" in text) == (start == "relaxed")


@pytest.mark.parametrize("rates", [[4.0] * (N + 1), 4.0 + 1e-9 * APART, APART])
def test_rates_that_agree_or_are_far_apart_are_not_told(rates):
    assert told(hanging(speeds, rates=rates), start="static") == []


def test_rates_that_nearly_agree_are_not_told_where_a_run_begins_as_drawn():
    assert told(hanging(speeds, rates=4.0 + 1e-3 * APART)) == []


def test_material_that_one_function_moves_by_factors_that_nearly_agree_is_not_told():
    """Rope that is let out by one winch: each node goes on by its share."""
    items = hanging(speeds).replace("BC_functions: [0, 0, 0, 0, 0, 0, 13]", "BC_functions: [0, 0, 0, 0, 0, 0, 0]")
    last = items.index("Node7Dof: {id: 12,")
    items = items[:last] + items[last:].replace("BC: [1, 1, 1, 0, 0, 0, 1]", "BC: [1, 1, 1, 0, 0, 0, 0]", 1)
    share = "{mNode: 11, mDof: 7, factor: 1.001}"
    gap = ROPE - 1.001 * ROPE * 11 / N
    items += f"  - LinearCoupl: {{id: 1, sNode: 12, sDof: 7, f0: {gap!r}, masters: [{share}]}}\n"
    assert told(items, start="static") == []
