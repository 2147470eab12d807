"""The string cut into lumps: masses at element ends, springs between them, a lump at every change of section."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from tautline.errors import ArgumentError


class ToolJoints(NamedTuple):
    """Tool joints of a section, of its material: diameters in m, and their share of the section's length."""

    od: float
    id: float
    share: float


@dataclass(frozen=True)
class Tube:
    """One section of the string: dimensions in m, moduli in Pa, densities in kg/m^3.

    Its torsion is that of tube and ``joints`` on average: waves of drill pipe are a hundred times as long as a joint of
    pipe.
    """

    name: str
    length: float
    od: float
    id: float
    contact_od: float
    youngs_modulus: float
    shear_modulus: float
    density: float
    mass_per_length: float
    second_moment: float
    eccentricity: tuple[float, float] = (0.0, 0.0)
    elements: int | None = None
    joints: ToolJoints | None = None

    @property
    def area(self) -> float:
        """Steel's cross-section, m^2."""
        return pi / 4.0 * (self.od**2 - self.id**2)

    @property
    def polar_moment(self) -> float:
        """Polar second moment of area of the round tube, m^4."""
        return _ring(self.od, self.id)

    @property
    def rotary_inertia(self) -> float:
        """About the axis, per length, kg m: the mean of tube and tool joints."""
        if self.joints is None:
            return self.density * self.polar_moment
        od, bore, share = self.joints
        return self.density * ((1.0 - share) * self.polar_moment + share * _ring(od, bore))

    @property
    def torsional_stiffness(self) -> float:
        """Torque over twist per length, N m^2: of tube and tool joints one behind the other."""
        if self.joints is None:
            return self.shear_modulus * self.polar_moment
        od, bore, share = self.joints
        return self.shear_modulus / ((1.0 - share) / self.polar_moment + share / _ring(od, bore))


def _ring(od: float, bore: float) -> float:
    """Polar second moment of area of a ring, m^4, of diameters m."""
    return pi / 32.0 * (od**4 - bore**4)


def share_elements(tubes: list[Tube], total: int) -> list[int]:
    """Elements of each section: in proportion to length, at least one each, ``total`` in all.

    Sections that state their own number keep it; the remainder is shared among the others.

    Raises
    ------
    ArgumentError
        Where there are fewer elements than sections.
    """
    if total < len(tubes):
        raise ArgumentError(f"{total} elements for {len(tubes)} sections: each section needs at least one")
    counts = [tube.elements or 1 for tube in tubes]
    # The next element goes where elements are longest now, which is what stands on top of the heap.
    longest = [(-tube.length, k) for k, tube in enumerate(tubes) if tube.elements is None]
    if not longest:
        return counts
    heapq.heapify(longest)
    for _ in range(total - sum(counts)):
        k = longest[0][1]
        counts[k] += 1
        heapq.heapreplace(longest, (-(tubes[k].length / counts[k]), k))
    return counts


@dataclass(frozen=True)
class Lumps:
    """A string as n + 1 lumps and n links; lump 0 hangs in the top drive. Arrays (n + 1,) or (n,), SI units.

    ``halves`` (n + 1, sections) is how many metres of each section belong to a lump.
    """

    tubes: tuple[Tube, ...]
    section: np.ndarray
    length: np.ndarray
    measured_depth: np.ndarray
    halves: np.ndarray

    def of_links(self, value: Callable[[Tube], float]) -> np.ndarray:
        """A quantity of the section of each link, (n,)."""
        return np.array([value(tube) for tube in self.tubes], dtype=float)[self.section]

    def of_lumps(self, per_length: Callable[[Tube], float]) -> np.ndarray:
        """A quantity per metre of section, summed over the metres that belong to each lump, (n + 1,)."""
        return self.halves @ np.array([per_length(tube) for tube in self.tubes], dtype=float)

    def largest(self, value: Callable[[Tube], float]) -> np.ndarray:
        """Largest of a quantity among the sections that a lump belongs to, (n + 1,)."""
        values = np.array([value(tube) for tube in self.tubes], dtype=float)
        return np.where(self.halves > 0.0, values, -np.inf).max(axis=1)

    @property
    def tributary(self) -> np.ndarray:
        """Length that belongs to each lump, (n + 1,) m."""
        return self.halves.sum(axis=1)

    @property
    def reach(self) -> tuple[np.ndarray, np.ndarray]:
        """Upper and lower end of the piece that belongs to each lump, (n + 1,) m of measured depth each."""
        middle = self.measured_depth[:-1] + 0.5 * self.length
        return np.append(0.0, middle), np.append(middle, self.measured_depth[-1])

    @property
    def total(self) -> float:
        """Unstretched length of the string, m."""
        return float(self.length.sum())

    def stretch(self, tension: np.ndarray) -> float:
        """By how much the links are longer than unstretched, m, with a tension (n,) N in each."""
        return float((tension * self.length / self.of_links(lambda tube: tube.youngs_modulus * tube.area)).sum())


def cut(tubes: list[Tube], elements: int) -> Lumps:
    """Cut a string into lumps.

    Parameters
    ----------
    tubes : list of Tube
        From the rotary table down.
    elements : int
        Links in all.
    """
    counts = share_elements(tubes, elements)
    section = np.repeat(np.arange(len(tubes)), counts)
    length = np.array([tube.length / count for tube, count in zip(tubes, counts, strict=True)])[section]
    halves, link = np.zeros((length.size + 1, len(tubes))), np.arange(length.size)
    halves[link, section] += 0.5 * length
    halves[link + 1, section] += 0.5 * length
    depth = np.concatenate([[0.0], np.cumsum(length)])
    return Lumps(tuple(tubes), section, length, depth, halves)
