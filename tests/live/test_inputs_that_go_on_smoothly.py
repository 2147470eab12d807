"""Inputs of which only values are given, and how their ways go on from value to value.

References: the functions themselves, a mass on a spring by SciPy, and the quintic and the harmonic mean written again.
"""

import itertools
from pathlib import Path

import numpy as np
import pytest
from of_the_suite import studies
from scipy.integrate import solve_ivp

import tautline
from tautline.kernels.time_function import value_at

DATA = Path(__file__).parents[2] / "data"
PLACE, SPEED, HEAVE = "winch.pay_out", "winch.pay_out_speed", "vessel.heave"
W, A = 2.0 * np.pi / 8.0, 0.5
STIFF, MASS, DELAY = 1.4e6, 5.0e3, 1.0e-3
"""Of a rope with the period of 0.375 s: N/m, kg, and damping over stiffness, s."""
BAR = """
CableModelMaterial: {Gravity: [0, 0, -9.81]}
CableModel:
  - Node4Dof: {id: 0, xyz: [0, 0, 0], BC: [1, 1, 1, 1], BC_functions: [0, 0, 1, 0]}
  - Node4Dof: {id: 1, xyz: [0, 0, -5], BC: [1, 1, 0, 1]}
  - Function: {id: 1, value: 0.0}
  - CableALEelementLin: {id: 0, nodes4: [0, 1], EA: 7.0e6, rhoA: 0, strain: engineering, cDamp: 1.0e-3}
  - PointMass: {id: 0, nodes4: [1], mass: 5.0e3}
GeneralizedAlpha: {type: Newmark, time_step: 0.004, time_end: 12, plotpoints: 1200, start: static}
"""


def rise(t):
    """A share that begins at rest and is whole after 8 s, with both its rates."""
    x = np.clip(t / 8.0, 0.0, 1.0)
    return (
        x**3 * (10.0 - 15.0 * x + 6.0 * x * x),
        30.0 * (x * (1.0 - x)) ** 2 / 8.0,
        60.0 * x * (1 - x) * (1 - 2 * x) / 64,
    )


def heave(t):
    """Value, rate and second rate of a heave that begins at rest."""
    r, dr, ddr = rise(t)
    s, c = A * np.sin(W * t), A * np.cos(W * t)
    return s * r, W * c * r + s * dr, -W * W * s * r + 2.0 * W * c * dr + s * ddr


def still(**more):
    changes = {"vessel.motion": {"heave": {"constant": 0.0}}, "path[0].drum.pay_out": 0}
    return tautline.read(DATA / "hoist.yaml").replace(changes | more)


def simulation(name=HEAVE):
    return tautline.Simulation(still(), inputs=[name], keep=False)


def ways(sim, name, times, values, points=20):
    """Instants, and value, rate and second rate there, where the input alone goes on and the scene does not."""
    (steering, function), found, at = sim.inputs.handle(name).members[0], [], []
    for end, value in zip(times, values, strict=True):
        begin = sim.time
        if value is not None:
            sim.inputs[name] = value
        sim.inputs.write(begin, end)
        for t in np.linspace(begin, end, points, endpoint=False):
            at.append(t)
            found.append([x / steering.factor for x in value_at(sim.model.system.functions, function, t)])
        sim._time = end
    return np.array(at), np.array(found)[:, steering.order :]


def slopes_only(times, values, points=20):
    """The ways with the harmonic mean of two slopes and no second rate, in Hermite's form."""
    found, rate, before, begin, last = [], 0.0, 0.0, 0.0, 0.0
    x = np.arange(points) / points
    for end, value in zip(times, values, strict=True):
        h = end - begin
        slope = (value - last) / h
        next_rate = 2.0 * before * slope / (before + slope) if before * slope > 0.0 else 0.0
        rises, leaves = 10 * x**3 - 15 * x**4 + 6 * x**5, x - 6 * x**3 + 8 * x**4 - 3 * x**5
        comes = -4 * x**3 + 7 * x**4 - 3 * x**5
        second = 60 * x - 180 * x**2 + 120 * x**3
        leaves2, comes2 = -36 * x + 96 * x**2 - 60 * x**3, -24 * x + 84 * x**2 - 60 * x**3
        place = last + (value - last) * rises + h * (rate * leaves + next_rate * comes)
        found.append(np.stack([place, ((value - last) * second + h * (rate * leaves2 + next_rate * comes2)) / h**2], 1))
        rate, before, begin, last = next_rate, slope, end, value
    return np.concatenate(found)


