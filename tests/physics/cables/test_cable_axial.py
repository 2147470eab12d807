"""Case 1 of the thesis: axial vibrations of bars of cubic elements, against `references.cables` and by hand.

Unless a test says otherwise EA = 1000 N, rhoA = 1 kg/m, length 1 m, so the speed of sound is S = 31.623 m/s.

Misprints of Table 2.1, which its other columns and eq. 2.151, h_max = 2.8 L_eff/(2 S), show: p/p 1 has omega 204.9
rad/s and not 244.9 (its L_eff 0.31, its h_max 13.7 ms and +/+ 2, the same motion, agree on it; 244.9 is f/f 4); p/p 2
has h_max 28.0 ms and not 20.8; +/- 2, the same motion as p/p 2, has omega 100.0 and not 99.9.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from of_the_suite import studies
from physics.cables.axial_bars import (
    JOINTS,
    bar,
    cantilever,
    coupling,
    first_mode,
    fitted_frequency,
    highest_peaks,
    march_unchecked,
    model_of,
    natural_frequencies,
    period_of,
    rk4_factor,
    run,
    split_cantilever,
)
from references import cables
from scipy.linalg import eigh

from tautline.cable.application import Cable
from tautline.cable.input.scene import parse, read, with_values
from tautline.cable.model.build import build
from tautline.integrators.state import new_state
from tautline.integrators.status import Status, StoppedEarly
from tautline.integrators.vibration.modes import modes
from tautline.simulation import simulate

CASE_1 = Path(__file__).parents[3] / "data" / "cantilever_bar.yaml"
LINES = [0.2500, 0.7506, 1.2637, 1.8493, 3.0732]
"""Frequencies [Hz] of two elements with EA = 1 N: `cables.hammer().frequencies`, their highest 3.1 Hz in Fig. 2.22."""
THESIS_ALPHAS = {"alpha_m": -0.05, "alpha_f": 0.10}


# Table 2.1
TABLE = {
    # L_eff/L_e to four figures; omega [rad/s] and h_max [ms] as printed, misprints put right; fastest first
    "f/f": ([0.1533, 0.2582, 0.6364], [412.5, 244.9, 99.37], [6.8, 11.4, 28.2]),
    "p/f": ([0.1914, 0.4135, 1.2732], [330.4, 152.9, 49.7], [8.5, 18.3, 56.3]),
    "p/p": ([0.3086, 0.6325], [204.9, 100.0], [13.7, 28.0]),
    "+/-": ([0.6325, 0.6362], [100.0, 99.4], [28.0, 28.2]),
    "+/+": ([0.3086], [204.9], [13.7]),
}


def single_element(name, EA=1000.0, length=1.0, rhoA=1.0):
    """Items of a row of Table 2.1; the patterns of eqs 2.152-2.153 slave one end's unknowns to the other's."""
    ends = {"f/f": ("free", "free"), "p/f": ("pinned", "free"), "p/p": ("pinned", "pinned")}.get(name, ("free", "free"))
    items = bar(ends, EA=EA, length=length, rhoA=rhoA)
    if name in ("+/-", "+/+"):
        sign = -1.0 if name == "+/-" else 1.0
        for dof, at_rest in ((1, length), (4, 1 - sign)):
            items.append(coupling(dof, (1, dof), (0, dof), sign, at_rest))
    return items


def deforming(name, **bar_of):
    """Angular frequencies [rad/s] of a row of Table 2.1, fastest first, without the rigid motion."""
    omega = 2 * np.pi * natural_frequencies(single_element(name, **bar_of))[::-1]
    rigid = omega < 1e-6 * omega[0]
    assert rigid.sum() == (name in ("f/f", "+/+"))
    return omega[~rigid]


@pytest.mark.parametrize("name", TABLE)
def test_one_element_has_the_frequencies_and_steps_of_table_2_1(name):
    # source: Table 2.1; tolerance: its last printed digit (56.3 ms is cut off, not rounded: 56.36)
    lengths, omegas, steps = TABLE[name]
    omega = deforming(name)
    assert omega == pytest.approx(omegas, abs=0.06)
    assert 2.8e3 / omega == pytest.approx(steps, abs=0.07)
    assert 2 * np.sqrt(1000.0) / omega == pytest.approx(lengths, abs=5e-5)


@pytest.mark.parametrize(("EA", "length", "rhoA"), [(1000.0, 1.0, 1.0), (7.0, 0.25, 3.0), (2e9, 40.0, 30.0)])
@pytest.mark.parametrize("name", TABLE)
def test_effective_lengths_are_those_of_the_exact_matrices_whatever_the_bar_is_made_of(name, EA, length, rhoA):
    # source: `effective_lengths`, exact integrals; measured 1e-14
    omega = deforming(name, EA=EA, length=length, rhoA=rhoA)
    found = 2 * np.sqrt(EA / rhoA) / (omega * length)
    assert found == pytest.approx(cables.effective_lengths()[name], rel=1e-11)


@pytest.mark.parametrize(
    ("name", "places", "shape"),
    # full degrees of freedom: r x y z, r' x y z, p of each node
    [
        ("f/f", (0, 3, 7, 10), (-0.06, 0.71, 0.06, 0.71)),
        ("p/f", (3, 7, 10), (0.38, 0.10, 0.92)),
        ("p/p", (3, 10), (0.71, 0.71)),
    ],
)
def test_fastest_mode_of_one_element_has_the_shape_of_eqs_2_146_to_2_148(name, places, shape):
    model = model_of(single_element(name))
    found = modes(model.system, new_state(model.system)).shape[list(places), -1]
    found *= np.sign(found[-1]) / np.linalg.norm(found)
    assert found == pytest.approx(shape, abs=0.006)


# the hammer test, EA = 1 N
def hammer_test(**solver):
    """Result of data/cantilever_bar.yaml with other values of the solver."""
    values = {("GeneralizedAlpha", key): (value, key) for key, value in solver.items()}
    return simulate(build(with_values(read(CASE_1), values)))


@pytest.fixture(scope="module")
def swing():
    """The shipped run of 100 s once the hammer has let go: times, displacement of the tip, force of element 1."""
    result = hammer_test()
    after = result["time"] >= 1.0 - 1e-9
    return result["time"][after], result["position"][after, 2, 0] - 1.0, result["axial_force"][after, 1]


@pytest.mark.parametrize("what", ["displacement of the tip", "axial force"])
def test_hammer_test_shows_the_five_lines_of_two_elements(swing, what):
    # Fig. 2.22; the five highest peaks are the modes, those of the nonlinear strain stay below; resolution 1/(99 s)
    t, tip, force = swing
    found = highest_peaks(t, tip if "tip" in what else force, 5)
    assert found == pytest.approx(LINES, abs=1 / (t[-1] - t[0]))
    assert round(found[-1], 1) == 3.1


def tip_error(duration=1.0, points=3, **solver):
    """Largest difference of the tip [m] from `hammer_green` in six seconds, 50 frames a second."""
    result = hammer_test(time_end=6.0, plotpoints=50, **solver)
    exact = green(duration, points)
    return np.abs(result["position"][:, 2, 0] - 1.0 - exact[:, -2]).max()


@cache
def green(duration, points):
    return cables.hammer_green(np.arange(301) / 50, duration=duration, points=points)


def test_rk4_follows_the_hammered_bar_with_green_strain_at_fourth_order():
    # `hammer_green` with the three Gauss points of the production element, DOP853 to 1e-13; the tip moves 11 mm.
    # measured: 4.50e-7, 2.81e-8, 1.76e-9 m for steps of 10, 5, 2.5 ms, order 4.00
    coarse, middle, fine = (tip_error(time_step=h) for h in (0.01, 0.005, 0.0025))
    assert fine < 2e-9
    assert np.log2([coarse / middle, middle / fine]) == pytest.approx([4, 4], abs=0.05)


def test_three_gauss_points_move_the_hammered_tip_by_less_than_one_part_in_two_thousand():
    # the force of Green strain has degree 8, exact with 5 points; measured 3.4e-6 m of 11 mm
    assert 1e-6 < tip_error(points=5, time_step=0.0025) < 5e-6


def test_axial_force_and_slopes_of_the_hammered_bar_are_those_of_the_reference():
    # force in the middle of element 1: EA stretch (stretch^2 - 1)/2 with the stretch of the cubic; measured 6e-9 N
    result = hammer_test(time_end=6.0, plotpoints=50, time_step=0.0025)
    exact = green(1.0, 3)
    assert result["slope"][:, :, 0] - 1 == pytest.approx(exact[:, [0, 2, 4]], abs=1e-7)
    stretch = 1 + 3 * (exact[:, 3] - exact[:, 1]) - (exact[:, 2] + exact[:, 4]) / 4
    assert result["axial_force"][:, 1] == pytest.approx(cables.force_of(stretch, 1.0, "green"), abs=1e-7)


IMPLICIT = {"Newmark": {"type": "Newmark"}, "generalized-alpha": {"type": "G-alpha"}}


@pytest.mark.parametrize("method", IMPLICIT)
def test_implicit_methods_follow_the_hammered_bar_at_second_order(method):
    # the force stops at the end of a step, where it counts by half
    steps = (0.005, 0.0025, 0.00125)
    errors = [tip_error(duration=1.0, time_step=h, **IMPLICIT[method]) for h in steps]
    assert errors[-1] < 4e-6
    assert -np.diff(np.log2(errors)) == pytest.approx([2, 2], abs=0.1)


@pytest.mark.parametrize("method", ["RK4", "Newmark", "G-alpha"])
@pytest.mark.parametrize(
    "interval",
    [(0.0, 0.003), (0.0, 0.006), (0.0, 0.01), (0.003, 0.02), (0.004, 0.017), (0.0099, 0.02), (0.02, 0.023)],
)
def test_a_force_that_begins_or_ends_within_the_first_step_leaves_its_impulse_behind(method, interval):
    """The mean of a free bar's velocity is F over its mass times how long F acted; steps of 10 ms. Its energy balances,
    or the run would not come to its end."""
    begin, end = interval
    items = [
        "Node7Dof: {id: 0, xyz: [0, 0, 0], xyz_d: [1, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1]}",
        "Node7Dof: {id: 1, xyz: [1, 0, 0], xyz_d: [1, 0, 0], BC: [0, 0, 0, 0, 0, 0, 1]}",
        "CableALEelement: {id: 0, nodes7: [0, 1], EA: 10, EJ: 0, rhoA: 2}",
        f"PointForce: {{id: 0, nodes7: [1], force: [0.01, 0, 0], timeInterval: [{begin}, {end}]}}",
    ]
    rho = "" if method == "RK4" else ", rho_inf: 1.0" if method == "G-alpha" else ""
    text = "CableModelMaterial: {Gravity: [0, 0, 0]}\nCableModel:\n" + "".join(f"  - {item}\n" for item in items)
    text += f"GeneralizedAlpha: {{type: {method}, time_step: 0.01, time_end: 0.2{rho}}}\n"
    result = simulate(build(parse(text)))
    mean = cubic_mean(result)
    found = (mean[-1] - mean[-2]) / (result.time[-1] - result.time[-2])
    assert found == pytest.approx(0.01 * (end - begin) / 2.0, rel=1e-6)


BLOWS = [(0.0, 1e-3), (2e-3, 3e-3), (0.2, 0.2001), (0.2033, 0.2043), (0.301, 0.3012), (0.2, 0.22)]
"""When a force acts, in runs whose steps are chosen and no longer than 10 ms."""


def hit_mass(interval, **solver):
    """A free mass of 2 kg that is hit by 0.2 N s; the bound on its steps' error, 1e-5 m, changes them at the blow."""
    begin, end = interval
    given = {"type": "G-alpha", "time_step": 0.01, "time_end": 0.5, "control": "error", "tolerance": 1e-5} | solver
    force = 0.2 / (end - begin)
    items = [
        "Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1]}",
        "Node4Dof: {id: 1, xyz: [1, 0, 0], BC: [0, 0, 0, 1]}",
        "CableALEelementLin: {id: 0, nodes4: [0, 1], EA: 1.0e-9, rhoA: 0}",
        "PointMass: {id: 0, nodes4: [1], mass: 2}",
        f"PointForce: {{id: 0, nodes4: [1], force: [{force:.16g}, 0, 0], timeInterval: [{begin}, {end}]}}",
    ]
    text = "CableModelMaterial: {Gravity: [0, 0, 0]}\nCableModel:\n" + "".join(f"  - {item}\n" for item in items)
    return parse(text + f"GeneralizedAlpha: {{{', '.join(f'{key}: {value}' for key, value in given.items())}}}\n")


