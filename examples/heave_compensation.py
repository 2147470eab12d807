"""Heave compensation: rope is paid out as the tip was measured to rise, some time ago.

The load follows z(t) - z(t - delay), the tip's motion less the rope that is paid out late. Of a heave of frequency w
the part 2 sin(w delay / 2) is left.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

import tautline

SCENE = """
title: Load under a heaving ship
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e7, damping: 1.0e-2, diameter: 36 mm, breaking_load: 1.1 MN}
bodies:
  - {name: payload, mass: 5 t, position: [12.4, 0, 5]}
path:
  - drum:   {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20, law: no_slip}
  - end:    {name: hook, body: payload}
mesh: {elements_per_span: 3}
vessel:
  reference: [0, 0, -10]
  motion: {heave: {harmonic: {amplitude: 0.5, period: 8, ramp: 8}}}
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 60 s}
output: {interval: 50 ms}
"""
PERIOD, HEAVE, EVERY = 8.0, 0.5, 0.02


def run(delay: float, end: float = 40.0) -> tuple[np.ndarray, np.ndarray]:
    """Time s and height of the load m at every reading, with so many s between a measurement and its answer."""
    sim = tautline.Simulation(SCENE, inputs=["winch.pay_out"], keep=False)
    begin, late = sim["tip.position"][2], round(delay / EVERY)
    seen = deque([(0.0, 0.0)] * late, maxlen=max(late, 1))
    times, heights = [], []
    while sim.time < end - 1e-9:
        measured = sim["tip.position"][2] - begin, sim["tip.velocity"][2]
        answered = seen[0] if late else measured
        seen.append(measured)
        times.append(sim.time)
        heights.append(sim["payload.position"][2])
        # What is reached at the end of the advance was measured at its beginning: one reading of delay.
        sim.inputs["winch.pay_out"] = answered
        sim.advance(EVERY)
    return np.array(times), np.array(heights)


def expected(delay: float) -> float:
    """Amplitude of the load, m, with what the loop itself adds to the delay: one reading."""
    return HEAVE * 2.0 * math.sin(math.pi * (delay + EVERY) / PERIOD)


if __name__ == "__main__":
    for delay in (0.0, 0.2, 0.4):
        time, height = run(delay)
        left = np.ptp(height[time > 24.0]) / 2.0
        print(f"delay {delay:.1f} s: the load moves by {left:.4f} m, {expected(delay):.4f} m by the formula")
