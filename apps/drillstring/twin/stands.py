"""The string grows by a stand: the scene of the next one, the hole and the string one stand longer.

What is added is pipe at the top, where stands come from. Depths of the hole stay, for they count from the rotary
table: the casing's shoe is where it was, and the bit is a stand deeper. The number of links stays, so nothing is
compiled anew.
"""

from __future__ import annotations

from typing import Any

from drillstring.model.prepared import tubes_of, well_of
from drillstring.scene.hole import Hold
from drillstring.scene.scene import DrillstringScene, scene_of
from tautline.scene.errors import SceneError
from tautline.scene.reading.document import Path_

ORIGIN = "a stand"
"""What messages name in place of a line."""


def bit_depth(scene: Any) -> float:
    """Measured depth, m, of the bit of the unstretched string; takes and raises what `with_stand` does of a scene."""
    scene = scene_of(scene)
    return float(sum(tube.length for tube in tubes_of(scene, well_of(scene).length)))


def with_stand(scene: Any, length: float) -> DrillstringScene:
    """The scene with its string longer by a stand; all else is the same.

    Parameters
    ----------
    scene : DrillstringScene, path, text or dict
        The section at the top of its string is the pipe that is added.
    length : float
        Of the stand, m; negative of one that is laid down.

    Returns
    -------
    DrillstringScene
        Where the string already fills the hole, its sections end with a straight piece, which is drilled further. A
        string that ends above the bottom goes down in the hole there is. A block with a position begins where it was:
        the way of the block counts from the string's top at the table.

    Raises
    ------
    SceneError
        Where the bit would pass the end of a survey, or of a hole that ends in an arc: what comes after it is not
        known; where less than nothing of the pipe would be left; and as `DrillstringScene.replace` and `scene_of` do.
    ArgumentTypeError
        As `scene_of` does.
    """
    scene = scene_of(scene)
    well = well_of(scene)
    tubes = tubes_of(scene, well.length)
    old = sum(tube.length for tube in tubes)
    grown = tubes[0].length + length
    if grown <= 0.0:
        top = tubes[0]
        cause = f"{-length:g} m of pipe are to be laid down, and '{top.name}' at the top is {top.length:g} m long"
        raise SceneError([scene.problem("string[0].length", cause, "lay down less")])
    # Every section gets its length as a number: one that is the rest of the hole grows only at the top.
    values: dict[Path_, Any] = {("string", k, "length"): tube.length for k, tube in enumerate(tubes)}
    values["string", 0, "length"] = grown
    deeper = old + length - well.length
    if deeper > 1e-9 * well.length:
        values.update(_drilled_on(scene, deeper))
    return scene.with_values({path: (value, ORIGIN) for path, value in values.items()})


def _drilled_on(scene: DrillstringScene, deeper: float) -> dict[Path_, Any]:
    """Values of a hole that goes on straight for so many metres more."""
    if scene.well.survey is not None:
        end = well_of(scene).length
        cause = f"ends at {end:g} m, and the bit would be at {end + deeper:g} m: the course there is unknown"
        raise SceneError([scene.problem("well.survey", cause, "add the stations that were measured, or are planned")])
    assert scene.well.sections is not None
    last = len(scene.well.sections) - 1
    piece = scene.well.sections[last]
    if not isinstance(piece, Hold):
        end = well_of(scene).length
        cause = f"ends in an arc at {end:g} m: what course the hole takes below it is unknown"
        raise SceneError([scene.problem(f"well.sections[{last}]", cause, "add what is planned: a hold, build or turn")])
    return {("well", "sections", last, "hold"): piece.length + deeper}
