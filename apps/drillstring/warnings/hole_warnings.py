"""What to tell a user about a hole before a string is in it: depths, directions and bends that few holes have."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import degrees

import numpy as np

from drillstring.model.prepared import Prepared, survey_of
from drillstring.scene.hole import DRILLED, Hold
from drillstring.scene.scene import DrillstringScene
from drillstring.well.sections import dogleg_severity
from drillstring.well.wellbore import Wellbore
from tautline.scene.values.printed import shown
from tautline.scene.values.ranges import RANGES, in_range, sized

RISING = 0.05
"""Height above the table over the length of a hole that is warned of; a crossing below a river may end higher up."""
SHARP = np.radians(10.0) / 30.0
"""Dogleg severity, rad/m, above which a hole is warned of: medium-radius wells; most others stay below 5 deg/30 m."""
STATIONS = 200
"""Places along the hole at which its direction is looked at."""
DEEP_STATION, INCLINED = 30.0, np.radians(1.0)
"""Depth of a first station, m, and its inclination, above which the hole above it is warned of: a stand, and what
"vertical" holes have."""
Sentences = Iterator[tuple[str, str]]
Check = Callable[[DrillstringScene, Prepared], Sentences]


def _survey(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """Stations deeper than any hole: the column of depths has another unit."""
    row, length = RANGES["depth"], ready.well.length
    if scene.well.survey is not None and not row.holds(length):
        text = (
            f"{scene.well.survey.file}: the last station stands at {sized(length, 'm')}, and {in_range(row)} is "
            "plausible for a depth; check the unit of the column md, or give it as `md:`"
        )
        yield "well.survey", text


def _first_station(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A survey that begins deep and inclined: nothing in it says how the hole gets there from the table."""
    if scene.well.survey is None:
        return
    survey = survey_of(scene)
    first, tilt = float(survey.md[0]), float(survey.inc[0])
    if first <= DEEP_STATION or tilt <= INCLINED:
        return
    depth, angle = shown(first, "m", scene.units), f"{degrees(tilt):.3g} deg"
    text = (
        f"{scene.well.survey.file}: the first station is at {depth} and inclined by {angle}. Above it the hole is "
        f"taken as straight at {angle}, from the table on. If the hole begins vertical, add the station 0, 0, 0 "
        "(md, inc, azi), and those in between"
    )
    yield "well.survey", text


def _above_the_table(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A hole that goes up above the rotary table: inclinations counted from another direction."""
    md = np.concatenate((ready.well.md, np.linspace(0.0, ready.well.length, STATIONS)))
    heights = -ready.well.tvd(md)
    if heights.max() <= RISING * ready.well.length:
        return
    height, where = (shown(float(x), "m", scene.units) for x in (heights.max(), md[heights.argmax()]))
    text = (
        f"the hole goes up to {height} above the rotary table, at {where} along it. An inclination is counted from "
        "straight down: 0 deg is down, 90 deg level, 180 deg up; check the inclinations"
    )
    yield "well.survey" if scene.well.survey is not None else "well.sections", text


def _dogleg(scene: DrillstringScene, ready: Prepared) -> Sentences:
    """A hole that bends more than drill pipe is used to; models of the laboratory are left out."""
    severity, begin, end = sharpest(ready.well)
    if severity <= SHARP or scene.well.diameter < DRILLED:
        return
    text = (
        f"the hole bends by {dogleg_severity(severity, scene.units)} at {begin:.6g} to {end:.6g} m, and more than "
        f"{dogleg_severity(SHARP, scene.units)} is seldom drilled with pipe: it wears and tires there; check the "
        f"{_bends_by(scene)}"
    )
    yield "well.survey" if scene.well.survey is not None else "well.sections", text


def _bends_by(scene: DrillstringScene) -> str:
    """What the sharpest bend is written by: stations, or the key that stands in its section."""
    if scene.well.survey is not None:
        return "stations"
    arcs = [one for one in scene.well.sections or () if not isinstance(one, Hold)]
    return max(arcs, key=lambda one: one.curvature).key


SAME_BEND = 1.0e-3
"""Share by which the curvature of two arcs may differ that bend alike."""


def sharpest(well: Wellbore) -> tuple[float, float, float]:
    """Largest curvature of the hole, rad/m, and measured depths of the arcs that have it, m.

    Arcs one behind the other that bend alike count as one; of several such the first.
    """
    curvature = np.hypot(well.k1, well.k2)
    alike = curvature >= curvature.max() * (1.0 - SAME_BEND)
    first = int(np.argmax(alike))
    behind = np.flatnonzero(~alike[first:])
    end = first + int(behind[0]) if behind.size else alike.size
    return float(curvature.max()), float(well.md[first]), float(well.md[end])


OF_THE_HOLE: tuple[Check, ...] = (_survey, _first_station, _above_the_table, _dogleg)
"""What is looked at of the hole alone, in the order in which it is reported."""
