"""Stiffnesses and damping of elements as they stand in the rows of the groups, where parameters change them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from tautline.cable.input.parts import Element


class Numbers(NamedTuple):
    """Of all elements (m,): EA in N, c of the strain in s, EJ in N m^2, EJ c of the curvature in N m^2 s."""

    stiffness: np.ndarray
    damping: np.ndarray
    bending: np.ndarray
    viscosity: np.ndarray


class Sections:
    """Where the numbers of each element stand: ``members`` are groups, each with the places of its rows' elements.

    The groups' rows are what the equations use, what parameters change, and what a state that is restored brings back.
    """

    def __init__(self, elements: Sequence[Element]) -> None:
        # Two elements may be alike in all they say: which of them a row is of is known by the object alone.
        self._place = {id(element): k for k, element in enumerate(elements)}
        self.members: list[tuple[Any, np.ndarray]] = []

    def of(self, group: Any, elements: Sequence[Element]) -> Any:
        """A group, whose rows from now on count as those of so many elements, in this order."""
        self.members.append((group, np.array([self._place[id(element)] for element in elements], dtype=int)))
        return group

    def numbers(self) -> Numbers:
        """As they are now; zero of what an element has not."""
        found = Numbers(*np.zeros((4, len(self._place))))
        for group, places in self.members:
            rows = group.rows
            names = rows.dtype.names or ()
            # By fields that only its records have: of tension (in pipes with bending), of bending, of damping of it.
            if "engineering" in names:
                found.stiffness[places], found.damping[places] = rows["stiffness"], rows["damping"]
            bending = "bending" if "bending" in names else "stiffness" if "smoothing" in names else ""
            if bending:
                found.bending[places] = rows[bending]
                found.viscosity[places] += rows[bending] * rows["damping"]
            if "viscosity" in names:
                found.viscosity[places] += rows["viscosity"]
        return found
