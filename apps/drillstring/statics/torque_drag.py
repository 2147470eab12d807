"""Torque and drag of a string: hook loads and surface torque against depth, buckling, lock-up.

Every number is found twice: from the statics of the dynamic model, lumps or a beam (statics.py), and by the soft
string's integral (soft_string.py).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from drillstring.mesh import follows_hole
from drillstring.model.prepared import well_of
from drillstring.scene.scene import BEAM, LUMPED, DrillstringScene, check_lengths, of_kind
from drillstring.statics.enough_links import ELEMENTS, Doubling, links, links_at, settled_links
from drillstring.statics.helix import LockedUp
from drillstring.statics.motion import MOTIONS, Motion
from drillstring.statics.soft_string import SoftString
from drillstring.statics.statics import Profile, Statics, shortened
from drillstring.statics.strokes import BreakAway, break_away
from drillstring.string.buckled import NO_FORCE, Stations, stations_of
from drillstring.string.buckling import Limits
from drillstring.string.factors import Factors, factors_of, same
from drillstring.string.strength import extreme_tension
from tautline.integrators.status import StoppedEarly
from tautline.scene.errors import SceneError

DIRECTIONS = tuple(MOTIONS)
"""Picked up, slacked off, turned off bottom."""


class Overpull(NamedTuple):
    """Force, N, that the hook can pull beyond the pick-up load until a section yields; its name, and where, m."""

    margin: float
    section: str
    measured_depth: float


class Point(NamedTuple):
    """The string with its bit at a depth, m, for one friction factor, or one pair of them.

    ``profiles`` and ``soft`` hold the statics' and the soft string's results by direction; ``profiles`` has none
    where no equilibrium was found, and ``failures`` says why. ``limits`` are the buckling limits in the middles of the
    links (n,), ``stations`` has those at their ends too;
    ``overpull`` is None where no section has a yield load, ``strokes`` where nothing was found and of a bit on bottom;
    ``locks`` says of a direction in which the string locks up where the friction of a helix outgrows the pipe, m;
    ``motions`` are the motions by name; ``model`` is the kind of model, ``lumped`` or ``ale-ancf``.
    """

    friction: Factors
    depth: float
    link_depth: np.ndarray
    limits: Limits
    profiles: dict[str, Profile]
    soft: dict[str, SoftString]
    failures: dict[str, str]
    overpull: Overpull | None
    strokes: BreakAway | None
    locks: dict[str, float]
    motions: dict[str, Motion]
    stations: Stations
    model: str = LUMPED

    def hook_load(self, direction: str) -> float:
        """Hook load, N; NaN where no equilibrium was found."""
        return self.profiles[direction].hook_load if direction in self.profiles else np.nan

    def torque(self, direction: str) -> float:
        """Surface torque, N m; NaN where no equilibrium was found."""
        return self.profiles[direction].surface_torque if direction in self.profiles else np.nan

    def buckled(self, direction: str, kind: str) -> list[tuple[float, float]]:
        """Stretches of hole, from and to measured depth in m, in which the string buckles."""
        if direction not in self.profiles:
            return []
        profile = self.profiles[direction]
        return self.stations.buckled(kind, self.stations.compression(profile.hook_load, profile.tension))

    @property
    def locked(self) -> bool | None:
        """Whether the string cannot be lowered by its weight, or by any force; None if not known."""
        if "slack_off" in self.locks:
            return True
        return None if "slack_off" not in self.profiles else self.must_be_pushed

    @property
    def must_be_pushed(self) -> bool:
        """Whether friction holds the whole weight of the string as it is lowered; False where it locks up."""
        return "slack_off" in self.profiles and self.hook_load("slack_off") < -NO_FORCE


class Case(NamedTuple):
    """All depths for one friction factor, of one kind of model.

    ``doubling`` is what doubling the links changed, where their number followed the hole; ``follows`` whether the
    string feels the bends of its hole.
    """

    friction: Factors
    points: list[Point]
    doubling: Doubling | None = None
    follows: bool = True

    def hook_loads(self, direction: str) -> np.ndarray:
        """Against depth (m,), N."""
        return np.array([point.hook_load(direction) for point in self.points])

    def soft_hook_loads(self, direction: str) -> np.ndarray:
        """The soft string's, against depth (m,), N."""
        return np.array([point.soft[direction].hook_load for point in self.points])

    def torques_of(self, direction: str) -> np.ndarray:
        """Surface torque against depth (m,), N m."""
        return np.array([point.torque(direction) for point in self.points])

    def soft_torques_of(self, direction: str) -> np.ndarray:
        """The soft string's, against depth (m,), N m."""
        return np.array([point.soft[direction].surface_torque for point in self.points])

    @property
    def torques(self) -> np.ndarray:
        """Surface torque of the string that turns off bottom, against depth (m,), N m."""
        return self.torques_of("rotating")

    @property
    def soft_torques(self) -> np.ndarray:
        """The soft string's, against depth (m,), N m."""
        return self.soft_torques_of("rotating")

    @property
    def model(self) -> str:
        """Kind of model."""
        return self.points[0].model

    @property
    def motions(self) -> tuple[str, ...]:
        """Names of the motions."""
        return tuple(self.points[0].soft)

    @property
    def failures(self) -> list[str]:
        """What was not found, and why."""
        return [
            f"{direction.replace('_', ' ')}: {text}"
            for point in self.points
            for direction, text in point.failures.items()
        ]


