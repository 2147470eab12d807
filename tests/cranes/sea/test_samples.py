"""Functions known at knots: quintics through value, rate and second rate."""

import numpy as np
import pytest

from tautline.kernels.time_function import sample
from tautline.system.time_functions import FunctionRequest, Samples, compile_functions

END = 2.0


def wave(t):
    return np.array([np.sin(3.0 * t + 0.2), 3.0 * np.cos(3.0 * t + 0.2), -9.0 * np.sin(3.0 * t + 0.2)])


def sampled(pieces, times, integrate=False):
    knots = np.linspace(0.0, END, pieces + 1)
    functions = compile_functions([FunctionRequest(Samples(knots, *wave(knots)), integrate)])
    return sample(functions, 0, np.asarray(times, dtype=float)).T


@pytest.mark.parametrize(("derivative", "order"), [(0, 6), (1, 5), (2, 4)])
def test_the_error_falls_with_the_sixth_power_of_the_spacing(derivative, order):
    times = np.linspace(0.0, END, 1501)[:-1]
    errors = [np.abs(sampled(pieces, times) - wave(times))[derivative].max() for pieces in (6, 12, 24)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(rates - order) < 0.15)
    if derivative == 0:
        h = END / 24
        assert errors[-1] == pytest.approx(h**6 * 3.0**6 / 46080.0, rel=0.1)


def test_knots_are_hit_and_the_curve_is_c2_there():
    knots = np.linspace(0.0, END, 9)[1:-1]
    left, right = sampled(8, np.nextafter(knots, 0.0)), sampled(8, knots)
    assert np.allclose(left, right, atol=1e-11) and np.allclose(right, wave(knots), atol=1e-13)


def test_outside_the_first_and_last_value_are_held():
    assert np.array_equal(sampled(8, [-1.0, -1e-9])[:, 0], [wave(0.0)[0], 0.0, 0.0])
    held = sampled(8, [END + 1e-9, 9.0])
    assert np.all(held[0] == wave(END)[0]) and np.all(held[1:] == 0.0)
    assert np.allclose(sampled(8, [0.0])[:, 0], wave(0.0))


def test_samples_integrate_exactly():
    times = np.linspace(0.0, END, 37)[:-1]
    whole = sampled(40, times, integrate=True)
    assert np.allclose(whole[0], (np.cos(0.2) - np.cos(3.0 * times + 0.2)) / 3.0, atol=1e-10)
    assert np.allclose(whole[1], sampled(40, times)[0], atol=1e-13)


def test_one_knot_is_a_constant():
    functions = compile_functions([FunctionRequest(Samples([1.0], [2.0], [3.0], [4.0]), factor=2.0)])
    assert np.array_equal(sample(functions, 0, np.array([0.0, 1.0, 2.0])), [[4.0, 0.0, 0.0]] * 3)


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        (([0.0, 1.0], [0.0, 1.0], [0.0], [0.0, 0.0]), "rate has the shape"),
        (([], [], [], []), "time has the shape"),
        (([0.0, 0.0], [0.0, 1.0], [0.0, 0.0], [0.0, 0.0]), "do not increase"),
        (([0.0, 1.0], [0.0, np.nan], [0.0, 0.0], [0.0, 0.0]), "value is not finite"),
    ],
)
def test_what_is_no_function_is_refused(columns, words):
    with pytest.raises(ValueError, match=words):
        Samples(*columns)
