"""Noise of the inputs: a load does not bounce in the simulation by it, and what it makes unknown is said."""

import functools

import numpy as np
import pytest
from of_the_suite import studies
from twin.test_inputs_that_come_back import MAP, QUIET, RATE, UNTRUE

import tautline
from tautline.integrators.status import Status, StoppedEarly
from tautline.scene.errors import SceneError
from tautline.twin.condition import SHOWS_LITTLE, condition_of
from tautline.twin.map.file import read_map
from tautline.twin.record import Sensing, read_input_noise, record
from tautline.twin.signals.smoothing import smooth_widely
from tautline.twin.signals.steps import Steps
from tautline.twin.storage import load, save
from tautline.twin.twin import Twin
from tautline.twin.watch import Compared

HOIST = "data/hoist.yaml"
TRUE_MASS = 5300.0
BOUNCING = {"size": 0.01, "end": 8.0, "seed": 2}
"""A twin whose simulation bounces until it begins again from rest, at 4 s."""
TWO_BLOCKED = 12.982
"""When two blocks come together in the finer model, s."""


LONG_ENOUGH = 6.0
"""When an estimate has settled after the noise of the start, s: rows behind that say the same."""


def noisy(size):
    """Lines of a twin of the finer model's rows, with noise of both inputs, m."""
    return twin_of_noise(size)[0]


@functools.cache
def twin_of_noise(size, step=0.0, phase=0.0, end=LONG_ENOUGH, seed=1):
    """The same, and the twin; an encoder in steps, m, has marks that are off by a part of a step."""
    fine = {"mesh.elements_per_span": 8, "solver.step": "2 ms", "bodies[0].mass": "5.3 t"}
    sensing = Sensing(seed=seed, rate=RATE, input_noise={"winch_pos": size, "heave": size})
    twin, lines = Twin(HOIST, MAP), []
    for stamp, readings in record(tautline.read(HOIST).replace(fine), read_map(MAP), sensing, end):
        if step:
            readings["winch_pos"] = step * round(readings["winch_pos"] / step + phase)
        lines += twin.add(stamp, readings)
        twin.work()
    return lines + twin.finish(), twin


def test_a_millimetre_of_noise_of_the_inputs_moves_the_tension_by_little_and_raises_no_alarm():
    lines = noisy(0.001)
    late = [line for line in lines if line["time"] > QUIET]
    off = [line["outputs"]["winch.tension"] - line["measured"]["winch.tension"] for line in late]
    # It was 136 kN, with 8336 +- 3643 kg.
    assert np.std(off) < 3e3
    assert lines[-1]["estimates"]["payload.mass"]["value"] == pytest.approx(TRUE_MASS, rel=0.01)
    raised = {one["name"] for line in late for one in line["alarms"]}
    assert not UNTRUE & raised


@pytest.fixture(scope="module")
def without_noise():
    """Lines of a twin of the finer model's rows without noise of the inputs, after `QUIET`, and the load's heights."""
    fine = {"mesh.elements_per_span": 8, "solver.step": "2 ms", "bodies[0].mass": "5.3 t"}
    height = "sensors:\n  - {column: height, unit: m, output: 'payload.position[2]'}"
    with_height = read_map(MAP.replace("sensors:", height))
    twin, lines, heights = Twin(HOIST, MAP + "keep: [payload.position]\n"), [], {}
    for stamp, readings in record(tautline.read(HOIST).replace(fine), with_height, Sensing(seed=1, rate=RATE), 7.5):
        heights[round(stamp, 6)] = readings.pop("height")
        lines += twin.add(stamp, readings)
        twin.work()
    return [line for line in lines + twin.finish() if line["time"] > QUIET], heights


def test_the_place_of_a_load_that_nothing_measures_has_a_deviation_of_what_the_rows_miss(without_noise):
    late, heights = without_noise
    off = np.array([line["outputs"]["payload.position"][2] - heights[round(line["time"], 6)] for line in late])
    sd = np.array([line["deviations"]["payload.position"][2] for line in late])
    # By the estimate alone it was within two deviations in a quarter of the rows.
    assert np.mean(np.abs(off) < 2.0 * sd) > 0.6
    # Nor is it so large that it says nothing: the load swings by centimetres.
    assert np.median(sd) < 0.002


