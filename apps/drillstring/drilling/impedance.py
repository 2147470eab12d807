"""Torsional waves in a string: the impedance of its pipe, its first frequency, and a drive that lets no wave come back.

A torsional wave in a pipe of inertia I and stiffness K per length carries a torque of ``zeta`` times its speed,
zeta = sqrt(I K), of a bare tube J_p sqrt(rho G). A drive of impedance
Z = K_p + i (omega J - K_i / omega) sends back the part (Z - zeta) / (Z + zeta) of the speed's wave, reversed: none at
the frequency at which its inertia and its integral gain cancel if K_p = zeta. With that the string's first mode leaves
through the drive (Kyllingstad and Nessjoen, A new stick-slip prevention system, SPE 119660, 2009).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan, cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.scene.ends import Controller
from drillstring.string.lumps import Tube

LOOKS = 400
"""Frequencies at which the lowest one is looked for, up to that of the string as if it were all of its fastest part."""


class Gains(NamedTuple):
    """Of a drive: N m s/rad and N m/rad."""

    proportional: float
    integral: float


def pipe_impedance(tube: Tube) -> float:
    """Torque over speed of a torsional wave in a pipe, N m s/rad."""
    return sqrt(tube.rotary_inertia * tube.torsional_stiffness)


def delay_of(tube: Tube) -> float:
    """Time that a torsional wave takes along a section, s."""
    return tube.length * sqrt(tube.rotary_inertia / tube.torsional_stiffness)


def torsional_frequency(tubes: Sequence[Tube]) -> float:
    """First natural frequency of a string that is held at its top and turns freely at the bit, Hz.

    Exact for a stepped shaft: the torque at the bit of a vibration that begins with none of the rotation at the top.
    """

    # Found once: it is asked for at hundreds of frequencies.
    delays, impedances = list(map(delay_of, tubes)), list(map(pipe_impedance, tubes))

    def torque(omega: float) -> float:
        turn, twist = 0.0, 1.0
        for along, of_pipe in zip(delays, impedances, strict=True):
            angle, wave = omega * along, omega * of_pipe
            turn, twist = (
                turn * cos(angle) + twist / wave * sin(angle),
                twist * cos(angle) - turn * wave * sin(angle),
            )
        return twist

    from scipy.optimize import brentq

    delay, ratio = sum(delays), max(impedances) / min(impedances)
    # A uniform string has pi / 2 over its delay; that of a stepped one can be lower, about as the ratio is, or higher.
    low, high = atan(1.0 / sqrt(ratio)) / ratio / delay, 2.0 * pi * len(tubes) / delay
    grid = np.geomspace(0.1 * low, high, LOOKS * len(tubes))
    values = np.array([torque(omega) for omega in grid])
    first = int(np.argmax(values <= 0.0))
    return float(brentq(torque, grid[first - 1], grid[first], xtol=1e-14 * grid[first])) / (2.0 * pi)


def gains(controller: Controller, tubes: Sequence[Tube]) -> Gains:
    """Gains of a drive, those of soft torque found from the string where they are not given."""
    if controller.kind == "pi":
        return Gains(float(controller.proportional or 0.0), float(controller.integral or 0.0))
    proportional, integral = controller.proportional, controller.integral
    assert controller.inertia is not None
    if proportional is None:
        proportional = pipe_impedance(tubes[0])
    if integral is None:
        integral = (2.0 * pi * torsional_frequency(tubes)) ** 2 * controller.inertia
    return Gains(float(proportional), float(integral))


def note_of_drive(controller: Controller, tubes: Sequence[Tube]) -> str:
    """What soft torque has been tuned to, in a sentence."""
    found, frequency, zeta = gains(controller, tubes), torsional_frequency(tubes), pipe_impedance(tubes[0])
    return (
        f"soft torque: proportional {found.proportional:.4g} N m s/rad, integral {found.integral:.4g} N m/rad; the "
        f"pipe's impedance is {zeta:.4g} N m s/rad, the string's first torsional frequency {frequency:.4g} Hz"
    )
