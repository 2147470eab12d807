"""Rope on a drum in layers, turn by turn."""

import math

import numpy as np
import pytest

from crane.results.observe import layers_of
from crane.scene.scene import Drum

DIAMETER, TURNS, CORE = 0.03, 10, 0.5


def drum(**keys):
    return Drum(name="winch", radius=0.53, axis=(0, 1, 0), wrap="over", center=(0, 0, 0), pay_out=0, **keys)


def radius(layer):
    return CORE + DIAMETER * (0.5 + (layer - 1) * math.sqrt(3.0) / 2.0)


def test_three_layers_unwound_turn_by_turn():
    """Two full layers and half of the third, counted by hand: each layer's turns at its own radius."""
    full = [2.0 * math.pi * TURNS * radius(j) for j in (1, 2, 3)]
    held = full[0] + full[1] + 0.5 * full[2]
    wound = layers_of(drum(layers={"turns": TURNS, "core_radius": CORE}, rope_on_drum=held), DIAMETER, 1.0)
    out = np.array([0.0, 0.5 * full[2] - 1e-9, 0.5 * full[2] + full[1], held])
    assert wound.radius_at(out[:2]) == pytest.approx([radius(3), radius(3)])
    assert wound.radius_at(out[1:2] + 1.0) == pytest.approx([radius(2)])
    assert wound.rotation_at(out) / (2.0 * math.pi) == pytest.approx([0.0, 5.0, 15.0, 25.0], abs=1e-6)
    assert wound.rotation_at(np.array([-0.5 * full[2]])) == pytest.approx(-5.0 * 2.0 * math.pi)


@pytest.mark.parametrize("reeled_in", [1.0, 205.0, 5000.0])
def test_layers_go_on_as_long_as_rope_comes(reeled_in):
    """Rope wound on layer by layer, on a drum that begins with 10 m."""
    left, layer, turned = 10.0 + reeled_in, 0, 0.0
    while left > 0.0:
        layer += 1
        length = min(left, 2.0 * math.pi * TURNS * radius(layer))
        left, turned = left - length, turned + length / radius(layer)
    begun = 10.0 / radius(1)
    wound = layers_of(drum(layers={"turns": TURNS, "core_radius": CORE}, rope_on_drum=10.0), DIAMETER, 1.0)
    assert wound.rotation_at(np.array([-reeled_in])) == pytest.approx(begun - turned, rel=1e-12)
    assert wound.radius_at(np.array([-reeled_in])) == pytest.approx(radius(layer))


def test_rope_beyond_the_last_layer_that_there_may_be_lies_in_it():
    wound = layers_of(drum(layers={"turns": TURNS, "core_radius": CORE, "count": 2}, rope_on_drum=10.0), DIAMETER, 1.0)
    assert wound.radius_at(np.array([5.0, -500.0])) == pytest.approx([radius(1), radius(2)])


def test_without_layers_there_is_one_radius():
    wound = layers_of(drum(), None, 1.001)
    assert wound.rotation_at(np.array([5.3])) == pytest.approx(5.3 * 1.001 / 0.53)
    assert wound.radius_at(np.array([5.3])) == pytest.approx(0.53)
