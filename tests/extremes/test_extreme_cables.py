"""Ropes at the edge of what makes sense: right, or a named error; never NaN in what is stored, never silent.

Every run is judged: all that it stores is finite, its energy balances, and it is near a closed form or an invariant.
Lengths are 1 m, masses 1 kg/m and gravity 9.81 m/s2 where nothing else is said.
"""

from itertools import pairwise

import numpy as np
import pytest
from references import cables
from scipy.special import ellipk

from tautline.cable.input.scene import parse
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.vibration.modes import modes
from tautline.scene.errors import SceneError
from tautline.simulation import simulate

GRAVITY = 9.81
HELD, FREE, ALL_FREE = (1, 1, 1, 0, 0, 0, 1), (0, 0, 0, 0, 0, 0, 1), (0,) * 7
DOWN, ALONG = (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)
METHODS = ("RK4", "G-alpha", "Newmark")


# scenes
def _entry(key, **fields):
    inside = ", ".join(f"{name}: {list(x) if isinstance(x, (tuple, np.ndarray)) else x}" for name, x in fields.items())
    return f"{key}: {{{inside}}}".replace("'", "")


def node(i, xyz, slope, bc=FREE, **more):
    return _entry("Node7Dof", id=i, xyz=[float(x) for x in xyz], xyz_d=[float(x) for x in slope], BC=bc, **more)


def element(i, **fields):
    return _entry(
        "CableALEelement", id=i, nodes7=[i, i + 1], **({"EA": 1e4, "EJ": 0.0, "rhoA": 1.0, "cDamp": 0.0} | fields)
    )


def motion(i, start, times, rates):
    return _entry("Function_VelocityDefined", id=i, pos0=start, timeList=times, velocityList=rates)


def scene(items, gravity=0.0, method="G-alpha", **solver):
    """Text of a scene; frames are kept of every step unless ``plotpoints`` says less."""
    solver = {"type": method, "time_step": 1e-3, "time_end": 0.1, "plotpoints": 0} | solver
    lines = "".join(f"  - {item}\n" for item in items)
    return (
        f"CableModelMaterial: {{Gravity: [0, 0, {-gravity}]}}\nCableModel:\n{lines}"
        + _entry("GeneralizedAlpha", **solver)
        + "\n"
    )


def line(lengths, direction, first=HELD, last=FREE, stretch=1.0, **material):
    """A straight rope of elements of some lengths from the origin, stretched or slack."""
    p, d = np.concatenate([[0.0], np.cumsum(lengths)]), np.asarray(direction)
    ends = {0: first, p.size - 1: last}
    nodes = [node(i, stretch * x * d, stretch * d, ends.get(i, FREE), p=float(x)) for i, x in enumerate(p)]
    return nodes + [element(i, **material) for i in range(p.size - 1)]


def judged(text, energy=1e-6):
    """Run a scene to its end; everything that it stores is finite and its energy balances."""
    model = build(parse(text))
    result = simulate(model)
    _all_finite(model, result)
    assert result.attributes["status"] == "done"
    assert result.attributes["energy_error"] <= energy
    return result


def stopped(text, *statuses, finite=True):
    """Run a scene that stops early with one of some statuses; what it stored until then is finite."""
    model = build(parse(text))
    with pytest.raises(StoppedEarly) as stop:
        simulate(model)
    assert stop.value.status in statuses
    assert stop.value.part and stop.value.sentence
    if finite and stop.value.result is not None:
        _all_finite(model, stop.value.result)
    return stop.value


def _all_finite(model, result):
    for variable in model.variables:
        assert np.isfinite(result[variable.name]).all(), variable.name


def total(result):
    return result["kinetic_energy"] + result["strain_energy"] + result["potential_energy"]


# stiffness and length
EVEN, SHORT_FIRST, SHORT_INSIDE = (0.25,) * 4, (1e-4, 1.0 - 1e-4), (0.5, 5e-5, 0.5 - 5e-5)