@pytest.mark.parametrize(("shortest", "longest", "wrong"), [(0.1, 0.1, 0.025), (0.05, 0.05, 0.006), (0.04, 0.16, 0.06)])
def test_a_smooth_motion_given_by_values_alone_has_its_own_accelerations_also_with_uneven_advances(
    shortest, longest, wrong
):
    times = np.cumsum(np.random.default_rng(4).uniform(shortest, longest, round(20.0 / (0.5 * (shortest + longest)))))
    t, found = ways(simulation(), HEAVE, times, heave(times)[0])
    settled = t > 1.0
    assert np.abs(found[settled, 2] - heave(t)[2][settled]).max() < wrong * A * W * W


def test_a_smooth_heave_given_by_values_alone_pulls_a_stiff_rope_as_the_motion_itself_does():
    """Ten values a second shook it by 80 % of m a, four times its period of 0.375 s."""
    sim, found = tautline.Simulation(BAR, inputs=["function 1"]), []
    times = 0.1 * np.arange(1, 121)
    for t in times:
        sim.inputs["function 1"] = float(heave(t)[0])
        sim.advance_to(t)
    told = sim.result
    found, at = np.asarray(told["axial_force"])[:, 0], np.asarray(told["time"])

    def moved(t, y):
        u, du, _ = heave(t)
        return y[1], (STIFF * (u - y[0]) + DELAY * STIFF * (du - y[1])) / MASS

    y = solve_ivp(moved, (0.0, 12.0), [0.0, 0.0], t_eval=at, rtol=1e-8, atol=1e-10, max_step=0.05).y
    u, du, _ = heave(at)
    exact = MASS * 9.81 + STIFF * (u - y[0]) + DELAY * STIFF * (du - y[1])
    assert np.abs(found - exact).max() < 0.025 * MASS * A * W * W


def test_a_speed_given_by_values_alone_has_its_own_accelerations():
    times = 0.1 * np.arange(1, 121)
    sim = simulation(SPEED)
    t, found = ways(sim, SPEED, times, heave(times)[0])
    settled = t > 1.0
    assert np.abs(found[settled, 1] - heave(t)[1][settled]).max() < 0.001 * A * W


def test_a_motion_given_with_its_rate_has_its_own_accelerations():
    times = 0.1 * np.arange(1, 121)
    value, rate, _ = heave(times)
    t, found = ways(simulation(), HEAVE, times, zip(value, rate, strict=True))
    settled = t > 1.0
    assert np.abs(found[settled, 2] - heave(t)[2][settled]).max() < 0.015 * A * W * W
    assert found[::20, 1][1:] == pytest.approx(rate[:-1], abs=1e-12)


@pytest.mark.parametrize(
    "given",
    [
        [0, 0, 1, 1, 1, 1],
        [1, 2, 3, 4, 5, 6, 6, 6],
        [1, 2, 3, 4, 5, 6, 5, 4, 3, 2],
        [1, 0, 1, 0, 1, 0, 1],
        [0, 0.3, 1, 1, 1],
        [1, 2, 3, 13, 14, 15, 16, 17],
        [0, 1, 0, 0, 0.1],
        [0.1, 0.5, 1.5, 1.5, 1.5],
    ],
    ids=["step", "ramp and stop", "reversal", "to and fro", "step in two", "jump of a ramp", "spike", "first values"],
)
def test_jumps_stops_reversals_and_first_values_go_by_slopes_alone(given):
    times = 0.1 * np.arange(1, len(given) + 1)
    _, found = ways(simulation(), HEAVE, times, 0.1 * np.array(given))
    assert found[:, [0, 2]] == pytest.approx(slopes_only(times, 0.1 * np.array(given)), abs=1e-9)