@pytest.mark.parametrize("interval", BLOWS)
@pytest.mark.parametrize("solver", [{"type": "Newmark"}, {"rho_inf": 1.0}], ids=["Newmark", "rho_inf 1"])
def test_a_blow_shorter_than_steps_that_change_leaves_its_impulse_behind(solver, interval):
    # half of it was lost from 0 to 1 ms, and all of it from 0.2033 to 0.2043 s
    result = simulate(build(hit_mass(interval, **solver)))
    assert result["velocity"][-1, 1, 0] == pytest.approx(0.1, rel=1e-8)


@pytest.mark.parametrize("interval", BLOWS)
def test_a_blow_in_a_damped_run_whose_steps_change_is_warned_of_where_its_impulse_is_off(interval):
    scene = hit_mass(interval, rho_inf=0.8)
    try:
        found = simulate(build(scene))["velocity"][-1, 1, 0]
    except StoppedEarly as stop:
        assert stop.status == Status.IMBALANCE
        found = stop.result["velocity"][-1, 1, 0]
    assert found == pytest.approx(0.1, rel=0.12)
    told = [str(one) for one in Cable().warnings(scene) if "impulse" in str(one)]
    assert told or found == pytest.approx(0.1, rel=2e-3)
    exact = hit_mass(interval, type="Newmark")
    assert not [str(one) for one in Cable().warnings(exact) if "impulse" in str(one)]


