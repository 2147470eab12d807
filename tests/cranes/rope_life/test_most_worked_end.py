"""The most worked end is that whose rainflow cycles do most damage, counted of every end by a reference of its own."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import tautline
from crane.application import Crane
from crane.results.summary import ends_of, most_worked_end
from tautline.errors import ArgumentError
from tautline.simulation import simulate

SNAPPING = """
title: A rope over three sheaves that goes slack and snaps
rope: {mass_per_length: 6.5, axial_stiffness: 80 MN, diameter: 36 mm, breaking_load: 1.1 MN, compression: none}
bodies:
  - {name: load, mass: 5000, position: [12.4, 0, -20]}
path:
  - drum: {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: s0, center: [4, 0, 10.00], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20, law: capstan,
             friction: 0.1}
  - sheave: {name: s1, center: [8, 0, 12.85], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20, law: capstan,
             friction: 0.1}
  - sheave: {name: s2, center: [12, 0, 15.40], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20, law: capstan,
             friction: 0.1}
  - end: {name: hook, body: load}
mesh: {elements_per_span: 1}
vessel:
  reference: [0, 0, 0]
  motion: {heave: {harmonic: {amplitude: 1.6, period: 2.4, ramp: 5}}}
start: static
solver: {step: 5 ms, end: 30}
output: {interval: 20 ms}
"""
SLOPE = 5.0


def astm(values):
    """ASTM E1049-85, section 5.4.4, step by step as it is written there: pairs of range and count."""
    turns = [values[0]]
    for value in values[1:]:
        if value == turns[-1]:
            continue
        if len(turns) > 1 and (value - turns[-1]) * (turns[-1] - turns[-2]) > 0.0:
            turns[-1] = value
        else:
            turns.append(value)
    points, found = [], []
    for turn in turns:
        points.append(turn)
        while len(points) >= 3:
            x, y = abs(points[-1] - points[-2]), abs(points[-2] - points[-3])
            if x < y:
                break
            if len(points) == 3:
                found.append((y, 0.5))
                points.pop(0)
            else:
                found.append((y, 1.0))
                del points[-3:-1]
    return found + [(abs(b - a), 0.5) for a, b in itertools.pairwise(points)]


def damage(cycles):
    return sum(count * (size / 1e5) ** SLOPE for size, count in cycles)


def reference(tension):
    """Column, equivalent range, N, and cycles of the worst of the columns of (m, n) tensions."""
    found = [astm(column.tolist()) for column in tension.T]
    k = max(range(len(found)), key=lambda column: damage(found[column]))
    cycles = sum(count for _, count in found[k])
    return k, 1e5 * (damage(found[k]) / cycles) ** (1.0 / SLOPE), cycles


def test_the_reference_counts_the_example_of_the_standard():
    # Figure 6 of ASTM E1049-85: ranges 3, 4, 6, 8, 8, 9 of which the one of 4 at E-F is closed.
    found = sorted(astm([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    assert found == [(3.0, 0.5), (4.0, 0.5), (4.0, 1.0), (6.0, 0.5), (8.0, 0.5), (8.0, 0.5), (9.0, 0.5)]


def test_a_ripple_does_not_hide_the_large_swing_that_it_rides_on():
    time = np.linspace(0.0, 100.0, 10001)
    swing = 50e3 + 20e3 * np.sin(2 * np.pi * time / 50) + 3e3 * np.sin(2 * np.pi * time * 2)
    smooth = [50e3 + (7e3 + 10 * k) * np.sin(2 * np.pi * time / 5) for k in range(3)]
    tension = np.column_stack([*smooth, swing])
    k, cycles = most_worked_end(time, tension)
    assert k == reference(tension)[0] == 3
    assert cycles.range[0] == pytest.approx(np.ptp(swing), rel=1e-12)


def test_slack_at_exactly_no_tension_does_not_hide_turns():
    # Down to a plateau of nothing and up again: the plateau is a turn, though no frame lies beyond both neighbours.
    time = np.arange(4001) * 0.02
    slack = np.maximum(60e3 * np.sin(2 * np.pi * time / 4.0), 0.0)
    tension = np.column_stack([*(80e3 + (15e3 + k) * np.sin(2 * np.pi * time / 1.0) for k in range(3)), slack])
    assert most_worked_end(time, tension)[0] == reference(tension)[0] == 3


@pytest.mark.parametrize("seed", range(5))
def test_the_most_worked_of_random_ends_is_that_of_the_standard(seed):
    draw = np.random.default_rng(seed)
    tension = np.maximum(np.cumsum(draw.normal(size=(600, 8)) * 4e3, axis=0) + draw.normal(size=(600, 8)) * 9e3, 0.0)
    k, cycles = most_worked_end(np.arange(600.0), tension)
    worst, size, count = reference(tension)
    assert k == worst and cycles.count.sum() == count
    assert damage(zip(cycles.range, cycles.count, strict=True)) == pytest.approx(count * (size / 1e5) ** SLOPE)


def test_equal_ends_are_told_as_the_first_of_the_path():
    time = np.linspace(0.0, 20.0, 2001)
    one = 5e4 + 1e4 * np.sin(time)
    assert most_worked_end(time, np.column_stack([one, one * (1.0 + 1e-9)]))[0] == 0


def test_a_tension_that_is_not_a_number_is_refused():
    tension = np.ones((5, 2))
    tension[3, 1] = np.nan
    with pytest.raises(ArgumentError, match="frame 3"):
        most_worked_end(np.arange(5.0), tension)


@pytest.fixture(scope="module")
def snapping():
    build, scene = Crane().build, tautline.read(SNAPPING)
    kept = scene.replace({"output": {"interval": 0.02, "keep": "statistics"}})
    return simulate(build(scene)), simulate(build(kept))


def test_a_rope_that_snaps_has_the_figures_of_its_most_worked_end_with_frames_and_with_statistics(snapping):
    full, _ = snapping
    tension = ends_of(full)
    assert (tension == 0.0).any(axis=0).sum() >= 2
    _, size, count = reference(tension)
    for run in snapping:
        assert run.headline["equivalent_tension_range"]["value"] == pytest.approx(size, rel=1e-9)
        assert run.headline["tension_cycles"]["value"] == count
    texts = [run.headline["equivalent_tension_range"]["text"] for run in snapping]
    assert texts[0] == texts[1]