def test_a_wide_cubic_lets_nothing_of_a_bounce_through_and_follows_a_wave():
    t, period = 0.05 * np.arange(100), 0.3
    w = 2.0 * np.pi / 8.0
    shaking = 0.001 * np.sin(2.0 * np.pi / period * t)
    found = smooth_widely(t, 0.5 * np.sin(w * t) + shaking, t[50], 2.0 * period, 0.15, 0.001)
    assert found is not None
    exact = 0.5 * np.array([np.sin(w * t[50]), w * np.cos(w * t[50]), -w * w * np.sin(w * t[50])])
    assert found[0] == pytest.approx(exact[0], abs=1e-4)
    # A millimetre at that frequency is 0.44 m/s2.
    assert found[2] == pytest.approx(exact[2], abs=0.01)


def test_a_computed_value_of_many_deviations_of_its_sensor_is_degraded_where_inputs_shake_it():
    twin = Twin(HOIST, MAP)
    for track in twin.readings.tracks:
        track.bounce, track.noise = 0.3, 0.01
    horizon = twin.estimate.horizon
    horizon.shaken, horizon.spread[:] = True, 100.0
    found = twin._with_noise_of_inputs({"winch.tension": (50e3, 0.0)}, {}, np.array([50e3]))
    assert found["winch.tension"][1] == pytest.approx(500.0 * 99.0**0.5)
    assert condition_of(twin)[0] == "degraded" and twin.doubts == [SHOWS_LITTLE]


def test_no_tension_of_ten_deviations_of_its_sensor_is_in_good_health_where_inputs_shake_by_seven_millimetres():
    lines, twin = twin_of_noise(0.007)
    assert twin.readings.shaken
    large = [line for line in lines if line["deviations"]["winch.tension"] > 10.0 * 500.0]
    assert len(large) > 50 and not [line for line in large if line["health"] == "good"]


def test_health_is_degraded_where_rows_and_window_miss_by_many_deviations_though_no_noise_is_seen():
    twin = Twin(HOIST, MAP)
    for missed, spread in ((36.0, 36.0), (36.0, 4.0), (4.0, 4.0)):
        twin.estimate.horizon.missed[:], twin.estimate.horizon.spread[:] = missed, spread
        found = twin._with_noise_of_inputs({"winch.tension": (50e3, 0.0)}, {}, np.array([50e3]))
        assert not twin.readings.shaken
        assert found["winch.tension"][1] == pytest.approx(500.0 * (missed - 1.0) ** 0.5)
        assert twin.unsure == (missed == spread == 36.0)


@pytest.mark.study
def test_a_step_that_is_not_recognised_is_in_no_good_health_until_the_simulation_begins_again(monkeypatch):
    # The first half second has too few rows for a window; after it began again the deviation is a memory of before.
    monkeypatch.setattr(Steps, "look", lambda steps, times, values: None)
    lines, twin = twin_of_noise(0.0, 0.02, 0.25, end=12.0)
    assert not any(track.steps.step for track in twin.readings.tracks)
    (begun,) = (float(note.split()[1]) for note in twin.notes if "started again from rest" in note)
    large = [line for line in lines if line["deviations"]["winch.tension"] > 5.0 * 500.0]
    before = [line for line in large if 0.5 < line["time"] < begun - 0.1]
    assert len(before) > 30 and not [line for line in before if line["health"] == "good"]


def test_health_is_degraded_where_noisy_inputs_keep_a_load_from_being_known():
    twin = Twin(HOIST, MAP)
    for known, sd in ((False, 4000.0), (True, 5.0)):
        twin.estimate.horizon.spread[:] = 100.0
        twin.estimate.horizon.covariance[0, 0] = sd**2
        twin._with_noise_of_inputs({"winch.tension": (50e3, 0.0)}, {}, np.array([50e3]))
        assert twin.estimate.shown == known
        assert twin.unsure != known


def test_a_run_ahead_begins_with_the_tension_that_is_computed():
    twin, tried = Twin(HOIST, MAP), 0
    sim = twin.estimate.family.simulations[0].copy()
    for stamp, readings in record(tautline.read(HOIST), read_map(MAP), Sensing(seed=1, rate=RATE), 4.0):
        lines = twin.add(stamp, readings)
        if stamp > 3.0 and lines and twin.estimate.family.mixed.any():
            state, parameters = twin.estimate.state()
            sim.restore(state)
            for name, value in parameters.items():
                sim.parameters[name] = value
            read = dict(zip(["winch.tension"], twin.estimate.family.read(["winch.tension"]), strict=True))
            computed = twin.estimate.outputs(read)["winch.tension"][0]
            assert sim["winch.tension"] == pytest.approx(computed, rel=0.02)
            tried += 1
    assert tried > 5