def cubic_mean(result):
    """Mean of x over the material of one cubic element of 1 m: (x0 + x1) / 2 + (x0' - x1') / 12."""
    x, slope = result["position"][:, :, 0], result["slope"][:, :, 0]
    return (x[:, 0] + x[:, 1]) / 2.0 + (slope[:, 0] - slope[:, 1]) / 12.0


@pytest.mark.parametrize("method", ["RK4", "Newmark", "G-alpha"])
def test_a_blow_leaves_its_impulse_behind(method):
    # a free bar of 1 kg, hit with 10 mN for 1 s, drifts at 10 mm/s: F T/m
    free = [
        *bar(["free", "free"], EA=1.0),
        "PointForce: {id: 0, nodes7: [1], force: [0.01, 0, 0], timeInterval: [0, 1]}",
    ]
    result = run(free, type=method, time_step=0.01, time_end=3.0)
    (x1, x2), (s1, s2) = result["position"][:, :, 0].T, result["slope"][:, :, 0].T
    centre = (x1 + x2) / 2 + (s1 - s2) / 12
    after = result["time"] > 1.5
    assert np.polyfit(result["time"][after], centre[after], 1)[0] == pytest.approx(0.01, rel=1e-6)


# the mirror of the hammer test: positions held, material free
# A particle's displacement is u = r(p, t) - p. Where a node holds r = P and p = P + w is free, its displacement is
# u(p) = P - p = -w, and its slope u' is r' - 1: to first order the same cubic through the same unknowns as with p held,
# so the same mass and stiffness and the same frequencies. About a uniform stretch L, u = -L w with the tangent
# stiffness EA (3 L^2 - 1)/2 of Green strain. (The tip is an open end here: it is at rest where N = 0 and L = 1 only.)
@pytest.mark.parametrize("moving", ["free", "flowing"])
def test_bar_has_the_same_frequencies_whether_its_nodes_or_its_material_move(moving):
    # thesis section 2.5.1; measured 1e-14
    found = natural_frequencies(bar(["pinned", moving, moving], EA=1.0))
    assert found == pytest.approx(LINES, abs=5e-5)
    assert found == pytest.approx(cables.hermite_bar_frequencies(2, 1.0, 1.0, 1.0), rel=1e-10)


