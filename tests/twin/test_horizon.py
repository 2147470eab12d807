"""The moving horizon against what is known in closed form: for a linear model it is recursive least squares."""

import numpy as np
import pytest
from of_the_suite import studies

from tautline.twin.estimation.horizon import Horizon, Sample
from tautline.twin.map.plan import Channel, Unknown


def unknown(name, start, sd, drift=0.0, low=-np.inf, high=np.inf):
    return Unknown(
        name=name, target=name, is_offset=False, unit="", start=start, sd=sd, low=low, high=high, drift=drift
    )


def channel(sd):
    return Channel(
        column="y", name="y", is_input=False, unit="N", scale=1.0, zero=0.0, zero_first=False, sd=sd, relative=False,
        low=-np.inf, high=np.inf, waves=False, lost_after=5.0,
    )  # fmt: skip


def fed(horizon, t, y, J):
    for at, value, row in zip(t, y, J, strict=True):
        row = np.atleast_2d(row)
        horizon.add(Sample(at, np.array([value]), row @ horizon.theta0, row, np.ones(1, bool)))
    return horizon


def test_the_estimate_is_that_of_all_data_though_only_a_window_is_kept():
    rng = np.random.default_rng(1)
    t = 0.1 * np.arange(200)
    J = np.column_stack([np.ones(200), np.sin(t)])
    truth = np.array([3.0, -1.5])
    y = J @ truth + 0.2 * rng.standard_normal(200)
    horizon = Horizon([unknown("a", 0.0, 10.0), unknown("b", 0.0, 10.0)], [channel(0.2)], 3.0)
    horizon.theta0[:] = truth  # from far away a line would not be believed: who knows that it is straight
    fed(horizon, t, y, J)
    info = J.T @ J / 0.2**2 + np.eye(2) / 10.0**2
    mean = np.linalg.solve(info, J.T @ y / 0.2**2)
    assert len(horizon.samples) == 31
    assert horizon.mean == pytest.approx(mean, abs=0.02)
    # Its own deviation is that of least squares, or larger by what the residuals' likeness tells.
    exact = np.sqrt(np.diag(np.linalg.inv(info)))
    assert np.all(horizon.linear_deviation >= exact) and np.all(horizon.linear_deviation < 1.6 * exact)


@pytest.mark.parametrize("trials", [20, *studies(60)])
def test_the_truth_lies_within_two_deviations_in_nine_of_ten_trials(trials):
    # Samples that count as independent, which they are not, have deviations that hold in 57 of 100 trials: of twenty
    # trials eighteen or more would hold once in five hundred times.
    within = 0
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        t = 0.1 * np.arange(50)  # half as long again as what is kept
        noise = np.zeros(50)
        for k in range(50):  # noise with a memory, as an input that is off has it
            noise[k] = 0.6 * noise[k - 1] + 0.2 * rng.standard_normal()
        y = 3.0 + noise
        horizon = fed(Horizon([unknown("a", 6.0, 5.0)], [channel(0.2)], 3.0), t, y, np.ones((50, 1)))
        within += abs(horizon.mean[0] - 3.0) <= 2.0 * horizon.linear_deviation[0]
    assert within >= 0.9 * trials


def test_a_value_that_changes_for_good_is_followed_after_a_contradiction():
    t = 0.1 * np.arange(300)
    rng = np.random.default_rng(3)
    y = np.where(t < 15.0, 3.0, 4.0) + 0.05 * rng.standard_normal(300)
    horizon = fed(Horizon([unknown("a", 3.0, 2.0)], [channel(0.05)], 3.0), t, y, np.ones((300, 1)))
    assert horizon.released > 15.0
    assert horizon.mean[0] == pytest.approx(4.0, abs=0.05)


def swinging(noise):
    """Samples of a slope of either sign, as friction has it: a change leaves nothing in the mean of the residuals."""
    n = len(noise)
    J = 100.0 * np.sign(np.sin(0.8 * np.arange(n))).reshape(-1, 1)
    return 4.0 * np.arange(n), J


