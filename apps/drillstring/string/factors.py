"""Friction factors along a hole: one, or one in the casing and another in the open hole below its shoe."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from drillstring.scene.hole import Wall


class Factors(NamedTuple):
    """Friction factors of the open and of the cased hole, and measured depth of the shoe, m: 0 without casing."""

    open: float
    cased: float
    shoe: float = 0.0

    @property
    def several(self) -> bool:
        """Whether the hole has a casing."""
        return self.shoe > 0.0

    @property
    def largest(self) -> float:
        """The larger of the two."""
        return max(self.open, self.cased) if self.several else self.open

    def over(self, top: np.ndarray, bottom: np.ndarray) -> np.ndarray:
        """Mean factor of stretches (n,) from top to bottom (n,) m of measured depth."""
        share = np.clip((self.shoe - top) / (bottom - top), 0.0, 1.0)
        return self.open + (self.cased - self.open) * share

    def times(self, part: float) -> Factors:
        """Both factors times a number."""
        return Factors(part * self.open, part * self.cased, self.shoe)

    def __format__(self, spec: str) -> str:
        """Cased and open between a stroke, as ``--friction`` reads them, or the one number."""
        both = (self.cased, self.open) if self.several and self.cased != self.open else (self.open,)
        return "/".join(format(factor, spec) for factor in both)

    def plain(self) -> float | dict[str, float]:
        """For ``--json``: the number, or both by name where they differ."""
        return {"cased": self.cased, "open": self.open} if self.several and self.cased != self.open else self.open


def same(friction: float | Factors, shoe: float = 0.0) -> Factors:
    """A number as the factors of a hole with its shoe at a depth, m; factors as they are."""
    return friction if isinstance(friction, Factors) else Factors(float(friction), float(friction), shoe)


def factors_of(wall: Wall, kind: str) -> Factors:
    """The ``static`` or ``kinetic`` factors of a scene's wall."""
    below = float(getattr(wall.friction, kind))
    if wall.casing is None:
        return Factors(below, below)
    return Factors(below, float(getattr(wall.casing.friction, kind)), wall.casing.shoe)
