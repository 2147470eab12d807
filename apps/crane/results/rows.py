"""Which rows the summary of a run leaves out, because other rows tell the same; ``--json`` has all of them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

ALIKE = 1.0e-3
"""Share by which two lengths differ at most that are printed once."""
OF_LIMITS = {"max_fleet_angle": "fleet_angle", "max_sidelead": "sidelead", "smallest_bending_ratio": "bending_ratio"}
"""Figures that the row of a limit tells, beside what is allowed."""
LESS = re.compile(r"energy_hoisted.*|max_tension_(sheaves|.*_(in|out)(_\d+)?)")
"""Figures of each place or drum of which others tell enough. Tensions at drums, ends and anchors are asked for."""
LITTLE = 0.01
"""Share of what winches hoist up to which what they take back is no concern of brakes."""
OF_MODELS = ("strain", "least_stretch", "most_stretch")
"""Limits that tell whether the model of the rope holds, which is of interest where it does not."""


def aside(figures: Mapping[str, Mapping[str, Any]], limits: Iterable[Mapping[str, Any]]) -> frozenset[str]:
    """Names of figures and of limits that the summary does not print.

    Parameters
    ----------
    figures : mapping
        Name -> value, unit, text; SI.
    limits : iterable of mapping
        Records of `crane.results.limits`. One that is not satisfied is a warning, whether it is named here or not.
    """
    judged = {record["name"]: record["value"] for record in limits if "output" not in record}
    values = {name: figure["value"] for name, figure in figures.items()}
    found = {name for name in figures if LESS.fullmatch(name)}
    # A limit is of the place that is nearest to its own bound, which need not be that of the largest value.
    found |= {name for name, limit in OF_LIMITS.items() if name in values and _tells(judged.get(limit), values[name])}
    # The equivalent range says of how many cycles it is.
    found |= {"tension_cycles", *OF_MODELS}
    if "safety_factor" in figures:
        found.add("breaking_load")
    return frozenset([*found, *_of_winches(values), *_of_bodies(values)])


def _of_winches(values: Mapping[str, Any]) -> Iterator[str]:
    """Of what winches take back what is little: brakes turn the rest to heat."""
    for name, value in values.items():
        if name.startswith("energy_regenerated"):
            of = name.removeprefix("energy_regenerated")
            if value <= LITTLE * values.get(f"energy_hoisted{of}", 0.0):
                yield name


def _of_bodies(values: Mapping[str, Any]) -> Iterator[str]:
    """Of the ways of a body those that are its rise at the end again, or its largest."""
    for name in values:
        if not name.startswith("rise"):
            continue
        of = name.removeprefix("rise")
        rise, highest, away = values[name], values.get(f"max_rise{of}", 0.0), values.get(f"max_displacement{of}", 0.0)
        if _alike(highest, max(rise, 0.0)):
            yield f"max_rise{of}"
        if _alike(away, max(abs(rise), highest)):
            yield f"max_displacement{of}"


def _tells(limit: float | None, figure: float) -> bool:
    return limit is not None and _alike(abs(limit), abs(figure))


def _alike(one: float, two: float) -> bool:
    return bool(abs(one - two) <= ALIKE * max(abs(one), abs(two)))
