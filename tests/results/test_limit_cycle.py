"""The motion of a hose's tip is told right from histories whose answer is known."""

import warnings

import numpy as np
import pytest
from figures.synthetic_hose import result
from of_the_suite import studies
from scipy.integrate import solve_ivp

from gardenhose.motion.curves import Trace
from gardenhose.motion.cycles import swings
from gardenhose.motion.limit_cycle import LimitCycle, limit_cycle
from gardenhose.summary import headline
from tautline.results.headline import to_json
from tautline.view.figures.spectrum import spectrum

TURN = 2.0 * np.pi
RATE = 20.37  # frames a second: no whole number of them in a period of 1 s


def moving(time, value, rate, direction=(0.0, 0.0, 1.0), mean=(0.4, 0.1, -0.2)):
    """A point at `mean` that moves along a direction."""
    direction = np.array(direction) / np.linalg.norm(direction)
    return time, np.outer(value, direction) + mean, np.outer(rate, direction)


def sine(periods=12.2, rate=RATE, size=1.0, growth=0.0, start=0.3, **where):
    time = np.arange(0.0, periods, 1.0 / rate)
    envelope, angle = size * np.exp(growth * time), TURN * time + start
    return moving(time, envelope * np.sin(angle), envelope * (TURN * np.cos(angle) + growth * np.sin(angle)), **where)


def sum_of(sizes, factors, periods=60.0, phase=0.4):
    time = np.arange(0.0, periods, 1.0 / RATE)
    value = sum(a * np.sin(TURN * k * time + phase * k) for a, k in zip(sizes, factors, strict=True))
    rate = sum(TURN * k * a * np.cos(TURN * k * time + phase * k) for a, k in zip(sizes, factors, strict=True))
    return moving(time, value, rate)


def finite(cycle):
    for name in LimitCycle.__dataclass_fields__:
        value = getattr(cycle, name)
        if not isinstance(value, str):
            assert np.isfinite(value).all(), name
    return cycle


@pytest.mark.parametrize(("rate", "tolerance"), [(20.37, 1e-9), (10.3, 1e-6), (6.1, 1e-4)])
def test_a_sine_has_its_frequency_and_amplitude(rate, tolerance):
    cycle = finite(limit_cycle(*sine(rate=rate)))
    assert cycle.kind == "periodic" and cycle.settled and cycle.loops == 1 and cycle.cycles == 11
    assert cycle.frequency == pytest.approx(1.0, rel=min(tolerance, 1e-6))
    assert cycle.amplitude == pytest.approx(1.0, rel=tolerance)
    assert cycle.max_speed == pytest.approx(TURN, rel=max(tolerance, 1e-7))
    np.testing.assert_allclose(cycle.axis_amplitude, [0.0, 0.0, 1.0], atol=max(tolerance, 1e-7))
    np.testing.assert_allclose(cycle.mean, [0.4, 0.1, -0.2], atol=tolerance)
    assert cycle.scatter < 10 * tolerance and abs(cycle.log_decrement) < 10 * tolerance
    assert cycle.period == 1.0 / cycle.frequency and cycle.end - cycle.start == pytest.approx(11.0, rel=tolerance)


def test_frames_at_uneven_intervals_serve_as_well():
    rng = np.random.default_rng(1)
    time = np.cumsum(rng.uniform(0.7, 1.3, 250)) / RATE
    cycle = limit_cycle(*moving(time, np.sin(TURN * time), TURN * np.cos(TURN * time)))
    assert cycle.kind == "periodic"
    assert cycle.frequency == pytest.approx(1.0, rel=1e-7) and cycle.amplitude == pytest.approx(1.0, rel=1e-7)


@pytest.mark.parametrize("growth", [-0.7, -0.05, -0.005, 0.005, 0.05, 0.7])
def test_growth_and_decay_are_told_with_their_rate(growth):
    cycle = finite(limit_cycle(*sine(growth=growth)))
    assert cycle.kind == ("growing" if growth > 0 else "decaying") and not cycle.settled
    assert cycle.growth_rate == pytest.approx(growth, rel=1e-4)
    assert cycle.log_decrement == pytest.approx(-growth, rel=1e-4)
    assert cycle.frequency == pytest.approx(1.0, rel=2e-6)


