"""How a drill string's scene is varied for a study: finer or coarser links, other stiffness, a sliver at the bit.

Each function takes a validated scene and returns another, as it would be read from a file that says so; the scene given
stays as it is.
"""

from __future__ import annotations

import copy
import math
from typing import Any

from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.scene import LUMPED, DrillstringScene
from drillstring.string.lumps import Tube, share_elements
from tautline.scene.reading.document import Path_
from tautline.study.robustness.bar import Bar

ORIGIN = "study"
"""What messages name in place of a line."""
WALL: Path_ = ("well", "wall", "stiffness")


def elements(scene: DrillstringScene, factor: float) -> DrillstringScene | None:
    """Give every section ``factor`` times its links, at least one; None if that changes nothing.

    Every section states its number in the new scene: shared anew, they would not be those of the old one times the
    factor.

    Raises
    ------
    SceneError
        For more links than a string may have, and as `links_of` does.
    """
    counts = [count for _, count in links_of(scene)]
    wanted = [max(1, math.floor(count * factor + 0.5)) for count in counts]
    if wanted == counts:
        return None
    return scene.varied(_meshed(scene, wanted), ORIGIN)


def stiffness(scene: DrillstringScene, factor: float) -> DrillstringScene:
    """Axial, bending and torsional stiffness of the string times ``factor``: that of its moduli."""
    moduli = ("youngs_modulus", "shear_modulus")
    values: dict[Path_, Any] = {("material", key): factor * getattr(scene.material, key) for key in moduli}
    own = [
        {key: factor * value for key in moduli if (value := getattr(section, key)) is not None}
        for section in scene.string
    ]
    if any(own):
        values["string",] = _sections(scene, own)
    return scene.varied(values, ORIGIN)


def contact(scene: DrillstringScene, value: float) -> DrillstringScene | None:
    """Stiffness of the hole's wall, N/m, as the scene would give it; None in free space."""
    return None if scene.well.wall is None else scene.varied({WALL: value}, ORIGIN)


def penalty(scene: DrillstringScene, value: float) -> None:
    """No constraint of a lumped string is a spring: None."""
    return None


def shortest(scene: DrillstringScene, factor: float) -> DrillstringScene:
    """Cut a link off the lower end that is ``factor`` times shorter than the shortest; the section above keeps its own.

    Raises
    ------
    SceneError
        If nothing would be left of the last section, and as `links_of` does.
    """
    links = links_of(scene)
    sliver = min(tube.length / count for tube, count in links) / factor
    values = _meshed(scene, [count for _, count in links])
    above = values["string",][-1]
    end = copy.deepcopy(above) | {"name": f"{scene.string[-1].name}, lower end", "length": sliver, "elements": 1}
    if scene.string[-1].length != "rest":
        above["length"] = links[-1][0].length - sliver
    values["string",].append(end)
    values["model", "elements"] += 1
    return scene.varied(values, ORIGIN)


def constraints(scene: DrillstringScene) -> tuple[str, ...]:
    """Tell in which ways constraints can be imposed: lumps in a hole have none."""
    return ()


def constraint(scene: DrillstringScene, name: str) -> None:
    """There is no choice: None."""
    return None


def stiffnesses(scene: DrillstringScene) -> dict[str, float | None]:
    """Stiffness of the wall as the scene gives it, N/m, and of penalty constraints, of which there are none."""
    return {"contact": None if scene.well.wall is None else scene.well.wall.stiffness, "penalty": None}


def bars(scene: DrillstringScene) -> list[Bar]:
    """One link of every section, and the last one, whose lower lump is free to move along the hole.

    Raises
    ------
    SceneError
        As `links_of` does.
    """
    links, made = links_of(scene), []
    for i, (tube, count) in enumerate(links):
        length = tube.length / count
        speed = math.sqrt(tube.youngs_modulus * tube.area / tube.mass_per_length)
        name, last = f"{tube.name}, element of {length:.4g} m", i == len(links) - 1
        kind = "lumped" if scene.model.kind == LUMPED else "bent"
        if count > 1 or not last:
            made.append(Bar(name, length, speed, kind, False))
        if last:
            made.append(Bar(f"{name} at the lower end", length, speed, kind, True))
    return made


def links_of(scene: DrillstringScene) -> list[tuple[Tube, int]]:
    """Sections as the builder cuts them, each with its number of links.

    Raises
    ------
    SceneError
        Where the well cannot be drilled as written, or the string does not fit into it.
    """
    tubes = tubes_of(scene, well_of(scene).length)
    return list(zip(tubes, share_elements(tubes, scene.model.elements), strict=True))


def _meshed(scene: DrillstringScene, counts: list[int]) -> dict[Path_, Any]:
    """Values that give each section its number of links."""
    sections = _sections(scene, [{"elements": count} for count in counts])
    return {("string",): sections, ("model", "elements"): sum(counts)}


def _sections(scene: DrillstringScene, changes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Sections as the file has them, with changes; none shares a mapping with another, as an alias would."""
    written = scene.written["string"]
    return [copy.deepcopy(section) | change for section, change in zip(written, changes, strict=True)]