def test_stops_of_many_kinds_are_overshot_hardly_more_than_by_slopes_alone():
    """Ramps, half waves and parabolas that end at 1 between two values or at one: worst and mean over all."""
    rng, ours, by_slopes = np.random.default_rng(1), [], []
    kinds = (lambda q: q, lambda q: 0.5 - 0.5 * np.cos(np.pi * q), lambda q: q * (2 - q), lambda q: q * q)
    for k, kind in itertools.product(range(12), kinds):
        times = 0.1 * np.arange(1, 21) if k % 2 else np.cumsum(rng.uniform(0.05, 0.2, 20))
        values = kind(np.clip((times - rng.uniform(0.1, 0.3)) / rng.uniform(0.1, 1.0), 0.0, 1.0))
        values[-4:] = values[-5]
        ours.append(ways(simulation_of_all(), HEAVE, times, values)[1][:, 0].max() - values.max())
        by_slopes.append(slopes_only(times, values)[:, 0].max() - values.max())
    assert max(ours) <= 1.1 * max(by_slopes)
    assert np.mean(ours) <= 1.02 * np.mean(by_slopes)


_STILL = []


def simulation_of_all():
    """A simulation at its start: built once, and gone back to."""
    if not _STILL:
        sim = simulation()
        _STILL.extend([sim, sim.save()])
    _STILL[0].restore(_STILL[1])
    return _STILL[0]


def test_a_value_that_is_given_again_and_again_behind_a_smooth_motion_stays_without_drift():
    times = 0.1 * np.arange(1, 41)
    values = heave(np.minimum(times, 2.0))[0]
    for again in (True, False):
        given = [x if again or t < 2.05 else None for t, x in zip(times, values, strict=True)]
        t, found = ways(simulation(), HEAVE, times, given)
        assert found[t > 2.15, 0] == pytest.approx(values[-1], abs=1e-12)
        assert found[t > 2.15, 1] == pytest.approx(0.0, abs=1e-12)


def test_a_value_with_its_rate_is_at_rest_an_advance_after_it_was_given_last():
    times = 0.1 * np.arange(1, 31)
    value, rate, _ = heave(times)
    given = [*zip(value[:20], rate[:20], strict=True), *[None] * 10]
    t, found = ways(simulation(), HEAVE, times, given)
    assert found[t > 2.15, 0] == pytest.approx(value[19], abs=1e-12)
    assert found[t > 2.15, 1] == pytest.approx(0.0, abs=1e-12)


def test_a_motion_given_with_its_rate_keeps_its_acceleration_at_a_turning_point_where_the_rate_is_zero():
    times = 0.1 * np.arange(1, 151)
    value, rate, second = heave(times)
    turns = np.flatnonzero(np.isclose(times, 10.0))[0]
    rate[turns] = 0.0
    _, found = ways(simulation(), HEAVE, times, zip(value, rate, strict=True))
    assert found[20 * (turns + 1), 2] == pytest.approx(second[turns], rel=0.02)


def test_noise_of_a_measured_motion_grows_little_beside_slopes_alone():
    times = 0.05 * np.arange(1, 401)
    values = heave(times)[0] + np.random.default_rng(0).normal(0.0, 1e-3, times.size)
    _, found = ways(simulation(), HEAVE, times, values)
    by_slopes = slopes_only(times, values)[:, 1]
    assert np.sqrt(np.mean(found[:, 2] ** 2)) < 1.1 * np.sqrt(np.mean(by_slopes**2))


def test_states_and_copies_in_the_middle_of_a_smooth_motion_go_on_to_the_bit():
    scene = still()
    values = [float(heave(0.1 * k)[0]) for k in range(1, 21)]
    one = tautline.Simulation(scene, inputs=[HEAVE], keep=False)
    for x in values[:12]:
        one.inputs[HEAVE] = x
        one.advance(0.1)
    saved, twin = one.save(), one.copy()
    other = tautline.Simulation(scene, inputs=[HEAVE], keep=False)
    other.restore(saved)
    for sim in (one, twin, other):
        for x in values[12:]:
            sim.inputs[HEAVE] = x
            sim.advance(0.1)
    memories = [sim.inputs.memory.tobytes() for sim in (one, twin, other)]
    assert memories[0] == memories[1] == memories[2]
    assert one["winch.tension"] == twin["winch.tension"] == other["winch.tension"]


def test_a_state_of_an_fmu_in_the_middle_of_a_smooth_motion_goes_on_to_the_bit(tmp_path):
    pytest.importorskip("pythonfmu", reason="PythonFMU is not installed")
    import zipfile

    from tautline.live.fmu.unit import Core, state_from_bytes, to_bytes
    from tautline.live.fmu.writing import write_fmu

    write_fmu(still(), tmp_path / "still.fmu", [HEAVE], ["winch.tension"])
    zipfile.ZipFile(tmp_path / "still.fmu").extractall(tmp_path)
    ends = []
    for back in (False, True):
        core = Core(tmp_path / "resources")
        for k in range(20):
            if back and k == 12:
                data = to_bytes(core.save())
                core = Core(tmp_path / "resources")
                core.restore(state_from_bytes(data))
            core.set(HEAVE, float(heave(0.1 * (k + 1))[0]))
            core.step(0.1 * k, 0.1)
        ends.append(core.get("winch.tension"))
    assert ends[0] == ends[1]