@pytest.mark.parametrize("lengths", [EVEN, SHORT_FIRST, SHORT_INSIDE], ids=["even", "1:1e4", "1e4:1:1e4"])
@pytest.mark.parametrize("EA", [1e3, 1e6, 1e9, 1e12])
def test_a_rope_hangs_in_its_weight_from_a_stiffness_of_1e3_to_1e12_and_elements_10_000_times_longer(EA, lengths):
    """Tip to 1e-9 m, force to 1e-6 and rounding: strain is known to eps / L_e, force to EA times that."""
    text = scene(line(lengths, DOWN, EA=EA), GRAVITY, start="static", time_end=0.005)
    # Where the rope does not move, what goes through it is rounding.
    result = judged(text, energy=1e-2)
    p = np.concatenate([[0.0], np.cumsum(lengths)])
    depth, _ = cables.hanging_rope(p, 1.0, EA, GRAVITY, strain="green")
    assert -result["position"][-1, :, 2] == pytest.approx(depth, abs=1e-9)
    below = GRAVITY * (1.0 - 0.5 * (p[1:] + p[:-1]))
    rounding = 8.0 * np.finfo(float).eps * EA / np.diff(p)
    assert np.all(np.abs(result["axial_force"][-1] - below) < 1e-5 * below + rounding)
    assert np.ptp(result["position"], axis=0).max() < 1e-12


def test_a_rope_that_its_weight_stretches_to_almost_three_times_its_length_hangs_as_the_closed_form_says():
    # four elements of EA = 1 N: within 3e-4 of a depth of 2.4 m
    result = judged(scene(line(EVEN, DOWN, EA=1.0), GRAVITY, start="static", time_end=0.005))
    depth, _ = cables.hanging_rope(np.linspace(0, 1, 5), 1.0, 1.0, GRAVITY, strain="green")
    assert -result["position"][-1, :, 2] == pytest.approx(depth, abs=3e-4)


def test_with_elements_10_000_times_longer_that_stretch_is_found():
    # next to all of it is one element: within 2e-3
    result = judged(scene(line(SHORT_FIRST, DOWN, EA=1.0), GRAVITY, start="static", time_end=0.005), energy=1e-2)
    depth, _ = cables.hanging_rope(1.0, 1.0, 1.0, GRAVITY, strain="green")
    assert -result["position"][-1, -1, 2] == pytest.approx(depth, rel=3e-3)


@pytest.mark.parametrize("EA", [1.0, 1e6, 1e12])
def test_elements_10_000_times_longer_leave_the_lowest_axial_frequency(EA):
    # sqrt(EA/m) / (4 L) Hz; a cubic element or two have it to 0.1 %
    model = build(parse(scene(line((1e-4, 0.5 - 1e-4, 0.5), ALONG, EA=EA))))
    found = modes(model.system, new_state(model.system))
    exact = 0.25 * np.sqrt(EA)
    axial = np.abs(found.shape[[14, 21]]).max(axis=0) > 1e-3
    assert found.frequency[axial & (found.frequency > 1e-3 * exact)].min() == pytest.approx(exact, rel=1e-3)


@pytest.mark.parametrize("lengths", [SHORT_FIRST, SHORT_INSIDE])
def test_the_explicit_method_names_the_step_that_a_short_element_asks_for(lengths):
    stop = stopped(scene(line(lengths, ALONG, EA=1e6), method="RK4", time_step=1e-5), Status.UNSTABLE)
    assert "critical step" in stop.sentence


# nothing to do
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("EJ", [0.0, 1.0])
def test_a_straight_rope_without_gravity_stays_where_it_is(method, EJ):
    text = scene(line(EVEN, (0.6, 0.0, 0.8), last=HELD, EA=1e3, EJ=EJ, cDamp=1e-5), method=method, time_step=1e-4)
    result = judged(text, energy=np.inf)
    assert np.abs(result["position"] - result["position"][0]).max() < 1e-12
    assert np.abs(result["axial_force"]).max() < 1e-9
    assert np.abs(result["velocity"]).max() < 1e-9