def test_of_a_long_window_the_last_samples_are_enough_to_tell_that_a_value_has_changed():
    noise = np.random.default_rng(8).standard_normal(46)
    t, J = swinging(noise)
    y = J[:, 0] * np.where(np.arange(46) < 35, 0.2, 0.35) + noise
    window = {late: Horizon([unknown("a", 0.4, 0.15)], [channel(1.0)], 300.0, late=late) for late in (0, 8)}
    for horizon in window.values():
        fed(horizon, t, y, J)
    assert window[8].mean[0] == pytest.approx(0.35, abs=0.02)
    assert abs(window[8].mean[0] - 0.35) < 3.0 * window[8].linear_deviation[0]
    assert t[33] <= window[8].since <= t[38]
    # Held against the prior alone it would not be told for three minutes.
    assert abs(window[0].mean[0] - 0.35) > 0.05 and window[0].since == -np.inf


@pytest.mark.parametrize("seeds", [range(30), *studies(range(30, 100))])
def test_what_stays_as_it_is_is_not_forgotten(seeds):
    for seed in seeds:
        rng = np.random.default_rng(seed)
        noise = np.zeros(60)
        for k in range(60):  # noise with a memory, and some wild samples
            noise[k] = 0.5 * noise[k - 1] + rng.standard_normal()
        noise[rng.integers(0, 60, 3)] *= 10.0
        t, J = swinging(noise)
        horizon = fed(Horizon([unknown("a", 0.4, 0.15)], [channel(1.0)], 300.0, late=8), t, 0.2 * J[:, 0] + noise, J)
        assert horizon.since == -np.inf


def test_a_random_walk_is_followed():
    rng = np.random.default_rng(4)
    t = 0.1 * np.arange(300)
    truth = 3.0 + np.cumsum(0.02 * np.sqrt(0.1) * rng.standard_normal(300))
    y = truth + 0.05 * rng.standard_normal(300)
    horizon = fed(Horizon([unknown("a", 3.0, 1.0, drift=0.02)], [channel(0.05)], 3.0), t, y, np.ones((300, 1)))
    assert abs(horizon.mean[0] - truth[-15]) < 3.0 * horizon.linear_deviation[0]
    assert horizon.linear_deviation[0] > 0.005


def test_an_estimate_stays_within_its_range():
    horizon = Horizon([unknown("a", 1.0, 5.0, low=0.5, high=2.0)], [channel(0.1)], 3.0)
    fed(horizon, 0.1 * np.arange(20), np.full(20, 3.0), np.ones((20, 1)))
    assert horizon.mean[0] == 2.0
    assert horizon.at_bound[0]


def test_what_cannot_be_told_apart_is_said_and_what_is_not_seen_too():
    horizon = Horizon(
        [unknown("weight", 0.0, 10.0), unknown("offset", 0.0, 10.0), unknown("other", 0.0, 1.0)], [channel(0.1)], 3.0
    )
    J = np.tile([1.0, 1.0, 0.0], (40, 1))
    fed(horizon, 0.1 * np.arange(40), np.full(40, 4.0), J)
    told = horizon.not_observable()
    assert any("weight and offset cannot be told apart" in text for text in told)
    assert any(text.startswith("other: the sensors have not shown it") for text in told)
    moving = np.column_stack([1.0 + 0.5 * np.sin(np.arange(40)), np.ones(40), np.zeros(40)])
    fed(horizon, 4.0 + 0.1 * np.arange(40), moving @ [3.0, 1.0, 0.0], moving)
    assert not any("told apart" in text for text in horizon.not_observable())


def test_one_wild_sample_does_not_move_the_estimate():
    rng = np.random.default_rng(6)
    y = 3.0 + 0.05 * rng.standard_normal(60)
    y[40] = 300.0
    horizon = fed(Horizon([unknown("a", 3.0, 1.0)], [channel(0.05)], 3.0), 0.1 * np.arange(60), y, np.ones((60, 1)))
    assert abs(horizon.mean[0] - 3.0) < 0.06


@pytest.mark.parametrize(("left_before", "remembered"), [(60.0, 0.6), (1.2, 1.2)])
def test_what_a_first_guess_left_unexplained_is_forgotten_and_noise_of_inputs_is_not(left_before, remembered):
    rng = np.random.default_rng(4)
    noise = {k: rng.standard_normal(1) for k in range(40)}

    def rows(size):
        row = np.array([[1.0, 0.0]])
        return [Sample(0.1 * k, 3.0 + size * noise[k], np.zeros(1), row, np.ones(1, bool)) for k in range(40)]

    horizon = Horizon([unknown("a", 3.0, 5.0), unknown("swing", 0.0, 1.0)], [channel(1.0)], 5.0, free=1)
    horizon.shaken = True
    for one in rows(left_before):
        horizon.add(one)
    # The same readings beside simulations that were begun anew with what was found: their own noise alone is left.
    horizon.replaced(rows(remembered), np.zeros(2))
    assert np.sqrt(horizon.spread[0]) == pytest.approx(remembered, rel=0.3)
    assert horizon.learned[0] == (1.0 if left_before > 2.0 * remembered else 34.0)