def test_an_input_that_was_driven_by_another_meanwhile_goes_on_as_one_given_for_the_first_time():
    """Its values of before say nothing about how it goes on."""
    sim = tautline.Simulation(still(), inputs=[PLACE, SPEED], keep=False)
    times = 0.1 * np.arange(1, 9)
    ways(sim, PLACE, times, 0.01 * times**2)
    ways(sim, SPEED, [0.9], [0.0])
    place = float(sim.inputs[PLACE])
    _, found = ways(sim, PLACE, [1.0, 1.1, 1.2, 1.3], place + 0.01 * np.array([0.19, 0.4, 0.63, 0.88]))
    assert found[[20, 40, 60], 2] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(("short", "noise", "wrong"), [(0.01, 1e-3, 2.0), (0.001, 1e-4, 2.0), (0.01, 0.0, 1.001)])
def test_a_long_advance_behind_short_ones_of_a_noisy_signal_goes_at_most_twice_as_far_astray_as_by_slopes_alone(
    short, noise, wrong
):
    """A dropout of a second in a signal of 100 or 1000 Hz; the way flew off by 1.4 and 13 m."""
    lengths = np.where(np.arange(400) % 8 == 7, 1.0, short)
    times = np.cumsum(lengths)
    values = 0.5 - 0.5 * np.cos(W * times) + np.random.default_rng(0).normal(0.0, noise, times.size)
    t, found = ways(simulation_of_all(), HEAVE, times, values)
    truth = 0.5 - 0.5 * np.cos(W * t)
    by_slopes = np.abs(slopes_only(times, values)[:, 0] - truth).max()
    assert np.abs(found[:, 0] - truth).max() < wrong * by_slopes


def test_a_noisy_signal_that_is_given_no_more_stays_near_its_last_value_in_a_long_advance():
    times = np.append(0.01 * np.arange(1, 101), 2.0)
    noise = np.random.default_rng(0)
    for _ in range(20):
        values = [*noise.normal(0.0, 1e-3, 100), None]
        _, found = ways(simulation_of_all(), HEAVE, times, values)
        assert np.abs(found[-20:, 0] - values[-2]).max() < 0.2


def test_a_speed_that_takes_over_from_a_noisy_place_goes_on_near_it_in_a_long_advance():
    """A winch that is held by `pay_out_speed = 0` behind measured values of 100 Hz; it moved by 2.8 m, from 0.2 m/s."""
    for seed in range(10):
        noise = np.random.default_rng(seed)
        sim = tautline.Simulation(still(), inputs=[PLACE, SPEED], keep=False)
        times = 0.01 * np.arange(1, 41)
        ways(sim, PLACE, times, float(sim.inputs[PLACE]) + A * np.sin(W * times) + noise.normal(0.0, 1e-3, 40))
        sim.inputs[SPEED] = 0.0
        sim.inputs.write(sim.time, sim.time + 1.0)
        function = sim.inputs.handle(SPEED).members[0][1]
        moved = [value_at(sim.model.system.functions, function, t)[0] for t in np.linspace(0.4, 1.4, 21)]
        assert np.abs(np.array(moved) - moved[0]).max() < 0.4


def test_a_second_rate_that_was_given_is_carried_into_an_advance_of_any_length():
    times = np.append(0.01 * np.arange(1, 11), 1.1)
    _, found = ways(simulation_of_all(), HEAVE, times, zip(*heave(times), strict=True))
    assert found[200, 2] == pytest.approx(heave(0.1)[2], rel=1e-12)


def test_much_longer_advances_carry_as_much_of_a_second_rate_as_four_times_the_last_would():
    """Continuous in the length, so that rounding of a time decides nothing."""
    for long, share in ((0.39, 1.0), (0.41, (0.4 / 0.41) ** 2), (0.8, 0.25), (4.0, 0.01)):
        times = np.append(0.1 * np.arange(1, 11), 1.0 + long)
        _, found = ways(simulation_of_all(), HEAVE, times, times**3)
        assert found[200, 2] == pytest.approx(6.0 * share, rel=1e-6)