def test_a_decay_that_would_take_the_run_many_times_over_counts_as_periodic():
    assert limit_cycle(*sine(growth=-2e-4)).kind == "periodic"


def test_a_motion_that_has_died_out_is_at_rest():
    cycle = finite(limit_cycle(*sine(growth=-3.0)))
    assert cycle.kind == "rest" and cycle.settled and cycle.amplitude == cycle.frequency == 0.0
    np.testing.assert_allclose(cycle.mean, [0.4, 0.1, -0.2], atol=1e-9)


def test_rest_is_a_share_of_the_length():
    assert limit_cycle(*sine(size=2e-10), 0.5).kind == "rest"
    tiny = limit_cycle(*sine(size=2e-9), 0.5)
    assert tiny.kind == "periodic" and tiny.amplitude == pytest.approx(2e-9, rel=1e-6)


def van_der_pol(frames):
    period = 6.6632868593  # at mu = 1; the amplitude is 2.008619861
    time = np.arange(0.0, 25 * period, period / frames)

    def rates(_, y):
        return [y[1], (1.0 - y[0] ** 2) * y[1] - y[0]]

    done = solve_ivp(rates, (0.0, time[-1] + 1.0), [1e-3, 0.0], t_eval=time, rtol=1e-11, atol=1e-12, method="DOP853")
    return period, moving(time, *done.y)


@pytest.mark.parametrize(("frames", "tolerance"), [(20.3, 2e-6), *studies((40.7, 3e-8))])
def test_van_der_pols_limit_cycle_from_a_small_start(frames, tolerance):
    period, history = van_der_pol(frames)
    cycle = finite(limit_cycle(*history))
    assert cycle.kind == "periodic" and cycle.settled and cycle.cycles >= 5
    assert cycle.period == pytest.approx(period, rel=tolerance)
    assert cycle.amplitude == pytest.approx(2.008619861, rel=tolerance)


@pytest.mark.parametrize(
    ("sizes", "factors"),
    [((1.0, 0.3), (1, 2)), ((1.0, 0.8), (1, 2)), ((1.0, 0.8), (1, 3)), ((1.0, 0.4, 0.3), (1, 2, 3))],
)
def test_harmonics_do_not_hide_the_period(sizes, factors):
    cycle = limit_cycle(*sum_of(sizes, factors))
    assert cycle.kind == "periodic" and cycle.frequency == pytest.approx(1.0, rel=1e-6)
    angle = np.linspace(0.0, TURN, 20001)
    exact = sum(a * np.sin(k * (angle + 0.4)) for a, k in zip(sizes, factors, strict=True))
    assert cycle.amplitude == pytest.approx(0.5 * np.ptp(exact), rel=1e-4)


def test_a_doubled_period_is_one_cycle_of_two_loops():
    cycle = limit_cycle(*sum_of((1.0, 0.3), (1.0, 0.5)))
    assert cycle.kind == "periodic" and cycle.loops == 2
    assert cycle.frequency == pytest.approx(0.5, rel=1e-7)


def test_two_frequencies_without_a_common_period_are_irregular():
    for other in (np.sqrt(2.0), 1.02):
        cycle = finite(limit_cycle(*sum_of((1.0, 0.3), (1.0, other))))
        assert cycle.kind == "irregular" and not cycle.settled


def test_noise_hardly_moves_the_answer_and_alone_is_irregular():
    rng = np.random.default_rng(0)
    time, position, velocity = sine(periods=20.0)
    for size in (1e-4, 3e-3):
        noisy = position + size * rng.normal(size=position.shape)
        cycle = limit_cycle(time, noisy, velocity + TURN * size * rng.normal(size=position.shape))
        assert cycle.kind == "periodic" and cycle.settled
        assert cycle.frequency == pytest.approx(1.0, abs=0.02 * size)
        assert cycle.amplitude == pytest.approx(1.0, abs=size)
    only = finite(limit_cycle(time, rng.normal(size=position.shape), rng.normal(size=position.shape)))
    assert only.kind == "irregular"