@pytest.mark.parametrize("stretch", [0.9, 1.0, 1.1])
@pytest.mark.parametrize("count", [2, 4])
@pytest.mark.parametrize("moving", ["free", "flowing"])
def test_stretched_bar_has_the_same_frequencies_whether_its_nodes_or_its_material_move(moving, count, stretch):
    ends = ["pinned", *(count - 1) * [moving], "pinned"]
    places = stretch * np.linspace(0.0, 1.0, count + 1)
    found = natural_frequencies(bar(ends, positions=places, slopes=np.full(count + 1, stretch)))
    stiffness = 1000.0 * (3 * stretch**2 - 1) / 2
    exact = cables.hermite_bar_frequencies(count, stiffness, 1.0, 1.0, held=(0, 2 * count))
    assert found == pytest.approx(exact, rel=1e-10)


def test_material_that_moves_through_fixed_nodes_is_the_mirror_of_nodes_that_move():
    # slopes disturbed by 1e-6, all else at rest; superposition of the modes of `hermite_bar`. Measured 2e-12 m of
    # 1.5e-7 m and 1.2e-11 of 1e-6: the disturbance squared, and RK4
    slopes = 1 + 1e-6 * np.array([1.0, -0.5, 0.8])
    ends = ["pinned", "flowing", "flowing"]
    result = run(bar(ends, slopes=slopes, EA=1.0), time_step=0.0025, time_end=10.0, plotpoints=50)
    stiffness, mass = (matrix[1:, 1:] for matrix in cables.hermite_bar(2, 1.0, 1.0, 1.0))
    squares, shapes = eigh(stiffness, mass)
    start = np.array([slopes[0] - 1, 0.0, slopes[1] - 1, 0.0, slopes[2] - 1])
    motion = np.cos(np.outer(result["time"], np.sqrt(squares))) * (shapes.T @ mass @ start) @ shapes.T
    u = np.array([0.0, 0.5, 1.0]) - result["material_coordinate"]
    assert np.ptp(u[:, 2]) > 1e-7
    assert u[:, 1:] == pytest.approx(motion[:, [1, 3]], abs=1e-11)
    assert result["slope"][:, :, 0] - 1 == pytest.approx(motion[:, [0, 2, 4]], abs=1e-10)


