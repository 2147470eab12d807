"""A crane's work as a twin follows it: when its load hangs free, and what its rope has run over, kept over operations.

A load on the ground bounces there, and simulations of other weights bounce at other times. Their differences are no
derivatives, and would pass for knowledge of the weight that nobody has. So would those of a rope that is slack.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np

from crane.assembly.layout import Layout
from crane.results.course import contacts_of, course_of, laid_out
from crane.rope_life.account import CountedFrom, RopeAccount, RopeOf
from crane.scene.scene import CraneScene, Drum, End, PathItem
from crane.twin.loads_in_waves import LoadsInWaves, doubts_of_waves
from tautline.scene.errors import SceneError
from tautline.twin.operation import Blur, Operation

FOUND = {"rope.damage": "", "rope.damage_place": "m"}
"""What it finds, and the units."""
TENSIONS = ("tension", "axial_force", "drum_tension", "max_tension", "min_tension")
"""Outputs of a whole rope that is never pressed together."""
COLUMNS = 3 + np.arange(9)
"""Where the columns of a rotation are behind the place of a frame."""


class Lifting(Operation):
    """Says when the tension of a crane's rope is that of a load which hangs free.

    Parameters
    ----------
    scene : CraneScene
    """

    elsewhere = dict.fromkeys(FOUND, "give the account of the rope: --account FILE, or account= of Twin in Python")

    def __init__(self, scene: CraneScene) -> None:
        self._heights = _heights_on_ground(scene)
        self._waters, self._doubts = LoadsInWaves(scene), doubts_of_waves(scene)
        self.reads: Sequence[str] = tuple(dict.fromkeys(("min_tension", *self._heights, *self._waters.reads)))
        if scene.rope.compression == "none":
            drums = [f"{one.name}.tension" for one in scene.path if isinstance(one, Drum)]
            self.pulled = frozenset((*TENSIONS, *drums))

    def built(self, sim: Any) -> None:
        """Take notice of the scene that the simulation runs."""
        if self._waters.reads:
            self._waters.built(laid_out(sim.driven_scene))

    def doubts(self, plan: Any) -> list[str]:
        """What of the sea nobody knows, where the map estimates something."""
        return self._doubts if plan.unknowns else []

    def blurred(self, read: Mapping[str, np.ndarray], sensors: Mapping[str, str]) -> Blur:
        """What waves on loads make of the sensors."""
        return self._waters.blurred(read, sensors)

    def counts(self, read: Mapping[str, np.ndarray], sensors: Sequence[str]) -> np.ndarray:
        """All sensors, while in every simulation the rope is taut and no load touches the ground."""
        taut = bool((read["min_tension"] > 0.0).all())
        lifted = all(bool((read[name][..., 2] > height).all()) for name, height in self._heights.items())
        return np.full(len(sensors), taut and lifted)

    def put_down(self, read: Mapping[str, np.ndarray]) -> bool:
        """Whether in every simulation the rope is slack and all loads touch the ground."""
        slack = bool((read["min_tension"] <= 0.0).all())
        on_ground = all(bool((read[name][..., 2] <= height).all()) for name, height in self._heights.items())
        return slack and bool(self._heights) and on_ground


class CraneOperation(Lifting):
    """The same with the account of the crane's rope.

    Parameters
    ----------
    scene : CraneScene
    account : Path
        The file; a new one is made where there is none.

    Raises
    ------
    SceneError, ResultError
        For a rope that has no diameter or no breaking load, and for the account of another rope or from another end.
    """

    outputs = FOUND

    def __init__(self, scene: CraneScene, account: Path) -> None:
        super().__init__(scene)
        self.path = account
        self.name = uuid4().hex
        rope = _rope_of(scene)
        # An end without a drum is the same whatever was paid out: that at a load before one that is made fast.
        ends = [place for place in (-1, 0) if not isinstance(scene.path[place], Drum)]
        if not ends:
            cause = "runs from drum to drum: an account of it is kept by the distance from an end without a drum"
            raise SceneError([scene.problem("path", cause, "leave the account out")])
        self._end = min(ends, key=lambda place: not isinstance(scene.path[place], End))
        self._measured_from = _said(scene.path[self._end])
        self._counted_from = _counted_from(scene, self._end)
        # Versions that did not write the end took the last of the path, were it made fast.
        self._unsaid = _counted_from(scene, ends[0])
        self.account = self._kept(rope) if account.exists() else RopeAccount(rope, self.name, self._counted_from)
        self._layout: Layout | None = None

    def built(self, sim: Any) -> None:
        """Lay out the scene that the simulation runs."""
        super().built(sim)
        self._layout = laid_out(sim.driven_scene)

    def found(
        self, time: float, measured: Mapping[str, Any], outputs: Mapping[str, Any], estimates: Mapping[str, Any],
        sim: Any,
    ) -> dict[str, tuple[float, float]]:  # fmt: skip
        """Count a row: where the rope lies on what, and under which tension."""
        assert self._layout is not None
        frames, layout = sim.parts.frames, self._layout
        rows = len(frames.time)
        observed = {"time": frames.time, **sim.model.observe(frames)}
        columns = frames.q[:, layout.wheels.frame[:, None] + COLUMNS].reshape(rows, -1, 3, 3)
        course = course_of(observed, layout, columns=columns)
        end = float(observed["material_coordinate"][0, self._end])
        self.account.add(time, contacts_of(observed, course), end)
        damage, place = self.account.worst
        return {"rope.damage": (damage, 0.0), "rope.damage_place": (place, 0.0)}

    def alarms(self) -> Iterator[tuple[str, bool, str, float]]:
        """A rope that has done what it lasts."""
        damage, place = self.account.worst
        worn = self.account.rope.life is not None and damage >= 1.0
        at = f"{place:.1f} m from {self._measured_from}"
        text = f"the rope {at} has had {100.0 * damage:.0f} % of the bending that it lasts"
        yield "rope worn", worn, text, 0.0

    def save(self) -> None:
        """Write the account; raises ResultError where that is not possible."""
        self.account.save(self.path)

    def memory(self) -> dict[str, Any]:
        """What a later process needs to go on."""
        return {"operation": self.name}

    def recall(self, memory: Mapping[str, Any]) -> None:
        """Go on with the operation that an earlier process began: what it has counted is not counted again."""
        self.name = str(memory["operation"])
        if self.path.exists():
            self.account = self._kept(self.account.rope)
        else:
            self.account.operations.clear()
            self.account.begin(self.name)

    def _kept(self, rope: RopeOf) -> RopeAccount:
        """The account of the file; raises ResultError for that of another rope, or from another end of it."""
        return RopeAccount.load(self.path, rope, self.name, self._counted_from, self._unsaid)


def _counted_from(scene: CraneScene, place: int) -> CountedFrom:
    """An end of the path, as an account keeps it."""
    item = scene.path[place]
    return CountedFrom(str(scene.key_of(item)[2]), item.name)


def _said(item: PathItem) -> str:
    """The end that places count from, in words: the load, or what the rope is made fast to, by its name."""
    return "the load" if isinstance(item, End) else item.name


def _heights_on_ground(scene: CraneScene) -> dict[str, float]:
    """Output -> height, m, at which a body touches the ground; nothing without ground."""
    if scene.ground is None:
        return {}
    return {f"{body.name}.position": scene.ground.level + body.bottom for body in scene.bodies}


def _rope_of(scene: CraneScene) -> RopeOf:
    rope = scene.rope
    missing = [name for name in ("diameter", "breaking_load") if getattr(rope, name) is None]
    if missing:
        cause = f"has no {missing[0]}: what bends a rope cannot be told without it"
        raise SceneError([scene.problem("rope", cause, f"give {missing[0]} of the rope, by its maker's certificate")])
    assert rope.diameter is not None and rope.breaking_load is not None
    return RopeOf(rope.diameter, rope.breaking_load, rope.mass_per_length, rope.axial_stiffness, rope.bending_life)