def test_a_rope_without_any_load_has_no_energy_error():
    result = judged(scene(line(EVEN, (0.6, 0.0, 0.8), last=HELD, EA=1e3)), energy=np.inf)
    assert np.abs(total(result)).max() < 1e-25
    assert result.attributes["energy_error"] < 1e-6


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("EA", [1.0, 1e12])
def test_a_slack_rope_falls_as_a_stone(method, EA):
    # z = -g t^2 / 2 to rounding: every method integrates it exactly, and EA does not act
    text = scene(line(EVEN, ALONG, FREE, FREE, 0.7, EA=EA, compression="false"), GRAVITY, method, time_end=0.2)
    result = judged(text)
    fallen = -0.5 * GRAVITY * result.time[:, None] ** 2
    assert np.abs(result["position"][:, :, 2] - fallen).max() < 1e-13
    assert not result["axial_force"].any()


# folded
def test_a_rope_folded_back_on_itself_hangs_double():
    """A hinge at the fold: both halves lie in one line, and each carries its own weight."""
    half = np.array([0.0, 0.25, 0.5])
    nodes = [node(i, (0, 0, -x), DOWN, HELD if i == 0 else FREE, p=float(x)) for i, x in enumerate(half)]
    nodes += [
        node(3 + i, (0, 0, x - 0.5), (0, 0, 1), HELD if i == 2 else FREE, p=float(0.5 + x)) for i, x in enumerate(half)
    ]
    hinge = ["LagMultipl7: {id: 1, nodes7: [2, 3], constr: 0}"]
    items = nodes + [element(i, EA=1e5) for i in (0, 1, 3, 4)] + hinge
    result = judged(scene(items, GRAVITY, start="static", time_end=0.05), energy=1e-2)
    depth, _ = cables.hanging_rope(half, 0.5, 1e5, GRAVITY, strain="green")
    assert -result["position"][-1, :3, 2] == pytest.approx(depth, abs=1e-10)
    assert -result["position"][-1, 3:, 2] == pytest.approx(depth[::-1], abs=1e-10)
    assert np.abs(result["multiplier"][-1]).max() < 1e-6
    assert np.abs(result["position"][..., :2]).max() < 1e-12


@pytest.mark.parametrize("strain", ["green", "engineering"])
@pytest.mark.parametrize("EJ", [0.0, 1e-3])
@pytest.mark.parametrize(("method", "step"), [("Newmark", 1e-4), ("Newmark", 1e-3), ("G-alpha", 1e-3), ("RK4", 1e-3)])
def test_a_rope_with_a_fold_inside_an_element_moves_on_with_its_energy_or_stops_by_name(strain, EJ, method, step):
    # the slope turns round inside one element: 100 J and more per kilogramme are let go at once
    folded = [node(0, (0, 0, 0), DOWN, HELD, p=0.0), node(1, (0, 0, -0.5), (0, 1, 0), p=0.5)]
    folded += [node(2, (0, 0.01, 0.0), (0, 0, 1), p=1.0)]
    items = folded + [element(i, EA=1e3, EJ=EJ, strain=strain) for i in range(2)]
    text = scene(items, GRAVITY, method, time_step=step, time_end=0.05, plotpoints=200)
    try:
        judged(text, energy=1e-2 if step < 1e-3 else 0.05)
    except StoppedEarly as stop:
        assert stop.status in (Status.NOT_CONVERGED, Status.NOT_FINITE, Status.UNSTABLE, Status.IMBALANCE)


def _point_of_no_direction(**material):
    """An element whose slope is zero in its middle, which is a point of integration."""
    return [node(0, (0, 0, 0), ALONG, HELD, p=0.0), node(1, (0, 0, 0), (-1, 0, 0), p=1.0), element(0, **material)]


@pytest.mark.parametrize("material", [{"strain": "engineering"}, {"EJ": 1e-3}, {"EJ": 1e-3, "compression": "false"}])
@pytest.mark.parametrize("method", ["RK4", "G-alpha"])
@pytest.mark.filterwarnings("ignore:invalid value encountered in divide:RuntimeWarning")
def test_where_a_rope_has_no_direction_engineering_strain_and_bending_stop_by_name(method, material):
    text = scene(_point_of_no_direction(EA=1e3, **material), method=method, time_step=1e-4)
    stopped(text, Status.NOT_FINITE, Status.UNSTABLE, finite=False)


