"""Sea states: significant height, peak period and heading, which are physical, and the scenes of their storms."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from crane.scene.carried import brings_sea, carries, how_to_mount
from crane.scene.scene import VESSEL, CraneScene
from crane.scene.surroundings import Motion, SeaMotion
from crane.sea.frames import MOTIONS
from crane.sea.sea_doubts import FEWEST_WAVES, equal_waves, highest
from tautline.scene.errors import SceneError
from tautline.scene.functions import Spectrum, Sum, Velocity
from tautline.scene.vector import EARTH_GRAVITY

APART = 1_000_003
"""How far the seeds of two motions with a draw of their own are apart: more than there are storms."""
FEW_WAVES = 60.0
"""Number of equal waves below which the extremes of a sum of sines lie visibly below those of a Gaussian sea."""

SHORT_OF_WAVES = 12.0
"""Number of equal waves below which that is more than a few per cent: by drawn phases 7 % of 3 h at 12, 24 % at 5."""


class Condition(NamedTuple):
    """A sea state: m, s, rad or None for the scene's own heading, and the gravity that its waves have, m/s^2."""

    height: float
    period: float
    heading: float | None
    gravity: float = EARTH_GRAVITY

    @property
    def physical(self) -> bool:
        """Whether waves of this period can be so high."""
        return self.height <= highest(self.period, self.gravity) * (1.0 + 1e-9)


class SeaKeys(NamedTuple):
    """Keys of a scene by which its sea is changed.

    ``draws`` are the places of the spectra's seeds among those that the scene has: motions of one seed follow the same
    waves in every storm, and those of several seeds never do.
    """

    spectra: tuple[str, ...]
    direction: str | None
    draws: tuple[int, ...] = (0,)

    def changes(self, condition: Condition, seed: int) -> dict[str, Any]:
        """Values of a storm."""
        made: dict[str, Any] = {}
        for key, draw in zip(self.spectra, self.draws, strict=True):
            made[f"{key}.significant_height"] = condition.height
            made[f"{key}.peak_period"] = condition.period
            made[f"{key}.seed"] = seed + APART * draw
        if condition.heading is not None and self.direction is not None:
            made[self.direction] = condition.heading
        return made

    def seas(self, scene: CraneScene) -> dict[str, Spectrum]:
        """The sea of each key."""
        motion: Any = scene.vessel.motion if scene.vessel is not None else None
        return {key: motion.sea if self.direction else getattr(motion, key.split(".")[2]) for key in self.spectra}

    def ramps(self, scene: CraneScene, length: float) -> dict[str, float]:
        """A time, s, in which the sea grows from nothing, where the scene gives none: a jump would shake the load."""
        return {f"{key}.ramp": length for key, sea in self.seas(scene).items() if sea.ramp == 0.0 and length > 0.0}


def sea_keys(scene: CraneScene, headings: bool) -> SeaKeys:
    """Where a scene has its sea.

    Raises
    ------
    SceneError
        For a scene without a sea, or whose sea moves nothing of the rope and acts on no load; for headings
        where the responses of the vessel know none, and for motions of several seas, of which a sea state is one.
    """
    motion = scene.vessel.motion if scene.vessel is not None else None
    _check_waves(scene, headings)
    if isinstance(motion, SeaMotion):
        _check_carried(scene)
        return SeaKeys(("vessel.motion.sea",), "vessel.motion.direction")
    spectra = []
    if isinstance(motion, Motion):
        _check_stand_alone(scene, motion)
        spectra = [name for name in MOTIONS if isinstance(getattr(motion, name), Spectrum)]
    if not spectra:
        key: tuple[str, ...] = ("vessel", "motion") if scene.vessel is not None else ("vessel",)
        cure = "give vessel.motion: {sea: {significant_height: 2, peak_period: 9}, rao: vessel.csv}"
        raise SceneError([scene.problem(key, "has no sea, and operability varies one", cure)])
    _check_carried(scene)
    if headings:
        cure = (
            "leave --heading out, or give vessel.motion a sea and a file of responses with the column direction [deg]"
        )
        raise SceneError([scene.problem(("vessel", "motion"), "knows no headings of the sea", cure)])
    assert isinstance(motion, Motion)
    _check_one_sea(scene, motion, spectra)
    seeds = [getattr(motion, name).seed for name in spectra]
    draws = tuple(list(dict.fromkeys(seeds)).index(seed) for seed in seeds)
    return SeaKeys(tuple(f"vessel.motion.{name}.spectrum" for name in spectra), None, draws)


def _check_carried(scene: CraneScene) -> None:
    """Refuse a sea that neither moves the rope nor acts on a load: every height of it would be allowed."""
    if not carries(scene, VESSEL) and not brings_sea(scene):
        cause = "no drum, sheave or anchor of the path rides on the vessel: the sea moves nothing"
        raise SceneError([scene.problem((VESSEL,), cause, how_to_mount(scene, VESSEL))])


