"""Cases that a figure of a sweep has no number of, which are often the worst ones: how many, which, and why."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tautline.scene.values.printed import shown
from tautline.sweeps.cases import DONE
from tautline.sweeps.plans import AS_IN_THE_SCENE, GRID, ONE, Cases, Parameter, word_of
from tautline.sweeps.table import NOT_RUN, Variables
from tautline.view.figures.figure import shortened

MOST_TOLD = 4
"""Values that a heading names."""
LETTERS = 26
"""Letters of one that is a word."""


class Missing(NamedTuple):
    """Cases without a number.

    Attributes
    ----------
    cases : (n,) array of bool
        Of all cases, in their order.
    word : str
        What a legend says of them.
    said : str
        What a sentence says of them.
    """

    cases: np.ndarray
    word: str
    said: str

    @classmethod
    def of(cls, data: Variables, name: str) -> Missing:
        """The cases without a number of that name."""
        lacking = ~np.isfinite(data[name].values.ravel())
        status = set(data["status"].values.ravel()[lacking].tolist())
        if DONE in status:
            return cls(lacking, "no number", "have no number")
        if NOT_RUN in status:
            return (
                cls(lacking, "not run", "were not run")
                if len(status) == 1
                else cls(lacking, "failed or not run", "failed or were not run")
            )
        return cls(lacking, "failed", "failed")

    def sentence(self, cases: Cases, system: str) -> str:
        """How many there are, and with which values where one key alone tells them; empty for none.

        Parameters
        ----------
        cases : Cases
        system : str
            Of units.
        """
        count = int(self.cases.sum())
        if not count:
            return ""
        said = self.said.replace("have", "has").replace("were", "was") if count == 1 else self.said
        text = f"{count} of {len(cases)} case{'s' if len(cases) > 1 else ''} {said}"
        words = self._told(cases, system)
        return f"{text}: {listed_shortly(words)}" if words else text

    def _told(self, cases: Cases, system: str) -> list[str]:
        long = [one for one, length in zip(cases.parameters, cases.shape, strict=False) if length > 1]
        if cases.plan.name == ONE and len(cases.parameters) == 1:
            return (["as in the scene"] if self.cases[0] else []) + self.values_of(cases.parameters[0], cases, system)
        return self.values_of(long[0], cases, system) if cases.plan.name == GRID and len(long) == 1 else []

    def values_of(self, one: Parameter, cases: Cases, system: str) -> list[str]:
        """Values that a parameter has in them, as they are told, from the smallest to the largest."""
        own, numbers = cases.values[one.key], cases.numbers[one.key]
        its = [k for k in np.flatnonzero(self.cases).tolist() if own[k] is not AS_IN_THE_SCENE]
        if one.numeric:
            return [shown(float(number), one.unit, system) for number in sorted(numbers[its].tolist())]
        return [shortened(word_of(own[k]), LETTERS) for k in its]


def listed_shortly(words: list[str]) -> str:
    """Words with commas; of many the first ones, and how many more there are."""
    left = f" and {len(words) - MOST_TOLD} more" if len(words) > MOST_TOLD + 1 else ""
    return ", ".join(words[:MOST_TOLD] if left else words) + left