@pytest.mark.filterwarnings("ignore:invalid value encountered in divide:RuntimeWarning")
@pytest.mark.parametrize("material", [{"strain": "engineering"}, {"EJ": 1e-3}])
def test_a_run_that_stops_there_has_stored_no_nan(material):
    stopped(scene(_point_of_no_direction(EA=1e3, **material), time_step=1e-4), Status.NOT_FINITE)


@pytest.mark.filterwarnings("ignore:invalid value encountered in divide:RuntimeWarning")
def test_where_a_rope_has_no_direction_greens_strain_goes_on():
    judged(scene(_point_of_no_direction(EA=1e3), time_step=1e-4, time_end=0.01), energy=1e-2)


# masses
def pendulum(EA, rope, mass, elements=1, angle=0.1, **solver):
    """A weight on a rope, drawn as far as the pull stretches it: it begins to swing without ringing."""
    d = np.array([np.sin(angle), 0.0, -np.cos(angle)])
    stretch = float(cables.stretch_of(mass * GRAVITY * np.cos(angle), EA, "green"))
    items = line((1.0 / elements,) * elements, d, stretch=stretch, EA=EA, rhoA=rope)
    return scene([*items, f"PointMass: {{id: 0, nodes7: [{elements}], mass: {mass}}}"], GRAVITY, **solver)


def period(result):
    """Four times the time to the first passage through the vertical, s."""
    x, t = result["position"][:, -1, 0], result.time
    k = int(np.flatnonzero(x[1:] * x[:-1] < 0.0)[0])
    return 4.0 * (t[k] - x[k] * (t[k + 1] - t[k]) / (x[k + 1] - x[k]))


PERIOD = 4.0 * np.sqrt(1.0 / GRAVITY) * ellipk(np.sin(0.05) ** 2)
"""Of a mathematical pendulum of 1 m let go at 0.1 rad, s."""


@pytest.mark.parametrize("rho_inf", [0.0, 0.6])
@pytest.mark.parametrize("elements", [1, 2])
@pytest.mark.parametrize("EA", [1e6, 1e9])
def test_a_weight_a_million_times_heavier_than_its_rope_swings_as_the_mathematical_pendulum(EA, elements, rho_inf):
    # 1e-4 of the period: the stretch of 1e-5, and the step
    text = pendulum(EA, 1e-6, 1.0, elements, rho_inf=rho_inf, time_step=2e-3, time_end=0.52, maxIter=200)
    result = judged(text, energy=5e-3)
    assert period(result) == pytest.approx(PERIOD, rel=1e-4)
    arm = np.linalg.norm(result["position"][:, -1], axis=-1)
    assert arm == pytest.approx(1.0, abs=1e-4)


def test_where_iterations_run_out_what_is_stored_until_the_run_stops_is_right():
    # the same with 20 iterations: 200 need no halving and swing as they should; the whole energy is 10 J
    model = build(parse(pendulum(1e9, 1e-6, 1.0, rho_inf=0.6, time_step=2e-3, time_end=0.52)))
    try:
        result = simulate(model)
    except StoppedEarly as stop:
        result = stop.result
    energy = total(result)
    assert np.abs(energy - energy[0]).max() < 1e-3


def test_a_weight_a_million_times_lighter_than_its_rope_does_not_count():
    solver = {"rho_inf": 0.6, "time_step": 2e-3, "time_end": 0.1}
    with_it = judged(pendulum(1e4, 1.0, 1e-6, 2, **solver), energy=1e-2)
    without = judged(pendulum(1e4, 1.0, 0.0, 2, **solver).replace("mass: 0.0", "mass: 1e-30"), energy=1e-2)
    assert np.abs(with_it["position"] - without["position"]).max() < 1e-5


