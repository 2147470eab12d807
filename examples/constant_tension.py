"""Constant tension: a winch on a heaving ship holds the tension of a rope that is fast to the sea floor.

A PI law reads the tension at the drum every 20 ms and sets the speed at which rope is paid out. A rope of stiffness
k = EA / L and a tip that heaves at speed v give dT/dt = k (v - u), with u = K (T - T0) + K_i int (T - T0) dt. What is
left of a heave of amplitude a at frequency w is then

    |T - T0| = k w^2 a / |-w^2 + i w k K + k K_i|.
"""

from __future__ import annotations

import math

import numpy as np

import tautline

SCENE = """
title: Rope fast to the sea floor
rope: {mass_per_length: 6.5, axial_stiffness: 8.0e7, damping: 1.0e-3, diameter: 36 mm, breaking_load: 1.1 MN}
path:
  - drum:   {name: winch, center: [0, 0, 0], radius: 0.5, axis: [0, 1, 0], wrap: over, pay_out: 0}
  - sheave: {name: tip, center: [12, 0, 30], radius: 0.4, axis: [0, 1, 0], wrap: over, inertia: 20, law: no_slip}
  - anchor: {name: sea floor, position: [12.4, 0, -40], frame: ground}
mesh: {elements_per_span: 4}
vessel: {reference: [0, 0, -10]}
start: static
solver: {method: generalized-alpha, rho_inf: 0.6, step: 5 ms, end: 60 s}
output: {interval: 50 ms}
"""
WANTED, PERIOD, HEAVE, EVERY = 60.0e3, 8.0, 0.5, 0.02
"""Tension N, period s and amplitude m of the heave, and time between readings, s."""
GAIN, INTEGRAL = 1.0e-5, 1.0e-4
"""m/s and m/s^2 of rope per N."""


def heave(t: float) -> tuple[float, float, float]:
    """Heave that grows over the first period, with both derivatives."""
    w, x = 2.0 * math.pi / PERIOD, min(t / PERIOD, 1.0)
    e, de = x**3 * (10.0 - 15.0 * x + 6.0 * x * x), 30.0 * (x * (1.0 - x)) ** 2 / PERIOD
    dde = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / PERIOD**2
    s, c = HEAVE * math.sin(w * t), HEAVE * w * math.cos(w * t)
    return e * s, de * s + e * c, dde * s + 2.0 * de * c - e * w * w * s


def run(end: float = 40.0, controlled: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Time s and tension N at every reading."""
    sim = tautline.Simulation(SCENE, inputs=["winch.pay_out_speed", "vessel.heave"], keep=False)
    times, tensions, integral = [], [], 0.0
    while sim.time < end - 1e-9:
        tension = sim["winch.tension"]
        times.append(sim.time)
        tensions.append(tension)
        integral += INTEGRAL * (tension - WANTED) * EVERY
        if controlled:
            sim.inputs["winch.pay_out_speed"] = GAIN * (tension - WANTED) + integral
        sim.inputs["vessel.heave"] = heave(sim.time + EVERY)
        sim.advance(EVERY)
    return np.array(times), np.array(tensions)


def expected(stiffness: float) -> float:
    """Amplitude of the tension that is left, N, of a rope of so many N/m."""
    w = 2.0 * math.pi / PERIOD
    return stiffness * w * w * HEAVE / abs(-w * w + 1j * w * stiffness * GAIN + stiffness * INTEGRAL)


if __name__ == "__main__":
    time, tension = run()
    late = tension[time > 20.0]
    print(
        f"tension {late.mean() / 1e3:.2f} kN, within {np.ptp(late) / 2e3:.2f} kN; {WANTED / 1e3:.0f} kN was asked for"
    )
