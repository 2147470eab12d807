"""The error that generalized-alpha states of one step, against a motion whose acceleration grows evenly."""

from types import SimpleNamespace

import numpy as np
import pytest

from tautline.integrators.generalized_alpha import DEPTH, _local_error, alphas, coefficients


@pytest.mark.parametrize("rho_inf", [0.0, 0.5, 0.9, 1.0])
def test_the_stated_error_is_that_of_the_methods_formula_for_an_acceleration_that_grows_evenly(rho_inf):
    """x.. = a + j t: x moves by a h^2/2 + j h^3/6; the method by h^2 ((1/2 - beta) a + beta (a + j h))."""
    beta, _ = coefficients(*alphas(rho_inf))
    h, begin, jerk, length = 0.03, np.array([2.0, -1.0, 0.5]), np.array([1.0, -40.0, 7.0]), np.array([1.0, 0.5, 2.0])
    exact = 0.5 * begin * h**2 + jerk * h**3 / 6.0
    method = h**2 * ((0.5 - beta) * begin + beta * (begin + jerk * h))
    history = np.zeros((DEPTH, 3))
    history[1] = begin
    state = SimpleNamespace(q=np.zeros(3), a=begin + jerk * h, counters=np.zeros(8, np.int64))
    scratch = SimpleNamespace(beta=beta, length=length, history=history, newest=np.array([1]))
    stated = getattr(_local_error, "py_func", _local_error)(scratch, state, h)
    assert stated == pytest.approx(np.abs(length * (method - exact)).max(), rel=1e-9)