def test_material_shaken_through_fixed_nodes_shows_the_five_lines():
    # as the thesis does it: the pinned end is moved, by 0.5 mm and back in half a second, then held
    items = bar(["pinned", "flowing", "flowing"], EA=1.0)
    items[0] = items[0][:-1] + ", BC_functions: [1, 0, 0, 0, 0, 0, 0]}"
    shake = "timeList: [0, 0.125, 0.375, 0.5, 200], velocityList: [0, 0.004, -0.004, 0, 0]"
    items.append(f"Function_VelocityDefined: {{id: 1, pos0: 0, {shake}}}")
    result = run(items, time_step=0.01, time_end=100.0, plotpoints=100)
    after = result["time"] >= 1.0 - 1e-9
    t = result["time"][after]
    for signal in (result["material_coordinate"][after, 2], result["axial_force"][after, 1]):
        assert highest_peaks(t, signal, 5) == pytest.approx(LINES, abs=1 / (t[-1] - t[0]))


# the longest step of RK4
MESHES = (1, 2, 4, 8, 16)
CRITICAL = dict(zip(MESHES, (8.5615, 4.6320, 2.3414, 1.1709, 0.58546), strict=True))
"""2 sqrt 2/omega_max [ms] of n elements."""


def jagged(count, amplitude):
    """Slopes that alternate: all of the fast modes are in them."""
    return 1 + amplitude * (-1.0) ** np.arange(count + 1)