def test_samples_of_a_first_guess_that_have_left_a_short_window_do_not_keep_the_estimate_from_the_truth():
    # What is measured is the square of the unknown: its line from 3 says 1.67 where the truth is 1.
    rng, truth = np.random.default_rng(7), 1.0
    horizon = Horizon([unknown("a", 3.0, 1.5)], [channel(0.05)], 1.0)

    def at(time, y):
        a = horizon.theta0[0]
        return Sample(time, np.array([y]), np.array([a**2]), np.array([[2.0 * a]]), np.ones(1, bool))

    for k in range(150):
        horizon.add(at(0.05 * k, truth**2 + 0.05 * rng.standard_normal()))
        if k % 25 == 24:  # a window is gone through anew later than it lasts
            a, kept = horizon.mean.copy(), list(horizon.samples)
            horizon.theta0 = a
            horizon.replaced([at(one.time, one.y[0]) for one in kept], a)
        if k > 25:
            assert abs(horizon.mean[0] - truth) < 3.0 * horizon.deviation[0]
    assert horizon.mean[0] == pytest.approx(truth, abs=0.01)


def told_by_two(off, rows=160):
    """A horizon of one unknown, 3, that two sensors show alike; the second is off by so much."""
    rng = np.random.default_rng(5)
    horizon = Horizon([unknown("a", 3.0, 2.0)], [channel(0.05), channel(0.05)], 4.0)
    for k in range(rows):
        y = 3.0 + 0.05 * rng.standard_normal(2) + np.array([0.0, off])
        horizon.add(Sample(0.05 * k, y, np.full(2, 3.0), np.ones((2, 1)), np.ones(2, bool)))
    return horizon


@pytest.mark.parametrize("off", [0.1, 0.2, 0.5, 1.0])
def test_where_two_sensors_contradict_each_other_the_truth_is_within_three_stated_deviations(off):
    horizon = told_by_two(off)
    wrong = abs(horizon.mean[0] - 3.0)
    assert wrong > 3.0 * horizon.linear_deviation[0]  # what the number of rows makes of it
    assert wrong < 3.0 * horizon.stated[0] < 3.0 * horizon.first_sd[0]


def test_sensors_that_agree_add_nothing_to_the_deviation():
    horizon = told_by_two(0.0)
    assert np.array_equal(horizon.stated, horizon.deviation)


def test_what_all_rows_of_a_sensor_are_off_by_is_left_of_the_window_though_it_is_no_noise():
    # Half of 0.5 N each are 5 deviations of a sensor of 0.05 N.
    horizon = told_by_two(1.0)
    assert np.all(horizon.spread < 4.0)
    assert max(horizon.left) > 5.0**2
    assert np.all(told_by_two(0.0).left < 2.0)


def test_what_readings_have_put_in_doubt_stays_so_while_nothing_is_measured_and_until_readings_agree_again():
    """The value goes from 3 to 4 at 10 s, as the sensor dies after so few readings that nothing is released."""
    rng = np.random.default_rng(3)
    horizon, stated = Horizon([unknown("a", 3.0, 2.0)], [channel(0.05)], 3.0), []
    for k in range(250):
        time = 0.1 * k
        value, dead = 3.0 + (10.0 < time < 20.0), 10.9 < time < 20.0
        y = np.array([np.nan if dead else value + 0.05 * rng.standard_normal()])
        horizon.add(Sample(time, y, np.ones(1) * horizon.theta0, np.ones((1, 1)), np.array([not dead])))
        stated.append(float(horizon.stated[0]))
    assert horizon.released == -np.inf and stated[95] < 0.02
    assert min(stated[109:200]) > 0.2 and abs(horizon.mean[0] - 3.0) < 0.05
    assert stated[-1] < 0.03
