"""A string as a torsional line: what its top tells of its bit, and what resists the bit's oscillation.

With rotary speed and torque (that which the part above exerts on the part below, clockwise) as exp(i omega t), a pipe
of polar moment J_p with viscous torque d per length and speed, and structural damping of time c, obeys

    dOmega/ds = -i omega T / (G J_p (1 + i omega c)),    dT/ds = -(i omega rho J_p + d) Omega,

so that over a length l, with gamma^2 = (i omega rho J_p + d) i omega / (G J_p (1 + i omega c)) and the impedance
Z = (i omega rho J_p + d) / gamma,

    Omega_l = cosh(gamma l) Omega_0 - sinh(gamma l) T_0 / Z,    T_l = cosh(gamma l) T_0 - Z sinh(gamma l) Omega_0.

These are the transmission-line equations, exact for a stepped string. Friction on the wall is not in them.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi
from typing import Any

import numpy as np

from drillstring.drilling.impedance import Gains, gains, torsional_frequency
from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.ends import Controller
from drillstring.scene.scene import scene_of
from drillstring.string.lumps import Tube

LUMPS = 12
"""Lumps that coefficients of damping are of, where the scene has no wall."""


@dataclass(frozen=True)
class TorsionalLine:
    """A string between its drive and its bit.

    Attributes
    ----------
    tubes : tuple of Tube
        From the rotary table down.
    viscous : float
        Torque per metre and rotary speed, N s/rad.
    mass_proportional : float
        1/s, times the inertia.
    structural : float
        s, times the stiffness.
    drive : Gains or None
        Of the speed controller; None where the speed is prescribed.
    inertia : float
        Of the drive, kg m^2.
    """

    tubes: tuple[Tube, ...]
    viscous: float = 0.0
    mass_proportional: float = 0.0
    structural: float = 0.0
    drive: Gains | None = None
    inertia: float = 0.0

    @property
    def frequency(self) -> float:
        """First frequency of the string held at its top and free at its bit, undamped, Hz."""
        return torsional_frequency(self.tubes)

    def down(self, omega: np.ndarray, damped: float = 1.0) -> np.ndarray:
        """Matrices (n, 2, 2) that give speed and torque at the bit from those at the top, at frequencies (n,) rad/s.

        ``damped`` times all damping.
        """
        omega = np.asarray(omega, float)
        whole = np.broadcast_to(np.eye(2, dtype=complex), (omega.size, 2, 2))
        for tube in self.tubes:
            inertia = tube.rotary_inertia
            across = 1j * omega * inertia + damped * (self.viscous + self.mass_proportional * inertia)
            stiffness = tube.torsional_stiffness * (1.0 + 1j * omega * damped * self.structural)
            gamma = np.sqrt(across * 1j * omega / stiffness)
            impedance = across / gamma
            cosh, sinh = np.cosh(gamma * tube.length), np.sinh(gamma * tube.length)
            one = np.array([[cosh, -sinh / impedance], [-impedance * sinh, cosh]]).transpose(2, 0, 1)
            whole = one @ whole
        return whole

    def drive_impedance(self, omega: np.ndarray) -> np.ndarray:
        """Torque of the string over lack of speed at the top, N m s/rad; infinite where the speed is prescribed."""
        omega = np.asarray(omega, float)
        if self.drive is None:
            return np.full(omega.shape, inf, complex)
        return self.drive.proportional + self.drive.integral / (1j * omega) + 1j * omega * self.inertia

    def at_bit(self, omega: np.ndarray, damped: float = 1.0) -> np.ndarray:
        """Torque with which string and drive resist a speed of the bit, over that speed, (n,) N m s/rad."""
        whole = self.down(omega, damped)
        if self.drive is None:
            top = np.zeros((np.size(omega), 2), complex)
            top[:, 1] = 1.0
        else:
            top = np.stack([np.ones(np.size(omega)), -self.drive_impedance(omega)], axis=1)
        speed, torque = np.einsum("nij,nj->in", whole, top)
        return -torque / speed

    def resonance(self, damped: float = 1.0) -> tuple[float, float]:
        """Frequency, rad/s, at which the bit swings by itself, and the resistance to that, N m s/rad.

        It is where the imaginary part of the impedance at the bit is zero: inertia and stiffness cancel there.
        """
        from scipy.optimize import brentq

        first = 2.0 * pi * self.frequency
        grid = first * np.linspace(0.3, 1.6, 261)
        reactance = self.at_bit(grid, damped).imag
        rising = np.flatnonzero((reactance[:-1] < 0.0) & (reactance[1:] >= 0.0))
        if not rising.size:
            return first, float(self.at_bit(np.array([first]), damped).real[0])
        best = min(rising, key=lambda k: float(self.at_bit(grid[k : k + 1], damped).real[0]))
        omega = float(brentq(lambda w: float(self.at_bit(np.array([w]), damped).imag[0]), grid[best], grid[best + 1]))
        return omega, float(self.at_bit(np.array([omega]), damped).real[0])


def line_of(scene: Any) -> TorsionalLine:
    """The torsional line of a scene, path, text or dict; raises as `scene_of`, `well_of` and `tubes_of` do."""
    scene = scene_of(scene)
    tubes = tuple(tubes_of(scene, well_of(scene).length))
    length = sum(tube.length for tube in tubes)
    lumps = LUMPS if scene.well.wall is None else scene.well.wall.lumps
    rotation, damping = scene.top.rotation, scene.damping
    drive = rotation if isinstance(rotation, Controller) and rotation.kind != "stiff" else None
    return TorsionalLine(
        tubes,
        damping.rotation * lumps / length,
        damping.mass_proportional,
        damping.structural,
        None if drive is None else gains(drive, tubes),
        0.0 if drive is None else float(drive.inertia or 0.0),
    )
