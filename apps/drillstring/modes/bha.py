"""The bottom-hole assembly between its contact points: what of the string vibrates, and how finely it is cut for that.

The part that is looked at ends at the bit. Its upper end is the first point above the topmost stabiliser where the
string lies on the wall, or without stabilisers the first at or above the assembly's top; where there is none it is the
top drive. Above its upper end the string counts as held, so that drill pipe by the kilometre does not drown what is
asked for.
"""

from __future__ import annotations

from math import ceil, pi, sqrt
from typing import NamedTuple

import numpy as np

from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.scene import BEAM, LUMPED, DrillstringScene
from drillstring.string.fluid import fluid_of, mass_beside
from drillstring.string.lumps import Tube
from tautline.scene.errors import Problem, SceneError

LONGEST_STABILISER = 15.0
"""Sections thicker than their neighbours count as stabilisers up to so many metres."""
COARSE, CLOSE = 30.0, 5.0
"""Longest link, m, where nothing is asked for but the string's weight and place, and of an assembly that is not yet cut
for its waves."""
PER_WAVE = {LUMPED: 20, BEAM: 8}
"""Links or elements to a wave at the highest frequency, in the coarser of two meshes."""
LEAST_LINKS = 2
"""Of a section, in the coarser of two meshes."""
EDGE = 1e-6
"""Two depths that differ by less are one, m."""
MOST_LINKS = 4000
"""Of the finer mesh; elements of a beam are fewer, as those to a wave are."""


class Cut(NamedTuple):
    """A scene cut anew: sections with their number of links, and the first of them that is looked at closely."""

    scene: DrillstringScene
    counts: tuple[int, ...]
    first: int

    def doubled(self) -> Cut:
        """Twice the links where it is looked at."""
        counts = tuple(2 * n if i >= self.first else n for i, n in enumerate(self.counts))
        return Cut(_meshed(self.scene, counts), counts, self.first)


def assembly_of(scene: DrillstringScene) -> int:
    """Number of the assembly's first section: what is below the ``rest`` of the string, else below its longest section.

    0, the whole string, where nothing is below that.
    """
    rest = [i for i, section in enumerate(scene.string) if section.length == "rest"]
    lengths = [0.0 if section.length == "rest" else float(section.length) for section in scene.string]
    pipe = rest[0] if rest else int(np.argmax(lengths))
    return pipe + 1 if pipe + 1 < len(scene.string) else 0


def stabilisers_of(scene: DrillstringScene) -> list[int]:
    """Short sections of the assembly that are thicker than both neighbours, or than the one above at the bit."""
    wide = [section.contact_diameter for section in scene.string]
    found = []
    for i in range(max(1, assembly_of(scene)), len(wide)):
        length = scene.string[i].length
        below = wide[i + 1] if i + 1 < len(wide) else 0.0
        if length != "rest" and float(length) <= LONGEST_STABILISER and wide[i] > wide[i - 1] and wide[i] > below:
            found.append(i)
    return found


def top_of_assembly(scene: DrillstringScene) -> float:
    """Measured depth of the assembly's top, m."""
    tubes = tubes_of(scene, well_of(scene).length)
    return float(sum(tube.length for tube in tubes[: assembly_of(scene)]))


def lowest_end(scene: DrillstringScene) -> float:
    """Measured depth above which the upper end is looked for, m: top of the topmost stabiliser, or of the assembly."""
    tubes = tubes_of(scene, well_of(scene).length)
    tops = np.cumsum([0.0] + [tube.length for tube in tubes])
    stabilisers = stabilisers_of(scene)
    # A stabiliser's own upper edge is no end; the assembly's is one.
    return float(tops[stabilisers[0]]) - EDGE if stabilisers else top_of_assembly(scene) + EDGE


def wave_number(tube: Tube, mass: float, tension: float, frequency: float) -> float:
    """Wave number of bending waves, 1/m: EI k^4 + T k^2 = m omega^2 (Graff, Wave Motion in Elastic Solids, ch. 3).

    Parameters
    ----------
    tube : Tube
    mass : float
        Moving with a metre of it, kg/m.
    tension : float
        Effective, N; compression makes waves shorter.
    frequency : float
        Hz.
    """
    rigidity, load = tube.youngs_modulus * tube.second_moment, mass * (2.0 * pi * frequency) ** 2
    return sqrt((-tension + sqrt(tension**2 + 4.0 * rigidity * load)) / (2.0 * rigidity))


