"""What is known of the start of a run, and what of it a reader of the result should know."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np

FAR = 0.1
"""Share of the size of a scene by which a start that lies further from its initial geometry is warned of."""
DRAWN_ASIDE = "Draw it a little to the side that is meant"
"""How to choose the side to which a scene in unstable balance is pushed."""
PLACE = re.compile(r"[ r]([xyz])$")
"""Names of unknowns that are places in space."""
MULTIPLIER = "multiplier"
"""How names of multipliers begin, which are forces."""


@dataclass(frozen=True)
class Start:
    """How a run began: as it was given where nothing is known.

    Attributes
    ----------
    found : str
        ``static`` or ``relaxed`` where the start was searched for.
    stable : bool or None
        None where it is not known.
    negative_pivots : int or None
        Of the tangent, of a static start.
    moved, moved_most : float and str, or None
        Largest distance of a place from the initial geometry, m, and its name.
    far : bool
        Whether that is much of the size of the scene.
    pushed : bool
        Whether the scene was in an unstable equilibrium, and was perturbed.
    side : str
        What decided the side to which it was pushed: ``drawn``, ``on the way`` or ``arbitrary``, as in
        `tautline.integrators.statics.stability.Rest`. Records of a push that hold none are of scenes drawn in that
        equilibrium, whose side is arbitrary.
    aside : str
        Sentence on how to choose the side to which it is pushed, where that is not by drawing it there.
    carried : str
        What may hold the scene far from its drawing: ``the current``; empty where nothing does.
    at_rest : mapping
        Variables of a static start as they are before anything moves, by name: numbers, or lists of them as deep as
        the variable has dimensions beside time. Empty where no figure is over them.
    """

    found: str = ""
    stable: bool | None = None
    negative_pivots: int | None = None
    moved: float | None = None
    moved_most: str | None = None
    far: bool = False
    pushed: bool = False
    side: str = "drawn"
    aside: str = ""
    carried: str = ""
    at_rest: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def of_attribute(cls, stored: Mapping[str, Any] | str | None) -> Start:
        """What a result holds of it; a file holds it as JSON."""
        known = {one.name for one in fields(cls)}
        held: Mapping[str, Any] = (json.loads(stored) if isinstance(stored, str) else stored) or {}
        older = {"side": "arbitrary"} if held.get("pushed") else {}
        return cls(**{name: value for name, value in {**older, **held}.items() if name in known})

    @property
    def attribute(self) -> dict[str, Any]:
        """As results hold it; empty where nothing is known."""
        return asdict(self) if self != Start() else {}

    @property
    def warnings(self) -> list[str]:
        """Sentences for the reader of a result."""
        told = []
        if self.negative_pivots:
            told.append(
                f"the static start is unstable: the tangent has {pivots(self.negative_pivots)}. The "
                "string is pressed beyond its buckling load (Euler's, with its weight). A perfectly straight hole "
                "does not show it; where something pushes the string aside, it buckles until the wall holds it"
            )
        if self.found == "relaxed" and self.stable is False:
            told.append(
                "the relaxed start is unstable: the least disturbance leaves it. Try `start: static`, a smaller step, "
                "positions closer to those at rest, or a small force across, such as of wind"
            )
        elif self.pushed and self.side == "arbitrary":
            told.append(
                "the initial geometry is or leads to an unstable equilibrium, as of a column that carries more than "
                "Euler's load. It was perturbed, and came to rest from there. The side is arbitrary. "
                f"{self.aside or DRAWN_ASIDE}"
            )
        elif self.pushed and self.side == "on the way":
            told.append(
                "on its way from the initial geometry to rest the scene came to an unstable equilibrium. It was "
                "perturbed there, and came to rest from there. Look at the first frame"
            )
        if self.far:
            held = f": {self.carried} may hold it there. If not," if self.carried else ", and"
            told.append(
                f"the static start lies far from the initial geometry: {self.moved_most} has moved by "
                f"{self.moved:.3g} m. Look at the first frame{held} give positions closer to those at rest"
            )
        return told


def static_start(
    names: Sequence[str], moved: np.ndarray, places: Sequence[str], drawn: np.ndarray, negative: int
) -> Start:
    """The record of a static start.

    Parameters
    ----------
    names : sequence of str
        Of the unknowns.
    moved : (n,) array
        By how much each has changed from the initial geometry.
    places : sequence of str
        Names of all degrees of freedom, those that are held among them.
    drawn : (n_full,) array
        Their values in the initial geometry.
    negative : int
        Negative pivots of the tangent; -1 where they are not known.
    """
    free = [i for i, _ in _in_space(tuple(names))]
    way = np.abs(moved[free])
    most = int(way.argmax()) if free else 0
    size = size_of(places, drawn)
    return Start(
        "static",
        stable=None if negative < 0 else negative == 0,
        negative_pivots=None if negative < 0 else negative,
        moved=float(way[most]) if free else None,
        moved_most=names[free[most]] if free else None,
        far=bool(free) and size > 0.0 and float(way[most]) > FAR * size,
    )


def size_of(places: Sequence[str], drawn: np.ndarray) -> float:
    """Largest extent of a scene along an axis, m, wherever its origin is; 0 where it has no places in space."""
    found = _in_space(tuple(places))
    along = ([drawn[i] for i, axis in found if axis == one] for one in "xyz")
    return max((float(np.ptp(values)) for values in along if values), default=0.0)


def pivots(count: int) -> str:
    """A number of negative pivots in words."""
    return "one negative pivot" if count == 1 else f"{count} negative pivots"


@functools.lru_cache(maxsize=4)
def _in_space(names: tuple[str, ...]) -> list[tuple[int, str]]:
    """Those that are places in space, with their axes."""
    places = [(i, PLACE.search(name)) for i, name in enumerate(names) if not name.startswith(MULTIPLIER)]
    return [(i, found[1]) for i, found in places if found]
