"""Extremes of shorter storms are scaled in a steady state alone: what grows while storms last is found and told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from storms.test_operability import ALONE, SCENE, asked

import tautline
from crane.application import Crane
from crane.operability.storms import operability
from tautline.statistics.trends import PARTS, TREND, Trends, grows, trend

PENDULUM = (
    SCENE.replace("heave: {", "surge: {").replace("rao: 0.8", "rao: 0.03, ramp: 10 s").replace("50 ms", "200 ms")
    .replace("[0, 0, 10]", "[0, 0, 20]").replace("mass_per_length: 0.01", "mass_per_length: 1")
)  # fmt: skip
SWINGS = PENDULUM.replace("position: [0, 0, 0]}", "position: [0, 0, 0], drag: {linear: [0, 0, 0]}}")
DAMPED = PENDULUM.replace("position: [0, 0, 0]}", "position: [0, 0, 0], drag: {linear: [2000, 2000, 0]}}").replace(
    "mesh:", "water: {surface: 30, density: 1025}\nmesh:"
)
LIMIT = "load.position[0] < 3 m"


def block_maxima(envelopes):
    return envelopes[..., : envelopes.shape[-1] // PARTS * PARTS].reshape(*envelopes.shape[:-1], PARTS, -1).max(axis=-1)


def slopes_of(envelopes):
    return np.apply_along_axis(trend, -1, block_maxima(envelopes))


def test_the_trend_is_the_line_of_least_squares():
    parts = np.random.default_rng(1).standard_normal(PARTS)
    assert trend(parts) == pytest.approx(np.polyfit(np.linspace(0.0, 1.0, PARTS), parts, 1)[0], rel=1e-12)
    assert np.isnan(trend(np.array([1.0, np.nan, 2.0])))


@pytest.mark.parametrize("runs", [3, 10])
def test_one_steady_state_in_forty_is_taken_for_one_that_grows(runs):
    """Largest of Gaussian noise in parts; two states that hang together, as those of one seed do."""
    studies = 2000
    noise = np.random.default_rng(2).standard_normal((studies, runs, PARTS * 50))
    slopes = slopes_of(noise)
    told = np.mean([grows(np.stack([one, 2.0 * one])) for one in slopes])
    # The binomial error of 2000 studies is 0.35 %.
    assert 0.025 - 4 * 0.0035 < told < 0.025 + 4 * 0.0035


def test_nine_studies_of_ten_storms_in_ten_find_a_swing_that_nothing_damps():
    """The envelope of an undamped pendulum in broad waves is the size of a random walk in the plane."""
    steps = np.random.default_rng(3).standard_normal((2, 300, 10, 500)).cumsum(axis=-1)
    envelope = np.hypot(*steps)[..., 50:]
    assert np.mean([grows(slopes_of(one)[None]) for one in envelope]) > 0.8


@pytest.mark.filterwarnings("error")
def test_numbers_near_the_largest_there_are_overflow_in_no_trend():
    noise = np.random.default_rng(4).standard_normal((2, 8))
    for shift in (0.0, 3.0):
        slopes = noise + shift
        assert grows(1e300 * slopes) == grows(slopes) == (shift > 0.0)
        assert grows(np.where(slopes == slopes[0, 0], np.inf, slopes)) == (shift > 0.0)
    assert not grows(np.full((2, 5), np.inf)) and not grows(np.empty((0, 5)))
    line = np.arange(PARTS) / (PARTS - 1)
    assert trend(1e307 * (10.0 + line)) == pytest.approx(1e307, rel=1e-12)
    assert trend(1e308 * (2.0 * line - 1.0)) == np.inf or trend(1e308 * line) == pytest.approx(1e308)


def test_storms_without_a_trend_and_one_storm_tell_nothing():
    assert not grows(np.full((2, 5), np.nan)) and not grows(np.zeros((1, 5))) and not grows(np.ones((1, 1)))
    assert not grows(np.empty((0, 5)))
    assert grows(np.ones((1, 4))), "what every storm does alike is no chance"


@pytest.mark.parametrize("limits", [["max_tension < 65 kN"], ["max_tension < 65 kN", "max_snap < 1 MN"]])
def test_trends_of_statistics_and_of_frames_are_those_of_block_maxima_found_by_hand(limits, tmp_path):
    scene = tautline.read(SCENE.replace("50 ms", "100 ms"))
    found = operability(Crane(), scene, asked((0.9,), 3, 240.0, 60.0, limits=limits), ALONE)
    key = "vessel.motion.heave.spectrum"
    sea = {f"{key}.significant_height": 0.9, f"{key}.seed": 2, f"{key}.ramp": 10.0, "solver.end": 80.0}
    run = tautline.simulate(scene.replace(sea))
    tension = run["tension"].reshape(len(run.time), -1).max(axis=1)
    edges = np.linspace(20.0, 80.0, PARTS + 1)
    part = np.minimum(np.searchsorted(edges - 1e-9, run.time, side="right") - 1, PARTS - 1)
    parts = [tension[part == k].max() for k in range(PARTS)]
    by_hand = np.polyfit(np.linspace(0.0, 1.0, PARTS), parts, 1)[0]
    assert found.outcome.data[f"max_tension{TREND}"].values[1] == pytest.approx(by_hand, rel=1e-6)


def test_an_output_has_the_same_trend_as_the_figure_of_it():
    time = np.linspace(20.0, 80.0, 601)
    values = np.random.default_rng(5).standard_normal(601)
    found = Trends({"x max": "largest"}, 20.0, 80.0)._of_output(values, time, "largest")
    assert found == pytest.approx(
        np.append([values[100 * k : 100 * (k + 1)].max() for k in range(5)], values[500:].max())
    )


@pytest.mark.parametrize(("scene", "told"), [(SWINGS, True), (DAMPED, False)])
def test_a_swing_without_damping_is_not_scaled_without_a_word_and_a_damped_one_is(scene, told):
    given = replace(asked((1.0,), 8, 1200.0, 200.0, limits=[LIMIT]), lead=20.0)
    given = replace(given, conditions=[one._replace(period=9.0) for one in given.conditions])
    found = operability(Crane(), tautline.read(scene), given, ALONE)
    about = [one for one in found.warnings if "steady state" in one]
    assert bool(about) == told
    if told:
        assert "load.position[0] gets worse while a storm lasts" in about[0] and "--simulate 1200s" in about[0]


def test_storms_as_long_as_the_operation_have_no_trend():
    found = operability(Crane(), tautline.read(SWINGS), asked((1.0,), 3, 60.0, limits=[LIMIT]), ALONE)
    assert not any(name.endswith(TREND) for name in found.outcome.data.data_vars)
