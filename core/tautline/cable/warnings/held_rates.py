"""Rates that are held where nothing says so: before the first time of a list, and after the last one."""

from __future__ import annotations

from collections.abc import Iterator

from tautline.cable.input.parts import CableScene, Motion, Place
from tautline.cable.input.syntax.entries import DOFS
from tautline.scene.warnings import warning

SLOPE = "r'"
"""How names of slopes begin."""
NONE = 1e-9
"""Share of the largest rate of a list, and of the length of a run, that is none: what rounding leaves of sums."""


@warning("cable")
def _held_rates(scene: CableScene) -> Iterator[tuple[Place, str]]:
    """Motions by their rate that go on outside of their times. A single rate is meant to be held."""
    end = float(scene.solver.end)
    for motion in scene.motions:
        used = {
            name
            for node in scene.nodes
            for name, function in zip(DOFS[node.kind].split(), node.functions, strict=True)
            if function == motion.id
        }
        if used and len(motion.times) > 1:
            # A slope is a length over a length.
            unit = " or ".join(sorted({"1/s" if name.startswith(SLOPE) else "m/s" for name in used}, reverse=True))
            yield from _before(motion, end, unit)
            yield from _after(motion, end, unit)


def _is_none(rate: float, motion: Motion) -> bool:
    return abs(rate) <= NONE * max(abs(one) for one in motion.velocities)


def _before(motion: Motion, end: float, unit: str) -> Iterator[tuple[Place, str]]:
    first, rate = motion.times[0], motion.velocities[0]
    if first > NONE * end and not _is_none(rate, motion):
        text = (
            f"begins at {first:g} s. The first rate, {rate:g} {unit}, is held before it: the motion begins with the "
            "run. Give the rate at 0 s too, or begin with a rate of 0"
        )
        yield (*motion.place, "timeList"), text


def _after(motion: Motion, end: float, unit: str) -> Iterator[tuple[Place, str]]:
    last, rate = motion.times[-1], motion.velocities[-1]
    if last < end * (1.0 - NONE) and not _is_none(rate, motion):
        text = (
            f"ends at {last:g} s, before the run ({end:g} s). The last rate, {rate:g} {unit}, is held after it: "
            f"the motion goes on. Give the rate at {end:g} s too, or end with a rate of 0"
        )
        yield (*motion.place, "timeList"), text
