"""Natural modes of a large model, which Lanczos' method finds: the same input gives the same digits, each time."""

import numpy as np
import pytest
from scipy.sparse import csc_array, diags_array

from drillstring.modes.natural_modes import DENSE, modes_below
from tautline.integrators.vibration import modes

COUNT = DENSE + 100
"""Masses, kg, of 1 each, in a row with springs of 1 N/m, held at both ends."""


def chain():
    return csc_array(diags_array([-np.ones(COUNT - 1), 2.0 * np.ones(COUNT), -np.ones(COUNT - 1)], offsets=(-1, 0, 1)))


def frequencies(count):
    """Of the chain, rad/s: 2 sin(k pi / (2 (n + 1)))."""
    return 2.0 * np.sin(np.arange(1, count + 1) * np.pi / (2.0 * (COUNT + 1)))


def test_modes_of_a_string_that_are_found_twice_are_the_same_to_the_last_digit():
    highest = float(frequencies(30)[-1]) * 1.001 / (2.0 * np.pi)
    one, two = (modes_below(np.ones(COUNT), chain(), highest) for _ in range(2))
    assert 2.0 * np.pi * one[0] == pytest.approx(frequencies(30), rel=1e-8)
    assert all(np.array_equal(first, second) for first, second in zip(one, two, strict=True))


def test_the_lowest_modes_of_any_scene_that_are_found_twice_are_the_same_to_the_last_digit(monkeypatch):
    monkeypatch.setattr(modes, "sparse", lambda matrix: matrix)
    mass = csc_array(diags_array(np.ones(COUNT)))
    one, two = (modes._lowest(mass, chain(), 5) for _ in range(2))
    assert np.sqrt(np.sort(one[0])) == pytest.approx(frequencies(5), rel=1e-8)
    assert all(np.array_equal(first, second) for first, second in zip(one, two, strict=True))