# methods and steps
@pytest.mark.parametrize("rho_inf", [0.0, 1.0])
def test_both_ends_of_rho_inf_swing_a_weight_on_a_heavy_rope_alike(rho_inf):
    """The mathematical pendulum, integrated here: 2e-4 m after 0.5 s on a rope of a thousandth of the mass."""
    text = pendulum(1e4, 1e-3, 1.0, 1, rho_inf=rho_inf, time_step=1e-3, time_end=0.5)
    result = judged(text, energy=5e-3)
    assert result["position"][-1, -1, 0] == pytest.approx(_swung(0.5), abs=2e-4)


def _swung(t):
    """Position x of the mathematical pendulum at time t, by its equation, m."""
    from scipy.integrate import solve_ivp

    made = solve_ivp(lambda _, y: (y[1], -GRAVITY * np.sin(y[0])), (0.0, t), (0.1, 0.0), rtol=1e-10, atol=1e-12)
    return float(np.sin(made.y[0, -1]))


@pytest.mark.parametrize("method", METHODS)
def test_steps_of_a_microsecond_add_up(method):
    # a rope that hangs still, and 2e-5 s of a free fall, to rounding
    falling = scene(line(EVEN, ALONG, FREE, FREE, EA=1e4), GRAVITY, method, time_step=1e-6, time_end=2e-5)
    result = judged(falling, energy=1e-4)
    assert result.time.size == 21
    assert result["velocity"][-1, :, 2] == pytest.approx(-GRAVITY * 2e-5, rel=1e-9)
    assert np.abs(result["axial_force"]).max() < 1e-6


@pytest.mark.parametrize("method", ["G-alpha", "Newmark"])
def test_a_rope_that_hangs_still_does_so_in_steps_of_a_second(method):
    text = scene(line(EVEN, DOWN), GRAVITY, method, start="static", time_step=1.0, time_end=20.0)
    result = judged(text, energy=1e-2)
    assert np.ptp(result["position"], axis=0).max() < 1e-9
    assert np.ptp(result["axial_force"], axis=0).max() < 1e-5


def test_a_swinging_rope_in_steps_of_a_second_stops_by_name():
    d = (np.sin(1.0), 0.0, -np.cos(1.0))
    stopped(scene(line(EVEN, d), GRAVITY, time_step=1.0, time_end=20.0), Status.NOT_CONVERGED, Status.NOT_FINITE)
    rk4 = scene(line(EVEN, d), GRAVITY, "RK4", time_step=1.0, time_end=20.0)
    assert "critical step" in stopped(rk4, Status.UNSTABLE).sentence


# moving material
def even_p(count):
    """Couplings that spread p evenly between the first and last node of a rope."""
    return [
        f"LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: 0, masters: ["
        f"{{mNode: 0, mDof: 7, factor: {1.0 - i / count}}}, {{mNode: {count}, mDof: 7, factor: {i / count}}}]}}"
        for i in range(1, count)
    ]


def drawn_rope(times, rates, elements=4, stretch=1.05, **material):
    """A straight stretched rope between two fixed points through which its material is drawn at a given rate."""
    nodes = []
    for i in range(elements + 1):
        x, end = i / elements, i in (0, elements)
        functions = {"BC_functions": [0] * 6 + [1 if i == 0 else 2]} if end else {"p": x}
        nodes.append(node(i, (stretch * x, 0, 0), (stretch, 0, 0), HELD if end else ALL_FREE, **functions))
    parts = [element(i, **({"EA": 1e6} | material)) for i in range(elements)]
    return nodes + parts + even_p(elements) + [motion(1, 0.0, times, rates), motion(2, 1.0, times, rates)]


TENSION = float(cables.force_of(1.05, 1e6, "green"))
"""Of the drawn rope at rest, N."""


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("EJ", [0.0, 1.0])
def test_200_m_per_s_through_a_straight_rope_change_nothing(method, EJ):
    # no particle is accelerated: the force stays that of the stretch to 1e-11
    step = 1e-5 if method == "RK4" else 1e-4
    items = drawn_rope([0, 100], [200.0, 200.0], EJ=EJ, cDamp=1e-5)
    result = judged(scene(items, 0.0, method, time_step=step, time_end=0.02, plotpoints=1000))
    assert result["axial_force"] == pytest.approx(TENSION, rel=1e-11)
    assert result["material_coordinate"][:, 0] == pytest.approx(200.0 * result.time, abs=1e-12)
    assert np.abs(result["position"] - result["position"][0]).max() < 1e-12