def test_the_noise_of_an_input_that_record_is_given_is_in_its_column_alone_and_nonsense_is_refused():
    scene = tautline.read(HOIST)
    plain = np.array([list(r.values()) for _, r in record(scene, read_map(MAP), Sensing(rate=RATE), 4.0)])
    one = Sensing(rate=RATE, input_noise={"winch_pos": 0.01})
    noise = np.array([list(r.values()) for _, r in record(scene, read_map(MAP), one, 4.0)]) - plain
    assert noise[:, 0].std() == pytest.approx(0.01, rel=0.25)
    assert not noise[:, 1].any()
    assert read_input_noise("winch_pos:0.001") == ("winch_pos", 0.001)
    for text in ("winch_pos", "winch_pos:much", "winch_pos:-1", ":1"):
        with pytest.raises(SceneError):
            read_input_noise(text)
    with pytest.raises(SceneError, match="is no column of an input"):
        next(record(scene, read_map(MAP), Sensing(input_noise={"rope_tension": 1.0}), 1.0))


def test_no_noise_of_what_is_measured_is_asked_for_by_zero_and_that_of_the_map_by_saying_nothing():
    def tension(**noise):
        rows = record(tautline.read(HOIST), read_map(MAP), Sensing(rate=RATE, **noise), 2.0)
        return np.array([readings["rope_tension"] for _, readings in rows])

    without, other_seed = tension(noise=0.0), tension(noise=0.0, seed=7)
    assert np.array_equal(without, other_seed)
    assert tension() == pytest.approx(tension(noise=None), abs=0.0) and (tension() != without).all()


def test_the_weight_is_found_though_two_millimetres_of_noise_have_set_the_load_bouncing_at_the_start():
    found = noisy(0.002)[-1]["estimates"]["payload.mass"]
    # It was 8491 +- 3658 kg: what derivatives and residuals scatter counted times each other.
    assert found["sd"] < 0.1 * TRUE_MASS
    assert abs(found["value"] - TRUE_MASS) < 2.0 * found["sd"]


def test_health_is_degraded_until_the_weight_is_known_so_well_that_the_tension_is():
    twin = Twin(HOIST, MAP)
    for sd, unsure in ((1277.0, True), (100.0, False)):
        twin.estimate.horizon.mean[0] = twin.estimate.horizon.theta0[0] = 4783.0
        twin.estimate.horizon.covariance[0, 0] = sd**2
        twin._with_noise_of_inputs({"winch.tension": (50e3, 9.81 * sd)}, {}, np.array([50e3]))
        assert twin.unsure == unsure


def test_the_deviation_of_a_computed_tension_has_what_the_model_is_off_by(without_noise):
    late, _ = without_noise
    off = np.array([line["outputs"]["winch.tension"] - line["measured"]["winch.tension"] for line in late])
    sd = np.hypot([line["deviations"]["winch.tension"] for line in late], 500.0)
    # With what the estimate leaves open alone, 500 N of noise were all that was said: 0.7 of the rows.
    assert np.mean(np.abs(off) <= 2.0 * sd) >= 0.9


@pytest.mark.parametrize(
    ("computed", "sd", "measured", "known"),
    [(90e3, 5e3, np.nan, True), (70e3, 5e3, np.nan, False), (90e3, 5e3, 50e3, False), (90e3, 5e3, 70e3, True)],
)
def test_a_computed_overload_is_told_and_known_only_where_it_is_beyond_doubt(computed, sd, measured, known):
    twin = Twin(HOIST, MAP)
    twin.watch.judge(Compared(
        10.0, np.array([0.0, 0.0, measured]), {"winch.tension": (computed, sd)}, np.zeros(1), np.ones(1),
        np.ones(1, bool), np.ones(1), True, None,
    ))  # fmt: skip
    told = twin.watch.alarms.active["overload"]
    assert told.known == known and ("not certain" in told.text) != known


def test_a_simulation_that_bounces_by_itself_begins_again_from_rest_and_goes_on_as_the_load_does():
    lines, twin = twin_of_noise(**BOUNCING)
    late = [line for line in lines if line["time"] > BOUNCING["end"] - 2.0]
    off = [line["outputs"]["winch.tension"] - line["measured"]["winch.tension"] for line in late]
    # The bounce of the first seconds stayed: 12 kN, where the readings swing by 4 kN.
    assert np.std(off) < 3e3
    assert all(line["health"] == "good" for line in late)
    assert twin.restarts == 1
    assert any("started again from rest" in note for note in twin.notes)
    assert not [one for line in late for one in line["alarms"] if one["name"] in UNTRUE and one["known"]]