def coarse(scene: DrillstringScene) -> Cut:
    """The scene cut to find where it lies on the wall: finer in the assembly than above it."""
    assembly = assembly_of(scene)
    return _cut(scene, [COARSE if i < assembly else CLOSE for i in range(len(scene.string))])


def evenly(scene: DrillstringScene, longest: float) -> Cut:
    """The scene with links of at most ``longest`` m; raises SceneError where those are more than `MOST_LINKS`."""
    return _cut(scene, [longest] * len(scene.string))


def _cut(scene: DrillstringScene, longest: list[float]) -> Cut:
    tubes = tubes_of(scene, well_of(scene).length)
    counts = tuple(max(LEAST_LINKS, ceil(tube.length / most)) for tube, most in zip(tubes, longest, strict=True))
    _check(scene, 2 * sum(counts), "")
    return Cut(_meshed(scene, counts), counts, 0)


def fine(scene: DrillstringScene, top: float, frequency: float) -> Cut:
    """The scene cut for bending waves of a frequency (Hz) below a measured depth, coarsely above it.

    Raises
    ------
    SceneError
        Where that takes more links than `MOST_LINKS`.
    """
    scene = _parted(scene, top)
    tubes = tubes_of(scene, well_of(scene).length)
    tops = np.cumsum([0.0] + [tube.length for tube in tubes])[:-1]
    first = int(np.searchsorted(tops, top - EDGE))
    fluid, push = fluid_of(scene.mud), min(0.0, scene.bit.load)
    counts = []
    for i, tube in enumerate(tubes):
        if i < first:
            counts.append(max(LEAST_LINKS, ceil(tube.length / COARSE)))
            continue
        mass = tube.mass_per_length + mass_beside(fluid, tube, scene.well.diameter)
        wave = 2.0 * pi / wave_number(tube, mass, push, frequency)
        counts.append(max(LEAST_LINKS, ceil(PER_WAVE[scene.model.kind] * tube.length / wave)))
    _check(scene, 2 * sum(counts[first:]) + sum(counts[:first]), f" for bending waves of {frequency:.3g} Hz")
    return Cut(_meshed(scene, tuple(counts)), tuple(counts), first)


def _check(scene: DrillstringScene, links: int, why: str) -> None:
    most = MOST_LINKS * PER_WAVE[scene.model.kind] // PER_WAVE[LUMPED]
    if links > most:
        name = "links" if scene.model.kind == LUMPED else "elements"
        cause = f"needs {links} {name}{why}, more than {most}"
        bounded = "bound what is looked at by --from DEPTH, or " if why else ""  # of bending waves alone
        cure = f"{bounded}ask for lower frequencies by --up-to"
        raise SceneError([Problem("string", None, "", f"{len(scene.string)} sections", cause, cure)])


def _parted(scene: DrillstringScene, depth: float) -> DrillstringScene:
    """The scene with a section parted in two at a measured depth, m."""
    tubes = tubes_of(scene, well_of(scene).length)
    tops = np.cumsum([0.0] + [tube.length for tube in tubes])
    i = int(np.searchsorted(tops, depth, side="right")) - 1
    if not 0 <= i < len(tubes) or min(depth - tops[i], tops[i + 1] - depth) < 1e-3:
        return scene
    section = scene.string[i]
    upper = section if section.length == "rest" else section.model_copy(update={"length": float(depth - tops[i])})
    lower = section.model_copy(update={"length": float(tops[i + 1] - depth)})
    return scene.model_copy(update={"string": (*scene.string[:i], upper, lower, *scene.string[i + 1 :])})


def _meshed(scene: DrillstringScene, counts: tuple[int, ...]) -> DrillstringScene:
    pairs = zip(scene.string, counts, strict=True)
    string = tuple(section.model_copy(update={"elements": count}) for section, count in pairs)
    model = scene.model.model_copy(update={"elements": sum(counts)})
    return scene.model_copy(update={"string": string, "model": model})