def test_faster_than_its_waves_a_sagging_rope_keeps_its_energy_or_stops_by_name():
    """m v^2 = 40 kN against a pull of 5 kN: v is three times the speed of transverse waves."""
    items = drawn_rope([0, 100], [200.0, 200.0], EA=1e5, EJ=1.0)
    text = scene(items, GRAVITY, "Newmark", time_step=2e-5, time_end=0.01, plotpoints=1000)
    try:
        judged(text, energy=1e-3)
    except StoppedEarly as stop:
        assert stop.status in (Status.NOT_CONVERGED, Status.NOT_FINITE, Status.UNSTABLE)


@pytest.mark.parametrize("damping", [0.0, 1e-5])
@pytest.mark.parametrize("gravity", [0.0, GRAVITY])
def test_p_that_runs_to_200_m_per_s_and_back_pulls_one_way_and_then_the_other(gravity, damping):
    """dN/dp = m times the acceleration, -p.. r': over 7/8 m it is 9188 N, in the mean of each ramp to 5 %."""
    times, rates = [0, 0.02, 0.04, 0.06, 0.08, 100], [0, 200.0, 0.0, -200.0, 0.0, 0.0]
    items = drawn_rope(times, rates, 8, cDamp=damping)
    text = scene(items, gravity, "Newmark", time_step=1e-4, time_end=0.08, plotpoints=5000)
    result = judged(text, energy=1e-2)
    assert result["material_coordinate"][-1, [0, -1]] == pytest.approx([0.0, 1.0], abs=1e-12)
    assert result["material_velocity"].max() == pytest.approx(200.0)
    assert result["material_velocity"].min() == pytest.approx(-200.0)
    pull = result["axial_force"][:, -1] - result["axial_force"][:, 0]
    for (start, stop), acceleration in zip(pairwise(times[:5]), (1e4, -1e4, -1e4, 1e4), strict=True):
        during = (result.time > start) & (result.time < stop)
        assert pull[during].mean() == pytest.approx(-acceleration * 1.05 * 7 / 8, rel=0.05)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("EJ", [0.0, 1.0])
def test_a_rope_let_go_through_two_points_falls_freely_to_200_m_per_s(method, EJ):
    """p of all nodes is one unknown; in a field of 2000 m/s2 every particle falls freely: p = -g t^2 / 2, no force."""
    count = 4
    nodes = [
        node(i, (0, 0, -i / count), DOWN, (1, 1, 1, 0, 0, 0, 0) if i in (0, count) else ALL_FREE, p=i / count)
        for i in range(count + 1)
    ]
    follow = [
        f"LinearCoupl: {{id: {i}, sNode: {i}, sDof: 7, f0: {i / count}, masters: [{{mNode: 0, mDof: 7, factor: 1}}]}}"
        for i in range(1, count + 1)
    ]
    items = nodes + [element(i, EA=1e6, EJ=EJ) for i in range(count)] + follow
    step = 4e-5 if method == "RK4" else 5e-4
    result = judged(scene(items, 2000.0, method, time_step=step, time_end=0.1, plotpoints=200))
    assert result["material_velocity"][-1] == pytest.approx(-200.0, rel=1e-9)
    assert result["material_coordinate"][:, 0] == pytest.approx(-1000.0 * result.time**2, abs=1e-9)
    assert np.abs(result["axial_force"]).max() < 1e-3
    assert np.abs(result["position"] - result["position"][0]).max() < 1e-9