@pytest.mark.parametrize("count", MESHES)
def test_critical_step_is_that_of_the_fastest_mode(count):
    # sources: the figures, to their last digit, and `mesh_highest_frequency` exactly
    omega = 2 * np.pi * natural_frequencies(cantilever(count))[-1]
    assert 1e3 * 2 * np.sqrt(2) / omega == pytest.approx(CRITICAL[count], rel=2e-5)
    assert omega == pytest.approx(cables.mesh_highest_frequency(count, EA=1000.0), rel=1e-10)


@pytest.mark.parametrize("count", MESHES)
def test_rk4_runs_below_its_critical_step_and_is_stopped_at_once_beyond(count):
    # 0.99 * 2.828 = 2.7997 passes the limit of 2.8 of eq. 2.137, if only just; 1.02 * 2.828 does not
    omega = cables.mesh_highest_frequency(count, EA=1000.0)
    items = cantilever(count, slopes=jagged(count, 1e-6))
    below, beyond = 0.99 * 2.828 / omega, 1.02 * 2.828 / omega
    result = run(items, time_step=float(below), time_end=float(2000 * below))
    assert result.attributes["status"] == "done"
    assert np.abs(result["slope"][-1, :, 0] - 1).max() < 1e-6
    with pytest.raises(StoppedEarly) as stop:
        run(items, time_step=float(beyond), time_end=float(2000 * beyond))
    assert stop.value.status == Status.UNSTABLE
    assert stop.value.time == 0.0


@pytest.mark.parametrize("ratio", [0.99, 0.999, 1.001, 1.02])
@pytest.mark.parametrize("count", MESHES)
def test_unchecked_rk4_grows_beyond_the_critical_step_and_only_there(count, ratio):
    # past the check of the step: energy of the jagged bar after 2000 steps; nothing may grow below
    step = ratio * 2 * np.sqrt(2) / cables.mesh_highest_frequency(count, EA=1000.0)
    _, q, energy = march_unchecked(cantilever(count, slopes=jagged(count, 1e-9)), step, 2000)
    if ratio < 1:
        assert len(energy) == 2001
        assert energy.max() <= energy[0] * (1 + 1e-6)
        assert np.abs(q - q[0]).max() < 3e-9
    else:
        assert energy.max() > 1e4 * energy[0]


@pytest.mark.parametrize("count", MESHES)
def test_unchecked_rk4_grows_by_the_factor_of_the_taylor_polynomial(count):
    # |R(i omega h)| = 1.1503 a step at 1.02 times the critical one, while the strain is small; measured to 2.4e-6
    step = 1.02 * 2 * np.sqrt(2) / cables.mesh_highest_frequency(count, EA=1000.0)
    _, _, energy = march_unchecked(cantilever(count, slopes=jagged(count, 1e-9)), step, 80)
    assert (energy[80] / energy[50]) ** (1 / 60) == pytest.approx(abs(rk4_factor(1.02 * 2 * np.sqrt(2))), rel=2e-5)


@pytest.mark.parametrize("count", MESHES)
def test_unchecked_rk4_turns_the_bar_inside_out_beyond_the_critical_step(count):
    # engineering strain: the bar is linear until a slope is zero, so 1e-6 grows beyond 1; measured 6.6 to 9.0.
    # It need not grow on from there: detuned by its own strain the fastest mode is stable again (with Green strain at
    # strains of a tenth). A limit of speeds or displacements may never notice, so the step is what is checked
    step = 1.02 * 2 * np.sqrt(2) / cables.mesh_highest_frequency(count, EA=1000.0)
    items = cantilever(count, slopes=jagged(count, 1e-6), strain="engineering")
    _, q, _ = march_unchecked(items, step, 2000)
    assert np.abs(q - q[0]).max() > 3.0


