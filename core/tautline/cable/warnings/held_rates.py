"""Rates that are held where nothing says so: before the first time of a list, and after the last one."""

from __future__ import annotations

from collections.abc import Iterator

from tautline.cable.input.parts import CableScene, Motion, Place
from tautline.scene.warnings import warning


@warning("cable")
def _held_rates(scene: CableScene) -> Iterator[tuple[Place, str]]:
    """Motions by their rate that go on outside of their times. A single rate is meant to be held."""
    used = {function for node in scene.nodes for function in node.functions}
    for motion in scene.motions:
        if motion.id in used and len(motion.times) > 1:
            yield from _before(motion)
            yield from _after(motion, float(scene.solver.end))


def _before(motion: Motion) -> Iterator[tuple[Place, str]]:
    first, rate = motion.times[0], motion.velocities[0]
    if first > 0.0 and rate != 0.0:
        text = (
            f"begins at {first:g} s. The first rate, {rate:g} m/s, is held before it: the motion begins with the run. "
            "Give the rate at 0 s too, or begin with a rate of 0"
        )
        yield (*motion.place, "timeList"), text


def _after(motion: Motion, end: float) -> Iterator[tuple[Place, str]]:
    last, rate = motion.times[-1], motion.velocities[-1]
    if last < end and rate != 0.0:
        text = (
            f"ends at {last:g} s, before the run ({end:g} s). The last rate, {rate:g} m/s, is held after it: the "
            f"motion goes on. Give the rate at {end:g} s too, or end with a rate of 0"
        )
        yield (*motion.place, "timeList"), text