def _sliding_linear_rope(count=6):
    """An inclined rope of linear elements that slides through its two end points."""
    nodes = [
        _entry("Node4Dof", id=i, xyz=[0.8 * i / count, 0.0, -0.6 * i / count],
               BC=(1, 1, 1, 0) if i in (0, count) else (0, 0, 0, 0), p=i / count)
        for i in range(count + 1)
    ]  # fmt: skip
    parts = [_entry("CableALEelementLin", id=i, nodes4=[i, i + 1], EA=1e4, rhoA=1.0, cDamp=0.0) for i in range(count)]
    follow = [
        f"LinearCoupl: {{id: {i}, sNode: {i}, sDof: 4, f0: {i / count}, masters: [{{mNode: 0, mDof: 4, factor: 1}}]}}"
        for i in range(1, count + 1)
    ]
    return nodes + parts + follow


def test_an_inclined_rope_of_linear_elements_begins_to_slide_with_g_sin_alpha():
    # p.. = -g sin(alpha) = -5.886 m/s2 while it sags little: 2 % of the path after 0.1 s
    result = judged(scene(_sliding_linear_rope(), GRAVITY, "RK4", time_step=1e-4), energy=1e-2)
    assert result["material_coordinate"][-1, 0] == pytest.approx(-0.5 * 0.6 * GRAVITY * 0.01, rel=0.02)


def test_a_sliding_rope_of_linear_elements_balances_its_energy():
    # RK4: that of cubic elements is 1e-10
    judged(scene(_sliding_linear_rope(), GRAVITY, "RK4", time_step=1e-4, time_end=1.0, plotpoints=100), energy=1e-6)


# reeled in to nothing
def reeled(rate, elements, last, **solver):
    """A rope whose material is drawn in at its end, faster than there is any left of the last element."""
    nodes = [node(0, (0, 0, 0), ALONG, HELD, p=0.0)]
    nodes += [node(i, (i, 0, 0), ALONG, p=float(i)) for i in range(1, elements)]
    nodes += [node(elements, (elements, 0, 0), ALONG, last, BC_functions=[0] * 6 + [1])]
    material = {name: solver.pop(name) for name in ("EA", "EJ", "cDamp", "strain", "compression") if name in solver}
    items = nodes + [element(i, **({"EA": 1e3, "cDamp": 1e-3} | material)) for i in range(elements)]
    return scene([*items, motion(1, float(elements), [0, 100], [rate, rate])], **({"plotpoints": 200} | solver))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("elements", [1, 2])
def test_an_element_that_is_reeled_in_to_nothing_stops_by_name(method, elements):
    # the length is zero to rounding at 1 s, where no implicit step gets past; before that RK4's step is too long
    step = 1e-4 if method == "RK4" else 1e-3
    ends = (Status.UNSTABLE, Status.NO_LENGTH) if method == "RK4" else (Status.NO_LENGTH,)
    stop = stopped(reeled(-1.0, elements, HELD, method=method, time_step=step, time_end=2.0), *ends)
    assert stop.time < 1.0
    assert np.diff(stop.result["material_coordinate"], axis=1).min() > 0.0


PAST_NOTHING = {
    "a free end": dict(rate=-1.01, elements=1, last=FREE),
    "a free end of two elements with bending": dict(rate=-1.01, elements=2, last=HELD, EJ=0.1, gravity=GRAVITY),
    "a slack rope": dict(rate=-1.01, elements=1, last=FREE, compression="false"),
    "engineering strain between fixed ends": dict(rate=-1.01, elements=1, last=HELD, strain="engineering"),
    "long steps": dict(rate=-1.51, elements=1, last=HELD, time_step=1e-2),
}


@pytest.mark.parametrize("case", PAST_NOTHING)
def test_no_step_goes_past_an_element_of_no_length(case):
    given = dict(PAST_NOTHING[case])
    text = reeled(given.pop("rate"), given.pop("elements"), given.pop("last"), time_end=1.2, **given)
    stop = stopped(text, *Status)
    assert np.diff(stop.result["material_coordinate"], axis=1).min() > 0.0


def test_a_scene_that_begins_with_an_element_of_no_length_is_refused_by_name():
    items = [node(0, (0, 0, 0), ALONG, HELD, p=1.0), node(1, (1, 0, 0), ALONG, p=1.0), element(0)]
    with pytest.raises(SceneError, match=r"nothing is left|must grow"):
        build(parse(scene(items)))
