"""A simulation linearised about where it stands, with what of it the linear model cannot say."""

from tautline.live.plant.linearisation import linearise
from tautline.live.plant.plant import Plant

__all__ = ["Plant", "linearise"]