def test_an_inclined_plane_of_motion_is_found():
    time = np.arange(0.0, 12.2, 1.0 / RATE)
    along, across = np.array([0.6, 0.0, 0.8]), np.array([0.0, 1.0, 0.0])
    angle = TURN * time
    position = np.outer(np.sin(angle), along) + np.outer(0.1 * np.sin(2 * angle), across) + [1.0, 2.0, 3.0]
    velocity = TURN * (np.outer(np.cos(angle), along) + np.outer(0.2 * np.cos(2 * angle), across))
    cycle = limit_cycle(time, position, velocity)
    np.testing.assert_allclose(cycle.direction, along, atol=1e-8)
    np.testing.assert_allclose(np.abs(cycle.normal), [0.8, 0.0, 0.6], atol=1e-8)
    assert cycle.out_of_plane < 1e-8
    np.testing.assert_allclose(cycle.axis_amplitude, [0.6, 0.1, 0.8], rtol=1e-7)
    np.testing.assert_allclose(cycle.mean, [1.0, 2.0, 3.0], atol=1e-9)


def test_a_tip_that_whirls_has_the_radius_as_amplitude():
    time = np.arange(0.0, 12.2, 1.0 / RATE)
    angle = TURN * time
    position = 0.3 * np.stack([0 * angle, np.cos(angle), np.sin(angle)], axis=1)
    velocity = 0.3 * TURN * np.stack([0 * angle, -np.sin(angle), np.cos(angle)], axis=1)
    cycle = limit_cycle(time, position, velocity)
    assert cycle.kind == "periodic" and cycle.amplitude == pytest.approx(0.3, rel=1e-7)
    np.testing.assert_allclose(cycle.normal, [1.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(cycle.axis_amplitude, [0.0, 0.3, 0.3], rtol=1e-7, atol=1e-12)


def test_a_transient_is_left_out():
    time = np.arange(0.0, 20.0, 1.0 / RATE)
    drop = np.exp(-time)
    cycle = limit_cycle(*moving(time, drop + 0.05 * np.sin(TURN * time), -drop + 0.05 * TURN * np.cos(TURN * time)))
    assert cycle.kind == "periodic" and cycle.start > 10.0
    assert cycle.amplitude == pytest.approx(0.05, rel=1e-5)


@pytest.mark.parametrize("periods", [1.3, 2.2, 3.1])
def test_too_few_cycles_are_said_so(periods):
    cycle = finite(limit_cycle(*sine(periods=periods)))
    assert not cycle.settled and cycle.cycles < 3 and "whole cycle" in cycle.note


@pytest.mark.parametrize("frames", range(8))
def test_a_run_of_few_frames_is_no_cause_for_alarm(frames):
    time, position, velocity = sine()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cycle = finite(limit_cycle(time[:frames], position[:frames], velocity[:frames]))
    assert not cycle.settled and cycle.cycles == 0 and cycle.note


@pytest.mark.parametrize(
    ("value", "rate", "kind"),
    [
        (lambda t: 0 * t, lambda t: 0 * t, "rest"),
        (lambda t: t, lambda t: 1 + 0 * t, "irregular"),
        (lambda t: 1 - np.exp(-t / 3), lambda t: np.exp(-t / 3) / 3, "decaying"),
        (lambda t: np.exp(t / 3), lambda t: np.exp(t / 3) / 3, "growing"),
        (lambda t: np.tanh(5 * (t - 5)), lambda t: 5 / np.cosh(5 * (t - 5)) ** 2, "rest"),
        (lambda t: np.sin(TURN * t), lambda t: 0 * t, None),
        (lambda t: 1e300 * t, lambda t: 1e300 + 0 * t, None),
        (lambda t: 1e-300 * np.sin(TURN * t), lambda t: 0 * t, "rest"),
        (np.floor, lambda t: 0 * t, None),
        (lambda t: np.where(t < 5, t, np.nan), lambda t: 0 * t, None),
    ],
    ids=["still", "steady", "creeping", "fleeing", "stepped", "no rate", "huge", "tiny", "jumps", "not finite"],
)
def test_histories_without_cycles_have_an_answer(value, rate, kind):
    time = np.linspace(0.0, 20.0, 401)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cycle = finite(limit_cycle(*moving(time, value(time), rate(time))))
    assert cycle.kind == (kind or cycle.kind) and cycle.kind in ("rest", "periodic", "growing", "decaying", "irregular")
    assert cycle.cycles == 0


def test_a_motion_that_blows_up_between_frames_without_a_whole_cycle_is_not_said_to_decay():
    # A hose at 300 m/s that was stopped after 0.18 s: frames every 20 ms follow none of its swings.
    time = np.linspace(0.0, 0.18, 10)
    place, rate = np.zeros((10, 3)), np.zeros((10, 3))
    place[:, 0] = [0.0, 0.0, -1.438, 0.212, 1.255, 4.031, 3.421, 2.65, 2.83, 1.027]
    place[:, 2] = [0.999, 1.226, 3.232, 1.835, 4.791, 5.647, 4.399, 3.303, 3.462, 5.157]
    rate[:, 0] = [0.1, 9.484, -48.47, 165.212, 153.835, 29.375, -230.688, 227.671, 208.716, -3.521]
    rate[:, 2] = [0.0, 77.117, 248.348, -113.879, 169.67, 279.308, -253.182, -167.906, 195.071, 178.846]
    cycle = finite(limit_cycle(time, place, rate, 4.0))
    assert cycle.cycles == 0 and cycle.kind == "not determined"


def test_frames_that_repeat_a_time_are_left_out():
    time, position, velocity = sine()
    twice = np.sort(np.concatenate([np.arange(len(time)), [5, 50, 100]]))
    assert (
        limit_cycle(time[twice], position[twice], velocity[twice]).amplitude
        == limit_cycle(time, position, velocity).amplitude
    )


def test_a_spectrum_shows_a_line_with_its_amplitude():
    for frequency in (1.0, 1.237):
        time = np.arange(0.0, 12.2, 1.0 / RATE)
        at, amplitude = spectrum(time, 0.7 * np.sin(TURN * frequency * time) + 5.0)
        assert amplitude.max() == pytest.approx(0.7, rel=0.01)
        assert at[amplitude.argmax()] == pytest.approx(frequency, abs=0.02)
    uneven = time + 0.01 * np.sin(time)
    assert spectrum(uneven, np.sin(TURN * uneven))[1].max() == pytest.approx(1.0, rel=0.01)
    assert all(len(array) == 0 for array in spectrum(time[:3], time[:3]))
    assert spectrum(time, np.full(len(time), 0.3))[1].max() < 1e-15


def test_ripple_is_no_swing():
    time = np.arange(0.0, 10.0, 0.005)
    value = np.sin(TURN * time) + 0.02 * np.sin(41 * time)
    found = swings(time, value, TURN * np.cos(TURN * time) + 0.82 * np.cos(41 * time))
    assert len(found.time) == 20 and np.all(np.diff(np.sign(found.value)) != 0.0)


def test_a_trace_takes_polynomials_of_degree_seven_exactly():
    polynomial = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0, -1.0, 0.2, 0.3, -0.1])
    time = np.array([0.0, 0.2, 0.5, 0.7, 1.1, 1.2])
    trace = Trace(time, polynomial(time), polynomial.deriv()(time))
    at = np.linspace(0.0, 1.2, 50)
    np.testing.assert_allclose(trace(at)[0], polynomial(at), atol=1e-12)
    np.testing.assert_allclose(trace(at)[1], polynomial.deriv()(at), atol=1e-11)


def test_the_headline_has_its_keys_and_is_plain():
    run = result(frames=601)
    figures = headline(run)
    assert list(figures) == [
        "motion", "tip_amplitude", "frequency", "cycles", "tip_speed_max", "tip_mean", "axial_force_max",
        "axial_force_min", "flow_speed",
    ]  # fmt: skip
    assert all(figure.keys() == {"value", "unit", "text"} for figure in figures.values())
    values = {name: figure["value"] for name, figure in figures.items()}
    assert values["motion"] == "periodic" and isinstance(values["cycles"], int)
    assert values["frequency"] == pytest.approx(6.3, rel=1e-4)
    assert values["flow_speed"] == 35.0 and len(values["tip_mean"]) == 3
    assert (
        values["axial_force_max"] == run["axial_force"].max() and values["axial_force_min"] == run["axial_force"].min()
    )
    assert "null" not in to_json(figures)


def test_the_headline_of_one_frame_has_no_frequency():
    figures = headline(result(frames=1))
    assert figures["frequency"]["value"] is None and figures["cycles"]["value"] == 0
    assert "no whole cycle" in figures["motion"]["text"]
