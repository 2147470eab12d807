"""A parameter that the map knows well, and one that is not known yet: bounds are judged all the same.

What the machine does is known here: it is a run of the scene with the mass that the map gives or does not give. The
bound lies between what an output is before the flow rises and behind it, and no sensor of the twin shows it.
"""

import functools

import numpy as np
import pytest
import yaml

import tautline
from tautline.twin.alarms import bound_said
from tautline.twin.estimation.horizon import Horizon, Sample
from tautline.twin.forecast import Found
from tautline.twin.map.plan import Unknown
from tautline.twin.twin import Twin
from tautline.twin.watch import Compared, Watch

MASS, NOISE, RISES = 7.854e-4, 1e-3, 3.0
"""Of the fluid, kg/m; of the sensor, m; and when the flow rises, s."""
MAP = """
sensors:
  - {{column: flow, unit: m/s, input: water.speed}}
  - {{column: up, unit: m, output: "tip.position[2]", sd: 1 mm}}
window: 1 s
estimate:
  - {{parameter: hose.fluid_mass, start: {start}, sd: {sd}, range: [1e-4, 3e-3]}}
watch:
"""
REACH = "  - {{output: 'tip.position[0]', {side}: {bound} m, name: reach, ahead: 0 s}}\n"
RESIDUAL = "  - {residual: 'tip.position[2]', above: 8 mm, for: 0.2 s, name: off}\n"


def hose():
    scene = yaml.safe_load(open("data/hose.yaml"))
    scene["hose"]["elements"] = 5
    scene["water"]["speed"] = {"table": {"time": [0.0, RISES, RISES + 1.0, 8.0], "value": [2.0, 2.0, 6.0, 6.0]}}
    scene["solver"] |= {"step": "2 ms", "end": 7.0}
    scene["output"]["interval"] = 0.05
    return tautline.read(scene)


@functools.cache
def machine():
    """Stamps, flow, and the tip's height and reach of the machine."""
    data = tautline.simulate(hose()).data
    return data.time.values, data.flow_speed.values, data.tip.values[:, 2], data.tip.values[:, 0]


def lines(watch, start, sd, off=lambda t: 0.0):
    """Lines of a twin that starts with a mass and its deviation, kg/m, and whose sensor is off."""
    twin, noise, found = Twin(hose(), MAP.format(start=start, sd=sd) + watch), np.random.default_rng(0), []
    for t, flow, up, _ in zip(*machine(), strict=True):
        found += twin.add(float(t), [float(flow), float(up + NOISE * noise.standard_normal() + off(t))])
    return found


def shown(found, name):
    """Times, s, of the rows that have an alarm."""
    return [one["time"] for one in found if any(alarm["name"] == name for alarm in one["alarms"])]


@pytest.mark.parametrize("share", [0.4, 0.02, 0.005])
def test_a_bound_of_what_no_sensor_shows_is_told_as_it_is_passed_however_well_the_map_knows_the_parameter(share):
    time, _, _, reach = machine()
    before, behind = reach[(time > 2.0) & (time < RISES)], reach[time > 6.0]
    up = behind.mean() > before.mean()
    bound = 0.5 * (before.max() + behind.min()) if up else 0.5 * (before.min() + behind.max())
    passed = time[(time > RISES) & ((reach > bound) == up)][0]
    found = lines(REACH.format(side="above" if up else "below", bound=bound), MASS, share * MASS)
    told = [one for one in shown(found, "reach") if one > 2.0]
    assert told and abs(told[0] - passed) < 0.2
    assert told[-1] > 6.8


@pytest.mark.parametrize("share", [0.4, 0.02])
def test_a_sensor_that_is_suddenly_off_is_told_however_well_the_map_knows_the_parameter(share):
    found = lines(RESIDUAL, MASS, share * MASS, lambda t: 0.02 * (t > 6.0))
    told = shown(found, "off")
    assert told and 6.0 < told[0] < 6.5


def test_what_is_not_judged_yet_is_said_until_the_estimate_is_known():
    found = lines(REACH.format(side="above", bound=5.0), 1.2 * MASS, 0.4 * MASS)
    said = [any("known well yet" in text for text in one["not_observable"]) for one in found]
    assert said[0] and not said[-1]


@pytest.fixture(scope="module")
def judged():
    """A function that judges a computed reach, m, of an estimate that is a guess, and gives its alarm."""
    twin = Twin(hose(), MAP.format(start=MASS, sd=0.4 * MASS) + REACH.format(side="above", bound=1.0) + RESIDUAL)

    def judge(value, sd, residual=0.0, **more):
        watch = Watch(twin.plan, twin.readings.health, None)
        for time in (1.0, 1.3, 1.6):
            twin.readings.health[1].check(time, 0.01 * time)
            watch.judge(Compared(
                time, np.array([2.0, 0.01 * time]), {"tip.position[0]": (value, sd)}, np.array([residual]),
                np.array([sd]), np.ones(1, bool), np.ones(1), False, None, **more,
            ))  # fmt: skip
        return watch.alarms.active

    return judge


def test_a_guess_tells_only_what_its_deviation_does_not_reach(judged):
    assert "reach" not in judged(1.1, 0.1)
    assert judged(1.3, 0.1)["reach"].known
    # Of a guess that has left what was simulated the deviation is that of a straight line.
    assert "reach" not in judged(1.3, 0.1, far=True)
    assert "reach" not in judged(1.3, 0.1, unsure=True)
    assert "reach" not in judged(1.3, np.nan)