def require_wall(scene: DrillstringScene) -> None:
    """Raise SceneError where the scene has no wall: without contact there is no friction."""
    if scene.well.wall is None:
        cause = "without contact the string has no friction"
        raise SceneError([scene.problem("well.wall", cause, "give {stiffness: 1.0e9, friction: 0.2}")])


def own_depth(scene: DrillstringScene) -> float:
    """Depth of the bit in the scene as it stands, m."""
    return float(sum(check_lengths(scene, well_of(scene).length)))


def own_friction(scene: DrillstringScene) -> Factors:
    """The scene's kinetic friction factors."""
    require_wall(scene)
    assert scene.well.wall is not None
    return factors_of(scene.well.wall, "kinetic")


def meshes(
    scene: DrillstringScene,
    depths: Sequence[float] | None,
    elements: int | None,
    kinds: Sequence[str],
    unit: str | None = None,
) -> list[DrillstringScene]:
    """The string as `torque_drag` computes it at the deepest of its depths, where elements are longest, of each kind.

    Raises
    ------
    SceneError
        As `torque_drag` does.
    """
    deepest, length = own_depth(scene) if depths is None else max(depths), well_of(scene).length
    made = []
    for model in (of_kind(scene, kind) for kind in kinds):
        count = links(model, [deepest], unit) if elements is None else elements
        made.append(shortened(model, length, deepest, count, unit=unit))
    return made


