"""Vectors of three numbers in compiled code, of one element and of four in lanes."""

import numpy as np
import pytest

from tautline.kernels import lanes
from tautline.kernels.jit import entry
from tautline.kernels.vector import cross, dot, scaled, scaled_sum


@entry
def _of_one(x, y, s, out):
    out[0] = dot(x, y)
    out[1], out[2], out[3] = cross(x, y)
    out[4], out[5], out[6] = scaled(s, x)
    out[7], out[8], out[9] = scaled_sum(x, s, y)


@entry
def _of_four(x, y, s, out):
    a = lanes.load(x, 0), lanes.load(x, 4), lanes.load(x, 8)
    b = lanes.load(y, 0), lanes.load(y, 4), lanes.load(y, 8)
    factor = lanes.load(s, 0)
    lanes.store(out, 0, dot(a, b))
    for i in range(3):
        lanes.store(out, 4 + 4 * i, cross(a, b)[i])
        lanes.store(out, 16 + 4 * i, scaled(factor, a)[i])
        lanes.store(out, 28 + 4 * i, scaled_sum(a, factor, b)[i])


def by_numpy(x, y, s):
    return np.concatenate([[x @ y], np.cross(x, y), s * x, x + s * y])


def test_products_of_vectors_are_those_of_numpy():
    x, y, out = np.array([1.5, -2.0, 0.25]), np.array([-0.5, 3.0, 7.0]), np.zeros(10)
    _of_one(x, y, -1.25, out)
    assert out == pytest.approx(by_numpy(x, y, -1.25), rel=1e-15)


def test_products_of_vectors_in_lanes_are_those_of_each_element():
    x, y, s = np.random.default_rng(3).uniform(-2.0, 2.0, (3, 3, 4))
    out = np.zeros(40)
    _of_four(x.ravel(), y.ravel(), s[0], out)
    for k in range(4):
        assert out.reshape(10, 4)[:, k] == pytest.approx(by_numpy(x[:, k], y[:, k], s[0, k]), rel=1e-14)