# the first frequency through every integrator and every joint
FIRST = {1: 7.906234, 2: 7.905709, 4: 7.905694}
"""Hz; the bar itself has sqrt(EA/rhoA)/4 = 7.905694."""
ROUNDED = 5e-7
SOLVERS = {
    "RK4": {"type": "RK4"},
    "Newmark": {"type": "Newmark"},
    "generalized-alpha": {"type": "G-alpha", **THESIS_ALPHAS},
    "generalized-alpha 0.8": {"type": "G-alpha", "alpha_m": 0.6 / 1.8, "alpha_f": 0.8 / 1.8},
}


def vibration(items, solver, step):
    """Frequency [Hz] of the tip in a run of one second, and the same freed of the method's own error of the period."""
    result = run(items, time_step=step, time_end=1.0, plotpoints=500, eps_energy=1e-12, **SOLVERS[solver])
    seen = fitted_frequency(result["time"], result["position"][:, -1, 0] - 1.0, FIRST[4])
    omega = 2 * np.pi * FIRST[4]
    own = {key: value for key, value in SOLVERS[solver].items() if key != "type"}
    return seen, seen * period_of(SOLVERS[solver]["type"], omega, step, **own) * omega / (2 * np.pi)


@pytest.mark.parametrize("count", FIRST)
def test_first_frequency_of_one_two_and_four_elements(count):
    assert natural_frequencies(cantilever(count))[0] == pytest.approx(FIRST[count], abs=ROUNDED)


@pytest.mark.parametrize("count", [2, *studies(1, 4)])
@pytest.mark.parametrize("solver", SOLVERS)
def test_first_frequency_through_every_integrator(solver, count):
    # start: the first mode, 10 um at the tip. Implicit methods lengthen the period by 2.1e-6 to 2.9e-6 at this step,
    # `period_of`; freed of that, measured within 1.7e-8
    _, u, slope = first_mode(count)
    items = cantilever(count, positions=np.linspace(0, 1, count + 1) + 1e-5 * u, slopes=1 + 1e-5 * slope)
    seen, freed = vibration(items, solver, 1e-4)
    assert seen == pytest.approx(FIRST[count], rel=4e-6)
    assert freed == pytest.approx(FIRST[count], abs=ROUNDED + 3e-7)


STIFF = 1e7


@pytest.mark.parametrize("count", [2, 4])
@pytest.mark.parametrize("way", JOINTS)
def test_first_frequency_of_a_bar_split_and_joined_in_its_middle(way, count):
    # penalty: softer by the compliance of springs 5000 EA/L_e stiff and more, -5e-5; measured within 4e-9 of two halves
    # on springs, the rounding of eigenvalues that are 1e7 apart
    found = natural_frequencies(split_cantilever(count, way, STIFF))[0]
    if way == "penalty":
        assert found == pytest.approx(first_mode(count, STIFF)[0], rel=2e-8)
        assert FIRST[count] * (1 - 1e-4) < found < FIRST[count] - ROUNDED
    else:
        assert found == pytest.approx(FIRST[count], abs=ROUNDED)


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e9])
def test_penalty_springs_lower_the_first_frequency_as_two_halves_on_springs_do(stiffness):
    found = natural_frequencies(split_cantilever(2, "penalty", stiffness))[0]
    assert found == pytest.approx(first_mode(2, stiffness)[0], rel=1e-6)


@pytest.mark.parametrize("solver", list(SOLVERS)[:3])
@pytest.mark.parametrize("way", JOINTS)
def test_first_frequency_through_every_integrator_and_joint(way, solver):
    # as above, measured within 1.7e-8; springs of 1e5 N/m, which RK4 can run at this step
    springs = 1e5
    _, freed = vibration(split_cantilever(2, way, springs, amplitude=1e-5), solver, 5e-5)
    expected = first_mode(2, springs)[0] if way == "penalty" else FIRST[2]
    assert freed == pytest.approx(expected, abs=ROUNDED + 3e-7)
