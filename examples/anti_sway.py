"""Anti-sway: a crane slews by a quarter of a turn, and the slewing itself takes the sway out of the load.

The load under the tip of a boom of reach R is a pendulum of length L: with phi the angle of slew and s the sway along
the tip's path, s.. + g/L s = -R phi... A slew speed phi. = planned + (c / R) s makes it s.. + c s. + g/L s = 0 once the
planned speed is steady: the sway falls as exp(-c t / 2).
"""

from __future__ import annotations

import math

import numpy as np

import tautline

SCENE = """
title: Slewing
rope: {mass_per_length: 2.2, axial_stiffness: 4.0e7, damping: 1.0e-3, diameter: 22 mm, breaking_load: 0.4 MN}
bodies:
  - {name: payload, mass: 5 t, position: [20.2, 0, -4]}
path:
  - drum:   {name: winch, center: [0.5, 0, 0], radius: 0.3, axis: [0, 1, 0], wrap: over, frame: boom, pay_out: 0}
  - sheave: {name: tip, center: [20, 0, 16], radius: 0.2, axis: [0, 1, 0], wrap: over, frame: boom, inertia: 1.5,
             law: no_slip}
  - end:    {name: hook, body: payload}
frames:
  - {name: boom, pivot: [0, 0, 0], slew: {constant: 0}, luff: {constant: 0}}
mesh: {elements_per_span: 2}
start: static
solver: {method: generalized-alpha, rho_inf: 0.8, step: 10 ms, end: 80 s}
output: {interval: 0.1 s}
"""
REACH, ANGLE, OVER, EVERY = 20.2, 0.5 * math.pi, 20.0, 0.04
"""m; slew, rad, and the time it takes, s; time between readings, s."""
DAMPING = 0.25
"""c, 1/s."""


def planned(t: float) -> float:
    """Slew speed, rad/s: smooth from rest to rest, the whole angle in the given time."""
    x = min(max(t / OVER, 0.0), 1.0)
    return ANGLE / OVER * 30.0 * (x * (1.0 - x)) ** 2


def run(end: float = 50.0, controlled: bool = True) -> tuple[np.ndarray, np.ndarray, float]:
    """Time s, sway along the tip's path m at every reading, and the angle at the end, rad."""
    sim = tautline.Simulation(SCENE, inputs=["boom.slew"], keep=False)
    angle, speed = 0.0, 0.0
    times, sways = [], []
    while sim.time < end - 1e-9:
        x, y, _ = sim["payload.position"]
        # The tip's path at the angle of slew: its tangent is (-sin, cos).
        sway = -(x - REACH * math.cos(angle)) * math.sin(angle) + (y - REACH * math.sin(angle)) * math.cos(angle)
        times.append(sim.time)
        sways.append(sway)
        wanted = planned(sim.time + EVERY) + (DAMPING / REACH * sway if controlled else 0.0)
        angle += 0.5 * EVERY * (speed + wanted)
        speed = wanted
        sim.inputs["boom.slew"] = angle, speed
        sim.advance(EVERY)
    return np.array(times), np.array(sways), angle


if __name__ == "__main__":
    for controlled in (False, True):
        time, sway, _ = run(controlled=controlled)
        print(f"{'with' if controlled else 'without'} control: sway {np.abs(sway[time > 40.0]).max():.3f} m after 40 s")
