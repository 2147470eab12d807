"""Loads that bounce on their ropes: what a twin does not know of a crane at the begin of a window."""

from __future__ import annotations

from collections.abc import Iterator

from crane.scene.scene import CraneScene

SPEED = 0.01
"""Size of a blow that sets off the bounce, m/s: small enough to keep what sticks and slips as it is."""


def free_motions(scene: CraneScene) -> Iterator[tuple[str, tuple[float, ...], bool]]:
    """Blows along gravity, of each load one and one a quarter of a period later: output, size (3,), late."""
    size = sum(g * g for g in scene.gravity) ** 0.5
    up = [-g / size for g in scene.gravity] if size > 0.0 else [0.0, 0.0, 1.0]
    for body in scene.bodies:
        for late in (False, True):
            yield f"{body.name}.velocity", tuple(SPEED * x for x in up), late