def test_a_guess_tells_only_residuals_that_its_deviation_does_not_reach(judged):
    assert "off" not in judged(0.5, 0.002, residual=0.011)
    assert "off" in judged(0.5, 0.002, residual=0.013)
    assert "off" not in judged(0.5, 0.002, residual=0.013, far=True)


HEIGHT = "  - {output: 'tip.position[2]', above: 1 m, name: height, ahead: 2 s}\n"


@pytest.mark.parametrize(
    ("measured", "converged", "known"), [(0.3, False, False), (0.81, False, True), (0.3, True, True)]
)
def test_what_a_guess_foresees_is_certain_only_while_the_sensor_of_the_same_output_agrees_with_it(
    measured, converged, known
):
    twin = Twin(hose(), MAP.format(start=MASS, sd=0.4 * MASS) + HEIGHT)
    watch = Watch(twin.plan, twin.readings.health, None)
    for time in (1.0, 1.3, 1.6):
        value = measured + 1e-3 * time
        twin.readings.health[1].check(time, value)
        watch.judge(Compared(
            time, np.array([2.0, value]), {"tip.position[2]": (0.8, 0.02)}, np.array([value - 0.8]),
            np.array([0.02]), np.ones(1, bool), np.ones(1), converged, Found(time, beyond={"height": [(1.0, 1.5)]}),
        ))  # fmt: skip
    height = watch.alarms.active["height"]
    assert height.known == known and "in 1.0 s: 1.5 m, above 1 m" in height.text
    # The driver sees both values, and may judge himself.
    assert ("That is not certain. What is measured now is 0.301" in height.text) == (not known)


def horizon(sd, drift=0.0, start=1.0):
    channel = Twin(hose(), MAP.format(start=MASS, sd=0.4 * MASS) + RESIDUAL).plan.measured[0]
    one = Unknown(name="a", target="a", is_offset=False, unit="", start=start, sd=sd, low=0.0, high=9.0, drift=drift)
    return Horizon([one], [channel.model_copy(update={"sd": 0.1})], 1.0)


def fed(one, times, use=True, value=1.0):
    """A horizon that has taken in readings of 1, or of another value, which are the unknown itself."""
    for time in times:
        one.add(Sample(time, np.full(1, value), one.mean.copy(), np.ones((1, 1)), np.array([use])))
        one.theta0 = one.mean.copy()
    return one


def test_an_estimate_that_was_known_is_so_while_its_sensor_is_dead_and_a_guess_again_where_it_starts_anew():
    one = fed(horizon(1.0, drift=0.1), np.arange(0.0, 5.0, 0.1))
    assert one.found
    fed(one, np.arange(5.0, 12.0, 0.1), use=False)
    assert one.deviation[0] > 0.1 and one.found
    one.begin_again()
    assert not one.found


@pytest.mark.parametrize(("sd", "start", "known"), [(0.05, 1.0, True), (0.2, 1.0, False), (0.05, 0.0, False)])
def test_what_the_map_knows_to_a_tenth_is_known_behind_a_window_though_sensors_show_nothing_more(sd, start, known):
    one = fed(horizon(sd, start=start), np.arange(0.0, 0.9, 0.1), use=False)
    assert not one.found
    assert fed(one, np.arange(0.9, 2.0, 0.1), use=False).found == known


def test_an_estimate_that_readings_contradict_is_a_guess_until_a_whole_window_has_come_that_does_not():
    one = fed(horizon(0.05), np.arange(0.0, 2.0, 0.1))
    assert one.found
    known = []
    for time in np.arange(2.0, 9.0, 0.1):
        fed(one, [time], value=2.0)
        if np.isfinite(one.released) and one.found:
            assert time > one.released + 0.9
            # As well as the map knows it: what readings contradict is far from that.
            assert one.mean[0] == pytest.approx(2.0, rel=0.1)
            known.append(time)
    assert known and known[0] > 4.0


@pytest.mark.parametrize(("value", "bound"), [(0.49995862, 0.49995876), (0.499958, 0.5), (-2.00001, -2.0)])
def test_a_value_and_its_bound_are_told_with_as_many_digits_as_it_takes_to_see_which_is_which(value, bound):
    def tell(x, digits=4):
        return f"{x:.{digits}g} m"

    told, _, limit = (
        word.strip() for word in bound_said(value, np.inf, bound, tell).replace(", below", "|,|").split("|")
    )
    assert float(told[:-2]) < float(limit[:-2])
    assert bound_said(61.23, 60.0, -np.inf, tell) == "61.23 m, above 60 m"


def test_an_estimate_that_readings_contradict_is_a_guess_until_they_do_so_no_more_for_a_window():
    one, released, known = horizon(0.02, start=1.0), [], []
    for t in np.arange(0.0, 5.0, 0.1):
        # The thing is twice what the map says.
        one.add(Sample(t, np.full(1, 2.0), one.mean.copy(), np.ones((1, 1)), np.array([True])))
        one.theta0 = one.mean.copy()
        if np.isfinite(one.released) and one.released not in released:
            released.append(float(one.released))
        if one.found:
            known.append((float(t), float(one.mean[0])))
    assert released and all(t - max([0.0, *(r for r in released if r <= t)]) > 0.85 for t, _ in known)
