"""A hose linearised about its shape at rest, at any speed of flow: its motions, and how fast they grow."""

from __future__ import annotations

from functools import cached_property
from typing import Literal

import numpy as np

from gardenhose.scene import HoseScene, tied
from gardenhose.static import Form, form
from tautline.integrators.status import StoppedEarly
from tautline.integrators.vibration.following import apart
from tautline.integrators.vibration.vibrations import DENSE, Vibrations, vibrations

MODES = 8
"""Pairs of eigenvalues that are followed."""
SLOWEST = 30
"""Pairs, at least, that are sought of a hose that has too many for all: twice as many as are followed, and some."""
STILL, ROUNDING = 1.0e-7, 10.0
"""Growth over the size of the eigenvalue, and over what it may be off by rounding, that is none."""
ALIKE = 1.0e-6
"""Relative difference of the eigenvalues of two planes in which a straight hose moves alike."""

Plane = Literal["in", "out", "any"]


def normal_of(scene: HoseScene) -> np.ndarray | None:
    """Unit normal of the plane of direction and gravity; None where these are parallel, or there is no gravity."""
    across = np.cross(scene.hose.unit_direction, scene.gravity)
    size = float(np.linalg.norm(across))
    return across / size if size > 1e-9 * float(np.linalg.norm(scene.gravity)) and size > 0.0 else None


class LinearHose:
    """Eigenvalues at any speed of a hose that shares r and r' with its water, each static shape from the nearest."""

    def __init__(self, scene: HoseScene, modes: int = MODES) -> None:
        # Multipliers change no motion, and make too many unknowns of a few elements. Springs are so stiff that bending
        # would be lost in the rounding of eigenvalues.
        self.scene, self.normal = tied(scene), normal_of(scene)
        self.count = max(SLOWEST, 3 * modes)
        self.known: dict[float, Form] = {}
        self.solved: dict[float, tuple[Vibrations, np.ndarray]] = {}

    @cached_property
    def slow(self) -> float:
        """Size, 1/s, of the slowest eigenvalue without flow; differences of smaller ones are measured by it.

        At a speed next to a divergence the slowest is next to zero, and measures nothing. Where no shape at rest is
        found without flow it is that of the slowest speed that is known.
        """
        try:
            motions, _ = self.at(0.0)
        except StoppedEarly:
            motions, _ = self.solved[min(self.solved, key=abs)]
        size = np.abs(motions.value)
        return float(size[size > ROUNDING * motions.rounding].min(initial=size.max(initial=0.0)))

    def at(self, speed: float) -> tuple[Vibrations, np.ndarray]:
        """The motions that grow fastest or are slowest, and which share of each is out of the plane."""
        if speed in self.solved:
            return self.solved[speed]
        near = min(self.known.values(), key=lambda one: abs(one.speed - speed), default=None)
        found = form(self.scene, speed, near)
        self.known[speed] = found
        motions = vibrations(found.system, found.state, None if found.system.size <= DENSE else self.count)
        if self.normal is None:
            motions = _of_one_plane(motions)
        self.solved[speed] = motions, self._share(motions.shape)
        return self.solved[speed]

    def _share(self, shape: np.ndarray) -> np.ndarray:
        if self.normal is None:
            return np.zeros(shape.shape[1])
        count = len(self.known[next(iter(self.known))].position)
        nodes = shape[: 7 * count].reshape(count, 7, -1)[:, :3]
        across = np.einsum("nck,c->nk", nodes, self.normal)
        whole = (np.abs(nodes) ** 2).sum(axis=(0, 1))
        return (np.abs(across) ** 2).sum(axis=0) / np.where(whole > 0.0, whole, 1.0)

    def unlike(self, before: Vibrations, after: Vibrations) -> np.ndarray:
        """How unlike motions (n,) are others (m,), by eigenvalue and by shape, never below zero; (n, m)."""
        one, other = before.shape, after.shape
        if self.normal is None:
            # A straight hose moves alike in all planes, and which one a shape lies in is chance.
            count = len(self.known[next(iter(self.known))].position)
            one, other = (
                shape[: 7 * count].reshape(count, 7, -1)[:, :6].reshape(2 * count, 3, -1) for shape in (one, other)
            )
            both = np.einsum("sai,sbj->ijab", one.conj(), other, optimize=True)
            alike, sizes = np.linalg.norm(both, axis=(2, 3)), [np.linalg.norm(x, axis=(0, 1)) for x in (one, other)]
        else:
            alike, sizes = np.abs(one.conj().T @ other), [np.linalg.norm(x, axis=0) for x in (one, other)]
        # Of one shape with itself rounding leaves less than nothing.
        other_shape = np.maximum(1.0 - alike / np.maximum(np.outer(*sizes), 1e-300), 0.0)
        return apart(before, after, self.slow) + other_shape

    def growth(self, speed: float, plane: Plane) -> tuple[float, complex]:
        """Largest growth rate of motions in a plane less what may be rounding, 1/s, and the eigenvalue that has it."""
        motions, share = self.at(speed)
        those = np.full(share.size, True) if plane == "any" else (share > 0.5) == (plane == "out")
        chosen = motions.value[those]
        if not chosen.size:
            return -np.inf, 0j
        grows = growths(motions)[those]
        fastest = int(np.argmax(grows))
        return float(grows[fastest]), complex(chosen[fastest])


def growths(motions: Vibrations) -> np.ndarray:
    """Growth rates (k,) less what may be rounding, 1/s."""
    return motions.value.real - STILL * np.abs(motions.value) - ROUNDING * motions.rounding


def _of_one_plane(motions: Vibrations) -> Vibrations:
    """The motions of a straight hose, each that it makes in two planes once.

    What stretches it has no like. Of two pairs that meet, as where they are about to flutter, two are left.
    """
    value, kept = motions.value, np.full(motions.value.size, True)
    for i in range(value.size):
        if kept[i]:
            apart = np.abs(value[i + 1 :] - value[i])
            near = kept[i + 1 :] & (apart <= ALIKE * np.abs(value[i]) + ROUNDING * motions.rounding[i])
            if near.any():
                kept[i + 1 + np.argmin(np.where(near, apart, np.inf))] = False
    return Vibrations(value[kept], motions.shape[:, kept], motions.rounding[kept])