def _check_waves(scene: CraneScene, headings: bool) -> None:
    """Refuse waves on the loads that would stay what they are in every sea state."""
    waves, at = None if scene.water is None else scene.water.waves, ("water", "waves")
    if waves is None:
        return
    if waves.elevation != "vessel":
        cause = "are waves of their own: operability varies the sea of the vessel, and they would stay what they are"
        raise SceneError([scene.problem((*at, "elevation"), cause, "write elevation: vessel")])
    if headings and waves.direction is not None:
        cause = "is given, and the headings are varied"
        raise SceneError(
            [scene.problem((*at, "direction"), cause, "give vessel.motion the direction, and remove this")]
        )


def _check_stand_alone(scene: CraneScene, motion: Motion) -> None:
    """Refuse a sea within a sum or a velocity, which would stay what it is in every sea state."""
    for name in MOTIONS:
        if not isinstance(moved := getattr(motion, name), Spectrum) and _holds_sea(moved):
            cause = "has a spectrum within something else, and operability changes seas that stand alone"
            cure = f"write {name}: {{spectrum: ...}}, or give vessel.motion a sea and a file of responses"
            raise SceneError([scene.problem(("vessel", "motion", name), cause, cure)])


def _check_one_sea(scene: CraneScene, motion: Motion, spectra: Sequence[str]) -> None:
    """Refuse motions whose seas are not one: a storm has one height, one period and one shape of spectrum."""
    first = getattr(motion, spectra[0])
    for name in spectra[1:]:
        for key in ("significant_height", "peak_period", "gamma"):
            one, other = getattr(first, key), getattr(getattr(motion, name), key)
            if one != other:
                cause = f"is {other:g} and that of {spectra[0]} is {one:g}: a sea state has one for all motions"
                cure = "write the same; a wind sea on a swell is not looked at by operability, but by a sweep"
                raise SceneError([scene.problem(("vessel", "motion", name, "spectrum", key), cause, cure)])


def _holds_sea(function: Any) -> bool:
    """Whether a function of time is a spectrum, or has one in it."""
    if isinstance(function, Velocity):
        return _holds_sea(function.velocity)
    return isinstance(function, Spectrum) or (isinstance(function, Sum) and any(map(_holds_sea, function.terms)))


def conditions_of(
    heights: Sequence[float], periods: Sequence[float], headings: Sequence[float | None],
    gravity: Sequence[float] = (0.0, 0.0, -EARTH_GRAVITY),
) -> list[Condition]:  # fmt: skip
    """All sea states, physical or not, heading by heading, period by period; under a scene's gravity, if it has any."""
    g = math.hypot(*gravity) or EARTH_GRAVITY
    return [Condition(height, period, heading, g) for heading in headings for period in periods for height in heights]


def cases_of(conditions: Sequence[Condition], seeds: Sequence[int], keys: SeaKeys) -> dict[str, list[Any]]:
    """Values of each key for the plan ``zip``: a case for each seed of each physical condition, in this order.

    Every condition has the same seeds: what differs between two of them is then the sea and not the draw.
    """
    rows = [keys.changes(one, seed) for one in conditions if one.physical for seed in seeds]
    return {key: [row[key] for row in rows] for key in rows[0]} if rows else {}


def headings_that_run(conditions: Sequence[Condition]) -> list[Condition]:
    """A physical condition of each heading: what is not physical is not run."""
    return list({one.heading: one for one in reversed(conditions) if one.physical}.values())[::-1]


def sea_notes(scene: CraneScene, keys: SeaKeys) -> list[str]:
    """What is sound of a sea and better done otherwise."""
    found = []
    names = [key.split(".")[2] for key in keys.spectra]
    if len(names) > len(set(keys.draws)):
        alike = " and ".join(name for name, draw in zip(names, keys.draws, strict=True) if keys.draws.count(draw) > 1)
        found.append(
            f"vessel.motion: {alike} have one seed, and swing in phase in every storm; give them seeds of their own if "
            f"they are not to"
        )
    for key, one in keys.seas(scene).items():
        number = equal_waves(one)
        # Of fewer it is warned: they are no sea at all, whatever they are too low by.
        if FEWEST_WAVES <= number < FEW_WAVES:
            low = "a few" if number >= SHORT_OF_WAVES else "some 7 to 25"
            more = math.ceil(one.components * FEW_WAVES / number / 100.0) * 100
            found.append(
                f"{key}: the spectrum has too few components: {one.components}, equivalent to {number:.0f} equal "
                f"waves. The 3 h maximum is {low} per cent too low. Take components: {more}"
            )
    return found