def notches():
    """All commands of a lever with three notches in six values, the last held."""
    return [np.array([*given, given[-1], given[-1]]) for given in itertools.product((0.0, 0.5, 1.0), repeat=6)]


@pytest.mark.parametrize(("name", "order"), [(HEAVE, 0), (SPEED, 1)])
def test_commands_in_notches_are_overshot_no_more_than_by_slopes_alone(name, order):
    """Half of the range beyond it was the worst.

    The reference for a speed: a cubic that leaves 1 with half the range an advance, and comes to rest there.
    """
    sim, times = simulation(name), 0.1 * np.arange(1, 9)
    saved, beyond, by_slopes = sim.save(), [], []
    for given in notches()[::3] + [np.array([1, 0.5, 0, 0.5, 1, 0, 0, 0]), np.array([1, 1, 0, 0.5, 1, 0, 0, 0])]:
        sim.restore(saved)
        _, found = ways(sim, name, times, given, points=6)
        beyond.append(max(-found[:, 0].min(), found[:, 0].max() - 1.0))
        place = slopes_only(times, given, points=6)[:, 0]
        by_slopes.append(2.0 / 27.0 if order else max(-place.min(), place.max() - 1.0))
    assert max(beyond) <= max(by_slopes) + 1e-9


@pytest.mark.parametrize(("name", "share"), [(HEAVE, 16 / 81), (SPEED, 4 / 27)])
@pytest.mark.parametrize(
    ("long", "given"),
    [
        (0.1, 1.0),
        (1.0, 1.0 + 1e-8),
        (5.0, None),
        *studies(*((long, 1.0) for long in (0.2, 1.0, 5.0))),
        *studies(*((long, 1.0 + 1e-8) for long in (0.1, 0.2, 5.0))),
        *studies(*((long, None) for long in (0.1, 0.2, 1.0))),
    ],
)
def test_what_is_held_behind_a_steady_rise_is_overshot_by_as_much_in_an_advance_of_any_length(name, share, long, given):
    """By 16/81 of the last move: the top of the quintic that leaves with its rate; of a speed by 4/27, of the cubic."""
    times = np.append(0.1 * np.arange(1, 11), [1.0 + long, 1.1 + long])
    t, found = ways(simulation(name), name, times, [*(0.1 * np.arange(1, 11)), given, given], points=2000)
    assert found[:, 0].max() == pytest.approx(1.0 + 0.1 * share, abs=2e-5)
    assert found[t > 1.1 + 1e-9, 0] == pytest.approx(given or 1.0, abs=1e-12)
    assert not found[t > 1.1 + 1e-9, 1:].any()


def test_a_stop_that_is_given_with_its_rate_takes_the_whole_of_an_advance():
    """The quintic of 1 s that leaves with 1 m/s: its top is 16/81 m beyond, a third of the way."""
    times = np.append(0.1 * np.arange(1, 11), 2.0)
    t, found = ways(simulation(), HEAVE, times, [*((x, 1.0) for x in times[:-1]), (1.0, 0.0)], points=300)
    assert found[:, 0].max() == pytest.approx(1.0 + 16 / 81, abs=1e-4)
    assert t[found[:, 0].argmax()] == pytest.approx(4 / 3, abs=0.01)


def test_what_stops_in_an_advance_of_a_microsecond_stands_still_for_an_hour_after_it():
    """The rounding of 1000 m over the square of a microsecond is 0.1 m/s2."""
    times = np.append(1e-6 * np.arange(1, 51), 3600.0)
    _, found = ways(simulation_of_all(), HEAVE, times, [*(1000.0 + 0.3 * times[:-1]), None], points=50)
    assert np.abs(found[-49:, 0] - 1000.0 - 0.3 * 5e-5).max() < 1e-9


def test_values_that_differ_by_rounding_from_a_ramp_have_no_second_rate():
    """Every microsecond: 0.09 m/s2 came out of the last bits of 1000 m."""
    times = 1e-6 * np.arange(1, 51)
    _, found = ways(simulation_of_all(), HEAVE, times, 1000.0 + 0.3 * times, points=2)
    at_ends = found[20::2]
    assert at_ends[:, 1] == pytest.approx(0.3, rel=1e-3)
    assert at_ends[:, 2] == pytest.approx(0.0, abs=1e-6)
