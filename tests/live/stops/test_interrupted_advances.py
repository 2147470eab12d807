"""Ctrl-C in the middle of an advance: what was on its way goes on along it, and nothing jumps."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest

import tautline

DATA = Path(__file__).parents[3] / "data"
TARGET, UNTIL = 20.0, 11.0


def interrupted_surge():
    """A vessel that is to surge by 20 m from 1 s to 11 s, and is left at some 3 s; its speed goes on at the end."""
    sim = tautline.Simulation(DATA / "hoist.yaml", inputs=["vessel.surge"])
    sim.inputs["vessel.surge"] = 0.1
    sim.advance(1.0)
    sim.inputs["vessel.surge"] = TARGET
    pressed = []

    def press(t, q, v):
        if t > 3.0 and not pressed:
            pressed.append(t)
            os.kill(os.getpid(), signal.SIGINT)
        return [0.0, 0.0, 0.0]

    sim.add_force(press, on="payload.position")
    with pytest.raises(tautline.Interrupted):
        sim.advance_to(UNTIL)
    assert 3.0 < sim.time < 3.2
    return sim


def way(time):
    """The surge (m) that was asked for: the quintic from 0.1 m at 1 s with the rate that two slopes agree on.

    At 1 s the rate is the harmonic mean of none and 0.1 m/s, so zero; at 11 s that of 0.1 and 1.99 m/s.
    """
    h = UNTIL - 1.0
    slope = (TARGET - 0.1) / h
    rate = 2.0 * 0.1 * slope / (0.1 + slope)
    ends = np.array([0.1, 0.0, 0.0, TARGET, rate, 0.0])
    powers = np.arange(6)
    rows = []
    for x in (0.0, h):
        rows += [x**powers, powers * x ** np.maximum(powers - 1, 0)]
        rows.append(powers * (powers - 1) * x ** np.maximum(powers - 2, 0))
    return np.polynomial.Polynomial(np.linalg.solve(np.array(rows, float), ends))(time - 1.0)


def test_an_input_goes_on_along_its_way_after_an_interruption():
    """It went from 1.3 m to 20 m within the next advance of 50 ms, at 375 m/s."""
    sim = interrupted_surge()
    for until in (sim.time + 0.05, 5.0, 7.31, UNTIL):
        sim.advance_to(until)
        assert abs(sim.inputs["vessel.surge"] - way(until)) < 1e-8
        assert abs(sim["boom tip.position"][0] - 12.0 - way(until)) < 1e-8
    sim.advance(1.0)
    assert abs(sim.inputs["vessel.surge"] - TARGET) < 1e-9


def test_an_advance_beyond_the_end_of_an_interrupted_way_comes_to_rest_at_what_was_given():
    sim = interrupted_surge()
    sim.advance_to(UNTIL + 0.5)
    assert abs(sim.inputs["vessel.surge"] - TARGET) < 1e-9
    assert abs(sim["boom tip.velocity"][0]) < 1e-9
    sim.advance(0.5)
    assert abs(sim.inputs["vessel.surge"] - TARGET) < 1e-9


def test_a_state_that_was_saved_after_an_interruption_goes_on_the_same():
    sim = interrupted_surge()
    here = sim.save()
    sim.advance_to(5.0)
    there = sim["payload.position"]
    sim.restore(here)
    sim.advance_to(5.0)
    assert np.array_equal(sim["payload.position"], there)


def test_a_value_that_is_given_after_an_interruption_is_reached_from_where_the_input_stands():
    sim = interrupted_surge()
    sim.inputs["vessel.surge"] = 3.0
    sim.advance(2.0)
    assert abs(sim.inputs["vessel.surge"] - 3.0) < 1e-9