def test_a_simulation_that_noise_shakes_for_a_whole_window_begins_again_though_the_weight_is_not_known(monkeypatch):
    twin = Twin(HOIST, MAP)
    for stamp, readings in record(tautline.read(HOIST), read_map(MAP), Sensing(seed=1, rate=RATE), 5.0):
        twin.add(stamp, readings)
    horizon = twin.estimate.horizon
    for one in horizon.samples:
        one.y0[0] += 30e3 * np.sin(20.0 * one.time)
    horizon.spread[:], horizon.found = 1000.0, False
    assert not twin.estimate.converged and not twin._is_astray(twin.now)
    monkeypatch.setattr(type(twin.readings), "shaken", True)
    assert twin._is_astray(twin.now)
    # Also where readings that are far off pass for those of another unit, and none of them counts.
    for one in horizon.samples:
        one.use = np.zeros(1, bool)
    assert twin._is_astray(twin.now)
    # Before that the guess of the weight is being found.
    while horizon.samples[-1].time - horizon.samples[0].time > 0.8 * horizon.window:
        horizon.samples.popleft()
    assert not twin._is_astray(twin.now)


@pytest.mark.parametrize(
    ("noise", "again"),
    [
        ({"size": 0.006, "end": 5.0, "seed": 1}, 0),
        (BOUNCING, 1),
        *studies(
            *(({"size": size, "end": 5.0, "seed": seed}, 0) for size, seed in ((0.005, 2), (0.008, 2), (0.01, 1)))
        ),
    ],
)
def test_a_simulation_that_noise_shakes_finds_the_weight_and_begins_again_only_where_it_must(noise, again):
    # With 6 mm it stayed at 1060 kg, and of its window of 61 rows 5 were used.
    _, twin = twin_of_noise(**noise)
    assert twin.restarts == again
    assert twin.estimate.horizon.mean[0] == pytest.approx(TRUE_MASS, rel=0.1)


def test_what_rows_missed_of_a_simulation_that_was_given_up_is_forgotten_when_it_begins_again():
    rows = record(tautline.read(HOIST), read_map(MAP), Sensing(seed=1, rate=RATE), 2.0)
    twin = Twin(HOIST, MAP)
    missed = []
    for k, (stamp, readings) in enumerate(rows):
        if k == 20:
            twin.estimate.horizon.missed[:], twin.estimate.from_rest = 400.0, True
        if twin.add(stamp, readings):
            missed.append(twin.estimate.horizon.missed[0])
    # It was remembered for seconds: health stayed degraded though the new simulation went as the machine does.
    assert max(missed) < 100.0


def test_a_replay_that_cannot_go_on_is_not_told_as_an_accident(monkeypatch):
    twin = Twin(HOIST, MAP)

    def stops(passage):
        raise StoppedEarly(Status.TWO_BLOCKED, 13.685, "two blocks together")

    monkeypatch.setattr(twin.estimate, "_passage", object())
    monkeypatch.setattr(twin.estimate, "_go_through", stops)
    twin.estimate.relinearise()
    assert not twin.notes
    assert not twin.estimate.relinearising


@pytest.mark.parametrize("step", [0.03, *studies(0.01, 0.045, 0.05)])
def test_an_encoder_in_steps_moves_the_tension_by_little_and_two_blocking_is_told_a_second_before(step):
    lines, twin = twin_of_noise(0.0, step, end=12.0)
    late = [line for line in lines if line["time"] > QUIET]
    off = [line["outputs"]["winch.tension"] - line["measured"]["winch.tension"] for line in late]
    assert np.std(off) < 2e3
    stopped = TWO_BLOCKED - 1.0
    ahead = next(line for line in reversed(lines) if line["time"] <= stopped)["alarms"]
    assert "two-blocking ahead" in {one["name"] for one in ahead}
    said = [note for note in twin.notes if "changes in steps of" in note]
    assert len(said) <= 1 and all(
        f"The sensor winch_pos changes in steps of {step:g} m." in note and "results come later" in note
        for note in said
    )