def torque_drag(
    scene: DrillstringScene,
    frictions: Sequence[float | Factors] | None = None,
    depths: Sequence[float] | None = None,
    elements: int | None = None,
    progress: Callable[[int, int], None] | None = None,
    reamed: dict[str, Motion] | None = None,
    kinds: Sequence[str] = (),
    unit: str | None = None,
) -> list[Case]:
    """Hook loads, torque, side force and buckling for friction factors and depths.

    Parameters
    ----------
    scene : DrillstringScene
    frictions : sequence of float or Factors, optional
        Friction factors, of all of the hole or of its cased and open parts; the scene's kinetic ones if None.
    depths : sequence of float, optional
        Measured depths of the bit, m; the scene's own if None.
    elements : int, optional
        Links or elements of the string; as many as feel the bends of the hole if None (enough_links.py), of one length
        at all depths.
    progress : callable, optional
        Called with the number of depths done and that of all, each once to a model.
    reamed : dict of str to Motion, optional
        Motions beside the three, by name: see `drillstring.statics.motion.reaming`.
    kinds : sequence of str
        Kinds of model, ``lumped`` and ``ale-ancf``; that of the scene if empty.
    unit : str, optional
        In which errors tell depths; that of the scene if None.

    Returns
    -------
    list of Case
        One to a kind of model and a friction factor. A direction without an equilibrium is among the ``failures`` of
        its point.

    Raises
    ------
    SceneError
        For a scene without a wall, for depths at which the string does not fit the well, and for a kind of model that
        cannot have the scene's bending.
    """
    own = own_friction(scene)
    frictions = [own] if frictions is None else list(frictions)
    depths = [own_depth(scene)] if depths is None else list(depths)
    motions = MOTIONS | (reamed or {})
    found = []
    models = [of_kind(scene, kind) for kind in kinds or (scene.model.kind,)]
    for number, model in enumerate(models):
        factors = [same(friction, own.shoe) for friction in frictions]
        count, doubling = settled_links(model, depths, factors, unit) if elements is None else (elements, None)
        follows = elements is None or follows_hole(
            shortened(model, well_of(scene).length, max(depths), count, unit=unit)
        )
        cases = [Case(friction, [], doubling, follows) for friction in factors]
        found += cases
        least = max(ELEMENTS, model.model.elements)
        for done, depth in enumerate(depths, 1):
            here = links_at(depth, max(depths), count, least) if elements is None else count
            statics = Statics(model, depth, here, unit=unit)
            weight = statics.weight[statics.lumps.section]
            stations = stations_of(model, statics.well, statics.lumps, statics.pipes, weight, statics.limits)
            for case in cases:
                case.points.append(_point(statics, case.friction, model, motions, stations))
            if progress is not None:
                progress(number * len(depths) + done, len(models) * len(depths))
    return found


def _point(
    statics: Statics, friction: Factors, scene: DrillstringScene, motions: dict[str, Motion], stations: Stations
) -> Point:
    profiles, failures, soft, locks = {}, {}, {}, {}
    for direction, motion in motions.items():
        soft[direction] = statics.soft.solved(friction, motion, statics.bit_force)
        try:
            profiles[direction] = statics.solve(friction, direction if direction in MOTIONS else motion)
        except LockedUp as lock:
            place = soft[direction].locked
            locks[direction] = lock.measured_depth if place is None else place
        except StoppedEarly as stop:
            # On its way to lock-up the string has no equilibrium any more.
            place = soft[direction].locked
            if place is not None:
                locks[direction] = place
            else:
                hint = "; more elements may find one" if scene.model.kind == BEAM else ""
                failures[direction] = f"{stop.part}: {stop.sentence}{hint}"
    middle = statics.lumps.measured_depth[:-1] + 0.5 * statics.lumps.length
    pull = _overpull(statics, profiles["pick_up"], scene) if "pick_up" in profiles else None
    strokes = break_away(statics.solve(0.0, "pick_up"), profiles) if profiles and not scene.bit.on_bottom else None
    return Point(
        friction, statics.depth, middle, statics.limits, profiles, soft, failures, pull, strokes, locks,
        motions, stations, scene.model.kind,
    )  # fmt: skip


def _overpull(statics: Statics, picked: Profile, scene: DrillstringScene) -> Overpull | None:
    """Margin of the link that yields first if the bit sticks: what the hook pulls more, every link carries more."""
    loads = np.array([np.inf if one.yield_load is None else one.yield_load for one in scene.string])
    most = extreme_tension(scene, statics.lumps, np.asarray(picked.hook_load), picked.tension)
    margins = loads[statics.lumps.section] - most
    first = int(margins.argmin())
    if not np.isfinite(margins[first]):
        return None
    name = scene.string[statics.lumps.section[first]].name
    return Overpull(float(margins[first]), name, float(statics.lumps.measured_depth[first]))