@pytest.mark.parametrize(("step", "phase"), [(0.025, 0.25), *studies((0.01, 0.75), (0.02, 0.75))])
def test_a_load_does_not_bounce_when_a_step_is_found_while_the_winch_speeds_up(step, phase):
    lines, twin = twin_of_noise(0.0, step, phase)
    late = [line for line in lines if line["time"] > QUIET]
    off = [line["outputs"]["winch.tension"] - line["measured"]["winch.tension"] for line in late]
    # The bounce of the first second stayed, of up to 30 kN.
    assert np.max(np.abs(off)) < 5e3
    assert not UNTRUE & {one["name"] for line in late for one in line["alarms"]}
    assert twin.restarts == 0


def test_a_step_that_is_known_is_neither_told_nor_begun_with_again_after_a_resume(tmp_path):
    twin = Twin(HOIST, MAP)
    twin.readings.stepped.add(1)
    save(twin, tmp_path / "state")
    later = Twin(HOIST, MAP)
    load(later, tmp_path / "state")
    assert later.readings.stepped == {1}


def steps_in(values, rate=20.0):
    """Steps that are seen in places (n,), m, that come so many times a second, one after the other."""
    steps, t = Steps(), np.arange(len(values)) / rate
    return [steps.look(t[k - 12 : k], values[k - 12 : k]) or steps.step for k in range(12, len(values))]


def test_the_step_of_an_encoder_is_found_whatever_the_speed_and_stays_known():
    t = 0.05 * np.arange(300)
    place = 30.0 - 0.5 * np.minimum(t, 1.2) ** 2 - 1.2 * np.maximum(t - 1.2, 0.0) + 0.1 * np.sin(t)
    for step in (0.005, 0.007, 0.0314159, 0.045, 0.05):
        for digits in (12, 4):
            assert steps_in(np.round(step * np.round(place / step), digits))[40:] == pytest.approx(
                np.full(248, step), rel=2e-3
            )


def test_the_step_of_an_encoder_stays_known_over_a_new_zero():
    t = 0.05 * np.arange(400)
    marks = 0.01 * np.round(30.0 * np.sin(2.0 * np.pi / 8.0 * t))
    # By no multiple of the step.
    steps = steps_in(np.where(t > 8.0, marks + 2.003, marks))
    assert steps[100:] == pytest.approx(np.full(len(steps) - 100, 0.01))


def speeding_up(rate):
    """Places, m, of a winch that speeds up to 2 m/s within a second, for four seconds."""
    t = np.arange(0.0, 4.0, 1.0 / rate)
    return np.where(t < 1.0, t**2, 2.0 * t - 1.0)


@pytest.mark.parametrize("phase", [0.0, 0.25, 0.5, 0.75])
@pytest.mark.parametrize(("rate", "step"), [(20.0, 0.01), (20.0, 0.02), (20.0, 0.025), (50.0, 0.005), (50.0, 0.02)])
def test_the_step_of_an_encoder_is_found_while_the_winch_speeds_up_wherever_its_marks_are(rate, step, phase):
    # From then on it goes by a whole number of steps a row, and shows none any more.
    marks = step * (np.round(speeding_up(rate) / step + phase) - phase)
    assert steps_in(marks, rate)[int(1.1 * rate) - 12 :] == pytest.approx(
        np.full(len(marks) - int(1.1 * rate), step), rel=1e-6
    )


@pytest.mark.parametrize("rate", [5.0, 10.0, 20.0, 50.0])
def test_a_winch_that_speeds_up_and_slows_down_steadily_shows_no_step(rate):
    there = speeding_up(rate)
    slowed = np.append(there, 2.0 * there[-1] - there[-2::-1])
    assert not any(steps_in(slowed, rate))
    # At ends of a change of speed that lie between two rows half of it is seen.
    assert not any(steps_in(0.5 * (slowed[1:] + slowed[:-1]), rate))


def test_no_step_is_seen_in_fine_readings_noise_constants_and_motions_at_a_steady_speed_or_acceleration():
    t = 0.05 * np.arange(400)
    noise = 0.002 * np.random.default_rng(0).standard_normal(t.size)
    fine = [
        0.5 * np.sin(t), t + 0.1 * np.sin(t), 1.2 * t, noise, 1.2 * t + noise, np.full(400, 5.0),
        np.round(1.2 * t + 0.1 * np.sin(t), 3), np.floor(t / 3.0), np.cumsum(0.06 * (np.arange(400) // 60 % 2)),
        0.25 * np.minimum(t, 2.0) ** 2 + np.maximum(t - 2.0, 0.0),
    ]  # fmt: skip
    assert not any(any(steps_in(one)) for one in fine)
